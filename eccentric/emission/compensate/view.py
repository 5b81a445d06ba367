"""The compensation of friction: its gain, what its templates see, and the files that they give."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np
import sympy as sp

from eccentric.core import InputError
from eccentric.emission.adapt import CONFIDENCE, covariance_of_fit, identified_states
from eccentric.emission.backends import decimal, with_plain_text, wrapped
from eccentric.emission.check import limits, proof_command
from eccentric.emission.compensate.slopes import ZERO, steepness
from eccentric.emission.hot import executed, executed_beside, inputs_of, load_module
from eccentric.emission.program import build_program
from eccentric.emission.render import digest_of, render_beside
from eccentric.emission.templates import plain, template
from eccentric.model import LINEAR, TURNING, AxisKind, Model, regressor, spoken, spoken_quantity
from eccentric.model import vocabulary as v


@dataclass(frozen=True)
class _Spelled:
    """How a language writes what differs."""

    parameter: str
    choice: str
    also: str
    root: str
    exponential: str
    size: str


_C = _Spelled("p->{}", "(({0}) ? ({1}) : ({2}))", "&&", "sqrt", "exp", "fabs")
_PYTHON = _Spelled("p.{}", "(({1}) if ({0}) else ({2}))", "and", "math.sqrt", "_exp", "abs")


def spell(e: sp.Expr, letters: Mapping[str, str], language: _Spelled) -> str:
    """The expression, operation by operation in the same order in both languages."""

    def of(x: Any) -> str:
        if x.is_Symbol:
            return language.parameter.format(letters[x.name]) if x.name in letters else x.name
        if x.is_Number or x.is_NumberSymbol:
            return repr(float(x))
        if x.is_Add:
            return "(" + " + ".join(map(of, x.args)) + ")"
        if x.is_Mul:
            over = [f for f in x.args if f.is_Pow and f.exp.is_negative]
            top = " * ".join(of(f) for f in x.args if f not in over) or "1.0"
            return f"({top}{''.join(f' / {of(1 / f)}' for f in over)})"
        if x.is_Pow and x.exp.is_Integer:
            product = "(" + " * ".join([of(x.base)] * abs(int(x.exp))) + ")"
            return product if x.exp > 0 else f"(1.0 / {product})"
        if x.is_Pow and abs(x.exp) == sp.Rational(1, 2):
            root = f"{language.root}({of(x.base)})"
            return root if x.exp > 0 else f"(1.0 / {root})"
        if isinstance(x, sp.exp):
            return f"{language.exponential}({of(x.args[0])})"
        if isinstance(x, sp.Abs):
            return f"{language.size}({of(x.args[0])})"
        if isinstance(x, sp.Max | sp.Min):
            relation, (first, *rest) = (">" if isinstance(x, sp.Max) else "<"), map(of, x.args)
            for other in rest:
                first = language.choice.format(f"{first} {relation} {other}", first, other)
            return first
        if isinstance(x, sp.Piecewise):
            *cases, (last, _) = x.args
            text = of(last)
            for value, condition in reversed(cases):
                text = language.choice.format(f"{of(condition.lhs)} == {of(condition.rhs)}", of(value), text)
            return text
        raise InputError("compensation", "a formula of the parameters", str(x))

    return of(e)


# How much of the friction may be compensated: as much as the fit is sure is there.

MOST_WITHOUT_REFERENCE = 0.9
"""The most that may follow a measured velocity or a demanded torque."""
_DRAWS = 20_000


@dataclass(frozen=True)
class CompensationGain:
    """The gain g, and where it comes from, in words."""

    value: float
    origin: str


def gain_of(model: Model, fit: Mapping[str, Any] | None = None) -> CompensationGain:
    """The ratio of the friction that is there with 97.5 % to the model's, over the whole identified range.

    Of coefficients drawn by the fit's covariance, each draw has its least ratio of friction to the model's,
    over a turn and the speeds of the fit; g is the ratio that 97.5 % of the draws stay above. It is one bound
    of the torque at all states together: coefficients that are uncertain against each other cost nothing.

    Raises:
        InputError: the model has no friction to compensate.
    """
    fit = fit or {}
    columns = regressor(spoken(model))
    rows, values = identified_states(model, fit)
    if not len(rows):
        raise InputError(f"model {model.name}", "friction to compensate", "none")
    covariance = covariance_of_fit(columns, fit)
    if not covariance.any():
        stated = f"{MOST_WITHOUT_REFERENCE}, since without a fit the uncertainty of the friction is unknown"
        return CompensationGain(MOST_WITHOUT_REFERENCE, stated)
    value = sure_share(rows, values, covariance)
    return CompensationGain(
        value, f"{value}: with 97.5 % confidence, friction is nowhere below this share of the model's"
    )


def gravity_apart(model: Model) -> tuple[float, float]:
    """The largest gravity torque over a turn of the link, and the largest that is not the pendulum's [N m].

    A compensation of the friction has neither; the second is that of cogging, a spring or a constant load.
    """
    function = getattr(load_module(model), model.axis.named("gravity_torque"), None)
    if function is None:
        return 0.0, 0.0
    angle = np.linspace(0.0, 2.0 * math.pi, 720, endpoint=False)
    motor_angle = spoken_quantity(model.axis, v.theta_m).name
    carried = {q.name: q.default for q in model.parameters}
    given = {motor_angle: angle / float(carried.get("mu") or 1.0), "temperature": np.full_like(angle, 25.0)}
    values = (given.get(name, np.zeros_like(angle)) for name in inputs_of(function))
    torque = np.broadcast_to(function(*values), angle.shape)
    pendulum = sum(2.0 * np.mean(torque * wave) * wave for wave in (np.sin(angle), np.cos(angle)))
    loaded = carried.get("M") and carried.get("L")
    return float(np.abs(torque).max()), float(np.abs(torque - (pendulum if loaded else 0.0)).max())


def sure_share(rows: np.ndarray, values: np.ndarray, covariance: np.ndarray) -> float:
    """The share of a friction that is there at every state with 97.5 %, to three decimals, downwards.

    Args:
        rows: of the regressor (m, n), one for each state, with a friction above 0.
        values: of the coefficients (n,).
        covariance: of their errors (n, n).
    """
    squares, axes = np.linalg.eigh(covariance)
    drawn = np.random.default_rng(0).standard_normal((len(values), _DRAWS))
    errors = rows @ (axes * np.sqrt(np.maximum(squares, 0.0)) @ drawn)
    least = 1.0 + np.min(errors / (rows @ values)[:, None], axis=0)
    found = float(np.quantile(least, 1.0 - CONFIDENCE))
    # Further decimals are of the draws.
    return math.floor(1000.0 * min(max(found, 0.0), 1.0)) / 1000.0


# The settings, with what is required of them and their defaults by the kind of axis.

_LARGEST = {"single": float.fromhex("0x1.fffffep127"), "double": sys.float_info.max}
_STEP = {TURNING: 6.283185307179586 / 4096, LINEAR: 1e-6}
_TICK = 1e-3
_WIDTH, _FADE = {TURNING: 0.1, LINEAR: 5e-4}, {TURNING: 1.0, LINEAR: 5e-3}
_FASTEST = {TURNING: 100.0, LINEAR: 1.0}
_PUSH = {TURNING: 0.1, LINEAR: 1e-3}


@dataclass(frozen=True)
class LoopSetting:
    """One number of the settings."""

    name: str
    default: float
    doc: str


def settings_of(axis: AxisKind, gain: CompensationGain) -> list[LoopSetting]:
    """The numbers that a user sets, in their order."""
    speed, angle = axis.unit("rad/s"), axis.unit("rad")
    tick = _STEP[axis] / _TICK
    return [
        LoopSetting("gain", gain.value, "g: share of the friction compensated from a measurement [1]"),
        LoopSetting("feedforward", 1.0, "share of the friction compensated from the reference [1]"),
        LoopSetting("speed_max", _FASTEST[axis], f"the compensation is constant above this speed [{speed}]"),
        LoopSetting(
            "width",
            _WIDTH[axis],
            f"speed at which the full level is reached, instead of a jump at 0 [{speed}]",
        ),
        LoopSetting("encoder_step", _STEP[axis], f"one step of the encoder [{angle}]"),
        LoopSetting("tick", _TICK, "time between two calls [s]"),
        LoopSetting("band", tick, f"measured speed that is taken as 0, at least encoder_step/tick [{speed}]"),
        LoopSetting("fade", _FADE[axis], f"speed beyond the band at which the push has faded out [{speed}]"),
        LoopSetting(
            "push_width",
            _PUSH[axis],
            f"input of the full push: an error beyond one encoder_step [{angle}], or a"
            f" {axis.term('torque')} [{axis.unit('N m')}]",
        ),
    ]


def view(model: Model, gain: CompensationGain, digest: str, source: str) -> dict[str, Any]:
    """All variables of the templates but the Lipschitz constants of the defaults.

    `digest` is that of the model's program, as its header spells it; `source` is its C.
    """
    axis = model.axis
    program = with_plain_text(build_program(model))
    budget = next((r for r in program.routines if r.name == "friction_budget"), None)
    if budget is None:
        raise InputError(f"model {model.name}", "friction_budget", "none", why="to compensate friction")
    taken = [x.quantity for x in budget.inputs]
    angle, speed, torque = (spoken_quantity(axis, q).name for q in (v.theta_m, v.omega_m, v.torque))
    reference = f"{speed.removesuffix('_m')}_ref"
    demand = f"{torque}_demand" if torque in {q.name for q in taken} else torque
    own = [(q, limits(q, axis)) for q in taken if q.name not in (angle, speed)]
    arguments = {
        angle: f"{axis.text('motor angle')}, of the reference or as measured [{axis.unit('rad')}]",
        reference: f"{axis.text('motor velocity')} of the reference [{axis.unit('rad/s')}]",
        speed: f"{axis.text('motor velocity')} as measured [{axis.unit('rad/s')}]",
        "error": f"{axis.text('motor angle')} of the reference minus measured [{axis.unit('rad')}]",
        demand: f"{axis.term('torque')} of the loop without compensation [{axis.unit('N m')}]",
        **{q.name: f"{plain(q.meaning)} [{plain(q.unit)}], {a:g} to {b:g}" for q, (a, b) in own},
    }
    steep = steepness(model)
    letters = {q.name: axis.named(q.name) for q in model.parameters}
    settings = settings_of(axis, gain)
    return {
        "name": model.name,
        "guard": model.name.upper(),
        "digest": digest,
        "said": axis.text,
        "settings": settings,
        "values": [{"name": s.name} | _decimals(s.default) for s in settings],
        "gain": gain,
        "gravity": "" if (largest := gravity_apart(model)[0]) == 0.0 else f"{largest:.3g}",
        "most": MOST_WITHOUT_REFERENCE,
        "above": "1.000001",
        "smallest": "1e-6",
        "largest": "1e6",
        "fastest": f"{limits(v.omega_m)[1]:.1f}",
        "arguments": [{"name": x, "doc": doc, "typed": f"{x}: Any"} for x, doc in arguments.items()],
        "reference": reference,
        "speed": speed,
        "demand": demand,
        "unused": [] if angle in {q.name for q in taken} else [angle],
        "called": ["w" if q.name == speed else q.name for q in taken],
        "signature": wrapped(
            "ECCENTRIC_REAL",
            f"{model.name}_compensation",
            [
                *(f"ECCENTRIC_REAL {x}" for x in arguments),
                f"const {model.name}_compensation_settings *settings",
                f"const {model.name}_coefficients *c",
            ],
        ),
        "steep": {
            "c": [f"const double {x} = {spell(e, letters, _C)};" for x, e in steep.assignments],
            "python": [f"{x} = {spell(e, letters, _PYTHON)}" for x, e in steep.assignments],
            # The size of a level, then the slopes by angle, speed and what else there is.
            "found": [
                {"c": spell(x, letters, _C), "python": spell(x, letters, _PYTHON)}
                for x in (
                    steep.size,
                    *(steep.by.get(x, ZERO) for x in (angle, speed, *(q.name for q, _ in own))),
                )
            ],
            "own": [q.name for q, _ in own],
        },
        "derived": [
            {"name": letters[q.name], "value": spell(q.default, letters, _PYTHON)}
            for q in model.parameters
            if q.default is not None and q.default.free_symbols
        ],
        "proved": [
            {"name": angle, **_range(*limits(v.theta_m))},
            *({"name": x, "low": "-LARGEST", "high": "LARGEST"} for x in (reference, speed, "error", demand)),
            *({"name": q.name, **_range(*ends)} for q, ends in own),
        ],
        "command": proof_command(f"{model.name}_compensation", source),
    }


def _range(low: float, high: float) -> dict[str, str]:
    return {"low": repr(float(low)), "high": repr(float(high))}


def _decimals(x: float) -> dict[str, str]:
    """A number as C writes it, in both precisions; one beyond them is the largest that there is."""
    with mpmath.workdps(30):
        return {key: decimal(mpmath.mpf(min(x, most)), key == "single") for key, most in _LARGEST.items()}


def render_compensation(
    model: Model,
    files: Mapping[str, str],
    gain: CompensationGain,
    command: str = "eccentric emit --compensation",
) -> dict[str, str]:
    """The files of the compensation, file name -> text.

    Args:
        model: what was emitted, with its defaults.
        files: the output of `render`, with the C and the NumPy module.
        gain: that of the defaults.
        command: that writes the files, for their banner.

    Raises:
        InputError: the friction of the model has an operation whose slope is not bounded.
    """
    seen = view(model, gain, digest_of(model, files), files[f"{model.name}.c"])
    python = template("compensate/module.py").render(seen)
    # The constants of the defaults are those that the module computes.
    found = executed_beside(executed(files, model.name), model.name, python).lipschitz()
    seen |= {
        "constants": [f"{x:.4g} {model.axis.unit('N m')} per unit" for x in found.values()],
        "lipschitz": [_decimals(x) for x in found.values()],
    }
    return render_beside(model, "compensate", "compensation", seen, "Friction compensation.", command)
