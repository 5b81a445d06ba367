"""A log prepared for fitting: drive, smooth signals, rows; the one way from a model to a fit's rows.

The residuals are those of the emitted module, and so is the design: what is fitted is what is shipped.
"""

from __future__ import annotations

import dataclasses
import inspect
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.effects import Effect
from eccentric.emission import load_module
from eccentric.identification.drive import Drive, Machine
from eccentric.identification.expressions import (
    Signals,
    base_coefficients,
    base_columns,
    compiled,
    load_torque,
    seen_columns,
    state_series,
)
from eccentric.identification.limits import LAST_STEP, MOST_STEPS, MOSTLY_OFF, USABLE_PART
from eccentric.identification.regression import (
    Coefficient,
    ColumnRole,
    Design,
    Solution,
    iterate,
    require_rank,
)
from eccentric.model import Model, meaning
from eccentric.model import vocabulary as v
from eccentric.rigs import Rig
from eccentric.signals import Channels, Rows, rows_of, white_noise, with_doubts

Array = NDArray[np.float64]


class Emitted:
    """The functions of an emitted module, called with the inputs that they require."""

    def __init__(self, model: Model) -> None:
        self._module = load_module(model.with_other_values)
        self.letters = tuple(field.name for field in dataclasses.fields(self._module.Parameters))

    def parameters(self, values: Mapping[str, float]) -> Any:
        """Return the emitted `Parameters` with those values that the model has; others are ignored.

        Raises ValueError if the emitted class refuses a value.
        """
        return self._module.Parameters(**{k: x for k, x in values.items() if k in self.letters})

    def inputs_of(self, function: str) -> tuple[str, ...]:
        """The names of the inputs that a function takes."""
        names = inspect.signature(getattr(self._module, function)).parameters
        return tuple(name for name in names if name not in {"parameters", "out"})

    def __call__(self, function: str, inputs: Mapping[str, Array], parameters: Any) -> Array:
        """Evaluate a function on the inputs (n,) that it takes."""
        return getattr(self._module, function)(*(inputs[n] for n in self.inputs_of(function)), parameters)


class Residuals:
    """The residuals of a model on the samples (n,) and rows (m,) of a log.

    `values` are those for the drive torque, `scale` is that of the drive, None for its own; `states` are the
    hidden states (n,) by name.
    """

    def __init__(
        self,
        model: Model,
        drive: Drive,
        rows: Rows,
        values: Mapping[str, float],
        scale: float | None = None,
        states: Mapping[str, Array] | None = None,
    ) -> None:
        self._model, self._emitted, self._machine = model, Emitted(model), Machine(model)
        self._drive, self._rows = drive, rows
        voltage = drive.signal() if drive.by_voltage else drive.channels.motor.voltage
        self.inputs = drive.inputs | ({} if voltage is None else {"u": voltage})
        self.torque = drive.torque(values, scale)
        self.inputs["i"] = drive.machine.current_of_torque(values, self.torque)
        self.inputs |= {} if states is None else states

    def design(
        self,
        balance: str,
        values: Mapping[str, float],
        unknown: Sequence[tuple[str, ...]],
        current: Array | None = None,
    ) -> tuple[Array, Array]:
        """A balance that is linear in its unknowns: its residual without them (m,), a column for each (m, k).

        A column is what a unit step of the emitted function changes: of a parameter, or of several that are
        the same number. The columns may have a different current from the measured balance.
        """
        start = {**values, **{name: 0.0 for names in unknown for name in names}}
        rest = self.rows(balance, start)
        there = rest if current is None else self.rows(balance, start, current)
        steps = [
            there - self.rows(balance, {**start, **dict.fromkeys(names, 1.0)}, current) for names in unknown
        ]
        return rest, np.column_stack(steps) if steps else np.empty((len(rest), 0))

    def rows(self, balance: str, values: Mapping[str, float], current: Array | None = None) -> Array:
        """The residual of a balance on the rows [N m], optionally with a different current."""
        filtered = self._drive.filtered(balance, self._machine, values)
        return self._rows.once(self.samples(balance, values, current), filtered)

    def samples(self, balance: str, values: Mapping[str, float], current: Array | None = None) -> Array:
        """The same on the samples.

        With voltage alone, the two balances are one: i is the torque from the voltage, so that the electrical
        residual contains only the effects of the armature.
        """
        inputs = self.inputs if current is None else self.inputs | {"i": current}
        found = self._alike(balance, inputs, values)
        for rows, added in self._drive.channels.carried:
            carrying = self._alike(balance, inputs, self._machine.carrying(values, added))
            found = np.where(rows, carrying, found)
        return found

    def _alike(self, balance: str, inputs: Mapping[str, Array], values: Mapping[str, float]) -> Array:
        """A residual on the samples (n,), all of them with the same parameters."""
        parameters = self._emitted.parameters(values)
        found = self._emitted(f"{balance}_residual", inputs, parameters)
        if balance != "mechanical":
            return found
        for names, fast in self._drive.unresolved(self._model, values):
            without = self._emitted.parameters({**values, **dict.fromkeys(names, 0.0)})
            found = np.where(fast, self._emitted("mechanical_residual", inputs, without), found)
        if self._drive.by_voltage:
            armature = self._emitted("electrical_residual", inputs, parameters)
            found = found + np.where(self._drive.off, 0.0, armature)
        return found


