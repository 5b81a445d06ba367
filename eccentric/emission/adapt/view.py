"""What the templates of the estimator see, and the files that they give."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import mpmath
import numpy as np

from eccentric.emission.adapt import update
from eccentric.emission.adapt.alarm import Alarm, alarm_of
from eccentric.emission.adapt.applied import followed
from eccentric.emission.adapt.prior import Prior
from eccentric.emission.adapt.settings import Adaptation
from eccentric.emission.backends import BACKENDS, code, decimal, with_plain_text, wrapped
from eccentric.emission.check import limits, proof_command
from eccentric.emission.free_text import plain
from eccentric.emission.program import Program, Routine, build_program
from eccentric.emission.templates import template
from eccentric.errors import InputError
from eccentric.model import Model
from eccentric.version import __version__

AVERAGED = 2**15
"""Rows over which noise and correlation are averaged: the standard deviation to 0.4 %."""
ARMED = 2**10
"""Rows before the first alarm: by then the standard deviation is known to 2 %."""
_SLOWER = 16
"""What no row excites is forgotten slower by this factor."""
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
}
_MOST_ZETA, _MOST_RESIDUAL = 1e8, 1e6
"""Largest variance of a row's friction and largest residual that count, over the noise."""
_STATES = (
    "-eva-domains equality -eva-slevel 20 -eva-slevel-function NAME_project:2000,NAME_variance:100,main:100"
)
"""Of the proof: loops over coefficients are followed index by index, and nothing else is."""
_NEEDED = ("mechanical_residual", "regressor", "friction_coefficients")


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
    digest = re.findall(r"_PROGRAM (0x\w+)", files[f"{model.name}.h"])[0]
    seen = view(model, prior, asked, digest, files[f"{model.name}.c"])
    banner = (
        f"Generated: do not edit. Written by `{plain(command)}`, beside {model.name}.c",
        f"(eccentric {__version__}, program {digest[2:].removesuffix('UL')}).",
        "Estimator of the friction coefficients.",
    )
    return {
        file: (BACKENDS[backend].banner(banner) if backend else "") + template(f"adapt/{kind}").render(seen)
        for kind, file, backend in (
            ("header.h", f"{model.name}_adapt.h", "c99"),
            ("source.c", f"{model.name}_adapt.c", "c99"),
            ("module.py", f"{model.name}_adapt.py", "numpy"),
            ("proof.c", f"check/{model.name}_adapt_proof.c", ""),
        )
    }


def view(model: Model, prior: Prior, asked: Adaptation, digest: str, source: str) -> dict[str, Any]:
    """All variables of the templates.

    `digest` is that of the model's program, as its header spells it; `source` is its C.
    """
    program = with_plain_text(build_program(model))
    routines = {r.name: r for r in program.routines}
    if missing := [name for name in _NEEDED if name not in routines]:
        raise InputError(f"model {model.name}: an estimator of its friction requires {missing[0]}")
    n = len(prior.values)
    alarm = alarm_of(float(np.clip(_SHARE * prior.friction / prior.noise, *_SHIFTS)), asked.false_alarms)
    inputs = _inputs(model, routines)
    constants = _constants(prior, asked, alarm) + [
        (f"{end}_{x['name']}", x[which])
        for x in inputs
        for end, which in (("LEAST", "low"), ("MOST", "high"))
    ]
    names = [name for name, _ in constants]
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
        "growth": f"{1 - (1 - asked.forgetting) / _SLOWER:.7g}",
        "coefficients": [_coefficient(prior, k) for k in range(n)],
        "zeroed": _zeroed(model, prior),
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
        "constants": [_decimals(name, value) for name, value in constants],
        "all": {
            which: [f"{name}_{k}" for k in range(n)]
            for which, name in (("step", "STEP"), ("lowest", "LOWEST"), ("highest", "HIGHEST"), ("x", "x"))
        },
        "inputs": inputs,
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
        "inside": code([f"if ({_inside(inputs)}) {{"]),
        "residual": ", ".join(x.quantity.name for x in routines["mechanical_residual"].inputs),
        "regressor": ", ".join(x.quantity.name for x in routines["regressor"].inputs),
        "bounds": _bounds(n),
        "command": proof_command(
            f"{model.name}_adapt", source, _STATES.replace("NAME", f"{model.name}_adapt")
        ),
        "outside": code([f"if (!({_outside(n)})) {{"]),
        "applied": {
            which: _applied(model, program, prior, which == "single") for which in ("single", "double")
        },
        "python": {key: update.in_python(part, names) for key, part in lines.items()},
        **{key: code(update.in_c(model.name, part)) for key, part in lines.items()},
    }


