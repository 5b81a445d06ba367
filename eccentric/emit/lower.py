"""Lowering: each careful step becomes assignments in a fixed order, the same for every back end.

The primitive operations below take their arguments as they stand; SymPy neither re-orders nor simplifies
them, and the printers write them one to one. So NumPy and C compute the same bits.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce

import sympy as sp

from eccentric.emit.program import Assignment
from eccentric.model import steps
from eccentric.model.steps import Step


class Plus(Step):
    """a + b."""


class Minus(Step):
    """a - b."""


class Times(Step):
    """a b."""


class Over(Step):
    """a / b."""


class Root(Step):
    """Square root."""


class Size(Step):
    """Absolute value."""


class Rounded(Step):
    """A parameter-only number in the working precision (prepare only)."""


class Low(Step):
    """The digits of a parameter-only number that its double does not hold; 0 in exact arithmetic."""


class TurnLeft(Step):
    """2 pi - a b, its digits kept where a b is nearly 2 pi (prepare only)."""


class Call(Step):
    """A function of emission's own, by its name."""


class Pick(Step):
    """Pick(a, relation, b, x, y): x where `a relation b` holds, else y; relation is `>`, `<`, `<=` or `==`."""


# 3/2 times the number from which on all are whole: x + ROUNDER - ROUNDER is x, rounded to a whole number.
ROUNDER = sp.Symbol("rounder")
SINE_RATIO, COSINE = sp.Symbol("sine_ratio"), sp.Symbol("cosine")
# What a reader of the emitted code must know of the steps, by the names that they get there.
_NOTES = {
    "square_difference": "speed^2 - omega_star^2; the difference is taken once, before anything is rounded",
    "turns": "whole turns of the link and a half, up to the top that is nearest",
    "rest": "the turns go off in four parts of few digits: all products but the last are exact",
    "reduced": "motor angle from the top",
    "from_top": "an angle so large that nothing is left of its phase counts as the top",
    "half_angle": "half the link angle from the top",
    "chord": "2 sin(half_angle)/mu",
    "half_sine": "cosine of the half angle from the top",
    "inverse": "1 at the apex, where F_N is 0 and its derivatives are taken as 0",
}
HALF = sp.Rational(1, 2)
_ABOVE, _BELOW, _WITHIN, _EQUAL = sp.symbols("> < <= ==")


class Lowering:
    """Lowers expressions of one program; parameter-only work goes to `prepare`, the rest to `assignments`.

    The same step with the same arguments is lowered once.
    """

    def __init__(self, prepare: Callable[[str, sp.Expr], sp.Symbol]) -> None:
        self._prepare = prepare
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
            steps.ByDirection: lambda x, a, b: Pick(x, _ABOVE, sp.Integer(0), a, b),
            sp.Abs: Size,
            sp.Max: lambda *all_of: reduce(lambda a, b: self._either(a, _ABOVE, b), all_of),
            sp.Min: lambda *all_of: reduce(lambda a, b: self._either(a, _WITHIN, b), all_of),
        }

    def __call__(self, expression: sp.Expr) -> sp.Expr:
        """The expression in primitive operations; what must be computed before it stands in `assignments`."""
        if isinstance(expression, steps.Chord | steps.HalfSine):
            return self._half_turn(expression)
        if isinstance(expression, steps.SquareDifference):
            return self._square_difference(expression)
        if expression.is_Atom:
            return expression
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

    def _half_turn(self, step: sp.Expr) -> sp.Expr:
        """The angle from the top: theta_m less the nearest k + 1/2 periods, the period held in four parts.

        k + 1/2 times the first three parts is exact, and so is what is left of theta_m near the top; the
        fourth makes the reduced angle right to its own last place, wherever the top is.
        """
        theta_m, mu = step.args
        theta_m = theta_m if theta_m.is_Atom else self.named("angle", self(theta_m))
        period = self._prepare("period", 2 * sp.pi / mu)
        turns = Minus(Times(theta_m, self._prepare("turns_per_rad", mu / (2 * sp.pi))), HALF)
        turns = self.named("turns", Plus(Minus(Plus(turns, ROUNDER), ROUNDER), HALF))
        first, *others = self._period_parts(period, mu)
        rest: sp.Expr = self.named("rest", Minus(theta_m, Times(turns, first)))
        for part in others:
            rest = Minus(rest, Times(turns, part))
        rest = self.named("reduced", rest)
        # Infinity and NaN give NaN.
        lost = Minus(theta_m, theta_m)
        from_top = self.named("from_top", Pick(Size(rest), _WITHIN, period, rest, lost))
        half_angle = self.named("half_angle", Times(from_top, self._prepare("half_mu", mu / 2)))
        if isinstance(step, steps.Chord):
            return self.named("chord", Times(from_top, Call(SINE_RATIO, half_angle)))
        return self.named("half_sine", Call(COSINE, half_angle))

    def _period_parts(self, period: sp.Symbol, mu: sp.Expr) -> list[sp.Symbol]:
        """Long division of 2 pi by mu: a digit, and what it leaves of 2 pi, which gives the next ones."""
        first = self._prepare("period_1", steps.Leading(period))
        left = self._prepare("period_left", TurnLeft(first, mu) / mu)
        second = self._prepare("period_2", steps.Leading(left))
        third = self._prepare("period_3", steps.Leading(Minus(left, second)))
        last = Plus(Minus(Minus(left, second), third), Low(left))
        return [first, second, third, self._prepare("period_4", Rounded(last))]

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
        nowhere_zero = Pick(magnitude, _EQUAL, sp.Integer(0), sp.Integer(1), magnitude)
        return self.named("inverse", Over(sp.Integer(1), nowhere_zero))

    def _bounded(self, x: sp.Expr, b: sp.Expr) -> sp.Expr:
        size = x if x.is_Atom else self.named("size", x)
        below = size if isinstance(x, Size) else Pick(size, _BELOW, -b, -b, size)
        return Pick(size, _ABOVE, b, b, below)

    def _gated(self, a: sp.Expr, b: sp.Expr) -> sp.Expr:
        b = self.named("gate", b) if not b.is_Atom else b
        a = self.named("ungated", a) if not a.is_Atom else a
        return Pick(b, _EQUAL, sp.Integer(0), sp.Integer(0), Times(a, b))

    def _either(self, a: sp.Expr, relation: sp.Symbol, b: sp.Expr) -> sp.Expr:
        a = self.named("one", a) if not a.is_Atom else a
        b = self.named("other", b) if not b.is_Atom else b
        return Pick(a, relation, b, a, b)


def exact(value: sp.Expr) -> sp.Expr:
    """The parameter-only value with the primitive operations in SymPy's; rounding stays what it is."""
    plain = {
        Low: lambda _: sp.Integer(0),
        TurnLeft: lambda a, b: 2 * sp.pi - a * b,
        Plus: lambda a, b: a + b,
        Minus: lambda a, b: a - b,
    }
    for operation, meant in plain.items():
        value = value.replace(operation, meant)
    return value
