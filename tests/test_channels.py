"""Logs and a rig become signals in SI on the motor side, with masks by the reference definition."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from eccentric.errors import InputError
from eccentric.identify.channels import Channels, read_channels
from eccentric.identify.rig import Rig, read_rig

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

SHARED = Path(__file__).parents[1] / ".." / "shared" / "data"
RIGS = Path(__file__).parents[1] / "examples" / "rigs"
needs_shared = pytest.mark.skipif(not SHARED.exists(), reason="the shared logs are not beside this clone")

RATE = 250.0
T = np.arange(0.0, 12.0, 1.0 / RATE)
SWING = 2.0 * math.pi * 0.5
PHASE = 0.3
"""Keeps reversals off the sampling grid, where their side would be a matter of rounding."""
STANDARD = {
    "time_s": T,
    "theta_m_rad": 8.0 * np.sin(SWING * T + PHASE),
    "voltage_V": 3.0 * T,
    "current_A": np.cos(SWING * T),
}
RIG = '[known]\ncase = "C2"\nmu = 0.2\n'


def log_file(path: Path, columns: Mapping[str, Sequence[object] | NDArray[np.float64]]) -> Path:
    """Write columns as a CSV log, numbers to full precision."""
    rows = zip(*columns.values(), strict=True)
    lines = [",".join(columns), *(",".join(str(value) for value in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n")
    return path


def rig_file(tmp_path: Path, text: str = RIG) -> Rig:
    """Write and read a rig."""
    path = tmp_path / "rig.toml"
    path.write_text(text)
    return read_rig(path)


def channels_of(tmp_path: Path, columns: Mapping[str, NDArray[np.float64]], rig: str = RIG) -> Channels:
    """Write a log and a rig and read the channels."""
    return read_channels([log_file(tmp_path / "log.csv", columns)], rig_file(tmp_path, rig))


def test_sinusoid_passes_with_the_gain_of_the_filter_and_without_phase(tmp_path: Path) -> None:
    """A slow sine and its derivatives are scaled by |H|^2 and the central difference, and nothing else."""
    c = channels_of(tmp_path, STANDARD)
    middle = (c.t > 2.0) & (c.t < 10.0)
    warped = math.tan(math.pi * 0.5 / RATE) / math.tan(math.pi * 25.0 / RATE)
    amplitude = 8.0 / (1.0 + warped**4)
    slope = math.sin(SWING / RATE) * RATE
    sine, cosine = np.sin(SWING * T + PHASE), np.cos(SWING * T + PHASE)
    np.testing.assert_allclose(c.theta_m[middle], amplitude * sine[middle], atol=1e-9)
    np.testing.assert_allclose(c.omega_m[middle], amplitude * slope * cosine[middle], atol=1e-7)
    np.testing.assert_allclose(c.alpha_m[middle], -amplitude * slope**2 * sine[middle], atol=1e-5)


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
    for name in ("t", "theta_m", "omega_m", "voltage", "current"):
        np.testing.assert_allclose(getattr(actual, name), getattr(expected, name), rtol=1e-9, atol=1e-7)
    assert actual.temperature == pytest.approx(26.85)
    np.testing.assert_array_equal(actual.usable, expected.usable)


def test_link_torque_and_speed_come_to_the_motor_side(tmp_path: Path) -> None:
    """A torque at the link counts mu times at the motor, a speed at the link 1/mu times."""
    log = {"time_s": T, "omega_l_rad_s": 2.0 + np.sin(T), "torque_l_Nm": np.cos(T)}
    c = channels_of(tmp_path, log)
    assert c.torque is not None
    np.testing.assert_allclose(c.torque, 0.2 * np.cos(T), rtol=1e-12)
    middle = (c.t > 1.0) & (c.t < 11.0)
    np.testing.assert_allclose(c.omega_m[middle], 5.0 * (2.0 + np.sin(T[middle])), rtol=1e-4)
    # The angle is the integral of the speed from 0: 5 (2 t + 1 - cos t).
    np.testing.assert_allclose(c.theta_logged, 5.0 * (2.0 * T + 1.0 - np.cos(T)), atol=1e-4)
    assert any("integral of the speed" in warning for warning in c.warnings)
    assert c.drive == "torque"


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
    np.testing.assert_array_equal(c.usable, expected)
    held_out = ((T >= 0.2) & (T <= 3.0)) | ((T >= 6.0) & (T <= 7.5))
    np.testing.assert_array_equal(c.held_out, held_out)
    np.testing.assert_array_equal(c.score_rows, expected & held_out)
    np.testing.assert_array_equal(c.fit_rows, expected & ~held_out)
    assert c.holdout.intervals_s == ((0.2, 3.0), (6.0, 7.5))
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
    assert runs.run_names == ("7", "8")
    for c in (gap, runs):
        second = c.segment == 1
        assert np.count_nonzero(second) == len(T)
        np.testing.assert_allclose(c.omega_m[second], alone.omega_m, atol=1e-7)
        np.testing.assert_array_equal(c.moving[second], alone.moving)


def test_uneven_sampling_is_resampled_and_said(tmp_path: Path) -> None:
    """At jittering stamps the speed of a slow sine comes out to a per mille, and a warning says how."""
    t = np.cumsum(np.random.default_rng(1).uniform(0.003, 0.007, 3000))
    log = {"time_s": t, "theta_m_rad": 8.0 * np.sin(SWING * t), "current_A": np.ones_like(t)}
    c = channels_of(tmp_path, log)
    np.testing.assert_allclose(c.omega_m[c.usable], 8.0 * SWING * np.cos(SWING * t[c.usable]), atol=0.025)
    assert any("time steps are uneven" in warning for warning in c.warnings)


def test_one_missing_row_is_one_uneven_step(tmp_path: Path) -> None:
    """A blank cell leaves one step of two; the warning counts it and not the rows that are resampled."""
    current = STANDARD["current_A"].copy()
    current[1000] = np.nan
    c = channels_of(tmp_path, STANDARD | {"current_A": current})
    (said,) = (warning for warning in c.warnings if "uneven" in warning)
    assert "(1 of 2998 differ by more than 20% from the usual 0.004 s)" in said


def test_the_default_moving_threshold_is_no_warning(tmp_path: Path) -> None:
    """A good log under a good rig has no warnings, and the threshold is 3 % of the speed's upper end."""
    c = channels_of(tmp_path, STANDARD)
    assert c.warnings == ()
    # The 95th percentile of |cos| is sin(0.95 pi/2).
    expected = 0.03 * 8.0 * SWING * math.sin(0.95 * math.pi / 2.0)
    assert c.moving_threshold_rad_s == pytest.approx(expected, rel=1e-2)


