"""Rows are weighted means of samples: what they do to constants, slopes, sines, gaps and noise."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy import signal
from scipy.integrate import quad

from eccentric.core import InputError
from eccentric.diagnosis.search import balances
from eccentric.signals import Rows, hann_windows, low_pass_of, white_noise
from eccentric.signals.filters import is_even, places_of
from eccentric.signals.limits import BLOCK_S
from eccentric.signals.rows import in_order
from eccentric.signals.sampling import windows_by_parts

RNG = np.random.default_rng(3)
EVEN = np.arange(0.0, 4.0, 0.004)
COARSE = np.arange(0.0, 20.0, 0.025)
UNEVEN = np.cumsum(RNG.uniform(0.003, 0.007, 800))
GRIDS = {"even": EVEN, "coarse": COARSE, "uneven": UNEVEN}


def windows(t: np.ndarray, length_s: float, segment: np.ndarray | None = None) -> Rows:
    """Windows by parts of a log of one run, without gap if none is given."""
    segment = np.zeros(len(t), dtype=np.int64) if segment is None else segment
    return windows_by_parts(t, segment, np.zeros_like(segment), length_s)


def hann(t: np.ndarray, length_s: float, segment: np.ndarray | None = None) -> Rows:
    """Hann windows over all samples of a log of one run."""
    segment = np.zeros(len(t), dtype=np.int64) if segment is None else segment
    return hann_windows(t, np.ones(len(t), dtype=bool), segment, np.zeros_like(segment), length_s)


def second_rate(rows: Rows, x: np.ndarray) -> np.ndarray:
    """What a signal's weighted second rate is, by its operator."""
    assert rows.rate_operator is not None
    return rows.rate_operator @ x


@pytest.mark.parametrize("grid", GRIDS)
def test_parabola_is_exact_at_any_sampling(grid: str) -> None:
    """Of a parabola, the second rate is exact, however large the constant and uneven the sampling."""
    t = GRIDS[grid]
    w = windows(t, 0.4)
    x = 1000.0 + 3.0 * t + 2.0 * t**2
    np.testing.assert_allclose(w.mean(np.ones_like(t)), 1.0, rtol=1e-12)
    np.testing.assert_allclose(second_rate(w, x), 4.0, rtol=1e-6)


def sinusoid_errors(step: float) -> list[float]:
    """Return the largest errors of mean and second rate of a sine, against the transform of psi."""
    t, half, omega = np.arange(0.0, 8.0 + step / 2.0, step), 0.2, 9.0
    w = windows(t, 2.0 * half)
    area = quad(lambda s: (1.0 - s * s) ** 4, -1.0, 1.0)[0]
    gain = quad(lambda s: (1.0 - s * s) ** 4 * np.cos(omega * half * s), -1.0, 1.0)[0] / area
    x, sine = np.sin(omega * t), np.sin(omega * w.t)
    pairs = (
        (w.mean(x), gain * sine),
        (second_rate(w, x), -gain * omega**2 * sine),
    )
    return [float(np.max(np.abs(actual - expected))) for actual, expected in pairs]


def test_sinusoid_has_the_closed_form() -> None:
    """On a sine, both converge to the closed form with the orders of Euler and Maclaurin: 6 and 4."""
    coarse, fine = sinusoid_errors(0.025), sinusoid_errors(0.0125)
    orders = [round(float(np.log2(a / b))) for a, b in zip(coarse, fine, strict=True)]
    assert orders == [6, 4]


def test_matrix_of_columns_is_averaged_column_by_column() -> None:
    """The mean of a matrix (n, k) is the matrix (m, k) of the means."""
    w = windows(EVEN, 0.3)
    columns = np.stack([EVEN, np.cos(EVEN)], axis=1)
    np.testing.assert_array_equal(w.mean(columns)[:, 1], w.mean(np.cos(EVEN)))


