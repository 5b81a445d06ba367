"""Averages weigh both sides of the balance equally: the fit is kept, noise is removed."""

from __future__ import annotations

import dataclasses
import gzip
import math
import re
from pathlib import Path

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.identification import drive_of, fit_data_of
from eccentric.identification.problem import pose
from eccentric.logs import read_log
from eccentric.model import load_model
from eccentric.rigs import Rig, read_rig
from eccentric.signals import Channels, Rows, read_channels, rows_of, search_rows
from tests import screw
from tests.planted import FRICTION, K_I, KNOWN, MASS, MOTOR, RATE, TORQUE, T, fitted, motion, torque, written
from tests.swing import GARBAGE_V, Run, Swing, driven, write_rig, write_runs

AVERAGE_S = 0.2
LOG = 'case = "C2"\n' + KNOWN + TORQUE + MASS


def planted(tmp_path: Path, above: str) -> tuple[Channels, Rig]:
    """The planted rig with a torque signal."""
    channels, _ = written(tmp_path, LOG, {"torque_Nm": torque("C2", FRICTION)}, above)
    return channels, channels.rig


@pytest.mark.parametrize("length", [pytest.param(0.05, marks=pytest.mark.slow), AVERAGE_S])
def test_averages_leave_the_coefficients_of_a_log_without_noise(tmp_path: Path, length: float) -> None:
    """Both sides pass the same window: friction comes back as from the rows, to the differences' error."""
    above = f'average_over = "{length} s"'
    found = fitted(tmp_path, LOG, {"torque_Nm": torque("C2", FRICTION)}, above)
    assert FRICTION == pytest.approx({name: e.value for name, e in found.coefficients.items()}, rel=3e-3)
    assert f"averages over {length} s" in found.problem.rows.description


def test_averages_are_those_of_a_hann_window(tmp_path: Path) -> None:
    """A slope stays, a parabola rises by the window's variance, and two periods per window vanish."""
    channels, rig = planted(tmp_path, f'average_over = "{AVERAGE_S} s"')
    rows = rows_of(channels, rig)
    np.testing.assert_allclose(rows.mean(channels.time.t), rows.t, atol=1e-9)
    variance = AVERAGE_S**2 * (1.0 / 12.0 - 1.0 / (2.0 * math.pi**2))
    np.testing.assert_allclose(rows.mean(channels.time.t**2) - rows.t**2, variance, rtol=0.02)
    np.testing.assert_allclose(rows.mean(np.sin(4.0 * math.pi / AVERAGE_S * channels.time.t)), 0.0, atol=0.01)
    # Every sample that is averaged is one to fit on, or one held out, as the row is.
    for part, samples in (
        (rows.train, channels.selection.fit_rows),
        (rows.score, channels.selection.score_rows),
    ):
        np.testing.assert_allclose(rows.plain_mean(samples.astype(float))[part], 1.0)
    assert not np.any(rows.train & rows.score)
    assert np.all(np.diff(rows.t) > 0.0)


def test_rows_of_the_log_are_its_samples(tmp_path: Path) -> None:
    """Without a wish for averages a row is a row: after the low pass to fit on, as logged in an error."""
    channels, rig = planted(tmp_path, "")
    rows = rows_of(channels, rig)
    assert rows.operator is None
    np.testing.assert_allclose(rows.t, T, rtol=1e-12)
    np.testing.assert_array_equal(rows.train, channels.selection.fit_rows)
    noise = np.random.default_rng(3).standard_normal((len(rows), 2))
    passed = np.where(rows.train[:, None], channels.smooth(noise), noise)
    np.testing.assert_array_equal(rows.mean(noise), passed)
    np.testing.assert_array_equal(rows.noise_gain(), 1.0)
    other = rows.trained_on(rows.score)
    np.testing.assert_array_equal(other.mean(noise)[rows.score], channels.smooth(noise)[rows.score])
    np.testing.assert_array_equal(other.mean(noise)[rows.train], noise[rows.train])


def several(tmp_path: Path, above: str) -> tuple[Channels, Rig]:
    """Five driven runs with a torque signal, the last with the motor switched off."""
    rig, rng = Swing(), np.random.default_rng(4)
    runs = {f"run_{k}": driven(rig, rng) for k in range(5)}
    off = dict(runs["run_4"].columns)
    off |= {"torque_Nm": np.full_like(off["time_s"], GARBAGE_V), "motor_off": np.ones_like(off["time_s"])}
    runs["run_4"] = Run(off)
    log = write_runs(tmp_path / "log.csv", runs, ("time_s", "theta_m_rad", "torque_Nm", "motor_off"))
    channels = read_channels([log], read_rig(write_rig(tmp_path / "rig.toml", rig.known, above)))
    return channels, channels.rig