Values = dict[str, float]


@dataclass(frozen=True)
class FitData:
    """Drive, smooth signals, rows; gravity torque (samples,) [N m]."""

    drive: Drive
    signals: Signals
    rows: Rows
    gravity: Array

    @property
    def off(self) -> NDArray[np.bool_]:
        """Rows (m,) with the motor off: they have no voltage or current to be compared in."""
        return self.rows.plain_mean(self.drive.off.astype(float)) > MOSTLY_OFF

    @property
    def narrowed(self) -> FitData | None:
        """The same log below a lower cut-off, with the current that effects use; None without a low pass."""
        coarse = self.drive.channels.time.points_per_row > 1
        if self.rows.smooth is None or self.signals.base is None or coarse:
            return None
        drive = self.drive.narrowed()
        found = fit_data_of(drive, drive.channels.rig, self.signals.base)
        values = {**found.signals.values, "i": self.signals.values["i"]}
        return replace(found, signals=replace(found.signals, values=values))

    @property
    def later(self) -> FitData | None:
        """The same log with the current sampled one standard error later in its row."""
        drive = self.drive.later
        return None if drive is None else replace(self, drive=drive)

    def residuals(
        self, model: Model, shapes: Mapping[str, float], values: Values, scale: float | None
    ) -> Residuals:
        """The residuals of a model; `shapes` are those for its hidden states, others as in `Residuals`."""
        states = state_series(model, self.signals, shapes) if model.states else None
        return Residuals(model, self.drive, self.rows, values, scale, states)

    def require_rank(self, model: Model, where: str) -> None:
        """Raise InputError, `where` opening it, if the training rows leave coefficients of a model open."""
        columns = self.rows.mean(base_columns(model, self.signals))[self.rows.train]
        axis = self.drive.channels.rig.axis
        names = [axis.named(c.name) for c in base_coefficients(model, self.signals)]
        with with_doubts(self.drive.channels.intake.findings):
            require_rank(columns, names, where, axis)


def fit_data_of(drive: Drive, rig: Rig, model: Model) -> FitData:
    """Smooth signals that expressions are evaluated on, and the rows that models are compared on.

    The current that effects depend on is (u - k_e omega_m)/R if there is a voltage: measured current on both
    sides of the balance would explain its own noise.
    """
    channels, known = drive.channels, dict(drive.known)
    values = drive.inputs
    if drive.measured_twice and channels.motor.voltage is not None:
        values["u"] = channels.smooth(channels.motor.voltage)
        values["i"] = drive.machine.current(known, values["u"], channels.motion.omega_m)
    else:
        values["i"] = drive.machine.current_of_torque(known, channels.smooth(drive.torque()))
    if drive.scale is not None:
        machine = drive.machine
        absent = dict.fromkeys(machine.back_emf_letters, 0.0) | dict.fromkeys(machine.resistance_letters, 1.0)
        known = absent | known | drive.scaled()
    if drive.by_voltage:
        values["u"] = channels.smooth(drive.signal())
    starts = tuple(int(k) for k in np.flatnonzero(np.r_[True, np.diff(channels.time.segment) != 0]))
    dt = np.diff(channels.time.t, append=channels.time.t[-1] + np.median(np.diff(channels.time.t)))
    if channels.time.one_clock:
        starts = (0,)
    dt[[start - 1 for start in starts if start > 0]] = float(np.median(dt))
    # A mass that only some runs carry loads the bearing there.
    seen = seen_columns(model, {} if drive.channels.carried else known)
    signals = Signals(
        values,
        dt,
        starts,
        known,
        friction=seen,
        base=model,
        bridged=_bridged(channels),
        by_row=Machine(model).along(known, channels.carried),
    )
    # Its slope is that over the link angle.
    torque = meaning(model.expand(model.balance("mechanical").sum_of("gravity")))
    rising = sp.diff(torque, v.theta_m.symbol) / v.mu.symbol
    gravity, slope = (compiled(model, x, signals)({}, {}) for x in (torque, rising))
    signals = replace(signals, open=drive.columns(gravity, slope))
    return FitData(drive, signals, rows_of(channels, rig), gravity)


