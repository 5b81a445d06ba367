"""A carriage that follows its friction: the estimator in its own letters, and a log through it."""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eccentric
from tests.adapted import Estimator, emitted, module, python_bits
from tests.carriage import GIVEN, RIG, SLIDE, Carriage, logged
from tests.emitted import quick
from tests.test_linear_words import foreign

STEP = 1e-3


def motion(count: int) -> tuple[np.ndarray, ...]:
    """Position [m], velocity and acceleration of strokes of changing size with rests in between."""
    t = np.arange(count) * STEP
    size = np.random.default_rng(4).uniform(0.0, 1.0, count // 800 + 1)[np.arange(count) // 800]
    size[size < 0.3] = 0.0
    velocity = 0.2 * size * np.sin(2.0 * np.pi * t / 0.8)
    acceleration = 0.2 * size * 2.0 * np.pi / 0.8 * np.cos(2.0 * np.pi * t / 0.8)
    return np.cumsum(velocity) * STEP, velocity, acceleration


def driven(moved: tuple[np.ndarray, ...], B: np.ndarray, C: np.ndarray) -> np.ndarray:
    """The current of a carriage with this friction, by Newton's law written out."""
    _, velocity, acceleration = moved
    noise = np.random.default_rng(5).normal(0.0, 1.0, len(velocity))
    force = 95.0 * acceleration + B * velocity + C * np.sign(velocity) - 3.0
    return (force + noise) / 35.0


@pytest.mark.parametrize(
    ("name", "dtype"),
    quick(
        itertools.product(("linear_axis", "screw_axis"), (np.float32, np.float64)),
        {("screw_axis", np.float64)},
    ),
)
def test_same_bits(tmp_path: Path, name: str, dtype: Any) -> None:
    """Flags and every number of the state agree in C and Python; B and C end at what was driven."""
    given = GIVEN | ({"kappa": 628.3} if name == "screw_axis" else {})
    folder = emitted(tmp_path, name, given, forgetting=0.99)
    python, c = module(folder, name), Estimator(folder, name, dtype)
    moved = motion(12000)
    half = np.arange(12000) < 6000
    current = driven(moved, np.where(half, 203.0, 260.0), np.where(half, 20.0, 15.0))
    current[::501] = np.nan
    known = dict(zip(("position", "velocity", "acceleration", "i"), (*moved, current), strict=True))
    rows = [known[x].astype(dtype) for x in python.INPUTS]
    state = python.init(dtype)

    assert python.replay(*rows, state)["flags"].tolist() == c.learn(rows)

    assert python_bits(state) == c.bits()
    learned = dict(zip(python.COEFFICIENTS, state.coefficient, strict=True))
    assert learned == {"B": pytest.approx(260.0, abs=3.0), "C": pytest.approx(15.0, abs=0.4)}
    assert ("N s/m", "N") == python.UNITS
    written: Any = c.ffi.new(f"{name}_parameters *")
    c["adapt_parameters"](c.state, written)
    own = python.parameters(state)
    assert (written.B, written.C) == (own.B, own.C) == tuple(map(float, state.coefficient))


def test_the_words_are_those_of_a_carriage(tmp_path: Path) -> None:
    """No file speaks of torques, angles or motors."""
    folder = emitted(tmp_path, "linear_axis", GIVEN)

    found = {path.name: foreign(path.read_text(encoding="utf-8")) for path in folder.rglob("*_adapt*")}

    assert len(found) == 4
    assert not any(found.values()), found


def test_a_log_of_a_force_is_followed(tmp_path: Path) -> None:
    """Friction that changes between two simulated runs is followed from one value to the other."""
    plants = Carriage(), Carriage(B=240.0, C=26.0)
    parts = [logged(k, plant, seconds=10.0, runs=1) for k, plant in enumerate(plants)]
    log = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    log["run"] = np.repeat([0, 1], [len(part["t_s"]) for part in parts])
    before = eccentric.fit(parts[0], RIG)
    start = tmp_path / "fit.json"
    start.write_text(json.dumps(before.document), encoding="utf-8")

    found = eccentric.adapt(log, RIG, parameters=start, settle=60)

    course = found.course
    assert np.all(np.diff(course.t) > 0.0)  # the second run's own time begins anew
    half = int(np.searchsorted(course.t, 9.9))
    assert course.names == ("B", "C")
    assert course.values[half] == pytest.approx([203.0, 20.0], rel=0.03)
    assert course.values[-1] == pytest.approx([240.0, 26.0], rel=0.03)
    assert [kind for at, kind in course.alarms if at > 10.0][:1] == ["more"]
    assert not foreign("\n".join([found.summary(), json.dumps(found.document)]))


def test_a_strong_drive_is_within_its_range() -> None:
    """Of a force in kilonewtons no row is left out for its size: k_f is 1 N/A where a force is logged."""
    log = logged(2, Carriage(mass=9500.0, B=20300.0, C=2000.0, F_load=0.0, gain=3500.0), seconds=6.0, runs=1)
    columns = RIG["columns"] | {"force": {"column": "u_V", "gain": "3500 N/V"}}

    course = eccentric.adapt(log, RIG | {"columns": columns, "unknown": {}}).course

    small = eccentric.adapt(
        logged(2, Carriage(F_load=0.0), seconds=6.0, runs=1), RIG | {"unknown": {}}
    ).course
    assert course.used > 0.9 * small.used  # the loop is softer, the moves are the same
    assert course.values[-1] == pytest.approx([20300.0, 2000.0], rel=0.05)


def test_a_path_is_told_as_it_was_given(tmp_path: Path) -> None:
    """A folder called torque stays one, in the words of a carriage too."""
    path = tmp_path / "torque" / "fit.json"
    with pytest.raises(eccentric.InputError, match=r"torque/fit\.json"):
        eccentric.adapt(logged(0, seconds=3.0, runs=1), RIG, parameters=path)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            {"J": 1.0},
            r"parameters\.J: linear_axis has no such parameter; it has R, k_f, k_e, mass, B, C, F_load",
        ),
        ({"mass": 95.0, "J_m": 1.0}, "parameters: expected each only once, got mass and J_m"),
        ({"mass": -1.0}, r"parameters\.mass: expected a "),
    ],
)
def test_a_wrong_parameter_is_told_as_it_was_written(
    tmp_path: Path, values: dict[str, float], message: str
) -> None:
    """Letters of the axis and the general ones are taken, each once."""
    with pytest.raises(eccentric.InputError, match=message):
        eccentric.emit("linear_axis", tmp_path / "out", parameters=values)


def test_from_the_shell(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The bundled carriage: coefficients in N s/m and N, and a figure."""
    from eccentric.cli import main

    out = tmp_path / "out"
    files = [str(SLIDE / name) for name in ("slide.csv.gz", "slide.toml")]

    assert main(["adapt", files[0], "--rig", files[1], "--out", str(out)]) == 0

    said = capsys.readouterr().out
    assert "N s/m" in said
    assert not foreign(said)
    assert {"adapt.json", "adapt.png", "adapt.svg"} <= {path.name for path in out.iterdir()}
    assert not foreign((out / "adapt.json").read_text(encoding="utf-8"))
