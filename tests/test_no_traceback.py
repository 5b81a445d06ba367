"""Whatever a user gives, bad input is one line: from Python, from a shell, from the file system."""

from __future__ import annotations

import dataclasses
import io
import os
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import eccentric
from eccentric.cli import main
from eccentric.core import InputError, show
from eccentric.rigs import ColumnSource
from eccentric.signals import read_channels

BENCH = Path(__file__).parents[1] / "examples" / "bench"
LOG, RIG = BENCH / "bench.csv.gz", BENCH / "bench.json"

C2 = ("c2_parallel", "out")

NO_INPUT: dict[str, tuple[Callable[..., object], tuple[object, ...], dict[str, object], str]] = {
    "fit without logs": (eccentric.fit, ([], RIG), {}, "expected a log, got none"),
    "diagnose without logs": (eccentric.diagnose, ([], RIG), {}, "expected a log, got none"),
    "log with a null": (eccentric.read_log, ("a\0.csv",), {}, "log: expected a path without null"),
    "rig with a null": (eccentric.read_rig, ("a\0.toml",), {}, "rig: expected a path without null"),
    "load_model, a number": (eccentric.load_model, (1,), {}, "model: expected a path, got int"),
    "emit, a number": (eccentric.emit, (1.5, "out"), {}, "model: expected a path, got float"),
    "fit, model of bytes": (eccentric.fit, (LOG, RIG, b"x"), {}, "model: expected a path, got bytes"),
    "diagnose, a number": (eccentric.diagnose, (LOG, RIG, 1), {}, "model: expected a path, got int"),
    "diagnose, effects": (eccentric.diagnose, (LOG, RIG, None, 1), {}, "effects: expected a path"),
    "emit, parameters": (eccentric.emit, C2, {"parameters": 1}, "parameters: expected a path"),
    "emit, prefix": (eccentric.emit, C2, {"prefix": 1}, "prefix: expected a lower-case"),
    "emit, backend": (eccentric.emit, C2, {"backend": 1}, "backend: expected one of"),
    "emit, no backend": (eccentric.emit, C2, {"backend": []}, "got 'none'"),
    "emit, out": (eccentric.emit, ("c2_parallel", None), {}, "output: expected a path, got NoneType"),
    "bench, seconds": (eccentric.bench, (), {"seconds": "a"}, "seconds: expected 15 to 3600, got 'a'"),
    "bench, mu": (eccentric.bench, (), {"mu": None}, "gear ratio mu: expected 0.001 to 2, got None"),
    "bench, noise": (eccentric.bench, (), {"noise": 1j}, r"noise \(.*\): expected 0 to 0\.5, got 1j"),
    "bench, seed": (eccentric.bench, (), {"seed": 1.5}, "seed: expected an integer of 0 or more"),
    "bench, out": (eccentric.bench, (), {"out": 1}, "out: expected a path, got int"),
    "bench, effects": (eccentric.bench, ("stribeck",), {}, "effects: expected a list of names or of "),
    "bench, an effect": (eccentric.bench, ([1],), {}, r"effects: expected names or \(name, strength\)"),
    "bench, a strength": (
        eccentric.bench,
        ([("stribeck", "a")],),
        {},
        "stribeck: expected a strength above 0",
    ),
}


@pytest.mark.parametrize("case", NO_INPUT)
def test_python_arguments_of_a_wrong_type_are_refused_by_name(case: str) -> None:
    """The message names the argument, what is required, and what was received."""
    call, arguments, options, said = NO_INPUT[case]
    with pytest.raises(InputError, match=said):
        call(*arguments, **options)


def test_logs_and_rigs_print_without_their_arrays() -> None:
    """A log of 15,000 rows and a rig are each a line that says what they are."""
    assert repr(eccentric.read_log(LOG)).startswith(f"<Log {LOG}: 15000 rows of time_s, ")
    assert repr(eccentric.read_rig(RIG)).startswith("<Rig bench: case C2; known M, M_l, L, mu, ")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
