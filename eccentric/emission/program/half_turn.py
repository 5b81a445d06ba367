"""The angle of the link from the top: private functions of the emitted code that all routines share.

theta_m minus the nearest k + 1/2 periods 2 pi/mu is the motor angle from the top. The period is stored in
parts, five in single precision, three in double; k + 1/2 times each but the last is exact, and so is the
remainder of theta_m near the top. The last part makes the angle correct to its last place, wherever the top
is: its rounding is 2^-64 of the period, in double 2^-119, and up to 1e4 rad no number is close enough to a
top for this to matter. If the angle is shifted by a parameter, so is the top; `shift` stores the shift in
parts as well.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from eccentric.emission.program.prepare import Prepare
from eccentric.emission.program.primitive import (
    COSINE,
    HALF,
    ROUNDER,
    SINE_RATIO,
    Call,
    InSingle,
    Low,
    Minus,
    Plus,
    Times,
    TurnLeft,
    Within,
)
from eccentric.emission.program.program import Assignment, Helper
from eccentric.emission.program.shift import last_parts, parts
from eccentric.model import Leading

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
