"""What the templates of the compensation see, and the files that they give."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eccentric.core import InputError
from eccentric.emission.backends import BACKENDS, decimal, with_plain_text, wrapped
from eccentric.emission.check import limits, proof_command
from eccentric.emission.compensate.gain import MOST_WITHOUT_REFERENCE, Gain
from eccentric.emission.compensate.slopes import ZERO, Bound, Walk
from eccentric.emission.program import build_program
from eccentric.emission.templates import plain, template
from eccentric.model import LINEAR, TURNING, AxisKind, Model, spoken, spoken_quantity
from eccentric.model import vocabulary as v
from eccentric.model.rest import levels
from eccentric.version import __version__

# Assignments in the language of C and of Python, of formulas in the parameters.


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
_PYTHON = _Spelled("p.{}", "(({1}) if ({0}) else ({2}))", "and", "math.sqrt", "math.exp", "abs")


def spell(e: sp.Expr, parameters: frozenset[str], language: _Spelled) -> str:
    """The expression, operation by operation in the same order in both languages."""

    def of(x: Any) -> str:
        if x.is_Symbol:
            return language.parameter.format(x.name) if x.name in parameters else x.name
        if x.is_Number:
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


# How steep the compensation is: bounds of the budget, one assignment after the other.


@dataclass(frozen=True)
class Steepness:
    """Assignments name = formula, and the names of what the constants follow from.

    Attributes:
        assignments: in the order of their computation; of the parameters and of `speed_max`.
        size: the largest level of dry friction.
        by: input -> the largest slope of the friction in one direction of motion.
    """

    assignments: tuple[tuple[str, sp.Expr], ...]
    size: sp.Expr
    by: Mapping[str, sp.Expr]


FASTEST = sp.Symbol("speed_max", nonnegative=True)


def steepness(model: Model) -> Steepness:
    """Of the friction of a model in the letters of its axis, from its own levels."""
    omega_m = v.omega_m.symbol
    friction = tuple(t for t in model.balance("mechanical").terms if t.kind == "friction")
    found = levels(model, omega_m, friction)
    inputs = {q.symbol: q for q in (*model.inputs, *(state.quantity for state in model.states))}
    sizes = {x: sp.Float(max(map(abs, limits(q, model.axis)))) for x, q in inputs.items()}
    never = frozenset(x for x, q in inputs.items() if q.domain in ("nonnegative", "positive"))
    walk = Walk(sizes | {omega_m: FASTEST}, never)
    listed: list[tuple[str, sp.Expr]] = []

    def named(name: str, value: sp.Expr) -> sp.Expr:
        if value.is_Atom:
            return value
        listed.append((name, value))
        return sp.Symbol(name, nonnegative=True)

    def kept(name: str, bound: Bound) -> Bound:
        by = {x: named(f"{name}_by_{x.name}", k) for x, k in bound.slopes.items()}
        least = None if bound.least is None else named(f"{name}_least", bound.least)
        return Bound(named(f"{name}_size", bound.size), least, by)

    definitions = [(d.symbol, d.value) for d in model.definitions]
    definitions += [(a.target, a.value) for a in found.definitions]
    sides = (found.forward, found.backward)
    needed = {x for side in sides for e in (side.dry, side.viscous) for x in e.free_symbols}
    for symbol, value in reversed(definitions):
        if symbol in needed:
            needed |= value.free_symbols
    for symbol, value in definitions:
        if symbol in needed:
            walk.define(symbol, kept(symbol.name, walk(value)))
    dry = [kept(f"dry_{k}", walk(side.dry)) for k, side in enumerate(sides)]
    wet = [kept(f"viscous_{k}", walk(side.viscous * omega_m)) for k, side in enumerate(sides)]
    slopes = {
        x: named(
            f"friction_by_{x.name}",
            sp.Max(*(d.slopes.get(x, ZERO) + b.slopes.get(x, ZERO) for d, b in zip(dry, wet, strict=True))),
        )
        for x in inputs
        if any(x in one.slopes for one in (*dry, *wet))
    }
    size = named("level_size", sp.Max(*(d.size for d in dry)))
    by = {spoken_quantity(model.axis, inputs[x]).name: k for x, k in slopes.items()}
    return Steepness(tuple(listed), size, by)


# The settings, with what is required of them and their defaults by the kind of axis.

_STEP = {TURNING: 6.283185307179586 / 4096, LINEAR: 1e-6}
_TICK = 1e-3
_WIDTH, _FADE = {TURNING: 0.1, LINEAR: 5e-4}, {TURNING: 1.0, LINEAR: 5e-3}
_FASTEST = {TURNING: 100.0, LINEAR: 1.0}
_PUSH = {TURNING: 0.1, LINEAR: 1e-3}


@dataclass(frozen=True)
class Setting:
    """One number of the settings."""

    name: str
    default: float
    doc: str


def settings(axis: AxisKind, gain: Gain) -> list[Setting]:
    """The numbers that a user sets, in their order."""
    speed, angle = axis.unit("rad/s"), axis.unit("rad")
    tick = _STEP[axis] / _TICK
    return [
        Setting("gain", gain.value, "g: share of the friction that may follow a measurement [1]"),
        Setting("feedforward", 1.0, "share of the friction that is fed forward from the reference [1]"),
        Setting("speed_max", _FASTEST[axis], f"beyond this speed the compensation is constant [{speed}]"),
        Setting("width", _WIDTH[axis], f"speed at which a level is reached, in place of a jump at 0 [{speed}]"),
        Setting("encoder_step", _STEP[axis], f"one step of the encoder [{angle}]"),
        Setting("tick", _TICK, "time between two calls [s]"),
        Setting("band", tick, f"measured speed that counts as none, at least encoder_step/tick [{speed}]"),
        Setting("fade", _FADE[axis], f"speed beyond the band at which the push has faded out [{speed}]"),
        Setting(
            "push_width",
            _PUSH[axis],
            f"what the push is whole at, beyond one encoder_step: an error [{angle}], or a {axis.term('torque')}"
            f" [{axis.unit('N m')}]",
        ),
    ]


def view(model: Model, gain: Gain, digest: str, source: str) -> dict[str, Any]:
    """All variables of the templates.

    `digest` is that of the model's program, as its header spells it; `source` is its C.
    """
    axis, shown = model.axis, spoken(model)
    program = with_plain_text(build_program(model))
    budget = next((r for r in program.routines if r.name == "friction_budget"), None)
    if budget is None:
        raise InputError(f"model {model.name}", "friction_budget", "none", why="to compensate friction")
    names = {q.name: spoken_quantity(axis, q).name for q in (v.theta_m, v.omega_m, v.torque)}
    speed, angle, torque = names["omega_m"], names["theta_m"], names["torque"]
    reference = speed.removesuffix("_m") + "_ref"
    demand = torque if torque not in {x.quantity.name for x in budget.inputs} else f"{torque}_demand"
    own = [x.quantity for x in budget.inputs if x.quantity.name not in (angle, speed)]
    ranges = [(q, limits(q, axis)) for q in own]
    arguments = [
        (angle, f"{axis.text('motor angle')}, of the reference or measured [{axis.unit('rad')}]"),
        (reference, f"{axis.text('motor velocity')} of the reference [{axis.unit('rad/s')}]"),
        (speed, f"{axis.text('motor velocity')} as measured [{axis.unit('rad/s')}]"),
        ("error", f"reference minus measured {axis.text('motor angle')} [{axis.unit('rad')}]"),
        (demand, f"{axis.term('torque')} that the loop demands, without compensation [{axis.unit('N m')}]"),
        *((q.name, f"{plain(q.meaning)} [{plain(q.unit)}], {a:g} to {b:g}") for q, (a, b) in ranges),
    ]
    steep = steepness(model)
    letters = frozenset(q.name for q in shown.parameters) | frozenset(q.name for q in model.parameters)
    letter = {q.name: axis.named(q.name) for q in model.parameters}
    return {
        "name": model.name,
        "guard": model.name.upper(),
        "digest": digest,
        "said": axis.text,
        "settings": settings(axis, gain),
        "gain": gain,
        "most": MOST_WITHOUT_REFERENCE,
        "arguments": [{"name": name, "doc": doc} for name, doc in arguments],
        "angle": angle,
        "reference": reference,
        "speed": speed,
        "demand": demand,
        "unused": [] if angle in {x.quantity.name for x in budget.inputs} else [angle],
        "called": ", ".join("w" if x.quantity.name == speed else x.quantity.name for x in budget.inputs),
        "extra": [q.name for q in own],
        "signature": wrapped(
            "ECCENTRIC_REAL",
            f"{model.name}_compensation",
            [
                *(f"ECCENTRIC_REAL {name}" for name, _ in arguments),
                f"const {model.name}_compensation_settings *settings",
                f"const {model.name}_coefficients *c",
            ],
        ),
        "steep": {
            "c": _lines(steep, letters, letter, _C),
            "python": _lines(steep, letters, letter, _PYTHON),
            "by_angle": str(steep.by.get(angle, "0.0")),
            "by_speed": str(steep.by.get(speed, "0.0")),
            "by": [str(steep.by.get(q.name, "0.0")) for q in own],
            "size": str(steep.size),
        },
        "command": proof_command(f"{model.name}_compensation", source),
        "ranges": [{"name": q.name, "low": a, "high": b} for q, (a, b) in ranges],
        "decimal": _decimals,
    }


def _lines(
    steep: Steepness, letters: frozenset[str], letter: Mapping[str, str], language: _Spelled
) -> list[str]:
    renamed = {sp.Symbol(x): now for x, now in letter.items()}
    del renamed
    start, end = ("const double ", ";") if language is _C else ("", "")
    return [f"{start}{name} = {spell(value, letters, language)}{end}" for name, value in steep.assignments]


def _decimals(x: float) -> dict[str, str]:
    import mpmath

    with mpmath.workdps(30):
        return {"single": decimal(mpmath.mpf(x), True), "double": decimal(mpmath.mpf(x), False)}


def render_compensation(
    model: Model,
    files: Mapping[str, str],
    gain: Gain,
    constants: Callable[[str], Any],
    command: str = "eccentric emit --compensation",
) -> dict[str, str]:
    """The files of the compensation, file name -> text."""
    raise NotImplementedError
