"""How far apart two rivals are on a motion: the error that one makes where the other is true.

A rival that is wrong is fitted anew to all that will be known, the log and the motion together, with its
shapes within the range of the library: only what it cannot imitate tells it apart (the T-optimality of
A. C. Atkinson and V. V. Fedorov, Biometrika 62(1), 1975). The error counts in units of the noise that the log
showed: twice the expected log-likelihood ratio.
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

# A motion as a drive makes it that is not quite the fitted one: extremes of angle, speed and current.
#
# A reference within its limits is not a motion within them: a speed loop lags behind a ramp and overshoots
# its end, gravity and the reversal of friction disturb it, and mass and friction of the drive are not those
# of the fit. So the loop is simulated with each of them off by `OFF`, both ways: a speed controller,
# proportional and integral, behind the filter of its speed. It is tuned for the fitted inertia, and a mass
# that is added for one log leaves it so. Friction holds what is below its level. Load and friction are
# those along the reference: where the drive is elsewhere, it is by little.


Floats = NDArray[np.floating]


@dataclass(frozen=True)
class Met:
    """What a drive meets along a motion, motor side.

    Attributes:
        inertia: [kg m^2]; load: gravity and the like (n,) [N m]; friction: along the motion (n,) [N m].
        torque_constant: torque [N m] of one ampere; noise: what the loop adds to the current [A].
        tuned_for: the inertia that the speed loop was tuned for [kg m^2], None for this one.
    """

    inertia: float
    load: Floats
    friction: Floats
    torque_constant: float
    noise: float = 0.0
    tuned_for: float | None = None


@dataclass(frozen=True)
class Extremes:
    """Largest speed [rad/s] and current [A], both ends of the angle [rad], largest acceleration asked for."""

    speed: float
    acceleration: float
    current: float
    angle: tuple[float, float]

    def beyond(self, bounds: Bounds) -> float:
        """The largest part of any limit that is used: above 1 one is broken."""
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
    """The extremes over all drives of the uncertainty; `loop_hz`: bandwidth of the speed loop, if known."""
    loops = LOOPS_HZ if loop_hz is None else tuple(loop_hz * (1.0 + sign * OFF) for sign in (-1.0, 1.0))
    factors = (1.0 - OFF, 1.0 + OFF)
    found = [
        _followed(motion, met, mass, friction, loop)
        for mass, friction, loop in product(factors, factors, loops)
    ]
    speed, torque, low, high = (list(x) for x in zip(*found, strict=True))
    # A drive that sticks under a slow loop takes less than the motion asks for.
    steady = max(np.max(np.abs(m * met.load + f * met.friction)) for m, f in product(factors, factors))
    asked = np.max(np.abs(met.load + met.inertia * motion.alpha + met.friction))
    return Extremes(
        max(speed),
        float(np.max(np.abs(motion.alpha))),
        float(max(*torque, steady, asked)) / abs(met.torque_constant) + met.noise,
        (float(np.min(motion.theta)) + min(low), float(np.max(motion.theta)) + max(high)),
    )


def _followed(
    motion: Reference, met: Met, mass: float, friction: float, loop_hz: float
) -> tuple[float, float, float, float]:
    """Largest speed and torque, and the deviation of the angle to both sides, of one drive under its loop.

    The integral begins with what holds the load: the drive stands before it moves.
    """
    dt = 1.0 / (RATE_HZ * LOOP_STEPS)
    inertia, load = mass * met.inertia, (mass * met.load).tolist()
    dry = (friction * _size(motion, met.friction)).tolist()
    gain = 2.0 * math.pi * loop_hz * (met.inertia if met.tuned_for is None else met.tuned_for)
    per_step, pole = gain * INTEGRAL_PER_S * dt, 1.0 - math.exp(-2.0 * math.pi * SPEED_FILTER_HZ * dt)
    step, speed, seen, integral, away = dt / inertia, 0.0, 0.0, load[0], 0.0
    speeds, torques, deviations = [0.0], [0.0], [0.0]
    for asked, pull, hold in zip(motion.omega.tolist(), load, dry, strict=True):
        level = step * hold
        for _ in range(LOOP_STEPS):
            error = asked - seen
            torque = gain * error + integral
            integral += per_step * error
            push = speed + step * (torque - pull)
            speed = push - level if push > level else push + level if push < -level else 0.0
            seen += pole * (speed - seen)
            away += dt * (speed - asked)
            torques.append(torque)
        speeds.append(speed)
        deviations.append(away)
    return max(map(abs, speeds)), max(map(abs, torques)), min(deviations), max(deviations)


def _size(motion: Reference, friction: Floats) -> Floats:
    """The size of friction [N m] (n,): at rest, where the models have none, that of the motion beside it."""
    moving = motion.omega != 0.0
    if not np.any(moving):
        return np.zeros(len(friction))
    size = np.maximum(friction * np.sign(motion.omega), 0.0)
    return np.interp(motion.t, motion.t[moving], size[moving])


Array = np.ndarray


# How far apart two rivals are.


class Sums(NamedTuple):
    """Of a design X (rows, k) and a target y: X'X, X'y, y'y and the lower bounds of the coefficients."""

    matrix: Array
    vector: Array
    square: float
    lower: Array


