"""Recordings of one rig that differ: the run and the quantity are named before runs are pooled."""

from __future__ import annotations

import numpy as np
import pytest

from eccentric.diagnosis.stage import runs_that_differ
from eccentric.identification import Coefficient, balance_design
from eccentric.signals import Rows

NAMES = ("monday", "tuesday", "wednesday", "thursday", "friday")
ROWS = 200


def warned(
    level: dict[str, float], gain: dict[str, float], load: float = 1.0, runs: int = 5
) -> tuple[str, ...]:
    """What is said of runs whose friction and drive are these times the usual ones."""
    t = np.arange(runs * ROWS) / 100.0
    run = np.repeat(np.arange(runs), ROWS)
    speed = np.sin(2.0 * np.pi * t) + 0.3
    base = np.column_stack([speed, np.sign(speed)])
    friction = np.array([0.2, 0.4])
    known = load * np.cos(5.0 * t)
    size = np.array([level.get(name, 1.0) for name in NAMES])[run]
    torque = known + size * (base @ friction)
    torque = np.array([gain.get(name, 1.0) for name in NAMES])[run] * torque
    every, block = np.ones(len(t), dtype=bool), t.astype(int)
    rows = Rows(t, run, block, every, ~every, np.ones_like(t), "rows of the log")
    own = [Coefficient(name, "friction", "", 0.0) for name in ("B", "C")]
    balance = balance_design("mechanical", rows, own, torque - known, base, torque)
    return runs_that_differ(balance, torque, friction, NAMES)


def test_runs_alike_are_pooled_without_a_warning() -> None:
    """Friction within some percent from run to run is usual."""
    assert () == warned({"monday": 1.03, "friday": 0.97}, {})


def test_a_run_with_other_friction_is_named() -> None:
    """Its factor is the one that it was made with, and the gain is not doubted."""
    (said,) = warned({"tuesday": 1.5}, {})

    assert said.startswith("run tuesday: its friction differs")
    assert "friction 1.5 times" in said
    assert "1 to 1 times in the others" in said


def test_a_run_with_another_gain_is_named_for_it() -> None:
    """A current sensor that reads a third too much scales load and friction alike."""
    friction, gain = warned({}, {"thursday": 1.3})

    assert friction.startswith("run thursday: its friction differs")
    assert gain.startswith("run thursday: its gain of the drive differs")
    assert "drive torque for the same load 1.3 times" in gain


def test_without_load_only_friction_is_compared() -> None:
    """Nothing in the log then has a gain of its own."""
    (said,) = warned({}, {"thursday": 1.3}, load=0.0)

    assert said.startswith("run thursday: its friction differs")


@pytest.mark.parametrize("runs", [1, 3])
def test_few_runs_do_not_show_how_much_runs_differ(runs: int) -> None:
    """With fewer than three others there is no spread to compare with."""
    assert () == warned({"monday": 2.0}, {}, runs=runs)


def test_a_spread_that_is_usual_on_a_rig_is_no_difference() -> None:
    """A run is not unlike the others if these differ as much among themselves."""
    assert () == warned({"monday": 1.0, "tuesday": 1.3, "wednesday": 1.6, "thursday": 0.8}, {})