def _bridged(channels: Channels) -> dict[int, int]:
    """Steps from the sample before to each one that a window of a long log begins with, inside a run."""
    time = channels.time
    begins = np.flatnonzero(time.skipped[1:] & (np.diff(time.run) == 0)) + 1
    steps = (time.t[begins] - time.t[begins - 1]) / np.median(np.diff(time.t))
    return dict(zip(begins.tolist(), steps.round().astype(int).tolist(), strict=True))


def with_model_current(data: FitData, model: Model, friction: Array) -> FitData:
    """The data with the current that the first fit predicts.

    If only one signal measures the drive, its current is that signal: an effect of it would explain the drive
    by itself, including its noise.
    """
    signals = data.signals
    torque = load_torque(model, signals) + base_columns(model, signals) @ friction
    current = data.drive.machine.current_of_torque(signals.known, torque)
    return replace(data, signals=replace(signals, values={**signals.values, "i": current}))


def drive_noise(data: FitData) -> float:
    """RMS that the white noise of the measured drive leaves in a row, from its fourth differences."""
    drive = data.drive
    if drive.channels.motor.coasting:
        return deceleration_noise(drive, data.rows)
    sigma = white_noise(drive.torque(), drive.channels.time.segment)
    # An average of rows has less of it; the median one represents all.
    return sigma * float(np.sqrt(np.median(data.rows.noise_gain() ** 2)))


def deceleration_noise(drive: Drive, rows: Rows) -> float:
    """RMS of the noise in a row of a coast-down [N m], where only the motion is measured.

    From the fourth differences of every second row, which share no samples: their errors alternate, since a
    speed that is too high here is one from which the next row falls, and are taken for 1.3 times as large.
    """
    every = rows.mean(drive.driven_by())[::2]
    return white_noise(every, rows.run[::2])


_IN_THE_MODEL: set[ColumnRole] = {"inertia", "load"}
"""What the rig leaves open of parameters of the model; the rest is outside its module."""


# Fit a model, extended or not, on its own emitted module: what is scored is what is shipped.
#
# The residual of the mechanical balance is linear in friction, in the coefficients of effects and in what the
# rig leaves open; only the scale of the drive is not.  A free column of gravity finds it: if the fit requires
# 1 + g times the gravity torque, the scale (or the unknown arm) was too small by that factor, and the fit is
# repeated with the corrected one until g vanishes.
#
# If only one signal measures the drive, effects of the current use the one that the model predicts,
# (torque - residual)/k_i of the previous step: with the measured one the drive would explain itself.
@dataclass(frozen=True)
class Point:
    """The state of an iteration: every parameter of the model, scale and offset of the drive, zero angle."""

    values: Values
    scale: float | None
    offset: float = 0.0
    zero: float = 0.0
    current: Array | None = None  # (samples,) [A at the scale], which effects use; None for the measured one


@dataclass(frozen=True)
class Step:
    """The result of a step of the iteration, and the point that it leads to.

    solutions and residuals (rows,) [N m] by balance; target (rows,): the required mechanical friction,
    effects included [N m].
    """

    point: Point
    solutions: Mapping[str, Solution] = field(default_factory=dict)
    residuals: Mapping[str, Array] = field(default_factory=dict)
    target: Array = field(default_factory=lambda: np.empty(0))