SLOW_T = np.arange(0.0, 20.0, 0.025)


def slow(tmp_path: Path, rig: str = RIG) -> Channels:
    """Channels of a slow sine at 40 rows per second, under a voltage that rises in steps."""
    log = {"time_s": SLOW_T, "theta_m_rad": 8.0 * np.sin(SWING * SLOW_T), "voltage_V": 3.0 * SLOW_T}
    return channels_of(tmp_path, log, rig)


def test_slow_sampling_is_refined_by_a_spline_and_said(tmp_path: Path) -> None:
    """At 40 Hz there is no 25 Hz low pass: two points a row, on the sine and its derivatives; it is said."""
    c = slow(tmp_path)
    assert (c.points_per_row, c.logged_step_s) == (2, pytest.approx(0.025))
    np.testing.assert_allclose(c.t, np.arange(2 * len(SLOW_T) - 1) * 0.0125, atol=1e-12)
    middle = (c.t > 0.5) & (c.t < 19.0)
    sine, cosine = 8.0 * np.sin(SWING * c.t[middle]), 8.0 * np.cos(SWING * c.t[middle])
    np.testing.assert_allclose(c.theta_m[middle], sine, atol=1e-7)
    np.testing.assert_allclose(c.omega_m[middle], SWING * cosine, atol=1e-5)
    np.testing.assert_allclose(c.alpha_m[middle], -(SWING**2) * sine, atol=1e-3)
    assert any("sampled too slowly for the low pass" in warning for warning in c.warnings)


def test_slow_voltage_is_held_and_rows_are_counted_as_logged(tmp_path: Path) -> None:
    """Between two rows a commanded voltage is that of the first; counts are of the log, not of its points."""
    c = slow(tmp_path, "holdout_intervals_s = [[4.0, 8.0]]\n" + RIG)
    assert c.voltage is not None
    np.testing.assert_array_equal(c.voltage[::2], 3.0 * SLOW_T)
    np.testing.assert_array_equal(c.voltage[1::2], 3.0 * SLOW_T[:-1])
    assert c.counts["read"] == len(SLOW_T)
    # 19 s are clear of the ends; of each second with its reversal, 60 ms and some rows are lost either side.
    assert 19 * 40 * (1.0 - 2.0 * 0.1) < c.counts["used"] < 19 * 40 * (1.0 - 2.0 * 0.05)
    assert c.counts["held_out"] == pytest.approx(4.0 / 19.0 * c.counts["used"], abs=4)


