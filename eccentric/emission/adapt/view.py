"""What the templates of the estimator see."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import mpmath
import numpy as np

from eccentric.core import InputError
from eccentric.emission.adapt import update
from eccentric.emission.adapt.prior import CONFIDENCE, Adaptation, Alarm, Prior, alarm_of, joint_deviations
from eccentric.emission.adapt.update import (
    NEEDED,
    STATES,
    applied_lines,
    bounds,
    inside,
    ranged_inputs,
    within,
)
from eccentric.emission.backends import code, decimal, with_plain_text, wrapped
from eccentric.emission.check import proof_command
from eccentric.emission.program import build_program
from eccentric.emission.render import digest_of, render_beside
from eccentric.emission.templates import plain
from eccentric.model import Model, spoken, spoken_quantity
from eccentric.model import vocabulary as v

AVERAGED = 2**15
"""Rows over which noise and correlation are averaged: the standard deviation to 0.4 %."""
ARMED = 2**10
"""Rows before the first alarm: by then the standard deviation is known to 2 %."""
SLOWER = 16
"""What no row excites is forgotten slower by this factor."""
_GLOBAL = {
    "ZERO": 0.0,
    "ONE": 1.0,
    "CLIP": 5.0,  # beyond so many standard deviations, an innovation counts as an outlier of this size
    "KNOWN": 0.25,  # half the prior's standard deviation, squared
    "LEAST_VARIANCE": 2.0**-40,
    "MOST_U": 2.0**10,
    "LEAST_B": 2.0**-4,  # b is at least lambda, but no interval of Eva's knows it
    "MOST_RHO": 0.96875,
    "LEAST_SQUARE": 2.0**-10,
    "MOST_SQUARE": 256.0,
    "RATE": 1 / AVERAGED,
    "FIRST_RATE": 2.0**-6,
    "ARMED": 1 / ARMED,
    "LEAST_SHARPNESS": 2.0**-5,  # spread is below 2 MOST_SQUARE, by intervals
    "MOST_SHARPNESS": 2.0**5,
    "LEAST_LIMIT": 5.0 * 2.0**-5,  # CLIP times the root of LEAST_SQUARE
    "MOST_LIMIT": 5.0 * 2.0**4,
    "LEAST_FRICTION": 2.0**-40,  # over that of the prior
}
_MOST_ZETA, _MOST_RESIDUAL = 1e8, 1e6
"""Largest variance of a row's friction and largest residual that count, over the noise."""


def constants_of(
    prior: Prior, asked: Adaptation, alarm: Alarm, inputs: Iterable[Mapping[str, Any]]
) -> list[tuple[str, float]]:
    """Names and values, those of the prior and of the ranges of the inputs included."""
    forget, n = 1 - asked.forgetting, len(prior.values)
    U, d = prior.factors()
    scale = prior.deviations / prior.noise
    each = {
        "SCALE": scale,
        "STEP": prior.deviations,
        "START": prior.values,
        "LOWEST": prior.lowest,
        "HIGHEST": prior.highest,
        "D": np.minimum(d, 1.0),
        "U": [U[i, j] for j in range(n) for i in range(j)],
    }
    return [
        *_GLOBAL.items(),
        ("PER_NOISE", 1 / prior.noise),
        ("DEVIATIONS", joint_deviations(*prior.rows.shape)),
        ("MOVING", prior.moving),
        ("LAMBDA", asked.forgetting),
        ("FORGET", forget),
        ("GROWTH", 1 + n * forget / SLOWER),
        ("LEAST_ZETA", forget / 1024),
        ("REFERENCE", alarm.reference),
        ("THRESHOLD", alarm.threshold),
        ("TURNS", float(n)),
        ("MOST_ZETA", _MOST_ZETA),
        ("MOST_RESIDUAL", _MOST_RESIDUAL * prior.noise),
        *((f"{name}_{k}", float(x)) for name, values in each.items() for k, x in enumerate(values)),
        *(
            (f"{end}_{x['name']}", x[which])
            for x in inputs
            for end, which in (("LEAST", "low"), ("MOST", "high"))
        ),
    ]


def decimals(name: str, value: float) -> dict[str, str]:
    """A constant as the templates write it: its decimals in both precisions, in Python and C."""
    with mpmath.workdps(30):
        texts = [decimal(mpmath.mpf(value), single) for single in (True, False)]
    in_c = (f"({text})" if text.startswith("-") else text for text in (f"{texts[0]}f", texts[1]))
    return dict(zip(("name", "single", "double", "c_single", "c_double"), (name, *texts, *in_c), strict=True))


_SHARE, _SHIFTS = 0.2, (0.5, 2.0)
"""The alarm is made for a change of friction by this share, if that is a shift within these."""
_FLAGS = (
    ("UPDATED", 1, "the row has changed the coefficients"),
    ("STILL", 2, "row skipped: at rest, or just after a start or reversal"),
    ("RANGE", 4, "row skipped: an input, or a value computed from it, is not finite or out of range"),
    ("MORE", 8, "alarm: more friction than learned"),
    ("LESS", 16, "alarm: less friction than learned"),
    ("BOUND", 32, "a coefficient is limited to its bound"),
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
        "known": update.known(n),
        "shared": update.shared(n),
    }
    return {
        "name": model.name,
        "guard": model.name.upper(),
        "digest": digest,
        "names": ["init", "open", "apply", "parameters", "unseen", "deviation", "gain"],
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
        "rows": [[decimals("row", float(x)) for x in row] for row in prior.rows * prior.deviations],
        "confidence": f"{100.0 * CONFIDENCE:g}",
        "all": {
            which: [f"{name}_{k}" for k in range(n)]
            for which, name in (("step", "STEP"), ("lowest", "LOWEST"), ("highest", "HIGHEST"), ("x", "x"))
        },
        "inputs": inputs,
        "said": model.axis.text,
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


def render_adapt(
    model: Model,
    files: Mapping[str, str],
    prior: Prior,
    asked: Adaptation | None = None,
    command: str = "eccentric emit --adapt",
) -> dict[str, str]:
    """The files of the estimator, file name -> text.

    Args:
        model: what was emitted, with the defaults that the estimator starts from.
        files: the output of `render`, with the C.
        prior: of its coefficients.
        asked: forgetting and false alarms.
        command: that writes the files, for their banner.

    Raises:
        InputError: the model lacks a function that the estimator calls, or does not depend on friction in a
            way that it can follow.
    """
    asked = asked or Adaptation()
    seen = view(model, prior, asked, digest_of(model, files), files[f"{model.name}.c"])
    meaning = "Estimator of the friction coefficients."
    return render_beside(model, "adapt", "adapt", seen, meaning, command)
