"""What a rig would have to do to show friction by F_N, before there is a log.

The variance of a coefficient follows from the motion alone: that of the noise over the part of its column
that no other column imitates.  The others are viscous and Coulomb friction, and what is never known exactly:
inertia, constant load, gravity and zero angle.  Of a column x, of which x' is not imitated, over T seconds

    z = value * |x'| / sigma,   |x'|^2 = 50 T mean(x'^2)

since a low pass of 25 Hz leaves 50 independent rows a second.  Only white noise is in this; a drive that
warms up is not.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from eccentric.core import InputError, MissingValueError
from eccentric.identification import Emitted, Machine, own_letters
from eccentric.model import Load, Model, regressor
from eccentric.model import vocabulary as v
from eccentric.planning.limits import (
    INFORMATIVE_HZ,
    LEAST_TIME_S,
    MOST_TIMES_FASTER,
    MOST_TIMES_HEAVIER,
    NOISE_OF_THE_LIMIT,
    PIECE_S,
    RATE_HZ,
    SEARCH_STEPS,
    SHOWN_AT_Z,
    SLOW_PART,
    WIDER,
)
from eccentric.planning.motion import Bounds, Reference, Segment, joined, pieces
from eccentric.rigs import Rig

Array = np.ndarray
SEED = 1


@dataclass(frozen=True)
class Sought:
    """A coefficient of friction by F_N: its value, unit, and z with the limits as they are."""

    value: float
    unit: str
    z: float


@dataclass(frozen=True)
class DetectionPlan:
    """What shows values of coefficients at z = 5, with all else as it is.

    Attributes:
        model: the model's name; sought: the coefficients by letter.
        motion: the best piece of motion within the limits, in words; bounds: the limits.
        mass: of the rig [kg]; noise: of an independent sample of the torque, motor side [N m].
        assumed: whether the noise is an assumption.
        time_s, speed_rad_s, mass_kg: what would do, each alone; None where it would not.
        torque: the largest that the motion needs with these values [N m], without the inertia if that is
            not known; current: the same in amperes, None without k_i.
    """

    model: str
    sought: Mapping[str, Sought]
    motion: str
    bounds: Bounds
    mass: float
    noise: float
    assumed: bool
    time_s: float | None
    speed_rad_s: float | None
    mass_kg: float | None
    torque: float
    current: float | None

    @property
    def z(self) -> float:
        """That of the coefficient that is hardest to see."""
        return min(one.z for one in self.sought.values())


def sought_of(names: Sequence[str], model: Model, where: str = "--for") -> dict[str, float]:
    """Letters of friction by F_N and their values, from names such as "C_lN" or "C_lN=0.01".

    Raises InputError for a name that is no such letter of the model, and a value that is not positive.
    """
    own = own_letters(model)
    loaded = [c.parameter.name for c in regressor(model) if c.load is Load.NORMAL]
    found: dict[str, float] = {}
    for name in names:
        letter, _, text = (part.strip() for part in name.partition("="))
        if letter not in loaded:
            known = f"one of {', '.join(loaded)}" if loaded else "friction by F_N"
            raise InputError(where, known, repr(letter) if loaded else model.name)
        try:
            value = float(text) if text else own[letter]
        except ValueError:
            value = math.nan
        if not (math.isfinite(value) and value > 0.0):
            raise InputError(f"{where}: {letter}", "a number above 0", f"{text!r}")
        found[letter] = value
    if not found:
        raise InputError(where, f"one of {', '.join(loaded)}", "none")
    return found


def plan_detection(
    rig: Rig, model: Model, bounds: Bounds, values: Mapping[str, float], noise: float | None = None
) -> DetectionPlan:
    """What speed, mass and time would show these values at z = 5.

    Args:
        rig: with M, L, mu and the case; a range counts as its middle.
        model: with friction by F_N.
        bounds: what the motion may not exceed.
        values: of the coefficients, by letter.
        noise: of an independent sample of the torque, motor side [N m]; None for 1 % of the limit's torque.

    Raises:
        InputError: a quantity of the rig is missing; without a noise k_i is; no motion fits the limits.
    """
    bench = _Bench(rig, model, values)
    assumed, k_i = noise is None, bench.known.get(v.k_i.name)
    if noise is None:
        if k_i is None:
            raise MissingValueError(rig.path, "[known] k_i", "neither", why="or --noise", letter="k_i")
        noise = NOISE_OF_THE_LIMIT * abs(k_i) * bounds.current
    sigma, most = noise, math.inf if k_i is None else abs(k_i) * bounds.current

    def with_speed(factor: float) -> _Seen | None:
        return bench.best(replace(bounds, speed=factor * bounds.speed), sigma, most)

    def with_mass(factor: float) -> _Seen | None:
        return bench.heavier(factor).best(bounds, sigma, most)

    seen, mass = with_speed(1.0), bench.known[v.M.name]
    if seen is None:
        least = bench.least_torque(bounds)
        needs = f" at {least / abs(k_i):.3g} A" if least and k_i else ""
        raise InputError("limits", f"room for one motion{needs}", f"{bounds.current:g} A")
    z = min(seen.z.values())
    units = {c.parameter.name: c.parameter.unit for c in regressor(model)}
    return DetectionPlan(
        model=model.name,
        sought={name: Sought(value, units[name], seen.z[name]) for name, value in values.items()},
        motion=seen.piece.words(rig.axis),
        bounds=bounds,
        mass=mass,
        noise=noise,
        assumed=assumed,
        time_s=max(bounds.time * (SHOWN_AT_Z / z) ** 2, LEAST_TIME_S) if z > 0.0 else None,
        speed_rad_s=_least(with_speed, bounds.speed, MOST_TIMES_FASTER),
        mass_kg=_least(with_mass, mass, MOST_TIMES_HEAVIER) if mass > 0.0 else None,
        torque=seen.torque,
        current=None if k_i is None else seen.torque / abs(k_i),
    )


@dataclass(frozen=True)
class _Seen:
    """A piece of motion, z of each coefficient on it, and the largest torque."""

    piece: Segment
    z: Mapping[str, float]
    torque: float


class _Bench:
    """A rig on which motions are tried, without a log."""

    def __init__(self, rig: Rig, model: Model, values: Mapping[str, float]) -> None:
        ranges = {name: 0.5 * sum(ends) for name, ends in rig.unknown.items() if name != v.phi.name}
        self.known = {**ranges, **rig.known}
        self.rig, self.model, self._values = rig, model, values
        needed = {q.name for q in (v.M, v.L, v.mu)} & {q.name for q in model.parameters}
        if missing := sorted(needed - set(self.known)):
            raise MissingValueError(rig.path, f"[known] {missing[0]}", "neither", letter=missing[0])
        self._emitted, self._machine = Emitted(model), Machine(model)
        self._columns = regressor(model)

    def heavier(self, factor: float) -> _Bench:
        """The same with a multiple of the unbalanced mass, and its part of the inertia."""
        mass, own = self.known[v.M.name], dict(self.known)
        if v.J_l.name in own:
            own[v.J_l.name] += (factor - 1.0) * mass * own[v.L.name] ** 2
        return _Bench(
            dataclasses.replace(self.rig, known={**own, v.M.name: factor * mass}), self.model, self._values
        )

    def best(self, bounds: Bounds, noise: float, most: float) -> _Seen | None:
        """The piece that shows best what is hardest to see, of those that need at most a torque [N m]."""
        seen = (self._seen(piece, bounds, noise) for piece in self._pieces(bounds))
        fit = [one for one in seen if one.torque <= most]
        return max(fit, key=lambda one: min(one.z.values()), default=None)

    def least_torque(self, bounds: Bounds) -> float:
        """The torque [N m] of the piece that needs least, 0 where there is none."""
        return min((self._seen(piece, bounds, 1.0).torque for piece in self._pieces(bounds)), default=0.0)

    @staticmethod
    def _pieces(bounds: Bounds) -> Iterator[Segment]:
        return pieces(bounds, min(bounds.time, PIECE_S), np.random.default_rng(SEED))

    def _seen(self, piece: Segment, bounds: Bounds, noise: float) -> _Seen:
        whole, every = joined([piece], bounds), round(RATE_HZ / INFORMATIVE_HZ)
        motion = Reference(*(x[::every] for x in (whole.t, whole.theta, whole.omega, whole.alpha)))
        friction, gravity, beside = self._along(motion)
        moving = np.abs(motion.omega) > SLOW_PART * bounds.speed
        rows = np.column_stack([friction, beside])[moving]
        size = np.linalg.norm(rows, axis=0)
        rows, kept = rows[:, size > 0.0] / size[size > 0.0], np.flatnonzero(size > 0.0).tolist()
        repeated = bounds.time / whole.seconds
        z = dict.fromkeys(self._values, 0.0)
        names = [c.parameter.name for c in self._columns]
        torque = gravity.copy()
        for k, name in enumerate(names):
            if name not in self._values:
                continue
            torque += self._values[name] * friction[:, k]
            if k in kept and len(rows) > rows.shape[1]:
                others = np.delete(rows, kept.index(k), axis=1)
                own = rows[:, kept.index(k)]
                left = np.linalg.norm(own - others @ np.linalg.lstsq(others, own, rcond=None)[0])
                z[name] = self._values[name] * float(left * size[k]) * math.sqrt(repeated) / noise
        return _Seen(piece, z, float(np.max(np.abs(torque))))

    def _along(self, motion: Reference) -> tuple[Array, Array, Array]:
        """Columns of friction (n, k), torque without friction (n,), and columns of what is not known."""
        signals = {"theta_m": motion.theta, "omega_m": motion.omega, "alpha_m": motion.alpha, "t": motion.t}
        inputs = {name: np.asarray(x, np.float64) for name, x in signals.items()}
        parameters = self._emitted.parameters(self.known)
        friction = self._emitted("regressor", inputs, parameters)
        gravity = np.broadcast_to(self._emitted("gravity_torque", inputs, parameters), motion.t.shape)
        link = self.known[v.mu.name] * motion.theta
        beside = [motion.alpha, np.ones_like(link)]
        if np.any(gravity):
            beside += [np.sin(link), np.cos(link)]
        inertia = 0.0
        if self._machine.inertia_letters <= set(self.known):
            inertia = self._machine.inertia(self.known)
        return friction, gravity + inertia * motion.alpha, np.column_stack(beside)


def _least(seen_at: Callable[[float], _Seen | None], value: float, most: float) -> float | None:
    """The least multiple of a value at which all is seen at z = 5, by bisection; None up to `most` times."""

    def enough(factor: float) -> bool:
        found = seen_at(factor)
        return found is not None and min(found.z.values()) >= SHOWN_AT_Z

    # Step by step, since what is much faster than the limits allow has no motion at all.
    low = high = 1.0
    if enough(1.0):
        while enough(low) and low > 1.0 / most:
            low, high = low / WIDER, low
    else:
        while not enough(high):
            if high > most:
                return None
            low, high = high, high * WIDER
    for _ in range(SEARCH_STEPS):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if enough(middle) else (middle, high)
    return value * high