def test_slow_sampling_under_a_slower_low_pass_or_average_is_left_alone(tmp_path: Path) -> None:
    """A low pass that 40 Hz allows, or averages that the rig asks for, need no points between the rows."""
    for wish in ("low_pass_hz = 8\n", 'average_over = "0.3 s"\n'):
        c = slow(tmp_path, wish + RIG)
        assert (c.points_per_row, len(c.t)) == (1, len(SLOW_T))


def test_motor_that_is_switched_off_is_told_from_the_driven_rows(tmp_path: Path) -> None:
    """`motor_off` is a condition on columns; rows within 0.1 s of a switching are not used at all."""
    off = (T > 4.0) & (T < 8.0)
    columns = MAPPED + 'current = "current_A"\nmotor_off = "torque == 0"\n'
    c = channels_of(tmp_path, STANDARD | {"torque": np.where(off, 0.0, 1.0)}, RIG + columns)
    everything = channels_of(tmp_path, STANDARD)
    np.testing.assert_array_equal(c.off, off)
    near = (np.abs(T - 4.0) < 0.099) | (np.abs(T - 8.0) < 0.099)
    clear = (np.abs(T - 4.0) > 0.105) & (np.abs(T - 8.0) > 0.105)
    assert not np.any(c.usable & near)
    np.testing.assert_array_equal(c.usable[clear], everything.usable[clear])
    np.testing.assert_array_equal(c.driven.usable, c.usable & ~off)


def test_delay_zero_angle_and_offset(tmp_path: Path) -> None:
    """The rig's delay, zero angle and offset are taken out; realigned to none, the channels are as logged."""
    rig_text = "input_delay_s = 0.1\ntheta_zero_rad = 0.05\nvoltage_offset_V = 0.5\n" + RIG
    plain = channels_of(tmp_path, STANDARD)
    c = channels_of(tmp_path, STANDARD, rig_text)
    assert c.voltage is not None
    late = T >= 0.1
    np.testing.assert_allclose(c.voltage[late], 3.0 * (T[late] - 0.1) - 0.5, atol=1e-9)
    np.testing.assert_allclose(c.theta_m, plain.theta_m - 0.05 / 0.2, atol=1e-12)
    np.testing.assert_array_equal(c.omega_m, plain.omega_m)
    back = c.realigned(
        read_rig(tmp_path / "rig.toml"), input_delay_s=0.0, theta_zero_rad=0.0, voltage_offset_V=0.0
    )
    assert back.voltage is not None
    np.testing.assert_array_equal(back.voltage, STANDARD["voltage_V"])
    np.testing.assert_allclose(back.theta_m, plain.theta_m, atol=1e-12)


def test_default_held_out_part_of_one_run(tmp_path: Path) -> None:
    """One run: five contiguous blocks of equal length, 20 % of the rows."""
    c = channels_of(tmp_path, STANDARD)
    begins = np.count_nonzero(np.diff(c.held_out.astype(int)) == 1)
    assert (begins, len(c.holdout.intervals_s)) == (5, 5)
    assert np.mean(c.held_out) == pytest.approx(0.2, abs=5.0 / len(T))
    assert "five contiguous blocks" in c.holdout.rule.replace("5 ", "five ")


def test_default_held_out_part_of_several_logs(tmp_path: Path) -> None:
    """Three runs or more: whole runs, the third of three; the rule names it."""
    paths = [log_file(tmp_path / f"log{k}.csv", STANDARD) for k in range(3)]
    c = read_channels(paths, rig_file(tmp_path))
    assert c.run_names == ("log0", "log1", "log2")
    np.testing.assert_array_equal(c.held_out, c.run == 2)
    assert c.holdout.rule.endswith("log2")


def test_named_runs_are_held_out(tmp_path: Path) -> None:
    """Runs that the rig names are held out; a name that the log has not is refused with those that it has."""
    log = {name: np.concatenate([x, x]) for name, x in STANDARD.items()} | {
        "run": np.repeat([1.0, 2.0], len(T))
    }
    c = channels_of(tmp_path, log, 'holdout_runs = ["1"]\n' + RIG)
    np.testing.assert_array_equal(c.held_out, c.run == 0)
    with pytest.raises(InputError, match="holdout_runs: one of 1, 2 is required, received '3'"):
        channels_of(tmp_path, log, 'holdout_runs = ["3"]\n' + RIG)


def three_runs() -> dict[str, Sequence[object]]:
    """Three runs with names."""
    log: dict[str, Sequence[object]] = {n: np.concatenate([x] * 3).tolist() for n, x in STANDARD.items()}
    return log | {"run": np.repeat(["slow_1", "slow_2", "fast_1"], len(T)).tolist()}