def test_no_window_crosses_a_gap() -> None:
    """A jump of the angle across a gap leaves no trace in any window."""
    t = np.concatenate([EVEN, EVEN + 10.0])
    segment = np.repeat([0, 1], len(EVEN))
    w = windows(t, 0.3, segment)
    np.testing.assert_allclose(second_rate(w, np.where(segment == 0, 0.0, 500.0)), 0.0, atol=1e-6)
    assert np.all((w.t < 4.0) | (w.t > 10.0))


def test_inside_means_every_row() -> None:
    """A window is inside a mask where all its rows are."""
    w = windows(EVEN, 0.4)
    inside = w.inside((EVEN > 1.0) & (EVEN < 2.0))
    expected = (w.t - 0.2 > 1.0 + 1e-6) & (w.t + 0.2 < 2.0 - 1e-6)
    np.testing.assert_array_equal(inside, expected)


def test_too_short_windows_and_logs_are_refused() -> None:
    """Too few rows in a window, no room for one, and a length of zero are one line each."""
    with pytest.raises(InputError, match=r"expected at least 7 rows in 0\.1 s, got 5"):
        windows(COARSE, 0.1)
    with pytest.raises(InputError, match="expected a stretch of 60 s without a gap"):
        windows(EVEN, 60.0)
    with pytest.raises(InputError, match="expected a length above 0 s"):
        windows(EVEN, 0.0)


@pytest.mark.parametrize("make", [windows, hann])
def test_a_constant_and_a_slope_stay(make: Callable[[np.ndarray, float], Rows]) -> None:
    """The mean of a constant is the constant, that of a slope the slope at the middle of the row."""
    rows = make(EVEN, 0.3)

    np.testing.assert_allclose(rows.mean(np.full_like(EVEN, 7.0)), 7.0, rtol=1e-12)
    np.testing.assert_allclose(rows.mean(2.0 + 3.0 * EVEN), 2.0 + 3.0 * rows.t, rtol=1e-12)


def test_both_windows_tend_to_the_sample_as_they_get_short() -> None:
    """The mean of a sine leaves it by its curvature times half the window's variance: as length squared."""
    t = np.arange(0.0, 2.0, 1e-4)
    # Variances of the Hann weight and of (1 - s^2)^4, for a window of length one.
    of_hann = 1.0 / 12.0 - 1.0 / (2.0 * math.pi**2)
    bump = lambda k: quad(lambda s: s**k * (1.0 - s * s) ** 4, -1.0, 1.0)[0]  # noqa: E731
    for make, variance in ((hann, of_hann), (windows, bump(2) / bump(0) / 4.0)):
        rows = make(t, 0.01)
        expected = -(5.0**2) * np.sin(5.0 * rows.t) * variance * 0.01**2 / 2.0

        np.testing.assert_allclose(rows.mean(np.sin(5.0 * t)) - np.sin(5.0 * rows.t), expected, atol=2e-6)


def test_the_acceleration_by_parts_is_the_mean_of_the_acceleration() -> None:
    """What is integrated by parts from an angle is what the same window makes of its second derivative."""
    rows = windows(np.arange(0.0, 8.0, 0.01), 0.4)
    t = np.arange(0.0, 8.0, 0.01)
    x = np.sin(3.0 * t) + 0.2 * t**3
    second = -9.0 * np.sin(3.0 * t) + 1.2 * t

    np.testing.assert_allclose(second_rate(rows, x), rows.mean(second), atol=2e-4)


def test_a_hann_window_of_one_sample_is_the_sample() -> None:
    """At a length of two steps the window has weight on its centre only, and rows are samples."""
    rows = hann(EVEN, 0.008)

    np.testing.assert_array_equal(EVEN, rows.t)
    np.testing.assert_array_equal(np.sin(EVEN), rows.mean(np.sin(EVEN)))