@dataclass(frozen=True)
class Ground:
    """A log or a motion as the rivals see it.

    screen: designs of the balance that shows them; candidates: by id, on its signals; seen: the rows (rows,)
    that a search would use; per_row: information of a row, 1/(variance of an independent one) times their
    number per row; current: [A] (samples,), the largest that any rival needs; met: what the drive meets
    there, None on a log.
    """

    screen: Screen
    candidates: dict[str, Candidate]
    seen: Array
    per_row: float
    current: Array
    met: Met | None = None

    def on(self, variants: Sequence[Variant]) -> list[Variant]:
        """The same variants on the signals of this ground."""
        return [Variant(self.candidates[v.candidate.id], v.values) for v in variants]

    def predicted(self, rival: Rival) -> Array:
        """The target (rows,) [N m] that a rival predicts."""
        target, design, _ = self.screen.design(self.on(rival.variants))
        return self.screen.balance.target - target + design @ rival.coefficients

    def sums(self, truth: Array, variants: Sequence[Variant]) -> Sums:
        """The sums of a fit of these variants to a true target (rows,)."""
        target, design, lower = self.screen.design(self.on(variants))
        y = (truth - (self.screen.balance.target - target))[self.seen]
        design = design[self.seen]
        weight = self.per_row
        return Sums(weight * design.T @ design, weight * design.T @ y, weight * float(y @ y), lower)

    def left(self, truth: Array, variants: Sequence[Variant], coefficients: Array) -> Array:
        """What these coefficients leave of a true target (rows,), in units of its noise."""
        target, design, _ = self.screen.design(self.on(variants))
        error = truth - (self.screen.balance.target - target) - design @ coefficients
        return np.sqrt(self.per_row) * error[self.seen]


