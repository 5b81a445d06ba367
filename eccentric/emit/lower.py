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


class Floor(Step):
    """Greatest integer not above."""


class Rounded(Step):
    """A parameter-only number in the working precision (prepare only)."""


class Series(Step):
    """A polynomial of emission's own, by its name, at the square of the argument."""


class Pick(Step):
    """Pick(a, relation, b, x, y): x where `a relation b` holds, else y; relation is `>`, `<=` or `==`."""


LARGEST = sp.Symbol("largest")  # the greatest finite number of the working precision
SINE, COSINE = sp.Symbol("sine_series"), sp.Symbol("cosine_series")
# What a reader of the emitted code must know of the steps, by the names that they get there.
_NOTES = {
    "square_difference": "speed^2 - omega_star^2; the difference is taken once, before anything is rounded",
    "halves": "the odd number of half turns up to the top that is nearest",
    "rest": "the half turns go off in three parts, the leading digits first: both products are exact",
    "from_top": "angle from the top",
    "bounded": "an angle so large that nothing is left of its phase counts as the top",
    "half_angle": "half angle from the top",
    "half_cosine": "sine of the half angle from the top: the cosine of half the angle but for its sign",
    "half_sine": "cosine of the half angle from the top",
    "divisor": "0/0 at the apex, where F_N is 0 and its derivatives are taken as 0",
    "limit": "where the square overflows, the larger of the two decides",
}
_ABOVE, _WITHIN, _EQUAL = sp.Symbol(">"), sp.Symbol("<="), sp.Symbol("==")


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
        if isinstance(expression, steps.HalfCosine | steps.HalfSine):
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
        """The half angle from the top: theta_m less an odd number of half periods, held in three parts."""
        theta_m, mu = step.args
        theta_m = theta_m if theta_m.is_Atom else self.named("angle", self(theta_m))
        half_period = self._prepare("half_period", sp.pi / mu)
        part_1 = self._prepare("half_period_1", steps.Leading(half_period))
        part_2 = self._prepare("half_period_2", steps.Leading(half_period - part_1))
        part_3 = self._prepare("half_period_3", Rounded(half_period - part_1 - part_2))
        per_turn = self._prepare("turns_per_rad", mu / (2 * sp.pi))
        half_mu = self._prepare("half_mu", mu / 2)
        turns = Floor(Times(theta_m, per_turn))
        halves = self.named("halves", Plus(Times(sp.Integer(2), turns), sp.Integer(1)))
        rest = self.named("rest", Minus(theta_m, Times(halves, part_1)))
        rest = Minus(rest, Times(halves, part_2))
        rest = self.named("from_top", Minus(rest, Times(halves, part_3)))
        # An angle so large that nothing is left of its phase counts as the top; infinity and NaN give NaN.
        period = self._prepare("period", 2 * sp.pi / mu)
        lost = Minus(theta_m, theta_m)
        bounded = self.named("bounded", Pick(Size(rest), _WITHIN, period, rest, lost))
        half = self.named("half_angle", Times(bounded, half_mu))
        square = self.named("half_angle_squared", Times(half, half))
        if isinstance(step, steps.HalfCosine):
            return self.named("half_cosine", Times(half, Series(SINE, square)))
        return self.named("half_sine", Series(COSINE, square))

    def _square_difference(self, step: sp.Expr) -> sp.Expr:
        v, w = step.args
        high = self._prepare(f"{w.name}_1", Rounded(w))
        low = self._prepare(f"{w.name}_2", Rounded(w - high))
        v = self(v)
        return self.named("square_difference", Times(Minus(Minus(v, high), low), Plus(v, high)))

    def _magnitude(self, p: sp.Expr, q: sp.Expr) -> sp.Expr:
        p, q = self.named("p", p), self.named("q", q)
        return self.named("magnitude", Root(Plus(Times(p, p), Times(q, q))))

    def _cosine_along(self, p: sp.Expr, q: sp.Expr) -> sp.Expr:
        return self._direction(p, q, p)

    def _cosine_across(self, p: sp.Expr, q: sp.Expr) -> sp.Expr:
        return self._direction(p, q, q)

    def _direction(self, p: sp.Expr, q: sp.Expr, part: sp.Expr) -> sp.Expr:
        """part/magnitude: 0 at the apex; beyond the largest number only the larger of p and q counts."""
        magnitude = self._magnitude(p, q)
        p, q, part = self.named("p", p), self.named("q", q), self.named("p", part)
        divisor = self.named("divisor", Pick(magnitude, _EQUAL, sp.Integer(0), sp.Integer(1), magnitude))
        other = q if part == p else p
        limit = Pick(Size(part), _ABOVE, Size(other), steps.Sgn(part), sp.Integer(0))
        limit = self.named("limit", limit)
        return self.named("cosine", Pick(magnitude, _ABOVE, LARGEST, limit, Over(part, divisor)))

    def _gated(self, a: sp.Expr, b: sp.Expr) -> sp.Expr:
        b = self.named("gate", b) if not b.is_Atom else b
        a = self.named("ungated", a) if not a.is_Atom else a
        return Pick(b, _EQUAL, sp.Integer(0), sp.Integer(0), Times(a, b))

    def _either(self, a: sp.Expr, relation: sp.Symbol, b: sp.Expr) -> sp.Expr:
        a = self.named("one", a) if not a.is_Atom else a
        b = self.named("other", b) if not b.is_Atom else b
        return Pick(a, relation, b, a, b)
