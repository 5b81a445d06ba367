"""Logs and a rig become signals in SI on the motor side: masks, coarse logs, errors that were published."""

from __future__ import annotations

import math
from operator import attrgetter
from pathlib import Path

import numpy as np
import pytest

from eccentric.rigs import Alignment, read_rig
from eccentric.signals import Channels, fit_rows, read_channels
from tests.logged import (
    MAPPED,
    PHASE,
    RATE,
    RIG,
    RIGS,
    SHARED,
    STANDARD,
    SWING,
    T,
    channels_of,
    log_file,
    needs_shared,
    rig_file,
)


def test_sinusoid_passes_with_the_gain_of_the_filter_and_without_phase(tmp_path: Path) -> None:
    """A slow sine and its derivatives are scaled by |H|^2, and by nothing else."""
    c = channels_of(tmp_path, STANDARD)
    middle = (c.time.t > 2.0) & (c.time.t < 10.0)
    warped = math.tan(math.pi * 0.5 / RATE) / math.tan(math.pi * 25.0 / RATE)
    amplitude = 8.0 / (1.0 + warped**4)
    sine, cosine = np.sin(SWING * T + PHASE), np.cos(SWING * T + PHASE)
    np.testing.assert_allclose(c.motion.theta_m[middle], amplitude * sine[middle], atol=1e-9)
    np.testing.assert_allclose(c.motion.omega_m[middle], amplitude * SWING * cosine[middle], atol=1e-7)
    np.testing.assert_allclose(c.motion.alpha_m[middle], -amplitude * SWING**2 * sine[middle], atol=1e-5)


def test_units_sides_and_arithmetic_do_not_matter(tmp_path: Path) -> None:
    """The same motion logged at the link, in other units and as arithmetic gives the same channels."""
    expected = channels_of(tmp_path, STANDARD)
    other = {
        "ms": T * 1e3,
        "link (deg)": np.degrees(STANDARD["theta_m_rad"] * 0.2),
        "duty": STANDARD["voltage_V"] / 24.0 * 885.0,
        "supply": np.full_like(T, 24.0),
        "I": STANDARD["current_A"] * 1e3,
        "T": np.full_like(T, 300.0),
        "note": ["fine"] * len(T),
    }
    columns = """
[columns]
time = { column = "ms", unit = "ms" }
theta_l = { column = "link (deg)", unit = "deg" }
voltage = "duty / 885 * supply"
current = { column = "I", unit = "mA" }
temperature = { column = "T", unit = "K" }
"""
    actual = read_channels([log_file(tmp_path / "other.csv", other)], rig_file(tmp_path, RIG + columns))
    for name in ("time.t", "motion.theta_m", "motion.omega_m", "motor.voltage", "motor.current"):
        signal = attrgetter(name)
        np.testing.assert_allclose(signal(actual), signal(expected), rtol=1e-9, atol=1e-7)
    assert actual.temperature == pytest.approx(26.85)
    np.testing.assert_array_equal(actual.selection.usable, expected.selection.usable)


def test_link_torque_and_speed_come_to_the_motor_side(tmp_path: Path) -> None:
    """A torque at the link counts mu times at the motor, a speed at the link 1/mu times."""
    log = {"time_s": T, "omega_l_rad_s": 2.0 + np.sin(T), "torque_l_Nm": np.cos(T)}
    c = channels_of(tmp_path, log)
    assert c.motor.torque is not None
    np.testing.assert_allclose(c.motor.torque, 0.2 * np.cos(T), rtol=1e-12)
    middle = (c.time.t > 1.0) & (c.time.t < 11.0)
    np.testing.assert_allclose(c.motion.omega_m[middle], 5.0 * (2.0 + np.sin(T[middle])), rtol=1e-4)
    # The angle is the integral of the speed from 0: 5 (2 t + 1 - cos t).
    np.testing.assert_allclose(c.motion.theta_logged, 5.0 * (2.0 * T + 1.0 - np.cos(T)), atol=1e-4)
    assert any("integral of the speed" in warning for warning in c.intake.warnings)
    assert c.motor.measured_by == "torque"


