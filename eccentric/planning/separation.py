"""The distance of two rivals on a motion: the error of one where the other is true.

The wrong rival is refitted to log and motion together, with its shape parameters within the range of the
library: only the remaining error separates it (T-optimality; A. C. Atkinson and V. V. Fedorov, Biometrika
62(1), 1975). The squared error in units of the log's noise is twice the expected log-likelihood ratio.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eccentric.diagnosis import Candidate, Screen, Variant, bounded_solve, candidate_of, refined
from eccentric.effects import Effect
from eccentric.identification import (
    BalanceDesign,
    Coefficient,
    ColumnRole,
    Machine,
    Signals,
    balance_design,
    base_coefficients,
    base_columns,
    load_torque,
)
from eccentric.planning.limits import (
    COARSE,
    INFORMATIVE_HZ,
    INTEGRAL_PER_S,
    LOOP_STEPS,
    LOOPS_HZ,
    NOISE_PEAK,
    OFF,
    RATE_HZ,
    SPEED_FILTER_HZ,
    STEPS,
    TRAINED,
)
from eccentric.planning.motion import Bounds, Reference
from eccentric.planning.question import Question, Rival, rival_of
from eccentric.rigs import AddedMass
from eccentric.signals import Rows, white_noise

Floats = NDArray[np.floating]


# The motion of a drive that differs slightly from the fitted one: extremes of angle, speed and current.
#
# A reference within the limits does not guarantee a motion within them: a speed loop lags behind a ramp and
# overshoots its end, gravity and friction reversal disturb it, and the drive's mass and friction differ from
# the fit. So a PI speed controller with filtered speed is simulated with mass and friction off by `OFF` in
# both directions. It is tuned for the fitted inertia, also if a mass is added for one log. Dry friction
# sticks below its level. Load and friction are taken along the reference, from which the drive deviates
# little.
@dataclass(frozen=True)
class Met:
    """Inertia and external torques of a drive along a motion, motor side."""

    inertia: float  # [kg m^2]
    load: Floats  # gravity etc. (n,) [N m]
    friction: Floats  # along the motion (n,) [N m]
    torque_constant: float  # [N m/A]
    noise: float = 0.0  # peak noise current of the loop [A]
    tuned_for: float | None = None  # inertia that the speed loop was tuned for [kg m^2], None for `inertia`


@dataclass(frozen=True)
class Extremes:
    """Peak speed [rad/s] and current [A], range of the angle [rad], peak reference acceleration [rad/s^2]."""

    speed: float
    acceleration: float
    current: float
    angle: tuple[float, float]

    def beyond(self, bounds: Bounds) -> float:
        """The largest used fraction of any limit: above 1 one is exceeded."""
        used = [
            self.speed / bounds.speed,
            self.acceleration / bounds.acceleration,
            self.current / bounds.current,
        ]
        if bounds.angle is not None:
            middle, half = 0.5 * sum(bounds.angle), 0.5 * (bounds.angle[1] - bounds.angle[0])
            used += [abs(end - middle) / half for end in self.angle]
        return max(used)


def extremes(motion: Reference, met: Met, loop_hz: float | None = None) -> Extremes:
    """The extremes over all drives within the uncertainty; `loop_hz`: speed-loop bandwidth, if known."""
    loops = LOOPS_HZ if loop_hz is None else tuple(loop_hz * (1.0 + sign * OFF) for sign in (-1.0, 1.0))
    factors = (1.0 - OFF, 1.0 + OFF)
    simulated = [
        _followed(motion, met, mass, friction, loop)
        for mass, friction, loop in product(factors, factors, loops)
    ]
    speed, torque, low, high = (list(x) for x in zip(*simulated, strict=True))
    # A drive that sticks under a slow loop needs less than the reference motion.
    steady = max(np.max(np.abs(m * met.load + f * met.friction)) for m, f in product(factors, factors))
    required = np.max(np.abs(met.load + met.inertia * motion.alpha + met.friction))
    return Extremes(
        max(speed),
        float(np.max(np.abs(motion.alpha))),
        float(max(*torque, steady, required)) / abs(met.torque_constant) + met.noise,
        (float(np.min(motion.theta)) + min(low), float(np.max(motion.theta)) + max(high)),
    )


def _followed(
    motion: Reference, met: Met, mass: float, friction: float, loop_hz: float
) -> tuple[float, float, float, float]:
    """Peak speed and torque, and the extreme deviations of the angle, of one drive under its loop.

    The integrator starts at the holding torque: the drive is at rest before it moves.
    """
    dt = 1.0 / (RATE_HZ * LOOP_STEPS)
    inertia, load = mass * met.inertia, (mass * met.load).tolist()
    dry = (friction * _size(motion, met.friction)).tolist()
    gain = 2.0 * math.pi * loop_hz * (met.inertia if met.tuned_for is None else met.tuned_for)
    per_step, pole = gain * INTEGRAL_PER_S * dt, 1.0 - math.exp(-2.0 * math.pi * SPEED_FILTER_HZ * dt)
    step, speed, filtered, integral, deviation = dt / inertia, 0.0, 0.0, load[0], 0.0
    speeds, torques, deviations = [0.0], [0.0], [0.0]
    for target, pull, hold in zip(motion.omega.tolist(), load, dry, strict=True):
        level = step * hold
        for _ in range(LOOP_STEPS):
            error = target - filtered
            torque = gain * error + integral
            integral += per_step * error
            push = speed + step * (torque - pull)
            speed = push - level if push > level else push + level if push < -level else 0.0
            filtered += pole * (speed - filtered)
            deviation += dt * (speed - target)
            torques.append(torque)
        speeds.append(speed)
        deviations.append(deviation)
    return max(map(abs, speeds)), max(map(abs, torques)), min(deviations), max(deviations)


def _size(motion: Reference, friction: Floats) -> Floats:
    """Magnitude of friction [N m] (n,), interpolated at rest, where the models have none."""
    moving = motion.omega != 0.0
    if not np.any(moving):
        return np.zeros(len(friction))
    size = np.maximum(friction * np.sign(motion.omega), 0.0)
    return np.interp(motion.t, motion.t[moving], size[moving])


Array = np.ndarray


class Sums(NamedTuple):
    """Normal equations of a design X (rows, k) and target y: X'X, X'y, y'y, lower coefficient bounds."""

    matrix: Array
    vector: Array
    square: float
    lower: Array


