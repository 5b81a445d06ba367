"""The speed, mass and time a rig would need to show friction by F_N, before there is a log.

The variance of a coefficient follows from the motion alone: that of the noise over the part of its column
orthogonal to all others. The others are viscous and Coulomb friction, and what is never known exactly:
inertia, constant load, gravity and zero angle. For a column x with orthogonal part x' over T seconds

    z = value * |x'| / sigma,   |x'|^2 = 50 T mean(x'^2)

since a low pass of 25 Hz leaves 50 independent rows per second. Only white noise is considered, not a drive
that warms up.
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
    """A coefficient of friction by F_N: its value, unit, and z within the given limits."""

    value: float
    unit: str
    z: float


@dataclass(frozen=True)
class DetectionPlan:
    """The change of time, speed or mass, each alone, that shows the coefficients at z = 5.

    Attributes:
        model: the model's name; sought: the coefficients by symbol.
        motion: description of the best piece of motion within the limits; bounds: the limits.
        mass: of the rig [kg]; noise: of an independent sample of the torque, motor side [N m].
        assumed: whether the noise is an assumption.
        time_s, speed_rad_s, mass_kg: sufficient values, each alone; None if none suffices.
        torque: the peak torque of the motion with these values [N m], without the inertia if it is
            unknown; current: the same in amperes, None without k_i.
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
        """The smallest z of the coefficients."""
        return min(one.z for one in self.sought.values())


def sought_of(names: Sequence[str], model: Model, where: str = "--for") -> dict[str, float]:
    """Coefficients of friction by F_N -> values, from names such as "C_lN" or "C_lN=0.01".

    Raises InputError for a name that is no such coefficient of the model, and a value that is not positive.
    """
    defaults = own_letters(model)
    loaded = [c.parameter.name for c in regressor(model) if c.load is Load.NORMAL]
    sought: dict[str, float] = {}
    for name in names:
        letter, _, text = (part.strip() for part in name.partition("="))
        if letter not in loaded:
            known = f"one of {', '.join(loaded)}" if loaded else "friction by F_N"
            raise InputError(where, known, repr(letter) if loaded else model.name)
        try:
            value = float(text) if text else defaults[letter]
        except ValueError:
            value = math.nan
        if not (math.isfinite(value) and value > 0.0):
            raise InputError(f"{where}: {letter}", "a number above 0", f"{text!r}")
        sought[letter] = value
    if not sought:
        raise InputError(where, f"one of {', '.join(loaded)}", "none")
    return sought