def _bounds(n: int) -> list[tuple[str, str, str]]:
    """The invariant of the state: field, lowest and highest value."""
    return [
        *((f"coefficient[{k}]", f"LOWEST_{k}", f"HIGHEST_{k}") for k in range(n)),
        *((f"d[{k}]", "ZERO", "ONE") for k in range(n)),
        *((f"u[{k}]", "-(MOST_U)", "MOST_U") for k in range(n * (n - 1) // 2)),
        ("before", "-(MOST_LIMIT)", "MOST_LIMIT"),
        ("square", "LEAST_SQUARE", "MOST_SQUARE"),
        ("product", "-(MOST_SQUARE)", "MOST_SQUARE"),
        ("rho", "ZERO", "MOST_RHO"),
        ("sharpness", "LEAST_SHARPNESS", "MOST_SHARPNESS"),
        ("limit", "LEAST_LIMIT", "MOST_LIMIT"),
        ("rate", "RATE", "FIRST_RATE"),
        ("up", "ZERO", "THRESHOLD"),
        ("down", "ZERO", "THRESHOLD"),
    ]


def _inside(inputs: list[dict[str, Any]]) -> str:
    """The condition in C that the inputs are within their ranges; NaN is not."""
    names = [x["name"] for x in inputs]
    return " && ".join(f"({name} >= LEAST_{name}) && ({name} <= MOST_{name})" for name in names)


def _outside(n: int) -> str:
    """The condition in C that the coefficients are within their bounds."""
    return " && ".join(f"(x_{k} >= LOWEST_{k}) && (x_{k} <= HIGHEST_{k})" for k in range(n))


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


def _constants(prior: Prior, asked: Adaptation, alarm: Alarm) -> list[tuple[str, float]]:
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
        ("MOVING", prior.moving),
        ("LAMBDA", asked.forgetting),
        ("FORGET", forget),
        ("GROWTH", 1 + n * forget / _SLOWER),
        ("LEAST_ZETA", forget / 1024),
        ("REFERENCE", alarm.reference),
        ("THRESHOLD", alarm.threshold),
        ("TURNS", float(n)),
        ("MOST_ZETA", _MOST_ZETA),
        ("MOST_RESIDUAL", _MOST_RESIDUAL * prior.noise),
        *((f"{name}_{k}", float(x)) for name, values in each.items() for k, x in enumerate(values)),
    ]


def _decimals(name: str, value: float) -> dict[str, str]:
    with mpmath.workdps(30):
        texts = [decimal(mpmath.mpf(value), single) for single in (True, False)]
    in_c = (f"({text})" if text.startswith("-") else text for text in (f"{texts[0]}f", texts[1]))
    return dict(zip(("name", "single", "double", "c_single", "c_double"), (name, *texts, *in_c), strict=True))


def _inputs(model: Model, routines: Mapping[str, Routine]) -> list[dict[str, Any]]:
    """The motion, the current, and whatever else the balance depends on."""
    found = {
        x.quantity.name: x.quantity for name in _NEEDED for x in routines[name].inputs if x.length is None
    }
    first = ("theta_m", "omega_m", "alpha_m", "i")
    known = {q.name: q for q in model.inputs}
    ordered = [*(x for x in first if x in known), *(x for x in found if x not in first)]
    quantities = [found.get(x) or known[x] for x in ordered]
    return [
        {
            "name": q.name,
            "doc": plain(f"{q.meaning} [{q.unit}]"),
            "low": limits(q)[0],
            "high": limits(q)[1],
        }
        for q in quantities
    ]


def _applied(model: Model, program: Program, prior: Prior, single: bool) -> list[str]:
    suffix = "f" if single else ""
    lines = []
    for one in followed(model, program, prior.columns, single):
        terms = [
            f"state->coefficient[{k}]" if x == "1.0" else f"{x}{suffix} * state->coefficient[{k}]"
            for k, x in one.factors.items()
        ]
        lines.append(
            f"c->{one.name} = {' + '.join([*terms, *([one.constant + suffix] if one.constant else [])])};"
        )
    return code(lines)
