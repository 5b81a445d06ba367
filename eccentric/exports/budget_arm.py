"""The friction of an arm written into MuJoCo before each step, at the bearing loads that MuJoCo computes.

The emitted recursion knows no contacts; the engine does. So the levels are those of
`friction_budget_from_loads`, and the loads those of the engine's own forces between the bodies.
"""

from __future__ import annotations

import sympy as sp

from eccentric.core import InputError
from eccentric.emission import Choice, executed, inputs_of, render, template
from eccentric.exports.drive import ExportedArm
from eccentric.exports.export import Exported, decimal, head

_BUDGET = "friction_budget_from_loads"
_MOTION = ("theta_m", "omega_m", "alpha_m")
_LOADS = ("F_N", "F_T", "M_B", "T")


def write(arm: ExportedArm) -> Exported:
    """NAME.py with its runtime, and NAME_budget.py.

    Raises:
        InputError: a gear ratio or the place of a bearing is a parameter; friction depends on more than
            motion and loads.
    """
    files = render(arm.model, "eccentric export", arm.origin, ("numpy",), choice=Choice((_BUDGET,), "none"))
    inputs = inputs_of(getattr(executed(files, arm.name), _BUDGET))
    place = f"model {arm.name}"
    if others := [x for x in inputs if x not in {*_MOTION, *_LOADS}]:
        raise InputError(place, "friction of motion and loads", f"one of {', '.join(others)} too")
    values = {
        "names": [repr(joint.name) for joint in arm.joints],
        "mu": [_number(joint.mu, f"{place}: {joint.name}: mu") for joint in arm.joints],
        "bearings": [_number(joint.bearing, f"{place}: {joint.name}: bearing") for joint in arm.joints],
        "turns": [repr(joint.turns) for joint in arm.joints],
        "taken": ", ".join(x for x in inputs if x in _MOTION),
        "by_acceleration": "alpha_m" in inputs,
    }
    module = template("exports/budget_arm.py").render(head(arm) | values)
    return Exported({**files, f"{arm.name}_budget.py": module})


def _number(value: sp.Expr, place: str) -> str:
    if not value.is_number:
        raise InputError(place, "a number", f"the parameter {value}", why="to export")
    return decimal(float(value))