def test_white_noise_is_reduced_by_the_gain_of_the_row() -> None:
    """The RMS of averaged white noise is the gain that the rows state, and samples keep theirs."""
    noise = np.random.default_rng(0).standard_normal(200_000)
    t = 0.004 * np.arange(len(noise))
    rows = hann(t, 0.064)
    as_they_are = dataclasses.replace(rows, operator=None)

    np.testing.assert_allclose(rows.mean(noise).std(), rows.noise_gain()[0], rtol=0.02)
    np.testing.assert_array_equal(np.ones(len(rows)), as_they_are.noise_gain())


def test_a_low_pass_before_the_mean_reduces_white_noise_further() -> None:
    """The gain of filtered rows is the RMS that noise has after filter and mean, with and without windows."""
    noise = np.random.default_rng(1).standard_normal(200_000)
    t, one = np.arange(len(noise), dtype=float) * 0.004, np.zeros(len(noise), dtype=int)
    low_pass = low_pass_of(t, one, 15.0)

    for rows in (hann(t, 0.064), dataclasses.replace(hann(t, 0.064), operator=None, t=t)):
        filtered = dataclasses.replace(rows, smooth=low_pass)

        np.testing.assert_allclose(filtered.mean(noise).std(), filtered.noise_gain()[0], rtol=0.02)


def test_the_noise_of_a_row_is_that_of_averaged_samples() -> None:
    """White noise, and its opposite, remain in a mean with the RMS of the means."""
    noise = np.random.default_rng(7).standard_normal(40_000)
    rows = hann(0.004 * np.arange(len(noise)), 0.064)
    expected = rows.mean(noise).std()

    assert expected == pytest.approx(balances._row_noise(noise, rows), rel=0.05)
    assert expected == pytest.approx(balances._row_noise(-noise, rows), rel=0.05)


def test_the_noise_of_a_sensor_is_found_under_a_smooth_signal() -> None:
    """Fourth differences leave of a slow sine nothing, of white noise its standard deviation."""
    t = np.arange(0.0, 40.0, 0.002)
    noise = 0.01 * np.random.default_rng(5).standard_normal(len(t))
    jump = np.where(t < 20.0, 0.0, 50.0)
    segment = (t >= 20.0).astype(np.int64)

    assert white_noise(np.sin(t) + noise) == pytest.approx(0.01, rel=0.03)
    assert white_noise(np.sin(t) + noise + jump, segment) == pytest.approx(0.01, rel=0.03)
    assert white_noise(np.where(t < 1.0, np.nan, noise)) == pytest.approx(0.01, rel=0.03)


def test_what_a_speed_loop_makes_of_quanta_is_not_white() -> None:
    """Differences of white noise, as of counts, cancel in means: of eight samples an eighth of their squares.

    Their fourth difference is the fifth of white noise, whose squares sum to 252 and not to twice 70.
    """
    white = np.random.default_rng(6).standard_normal(40_001)
    differences = np.diff(white) / np.sqrt(2.0)

    assert white_noise(differences) == pytest.approx(np.sqrt(252.0 / 140.0 / 8.0), rel=0.05)
    assert white_noise(white) == pytest.approx(1.0, rel=0.03)


def test_blocks_are_stretches_of_a_second_within_a_stretch() -> None:
    """Rows closer than a second that no gap parts share a block; those across a gap never do."""
    t = np.concatenate([EVEN, EVEN + 3.999])
    rows = hann(t, 0.1, np.repeat([0, 1], len(EVEN)))
    parts = [(rows.t < 4.0), (rows.t >= 4.0)]

    assert rows.block[0] == 0
    assert set(np.diff(rows.block)) == {0, 1}
    for block in np.unique(rows.block):
        assert np.ptp(rows.t[rows.block == block]) <= BLOCK_S
    assert not set(rows.block[parts[0]]) & set(rows.block[parts[1]])