def test_masks_follow_the_reference_definition_row_by_row(tmp_path: Path) -> None:
    """Usable and scored rows are those that the README of the shared examples defines, applied row by row."""
    theta = 3.0 * np.sin(2.1 * T) + 0.4 * np.sin(13.0 * T) + 0.02 * np.sin(200.0 * T)
    rig = "moving_threshold_rad_s = 1.5\nholdout_intervals_s = [[0.2, 3.0], [6.0, 7.5]]\n" + RIG
    c = channels_of(tmp_path, STANDARD | {"theta_m_rad": theta}, rig)
    n, v = len(T), np.full(len(T), np.nan)
    for k in range(5, n - 5):
        v[k] = (theta[k + 5] - theta[k - 5]) / 0.04
    expected = [
        T[0] + 0.5 < T[k] < T[-1] - 0.5
        and abs(v[k]) > 1.5
        and all(np.sign(v[j]) == np.sign(v[k]) for j in range(k - 15, k + 16))
        for k in range(n)
    ]
    np.testing.assert_array_equal(c.selection.usable, expected)
    held_out = ((T >= 0.2) & (T <= 3.0)) | ((T >= 6.0) & (T <= 7.5))
    np.testing.assert_array_equal(c.selection.held_out, held_out)
    np.testing.assert_array_equal(c.selection.score_rows, expected & held_out)
    np.testing.assert_array_equal(c.selection.fit_rows, expected & ~held_out)
    assert c.selection.holdout.intervals_s == ((0.2, 3.0), (6.0, 7.5))
    assert c.counts == {
        "read": n,
        "used": sum(expected),
        "held_out": int(np.sum(expected & held_out)),
        "rejected": 0,
    }


def test_a_gap_and_a_run_end_what_a_filter_sees(tmp_path: Path) -> None:
    """Each stretch of a log with runs or a gap is filtered as if it were a log of its own."""
    alone = channels_of(tmp_path, STANDARD)
    jump = {"theta_m_rad": np.concatenate([STANDARD["theta_m_rad"], STANDARD["theta_m_rad"] + 1000.0])}
    twice = {name: np.concatenate([x, x]) for name, x in STANDARD.items()} | jump
    gap = channels_of(tmp_path, twice | {"time_s": np.concatenate([T, T + 20.0])})
    runs = channels_of(tmp_path, twice | {"run": np.repeat([7.0, 8.0], len(T))})
    assert runs.time.run_names == ("7", "8")
    for c in (gap, runs):
        second = c.time.segment == 1
        assert np.count_nonzero(second) == len(T)
        np.testing.assert_allclose(c.motion.omega_m[second], alone.motion.omega_m, atol=1e-7)
        np.testing.assert_array_equal(c.selection.moving[second], alone.selection.moving)


def test_uneven_sampling_is_resampled_and_said(tmp_path: Path) -> None:
    """At jittering stamps the speed of a slow sine comes out to a per mille, and a warning says how."""
    t = np.cumsum(np.random.default_rng(1).uniform(0.003, 0.007, 3000))
    log = {"time_s": t, "theta_m_rad": 8.0 * np.sin(SWING * t), "current_A": np.ones_like(t)}
    c = channels_of(tmp_path, log)
    usable = c.selection.usable
    expected = 8.0 * SWING * np.cos(SWING * t[usable])
    np.testing.assert_allclose(c.motion.omega_m[usable], expected, atol=0.025)
    assert any("time steps are uneven" in warning for warning in c.intake.warnings)


def test_a_clock_that_drifts_has_no_uneven_steps(tmp_path: Path) -> None:
    """Over the log its stamps leave the even grid by many steps, but no step differs from the next."""
    t = T * (1.0 + 1e-3 * T / T[-1])
    c = channels_of(tmp_path, STANDARD | {"time_s": t})
    assert [] == [warning for warning in c.intake.warnings if "uneven" in warning]