@dataclass(frozen=True)
class Ground:
    """A log or a motion, with the designs of the rivals on it."""

    screen: Screen  # designs of the rivals' balance
    candidates: dict[str, Candidate]  # by id, on its signals
    seen: Array  # mask (rows,) of the rows a search would use
    per_row: float  # information per row: independent samples per row over their variance
    current: Array  # [A] (samples,), the largest that any rival needs
    met: Met | None = None  # external torques, None on a log

    def on(self, variants: Sequence[Variant]) -> list[Variant]:
        """The variants on the signals of this ground."""
        return [Variant(self.candidates[v.candidate.id], v.values) for v in variants]

    def predicted(self, rival: Rival) -> Array:
        """The target (rows,) [N m] predicted by a rival."""
        target, design, _ = self.screen.design(self.on(rival.variants))
        return self.screen.balance.target - target + design @ rival.coefficients

    def sums(self, truth: Array, variants: Sequence[Variant]) -> Sums:
        """The normal equations for fitting these variants to a true target (rows,)."""
        target, design, lower = self.screen.design(self.on(variants))
        y = (truth - (self.screen.balance.target - target))[self.seen]
        design = design[self.seen]
        weight = self.per_row
        return Sums(weight * design.T @ design, weight * design.T @ y, weight * float(y @ y), lower)

    def left(self, truth: Array, variants: Sequence[Variant], coefficients: Array) -> Array:
        """Residual of a true target (rows,) with these coefficients, in units of its noise."""
        target, design, _ = self.screen.design(self.on(variants))
        error = truth - (self.screen.balance.target - target) - design @ coefficients
        return np.sqrt(self.per_row) * error[self.seen]


