"""How far motion explains a column as it explains a drive: friction, speed, inertia, gravity.

    y = offset + C sgn(w) + B w + J dw/dt + a sin(k x) + b cos(k x)

The wave number k is searched: one period of gravity is one turn of the link, in the unit of the angle.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid
from scipy.optimize import minimize_scalar

from eccentric.drafting.columns import Grid, LoggedColumn
from eccentric.drafting.limits import (
    BOTH_WAYS,
    DISTINCT,
    DRIFTS,
    GRAVITY,
    GRAVITY_OR_DRIFT,
    MOST_GEAR,
    MOST_TURNS,
    NEAR_WHOLE,
    NUMBERS_AT_ONCE,
    SAME_SHAFT,
    SCANNED,
    SHOWN,
    SIGN,
    STILL,
)
from eccentric.drafting.proposal import RigLine
from eccentric.drafting.units import Reading, Shown, readings

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Moved:
    """Angle, speed and acceleration (m,) in the units of the columns, and the points that move."""

    x: Array
    w: Array
    a: Array
    moving: NDArray[np.bool_]


@dataclass(frozen=True)
class Explained:
    """A column as motion explains it.

    Attributes:
        r2: of all terms; `r2_plain` of those without gravity.
        shares: standard deviation of each term over that of the column: friction, speed, inertia, gravity.
        losses, inertia: signs of the power that goes with friction and speed, and of the inertia.
        period: of gravity in the unit of the angle, 0 without gravity; `turns` how many are in the travel.
        zero: the angle at which gravity vanishes and the mass hangs, in the unit of the angle.
        offset: mean of the column beyond all this, over its standard deviation.
        both: whether both directions are in it.
        follows: whether what friction and inertia leave follows the angle, over too little of it for gravity.
    """

    r2: float
    r2_plain: float
    shares: dict[str, float]
    losses: float
    inertia: float
    period: float
    turns: float
    zero: float
    offset: float
    both: bool
    follows: bool = False

    def without_gravity(self) -> Explained:
        """The same without what repeats with the angle."""
        return replace(
            self, r2=self.r2_plain, shares={**self.shares, "gravity": 0.0}, period=0.0, turns=0.0, zero=0.0
        )


def motion_from(grid: Grid, angle: LoggedColumn | None, speed: LoggedColumn | None) -> Moved:
    """Motion by the angle where there is one, else by the speed, whose integral is the angle."""
    if angle is not None:
        x, w, a = (grid.smooth(angle, k, angle=True) for k in range(3))
    elif speed is not None:
        w, a = grid.smooth(speed), grid.smooth(speed, 1)
        ends = np.cumsum([0, *(len(g) for _, g, _ in grid.parts)])
        x = np.concatenate(
            [
                cumulative_trapezoid(w[i:j], part[1], initial=0.0)
                for i, j, part in zip(ends[:-1], ends[1:], grid.parts, strict=True)
            ]
        )
    else:
        raise AssertionError("expected an angle or a speed")
    inner = grid.inner()
    fast = float(np.quantile(np.abs(w[inner]), 0.95)) if np.any(inner) else 0.0
    return Moved(x, w, a, inner & (np.abs(w) > STILL * fast))


def balance_of(motion: Moved, y: Array, *, periodic: bool = True, shortest: float = 0.0) -> Explained | None:
    """The balance of a column (m,); None if it does not vary where there is motion.

    Args:
        periodic: whether gravity is searched; an integrated speed has no angle that lasts.
        shortest: period that gravity has at least, in the unit of the angle; 0 for any.
    """
    rows = motion.moving
    if np.count_nonzero(rows) < SCANNED // 100 or np.std(y[rows]) <= 1e-9 * np.max(np.abs(y)):
        return None
    x, w, a, y = motion.x[rows], motion.w[rows], motion.a[rows], y[rows]
    both = float(min(np.mean(w > 0.0), np.mean(w < 0.0))) > BOTH_WAYS
    plain = np.column_stack([np.ones_like(w), np.sign(w), w, a])
    total = float(np.var(y))
    r2_plain = 1.0 - _left(plain, y) / total
    k, turns = _wave(plain, x, y, shortest) if periodic else (0.0, 0.0)
    design, gain, follows = plain, 0.0, False
    if k:
        design = np.column_stack([plain, np.sin(k * x), np.cos(k * x)])
        gain = 1.0 - _left(design, y) / total - r2_plain
        signed = np.column_stack([plain, np.sign(w) * np.sin(k * x), np.sign(w) * np.cos(k * x)])
        least = GRAVITY if turns > DRIFTS else GRAVITY_OR_DRIFT
        if gain < least or (both and 1.0 - _left(signed, y) / total - r2_plain > gain):
            follows = turns <= DRIFTS and gain > SHOWN * (1.0 - r2_plain) > 0.0
            k, design, gain = 0.0, plain, 0.0
    c = np.linalg.lstsq(design, y, rcond=None)[0]
    spread = float(np.std(y))
    shares = {
        "friction": abs(c[1]) * float(np.std(design[:, 1])) / spread,
        "speed": abs(c[2]) * float(np.std(w)) / spread,
        "inertia": abs(c[3]) * float(np.std(a)) / spread,
        "gravity": float(np.std(design[:, 4:] @ c[4:])) / spread if k else 0.0,
    }
    # Friction that grows faster than the speed has a negative sign of the speed beside it: what counts is the
    # power of both. In one direction alone a load or an offset looks like friction.
    braking = c[1] * np.sign(w) + c[2] * w
    return Explained(
        r2=r2_plain + gain,
        r2_plain=r2_plain,
        shares=shares,
        losses=float(np.sign(np.mean(braking * w))) if both and np.std(braking) > SIGN * spread else 0.0,
        inertia=float(np.sign(c[3])) if shares["inertia"] > SIGN else 0.0,
        period=2.0 * np.pi / k if k else 0.0,
        turns=turns,
        zero=float(np.arctan2(-c[5], c[4]) / k) if k else 0.0,
        offset=float(c[0]) / spread,
        both=both,
        follows=follows,
    )


def _left(design: Array, y: Array) -> float:
    """Variance of y that a design leaves."""
    scale = np.max(np.abs(design), axis=0)
    scaled = design / np.where(scale > 0.0, scale, 1.0)
    return float(np.mean((y - scaled @ np.linalg.lstsq(scaled, y, rcond=None)[0]) ** 2))


def _wave(plain: Array, x: Array, y: Array, shortest: float = 0.0) -> tuple[float, float]:
    """The wave number that explains most, and how many of its periods the travel has; 0 without travel.

    Searched on the whole travel and, where that is long, on its first part: the phase of a coarse number is
    lost on the way.
    """
    best = (0.0, 0.0, 0.0)
    for rows, travel, numbers in _scans(x, shortest):
        q, rest = _without(plain[rows], y[rows])
        gains = _gains(numbers, x[rows], q, rest)
        top = int(np.argmax(gains))
        share = float(gains[top] / (rest @ rest))
        if share > best[0]:
            step = 0.2 * 2.0 * np.pi / travel
            near = minimize_scalar(
                lambda k, q=q, rest=rest, rows=rows: -_gain(k, x[rows], q, rest),
                bounds=(max(numbers[top] - step, 0.2 * step), numbers[top] + step),
                method="bounded",
                options={"xatol": 1e-6 * numbers[top]},
            )
            best = (share, float(near.x), travel)
    _, k, travel = best
    whole = float(np.ptp(x))
    while k and travel < whole:
        # Refined on twice the travel at a time, within the uncertainty of the shorter one.
        travel = min(2.0 * travel, whole)
        rows = np.abs(x - x[0]) <= travel
        q, rest = _without(plain[rows], y[rows])
        step = np.pi / travel
        near = minimize_scalar(
            lambda k, q=q, rest=rest, rows=rows: -_gain(k, x[rows], q, rest),
            bounds=(max(k - step, 0.1 * step), k + step),
            method="bounded",
            options={"xatol": 1e-7 * k},
        )
        k = float(near.x)
    return k, whole * k / (2.0 * np.pi)


def _scans(x: Array, shortest: float = 0.0) -> Iterator[tuple[NDArray[np.int64], float, Array]]:
    """Rows, their travel and the wave numbers to try on them: of the whole travel and of its first part."""
    for part in (1.0, 1.0 / 8.0):
        stop = max(int(part * len(x)), min(len(x), SCANNED))
        rows = np.unique(np.linspace(0, stop - 1, min(SCANNED, stop)).astype(int))
        travel = float(np.ptp(x[rows]))
        if travel > 0.0:
            most = min(MOST_TURNS, travel / shortest if shortest else MOST_TURNS)
            yield rows, travel, 2.0 * np.pi / travel * np.arange(0.25, max(most, 0.3), 0.2)


def most_explained(motion: Moved, columns: Array) -> Array:
    """What friction, inertia and one wave of the angle may explain of columns (m, c), at most; (c,), 0 to 1.

    As `balance_of` searches it, for all columns at once and without refining: the next wave number that is
    tried is a tenth of a period over the travel away, where a wave has 0.97 of its power. What the whole
    travel has shown is not looked for in its first part, where few periods explain any slow column.
    """
    rows = motion.moving
    x, w, a = motion.x[rows], motion.w[rows], motion.a[rows]
    plain, y = np.column_stack([np.ones_like(w), np.sign(w), w, a]), columns[rows]
    found, tried = np.zeros(columns.shape[1]), 0.0
    for own, _, every in _scans(x):
        numbers = every[every > tried]
        if not len(numbers):
            continue
        tried = numbers[-1]
        q, rest = _without(plain[own], y[own])
        whole = np.maximum(np.sum((y[own] - np.mean(y[own], axis=0)) ** 2, axis=0), 1e-300)
        left = np.sum(rest**2, axis=0)
        best = np.max(_gains(numbers, x[own], q, rest), axis=0)
        found = np.maximum(found, 1.0 - (left - best) / whole)
    return found


def _without(plain: Array, y: Array) -> tuple[Array, Array]:
    """Orthonormal columns of a design (n, p), and what they leave of y (n,) or (n, c)."""
    q = np.linalg.qr(plain / np.maximum(np.max(np.abs(plain), axis=0), 1e-300))[0]
    return q, y - q @ (q.T @ y)


def _gain(k: float, x: Array, q: Array, rest: Array) -> float:
    """Sum of squares that sin and cos of k x take from the rest."""
    return float(_gains(np.array([k]), x, q, rest)[0])


def _gains(numbers: Array, x: Array, q: Array, rest: Array) -> Array:
    """Sum of squares that sin and cos of k x take from the rest that q leaves, for each k (n,) or (n, c).

    The numbers must be evenly spaced: the waves of many are those of one, multiplied by the same factors.
    """
    found = []
    steps = np.exp(1j * np.outer(numbers[:NUMBERS_AT_ONCE] - numbers[0], x))
    beside, p = np.column_stack([q, rest]), q.shape[1]
    for first in range(0, len(numbers), NUMBERS_AT_ONCE):
        wave = steps[: len(numbers) - first] * np.exp(1j * numbers[first] * x)
        along = wave @ beside  # (numbers, columns), cos + i sin
        c, s = along.real[:, :p], along.imag[:, :p]
        square = np.sum(wave**2, axis=1)  # sum of cos^2 - sin^2, and twice that of cos sin
        cc = 0.5 * (len(x) + square.real) - np.sum(c * c, axis=1)
        ss = 0.5 * (len(x) - square.real) - np.sum(s * s, axis=1)
        cs = 0.5 * square.imag - np.sum(c * s, axis=1)
        of_c, of_s = along.real[:, p:], along.imag[:, p:]
        cc, ss, cs = cc[:, None], ss[:, None], cs[:, None]
        det = cc * ss - cs**2
        taken = cc * of_s**2 - 2.0 * cs * of_c * of_s + ss * of_c**2
        kept = (cc > 0.0) & (ss > 0.0) & (det > DISTINCT * cc * ss)
        found.append(np.where(kept, taken, 0.0) / np.where(kept, det, 1.0))
    every = np.concatenate(found)
    return every[:, 0] if rest.ndim == 1 else every


def as_gravity(
    given: Shown, balances: Mapping[str, Explained], motion: Moved, signals: Mapping[str, Array]
) -> tuple[Shown, Explained | None, list[str]]:
    """What the log shows with its gravity, the balance of that, and what repeats too often to be gravity.

    A load that hangs comes back once per turn of its link, and the link turns no faster than the motor: what
    repeats within a turn of the logged shaft is cogging or ripple.

    Args:
        given: what is shown without gravity.
        balances, signals: of each drive.
        motion: of the log.
    """
    gravity = next(
        (balances[k] for k in ("current", "torque", "voltage") if k in balances and balances[k].period),
        max(balances.values(), key=lambda b: b.r2, default=None),
    )
    if gravity is None or not gravity.period:
        return given, gravity, []
    seen = replace(given, period=gravity.period, turns=gravity.turns)
    gear = readings(seen)[0].gear
    if not gravity.both:
        often = "once" if round(1.0 / gear, 2) == 1.0 else f"{1.0 / gear:.3g} times"
        said = f"the drive repeats {often} per turn, seen in one direction only"
        return given, gravity.without_gravity(), [f"{said}: it may be ripple or friction as well as gravity"]
    if 1.0 - SAME_SHAFT < gear < MOST_GEAR:
        return seen, gravity, []
    kind = next(kind for kind, balance in balances.items() if balance is gravity)
    ripple = [f"the drive repeats {1.0 / gear:.4g} times per turn of the logged shaft: cogging or ripple"]
    # Gravity may be there besides, weaker than this.
    turn = gravity.period / gear
    slower = (
        balance_of(motion, signals[kind], shortest=(1.0 - SAME_SHAFT) * turn) if kind in signals else None
    )
    if gear < 1.0 and slower is not None and slower.period:
        seen = replace(given, period=slower.period, turns=slower.turns)
        if 1.0 - SAME_SHAFT < readings(seen)[0].gear < MOST_GEAR:
            return seen, slower, ripple
    return given, gravity.without_gravity(), ripple if gear < 1.0 else []


# Which side of the gear angle and speed are of, and the gear: by gravity, slope and names.


GUESSED_UNITS = "only as certain as the units of angle and speed, one of which is a guess"
SHORT = "less than one period of gravity was seen: only a guess"


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
    angle, speed, shaft = ("m", "l", "link") if best.ratio < 1.0 else ("l", "m", "motor")
    why = f"the logged speed is {best.ratio:.4g} times the slope of the angle: that of the {shaft}"
    return Gear(angle, speed, _line(by, why, doubt))


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
    return bool(best.gear) or _whole(max(best.ratio, 1.0 / best.ratio)) > 0


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
            why = f"gravity may repeat every {said:.3g} turns; 1 refers everything to the logged shaft"
            return RigLine("known", "mu", "1", why, SHORT)
        return _line(said, f"gravity repeats every {said:.4g} turns of the logged shaft")
    if said:
        why = (
            "the logged angle is that of the link: everything is referred to its shaft, and k_i and J_m"
            " include the gear"
        )
        return RigLine("known", "mu", "1", why)
    why = "link speed over motor speed; 1 refers everything to the logged shaft"
    return RigLine("known", "mu", "1", why, "without gravity the log does not reveal the gear ratio")


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