def test_a_row_that_is_missing_is_an_uneven_step_and_a_blank_one_is_told_as_that(tmp_path: Path) -> None:
    """A row that the logger left out is one step of two; of a row without a number it is said, and first."""
    left_out = {name: np.delete(x, 1000) for name, x in STANDARD.items()}
    blank = {name: x.copy() for name, x in STANDARD.items()}
    blank["current_A"][2000] = np.nan
    both = {name: np.delete(x, 1000) for name, x in blank.items()}
    uneven, dropped = (
        "time steps are uneven ({} differ by more than 20 % from the usual 0.004 s)",
        "no number in 1",
    )

    for log, expected in (
        (left_out, [uneven.format("1 of 2998")]),
        (blank, [dropped]),
        (both, [dropped, uneven.format("1 of 2996")]),
    ):
        said = [w for w in channels_of(tmp_path, log).intake.warnings if "uneven" in w or "no number" in w]
        assert len(expected) == len(said)
        assert all(words in line for words, line in zip(expected, said, strict=True))


@pytest.mark.parametrize("count", [1, 3])
def test_missing_rows_change_nothing_far_from_them(count: int, tmp_path: Path) -> None:
    """Cells that are blank, or rows left out, of an encoder's log: 1 s away all signals are the same."""
    steps = np.round(STANDARD["theta_m_rad"] * 4096.0 / (2.0 * math.pi)) * (2.0 * math.pi / 4096.0)
    log = STANDARD | {"time_s": np.round(T + 3.0, 4), "theta_m_rad": steps}
    blank = log | {"current_A": log["current_A"].copy()}
    blank["current_A"][1500 : 1500 + count] = np.nan
    rows = np.delete(np.arange(len(T)), slice(1500, 1500 + count))
    far = np.abs(rows - 1500) > RATE
    whole = channels_of(tmp_path, log)

    for damaged in (blank, {name: x[rows] for name, x in log.items()}):
        c = channels_of(tmp_path, damaged)
        assert np.max(c.time.segment) == 0
        for name, close in (("theta_m", 1e-3), ("omega_m", 0.1), ("alpha_m", 10.0)):
            expected, found = getattr(whole.motion, name)[rows], getattr(c.motion, name)
            np.testing.assert_allclose(found[far], expected[far], rtol=0.0, atol=1e-9)
            np.testing.assert_allclose(found, expected, rtol=0.0, atol=close)
        smooth = whole.smooth(log["current_A"])[rows]
        np.testing.assert_allclose(c.smooth(log["current_A"][rows])[far], smooth[far], rtol=0.0, atol=1e-9)
        np.testing.assert_allclose(c.smooth(log["current_A"][rows]), smooth, rtol=0.0, atol=1e-3)
        np.testing.assert_array_equal(fit_rows(c, c.rig).weights[far], 1.0)


def test_the_default_moving_threshold_is_no_warning(tmp_path: Path) -> None:
    """A good log under a good rig has no warnings, and the threshold is 3 % of the speed's upper end."""
    c = channels_of(tmp_path, STANDARD)
    assert c.intake.warnings == ()
    # The 95th percentile of |cos| is sin(0.95 pi/2).
    expected = 0.03 * 8.0 * SWING * math.sin(0.95 * math.pi / 2.0)
    assert c.selection.moving_threshold_rad_s == pytest.approx(expected, rel=1e-2)


def test_motor_that_is_switched_off_is_told_from_the_driven_rows(tmp_path: Path) -> None:
    """`motor_off` is a condition on columns; rows within 0.1 s of a switching are not used at all."""
    off = (T > 4.0) & (T < 8.0)
    columns = MAPPED + 'current = "current_A"\nmotor_off = "torque == 0"\n'
    c = channels_of(tmp_path, STANDARD | {"torque": np.where(off, 0.0, 1.0)}, RIG + columns)
    everything = channels_of(tmp_path, STANDARD)
    np.testing.assert_array_equal(c.motor.off, off)
    near = (np.abs(T - 4.0) < 0.099) | (np.abs(T - 8.0) < 0.099)
    clear = (np.abs(T - 4.0) > 0.105) & (np.abs(T - 8.0) > 0.105)
    assert not np.any(c.selection.usable & near)
    np.testing.assert_array_equal(c.selection.usable[clear], everything.selection.usable[clear])
    np.testing.assert_array_equal(c.driven.selection.usable, c.selection.usable & ~off)


