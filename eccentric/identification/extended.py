"""Fit a model, extended or not, on its own emitted module: what is scored is what is shipped.

The residual of the mechanical balance is linear in friction, in the coefficients of effects and in what the
rig leaves open; only the scale of the drive is not.  A free column of gravity finds it: if the fit requires
1 + g times the gravity torque, the scale (or the unknown arm) was too small by that factor, and the fit is
repeated with the corrected one until g vanishes.

If only one signal measures the drive, effects of the current use the one that the model predicts,
(torque - residual)/k_i of the previous step: with the measured one the drive would explain itself.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from eccentric.effects import Effect
from eccentric.identification.fit_data import FitData, Residuals, Values
from eccentric.identification.limits import LAST_STEP, MOST_STEPS, USABLE_PART
from eccentric.identification.regression import Coefficient, ColumnRole, Design, Solution, iterate
from eccentric.model import Model

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
_IN_THE_MODEL: set[ColumnRole] = {"inertia", "load"}
"""What the rig leaves open of parameters of the model; the rest is outside its module."""


@dataclass(frozen=True)
class Point:
    """The state of an iteration: every parameter of the model, scale and offset of the drive, zero angle.

    `current` (samples,) [A at the scale] is the one that effects use; None for the measured one.
    """

    values: Values
    scale: float | None
    offset: float = 0.0
    zero: float = 0.0
    current: Array | None = None


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
    """A base model with effects on a log, ready to be fitted.

    groups: the friction coefficients, those of a group are one number; bounds: whether they are held within
    theirs.
    """

    model: Model
    effects: tuple[tuple[Effect, Values], ...]
    data: FitData
    groups: tuple[tuple[Coefficient, ...], ...]
    bounds: bool

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
            if self.data.drive.adjusts != "phi":
                return outside
            lower, upper = (end / math.cos(point.values["phi"]) - 1.0 for end in ends)
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
