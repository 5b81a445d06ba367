"""Windowed integrals give mean and second rate without differentiating."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from eccentric.errors import InputError
from eccentric.signals.weak import windows

RNG = np.random.default_rng(3)
EVEN = np.arange(0.0, 4.0, 0.004)
COARSE = np.arange(0.0, 20.0, 0.025)
UNEVEN = np.cumsum(RNG.uniform(0.003, 0.007, 800))
GRIDS = {"even": EVEN, "coarse": COARSE, "uneven": UNEVEN}


def one_stretch(t: np.ndarray) -> np.ndarray:
    """Return the numbers of a log without gap."""
    return np.zeros(len(t), dtype=np.int64)


@pytest.mark.parametrize("grid", GRIDS)
def test_parabola_is_exact_at_any_sampling(grid: str) -> None:
    """Of a parabola, the second rate is exact, however large the constant and uneven the sampling."""
    t = GRIDS[grid]
    w = windows(t, one_stretch(t), 0.4)
    x = 1000.0 + 3.0 * t + 2.0 * t**2
    np.testing.assert_allclose(w.mean(np.ones_like(t)), 1.0, rtol=1e-12)
    np.testing.assert_allclose(w.second_rate(x), 4.0, rtol=1e-6)


def sinusoid_errors(step: float) -> list[float]:
    """Return the largest errors of mean and second rate of a sine, against the transform of psi."""
    t, half, omega = np.arange(0.0, 8.0 + step / 2.0, step), 0.2, 9.0
    w = windows(t, one_stretch(t), 2.0 * half)
    area = quad(lambda s: (1.0 - s * s) ** 4, -1.0, 1.0)[0]
    gain = quad(lambda s: (1.0 - s * s) ** 4 * np.cos(omega * half * s), -1.0, 1.0)[0] / area
    x, sine = np.sin(omega * t), np.sin(omega * w.t)
    pairs = (
        (w.mean(x), gain * sine),
        (w.second_rate(x), -gain * omega**2 * sine),
    )
    return [float(np.max(np.abs(actual - expected))) for actual, expected in pairs]


def test_sinusoid_has_the_closed_form() -> None:
    """On a sine, both converge to the closed form with the orders of Euler and Maclaurin: 6 and 4."""
    coarse, fine = sinusoid_errors(0.025), sinusoid_errors(0.0125)
    orders = [round(float(np.log2(a / b))) for a, b in zip(coarse, fine, strict=True)]
    assert orders == [6, 4]


def test_matrix_of_columns_is_averaged_column_by_column() -> None:
    """The mean of a matrix (n, k) is the matrix (m, k) of the means."""
    w = windows(EVEN, one_stretch(EVEN), 0.3)
    columns = np.stack([EVEN, np.cos(EVEN)], axis=1)
    np.testing.assert_array_equal(w.mean(columns)[:, 1], w.mean(np.cos(EVEN)))


def test_no_window_crosses_a_gap() -> None:
    """A jump of the angle across a gap leaves no trace in any window."""
    t = np.concatenate([EVEN, EVEN + 10.0])
    segment = np.repeat([0, 1], len(EVEN))
    w = windows(t, segment, 0.3)
    np.testing.assert_allclose(w.second_rate(np.where(segment == 0, 0.0, 500.0)), 0.0, atol=1e-6)
    assert np.all((w.t < 4.0) | (w.t > 10.0))


def test_inside_means_every_row() -> None:
    """A window is inside a mask where all its rows are."""
    w = windows(EVEN, one_stretch(EVEN), 0.4)
    inside = w.inside((EVEN > 1.0) & (EVEN < 2.0))
    expected = (w.t - 0.2 > 1.0 + 1e-6) & (w.t + 0.2 < 2.0 - 1e-6)
    np.testing.assert_array_equal(inside, expected)


def test_too_short_windows_and_logs_are_refused() -> None:
    """Too few rows in a window, no room for one, and a length of zero are one line each."""
    with pytest.raises(InputError, match=r"7 rows in 0\.1 s are required, received 5"):
        windows(COARSE, one_stretch(COARSE), 0.1)
    with pytest.raises(InputError, match="a stretch of 60 s without gap is required"):
        windows(EVEN, one_stretch(EVEN), 60.0)
    with pytest.raises(InputError, match="above 0 s is required"):
        windows(EVEN, one_stretch(EVEN), 0.0)