def test_delay_zero_angle_and_offset(tmp_path: Path) -> None:
    """The rig's delay, zero angle and offset are taken out; realigned to none, the channels are as logged."""
    rig_text = "input_delay_s = 0.1\ntheta_zero_rad = 0.05\nvoltage_offset_V = 0.5\n" + RIG
    plain = channels_of(tmp_path, STANDARD)
    c = channels_of(tmp_path, STANDARD, rig_text)
    assert c.motor.voltage is not None
    late = T >= 0.1
    np.testing.assert_allclose(c.motor.voltage[late], 3.0 * (T[late] - 0.1) - 0.5, atol=1e-9)
    np.testing.assert_allclose(c.motion.theta_m, plain.motion.theta_m - 0.05 / 0.2, atol=1e-12)
    np.testing.assert_array_equal(c.motion.omega_m, plain.motion.omega_m)
    back = c.realigned(read_rig(tmp_path / "rig.toml"), Alignment())
    assert back.motor.voltage is not None
    np.testing.assert_array_equal(back.motor.voltage, STANDARD["voltage_V"])
    np.testing.assert_allclose(back.motion.theta_m, plain.motion.theta_m, atol=1e-12)


SLOW_T = np.arange(0.0, 20.0, 0.025)


def slow(tmp_path: Path, rig: str = RIG) -> Channels:
    """Channels of a slow sine at 40 rows per second, under a voltage that rises in steps."""
    log = {"time_s": SLOW_T, "theta_m_rad": 8.0 * np.sin(SWING * SLOW_T), "voltage_V": 3.0 * SLOW_T}
    return channels_of(tmp_path, log, rig)


def test_slow_sampling_is_refined_by_a_spline_and_said(tmp_path: Path) -> None:
    """At 40 Hz there is no 25 Hz low pass: four points a row, on the sine and its derivatives; it is said."""
    c = slow(tmp_path)
    assert (c.time.points_per_row, c.time.logged_step_s) == (4, pytest.approx(0.025))
    np.testing.assert_allclose(c.time.t, np.arange(4 * len(SLOW_T) - 3) * 0.00625, atol=1e-12)
    middle = (c.time.t > 0.5) & (c.time.t < 19.0)
    sine, cosine = 8.0 * np.sin(SWING * c.time.t[middle]), 8.0 * np.cos(SWING * c.time.t[middle])
    np.testing.assert_allclose(c.motion.theta_m[middle], sine, atol=1e-7)
    np.testing.assert_allclose(c.motion.omega_m[middle], SWING * cosine, atol=1e-5)
    np.testing.assert_allclose(c.motion.alpha_m[middle], -(SWING**2) * sine, atol=1e-3)
    assert any("too coarse for the low-pass filter" in warning for warning in c.intake.warnings)


def test_slow_voltage_is_held_if_the_rig_says_so(tmp_path: Path) -> None:
    """Between two rows a command is that of the first, and at a row it goes halfway to the next."""
    c = slow(tmp_path, RIG.replace("[known]", '[kinds]\nvoltage = "held"\n[known]'))
    assert c.motor.voltage is not None
    np.testing.assert_allclose(c.motor.voltage[10:-10:4], 3.0 * SLOW_T[2:-3])
    np.testing.assert_allclose(c.motor.voltage[8:-8:4], 3.0 * (SLOW_T[2:-2] - 0.0125))


def test_slow_samples_are_joined_by_lines_and_rows_are_counted_as_logged(tmp_path: Path) -> None:
    """A ramp of the voltage stays one; counts are of the log, not of its points."""
    c = slow(tmp_path, "holdout_intervals_s = [[4.0, 8.0]]\n" + RIG)
    assert c.motor.voltage is not None
    np.testing.assert_allclose(c.motor.voltage, 3.0 * c.time.t, atol=1e-12)
    assert c.counts["read"] == len(SLOW_T)
    # 19 s are clear of the ends; of each second with its reversal, 60 ms and some rows are lost either side.
    assert 19 * 40 * (1.0 - 2.0 * 0.1) < c.counts["used"] < 19 * 40 * (1.0 - 2.0 * 0.05)
    assert c.counts["held_out"] == pytest.approx(4.0 / 19.0 * c.counts["used"], abs=4)