@dataclass(frozen=True)
class Extended:
    """A base model with effects on a log, ready to be fitted."""

    model: Model
    effects: tuple[tuple[Effect, Values], ...]
    data: FitData
    groups: tuple[tuple[Coefficient, ...], ...]  # the friction coefficients, those of a group are one number
    bounds: bool  # whether they are held within theirs

    @property
    def shapes(self) -> Values:
        """The nonlinear values of the effects, and their coefficients before the fit."""
        return {name: value for _, own in self.effects for name, value in own.items()}

    @property
    def follows(self) -> bool:
        """Whether effects use the current that the model predicts."""
        return bool(self.effects) and not self.data.drive.measured_twice

    def start(self, base: Model) -> Point:
        """The start of the iteration: known values, and zero for all that is fitted."""
        drive, letters = self.data.drive, {q.name for q in self.model.parameters}
        values = {n: x for n, x in {**drive.machine.absent, **drive.known}.items() if n in letters}
        values |= drive.scaled()
        values |= dict.fromkeys((q.name for q in base.friction_parameters), 0.0) | self.shapes
        return Point(values | dict.fromkeys(self._of_effects(), 0.0), drive.scale)

    def fitted(self, base: Model) -> tuple[Step, float]:
        """Iterate until scale and current have converged, or the limit is reached; return the last change."""
        most = MOST_STEPS if self.data.drive.opens("gravity") or self.follows else 1
        return iterate(self.advance, Step(self.start(base)), most, LAST_STEP)

    def advance(self, last: Step) -> tuple[Step, float]:
        """One step: solve at a point and move on; return the relative change of scale and current."""
        drive, point = self.data.drive, last.point
        residuals = self.residuals(point)
        point, moved = self._followed(point, residuals) if self.follows else (point, 0.0)
        solutions: dict[str, Solution] = {}
        if drive.measured_twice and self._own("electrical", "effect"):
            solutions["electrical"] = self.design("electrical", point, residuals).solve()
            point, _ = self._moved(point, solutions["electrical"])
        solutions["mechanical"] = solution = self.design("mechanical", point, residuals).solve()
        point, change = self._moved(point, solution)
        # By its columns, since Parameters refuse the negative values of a fit without bounds.
        found = {"mechanical": solution.residual}
        roles = np.array([c.role in {"friction", "effect"} for c in solution.design.coefficients])
        target = found["mechanical"] + solution.design.columns[:, roles] @ solution.values[roles]
        if drive.measured_twice:
            lowest = {c.name: c.lower for group in self.groups for c in group}
            allowed = {n: max(x, lowest.get(n, x)) for n, x in point.values.items()}
            found["electrical"] = residuals.rows("electrical", allowed)
        return Step(point, solutions, found, target), max(abs(change), moved)

    def residuals(
        self, point: Point, model: Model | None = None, shapes: Mapping[str, float] | None = None
    ) -> Residuals:
        """The residuals of this model, or of another one, at a point."""
        given = self.shapes if shapes is None else shapes
        return self.data.residuals(model or self.model, given, point.values, point.scale)

    def design(self, balance: str, point: Point, residuals: Residuals | None = None) -> Design:
        """The design of a balance at a point; mechanical, with the columns outside the module."""
        drive, rows = self.data.drive, self.data.rows
        own, train, outside = self._own(balance, "effect"), rows.train, dict[Coefficient, Array]()
        if balance == "electrical":
            usable = rows.plain_mean(drive.channels.selection.usable.astype(float)) > USABLE_PART
            train = train & usable
        else:
            own = [*(group[0] for group in self.groups), *own]
            own += self._own("electrical", "armature") if drive.by_voltage else []
            own += [c for c in drive.open if c.role in _IN_THE_MODEL]
            # A motor that is off separates back-EMF and viscous friction.
            free = np.any(drive.off) and np.any(rows.plain_mean(drive.off.astype(float))[train])
            without = _IN_THE_MODEL | (set() if free else {"back_emf"})
            # Gravity, back-EMF, offset and zero angle, against the drive. What comes from filtered angles
            # does not pass the low pass again.
            outside = {
                c: rows.plain_mean(x) if c.role == "bodies" else rows.mean(x)
                for c, x in self.data.signals.open.items()
                if c.role not in without
            }
        unknown = [tuple(self._all(c.name, 1.0)) for c in own]
        residuals = residuals or self.residuals(point)
        rest, steps = residuals.design(balance, point.values, unknown, point.current)
        every = (*own, *(self._left(c, point) for c in outside))
        design = Design(every, rest, np.column_stack([steps, *outside.values()]), train, rows.weights)
        # None of these leaves its bounds, whatever a friction coefficient has to imitate.
        return design if self.bounds else design.without_bounds(but=("inertia", "back_emf", "gravity"))

    def _own(self, balance: str, role: ColumnRole) -> list[Coefficient]:
        """The coefficients of the effects that a balance shows."""
        return [
            Coefficient.within(q.name, role, q.unit, bounds)
            for effect, _ in self.effects
            if effect.balance == balance
            for q, bounds in zip(effect.coefficients, effect.bounds, strict=True)
        ]

    def _left(self, outside: Coefficient, point: Point) -> Coefficient:
        """What is left of a coefficient without a parameter in the module, at a point; as a torque."""
        ends, scale = (outside.lower, outside.upper), point.scale or 1.0
        if outside.role == "gravity":
            adjusts = self.data.drive.adjusts
            now = scale if adjusts == "scale" else point.values[adjusts]
            now = math.cos(now) if adjusts == "phi" else now
            lower, upper = (end / now - 1.0 for end in ends)
        else:
            known = point.values["k_e"] if outside.role == "back_emf" else 0.0
            lower, upper = ((end - known) / scale for end in ends)
        return replace(outside, lower=lower, upper=upper)

    def _moved(self, point: Point, solution: Solution) -> tuple[Point, float]:
        """Put a solution into the values; return the remaining coefficient of the free gravity column.

        Columns outside the module change scale, back-EMF, offset and zero angle.
        """
        found = solution.by_name()
        gravity, emf = found.pop("gravity", 0.0), found.pop("back_emf", 0.0)
        offset, zero = found.pop("offset", 0.0), found.pop("zero_angle", 0.0)
        drive, values, scale = self.data.drive, dict(point.values), point.scale
        if emf:
            values["k_e"] += emf * (scale or 1.0)
        offset *= scale or 1.0
        # All of a scaled solution is too large by the same factor.
        factor = 1.0 + gravity if drive.adjusts == "scale" else 1.0
        for name, x in found.items():
            values |= self._all(name, x / factor)
        if drive.rotor is not None and drive.machine.rotor in found:
            values |= drive.machine.shared(values, drive.rotor)
        if drive.adjusts == "scale" and scale is not None:
            scale *= factor
            values |= drive.scaled(scale)
        elif gravity:
            values |= drive.with_gravity(values, 1.0 + gravity)
        return Point(values, scale, offset, zero, point.current), gravity

    def _followed(self, point: Point, residuals: Residuals) -> tuple[Point, float]:
        """Use the current that the last step predicts; return the relative RMS of its change."""
        if point.current is None:
            return replace(point, current=self.data.signals.values["i"]), np.inf
        current = self._model_current(point, residuals)
        change = np.linalg.norm(current - point.current) / np.linalg.norm(current)
        return replace(point, current=current), float(change)

    def _model_current(self, point: Point, residuals: Residuals) -> Array:
        """The current (samples,) that the model of the last step predicts [A at the scale of the fit]."""
        quiet = point.values | dict.fromkeys(self._of_effects(), 0.0)
        effect = residuals.samples("mechanical", point.values, point.current)
        effect = effect - residuals.samples("mechanical", quiet, point.current)
        # The offset is zero where no column of it is free.
        offset = np.where(self.data.drive.off, 0.0, point.offset / (point.scale or 1.0))
        rest = residuals.samples("mechanical", quiet) + effect - offset
        return residuals.inputs["i"] - self.data.drive.machine.current_of_torque(point.values, rest)

    def _all(self, name: str, value: float) -> Values:
        """The value of a coefficient, and of those of its group."""
        own = next((group for group in self.groups if group[0].name == name), ())
        return {name: value, **dict.fromkeys((c.name for c in own), value)}

    def _of_effects(self) -> list[str]:
        return [q.name for effect, _ in self.effects for q in effect.coefficients]
