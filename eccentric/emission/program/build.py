"""Model to Program: each function's definitions, differentiated, parameter-only parts split off, lowered."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Literal, NamedTuple

import sympy as sp

from eccentric.core import InputError, meant
from eccentric.emission.program.accuracy import promises
from eccentric.emission.program.lower import HalfTurns, Lowering, written_out
from eccentric.emission.program.prepare import Prepare, notes
from eccentric.emission.program.program import (
    BELOW,
    Condition,
    Helper,
    Pick,
    Program,
    Routine,
    shortened,
    without_copies,
)
from eccentric.model import (
    TURNING,
    Assignment,
    AxisKind,
    Backward,
    ByDirection,
    Expressions,
    Forward,
    Gated,
    Input,
    Interface,
    Model,
    Output,
    Quantity,
    Sgn,
    cached,
    differentiate,
    interface_of,
    levels,
    needed,
    spoken_quantity,
    spoken_symbol,
    structure_of,
)
from eccentric.model import vocabulary as v


def stepped(routines: Iterable[Routine]) -> frozenset[str]:
    """The names of those that solve for a motion, from a torque."""
    return frozenset(r.name for r in routines if any(x.quantity.name == v.torque.name for x in r.inputs))


def conditions(model: Model) -> tuple[Condition, ...]:
    """Those of dry friction that follows loads with the acceleration in them, such as the transmitted torque.

    At rest such friction takes a share of an acceleration. Where that is as large as the inertia, a time step
    has no solution or several. The shares of several loads add up: each condition has the sum up to its
    parameter, so that the first one that fails names the parameter with which the sum becomes too large. If
    the slope of a load depends on the state, as that of F_N of the rotating link, parameters alone decide
    nothing: `inertial_loss` evaluates it.
    """
    alpha, omega = v.alpha_m.symbol, v.omega_m.symbol
    if model.declares is not None:
        return ()
    terms = tuple(t for t in model.balance("mechanical").terms if t.kind == "friction")
    if not any(alpha in model.expand(t.value).free_symbols for t in terms):
        return ()
    found = levels(model, omega, terms)

    def expanded(e: sp.Expr) -> sp.Expr:
        for a in reversed(found.definitions):
            e = e.xreplace({a.target: a.value})
        return model.expand(e)

    place = {q.symbol: k for k, q in enumerate(model.parameters)}
    listed: dict[sp.Expr, Condition] = {}
    for level in (found.forward.dry, found.backward.dry):
        # A level that is cut at 0 has the slope of what is cut.
        dry = sp.expand(
            level.replace(sp.Max, lambda *x: sp.Add(*x) if 0 in x and len(x) == 2 else sp.Max(*x))
        )
        shares: list[list[tuple[sp.Symbol, sp.Expr]]] = []  # of each load, by its sign
        for load in sorted(dry.free_symbols - model.parameter_symbols, key=str):
            gain = sp.diff(expanded(load), alpha)
            if gain == 0 or not gain.free_symbols <= model.parameter_symbols:
                continue
            share = []
            for sign in (1, -1):
                slope = sp.diff(dry.xreplace({sp.Abs(load): sign * load}), load).subs({omega: 0, load: 0})
                own = sorted(slope.free_symbols & place.keys(), key=place.__getitem__)
                if own and slope.free_symbols <= model.parameter_symbols:
                    share.append((own[-1], sp.Abs(slope * gain)))
            shares += [share] if share else []
        sums: Iterable[sp.Expr] = [sp.Integer(0)]
        for share in sorted(shares, key=lambda share: place[share[0][0]]):
            added = {before + loss: last for before in sums for last, loss in share}
            sums = added.keys()
            for loss, last in added.items():
                listed.setdefault(loss, Condition(last, loss, model.inertia))
    return tuple(listed.values())


Arrays = Literal["with", "beside", "none"]


@dataclass(frozen=True)
class Choice:
    """A choice of what to emit."""

    # their names, without those of arrays and the step of hidden states; none chosen is all
    functions: tuple[str, ...] = ()
    arrays: Arrays = "with"  # where C has its array functions: in the header, in one of their own, or nowhere
    # whether C has the default parameters only: neither a structure of parameters nor `prepare`
    fixed: bool = False

    def of(self, outputs: Sequence[Output]) -> tuple[Output, ...]:
        """Those of a model's outputs that are emitted, in their order.

        Raises:
            InputError: there is no function of a chosen name.
        """
        offered = [output.name for output in outputs if not output.advances]
        former = {output.formerly: output.name for output in outputs if output.formerly}
        for name in self.functions:
            if name in former:
                raise InputError("functions", former[name], f"{name!r}, its former name")
            if name not in offered:
                known = f"expected one of {', '.join(offered)}"
                raise InputError("functions", problem=f"{known}, got {name!r}{meant(name, offered)}")
        return tuple(
            output
            for output in outputs
            if output.advances or (output.name in self.functions if self.functions else not output.on_request)
        )


WHOLE = Choice()


@cache
def grouped(
    moved: tuple[sp.Symbol, ...],
    fixed: frozenset[sp.Symbol],
    slopes: frozenset[sp.Symbol],
    expression: sp.Expr,
) -> sp.Expr:
    """Friction as (... F_N + ...) omega_m + (... F_N + ...) sgn: fewest operations per call, (18)-(20).

    Args:
        moved: what is written once beside signs, such as the velocity; without any, sums stay as they are.
        fixed: symbols that depend on parameters only.
        slopes: derivatives of earlier values, which enter proportionally by the chain rule.
        expression: the friction torque, or a derivative of it.
    """
    if not moved or not isinstance(expression, sp.Add):
        return expression
    if inner := sorted(expression.free_symbols & slopes, key=str):
        parts = sp.collect(sp.expand_mul(expression), inner, evaluate=False)
        return sp.Add(*(slope * grouped(moved, fixed, slopes, factor) for slope, factor in parts.items()))
    expression = _by_direction(fixed, sp.expand_mul(expression))
    factors: list[sp.Expr] = [x for x in moved if expression.has(x)]
    factors += sorted(expression.atoms(Sgn), key=str)
    if any(isinstance(term, sp.Mul) and term.has(*factors) for term in expression.args if factors):
        return _collected(expression, factors)
    return expression


def _collected(expression: sp.Expr, factors: list[sp.Expr]) -> sp.Expr:
    """The sum with each of the factors written once, in front of its terms."""
    parts: dict[sp.Expr, list[sp.Expr]] = {}
    for term in expression.args:
        own = sp.Mul.make_args(term)
        shared = next((factor for factor in factors if factor in own), sp.Integer(1))
        parts.setdefault(shared, []).append(term / shared)
    return sp.Add(*(shared * sp.Add(*rest) for shared, rest in parts.items()))


def _by_direction(parameters: frozenset[sp.Symbol], expression: sp.Expr) -> sp.Expr:
    """Addends that differ only in gate and parameters become one, with a coefficient chosen by direction."""
    pairs: dict[tuple[sp.Expr, sp.Expr], dict[type, sp.Expr]] = {}
    rest = []
    for term in sp.Add.make_args(expression):
        gated = [factor for factor in sp.Mul.make_args(term) if isinstance(factor, Gated)]
        if len(gated) == 1 and isinstance(gated[0].args[1], Forward | Backward):
            basis, gate = gated[0].args
            fixed = [a for a in sp.Mul.make_args(basis) if a.free_symbols <= parameters]
            moving = sp.Mul(*(a for a in sp.Mul.make_args(basis) if a not in fixed))
            sides = pairs.setdefault(
                (moving, gate.args[0]), {Forward: sp.Integer(0), Backward: sp.Integer(0)}
            )
            sides[type(gate)] += term / gated[0] * sp.Mul(*fixed)
        else:
            rest.append(term)
    chosen = [basis * ByDirection(x, *sides.values()) for (basis, x), sides in pairs.items()]
    return sp.Add(*rest, *chosen)


# Arguments and local names of every emitted function in C, and modules that those in Python use.
_LOCAL = frozenset({"c", "count", "first", "k", "n", "next", "np", "out", "own", "parameters", "state"})
# Arguments and a local name of `prepare`, where parameters and what follows from them have names.
_OF_PREPARE = frozenset({"c", "invalid", "p", "zero"})
# What the object that holds the coefficients in Python has beside them.
OF_COEFFICIENTS = frozenset({"leading", "real", "rounded", "rounder", "single"})


def require_distinct(program: Program) -> None:
    """Raise InputError for a quantity that has the name of a value which the emitted code computes."""
    given = {q.name for q in (*program.parameters, *(q for q, _ in program.states))}
    inputs = {x.quantity.name for r in program.routines for x in r.inputs}
    inputs |= {q.name for q, _ in program.states}
    prepared = _targets(program.prepare)
    known = given | {s.name for s in program.coefficients}
    taken = [
        (inputs & _LOCAL) | (given & OF_COEFFICIENTS),
        {*given, *prepared} & _OF_PREPARE,
        _repeated([*given, *prepared]),
    ]
    for part in (*program.helpers, *program.routines):
        arguments = (
            [part.argument.name] if isinstance(part, Helper) else [x.quantity.name for x in part.inputs]
        )
        results = part.results if isinstance(part, Routine) else ()
        inner = [a for a in part.assignments if a.target not in results]
        taken += [_repeated([*arguments, *_targets(inner)]), known.intersection(_targets(part.assignments))]
    if names := next(filter(None, taken), None):
        raise InputError(
            f"model {program.name}",
            "a quantity with a name that the emitted code does not use for a value of its own",
            f"{min(names)!r}: rename it",
        )


def _targets(assignments: Iterable[Assignment]) -> list[str]:
    return [a.target.name for a in assignments]


def _repeated(names: Iterable[str]) -> set[str]:
    return {name for name, count in Counter(names).items() if count > 1}


def spoken_program(program: Program, axis: AxisKind) -> Program:
    """The same operations in the same order, with the letters, units and words of an axis."""
    if axis is TURNING:
        return program

    longest = sorted(axis.letters, key=len, reverse=True)
    letters = re.compile(rf"(?<![A-Za-z0-9])({'|'.join(longest)})(?![A-Za-z0-9])")

    def local(symbol: sp.Symbol) -> sp.Symbol:
        """A letter of the model, or a name made of some, such as C_m_per_k_i."""
        if symbol.name in axis.letters:
            return spoken_symbol(axis, symbol)
        name = letters.sub(lambda found: axis.letters[found[0]], symbol.name)
        return sp.Symbol(name, **symbol.assumptions0)

    def put(value: sp.Expr) -> sp.Expr:
        return value.xreplace({s: local(s) for s in value.free_symbols})

    def steps(assignments: Iterable[Assignment]) -> tuple[Assignment, ...]:
        return tuple(Assignment(local(a.target), put(a.value), axis.text(a.note)) for a in assignments)

    def routine(r: Routine) -> Routine:
        return replace(
            r,
            inputs=tuple(Input(spoken_quantity(axis, x.quantity), x.length) for x in r.inputs),
            assignments=steps(r.assignments),
            results=tuple(map(local, r.results)),
            labels=tuple(map(axis.named, r.labels)),
            requires=tuple(map(axis.named, r.requires)),
        )

    def helper(h: Helper) -> Helper:
        return replace(
            h, argument=local(h.argument), assignments=steps(h.assignments), meaning=axis.text(h.meaning)
        )

    return replace(
        program,
        title=axis.text(program.title),
        parameters=tuple(spoken_quantity(axis, q) for q in program.parameters),
        prepare=steps(program.prepare),
        coefficients=tuple(map(local, program.coefficients)),
        routines=tuple(map(routine, program.routines)),
        constants=tuple((name, tuple(map(axis.named, labels))) for name, labels in program.constants),
        notes=tuple((axis.named(name), axis.text(note)) for name, note in program.notes),
        states=tuple((spoken_quantity(axis, q), put(initial)) for q, initial in program.states),
        defaults=axis.text(program.defaults),
        cautions=tuple(map(axis.text, program.cautions)),
        helpers=tuple(map(helper, program.helpers)),
        promises=tuple(map(axis.text, program.promises)),
        axis=axis,
        needed_for={axis.letters.get(name, name): of for name, of in program.needed_for.items()},
        inertia=frozenset(axis.letters.get(name, name) for name in program.inertia),
        conditions=tuple(
            Condition(local(c.parameter), put(c.loss), put(c.inertia)) for c in program.conditions
        ),
    )


# The hidden states one time step later, for any time step: without elapsed time, nothing changes.
#
# A model defines the update of a state over a positive time step. Firmware also passes 0 (the first sample, a
# repeated time stamp) and negative ones (a counter overflow). Then the states stay unchanged, and nothing in
# the computation divides by less than the shortest time step.

# In seconds: shorter than any loop, and second differences of a current over it do not overflow in float.
SHORTEST = "1e-9"
_DT, _LEAST = v.dt.symbol, sp.Rational(SHORTEST)
_ELAPSED = Assignment(
    sp.Symbol("elapsed", real=True),
    sp.Max(_DT, _LEAST, evaluate=False),  # which takes as long as all else here
    "time step, at least the shortest [s]",
)


def _for_any_step(output: Output) -> tuple[Output, Expressions]:
    """The output and its expressions; those that contain dt hold for any time step."""
    given = output.expressions()
    values = [*(value for _, value in given.results), *(a.value for a in given.definitions)]
    if not output.without_time or not any(value.has(_DT) for value in values):
        return output, given
    elapsed = {_DT: _ELAPSED.target}
    results = tuple(
        (name, Pick(_DT, BELOW, _LEAST, output.without_time[name], value.xreplace(elapsed)))
        for name, value in given.results
    )
    definitions = (replace(a, value=a.value.xreplace(elapsed)) for a in given.definitions)
    kept = replace(output, meaning=f"{output.meaning}, unchanged if dt is less than {SHORTEST} s")
    return kept, replace(given, results=results, definitions=(_ELAPSED, *definitions))


class _Lowered(NamedTuple):
    """What `prepare` computes, the helpers, the routines and the constants of the outputs."""

    prepare: list[Assignment]
    helpers: tuple[Helper, ...]
    routines: tuple[Routine, ...]
    constants: tuple[tuple[str, tuple[str, ...]], ...]


def build_program(model: Model, choice: Choice = WHOLE) -> Program:
    """The Program of a model: the outputs that it declares, ready to print.

    Raises:
        InputError: a quantity has the name of a value that the code computes; there is no function of a
            chosen name, or none that depends on a parameter; or fixed ones that they need are not given.
    """
    interface = interface_of(model)
    prepare, helpers, routines, constants = _routines(model, interface, choice)
    names, labels = [r.name for r in routines], {r.name: r.labels for r in routines}
    listed = [(name, labels[of]) for name, of in interface.constants.items() if of in labels]
    coefficients = _used((*helpers, *routines), model, prepare)
    program = Program(
        name=model.name,
        title=model.title,
        parameters=model.parameters,
        prepare=shortened(needed(prepare, coefficients)),
        coefficients=coefficients,
        routines=routines,
        constants=(*listed, *constants),
        notes=notes(model, prepare),
        states=tuple((state.quantity, state.initial) for state in model.states),
        defaults=model.defaults or _origin_of_defaults(model),
        cautions=model.cautions,
        helpers=helpers,
        promises=promises(model, names),
        first=interface.first if interface.first in names else names[0],
        chosen=bool(choice.functions),
        arrays=choice.arrays if any(r.inputs for r in routines) else "none",
        fixed=choice.fixed,
        needed_for={name: output.name for output in interface.outputs for name in output.needs},
        inertia=frozenset(name for output in interface.outputs for name in output.requires),
    )
    if moving := stepped(routines):
        found = conditions(model)
        program = replace(program, conditions=found, conditioned=moving if found else frozenset())
    program = spoken_program(program, model.axis)
    require_distinct(program)
    if choice.functions and not program.coefficients and model.declares is None:
        raise InputError(
            "functions",
            "one that depends on a parameter",
            (f"{', '.join(choice.functions)}, which {program.name} gives the same value for all parameters"),
        )
    if program.fixed and not program.ungiven.isdisjoint(program.coefficients):
        absent = " and ".join(q.name for q in model.parameters if q.default is None)
        raise InputError(
            "fixed",
            problem=f"expected a value of {absent}, which {program.name} has no default for: emit it with"
            " parameters, or choose functions that need none of them",
        )
    return program


# By identity, as the interface: models that differ in their values alone have the same routines.
_KEPT = 8
_kept: dict[tuple[int, tuple[str, ...]], tuple[Interface, _Lowered]] = {}


def _routines(model: Model, interface: Interface, choice: Choice) -> _Lowered:
    """From memory, where the last 8 are kept; those of one drive from the user's cache, too."""
    key = id(interface), choice.functions
    if key not in _kept:
        record = structure_of(model), choice.functions
        found = cached("routines", record, lambda: _lowered(model, choice.of(interface.outputs)))
        if len(_kept) >= _KEPT:
            _kept.pop(next(iter(_kept)), None)
        _kept[key] = interface, found
    return _kept[key][1]


