"""What a row's value stands for: closed forms of a sine, and fits to an exact motion."""

from __future__ import annotations

import numpy as np
import pytest

import eccentric
from eccentric.core import InputError
from eccentric.logs import Log
from eccentric.rigs import read_rig
from eccentric.signals import read_channels, read_table
from eccentric.signals.motion import of_the_motor
from eccentric.signals.rows import SampledCurrent, at_the_times, sampled_current
from tests import first_order_drive
from tests.first_order_drive import RIG, A, advanced, log


@pytest.mark.parametrize("wave", [0.05, 0.2, 0.5])
@pytest.mark.parametrize("kind", ["held", "mean"])
def test_a_row_that_lasts_is_read_in_its_middle(kind: str, wave: float) -> None:
    """A sine of this wave number per row, held or averaged over the rows, has its own phase again.

    Held for a row, exp(iwk) has the component sin(w/2)/(w/2) exp(-iw/2) at its own frequency; the mean over a
    row has the same factor with the opposite phase.
    """
    k = np.arange(400.0)
    size = np.sinc(wave / (2.0 * np.pi))
    values, expected = np.cos(wave * k), size * np.cos(wave * (k - 0.5))
    if kind == "mean":
        values, expected = size * np.cos(wave * (k + 0.5)), np.cos(wave * k)
    found = at_the_times(values, kind, 0.02 * k, np.zeros(400, int))
    assert found[3:-3] == pytest.approx(expected[3:-3], abs=0.15 * wave**4)


def test_uneven_rows_are_weighted_by_how_long_they_last() -> None:
    """A row of three times the length takes part in the mean at its ends with three times the weight."""
    t, x = np.array([0.0, 1.0, 4.0, 5.0]), np.array([0.0, 8.0, 0.0, 0.0])
    found = at_the_times(x, "held", t, np.zeros(4, int))
    curvature = np.array([8.0, -8.0, -8.0, 8.0]) / 24.0
    assert found + curvature == pytest.approx([0.0, 6.0, 6.0, 0.0])


def test_means_of_uneven_rows_are_read_at_their_times() -> None:
    """Means of a cosine over rows of uneven length: nearer the cosine than the mean of two rows alike is."""
    t = np.cumsum(0.02 * (1.0 + 0.4 * np.random.default_rng(4).uniform(-1.0, 1.0, 400)))
    ends, w = np.append(t, t[-1] + 0.02), np.pi
    means = np.diff(np.sin(w * ends)) / (w * np.diff(ends))
    found = at_the_times(means, "mean", t, np.zeros(400, int))[3:-3]
    alike = 0.5 * (means + np.r_[means[0], means[:-1]])[3:-3]
    error, plain = (np.sqrt(np.mean((x - np.cos(w * t[3:-3])) ** 2)) for x in (found, alike))
    assert error < 0.3 * plain


def test_a_drive_that_is_nothing_is_refused_by_name() -> None:
    """A coarse log whose voltage is 0 throughout: the message is that of any other log."""
    still = log(25.0, held=True, seed=0) | {"voltage_V": np.zeros(1501)}
    with pytest.raises(InputError, match="expected a voltage that drives the motor, got 0"):
        read_channels([table(still)], read_rig(RIG))


def test_no_row_reaches_across_a_gap() -> None:
    """The value before a gap does not act after it."""
    x = np.array([5.0, 5.0, 5.0, -5.0, -5.0, -5.0])
    found = at_the_times(x, "held", np.array([0.0, 1, 2, 10, 11, 12]), np.array([0, 0, 0, 1, 1, 1]))
    assert x.tolist() == found.tolist()


@pytest.mark.parametrize("rate_hz", [25.0, 50.0, 100.0])
@pytest.mark.parametrize("held", [True, False])
def test_the_inertia_is_right_at_coarse_rates(rate_hz: float, held: bool) -> None:
    """A voltage that is held, and one that ramps, without a word in the rig: J R/k_i to 0.3 %."""
    found = [eccentric.fit(log(rate_hz, held, seed), RIG).estimates["J*R/k_i"].value for seed in (1, 2)]
    assert pytest.approx(A, rel=3e-3) == np.mean(found)


CURRENT = {"drive": "current", "known": RIG["known"] | {"k_i": "1 N m/A"}}