def test_parts_are_joined_in_the_order_of_the_log() -> None:
    """Rows to fit on and rows held out, put together, follow each other in time and keep their means."""
    middle = (EVEN > 1.5) & (EVEN < 2.5)
    none = np.zeros(len(EVEN), dtype=np.int64)
    parts = {
        part: hann_windows(EVEN, mask, none, none, 0.1).for_part(part)
        for part, mask in (("train", ~middle), ("score", middle))
    }
    rows = in_order(list(parts.values()))

    assert len(rows) == len(parts["train"]) + len(parts["score"])
    assert np.all(np.diff(rows.t) > 0.0)
    np.testing.assert_array_equal(rows.score, ~rows.train)
    np.testing.assert_array_equal((rows.t > 1.5) & (rows.t < 2.5), rows.score)
    np.testing.assert_allclose(rows.mean(EVEN), rows.t, rtol=1e-12)
    assert not set(rows.block[rows.train]) & set(rows.block[rows.score])


def test_chosen_rows_keep_their_means() -> None:
    """Every other row, by numbers or by a mask, is the same mean as before, its second rate too."""
    rows = windows(EVEN, 0.3)
    mask = np.arange(len(rows)) % 2 == 0
    x = np.cos(EVEN)
    for kept in (rows.chosen(mask), rows.chosen(np.flatnonzero(mask))):
        np.testing.assert_array_equal(rows.mean(x)[mask], kept.mean(x))
        np.testing.assert_array_equal(second_rate(rows, x)[mask], second_rate(kept, x))


def test_a_low_pass_stops_at_gaps_and_leaves_short_stretches_alone() -> None:
    """Each long stretch is what `filtfilt` makes of it by itself, at its own sampling rate."""
    lengths, steps = (400, 20, 300), (0.004, 0.004, 0.002)
    t = np.concatenate(
        [np.arange(n, dtype=float) * h + 10.0 * k for k, n, h in zip(range(3), lengths, steps, strict=True)]
    )
    segment = np.repeat(np.arange(3), lengths)
    x = np.random.default_rng(2).standard_normal((720, 2))

    found = low_pass_of(t, segment, 15.0)(x)

    for number, step in ((0, 0.004), (2, 0.002)):
        rows = segment == number
        expected = signal.filtfilt(*signal.butter(2, 15.0, fs=1.0 / step), x[rows], axis=0)
        np.testing.assert_allclose(found[rows], expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(x[segment == 1], found[segment == 1])


@pytest.mark.parametrize(
    ("off", "expected"), [(0.0, True), (0.3e-3, True), (0.6e-3, False), (-0.6e-3, False)]
)
def test_time_stamps_are_even_within_a_tenth_of_a_step(off: float, expected: bool) -> None:
    """At 250 Hz 0.4 ms: one of a thousand may be off by 0.3 ms, and not by 0.6 ms."""
    t = 3.0 + 0.004 * np.arange(1000.0)
    t[500] += off

    assert expected == is_even(t)


@pytest.mark.parametrize(("off", "on_grid"), [(0.3e-3, True), (0.6e-3, False)])
def test_stamps_may_lack_rows_of_their_grid(off: float, on_grid: bool) -> None:
    """Of a thousand rows at 250 Hz one is missing, then three: places are known if stamps are on a grid."""
    kept = np.delete(np.arange(1000), [100, 400, 401, 402])
    t = 3.0 + 0.004 * kept.astype(float)
    t[700] += off

    found = places_of(t)

    assert on_grid == (found is not None)
    if found is not None:
        np.testing.assert_array_equal(found, kept)


def test_a_low_pass_fills_missing_rows_in() -> None:
    """A signal without two of its rows is filtered as if they were on the line between those beside."""
    kept = np.delete(np.arange(400), [150, 151])
    x = np.random.default_rng(3).standard_normal((400, 2))
    x[150:152] = x[149] + np.outer([1.0, 2.0], x[152] - x[149]) / 3.0

    found = low_pass_of(0.004 * kept.astype(float), np.zeros(len(kept), np.int64), 15.0)(x[kept])

    expected = signal.filtfilt(*signal.butter(2, 15.0, fs=250.0), x, axis=0)
    np.testing.assert_allclose(found, expected[kept], rtol=1e-9, atol=1e-9)