def test_whole_runs_are_means_of_their_used_rows(tmp_path: Path) -> None:
    """`average_over = "run"`: one row a run, in the order of the log, the plain mean of what is used."""
    channels, rig = several(tmp_path, 'average_over = "run"\nholdout_runs = ["run_2"]')
    rows = rows_of(channels, rig)
    x = np.random.default_rng(0).standard_normal(len(channels.time.t))
    expected = [x[channels.selection.usable & (channels.time.run == run)].mean() for run in range(5)]
    np.testing.assert_allclose(rows.mean(x), expected, rtol=1e-12)
    np.testing.assert_array_equal(rows.run, range(5))
    np.testing.assert_array_equal(rows.score, np.arange(5) == 2)
    np.testing.assert_array_equal(rows.train, np.arange(5) != 2)


def chosen(tmp_path: Path, counts: int, jitter: float, above: str = "") -> Channels:
    """Channels of the planted motion by an encoder of these counts; stamps jitter by a part of a step."""
    t = T + jitter / RATE * np.random.default_rng(2).uniform(-1.0, 1.0, len(T))
    step = 2.0 * np.pi / counts
    theta = np.round(np.interp(t, T, motion()[0]) / step) * step
    columns = {"time_s": t, "theta_m_rad": theta, "torque_Nm": torque("C2", FRICTION)}
    return written(tmp_path, LOG, columns, above)[0]


def test_fine_encoder_keeps_the_low_pass_of_25_hz(tmp_path: Path) -> None:
    """Nothing is averaged where the angle is fine and the stamps even."""
    channels = chosen(tmp_path, 65536, 0.0)
    sampling = channels.rig.sampling
    assert (sampling.low_pass_hz, sampling.average_over, channels.intake.warnings) == (25.0, 0.0, ())


def test_coarse_encoder_gets_a_lower_cut_off_and_averages_and_says_so(tmp_path: Path) -> None:
    """Of 60 counts a turn, the acceleration is noise at 25 Hz: cut-off and averages follow, unless given."""
    channels = chosen(tmp_path, 60, 0.3)
    cut = channels.rig.sampling.low_pass_hz
    assert 3.0 <= cut < 25.0
    assert channels.rig.sampling.average_over == pytest.approx(1.0 / cut)
    assert any("the low-pass filter is set to" in warning for warning in channels.intake.warnings)
    _, omega, alpha = motion()
    # What is left of the acceleration's error is a small part of it.
    rows = channels.selection.usable
    assert np.std((channels.motion.alpha_m - alpha)[rows]) < 0.1 * np.std(alpha[rows])
    given = chosen(tmp_path, 60, 0.3, "low_pass_hz = 25")
    assert (given.rig.sampling.low_pass_hz, given.rig.sampling.average_over) == (25.0, 0.0)
    assert np.std((given.motion.alpha_m - alpha)[rows]) > 0.1 * np.std(alpha[rows])
    np.testing.assert_allclose(channels.motion.omega_m[rows], omega[rows], atol=0.02 * np.max(np.abs(omega)))


def test_runs_of_constant_speed_are_means_without_being_asked(tmp_path: Path) -> None:
    """A bench that holds one speed a run gives one mean a run; a warning says so."""
    (tmp_path / "rig.toml").write_text(
        screw.RIG.replace('average_over = "run"\nlow_pass_hz = 1\n', ""), encoding="utf-8"
    )
    channels = read_channels(
        [screw.write_log(tmp_path / "log.csv", {}, rows=4000)], read_rig(tmp_path / "rig.toml")
    )
    assert math.isinf(channels.rig.sampling.average_over)
    assert any("runs of constant speed: one mean of each" in warning for warning in channels.intake.warnings)


def test_an_average_longer_than_what_moves_is_refused_in_one_line(tmp_path: Path) -> None:
    """Where no stretch of one direction is as long as the average, none is left, and that is said."""
    channels, rig = planted(tmp_path, 'average_over = "20 s"')
    with pytest.raises(InputError) as refused:
        rows_of(channels, rig)
    assert "expected at least one of the averages over 20 s to fit, got none" in str(refused.value)
    (over, gives) = re.findall(r'average_over = "(.*) s" gives (\d+)$', str(refused.value))[0]
    shorter = dataclasses.replace(rig, sampling=dataclasses.replace(rig.sampling, average_over=float(over)))
    rows = rows_of(channels, shorter)
    assert int(gives) == pytest.approx(np.count_nonzero(rows.train), rel=0.05)
    assert f"in {rig.path}, " in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("over", "remedy"), [("0.5 s", "a shorter time as average_over gives more"), ("0.03 s", "record longer")]
)
def test_shorter_averages_are_advised_down_to_eight_rows(tmp_path: Path, over: str, remedy: str) -> None:
    """At 250 rows per second those are 32 ms; with less, only a longer log has more to average."""
    channels, rig = planted(tmp_path, f'average_over = "{over}"')

    assert remedy in rows_of(channels, rig).remedy


EXAMPLE = Path(__file__).parents[1] / "examples" / "bench"


