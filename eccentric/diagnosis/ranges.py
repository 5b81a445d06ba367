"""Estimates beside what is known from elsewhere: outside such a range, a name is not the whole story."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import sympy as sp
from scipy.stats import norm

from eccentric.effects import Effect, Plausible
from eccentric.identification import Refit, in_drive_unit
from eccentric.model import Parts


@dataclass(frozen=True)
class RangeCheck:
    """A figure of an effect beside the range that it is known to have.

    Attributes:
        effect: id of the effect.
        known: the range, for the parts that the rig has, with its source.
        value, interval: the figure with its 95 % interval, in its unit.
    """

    effect: str
    known: Plausible
    value: float
    interval: tuple[float, float]

    @property
    def outside(self) -> str:
        """Where all of the interval lies: "above" or "below" the range, "" for neither."""
        low, high = self.interval
        return "above" if low > self.known.high else "below" if high < self.known.low else ""


def range_checks(fit: Refit, parts: Parts, unit: str) -> tuple[RangeCheck, ...]:
    """The figures of the effects of a fit that are known from elsewhere and that the log determines.

    A figure is left out where it takes a quantity that the rig does not have, or a torque that is known in
    the `unit` of the drive only.
    """
    return tuple(
        check
        for effect, _ in fit.effects
        for known in (plausible.for_parts(parts) for plausible in effect.plausible)
        if np.isfinite(known.high)
        and _in_its_unit(effect, known, unit)
        and (check := _check(effect, known, fit)) is not None
    )


def _in_its_unit(effect: Effect, known: Plausible, unit: str) -> bool:
    own = [q for q in effect.parameters if q.symbol in known.value.free_symbols]
    return all(in_drive_unit(q.unit, unit) == q.unit for q in own)


def _check(effect: Effect, known: Plausible, fit: Refit) -> RangeCheck | None:
    letters = sorted(known.value.free_symbols, key=lambda letter: letter.name)
    if not {letter.name for letter in letters} <= set(fit.values):
        return None
    at: dict[sp.Basic, float] = {letter: fit.values[letter.name] for letter in letters}
    value = float(known.value.subs(at))
    own = [letter for letter in letters if letter.name in fit.estimates]
    if not own:
        return None
    interval = _of_one(known, own[0], at, fit) if len(own) == 1 else _of_several(known, own, at, fit)
    if not all(map(np.isfinite, (value, *interval))):
        return None
    return RangeCheck(effect.id, known, value, interval)


def _of_one(
    known: Plausible, letter: sp.Basic, at: Mapping[sp.Basic, float], fit: Refit
) -> tuple[float, float]:
    """The ends of the interval of one parameter, carried over: figures rise or fall with it."""
    ends = fit.estimates[str(letter)].interval
    if not all(map(np.isfinite, ends)):
        return np.nan, np.nan
    low, high = sorted(float(known.value.subs({**at, letter: end})) for end in ends)
    return low, high


def _of_several(
    known: Plausible, own: list[sp.Basic], at: Mapping[sp.Basic, float], fit: Refit
) -> tuple[float, float]:
    """The interval by the slopes of the figure and the covariance of its parameters."""
    value, names = float(known.value.subs(at)), list(fit.estimates)
    places = [names.index(str(letter)) for letter in own]
    slope = np.array([float(sp.diff(known.value, letter).subs(at)) for letter in own])
    spread = norm.ppf(0.975) * np.sqrt(slope @ fit.covariance[np.ix_(places, places)] @ slope)
    return value - spread, value + spread
