"""Parameter-only work of a program: split off its routines, computed once, named by its formula."""

from __future__ import annotations

import re
from collections.abc import Sequence

import sympy as sp

from eccentric.emission.program.program import InSingle, Low, Rounded, TurnLeft, exact
from eccentric.model import (
    Assignment,
    Bump,
    ByDirection,
    Chord,
    Clipped,
    HalfCosine,
    HalfSine,
    Leading,
    Model,
    Sgn,
    SquareDifference,
    meaning,
)
from eccentric.model import vocabulary as v


class Prepare:
    """The parameter-only assignments of one program, in order, each value once; called, it names a value."""

    def __init__(self, model: Model) -> None:
        self.symbols: set[sp.Symbol] = {q.symbol for q in model.parameters}
        self.assignments: list[Assignment] = []
        self._values: dict[sp.Expr, sp.Symbol] = {}
        self._names: dict[str, sp.Expr] = {}
        self._hoisted: dict[tuple[sp.Expr, str], sp.Expr] = {}
        # A value that has a name in the model keeps it.
        self._defined = {d.value: d.symbol for d in model.definitions if d.value.free_symbols <= self.symbols}
        self._sums = [(symbol, value.args) for value, symbol in self._defined.items() if value.is_Add]

    def __call__(self, name: str, value: sp.Expr) -> sp.Symbol:
        """The symbol of the value, with this name or, if that is taken, another one."""
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
        """Add `symbol = value`, once."""
        if symbol in self.symbols:
            return
        self.symbols.add(symbol)
        self.assignments.append(Assignment(symbol, value))
        self._values[value] = symbol
        self._names[symbol.name] = value

    def hoist(self, expression: sp.Expr, role: str = "coefficient") -> sp.Expr:
        """The expression with its parameter-only parts replaced by coefficients that `prepare` computes.

        A sign stays in the expression: no coefficient is the negative of another. `role` names values whose
        formula is too long for a name.
        """
        if (expression, role) not in self._hoisted:
            self._hoisted[expression, role] = self._hoist(expression, role)
        return self._hoisted[expression, role]

    def _hoist(self, expression: sp.Expr, role: str) -> sp.Expr:
        if expression.is_Atom:
            return expression
        known = {
            step: meaning(step)
            for step in expression.atoms(Bump, Clipped)
            if step.free_symbols <= self.symbols
        }
        if known:
            return self.hoist(expression.xreplace(known), role)
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
        """A sum with the model's names for its parts: B_m + mu^2 B_lT F_T is B."""
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


def notes(model: Model, prepare: Sequence[Assignment]) -> tuple[tuple[str, str], ...]:
    """The description of each coefficient: its meaning and unit, or its formula."""
    known = {q.symbol.name: f"{q.meaning} [{q.unit}]" for q in model.parameters}
    known |= {d.quantity.name: f"{d.quantity.meaning} [{d.quantity.unit}]" for d in model.definitions}
    values = {a.target: a.value for a in prepare}
    formulas = {symbol.name: _formula(value, values) for symbol, value in values.items()}
    return tuple((formulas | known).items())


def _formula(value: sp.Expr, values: dict[sp.Symbol, sp.Expr]) -> str:
    """The formula of a coefficient as a person would write it."""
    if isinstance(value, InSingle):
        return f"{_formula(value.args[0], values)} (in double: all)"
    if isinstance(value, Leading | Rounded):
        kind = "leading digits" if isinstance(value, Leading) else "in the working precision"
        if any(_is_left(values[s], values) for s in value.free_symbols if s in values):
            return f"remainder after the previous parts, {kind}"
        return f"{_formula(exact(value.args[0]), values)}, {kind}"
    # Subtracted terms come last.
    terms = sorted(_with_decimals(exact(value)).as_ordered_terms(), key=_is_negative)
    text = " + ".join(map(str, terms)).replace("+ -", "- ").replace("Leading(", "leading digits of (")
    return text.replace("**", "^").replace("*", " ")


def _with_decimals(value: sp.Expr) -> sp.Expr:
    """Fractions of long numbers as decimals: nobody reads 2001599834386887/36028797018963968."""
    long = [x for x in value.atoms(sp.Rational) if x.q > _READABLE or abs(x.p) > _READABLE]
    return value.xreplace({x: sp.Symbol(f"{float(x):.17g}") for x in long})


def _is_left(value: sp.Expr, values: dict[sp.Symbol, sp.Expr]) -> bool:
    """Whether it depends on the remainder after a part of a number."""
    known = [values[s] for s in value.free_symbols if s in values]
    return value.has(TurnLeft, Low) or any(_is_left(v, values) for v in known)


_READABLE = 10**6
"""Largest number above or below a fraction that is written as one."""
# Names differ within their first 31 characters, which every C compiler distinguishes.
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
    """Whether it is written with a leading minus sign."""
    if expression.is_Add:
        return all(map(_is_negative, expression.args))
    return expression.as_coeff_Mul()[0].is_negative is True


_MULTIPLIES = {
    v.omega_m.symbol: "viscous",
    v.alpha_m.symbol: "inertial",
    v.i.symbol: "driving",
    v.u.symbol: "driving",
}


def _role(moving: list[sp.Expr], role: str) -> str:
    """The meaning of such a factor in the friction model; `role` if unknown."""
    if any(isinstance(factor, Sgn) for factor in moving):
        return "coulomb"
    named = [_MULTIPLIES[factor] for factor in moving if factor in _MULTIPLIES]
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
            symbols = [a for a in expression.args if a.is_Symbol]
            is_scaled = expression.is_Mul and len(symbols) == 1 and len(expression.free_symbols) == 1
            return f"{symbols[0]}_scaled" if is_scaled else None
        if expression.is_Mul:
            parts = sorted(parts, key=lambda part: (str(part).startswith("per_"), 0))
        return re.sub(
            "_plus_minus_", "_minus_", ("_" if expression.is_Mul else "_plus_").join(map(str, parts))
        )
    return None