@pytest.mark.parametrize(
    ("left_out", "key", "remedy"),
    [
        ("voltage", "average_over below 0.064 s", 'average_over = "0.05 s"'),
        ("", "low_pass_hz above 25", "low_pass_hz = 50"),
    ],
    ids=["one drive signal", "two"],
)
def test_a_short_log_is_refused_with_what_helps(tmp_path: Path, left_out: str, key: str, remedy: str) -> None:
    """Two seconds are too short for 50 windows to search on; the key that is named gives rows enough."""
    lines = gzip.decompress((EXAMPLE / "bench.csv.gz").read_bytes()).decode().splitlines()
    (tmp_path / "log.csv").write_text("\n".join(lines[:501]), encoding="utf-8")
    text = (EXAMPLE / "bench.toml").read_text(encoding="utf-8")
    kept = [x for x in text.splitlines() if not x.startswith(("holdout", f"{left_out or None} = "))]

    def search(*above: str) -> Rows:
        (tmp_path / "rig.toml").write_text("\n".join([*above, *kept]), encoding="utf-8")
        channels = read_channels([read_log(tmp_path / "log.csv")], read_rig(tmp_path / "rig.toml"))
        return search_rows(channels, channels.rig, moving=bool(left_out))

    with pytest.raises(
        InputError, match=rf"expected at least \d+ windows .*, got \d+: .*; {key} gives more$"
    ):
        search()
    assert len(search(remedy)) > 20


@pytest.mark.parametrize("left_out", ["voltage", ""], ids=["one drive signal", "two"])
def test_a_log_too_short_for_any_window_has_to_be_longer(tmp_path: Path, left_out: str) -> None:
    """1.2 s have 50 rows away from the ends: 50 windows of eight do not fit, and no key is advised."""
    lines = gzip.decompress((EXAMPLE / "bench.csv.gz").read_bytes()).decode().splitlines()
    (tmp_path / "log.csv").write_text("\n".join(lines[:301]), encoding="utf-8")
    text = (EXAMPLE / "bench.toml").read_text(encoding="utf-8")
    kept = [x for x in text.splitlines() if not x.startswith(("holdout", f"{left_out or None} = "))]
    (tmp_path / "rig.toml").write_text("\n".join(kept), encoding="utf-8")
    channels = read_channels([read_log(tmp_path / "log.csv")], read_rig(tmp_path / "rig.toml"))

    with pytest.raises(InputError, match=r"got \d+: no shorter window gives enough: record longer$"):
        search_rows(channels, channels.rig, moving=bool(left_out))


def test_an_average_longer_than_all_motion_asks_for_a_longer_log(tmp_path: Path) -> None:
    """Not one is whole, and no shorter one gives enough either."""
    log = read_log(EXAMPLE / "bench.csv.gz")
    short = read_log({name: log.numbers(name)[:300] for name in log.columns})
    lines = (EXAMPLE / "bench.toml").read_text(encoding="utf-8").splitlines()
    kept = ['average_over = "5 s"', *(x for x in lines if not x.startswith("holdout"))]
    (tmp_path / "rig.toml").write_text("\n".join(kept), encoding="utf-8")
    channels = read_channels([short], read_rig(tmp_path / "rig.toml"))

    needed = r"of \d+ rows to fit, \d+ move .*, and an average takes 1250 in a row: record a longer log$"
    with pytest.raises(
        InputError, match=rf"^table: expected .* averages over 5 s to fit, got none: {needed}"
    ):
        rows_of(channels, channels.rig)


def test_nothing_driven_to_hold_out_is_refused_in_one_line(tmp_path: Path) -> None:
    """With the motor off in all that is held out, the first fit of a drive has nothing to be judged by."""
    channels, rig = several(tmp_path, 'average_over = "run"\nholdout_runs = ["run_4"]')
    with pytest.raises(
        InputError, match="average_over: expected at least one of the whole runs to hold out"
    ) as no:
        pose(channels, rig, load_model(rig.model))
    assert "\n" not in str(no.value)


def test_the_voltage_of_expressions_passes_the_low_pass_of_the_rig(tmp_path: Path) -> None:
    """A sine of 6 Hz keeps the gain |H|^2 of a Butterworth low pass at the 8 Hz that the rig requires."""
    u = np.sin(2.0 * math.pi * 6.0 * T)
    known = 'case = "C2"\n' + KNOWN + MOTOR + MASS
    columns = {"voltage_V": u, "current_A": torque("C2", FRICTION) / K_I}
    channels, rig = written(tmp_path, known, columns, "low_pass_hz = 8.0")
    model = load_model(rig.model)
    found = fit_data_of(drive_of(channels, channels.rig, model), channels.rig, model).signals.values["u"]
    warped = math.tan(math.pi * 6.0 / RATE) / math.tan(math.pi * 8.0 / RATE)
    middle = (T > 1.0) & (T < T[-1] - 1.0)
    np.testing.assert_allclose(found[middle], u[middle] / (1.0 + warped**4), atol=1e-6)
