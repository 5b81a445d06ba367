"""Model to Program: each function's definitions, differentiated, parameter-only parts split off, lowered."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import sympy as sp

from eccentric.emit.accuracy import promises
from eccentric.emit.functions import Function, closure, functions
from eccentric.emit.half_turn import HalfTurns
from eccentric.emit.lower import Lowering
from eccentric.emit.primitive import InSingle, Rounded, TurnLeft, exact
from eccentric.emit.program import Assignment, Helper, Input, Program, Routine, differentiate, needed
from eccentric.emit.shift import written_out
from eccentric.emit.shorten import shortened, without_copies
from eccentric.model import Model, Quantity
from eccentric.model import vocabulary as v
from eccentric.model.steps import (
    Backward,
    ByDirection,
    Chord,
    Forward,
    Gated,
    HalfCosine,
    HalfSine,
    Leading,
    Magnitude,
    Sgn,
    SquareDifference,
)


def build_program(model: Model) -> Program:
    """The Program of a model: every function of `eccentric.emit.functions`, ready to print."""
    shared = _Prepare(model)
    half_turns = HalfTurns(shared)
    known = {q.name: q for q in vars(v).values() if isinstance(q, Quantity)}
    chosen = functions(model)
    from_table = all(q.default == known.get(q.name, q).default for q in model.parameters)
    routines = tuple(_routine(model, f, shared, half_turns) for f in chosen)
    called = {s for r in routines for a in r.assignments for s in a.value.free_symbols}
    helpers = tuple(h for h in half_turns.helpers if sp.Symbol(h.name) in called)
    labels = {r.name: r.labels for r in routines}
    return Program(
        name=model.name,
        title=model.title,
        parameters=model.parameters,
        prepare=shortened(shared.assignments),
        coefficients=_used((*helpers, *routines), shared),
        routines=routines,
        constants=(
            ("REGRESSOR", labels["regressor"]),
            ("GRADIENT", labels["friction_torque_gradient"]),
            ("JACOBIAN", labels["friction_torque_jacobian"]),
        ),
        notes=_notes(model, shared),
        states=tuple((state.quantity, state.initial) for state in model.states),
        defaults=model.defaults
        or ("Table 1 of the paper with mu = 1/5" if from_table else "those of the derivation"),
        helpers=helpers,
        promises=promises(model),
    )


def _routine(model: Model, function: Function, shared: _Prepare, half_turns: HalfTurns) -> Routine:
    fixed = model.parameter_symbols
    assignments, results = _unscaled(*written_out(closure(model, function.results), function.results, fixed))
    if function.by:
        y = sp.Symbol("torque", real=True)
        torque = results[0][1]
        if not fixed.intersection(function.by):
            torque = _grouped(fixed, torque)
        steps = differentiate((*assignments, Assignment(y, torque)), function.by)
        slopes = {f"torque_d_{x.name}": x.name for x in function.by}
        found = {slopes[a.target.name]: a.value for a in steps if a.target.name in slopes}
        value = [(label, torque) for label, _ in results if label]
        results = value + [(x.name, found[x.name]) for x in function.by if x.name in found]
        assignments = needed([a for a in steps if a.target.name not in slopes], [e for _, e in results])
    # What depends on parameters only is moved to `prepare`; the rest keeps its order.
    lowering = Lowering(shared, half_turns)
    for assignment in assignments:
        if assignment.target in shared.symbols or assignment.value.free_symbols <= shared.symbols:
            shared.define(assignment.target, assignment.value)
        else:
            value = lowering(shared.hoist(_grouped(fixed, assignment.value)))
            lowering.assignments.append(replace(assignment, value=value))
    targets = []
    for label, expression in results:
        value = lowering(shared.hoist(_grouped(fixed, expression)))
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
        if a.target.name == "F_N" and magnitude:
            scaled[a.target] = a.value.xreplace({magnitude[0]: load})
            written.append(Assignment(load, magnitude[0], "normal force over scale_N [rad^2/s^2]"))
        else:
            written.append(replace(a, value=a.value.xreplace(scaled)))
    return written, [(label, expression.xreplace(scaled)) for label, expression in results]


@cache
def _grouped(fixed: frozenset[sp.Symbol], expression: sp.Expr) -> sp.Expr:
    """Friction as (... F_N + ...) omega_m + (... F_N + ...) sgn: fewest operations per call, (18)-(20)."""
    if not isinstance(expression, sp.Add):
        return expression
    slopes = sorted((s for s in expression.free_symbols if "_d_" in s.name), key=str)
    if slopes:
        parts = sp.collect(sp.expand_mul(expression), slopes, evaluate=False)
        return sp.Add(*(slope * _grouped(fixed, factor) for slope, factor in parts.items()))
    expression = _by_direction(fixed, sp.expand_mul(expression))
    factors = [symbol for symbol in expression.free_symbols if symbol.name == "omega_m"]
    factors += sorted(expression.atoms(Sgn), key=str)
    if any(isinstance(term, sp.Mul) and term.has(*factors) for term in expression.args if factors):
        return _collected(expression, factors)
    return expression


def _collected(expression: sp.Expr, factors: list[sp.Expr]) -> sp.Expr:
    """The sum with each of the factors written once, before all that it multiplies."""
    parts: dict[sp.Expr, list[sp.Expr]] = {}
    for term in expression.args:
        own = sp.Mul.make_args(term)
        shared = next((factor for factor in factors if factor in own), sp.Integer(1))
        parts.setdefault(shared, []).append(term / shared)
    return sp.Add(*(shared * sp.Add(*rest) for shared, rest in parts.items()))


def _by_direction(parameters: frozenset[sp.Symbol], expression: sp.Expr) -> sp.Expr:
    """Addends that differ in gate and parameters only become one, its coefficient chosen by direction."""
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


class _Prepare:
    """The parameter-only assignments of one program, in order, each value once; called, it names a value."""

    def __init__(self, model: Model) -> None:
        self.symbols: set[sp.Symbol] = {q.symbol for q in model.parameters}
        self.assignments: list[Assignment] = []
        self._values: dict[sp.Expr, sp.Symbol] = {}
        self._names: dict[str, sp.Expr] = {}
        self._hoisted: dict[tuple[sp.Expr, str], sp.Expr] = {}
        # A value that the model has a name for is called by it.
        self._defined = {d.value: d.symbol for d in model.definitions if d.value.free_symbols <= self.symbols}
        self._sums = [(symbol, value.args) for value, symbol in self._defined.items() if value.is_Add]

    def __call__(self, name: str, value: sp.Expr) -> sp.Symbol:
        if value in self._values:
            return self._values[value]
        if value in self._defined:
            self.define(self._defined[value], value)
            return self._defined[value]
        if self._names.get(name, value) != value:
            name = next(f"{name}_{k}" for k in range(2, 99) if f"{name}_{k}" not in self._names)
        symbol = sp.Symbol(name, real=True)
        self.define(symbol, value)
        return symbol

    def define(self, symbol: sp.Symbol, value: sp.Expr) -> None:
        """Take `symbol = value` over, once."""
        if symbol in self.symbols:
            return
        self.symbols.add(symbol)
        self.assignments.append(Assignment(symbol, value))
        self._values[value] = symbol
        self._names[symbol.name] = value

    def hoist(self, expression: sp.Expr, role: str = "coefficient") -> sp.Expr:
        """The expression with its parameter-only parts replaced by coefficients that `prepare` computes.

        A sign stays in the expression: no coefficient is another one's negative. `role` is the name of what
        has a formula too long for a name.
        """
        if (expression, role) not in self._hoisted:
            self._hoisted[expression, role] = self._hoist(expression, role)
        return self._hoisted[expression, role]

    def _hoist(self, expression: sp.Expr, role: str) -> sp.Expr:
        if expression.is_Atom:
            return expression
        if expression.has(HalfCosine):
            return self.hoist(expression.rewrite("chord"), role)
        if expression.free_symbols and expression.free_symbols <= self.symbols:
            if _is_negative(expression):
                return -self.hoist(-expression, role)
            value = self._folded(expression)
            return value if value.is_Symbol else self(_name(value, role), value)
        if isinstance(expression, Chord | HalfSine | SquareDifference):
            return expression.func(self.hoist(expression.args[0]), expression.args[1])
        if isinstance(expression, ByDirection) and all(
            a == 0 or _is_negative(a) for a in expression.args[1:]
        ):
            x, forward, backward = expression.args
            return -self.hoist(ByDirection(x, -forward, -backward), role)
        if expression.is_Mul or expression.is_Add:
            fixed = [a for a in expression.args if a.free_symbols <= self.symbols]
            moving = [a for a in expression.args if a not in fixed]
            if expression.is_Mul:
                role = _role(moving, role)
                flipped = [-a if _is_negative(a) else a for a in moving]
                fixed += [sp.Integer(-1) for a in moving if _is_negative(a)]
                moving = flipped
            moving = [self.hoist(a, role) for a in moving]
            constant = expression.func(*fixed)
            return expression.func(self.hoist(constant, role), *moving)
        return expression.func(*(self.hoist(argument, role) for argument in expression.args))

    def _folded(self, value: sp.Expr) -> sp.Expr:
        """A sum with what the model has a name for called by it: B_m + mu^2 B_lT F_T is B."""
        named = [
            (symbol, parts)
            for symbol, parts in self._sums
            if sp.Add(*parts).free_symbols <= value.free_symbols
        ]
        terms = list(sp.Add.make_args(sp.expand(value))) if named else []
        for symbol, parts in named:
            for term in terms:
                found = [sp.expand(term / parts[0] * part) for part in parts]
                if set(found) <= set(terms):
                    self.define(symbol, sp.Add(*parts))
                    terms = [*(t for t in terms if t not in found), term / parts[0] * symbol]
                    value = sp.Add(*terms)
                    break
        return value


def _notes(model: Model, shared: _Prepare) -> tuple[tuple[str, str], ...]:
    known = {q.symbol.name: f"{q.meaning} [{q.unit}]" for q in model.parameters}
    known |= {d.quantity.name: f"{d.quantity.meaning} [{d.quantity.unit}]" for d in model.definitions}
    values = {a.target: a.value for a in shared.assignments}
    formulas = {symbol.name: _formula(value, values) for symbol, value in values.items()}
    return tuple((formulas | known).items())


def _formula(value: sp.Expr, values: dict[sp.Symbol, sp.Expr]) -> str:
    """The formula of a coefficient as a person writes it."""
    if isinstance(value, InSingle):
        return f"{_formula(value.args[0], values)}, in double all"
    if isinstance(value, Leading | Rounded):
        kind = "leading digits" if isinstance(value, Leading) else "in the working precision"
        if any(values[s].has(TurnLeft) for s in value.free_symbols if s in values):
            return f"what the parts before it leave of the period, {kind}"
        return f"{_formula(exact(value.args[0]), values)}, {kind}"
    # What is subtracted stands last.
    terms = sorted(exact(value).as_ordered_terms(), key=_is_negative)
    text = " + ".join(map(str, terms)).replace("+ -", "- ").replace("Leading(", "leading digits of (")
    return text.replace("**", "^").replace("*", " ")


def _used(parts: tuple[Helper | Routine, ...], shared: _Prepare) -> tuple[sp.Symbol, ...]:
    used = set().union(*(a.value.free_symbols for part in parts for a in part.assignments))
    order = [a.target for a in shared.assignments]
    plain = sorted((s for s in used & shared.symbols if s not in order), key=str)
    return (*plain, *(symbol for symbol in order if symbol in used))


# Names differ within their first 31 characters, which every C compiler tells apart.
_LONGEST = 31
_NUMBERS = {
    2: "twice",
    -1: "minus",
    -2: "minus_twice",
    4: "four",
    sp.Rational(1, 2): "half",
    sp.Rational(1, 4): "quarter",
}


def _is_negative(expression: sp.Expr) -> bool:
    """Whether it is written with a minus sign before everything."""
    if expression.is_Add:
        return all(map(_is_negative, expression.args))
    return expression.as_coeff_Mul()[0].is_negative is True


def _role(moving: list[sp.Expr], role: str) -> str:
    """What a factor of these is in the friction model; `role` if that cannot be told."""
    if any(isinstance(factor, Sgn) for factor in moving):
        return "coulomb"
    roles = {"omega_m": "viscous", "alpha_m": "inertial", "i": "driving", "u": "driving"}
    named = [roles[factor.name] for factor in moving if factor.is_Symbol and factor.name in roles]
    turning = any(isinstance(factor, Chord | HalfSine) for factor in moving)
    return named[0] if named else "turning" if turning else role


def _name(expression: sp.Expr, role: str) -> str:
    """A name like the formula: mu**2*B_lN is B_lN_mu2, B_m + k_e*k_i/R is B_m_plus_k_e_k_i_per_R."""
    name = _spelled(expression)
    return name if name is not None and len(name) <= _LONGEST else role


def _spelled(expression: sp.Expr) -> str | None:
    if expression.is_Symbol:
        return expression.name
    if expression in _NUMBERS:
        return _NUMBERS[expression]
    if isinstance(expression, sp.sin | sp.cos):
        inner = _spelled(expression.args[0])
        return inner and f"{expression.func.__name__}_{inner}"
    if expression.is_Pow and expression.exp.is_Integer and expression.base.is_Symbol:
        power = abs(int(expression.exp))
        spelled = expression.base.name + (str(power) if power > 1 else "")
        return f"per_{spelled}" if expression.exp < 0 else spelled
    if expression.is_Mul or expression.is_Add:
        parts = [
            _spelled(a)
            for a in (expression.as_ordered_factors() if expression.is_Mul else expression.as_ordered_terms())
        ]
        if any(part is None for part in parts):
            return None
        if expression.is_Mul:
            parts = sorted(parts, key=lambda part: (str(part).startswith("per_"), 0))
        return re.sub(
            "_plus_minus_", "_minus_", ("_" if expression.is_Mul else "_plus_").join(map(str, parts))
        )
    return None
