"""Which side of the gear angle and speed are of, and the gear: by gravity, slope and names."""

from __future__ import annotations

from dataclasses import dataclass

from eccentric.drafting.balance import Explained
from eccentric.drafting.limits import NEAR_WHOLE, SAME_SHAFT
from eccentric.drafting.proposal import RigLine
from eccentric.drafting.units import Reading, Shown

__all__ = ["SHORT", "Gear", "gear_of"]

GUESSED_UNITS = "as sure as the units of angle and speed, of which one is a guess"
SHORT = "less than one period of gravity was seen: no more than a guess"


@dataclass(frozen=True)
class Gear:
    """The sides of angle and speed, "m" for the motor or "l" for the link, and the rig's line of mu."""

    angle: str
    speed: str
    mu: RigLine


def gear_of(best: Reading, given: Shown, balance: Explained | None) -> Gear:
    """The gear as the log shows it; 1 where it shows none."""
    if not _two_shafts(best, given):
        side = "l" if _on_link(best, given) else "m"
        return Gear(side, side, _by_gravity(best, balance))
    by, doubt = max(best.ratio, 1.0 / best.ratio), "" if _has_units(given) else GUESSED_UNITS
    if best.ratio < 1.0:
        why = f"the logged speed is {best.ratio:.4g} times the slope of the angle: that of the link"
        return Gear("m", "l", _line(by, why, doubt))
    why = f"the logged speed is {by:.4g} times the slope of the angle: that of the motor"
    return Gear("l", "m", _line(by, why, doubt))


def _two_shafts(best: Reading, given: Shown) -> bool:
    """Whether angle and speed are of both ends of a gear; gravity or a name may say otherwise."""
    if best.ratio == 1.0 or given.angle is None or given.speed is None:
        return False
    angle, speed = ("l", "m") if best.ratio > 1.0 else ("m", "l")
    names = given.angle.name.side, given.speed.name.side
    if names[0] not in ("", angle) or names[1] not in ("", speed):
        return False
    turns = 1.0 if best.ratio > 1.0 else 1.0 / best.ratio
    if best.gear and not _is(best.gear, turns):
        return False
    if names == (angle, speed):
        return True
    return _has_units(given) and (bool(best.gear) or _whole(max(best.ratio, 1.0 / best.ratio)) > 0)


def _has_units(given: Shown) -> bool:
    """Whether the header names both units: else the ratio of speed and slope may be one of units."""
    return all(column is not None and column.name.unit for column in (given.angle, given.speed))


def _on_link(best: Reading, given: Shown) -> bool:
    """Whether the logged shaft is the link: by its name, where gravity does not say otherwise."""
    named = given.angle or given.speed
    says = named is not None and named.name.side == "l"
    return says and (not best.gear or _is(best.gear, 1.0))


def _by_gravity(best: Reading, balance: Explained | None) -> RigLine:
    """The gear of one logged shaft, by how often gravity repeats in its turns."""
    said = best.gear
    if said and not _is(said, 1.0):
        if not _whole(said) and balance is not None and balance.turns < 1.0:
            why = f"gravity may repeat every {said:.3g} turns; 1 sees everything at the logged shaft"
            return RigLine("known", "mu", "1", why, SHORT)
        return _line(said, f"gravity repeats every {said:.4g} turns of the logged shaft")
    if said:
        why = "the logged angle is that of the link: all is seen at its shaft, a gear is inside k_i and J_m"
        return RigLine("known", "mu", "1", why)
    why = "link speed over motor speed; 1 sees everything at the logged shaft"
    return RigLine("known", "mu", "1", why, "without gravity the log does not show the gear")


def _line(gear: float, why: str, doubt: str = "") -> RigLine:
    whole = _whole(gear)
    doubt = doubt or ("" if whole else "no whole number: check it")
    return RigLine(
        "known", "mu", f'"1/{whole}"' if whole else f"{1.0 / gear:.6g}", why, doubt, guessed=bool(doubt)
    )


def _is(gear: float, turns: float) -> bool:
    """Whether gravity repeats in so many turns, as far as it can be told."""
    return abs(gear / turns - 1.0) <= SAME_SHAFT


def _whole(gear: float) -> int:
    """The whole number of turns that a gear is close to, from 2 on; else 0."""
    whole = round(gear)
    return whole if whole >= 2 and abs(gear / whole - 1.0) < NEAR_WHOLE else 0