@pytest.mark.parametrize("name", ["log.csv", "rig.toml", "rig.json"])
def test_a_pipe_is_refused_and_not_waited_for(tmp_path: Path, name: str) -> None:
    """Reading a named pipe without a writer would never return."""
    os.mkfifo(tmp_path / name)
    read = eccentric.read_log if name.startswith("log") else eccentric.read_rig
    with pytest.raises(InputError, match="expected a regular file, got a pipe or a device"):
        read(tmp_path / name)


@pytest.mark.skipif(sys.platform != "linux", reason="names of files are text on this system")
def test_a_name_that_is_not_utf8_is_shown_with_replacements(tmp_path: Path) -> None:
    """Results are UTF-8: a byte of a file's name that is not becomes the replacement character."""
    log, rig = (Path(os.fsdecode(os.fsencode(tmp_path / "a") + b"\xff" + end)) for end in (b".csv", b".json"))
    log.write_text("time_s\n0\n", encoding="utf-8")
    rig.write_text('{"known": {"case": "C2"}}', encoding="utf-8")

    assert f"{tmp_path}/a\ufffd.csv" == eccentric.read_log(log).path
    assert "a\ufffd" == eccentric.read_rig(rig).name


def test_a_character_that_the_terminal_lacks_is_printed_as_an_escape(monkeypatch: pytest.MonkeyPatch) -> None:
    """An ASCII terminal shows the letter omega by its number."""
    printed = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(printed, encoding="ascii", newline="\n"))
    show("ω")

    assert b"\\u03c9\n" == printed.getvalue()


def test_too_little_memory_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    """As under a limit of the shell: NumPy raises MemoryError."""
    import eccentric.paper

    def full() -> str:
        raise MemoryError

    monkeypatch.setattr(eccentric.paper, "table_1", full)

    assert 2 == main(["audit"])
    assert capsys.readouterr().err.startswith("eccentric: error: not enough memory: ")


@pytest.fixture(scope="module")
def swings() -> eccentric.BenchResult:
    """A log in a horizontal plane."""
    return eccentric.bench(seconds=15, case="C1", seed=3)


def test_a_load_that_no_log_separates_is_refused_by_fit_and_diagnose(swings: eccentric.BenchResult) -> None:
    """With Coulomb friction of its own in each direction, a constant load is half their difference."""
    unknown = {"T_load": (-0.1, 0.1)}
    rig = dataclasses.replace(swings.rig, unknown=unknown)
    for command in (eccentric.fit, eccentric.diagnose):
        with pytest.raises(InputError, match="C_pos, C_neg, T_load cannot be separated on this log"):
            command(swings.log, rig, "c1_asymmetric")


def test_a_range_of_the_back_emf_bounds_its_sum_with_friction(swings: eccentric.BenchResult) -> None:
    """Friction is not negative: k_e plus its share is at least the lower end of the range."""
    known = {name: x for name, x in swings.rig.known.items() if name not in {"k_e", "R", "k_i"}}
    rig = dataclasses.replace(swings.rig, known=known, unknown={"k_e": (0.5, 0.6)})
    rig = dataclasses.replace(rig, log=dataclasses.replace(rig.log, drive="voltage"))
    found = eccentric.fit(swings.log, rig).estimates
    (name,) = (name for name in found if "k_e" in name)

    assert 0.5 == found[name].value
    assert "lower" == found[name].bound_active


def test_a_range_without_effect_is_said(swings: eccentric.BenchResult) -> None:
    """A current measures the torque whatever the back-EMF is."""
    known = {name: x for name, x in swings.rig.known.items() if name != "k_e"}
    rig = dataclasses.replace(swings.rig, known=known, unknown={"k_e": (0.05, 0.06)})

    said = "k_e has no effect on c1_perpendicular driven by current"
    assert said in eccentric.fit(swings.log, rig).warnings


SIZES: dict[str, tuple[str, float, str]] = {
    "a current of 1e308": ("current_A", 1e308, r"column .*: expected at most 1e.12 A"),
    "a current of 1e-310": ("current_A", 1e-310, "expected a value of at least 1e-12 A, got at most"),
    "an angle of 1e300": ("theta_m_rad", 1e300, "line 3, column 'theta_m_rad'.*: expected at most 1e.12 rad"),
}