def _lowered(model: Model, outputs: Sequence[Output]) -> _Lowered:
    shared = Prepare(model)
    half_turns = HalfTurns(shared)
    given = [_for_any_step(output) for output in outputs]
    routines = tuple(_routine(model, *one, shared, half_turns) for one in given)
    called = {s for r in routines for a in r.assignments for s in a.value.free_symbols}
    helpers = tuple(h for h in half_turns.helpers if sp.Symbol(h.name) in called)
    constants = tuple(constant for _, one in given for constant in one.constants)
    return _Lowered(shared.assignments, helpers, routines, constants)


def _origin_of_defaults(model: Model) -> str:
    known = {q.name: q for q in vars(v).values() if isinstance(q, Quantity)}
    from_table = all(q.default == known.get(q.name, q).default for q in model.parameters)
    return "Table 1 of the paper with mu = 1/5" if from_table else "those of the derivation"


def _routine(
    model: Model, output: Output, given: Expressions, shared: Prepare, half_turns: HalfTurns
) -> Routine:
    fixed = model.parameter_symbols
    assignments, results = written_out(given.definitions, given.results, fixed)
    slopes: Mapping[tuple[sp.Symbol, sp.Symbol], sp.Symbol] = {}
    if given.by:
        y = sp.Symbol("torque", real=True)
        torque = results[0][1]
        if not fixed.intersection(given.by):
            torque = grouped(given.factors, fixed, frozenset(), torque)
        steps, slopes = differentiate((*assignments, Assignment(y, torque)), given.by)
        gradient = {slopes[y, x]: x.name for x in given.by if (y, x) in slopes}
        found = {gradient[a.target]: a.value for a in steps if a.target in gradient}
        value = [(label, torque) for label, _ in results if label]
        results = value + [(x.name, found[x.name]) for x in given.by if x.name in found]
        assignments = needed([a for a in steps if a.target not in gradient], [e for _, e in results])
    chained = frozenset(slopes.values())

    def lowered(expression: sp.Expr) -> sp.Expr:
        return lowering(shared.hoist(grouped(given.factors, fixed, chained, expression)))

    # Parts that depend on parameters only are moved to `prepare`; the rest keeps its order.
    lowering, noted = Lowering(shared, half_turns), ""
    for a in assignments:
        if a.target in shared.symbols or a.value.free_symbols <= shared.symbols:
            shared.define(a.target, a.value)
        else:
            # Of equal comments, as those of the components of a vector, the first one is written.
            value = lowered(a.value)
            lowering.assignments.append(Assignment(a.target, value, a.note if a.note != noted else ""))
            noted = a.note
    targets = []
    for label, expression in results:
        value = lowered(expression)
        targets.append(sp.Symbol(f"result_{label}" if label else "result", real=True))
        lowering.assignments.append(Assignment(targets[-1], value))
    used = set().union(*(a.value.free_symbols for a in lowering.assignments))
    return Routine(
        name=output.name,
        inputs=tuple(
            x for x in output.inputs if x.quantity.name in output.taken or not used.isdisjoint(x.symbols)
        ),
        assignments=without_copies(shortened(lowering.assignments), targets),
        results=tuple(targets),
        labels=tuple(label for label, _ in results) if results[0][0] else (),
        unit=output.unit,
        meaning=output.meaning,
        requires=output.requires,
        formerly=output.formerly,
    )


def _used(
    parts: tuple[Helper | Routine, ...], model: Model, prepare: Sequence[Assignment]
) -> tuple[sp.Symbol, ...]:
    used = set().union(*(a.value.free_symbols for part in parts for a in part.assignments))
    order = [a.target for a in prepare]
    given = {q.symbol for q in model.parameters}
    plain = sorted((s for s in used & given if s not in order), key=str)
    return (*plain, *(symbol for symbol in order if symbol in used))