def test_patterns_choose_the_runs_that_are_read_and_held_out(tmp_path: Path) -> None:
    """`runs` leaves out what no pattern means, `holdout_runs` holds out what one means."""
    log = log_file(tmp_path / "log.csv", three_runs())
    some = read_channels([log], rig_file(tmp_path, 'runs = ["slow_*"]\nholdout_runs = ["*_2"]\n' + RIG))
    assert some.run_names == ("slow_1", "slow_2")
    np.testing.assert_array_equal(some.held_out, some.run == 1)
    assert some.counts["read"] == 2 * len(T)
    two = read_channels([log], rig_file(tmp_path, 'holdout_runs = ["?low_1", "fast_1"]\n' + RIG))
    np.testing.assert_array_equal(two.held_out, two.run != 1)
    assert two.holdout.rule == "runs named by the rig: slow_1, fast_1"


@pytest.mark.parametrize("key", ["runs", "holdout_runs"])
def test_a_pattern_that_no_run_has_is_refused_in_one_line(tmp_path: Path, key: str) -> None:
    """A pattern without a match is refused with the runs of the log."""
    log = log_file(tmp_path / "log.csv", three_runs())
    with pytest.raises(InputError) as caught:
        read_channels([log], rig_file(tmp_path, f'{key} = ["slow_*", "drive?_*"]\n' + RIG))
    message = str(caught.value)
    assert f"{key}: one of slow_1, slow_2, fast_1 is required, received 'drive?_*'" in message
    assert "\n" not in message


def test_rows_by_condition(tmp_path: Path) -> None:
    """Rows that the condition `use` excludes are neither fitted nor scored, and not rejected."""
    c = channels_of(
        tmp_path,
        STANDARD,
        RIG + '[columns]\ntime = "time_s"\ntheta_m = "theta_m_rad"\n'
        'current = "current_A"\nuse = "time_s < 3 or time_s >= 5"\n',
    )
    everything = channels_of(tmp_path, STANDARD)
    np.testing.assert_array_equal(c.usable, everything.usable & ((T < 3.0) | (T >= 5.0)))
    assert c.counts["rejected"] == 0


def test_rows_that_are_not_numbers_are_dropped_counted_and_warned_of(tmp_path: Path) -> None:
    """A tenth of missing currents is dropped with a warning; the rest is as before."""
    current = STANDARD["current_A"].copy()
    missing = np.arange(len(T)) % 10 == 3
    current[missing] = np.nan
    c = channels_of(tmp_path, STANDARD | {"current_A": current})
    assert c.counts["read"] == len(T)
    assert c.counts["rejected"] == np.count_nonzero(missing)
    np.testing.assert_array_equal(c.t, T[~missing])
    assert any("300 of 3000 rows are not numbers (first: line 5; most: 'current_A')" in w for w in c.warnings)


def test_drive_is_what_is_logged_or_what_the_rig_says(tmp_path: Path) -> None:
    """Current goes before torque and voltage, unless the rig says otherwise."""
    assert channels_of(tmp_path, STANDARD).drive == "current"
    assert channels_of(tmp_path, STANDARD, 'drive = "voltage"\n' + RIG).drive == "voltage"
    with pytest.raises(InputError, match=r"drive: one of current, voltage is required.*received 'torque'"):
        channels_of(tmp_path, STANDARD, 'drive = "torque"\n' + RIG)


def changed(**columns: object) -> dict[str, object]:
    """Return the standard log with other columns; None takes one out."""
    log = {**STANDARD, **columns}
    return {name: x for name, x in log.items() if x is not None}