@pytest.mark.parametrize("case", SIZES)
def test_a_value_that_no_sensor_gives_is_refused_where_it_is_read(tmp_path: Path, case: str) -> None:
    """The message names the file, the line, the column, what is required and what was received."""
    column, size, said = SIZES[case]
    t = np.arange(100) / 100.0
    values: dict[str, np.ndarray] = dict.fromkeys(
        ("time_s", "theta_m_rad", "omega_m_rad_s", "voltage_V", "current_A"), t
    )
    values[column] = np.where(t > 0, size, 0.0)
    lines = [",".join(values), *(",".join(map(str, row)) for row in zip(*values.values(), strict=True))]
    (tmp_path / "log.csv").write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(InputError, match=said):
        eccentric.fit(tmp_path / "log.csv", RIG)


PARAMETERS = {
    "phi": (2.0, "phi: expected an angle from 0 to pi/2, got 2.0"),
    "mu": (1e-300, "mu: expected a number of size 1e-12 to 1e.12, got 1e-300"),
    "L": (5e-324, "expected .* within single precision, got L = 5.0e-324"),
    "M": (1e300, "M: expected a number of size up to 1e.12, got 1e.300"),
}


@pytest.mark.parametrize("letter", PARAMETERS)
def test_a_parameter_beyond_what_the_c_can_hold_is_refused(letter: str, tmp_path: Path) -> None:
    """Its coefficients would be infinite in single precision."""
    value, said = PARAMETERS[letter]
    with pytest.raises(InputError, match=said):
        eccentric.emit("rotating_link", tmp_path / "out", parameters={letter: value})
    assert [] == list(tmp_path.iterdir())


@pytest.mark.parametrize("key", ["M_kg", "L_m", "mu", "R_ohm", "k_i_Nm_per_A", "J_m_kgm2", "g_m_s2"])
@pytest.mark.parametrize("size", [1e-300, 1e299], ids=str)
def test_a_rig_of_impossible_size_is_refused(key: str, size: float) -> None:
    """No drive has such a mass, arm, gear, winding or inertia."""
    with pytest.raises(InputError, match=rf"\[known\] {key}: expected a value of size .*"):
        eccentric.read_rig({"known": {"case": "C2", key: size}})


COLUMNS = {"time": "time_s", "theta_m": "theta_m_rad", "current": "current_A"}


def test_a_horizontal_axis_is_not_told_where_gravity_pulls(swings: eccentric.BenchResult) -> None:
    """A current that follows the sine of the link angle is cogging or friction there."""
    columns = {name: swings.log.numbers(name) for name in swings.log.columns}
    columns["current_A"] = columns["current_A"] + 2.0 * np.sin(0.2 * columns["theta_m_rad"] + 2.0)
    known = {name: x for name, x in swings.rig.known.items() if name in {"mu", "k_i", "g", "phi"}}
    log = dataclasses.replace(
        swings.rig.log, columns={name: ColumnSource(column) for name, column in COLUMNS.items()}
    )
    rig = dataclasses.replace(swings.rig, known=known, log=log)

    assert [] == [w for w in read_channels([columns], rig).intake.warnings if "gravity" in w]


@pytest.mark.parametrize("value", [1e-300, 1e-12, 0.0, -1.0], ids=str)
def test_a_low_pass_that_leaves_no_motion_is_refused(value: float) -> None:
    """Its poles are all 1 in double precision."""
    with pytest.raises(InputError, match=r"low_pass_hz: expected a finite number of at least 0\.001"):
        eccentric.read_rig({"known": {"case": "C2"}, "low_pass_hz": value})


def test_half_a_character_in_a_name_is_replaced(tmp_path: Path) -> None:
    """JSON can spell a lone surrogate, which no UTF-8 file can contain."""
    (tmp_path / "rig.json").write_text('{"known": {"case": "C2"}, "name": "\\ud800"}', encoding="utf-8")
    assert "?" == eccentric.read_rig(tmp_path / "rig.json").name
