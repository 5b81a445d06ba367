"""The variables of the templates of the JAX module: the Program as lines of Python, nothing symbolic."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import sympy as sp

from eccentric.emission.backends.backend import number, used_series
from eccentric.emission.backends.python.dialect import (
    ON_PARAMETERS,
    WIDTH,
    Dialect,
    Language,
    broken,
    choice_of_pairs,
    on_samples,
    printed,
)
from eccentric.emission.backends.python.functions import nan_without, quoted
from eccentric.emission.backends.python.module import module, series, stepped
from eccentric.emission.program import (
    COSINE,
    LEADING_BITS,
    ROUNDER,
    SINE_RATIO,
    Call,
    Minus,
    Over,
    Pick,
    Plus,
    Program,
    Times,
    TurnLeft,
    paired,
)

_NONZERO = sp.Symbol("nonzero")


def differentiable(program: Program) -> Program:
    """The program with kernels that JAX compiles and differentiates; their values are the same.

    Rounding by adding and subtracting one number, which XLA would cancel, is a call. A branch that is not
    taken never divides by 0, since derivatives would propagate the result. And a missing parameter needs no
    gate: no function that reads it is called without it.
    """

    def rewritten(parts: Iterable[Any]) -> tuple[Any, ...]:
        return tuple(
            replace(p, assignments=tuple(replace(a, value=_smooth(a.value)) for a in p.assignments))
            for p in parts
        )

    pairs = paired(program)  # they are guarded where they are divided
    prepare = tuple(a if a.target in pairs else replace(a, value=_guarded(a.value)) for a in program.prepare)
    helpers, routines = rewritten(program.helpers), rewritten(program.routines)
    return replace(program, prepare=prepare, helpers=helpers, routines=routines)


def _guarded(e: sp.Expr) -> sp.Expr:
    """A choice by parameters, without a division by 0 in the branch that is not taken."""
    if not isinstance(e, sp.Piecewise):
        return e
    divisors = {p for value, _ in e.args for p in value.atoms(sp.Pow) if p.exp.is_negative}
    guarded = {p: Call(_NONZERO, p.base) ** p.exp for p in divisors}
    return sp.Piecewise(*((value.xreplace(guarded), condition) for value, condition in e.args))


def _smooth(e: sp.Expr) -> sp.Expr:
    e = e.func(*map(_smooth, e.args)) if e.args else e
    if isinstance(e, Minus) and e.args[1] == ROUNDER and isinstance(e.args[0], Plus):
        return Call(sp.Symbol("rounded_off"), e.args[0].args[0])
    if isinstance(e, Pick) and e.args[1].name == "==" and e.args[2] == 0:
        by, _, _, x, y = e.args
        if (x, y) == (1, Over(1, by)):
            return Over(1, Call(_NONZERO, by))
        if x == 0 and isinstance(y, Times) and y.args[1] == by:
            return y
    return e


def _pair(e: sp.Expr, pairs: frozenset[sp.Symbol], plain: Language, name: Callable[[str], str]) -> str:
    if isinstance(e, sp.Piecewise):
        return choice_of_pairs(e, lambda value: _pair(value, pairs, plain, name), plain)
    inner = {
        part: f"_turn_less({', '.join(printed(a, plain) for a in part.args)})"
        if isinstance(part, TurnLeft)
        else f"_pair({printed(part, plain)})"
        for part in e.atoms(sp.Function)
    }
    spelled = {text: text for text in inner.values()} | {s.name: name(s.name) for s in pairs}
    spelling = replace(
        plain,
        symbol=lambda s: spelled.get(s) or f"_pair({plain.symbol(s)})",
        number=lambda decimal: f"_pair({number(decimal)})",
    )
    return printed(e.xreplace({part: sp.Symbol(text) for part, text in inner.items()}), spelling)


def _broken(line: str) -> list[str]:
    """A choice that is too long takes a line for each of its arguments."""
    head, call, arguments = line.partition("_choose(")
    if len(line) <= WIDTH or not call:
        target, _, value = line.partition(" = ")
        return broken(f"{target} = ", value)
    parts, depth = [""], 0
    for c in arguments[:-1]:
        depth += (c == "(") - (c == ")")
        if c == "," and not depth:
            parts.append("")
        else:
            parts[-1] += c
    return [f"{head}{call}", *(f"    {part.strip()}," for part in parts), ")"]


DIALECT = Dialect(
    kernel=on_samples("jnp")
    | {
        "sqrt": "_sqrt({0})",
        "sine_ratio": "_sine_ratio({0})",
        "cosine": "_cosine({0})",
        "rounded_off": "jnp.round({0})",
        "nonzero": "_nonzero({0})",
    },
    prepare=ON_PARAMETERS
    | {"sqrt": "_sqrt({0})", "nonzero": "_nonzero({0})"}
    | {name: f"_math({{0}}).{name}({{0}})" for name in ("sin", "cos", "exp")},
    where="jnp.where({0}, {1}, {2})",
    choice="_choose({0}, {1}, {2})",
    decorator="_function",
    missing="0.0",  # derivatives of what is not computed are finite
    divisor="1.0",
    pair=_pair,
    broken=_broken,
    single=False,  # coefficients have the same names in both precisions
    guarded=True,
)


def view(program: Program, _: str) -> dict[str, Any]:
    """All variables of the templates of the JAX module."""
    guarded = any(nan_without(program, r) for r in program.routines)
    vectors = any(x.length for r in program.routines for x in r.inputs)
    options = ["needs", *(["nan_without"] if guarded else []), *(["vectors"] if vectors else [])]
    options += ["steps"] if program.conditions else []
    return {
        **module(differentiable(program), DIALECT),
        "guarded": guarded,
        "options": ", ".join(f"{name}=()" for name in options),
        "passed": ", ".join(f"{name}={name}" for name in options),
        "wraps": program.axis.wraps,
        "leading": LEADING_BITS,
        # Each is in the derivative of the other.
        "polynomials": [series(s.name) for s in (SINE_RATIO, COSINE)] if used_series(program) else [],
        "vectors": vectors,
        **_states(program),
    }


def _states(program: Program) -> dict[str, Any]:
    """How the hidden states are passed to `next_state`; empty for a model without."""
    states, passed = [q.name for q, _ in program.states], stepped(program)
    logged = [name for name in passed if name not in states]
    lengths = {x.quantity.name: x.length for r in program.routines for x in r.inputs}
    absent = [name for r in program.routines if r.name == "next_state" for name in nan_without(program, r)]
    return {
        "initial": [repr(float(value)) for _, value in program.states],
        "stepped": [f"state[{states.index(name)}]" if name in states else name for name in passed],
        "logged": logged,
        "named": quoted(logged),
        "nan_without": quoted(absent) if absent else "",
        "lengths": tuple(lengths[name] for name in logged),
    }
