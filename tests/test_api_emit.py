"""`eccentric.emit` and `eccentric.compile` on models of every origin."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import eccentric
from eccentric import InputError, cli

CHECKS = ["check/arm_selftest.c", "check/arm_vectors.h", "check/arm_proof.c"]
FILES = {"arm.py", "eccentric_runtime.py", "arm.h", "arm.c", *CHECKS}


def test_the_command_writes_the_same(tmp_path: Path) -> None:
    """By function and by command, each file has the same bytes; the function returns their paths."""
    paths = eccentric.emit("c1_perpendicular", tmp_path / "function", prefix="arm")
    assert 0 == cli.main(["emit", "c1_perpendicular", "--prefix", "arm", "--out", str(tmp_path / "command")])

    assert FILES == {path.relative_to(tmp_path / "function").as_posix() for path in paths}
    for name in FILES:
        assert (tmp_path / "function" / name).read_bytes() == (tmp_path / "command" / name).read_bytes()


def test_values_by_letter_are_the_defaults_of_the_code(tmp_path: Path) -> None:
    """Those given, and the model's own for the rest."""
    eccentric.emit("c1_perpendicular", tmp_path / "out", parameters={"B_m": 0.25}, prefix="arm")
    program = "import arm; print(arm.Parameters().B_m, arm.Parameters().mu)"
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path / "out", capture_output=True, text=True, check=True
    )

    assert "0.25 0.2\n" == done.stdout


def test_a_model_names_itself_in_the_banner(tmp_path: Path) -> None:
    """A Model in memory has no file: the banner says which model it is."""
    eccentric.emit(eccentric.load_model("c1_perpendicular"), tmp_path / "out")
    text = (tmp_path / "out" / "c1_perpendicular.h").read_text(encoding="utf-8")

    assert "Written by `eccentric emit` from model c1_perpendicular" in text


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ({"prefix": "int"}, "prefix: expected a lower-case C identifier that C and Python leave free"),
        ({"parameters": {"B": 1.0}}, "parameters: parameters.B: c1_perpendicular has no such parameter"),
        (
            {"parameters": {"B_m": "a"}},
            "parameters: parameters.B_m: expected a finite number, got 'a'",
        ),
        ({"parameters": {"model": "c2_parallel", "parameters": {"B_m": 1.0}}}, "parameters: expected a fit"),
        (
            {"parameters": {"k_i": 0.05}},
            "parameters: parameters: expected all of R, k_i, k_e, or none, got k_i alone",
        ),
        (
            {"parameters": {"parameters": {"B_m": 0.1}, "placeholders": {"R": "a"}}},
            "parameters: placeholders.R: expected a finite number, got 'a'",
        ),
        ({"parameters": "no.json"}, "no.json: no such file"),
    ],
    ids=["prefix", "letter", "text", "another model", "part of a motor", "placeholder", "no file"],
)
def test_bad_values_are_one_line(arguments: dict, line: str, tmp_path: Path) -> None:
    """The line begins with the argument, and nothing is written."""
    with pytest.raises(InputError) as error:
        eccentric.emit("c1_perpendicular", tmp_path / "out", **arguments)

    assert str(error.value).startswith(line)
    assert [] == list(tmp_path.iterdir())


def test_a_live_model_compiles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The C of a Model with other defaults gives their torque: case C1 with viscous friction alone is B w."""
    if shutil.which("cc") is None:
        pytest.skip("not installed: cc")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    compiled = eccentric.compile(eccentric.load_model("c1_perpendicular"))
    none = dict.fromkeys(("B_lN", "C_lN", "B_lT", "C_lT", "C_m"), 0.0)

    torque = compiled.mechanical_friction_torque(4.0, compiled.Parameters(**none, B_m=0.25))

    assert 1.0 == torque
