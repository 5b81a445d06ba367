"""What the templates of the estimator see."""

from __future__ import annotations

from typing import Any

import numpy as np

from eccentric.emission.adapt import update
from eccentric.emission.adapt.alarm import alarm_of
from eccentric.emission.adapt.applied import applied_lines
from eccentric.emission.adapt.constants import AVERAGED, SLOWER, constants_of, decimals
from eccentric.emission.adapt.inputs import NEEDED, inside, ranged_inputs
from eccentric.emission.adapt.invariant import STATES, bounds, within
from eccentric.emission.adapt.prior import Prior
from eccentric.emission.adapt.settings import Adaptation
from eccentric.emission.backends import code, with_plain_text, wrapped
from eccentric.emission.check import proof_command
from eccentric.emission.free_text import plain
from eccentric.emission.program import build_program
from eccentric.errors import InputError
from eccentric.model import Model, spoken, spoken_quantity
from eccentric.model import vocabulary as v

_SHARE, _SHIFTS = 0.2, (0.5, 2.0)
"""The alarm is made for a change of friction by this share, if that is a shift within these."""
_FLAGS = (
    ("UPDATED", 1, "the row has changed the coefficients"),
    ("STILL", 2, "left out: at rest, or just after a start or reversal"),
    ("RANGE", 4, "left out: an input, or what follows from it, is not finite or out of range"),
    ("MORE", 8, "alarm: there is more friction than was learned"),
    ("LESS", 16, "alarm: there is less friction than was learned"),
    ("BOUND", 32, "a coefficient is kept at a bound"),
)


def view(model: Model, prior: Prior, asked: Adaptation, digest: str, source: str) -> dict[str, Any]:
    """All variables of the templates.

    `digest` is that of the model's program, as its header spells it; `source` is its C.
    """
    program = with_plain_text(build_program(model))
    routines = {r.name: r for r in program.routines}
    if missing := [name for name in NEEDED if name not in routines]:
        raise InputError(f"model {model.name}: an estimator of its friction requires {missing[0]}")
    n = len(prior.values)
    alarm = alarm_of(float(np.clip(_SHARE * prior.friction / prior.noise, *_SHIFTS)), asked.false_alarms)
    inputs = ranged_inputs(model, routines)
    constants = constants_of(prior, asked, alarm, inputs)
    names = [name for name, _ in constants]
    shown = spoken(model)
    lines = {
        "loaded": update.loaded(n),
        "innovation": update.innovation(n),
        "scaled": update.scaled(),
        "updated": update.updated(n),
        "kept": update.kept(n),
    }
    return {
        "name": model.name,
        "guard": model.name.upper(),
        "digest": digest,
        "names": ["init", "open", "apply", "parameters", "unseen", "deviation"],
        "n": n,
        "triangle": n * (n - 1) // 2,
        "flags": [{"name": name, "value": value, "doc": doc} for name, value, doc in _FLAGS],
        "settle": asked.settle,
        "averaged": AVERAGED,
        "forgetting": f"{asked.forgetting:.6g}",
        "growth": f"{1 - (1 - asked.forgetting) / SLOWER:.7g}",
        "coefficients": [_coefficient(prior, k) for k in range(n)],
        "zeroed": _zeroed(shown, prior),
        "prior": {
            "origin": prior.origin,
            "noise": f"{prior.noise:.4g}",
            "moving": f"{prior.moving:.4g}",
            "d": [f"D_{k}" for k in range(n)],
            "u": [f"U_{k}" for k in range(n * (n - 1) // 2)],
        },
        "alarm": {
            "between": f"{asked.false_alarms:.4g}",
            "shift": f"{alarm.shift:.3g}",
            "torque": f"{alarm.shift * prior.noise:.3g}",
            "delay": f"{alarm.delay:.1f}",
            "bound": f"{alarm.bound:.1f}",
            "lorden": f"{alarm.lorden:.1f}",
        },
        "constants": [decimals(name, value) for name, value in constants],
        "all": {
            which: [f"{name}_{k}" for k in range(n)]
            for which, name in (("step", "STEP"), ("lowest", "LOWEST"), ("highest", "HIGHEST"), ("x", "x"))
        },
        "inputs": inputs,
        "said": model.axis.said,
        "speed": spoken_quantity(model.axis, v.omega_m).name,
        "given": ", ".join(x["name"] for x in inputs),
        "typed": ", ".join(f"{x['name']}: Any" for x in inputs),
        "signature": wrapped(
            "uint32_t",
            f"{model.name}_adapt",
            [
                *(f"ECCENTRIC_REAL {x['name']}" for x in inputs),
                f"{model.name}_adapt_state *state",
                f"const {model.name}_coefficients *c",
            ],
        ),
        "inside": code([f"if ({inside(inputs)}) {{"]),
        "residual": ", ".join(x.quantity.name for x in routines["mechanical_residual"].inputs),
        "regressor": ", ".join(x.quantity.name for x in routines["regressor"].inputs),
        "bounds": bounds(n),
        "command": proof_command(
            f"{model.name}_adapt", source, STATES.replace("NAME", f"{model.name}_adapt")
        ),
        "outside": code([f"if (!({within(n)})) {{"]),
        "applied": {
            which: applied_lines(shown, program, prior.columns, which == "single")
            for which in ("single", "double")
        },
        "python": {key: update.in_python(part, names) for key, part in lines.items()},
        **{key: code(update.in_c(model.name, part)) for key, part in lines.items()},
    }


def _coefficient(prior: Prior, k: int) -> dict[str, str]:
    column = prior.columns[k]
    return {
        "name": column.name,
        "unit": plain(column.unit),
        "letter": column.parameter.name,
        "start": f"START_{k}",
        "value": f"{prior.values[k]:.4g}",
        "deviation": f"{prior.deviations[k]:.2g}",
        "lowest": f"{prior.lowest[k]:.3g}",
        "highest": f"{prior.highest[k]:.3g}",
    }


def _zeroed(model: Model, prior: Prior) -> list[str]:
    """Friction parameters that only a combination shows: it is assigned to another letter."""
    letters = {column.parameter.name for column in prior.columns}
    return [q.name for q in model.friction_parameters if q.name not in letters]
