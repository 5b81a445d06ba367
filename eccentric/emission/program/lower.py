"""Lowering: each stable step becomes assignments in a fixed order, the same for every back end.

`eccentric.emission.program.half_turn` lowers the half-turn steps.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce

import sympy as sp

from eccentric.emission.program.half_turn import HalfTurns
from eccentric.emission.program.prepare import Prepare
from eccentric.emission.program.primitive import (
    ABOVE,
    AT_MOST,
    BELOW,
    EQUAL,
    AtMost,
    Call,
    Low,
    Minus,
    Over,
    Pick,
    Plus,
    Root,
    Rounded,
    Size,
    Times,
)
from eccentric.emission.program.program import Assignment
from eccentric.emission.program.shift import split
from eccentric.model import steps

# Notes on the steps for readers of the emitted code, by their names there.
_NOTES = {
    "square_difference": "speed^2 - omega_star^2; the difference is taken once, before anything is rounded",
    "inverse": "1 at the apex, where F_N is 0 and its derivatives are taken as 0",
}
_LATE = (steps.Chord, steps.HalfSine)


class Lowering:
    """Lowers expressions of one program; parameter-only work goes to `prepare`, the rest to `assignments`.

    The same step with the same arguments is lowered once.
    """

    def __init__(self, prepare: Prepare, half_turns: HalfTurns) -> None:
        self._prepare = prepare
        self._half_turns = half_turns
        self._done: dict[sp.Expr, sp.Symbol] = {}
        self._used: dict[str, int] = {}
        self.assignments: list[Assignment] = []
        self._simple: dict[type, Callable[..., sp.Expr]] = {
            steps.Magnitude: self._magnitude,
            steps.Along: self._cosine_along,
            steps.Across: self._cosine_across,
            steps.Gated: self._gated,
            steps.Bounded: self._bounded,
            steps.Sgn: lambda x: self.named("direction_of_motion", steps.Sgn(x)),
            steps.Forward: lambda x: self.named("is_forward", steps.Forward(x)),
            steps.Backward: lambda x: self.named("is_backward", steps.Backward(x)),
            steps.ByDirection: lambda x, a, b: Pick(x, ABOVE, sp.Integer(0), a, b),
            sp.Abs: Size,
            sp.Max: lambda *all_of: reduce(lambda a, b: self._either(a, ABOVE, AT_MOST, b), all_of),
            sp.Min: lambda *all_of: reduce(lambda a, b: self._either(a, AT_MOST, ABOVE, b), all_of),
        }

    def __call__(self, expression: sp.Expr) -> sp.Expr:
        """The expression in primitive operations; `assignments` holds what must be computed first."""
        if isinstance(expression, steps.Chord | steps.HalfSine):
            return self._half_turn(expression)
        if isinstance(expression, steps.SquareDifference):
            return self._square_difference(expression)
        if expression.is_Atom:
            return expression
        if expression.is_Mul and any(isinstance(a, _LATE) for a in expression.args):
            return self._late(expression)
        arguments = [self(argument) for argument in expression.args]
        lowered = self._simple.get(type(expression))
        if lowered is not None:
            return lowered(*arguments)
        if isinstance(expression, sp.Pow) and expression.exp.is_Integer and not arguments[0].is_Atom:
            return self.named("base", arguments[0]) ** expression.exp
        return expression.func(*arguments)

    def named(self, name: str, value: sp.Expr) -> sp.Symbol:
        """A symbol for the value, computed once; a second value of that name gets a number."""
        if value in self._done:
            return self._done[value]
        self._used[name] = self._used.get(name, 0) + 1
        count = self._used[name]
        symbol = sp.Symbol(name if count == 1 else f"{name}_{count}", real=True)
        self.assignments.append(Assignment(symbol, value, _NOTES.get(name, "")))
        self._done[value] = symbol
        return symbol

    def _late(self, product: sp.Expr) -> sp.Expr:
        """Chord and half sine take longest: values that are ready before them are multiplied first."""
        late = [self(a) for a in product.args if isinstance(a, _LATE)]
        others = sp.Mul(*(self(a) for a in product.args if not isinstance(a, _LATE)))
        for factor in late:
            others = factor if others == 1 else Times(others, factor)
        return others

    def _half_turn(self, step: sp.Expr) -> sp.Expr:
        """A call of the program's private functions of the angle, which all routines share."""
        angle, mu = step.args
        theta_m, shift = split(angle, self._prepare.symbols)
        if not theta_m:
            theta_m = angle if angle.is_Atom else self.named("angle", self(angle))
        names = self._half_turns(mu, shift)
        from_top = self.named("from_top", Call(names.from_top, theta_m))
        if isinstance(step, steps.Chord):
            return self.named("chord", Call(names.chord, from_top))
        return self.named("half_sine", Call(names.half_sine, from_top))

    def _square_difference(self, step: sp.Expr) -> sp.Expr:
        v, w = step.args
        high = self._prepare(f"{w.name}_1", Rounded(w))
        low = self._prepare(f"{w.name}_2", Rounded(Plus(Minus(w, high), Low(w))))
        v = self(v)
        return self.named("square_difference", Times(Minus(Minus(v, high), low), Plus(v, high)))

    def _magnitude(self, p: sp.Expr, q: sp.Expr) -> sp.Expr:
        p, q = self.named("p", p), self.named("q", q)
        return self.named("magnitude", Root(Plus(Times(p, p), Times(q, q))))

    def _cosine_along(self, p: sp.Expr, q: sp.Expr) -> sp.Expr:
        return Times(self.named("p", p), self._inverse(p, q))

    def _cosine_across(self, p: sp.Expr, q: sp.Expr) -> sp.Expr:
        return Times(self.named("q", q), self._inverse(p, q))

    def _inverse(self, p: sp.Expr, q: sp.Expr) -> sp.Expr:
        magnitude = self._magnitude(p, q)
        one = sp.Integer(1)
        return self.named("inverse", Pick(magnitude, EQUAL, sp.Integer(0), one, Over(one, magnitude)))

    def _bounded(self, x: sp.Expr, b: sp.Expr) -> sp.Expr:
        size = x if x.is_Atom else self.named("size", x)
        if isinstance(x, Size):
            return AtMost(size, b)
        return Pick(size, ABOVE, b, b, Pick(size, BELOW, -b, -b, size))

    def _gated(self, a: sp.Expr, b: sp.Expr) -> sp.Expr:
        zero, parameter = sp.Integer(0), a.free_symbols <= self._prepare.symbols
        b = self.named("gate", b) if not b.is_Atom else b
        a = self.named("ungated", a) if not a.is_Atom else a
        if parameter:
            return Pick(b, EQUAL, zero, zero, Times(a, b))
        if a in (symbol for value, symbol in self._done.items() if isinstance(value, steps.Sgn)):
            return Times(a, b)
        # A closed gate passes only the sign: a NaN stays, an infinity gives none.
        return Times(Pick(b, EQUAL, zero, steps.Sgn(a), a), b)

    def _either(self, a: sp.Expr, taken: sp.Symbol, left: sp.Symbol, b: sp.Expr) -> sp.Expr:
        """Return a where `a taken b`, b where `a left b`, else the sum, which is NaN as one of them is."""
        a = self.named("one", a) if not a.is_Atom else a
        b = self.named("other", b) if not b.is_Atom else b
        return Pick(a, taken, b, a, b if a.is_number else Pick(a, left, b, b, Plus(a, b)))