THIRD = np.where(np.arange(len(T)) % 3 == 0, np.nan, STANDARD["current_A"])
BACK = np.where(np.arange(len(T)) == 7, 0.0, T)
TWICE = np.where(np.arange(len(T)) == 7, T[6], T)
TEXT = [*STANDARD["current_A"][:4], "broken", *STANDARD["current_A"][5:]]
SPLIT = np.where((T > 3.0) & (T < 4.0), 1.0, 0.0)
MAPPED = '[columns]\ntime = "time_s"\ntheta_m = "theta_m_rad"\n'
BAD = {
    "no time": (changed(time_s=None), RIG, "a column for time (column 'time_s') is required"),
    "no angle": (changed(theta_m_rad=None), RIG, "a column for theta_m (column 'theta_m_rad') or theta_l"),
    "no drive": (
        changed(voltage_V=None, current_A=None),
        RIG,
        "a column for voltage (column 'voltage_V') or",
    ),
    "column": (
        changed(),
        RIG + MAPPED + 'current = "amps"\n',
        "column 'amps' is required, the log has time_s",
    ),
    "arithmetic": (
        changed(),
        RIG + MAPPED + 'current = "current_A ** 2"\n',
        "[columns] current: 'current_A ** 2'",
    ),
    "condition": (changed(), RIG + MAPPED + 'current = "current_A > 2"\n', "current: a number is required"),
    "text": (
        changed(current_A=TEXT),
        RIG,
        "line 6, column 'current_A': a number is required, received 'broken'",
    ),
    "third": (changed(current_A=THIRD), RIG, "1000 of 3000 rows are not numbers"),
    "back": (changed(time_s=BACK), RIG, "line 9: time stamps must increase, received 0 s after 0.024 s"),
    "twice": (changed(time_s=TWICE), RIG, "line 9: time stamps must increase, received 0.024 s after 0.024"),
    "split": (changed(run=SPLIT), RIG, "the rows of a run must stand together, '0' comes back"),
    "still": (changed(theta_m_rad=0.0 * T), RIG, "moving rows (above"),
    "outside": (changed(), "holdout_intervals_s = [[90.0, 99.0]]\n" + RIG, "required to fit and to hold out"),
    "link": (
        changed(theta_m_rad=None, theta_l_rad=T),
        '[known]\ncase = "C2"\n',
        "[known] mu is required here",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_log_under_a_rig_is_refused_in_one_line(tmp_path: Path, name: str) -> None:
    """What cannot be fitted on is refused with file, row, column, what is required and what came."""
    log, rig, expected = BAD[name]
    with pytest.raises(InputError) as caught:
        channels_of(tmp_path, log, rig)  # pyright: ignore[reportArgumentType]
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)


def test_logs_with_different_channels_are_refused(tmp_path: Path) -> None:
    """Logs read together have the same channels."""
    first = log_file(tmp_path / "a.csv", STANDARD)
    second = log_file(tmp_path / "b.csv", STANDARD | {"temperature_C": T})
    with pytest.raises(InputError, match=r"b\.csv: the same channels in every log are required, temperature"):
        read_channels([first, second], rig_file(tmp_path))


PUBLISHED = {1: (0.00720, 0.00165), 2: (0.01768, 0.00598), 3: (0.00198, 0.00198), 4: (0.06651, 0.01152)}


@needs_shared
@pytest.mark.parametrize("number", PUBLISHED)
def test_published_held_out_errors_are_reproduced(number: int) -> None:
    """Least squares on these channels gives the RMSE in the README of the shared examples, to 0.3 %.

    The paper's model is written out here by hand, once alone and once with the effects of truth.json.
    """
    rig = read_rig(SHARED / "examples" / f"example{number}.json")
    c = read_channels([SHARED / "examples" / f"example{number}.csv.gz"], rig)
    k = rig.known
    mu, w, link = k["mu"], c.omega_m, k["mu"] * c.theta_m
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
    assert c.current is not None
    torque = k["k_i"] * c.current - (k["J_m"] + mu**2 * k["J_l"]) * c.alpha_m - mu * load
    actual = []
    for columns in (paper, paper + effects):
        bases = np.stack(columns, axis=1)
        solution = np.linalg.lstsq(bases[c.fit_rows], torque[c.fit_rows], rcond=None)[0]
        residual = (torque - bases @ solution)[c.score_rows]
        actual.append(float(np.sqrt(np.mean(residual**2))))
    assert actual == pytest.approx(PUBLISHED[number], rel=0.003)


@needs_shared
def test_real_rig_is_read_as_its_readme_says() -> None:
    """The unbalanced disc: 24500 rows, pi/1000 rad per count, speeds up to 19 rad/s, voltage only."""
    rig = read_rig(RIGS / "tue_unbalanced_disc.toml")
    path = SHARED / "measured" / "tue_unbalanced_disc" / "data.csv.gz"
    counts = np.loadtxt(path, delimiter=",", skiprows=1, usecols=3)
    c = read_channels([path], rig)
    assert c.counts["read"] == 24500
    assert (c.points_per_row, c.logged_step_s) == (2, pytest.approx(0.025))
    assert c.run_names == ("2024",)
    assert c.quantum_rad == pytest.approx(math.pi / 1000.0)
    assert c.drive == "voltage"
    assert float(np.max(np.abs(c.omega_m))) == pytest.approx(19.0, abs=0.5)
    # Every other point is a row of the log.
    np.testing.assert_allclose(c.theta_logged[::2], counts * math.pi / 1000.0, atol=1e-9)
    assert rig.estimate == {"input_delay_s", "theta_zero_rad", "voltage_offset_V"}
