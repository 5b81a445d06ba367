"""Lowering: each stable step becomes assignments in a fixed order, the same for every back end."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import reduce

import sympy as sp

from eccentric.emission.program.prepare import Prepare
from eccentric.emission.program.program import (
    ABOVE,
    AT_MOST,
    BELOW,
    COSINE,
    EQUAL,
    HALF,
    ROUNDER,
    SINE_RATIO,
    AtMost,
    Call,
    Helper,
    InSingle,
    Low,
    Minus,
    Over,
    Pick,
    Plus,
    Root,
    Rounded,
    Size,
    Times,
    TurnLeft,
    Within,
)
from eccentric.model import Assignment, HalfCosine, HalfSine, Leading, needed, steps

# An angle shifted by a parameter: theta_m and the shift are reduced separately, never added first.
#
# Their sum would be rounded to the digits of theta_m, and near its zero F_N depends on those that follow.
_Results = Sequence[tuple[str, sp.Expr]]


def written_out(
    assignments: Sequence[Assignment], results: _Results, fixed: Collection[sp.Symbol]
) -> tuple[list[Assignment], list[tuple[str, sp.Expr]]]:
    """Half-turn steps of a defined angle, replaced by those of the angle that it shifts.

    Args:
        assignments: the definitions, in order.
        results: label and expression.
        fixed: the parameters.
    """
    angles = {a.target: a.value for a in assignments if sum(split(a.value, fixed)) != 0}

    def plain(value: sp.Expr) -> sp.Expr:
        turning = [e for e in value.atoms(HalfCosine, HalfSine) if e.args[0] in angles]
        return value.xreplace({e: e.func(angles[e.args[0]], e.args[1]) for e in turning})

    written = [Assignment(a.target, plain(a.value), a.note) for a in assignments]
    wanted = [(label, plain(expression)) for label, expression in results]
    return list(needed(written, [expression for _, expression in wanted])), wanted


def split(angle: sp.Expr, fixed: Collection[sp.Symbol]) -> tuple[sp.Expr, sp.Expr]:
    """A symbol and its shift, both 0 if the angle is anything else."""
    shift = sp.Add(*(a for a in sp.Add.make_args(angle) if a.free_symbols <= set(fixed)))
    moving = angle - shift
    return (moving, shift) if moving.is_Symbol else (sp.Integer(0), sp.Integer(0))


def parts(shift: sp.Symbol, first: sp.Symbol, prepare: Prepare) -> list[sp.Symbol]:
    """The shift in parts of few digits, subtracted after those of the period, each after its own.

    The first is a multiple of the last digit of the period's first part: a number of half turns of that,
    minus the shift's, is exact, and so is the small remainder of theta_m at the top.
    """
    twice = 2 * first  # so that the sum is not small, whatever the sign of the shift
    one = prepare(f"{shift.name}_1", Minus(Leading(Plus(twice, shift)), twice))
    two = prepare(f"{shift.name}_2", Leading(Minus(shift, one)))
    left = prepare(f"{shift.name}_left", Plus(Minus(Minus(shift, one), two), Low(shift)))
    return [one, two, *last_parts(shift.name, left, prepare)]


def last_parts(name: str, left: sp.Symbol, prepare: Prepare) -> list[sp.Symbol]:
    """The third part and those after it, from the remainder after the first two."""
    third = prepare(f"{name}_3", InSingle(Leading(left), Rounded(left)))
    fourth = prepare(f"{name}_4", Leading(Minus(left, third)))
    last = prepare(f"{name}_last", Minus(Minus(left, third), fourth))
    return [third, fourth, prepare(f"{name}_5", Rounded(last))]


# The angle of the link from the top: private functions of the emitted code that all routines share.
#
# theta_m minus the nearest k + 1/2 periods 2 pi/mu is the motor angle from the top. The period is stored in
# parts, five in single precision, three in double; k + 1/2 times each but the last is exact, and so is the
# remainder of theta_m near the top. The last part makes the angle correct to its last place, wherever the top
# is: its rounding is 2^-64 of the period, in double 2^-119, and up to 1e4 rad no number is close enough to a
# top for this to matter. If the angle is shifted by a parameter, so is the top; the shift is stored in
# parts as well.
_THETA, _FROM_TOP = sp.symbols("theta_m from_top", real=True)


@dataclass(frozen=True)
class Names:
    """The functions of one gear ratio, as symbols that `Call` takes."""

    from_top: sp.Symbol
    chord: sp.Symbol
    half_sine: sp.Symbol


class HalfTurns:
    """The helpers of one program; called with a gear ratio it gives their names and makes them once."""

    def __init__(self, prepare: Prepare) -> None:
        self._prepare = prepare
        self._names: dict[tuple[sp.Expr, sp.Expr], Names] = {}
        self.helpers: list[Helper] = []

    def __call__(self, mu: sp.Expr, shift: sp.Expr) -> Names:
        """The names of the functions for this gear ratio and this shift of the angle, a coefficient or 0."""
        if (mu, shift) not in self._names:
            suffix = f"_{len(self._names) + 1}" if self._names else ""
            self._names[mu, shift] = Names(
                *(sp.Symbol(name + suffix) for name in ("from_top", "chord", "half_sine"))
            )
            self._make(mu, shift, self._names[mu, shift])
        return self._names[mu, shift]

    def _make(self, mu: sp.Expr, shift: sp.Expr, names: Names) -> None:
        per_rad = self._prepare("turns_per_rad", mu / (2 * sp.pi))
        turns, rest, reduced, left = sp.symbols("turns rest reduced left", real=True)
        true = Plus(_THETA, shift) if shift else _THETA
        nearest = Plus(Minus(Plus(Minus(Times(true, per_rad), HALF), ROUNDER), ROUNDER), HALF)
        periods = self._period_parts(mu)
        shift = shift if shift.is_Atom else self._prepare("shift", shift)
        shifts = parts(shift, periods[0], self._prepare) if shift else [shift] * len(periods)
        first, *others = (Times(turns, part) for part in periods)
        first = Minus(first, shifts[0]) if shift else first
        second, third, fourth, fifth = zip(others, shifts[1:], strict=True)
        angle = (
            Assignment(turns, nearest, "whole turns of the link plus a half, up to the nearest top"),
            Assignment(
                rest,
                Minus(_THETA, first),
                "the turns are subtracted in parts of few digits: all products but the last are exact",
            ),
            Assignment(left, _reduced(_reduced(rest, second), third)),
            Assignment(reduced, InSingle(_reduced(_reduced(left, fourth), fifth), left)),
            Assignment(
                _FROM_TOP,
                Within(reduced, periods[0]),
                "bounded for angles too large to have any phase; infinity gives NaN",
            ),
        )
        half, chord, half_sine = sp.symbols("half_angle chord half_sine", real=True)
        halved = Assignment(half, Times(_FROM_TOP, self._prepare("half_mu", mu / 2)))
        # The sum is last: the terms before it are small where digits matter, and so are their roundings.
        bent = Assignment(chord, Plus(_FROM_TOP, Times(_FROM_TOP, Call(SINE_RATIO, half))))
        level = Assignment(half_sine, Call(COSINE, half))
        self.helpers += [
            Helper(names.from_top.name, _THETA, angle, "motor angle from the nearest top of the link [rad]"),
            Helper(names.chord.name, _FROM_TOP, (halved, bent), "2 sin(half the link angle from the top)/mu"),
            Helper(
                names.half_sine.name, _FROM_TOP, (halved, level), "cosine of half the link angle from the top"
            ),
        ]

    def _period_parts(self, mu: sp.Expr) -> list[sp.Symbol]:
        """Long division of 2 pi by mu: a digit, and the remainder of 2 pi, which gives the next ones."""
        first = self._prepare("period_1", Leading(2 * sp.pi / mu))
        left = self._prepare("period_left", TurnLeft(first, mu) / mu)
        second = self._prepare("period_2", Leading(left))
        rest = self._prepare("period_rest", Plus(Minus(left, second), Low(left)))
        return [first, second, *last_parts("period", rest, self._prepare)]


def _reduced(left: sp.Expr, part: tuple[sp.Expr, sp.Expr]) -> sp.Expr:
    """The angle minus the next part of the turns, and of the shift."""
    turned, shift = part
    return Plus(Minus(left, turned), shift) if shift else Minus(left, turned)


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
        zero = sp.Integer(0)
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
            steps.AtZero: lambda x, a, b: Pick(x, EQUAL, zero, a, b),
            steps.BySign: lambda x, a, b, c: Pick(x, ABOVE, zero, a, Pick(x, BELOW, zero, b, c)),
            steps.Clipped: self._clipped,
            steps.Shrunk: self._shrunk,
            steps.Quotient: Over,
            steps.Bump: self._bump,
            sp.Abs: Size,
            sp.Max: lambda *all_of: reduce(lambda a, b: self._either(a, ABOVE, AT_MOST, b), all_of),
            sp.Min: lambda *all_of: reduce(lambda a, b: self._either(a, AT_MOST, ABOVE, b), all_of),
        }

    def __call__(self, expression: sp.Expr) -> sp.Expr:
        """The expression in primitive operations; `assignments` holds what must be computed first."""
        if isinstance(expression, steps.Chord | steps.HalfSine | steps.FromTop):
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

    def _atom(self, name: str, value: sp.Expr) -> sp.Expr:
        return value if value.is_Atom else self.named(name, value)

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
        if isinstance(step, steps.FromTop):
            return from_top
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

    def _clipped(self, x: sp.Expr, low: sp.Expr, high: sp.Expr) -> sp.Expr:
        symmetric = low == -high
        x, high = self._atom("unlimited", x), self._atom("highest", high)
        if symmetric:
            return Within(x, high)
        low = self._atom("lowest", low)
        return Pick(x, ABOVE, high, high, Pick(x, BELOW, low, low, x))

    def _bump(self, x: sp.Expr) -> sp.Expr:
        size = self.named("distance", Size(self._atom("from_knot", x)))
        left = (self.named("left", Minus(knot, size)) for knot in (HALF, 3 * HALF))
        inner, outer = (self.named("reach", Plus(one, Size(one))) for one in left)
        eighth = sp.Rational(1, 8)
        return Minus(Times(Times(eighth, outer), outer), Times(Times(3 * eighth, inner), inner))

    def _shrunk(self, x: sp.Expr, low: sp.Expr, high: sp.Expr) -> sp.Expr:
        # An end that is NaN leaves x as it is: then the width of the band is NaN as well.
        symmetric, high = low == -high, self._atom("highest", high)
        low = -high if symmetric else self._atom("lowest", low)
        width = high if symmetric else Minus(high, low)
        taken = self.named("held_back", self._clipped(x, low, high))
        return Plus(Minus(x, taken), Times(sp.Integer(0), width))

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