def test_slow_sampling_under_a_slower_low_pass_or_average_is_left_alone(tmp_path: Path) -> None:
    """A low pass that 40 Hz allows, or averages that the rig requires, need no points between the rows."""
    for wish in ("low_pass_hz = 8\n", 'average_over = "0.3 s"\n'):
        c = slow(tmp_path, wish + RIG)
        assert (c.time.points_per_row, len(c.time.t)) == (1, len(SLOW_T))


@needs_shared
def test_real_rig_is_read_as_its_readme_says() -> None:
    """The unbalanced disc: 24500 rows, pi/1000 rad per count, speeds up to 19 rad/s, voltage only."""
    rig = read_rig(RIGS / "tue_unbalanced_disc.toml")
    path = SHARED / "measured" / "tue_unbalanced_disc" / "data.csv.gz"
    counts = np.loadtxt(path, delimiter=",", skiprows=1, usecols=3)
    c = read_channels([path], rig)
    assert c.counts["read"] == 24500
    assert (c.time.points_per_row, c.time.logged_step_s) == (4, pytest.approx(0.025))
    assert c.time.run_names == ("2024",)
    assert c.motion.quantum_rad == pytest.approx(math.pi / 1000.0)
    assert c.motor.measured_by == "voltage"
    assert float(np.max(np.abs(c.motion.omega_m))) == pytest.approx(19.0, abs=0.5)
    # Every fourth point is a row of the log.
    np.testing.assert_allclose(c.motion.theta_logged[::4], counts * math.pi / 1000.0, atol=1e-9)
    assert rig.estimate == {"input_delay_s", "theta_zero_rad", "voltage_offset_V"}


PUBLISHED = {1: (0.00720, 0.00165), 2: (0.01768, 0.00598), 3: (0.00198, 0.00198), 4: (0.06651, 0.01152)}


@needs_shared
@pytest.mark.parametrize("number", PUBLISHED)
def test_published_held_out_errors_are_reproduced(number: int) -> None:
    """Least squares on these channels gives the RMSE in the README of the shared examples, to 0.3 %.

    The paper's model is written out here explicitly, once alone and once with the effects of truth.json.
    """
    rig = read_rig(SHARED / "examples" / f"example{number}.json")
    c = read_channels([SHARED / "examples" / f"example{number}.csv.gz"], rig)
    k = rig.known
    mu, w, link = k["mu"], c.motion.omega_m, k["mu"] * c.motion.theta_m
    sign, weight = np.sign(w), k["g"] * (k["M"] + k["M_l"])
    load = k["M"] * k["g"] * k["L"] * np.sin(link) if rig.case == "C2" else np.zeros_like(w)
    pull = k["M"] * k["L"] * (mu * w) ** 2
    normal = np.sqrt(pull**2 + 2.0 * weight * pull * np.cos(link) + weight**2)
    paper = {"C1": [w**3, w * np.abs(w), w, sign], "C2": [normal * w, normal * sign, w, sign]}[rig.case or ""]
    effects = {
        1: [np.exp(-((w / 18.0) ** 2)) * sign],
        2: [np.abs(load) * sign * np.where(load * sign > 0.0, 1.0, 0.35)],
        3: [],
        4: [np.cos(3.0 * link) * sign, np.sin(3.0 * link) * sign, w / (1.0 + (w / 4.0) ** 2)],
    }[number]
    assert c.motor.current is not None
    torque = k["k_i"] * c.motor.current - (k["J_m"] + mu**2 * k["J_l"]) * c.motion.alpha_m - mu * load
    actual = []
    for columns in (paper, paper + effects):
        bases = np.stack(columns, axis=1)
        solution = np.linalg.lstsq(bases[c.selection.fit_rows], torque[c.selection.fit_rows], rcond=None)[0]
        residual = (torque - bases @ solution)[c.selection.score_rows]
        actual.append(float(np.sqrt(np.mean(residual**2))))
    # They were published for central differences, which take a little from the acceleration.
    assert actual == pytest.approx(PUBLISHED[number], rel=0.005)