def plan_detection(
    rig: Rig, model: Model, bounds: Bounds, values: Mapping[str, float], noise: float | None = None
) -> DetectionPlan:
    """Find the speed, mass and time that would show these values at z = 5.

    Args:
        rig: with M, L, mu and the case; a range counts as its midpoint.
        model: with friction by F_N.
        bounds: limits of the motion.
        values: of the coefficients, by symbol.
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

    def with_speed(factor: float) -> _Evaluation | None:
        return bench.best(replace(bounds, speed=factor * bounds.speed), sigma, most)

    def with_mass(factor: float) -> _Evaluation | None:
        return bench.heavier(factor).best(bounds, sigma, most)

    best, mass = with_speed(1.0), bench.known[v.M.name]
    if best is None:
        least = bench.least_torque(bounds)
        needs = f" at {least / abs(k_i):.3g} A" if least and k_i else ""
        raise InputError("limits", f"room for one motion{needs}", f"{bounds.current:g} A")
    z = min(best.z.values())
    units = {c.parameter.name: c.parameter.unit for c in regressor(model)}
    return DetectionPlan(
        model=model.name,
        sought={name: Sought(value, units[name], best.z[name]) for name, value in values.items()},
        motion=best.piece.words(rig.axis),
        bounds=bounds,
        mass=mass,
        noise=noise,
        assumed=assumed,
        time_s=max(bounds.time * (SHOWN_AT_Z / z) ** 2, LEAST_TIME_S) if z > 0.0 else None,
        speed_rad_s=_least(with_speed, bounds.speed, MOST_TIMES_FASTER),
        mass_kg=_least(with_mass, mass, MOST_TIMES_HEAVIER) if mass > 0.0 else None,
        torque=best.torque,
        current=None if k_i is None else best.torque / abs(k_i),
    )


@dataclass(frozen=True)
class _Evaluation:
    """A piece of motion, z of each coefficient on it, and the peak torque [N m]."""

    piece: Segment
    z: Mapping[str, float]
    torque: float


class _Bench:
    """A rig to evaluate motions on, without a log."""

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
        """A copy with the unbalanced mass, and its share of the inertia, scaled by a factor."""
        mass, known = self.known[v.M.name], dict(self.known)
        if v.J_l.name in known:
            known[v.J_l.name] += (factor - 1.0) * mass * known[v.L.name] ** 2
        return _Bench(
            dataclasses.replace(self.rig, known={**known, v.M.name: factor * mass}), self.model, self._values
        )

    def best(self, bounds: Bounds, noise: float, most: float) -> _Evaluation | None:
        """The piece with the largest minimum z, of those that need at most the torque `most` [N m]."""
        every = (self._evaluated(piece, bounds, noise) for piece in self._pieces(bounds))
        feasible = [one for one in every if one.torque <= most]
        return max(feasible, key=lambda one: min(one.z.values()), default=None)

    def least_torque(self, bounds: Bounds) -> float:
        """The smallest torque that any piece needs [N m], 0 without pieces."""
        return min(
            (self._evaluated(piece, bounds, 1.0).torque for piece in self._pieces(bounds)), default=0.0
        )

    @staticmethod
    def _pieces(bounds: Bounds) -> Iterator[Segment]:
        return pieces(bounds, min(bounds.time, PIECE_S), np.random.default_rng(SEED))

    def _evaluated(self, piece: Segment, bounds: Bounds, noise: float) -> _Evaluation:
        full, every = joined([piece], bounds), round(RATE_HZ / INFORMATIVE_HZ)
        motion = Reference(*(x[::every] for x in (full.t, full.theta, full.omega, full.alpha)))
        friction, gravity, nuisance = self._columns_along(motion)
        moving = np.abs(motion.omega) > SLOW_PART * bounds.speed
        rows = np.column_stack([friction, nuisance])[moving]
        size = np.linalg.norm(rows, axis=0)
        rows, nonzero = rows[:, size > 0.0] / size[size > 0.0], np.flatnonzero(size > 0.0).tolist()
        repetitions = bounds.time / full.seconds
        z = dict.fromkeys(self._values, 0.0)
        names = [c.parameter.name for c in self._columns]
        torque = gravity.copy()
        for k, name in enumerate(names):
            if name not in self._values:
                continue
            torque += self._values[name] * friction[:, k]
            if k in nonzero and len(rows) > rows.shape[1]:
                others = np.delete(rows, nonzero.index(k), axis=1)
                column = rows[:, nonzero.index(k)]
                residual = np.linalg.norm(column - others @ np.linalg.lstsq(others, column, rcond=None)[0])
                z[name] = self._values[name] * float(residual * size[k]) * math.sqrt(repetitions) / noise
        return _Evaluation(piece, z, float(np.max(np.abs(torque))))

    def _columns_along(self, motion: Reference) -> tuple[Array, Array, Array]:
        """Columns of friction (n, k), torque without friction (n,), and columns of nuisance parameters."""
        signals = {"theta_m": motion.theta, "omega_m": motion.omega, "alpha_m": motion.alpha, "t": motion.t}
        inputs = {name: np.asarray(x, np.float64) for name, x in signals.items()}
        parameters = self._emitted.parameters(self.known)
        friction = self._emitted("regressor", inputs, parameters)
        gravity = np.broadcast_to(self._emitted("gravity_torque", inputs, parameters), motion.t.shape)
        link = self.known[v.mu.name] * motion.theta
        nuisance = [motion.alpha, np.ones_like(link)]
        if np.any(gravity):
            nuisance += [np.sin(link), np.cos(link)]
        inertia = 0.0
        if self._machine.inertia_letters <= set(self.known):
            inertia = self._machine.inertia(self.known)
        return friction, gravity + inertia * motion.alpha, np.column_stack(nuisance)


def _least(evaluated_at: Callable[[float], _Evaluation | None], value: float, most: float) -> float | None:
    """The least multiple of a value that gives z = 5 for all, by bisection; None if above `most` times."""

    def enough(factor: float) -> bool:
        evaluation = evaluated_at(factor)
        return evaluation is not None and min(evaluation.z.values()) >= SHOWN_AT_Z

    # Bracketed step by step, since no motion is feasible far above the limits.
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
