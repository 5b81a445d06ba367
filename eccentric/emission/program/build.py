"""Model to Program: each function's definitions, differentiated, parameter-only parts split off, lowered."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import sympy as sp

from eccentric.emission.program.accuracy import of_functions, promises
from eccentric.emission.program.choice import WHOLE, Choice
from eccentric.emission.program.distinct import require_distinct
from eccentric.emission.program.functions import Function, closure, functions
from eccentric.emission.program.group import grouped
from eccentric.emission.program.half_turn import HalfTurns
from eccentric.emission.program.lower import Lowering
from eccentric.emission.program.prepare import Prepare, notes
from eccentric.emission.program.program import (
    Assignment,
    Helper,
    Input,
    Program,
    Routine,
    differentiate,
    needed,
)
from eccentric.emission.program.shift import written_out
from eccentric.emission.program.shorten import shortened, without_copies
from eccentric.emission.program.spoken import spoken_program
from eccentric.errors import InputError
from eccentric.model import Magnitude, Model, Quantity
from eccentric.model import vocabulary as v

_LABELLED = {
    "REGRESSOR": "regressor",
    "GRADIENT": "friction_torque_gradient",
    "JACOBIAN": "friction_torque_jacobian",
}
"""Constant of a module -> the function whose results it names."""


def build_program(model: Model, choice: Choice = WHOLE) -> Program:
    """The Program of a model: the functions of `eccentric.emission.program.functions`, ready to print.

    Raises:
        InputError: a quantity has the name of a value that the code computes; there is no function of a
            chosen name, or none that depends on a parameter; or fixed ones that they need are not given.
    """
    shared = Prepare(model)
    half_turns = HalfTurns(shared)
    known = {q.name: q for q in vars(v).values() if isinstance(q, Quantity)}
    given = functions(model)
    names = choice.of([f.name for f in given])
    chosen = [f for f in given if f.name in names]
    from_table = all(q.default == known.get(q.name, q).default for q in model.parameters)
    routines = tuple(_routine(model, f, shared, half_turns) for f in chosen)
    called = {s for r in routines for a in r.assignments for s in a.value.free_symbols}
    helpers = tuple(h for h in half_turns.helpers if sp.Symbol(h.name) in called)
    labels, said = {r.name: r.labels for r in routines}, model.axis.said
    first = said(model.first_function)
    program = Program(
        name=model.name,
        title=model.title,
        parameters=model.parameters,
        prepare=shortened(shared.assignments),
        coefficients=_used((*helpers, *routines), shared),
        routines=routines,
        constants=tuple((name, labels[said(of)]) for name, of in _LABELLED.items() if said(of) in labels),
        notes=notes(model, shared),
        states=tuple((state.quantity, state.initial) for state in model.states),
        defaults=model.defaults
        or ("Table 1 of the paper with mu = 1/5" if from_table else "those of the derivation"),
        helpers=helpers,
        promises=of_functions(promises(model), names),
        first=first if first in names else names[0],
        chosen=bool(choice.functions),
        arrays=choice.arrays if any(r.inputs for r in routines) else "none",
        fixed=choice.fixed,
    )
    program = spoken_program(program, model.axis)
    require_distinct(program)
    if choice.functions and not program.coefficients:
        raise InputError(
            f"functions: one that depends on a parameter is required, received {', '.join(choice.functions)},"
            f" which {program.name} gives the same value for all parameters"
        )
    if absent := [q.name for q in model.parameters if q.default is None] if _lacks(program) else []:
        raise InputError(
            f"fixed: a value of {' and '.join(absent)} is required, which {program.name} has no default for:"
            " emit it with parameters, or choose functions that need none of them"
        )
    return program


def _lacks(program: Program) -> bool:
    """Whether coefficients that cannot be changed are not given."""
    return program.fixed and not program.ungiven.isdisjoint(program.coefficients)


def _routine(model: Model, function: Function, shared: Prepare, half_turns: HalfTurns) -> Routine:
    fixed = model.parameter_symbols
    needs = closure(model, function.results, function.definitions)
    assignments, results = _unscaled(*written_out(needs, function.results, fixed))
    slopes: Mapping[tuple[sp.Symbol, sp.Symbol], sp.Symbol] = {}
    if function.by:
        y = sp.Symbol("torque", real=True)
        torque = results[0][1]
        if not fixed.intersection(function.by):
            torque = grouped(fixed, frozenset(), torque)
        steps, slopes = differentiate((*assignments, Assignment(y, torque)), function.by)
        gradient = {slopes[y, x]: x.name for x in function.by if (y, x) in slopes}
        found = {gradient[a.target]: a.value for a in steps if a.target in gradient}
        value = [(label, torque) for label, _ in results if label]
        results = value + [(x.name, found[x.name]) for x in function.by if x.name in found]
        assignments = needed([a for a in steps if a.target not in gradient], [e for _, e in results])
    chained = frozenset(slopes.values())
    # Parts that depend on parameters only are moved to `prepare`; the rest keeps its order.
    lowering = Lowering(shared, half_turns)
    for assignment in assignments:
        if assignment.target in shared.symbols or assignment.value.free_symbols <= shared.symbols:
            shared.define(assignment.target, assignment.value)
        else:
            value = lowering(shared.hoist(grouped(fixed, chained, assignment.value)))
            lowering.assignments.append(replace(assignment, value=value))
    targets = []
    for label, expression in results:
        value = lowering(shared.hoist(grouped(fixed, chained, expression)))
        name = f"result_{label}" if label else "result"
        targets.append(sp.Symbol(name, real=True))
        lowering.assignments.append(Assignment(targets[-1], value))
    used = set().union(*(a.value.free_symbols for a in lowering.assignments))
    states = [state.quantity for state in model.states]
    order = sorted([*model.inputs, *states, v.dt], key=lambda q: (q.name == "alpha_m", q.name == "dt"))
    inputs = [Input(q) for q in order if q.symbol in used or (function.requires and q.name == "alpha_m")]
    return Routine(
        name=function.name,
        inputs=tuple(inputs),
        assignments=without_copies(shortened(lowering.assignments), targets),
        results=tuple(targets),
        labels=tuple(label for label, _ in results) if results[0][0] else (),
        unit=function.unit,
        meaning=function.meaning,
        requires=function.requires,
    )


def _unscaled(
    assignments: Sequence[Assignment], results: Sequence[tuple[str, sp.Expr]]
) -> tuple[list[Assignment], list[tuple[str, sp.Expr]]]:
    """F_N = scale_N load is written out, so that its scale goes into the coefficients that multiply it."""
    load = sp.Symbol("load", real=True)
    scaled: dict[sp.Symbol, sp.Expr] = {}
    written: list[Assignment] = []
    for a in assignments:
        factors = sp.Mul.make_args(a.value)
        magnitude = [factor for factor in factors if isinstance(factor, Magnitude)]
        if a.target == v.F_N.symbol and magnitude:
            scaled[a.target] = a.value.xreplace({magnitude[0]: load})
            written.append(Assignment(load, magnitude[0], "normal force over scale_N [rad^2/s^2]"))
        else:
            written.append(replace(a, value=a.value.xreplace(scaled)))
    return written, [(label, expression.xreplace(scaled)) for label, expression in results]


def _used(parts: tuple[Helper | Routine, ...], shared: Prepare) -> tuple[sp.Symbol, ...]:
    used = set().union(*(a.value.free_symbols for part in parts for a in part.assignments))
    order = [a.target for a in shared.assignments]
    plain = sorted((s for s in used & shared.symbols if s not in order), key=str)
    return (*plain, *(symbol for symbol in order if symbol in used))