class Separation:
    """The rivals of a question on its log and on any motion, with optional added mass."""

    def __init__(self, question: Question, added: AddedMass | None = None) -> None:
        self.question, self.rivals, self._added = question, question.rivals, added
        by_id = {v.candidate.id: v.candidate for rival in self.rivals for v in rival.variants}
        offered = question.screen.candidates
        # Errors of the declared values are part of every rival.
        self.declared = [c for c in offered if c.tolerance and c.changes is None and c.id not in by_id]
        by_id |= {c.id: c for c in self.declared}
        # And each may be the only error: a diagnosis compares it with the rivals.
        beside = self.rivals[0].variants[:-1]
        self.besides = tuple(
            rival_of(question.screen, (*beside, Variant(candidate, {})), None) for candidate in self.declared
        )
        self._effects: dict[str, Effect] = {e.id: e for e in question.effects if e.id in by_id}
        self._cached: dict[tuple[object, ...], Sums] = {}
        screen = question.screen
        variance = min(screen.fit(rival.variants).loss.sum() for rival in self.rivals) / screen.rows
        # Logs and windows may have gaps.
        seconds = (
            screen.rows * float(np.median(np.abs(np.diff(screen.balance.rows.t)))) if screen.rows > 1 else 1.0
        )
        # Rows overlap; a low pass leaves this many independent ones per second.
        self._information = INFORMATIVE_HZ / variance
        per_row = min(self._information * seconds / screen.rows, 1.0 / variance)
        self.log = Ground(screen, by_id, np.ones(screen.rows, bool), per_row, np.empty(0))

    def ground(self, motion: Reference) -> Ground:
        """A motion as a ground for the rivals."""
        signals, base, load, current = self._signals(motion)
        balance = self._balance(signals, base, motion)
        drive = self.question.data.drive
        only = "mechanical" if drive.by_voltage else None
        seen = current if drive.measured_twice else None
        friction = self.question.friction
        model = self.question.model
        candidates = {
            name: candidate_of(effect, model, signals, friction, only, seen)
            for name, effect in self._effects.items()
        }
        if balance.name == "mechanical":
            # Flux effects that also appear in the torque.
            candidates = {
                name: c if c.balance == "mechanical" or c.also is None else c.in_the("mechanical")
                for name, c in candidates.items()
            }
        seen = np.ones(len(motion.t), bool)
        if balance.name == "mechanical":
            seen = np.abs(motion.omega) > self.question.data.drive.channels.selection.moving_threshold_rad_s
        per_row = TRAINED * self._information / RATE_HZ
        ground = Ground(Screen(balance, ()), candidates, seen, per_row, current)
        met = self._met(ground, signals.known, load, base, motion)
        needed = met.load + met.inertia * motion.alpha + met.friction
        return replace(ground, current=needed / met.torque_constant, met=met)

    def _met(
        self, ground: Ground, known: Mapping[str, float], load: Array, base: Array, motion: Reference
    ) -> Met:
        """The external torques, with the largest friction of all rivals and the base model."""
        drive = self.question.data.drive
        tuned_for = inertia = drive.machine.inertia({**drive.known, **known})
        if self._added is not None:
            inertia = drive.machine.inertia(drive.machine.carrying({**drive.known, **known}, self._added))
        frictions = [base @ self.question.friction]
        if self.rivals[0].balance == "mechanical":
            frictions += [ground.predicted(rival) for rival in self.rivals]
        way = np.sign(motion.omega)
        friction = way * np.max([way * x for x in frictions], axis=0)
        one = float(drive.machine.current_of_torque(known, 1.0))
        noise = white_noise(drive.torque(), drive.channels.time.segment) * abs(one)
        return Met(
            inertia,
            load - inertia * motion.alpha,
            friction,
            1.0 / one,
            NOISE_PEAK * noise,
            tuned_for=tuned_for,
        )

    def apart(self, truth: Rival, other: Rival, grounds: Sequence[Ground], steps: int = 0) -> float:
        """Twice the expected log-likelihood ratio of a true rival over another on these grounds.

        steps: of a refinement of the other's shapes; without any, the factors `COARSE`.
        """

        def fit(variants: Sequence[Variant]) -> tuple[float, Array]:
            every = [self._sums(ground, truth, variants) for ground in grounds]
            matrix = np.sum([s.matrix for s in every], axis=0)
            matrix = matrix + np.diag(self._prior(variants, len(matrix)))
            vector, total = np.sum([s.vector for s in every], axis=0), sum(s.square for s in every)
            c = bounded_solve(matrix, vector, every[0].lower)
            return max(total + float(c @ matrix @ c - 2.0 * c @ vector), 0.0), c

        def residual(variants: Sequence[Variant]) -> Array:
            _, c = fit(variants)
            rows = [
                ground.left(ground.predicted(truth), self._with_declared(variants), c) for ground in grounds
            ]
            return np.concatenate([*rows, np.sqrt(self._prior(variants, len(c))) * c])

        options = [(*other.variants[:-1], last) for last in _near(other.variants[-1])]
        losses = [fit(variants)[0] for variants in options]
        best = int(np.argmin(losses))
        if not steps or not other.variants[-1].candidate.shapes:
            return losses[best]
        others = options[best][:-1]
        (last,) = refined([options[best][-1]], lambda v: residual((*others, *v)), steps)
        return min(fit((*others, last))[0], losses[best])

    def by_names(self, truth: str, other: str, grounds: Sequence[Ground]) -> float:
        """`apart` of two rivals by their families, refined."""
        by_family = {rival.family: rival for rival in (*self.besides, *self.rivals)}
        return self.apart(by_family[truth], by_family[other], grounds, STEPS)

    def information(self, rival: Rival, grounds: Sequence[Ground]) -> Array:
        """Information matrix of a rival's coefficients (k, k), base first, in 1/(their unit)^2."""
        matrix = np.sum([self._sums(ground, rival, rival.variants).matrix for ground in grounds], axis=0)
        return matrix + np.diag(self._prior(rival.variants, len(matrix)))

    def _prior(self, variants: Sequence[Variant], count: int) -> Array:
        """Prior information on each coefficient (k,): from the deviation of a declared value, else 0."""
        declared = [v.candidate.deviation**-2 for v in self._with_declared(variants)[len(variants) :]]
        return np.r_[np.zeros(count - len(declared)), declared]

    def _sums(self, ground: Ground, truth: Rival, variants: Sequence[Variant]) -> Sums:
        """The normal equations for fitting a rival's prediction, cached."""
        key = (id(ground), truth.family, *(v.key for v in variants))
        if key not in self._cached:
            self._cached[key] = ground.sums(ground.predicted(truth), self._with_declared(variants))
        return self._cached[key]

    def _with_declared(self, variants: Sequence[Variant]) -> list[Variant]:
        """The variants, and the errors of the other declared values."""
        present = {variant.candidate.id for variant in variants}
        return [*variants, *(Variant(c, {}) for c in self.declared if c.id not in present)]

    def _signals(self, motion: Reference) -> tuple[Signals, Array, Array, Array]:
        """Signals of a motion, its base columns (n, p), load [N m] and current [A] (n,) without effects."""
        data, model = self.question.data, self.question.model
        n, dt, own = len(motion.t), 1.0 / RATE_HZ, data.signals.known
        every = () if self._added is None else ((np.ones(n, bool), self._added),)
        old = replace(data.signals, by_row=Machine(model).along(own, every))
        # The machine's zero angle is arbitrary, the model's is where the mass hangs lowest.
        theta = motion.theta - data.drive.channels.alignment.theta_zero_rad / old.known["mu"]
        values = {
            "theta_m": theta,
            "omega_m": motion.omega,
            "alpha_m": motion.alpha,
            "t": motion.t,
            "i": np.zeros(n),
        }
        if "temperature" in old.values:
            values["temperature"] = np.full(n, float(np.median(old.values["temperature"])))
        signals = replace(old, values=values, dt=np.full(n, dt), starts=(0,), open={})
        gravity = load_torque(model, replace(signals, values={**values, "alpha_m": np.zeros(n)}))
        turned = {**values, "alpha_m": np.zeros(n), "theta_m": theta + 1e-4}
        slope = (load_torque(model, replace(signals, values=turned)) - gravity) / 1e-4 / signals.known["mu"]
        columns: dict[ColumnRole, Array] = {
            "inertia": motion.alpha,
            "load": np.ones(n),
            "gravity": gravity,
            "back_emf": motion.omega,
            "offset": np.ones(n),
            "zero_angle": -slope,
        }
        signals = replace(signals, open={c: columns[c.role] for c in data.drive.open})
        base = base_columns(model, signals)
        mechanical = self.question.friction
        load = load_torque(model, signals)
        current = data.drive.machine.current_of_torque(signals.known, load + base @ mechanical)
        values["i"] = current
        if "u" in old.values:
            values["u"] = data.drive.machine.voltage(signals.known, current, motion.omega)
        return replace(signals, values=values), base, load, current

    def _balance(self, signals: Signals, base: Array, motion: Reference) -> BalanceDesign:
        """The balance of the rivals on a motion, one row per sample, with zero target."""
        n, name = len(motion.t), self.rivals[0].balance
        every = np.ones(n, bool)
        rows = Rows(
            motion.t.astype(float), np.zeros(n, int), np.zeros(n, int), every, ~every, np.ones(n), "samples"
        )
        coefficients: tuple[Coefficient, ...] = ()
        columns = np.empty((n, 0))
        if name == "mechanical":
            coefficients, columns = base_coefficients(self.question.model, signals), base
        made = balance_design(name, rows, coefficients, np.zeros(n), columns, np.ones(n))
        return made.without_bounds(but=("friction",)) if name == "mechanical" else made


def _near(variant: Variant) -> list[Variant]:
    """The variant at a grid of shapes around its values, within their range."""
    grid = [variant]
    for shape in variant.candidate.shapes:
        name = shape.quantity.name
        grid = [
            Variant(v.candidate, {**v.values, name: float(np.clip(near, shape.low, shape.high))})
            for v in grid
            for near in np.multiply(COARSE, v.values[name])
        ]
    return grid