@pytest.mark.parametrize("late", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("rate_hz", [10.0, 20.0])
def test_the_inertia_is_right_by_a_current_behind_a_hold(rate_hz: float, late: float) -> None:
    """Sampled at the start, in the middle or at the end of a row: 1 % where half a row would be 4 and 9 %."""
    found = [eccentric.fit(log(rate_hz, True, seed, late=late), CURRENT).estimates["J"] for seed in (1, 2)]
    assert pytest.approx(A, rel=1e-2) == np.mean([one.value for one in found])


@pytest.mark.parametrize("late", [0.0, 0.5, 1.0])
@pytest.mark.parametrize(("rate_hz", "held"), [(10.0, True), (10.0, False), (50.0, True), (50.0, False)])
def test_the_circuit_shows_when_a_current_was_sampled(rate_hz: float, held: bool, late: float) -> None:
    """Within four standard errors, which are a small part of the row; k_e/R as it is."""
    found = instant(log(rate_hz, held, 12, late=late), held)
    assert found.late_s * rate_hz == pytest.approx(late, abs=4.0 * found.error_s * rate_hz)
    assert found.error_s * rate_hz < 0.1
    assert found.slope == pytest.approx(-1.0, rel=0.03)


def test_the_error_of_the_instant_is_that_of_many_logs() -> None:
    """Twelve logs: the errors in standard errors have an RMS of about one."""
    every = [instant(log(25.0, True, seed, late=0.5), held=True) for seed in range(12)]
    off = np.array([(found.late_s - 0.02) / found.error_s for found in every])
    assert 0.5 < np.sqrt(np.mean(off**2)) < 1.6


@pytest.mark.parametrize("held", [True, False])
@pytest.mark.parametrize(("rate_hz", "late"), [(50.0, 0.5), (100.0, 1.0), (250.0, 1.0)])
def test_the_inertia_is_right_whenever_a_current_was_sampled(rate_hz: float, late: float, held: bool) -> None:
    """The mean of two fits is in the mean of their intervals; shorter rows need the kind of the voltage."""
    rig = CURRENT if rate_hz < 250.0 else CURRENT | {"kinds": {"voltage": "held" if held else "sample"}}
    found = [eccentric.fit(log(rate_hz, held, seed, late=late), rig).estimates["J"] for seed in (1, 2)]
    low, high = np.mean([one.interval for one in found], axis=0)
    assert low < A < high
    assert high - low < 0.03 * A


@pytest.mark.parametrize("late", [0.0, 1.0])
def test_an_instant_that_the_circuit_leaves_open_is_in_the_interval(
    late: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without friction, nothing tells R from the instant: k_i k_e h/(2 R) to either side."""
    monkeypatch.setattr(first_order_drive, "C", 0.0)
    found = eccentric.fit(log(20.0, True, 2, late=late), CURRENT)
    low, high = found.estimates["J"].interval
    assert low < A < high
    assert 0.05 < high - low < 0.08
    assert any("the current was sampled at 50 +- 29 % of its row" in one for one in found.warnings)


@pytest.mark.parametrize("late", [0.0, 0.5, 1.0])
def test_a_held_current_without_a_voltage_may_fall_with_the_speed(late: float) -> None:
    """The fit says so; with R and k_e, the interval contains what that would change."""
    logged = {name: x for name, x in log(20.0, True, 1, late=late).items() if name != "voltage_V"}
    plain = eccentric.fit(logged, CURRENT)
    known = CURRENT | {"known": CURRENT["known"] | {"R": "1 ohm", "k_e": "1 V s/rad"}}
    low, high = eccentric.fit(logged, known).estimates["J"].interval
    assert any("is wrong by up to k_i k_e h/(2 R), h = 0.05 s" in one for one in plain.warnings)
    assert low < A < high
    assert 0.05 < high - low < 0.08


def test_a_current_loop_is_declared() -> None:
    """The voltage of a current that a loop holds looks the same in the log; the rig tells them apart."""
    held = log(20.0, True, 3)
    w = np.gradient(held["theta_m_rad"], held["time_s"])
    logged = held | {"current_A": held["voltage_V"], "voltage_V": held["voltage_V"] + w}
    found = eccentric.fit(logged, CURRENT | {"kinds": {"current": "held"}}).estimates["J"]
    assert found.value == pytest.approx(A, rel=3e-3)


def test_the_current_of_a_fine_log_is_a_sample() -> None:
    """At 250 rows a second nothing is guessed unless the rig has the kind of the voltage."""
    logged = table(log(250.0, True, 1, late=1.0, seconds=20.0))
    assert read_channels([logged], read_rig(CURRENT)).later is None
    assert read_channels([logged], read_rig(CURRENT | {"kinds": {"voltage": "held"}})).later is not None


@pytest.mark.slow
@pytest.mark.parametrize("rate_hz", [10.0, 25.0, 50.0, 100.0, 250.0, 1000.0])
def test_intervals_cover_the_inertia(rate_hz: float) -> None:
    """Held and ramping, by voltage and by a current at the start, middle and end of a row.

    Twenty logs each; eight of fine ones, which take longer.
    The bias is below a tenth of the intervals' width, up to two standard errors of its own, and the intervals
    of a rate cover the inertia. At 10 rows a second friction turns between two rows: see the reference.
    """
    covered: list[bool] = []
    count = 20 if rate_hz <= 100.0 else 8
    for held in (True, False):
        kinds = {"kinds": {"voltage": "held" if held else "sample"}} if rate_hz > 100.0 else {}
        for late in (None, 0.0, 0.5, 1.0):
            name, rig = ("J*R/k_i", RIG) if late is None else ("J", CURRENT)
            logs = [log(rate_hz, held, seed, late=late) for seed in range(count)]
            fits = [eccentric.fit(one, rig | kinds).estimates[name] for one in logs]
            off = np.array([one.value for one in fits]) - A
            low, high = np.array([one.interval for one in fits]).T
            covered += (own := list((low <= A) & (high >= A)))
            # At 95 %, fewer than 14 of 20 have odds of 3 in 100,000, fewer than 6 of 8 of 6 in 1,000.
            assert rate_hz < 25.0 or sum(own) >= 0.7 * count, (held, late, own)
            limit = 0.1 * np.mean(high - low) + 2.0 * np.std(off) / np.sqrt(len(off))
            assert abs(off.mean()) < (6e-3 * A if rate_hz < 25.0 else limit), (held, late, off.mean())
    assert rate_hz < 25.0 or np.mean(covered) > 0.88


@pytest.mark.parametrize("late", [0.0, 0.5, 1.0])
def test_a_current_alone_does_not_show_when_it_was_sampled(late: float) -> None:
    """Without the voltage, a current that falls with the speed may be that of a speed controller."""
    logged = {n: x for n, x in log(20.0, True, 1, late=late).items() if n != "voltage_V"}
    said = read_channels([table(logged)], read_rig(CURRENT)).intake.warnings
    assert [False] * len(said) == ["by the circuit" in one for one in said]


@pytest.mark.parametrize(("rate_hz", "gain"), [(20.0, 3.0), (50.0, 3.0)])
def test_the_inertia_is_right_by_a_current_that_a_controller_holds(rate_hz: float, gain: float) -> None:
    """The current of a row is gain (reference - w) at its start."""
    rng, dt = np.random.default_rng(3), 1.0 / rate_hz
    n, every = int(60 * rate_hz), round(0.7 * rate_hz)
    reference = np.repeat(rng.uniform(-6.0, 6.0, n // every + 1), every)[:n]
    theta, w, angles, current = 0.0, 0.0, np.empty(n), np.empty(n)
    for k in range(n):
        angles[k], current[k] = theta, gain * (reference[k] - w)
        theta, w = advanced(theta, w, current[k], 0.0, dt)
    noisy = angles + 2e-4 * rng.standard_normal(n)
    logged = {"time_s": np.arange(n) * dt, "theta_m_rad": noisy, "current_A": current}

    assert pytest.approx(A, rel=1e-2) == eccentric.fit(logged, CURRENT).estimates["J"].value


def test_a_current_of_a_ramp_is_not_behind_a_hold() -> None:
    """A voltage that ramps makes no jumps."""
    said = read_channels([table(log(20.0, False, 1, late=0.0))], read_rig(CURRENT)).intake.warnings
    assert not any("by the circuit" in one for one in said)


def test_a_hold_is_reported_and_can_be_denied() -> None:
    """A coarse log that shows it says so; with the kind in the rig nothing is guessed."""
    held = log(25.0, held=True, seed=3)
    said = [w for w in read_channels([table(held)], read_rig(RIG)).intake.warnings if "held" in w]
    assert len(said) == 1
    assert "the voltage is held from row to row, 0.04 s each" in said[0]
    for kind in ("held", "sample", "mean"):
        rig = read_rig(RIG | {"kinds": {"voltage": kind}})
        assert not [w for w in read_channels([table(held)], rig).intake.warnings if "held" in w]


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("noise_rad", [1e-4, 5e-3])
def test_a_ramp_is_not_taken_for_a_hold(noise_rad: float, seed: int) -> None:
    """Samples of a continuous voltage: no hold is found, however noisy the angle."""
    ramp = log(25.0, held=False, seed=seed, noise_rad=noise_rad)
    assert not [w for w in read_channels([table(ramp)], read_rig(RIG)).intake.warnings if "held" in w]


@pytest.mark.parametrize(
    ("kinds", "message"),
    [
        (
            {"voltage": "latched"},
            "rig: [kinds] voltage: expected one of sample, mean, held, got 'latched'",
        ),
        ({"theta_m": "held"}, "rig: [kinds]: unknown key 'theta_m'"),
        ({"current": "held"}, "rig: [kinds] current: expected a channel of [columns], got none"),
    ],
)
def test_other_kinds_are_refused(kinds: dict[str, str], message: str) -> None:
    """A kind that is none, and a channel that has none."""
    with pytest.raises(InputError) as error:
        read_rig(RIG | {"kinds": kinds, "columns": ["time_s", "theta_m_rad", "voltage_V"]})
    assert message in str(error.value)


def table(columns: dict[str, np.ndarray]) -> Log:
    """A log in memory."""
    return Log("log", columns, len(columns["time_s"]))


def instant(columns: dict[str, np.ndarray], held: bool) -> SampledCurrent:
    """When in its row the current of a log was sampled."""
    rig = read_rig(CURRENT)
    read, _ = of_the_motor(read_table([table(columns)], rig), rig)
    step = float(columns["time_s"][1])
    found = sampled_current(read, read, held, 0.1, np.inf, step)
    assert found is not None
    return found