class Separation:
    """The rivals of a question on its log, and on any motion; the link may carry more mass there."""

    def __init__(self, question: Question, added: AddedMass | None = None) -> None:
        self.question, self.rivals, self._added = question, question.rivals, added
        own = {v.candidate.id: v.candidate for rival in self.rivals for v in rival.variants}
        offered = question.screen.candidates
        # What a declared value may be off by is part of every rival.
        self.declared = [c for c in offered if c.tolerance and c.changes is None and c.id not in own]
        own |= {c.id: c for c in self.declared}
        # And each of them may be all that is wrong: a diagnosis compares it with the rivals.
        beside = self.rivals[0].variants[:-1]
        self.besides = tuple(
            rival_of(question.screen, (*beside, Variant(candidate, {})), None) for candidate in self.declared
        )
        self._effects: dict[str, Effect] = {e.id: e for e in question.effects if e.id in own}
        self._kept: dict[tuple[object, ...], Sums] = {}
        screen = question.screen
        variance = min(screen.fit(rival.variants).loss.sum() for rival in self.rivals) / screen.rows
        # Logs and windows may have gaps.
        seconds = (
            screen.rows * float(np.median(np.abs(np.diff(screen.balance.rows.t)))) if screen.rows > 1 else 1.0
        )
        # Rows overlap; a low pass leaves so many independent ones in a second.
        self._information = INFORMATIVE_HZ / variance
        per_row = min(self._information * seconds / screen.rows, 1.0 / variance)
        self.log = Ground(screen, own, np.ones(screen.rows, bool), per_row, np.empty(0))

    def ground(self, motion: Reference) -> Ground:
        """A motion as the rivals see it."""
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
            # Effects on the flux that the torque shows.
            candidates = {
                name: c if c.balance == "mechanical" or c.also is None else c.in_the("mechanical")
                for name, c in candidates.items()
            }
        seen = np.ones(len(motion.t), bool)
        if balance.name == "mechanical":
            seen = np.abs(motion.omega) > self.question.data.drive.channels.selection.moving_threshold_rad_s
        per_row = TRAINED * self._information / RATE_HZ
        made = Ground(Screen(balance, ()), candidates, seen, per_row, current)
        met = self._met(made, signals.known, load, base, motion)
        needed = met.load + met.inertia * motion.alpha + met.friction
        return replace(made, current=needed / met.torque_constant, met=met)

    def _met(
        self, ground: Ground, known: Mapping[str, float], load: Array, base: Array, motion: Reference
    ) -> Met:
        """What the drive meets: of all rivals the largest friction, at least that of the base model."""
        drive = self.question.data.drive
        tuned_for = inertia = drive.machine.inertia({**drive.known, **known})
        if self._added is not None:
            inertia = drive.machine.inertia(drive.machine.carrying({**drive.known, **known}, self._added))
        frictions = [base @ self.question.friction]
        if self.rivals[0].balance == "mechanical":
            frictions += [ground.predicted(rival) for rival in self.rivals]
        way = np.sign(motion.omega)
        friction = way * np.max([way * own for own in frictions], axis=0)
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
            """Loss and coefficients."""
            every = [self._sums(ground, truth, variants) for ground in grounds]
            matrix = np.sum([s.matrix for s in every], axis=0)
            matrix = matrix + np.diag(self._prior(variants, len(matrix)))
            vector, total = np.sum([s.vector for s in every], axis=0), sum(s.square for s in every)
            c = bounded_solve(matrix, vector, every[0].lower)
            return max(total + float(c @ matrix @ c - 2.0 * c @ vector), 0.0), c

        def left(variants: Sequence[Variant]) -> Array:
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
        (last,) = refined([options[best][-1]], lambda v: left((*others, *v)), steps)
        return min(fit((*others, last))[0], losses[best])

    def by_names(self, truth: str, other: str, grounds: Sequence[Ground]) -> float:
        """`apart` of two rivals by their families, refined."""
        own = {rival.family: rival for rival in (*self.besides, *self.rivals)}
        return self.apart(own[truth], own[other], grounds, STEPS)

    def information(self, rival: Rival, grounds: Sequence[Ground]) -> Array:
        """The information on the coefficients of a rival (k, k), base first, in 1/(their unit)^2."""
        found = np.sum([self._sums(ground, rival, rival.variants).matrix for ground in grounds], axis=0)
        return found + np.diag(self._prior(rival.variants, len(found)))

    def _prior(self, variants: Sequence[Variant], count: int) -> Array:
        """What is known of each coefficient (k,): of a declared value its deviation, else nothing."""
        declared = [v.candidate.deviation**-2 for v in self._with_declared(variants)[len(variants) :]]
        return np.r_[np.zeros(count - len(declared)), declared]

    def _sums(self, ground: Ground, truth: Rival, variants: Sequence[Variant]) -> Sums:
        """The sums of a fit to what a rival predicts, computed once."""
        key = (id(ground), truth.family, *(v.key for v in variants))
        if key not in self._kept:
            self._kept[key] = ground.sums(ground.predicted(truth), self._with_declared(variants))
        return self._kept[key]

    def _with_declared(self, variants: Sequence[Variant]) -> list[Variant]:
        """The variants, and what the other declared values may be off by."""
        own = {variant.candidate.id for variant in variants}
        return [*variants, *(Variant(c, {}) for c in self.declared if c.id not in own)]

    def _signals(self, motion: Reference) -> tuple[Signals, Array, Array, Array]:
        """Signals of a motion, its base columns (n, p), load [N m] and current [A] (n,) without effects."""
        data, model = self.question.data, self.question.model
        n, dt, own = len(motion.t), 1.0 / RATE_HZ, data.signals.known
        every = () if self._added is None else ((np.ones(n, bool), self._added),)
        old = replace(data.signals, by_row=Machine(model).along(own, every))
        # The machine counts its angle from where it likes, the model from where the mass hangs lowest.
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
        made: dict[ColumnRole, Array] = {
            "inertia": motion.alpha,
            "load": np.ones(n),
            "gravity": gravity,
            "back_emf": motion.omega,
            "offset": np.ones(n),
            "zero_angle": -slope,
        }
        signals = replace(signals, open={c: made[c.role] for c in data.drive.open})
        base = base_columns(model, signals)
        mechanical = self.question.friction
        load = load_torque(model, signals)
        current = data.drive.machine.current_of_torque(signals.known, load + base @ mechanical)
        values["i"] = current
        if "u" in old.values:
            values["u"] = data.drive.machine.voltage(signals.known, current, motion.omega)
        return replace(signals, values=values), base, load, current

    def _balance(self, signals: Signals, base: Array, motion: Reference) -> BalanceDesign:
        """The balance of the rivals on a motion, its rows the samples, its target zero."""
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
    """The variant at shapes around its own, within their range."""
    found = [variant]
    for shape in variant.candidate.shapes:
        name, now = shape.quantity.name, found
        found = [
            Variant(v.candidate, {**v.values, name: float(np.clip(near, shape.low, shape.high))})
            for v in now
            for near in np.multiply(COARSE, v.values[name])
        ]
    return found
