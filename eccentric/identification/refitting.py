"""The fit of a model, extended or not: its estimates, shares and residuals."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from eccentric.effects import Effect, Shape
from eccentric.identification import limits
from eccentric.identification.drive import Drive, Machine, in_drive_unit
from eccentric.identification.expressions import alike, base_coefficients
from eccentric.identification.fit_data import Extended, FitData, Step, Values, drive_noise
from eccentric.identification.regression import Coefficient, Nonlinear, slopes_between
from eccentric.identification.uncertainty import TWO_SIDED, Estimate, rms
from eccentric.model import Model
from eccentric.signals import Band, band_of

Array = NDArray[np.float64]


def estimates(fit: Extended, step: Step) -> tuple[dict[str, Estimate], Array]:
    """Values with standard errors, by name, and the covariance (n, n) of their errors in the same order.

    Each is estimated from one balance; NaN is the covariance of two that are from different ones, and zero
    that of a coefficient that a bound holds, or of a shape without a slope.
    """
    found: dict[str, Estimate] = {}
    blocks: list[Array] = []
    others = [replace(fit, data=x) for x in (fit.data.narrowed, fit.data.later) if x is not None]
    for balance in step.solutions:
        own, covariance = _of_balance(fit, step, balance, others)
        found |= own
        blocks.append(covariance)
    whole = np.full((len(found), len(found)), np.nan)
    first = 0
    for block in blocks:
        last = first + len(block)
        whole[first:last, first:last] = block
        first = last
    return found, whole


def _of_balance(
    fit: Extended, step: Step, balance: str, others: list[Extended]
) -> tuple[dict[str, Estimate], Array]:
    """The estimates from one balance and their covariance; shapes enter by the slope of the residual."""
    drive, point, solution = fit.data.drive, step.point, step.solutions[balance]
    machine = drive.machine
    own = {balance} | ({"electrical"} if drive.by_voltage else set())
    shapes = {s.quantity.name: s for e, _ in fit.effects if e.balance in own for s in e.shapes}
    solution = replace(
        solution, at={name: point.values[name] for name in shapes}, slopes=_slopes(fit, step, balance, shapes)
    )
    # A shape is free in its error even at an end of its range, where its estimate says so.
    error = solution.spread(
        [Nonlinear(n, "", -np.inf, np.inf, (), 0.0) for n in shapes],
        tuple(one.design(balance, point) for one in (fit, *others)) if others else (),
    )
    coefficients, values = solution.design.coefficients, point.values
    units = {q.name: in_drive_unit(q.unit, drive.unit) for q in fit.model.parameters}
    unit = np.eye(len(coefficients) + len(shapes))
    # All torques are divided by the scale, so that its error is theirs as well.
    roles = [c.role for c in coefficients]
    scaled = drive.adjusts == "scale" and "gravity" in roles
    shared = unit[roles.index("gravity")] if scaled else np.zeros(len(unit))
    found: dict[str, Estimate] = {}
    slopes: list[Array] = []
    for k, c in enumerate(coefficients):
        name, ends, active = c.name, (c.lower, c.upper), int(solution.active[k])
        if c.role == "inertia" and drive.rotor is not None:
            # The rotor is known: what is free is the link's.
            name = machine.link
            whole = machine.inertia({**values, machine.rotor: drive.rotor})
            slope = (unit[k] - whole * shared) / machine.inertia_per(name, values)
            found[name] = error.estimate(values[name], slope, units[name], ends)
        elif name in units:
            slope = unit[k] - values[name] * shared
            found[name] = error.estimate(values[name], slope, units[name], ends, active)
        else:
            name, value, factor, of = _outside(c, fit, step)
            slope, free = factor * unit[k], (-math.inf, math.inf)
            # The bounds of the free gravity column are those of what it adjusts, relative to its value.
            ends = (value * (1.0 + c.lower), value * (1.0 + c.upper)) if c.role == "gravity" else free
            found[name] = error.estimate(value, slope, of, ends, active if c.role == "gravity" else 0)
        if name == "phi":
            first, last = drive.channels.rig.unknown[name]
            cosine, ends = math.cos(values[name]), (math.cos(last), math.cos(first))
            found[name] = _tilt(error.estimate(cosine, cosine * unit[k], "", ends, active), (first, last))
        slopes.append(slope)
    for k, (name, shape) in enumerate(shapes.items(), start=len(coefficients)):
        ends, value = (shape.low, shape.high), point.values[name]
        if shape.jumps:
            low, high = _profile(fit, step, balance, shape)
            found[name] = Estimate(value, (high - low) / (2.0 * TWO_SIDED), (low, high), units[name])
        else:
            place = shape.place_of(value)
            at_end = int(place > 1.0 - limits.AT_END) - int(place < limits.AT_END)
            found[name] = error.estimate(value, unit[k], units[name], ends, at_end)
        slopes.append(unit[k])
    gradient, endless = np.array(slopes), np.isinf(np.diag(error.matrix))
    covariance = gradient[:, ~endless] @ error.matrix[np.ix_(~endless, ~endless)] @ gradient[:, ~endless].T
    lost = np.any(gradient[:, endless] != 0.0, axis=1)
    covariance[lost, lost] = np.inf
    return found, covariance


def _tilt(cosine: Estimate, ends: tuple[float, float]) -> Estimate:
    """The tilt [rad] inside its range, from its cosine: the one is not linear in the other near upright.

    At a bound it has no standard error.
    """

    def angle(x: float) -> float:
        return math.acos(min(max(x, -1.0), 1.0))

    def inside(x: float) -> float:
        return min(max(angle(x), ends[0]), ends[1])

    value, reach = cosine.value, TWO_SIDED * cosine.std_error
    # More gravity is less tilt.
    side = {"lower": "upper", "upper": "lower", None: None}[cosine.bound_active]
    error = math.nan if side else (angle(value - reach) - angle(value + reach)) / (2.0 * TWO_SIDED)
    (low, high), widened = cosine.interval, side is not None or cosine.widened
    return Estimate(inside(value), error, (inside(high), inside(low)), "rad", side, widened)


def _profile(fit: Extended, step: Step, balance: str, shape: Shape) -> tuple[float, float]:
    """The 95 % interval of a shape without a slope: where the sum of squares rises by what chance allows.

    The other values stay as they are. Rows of one block count as one: they are not independent.
    """
    rows, name, misfit = fit.data.rows, shape.quantity.name, _misfit(fit, step, balance)
    train, here = rows.train, step.point.values[name]

    def loss(place: float) -> float:
        return float(np.sum(rows.weights[train] * misfit({name: shape.at(place)})[train] ** 2))

    start = shape.place_of(here)
    least = loss(start)
    most = least * (1.0 + TWO_SIDED**2 / len(np.unique(rows.block[train])))
    found = []
    for way, last in ((-1.0, 0.0), (1.0, 1.0)):
        inside, distance = start, limits.FIRST_PART
        while (outside := start + way * distance) * way < last * way and loss(outside) <= most:
            inside, distance = outside, 2.0 * distance
        outside = min(max(outside, 0.0), 1.0)
        if loss(outside) <= most:
            found.append(outside)
            continue
        for _ in range(limits.HALVINGS):
            middle = 0.5 * (inside + outside)
            inside, outside = (middle, outside) if loss(middle) <= most else (inside, middle)
        found.append(outside)
    return shape.at(found[0]), shape.at(found[1])


def _misfit(fit: Extended, step: Step, balance: str) -> Callable[[Mapping[str, float]], Array]:
    """Prediction minus target (rows,) with other values of some shapes."""
    point = step.point
    every = {s.quantity.name for e, _ in fit.effects for s in e.shapes}
    as_it_is = fit.residuals(point)
    here = -as_it_is.rows(balance, point.values, point.current)

    def misfit(at: Mapping[str, float]) -> Array:
        values = {**point.values, **at}
        if values == point.values:
            return here
        there = fit.residuals(point, shapes={n: values[n] for n in every}) if fit.model.states else as_it_is
        return -there.rows(balance, values, point.current)

    return misfit


def _slopes(fit: Extended, step: Step, balance: str, shapes: Mapping[str, Shape]) -> Array:
    """Slopes (rows, q) of prediction minus target by each shape, by forward differences; 0 without one."""
    point = step.point
    ends = {
        name: (
            x := point.values[name],
            x + limits.SHAPE_STEP * (s.high - s.low if s.scale == "linear" else x),
        )
        for name, s in shapes.items()
        if not s.jumps
    }
    found = np.zeros((len(fit.data.rows), len(shapes)))
    if ends:
        here = {name: point.values[name] for name in ends}
        found[:, [name in ends for name in shapes]] = slopes_between(_misfit(fit, step, balance), here, ends)
    return found


def _outside(c: Coefficient, fit: Extended, step: Step) -> tuple[str, float, float, str]:
    """Name, value, factor on the coefficient's error, and unit of each quantity of the drive."""
    drive, point = fit.data.drive, step.point
    scale = point.scale or 1.0
    if c.role == "gravity" and drive.adjusts == "scale":
        letters, unit = ("R/k_i", "V/(N m)") if drive.by_voltage else ("1/k_i", "A/(N m)")
        return letters, scale, scale, unit
    if c.role == "gravity":
        value = point.values[drive.adjusts]
        if drive.adjusts == "phi":
            # Of d cos(phi) = -sin(phi) d phi, for correlations; finite in an upright plane.
            return "phi", value, -math.cos(value) / max(math.sin(value), limits.LEAST_TILT), "rad"
        units = {q.name: q.unit for q in fit.model.parameters}
        return drive.adjusts, value, value, units[drive.adjusts]
    if c.role == "back_emf":
        return "k_e", point.values["k_e"], scale, c.unit
    if c.role == "bodies":
        return c.name, point.values.get(c.name, 0.0), 1.0, c.unit
    if c.role == "zero_angle":
        return "theta_zero_rad", drive.channels.alignment.theta_zero_rad + point.zero, 1.0, "rad"
    offset = drive.channels.alignment.voltage_offset_V + point.offset
    return "voltage_offset_V", offset, scale, "V"


def shares(fit: Extended, step: Step, base: Model) -> dict[str, float]:
    """RMS of the contribution of each effect, over that of the friction, on training rows."""
    data, point = fit.data, step.point
    rows = data.rows.train
    friction = rms(step.target[rows])
    found: dict[str, float] = {}
    whole = fit.residuals(point)
    for effect, _ in fit.effects:
        others = [(e, own) for e, own in fit.effects if e is not effect]
        model = base
        for other, own in others:
            model = other.extend(model, own)
        letters = {q.name for q in model.parameters}
        values = {name: value for name, value in point.values.items() if name in letters}
        kept = {s.quantity.name: point.values[s.quantity.name] for e, _ in others for s in e.shapes}
        balance = "mechanical" if data.drive.by_voltage else effect.balance
        without = fit.residuals(point, model, kept).rows(balance, values)
        found[effect.id] = rms((without - whole.rows(balance, point.values))[rows]) / friction
    return found


@dataclass(frozen=True)
class Refit:
    """A model fitted on the training part.

    Attributes:
        model: the model, extended by `effects`.
        effects: each with the values of all its parameters.
        values: every parameter of the model by name, as the emitted Parameters take it.
        scale: of the drive, V/(N m) or A/(N m); None where the torque is measured.
        estimates: fitted parameters with uncertainty, by name.
        covariance: of their errors (n, n), in the same order; zero where a bound holds one, NaN between two
            that are estimated from different balances.
        residuals: balance -> (rows,) [N m at this fit's own scale].
        shares: effect id -> RMS of its torque as a fraction of that of the friction, on training rows.
        target: (rows,) required mechanical friction, effects included [N m].
        data: what it was fitted on.
        change: relative, of the scale or of the predicted current, by the last step of the fit.
    """

    model: Model
    effects: tuple[tuple[Effect, Values], ...]
    values: Values
    scale: float | None
    estimates: dict[str, Estimate]
    covariance: Array
    residuals: dict[str, Array]
    shares: dict[str, float]
    target: Array
    data: FitData
    change: float

    @property
    def shapes(self) -> Values:
        """The nonlinear values of its effects, by name."""
        return {s.quantity.name: self.values[s.quantity.name] for e, _ in self.effects for s in e.shapes}

    @property
    def settled(self) -> bool:
        """Whether another step would not change the digits that are shown."""
        return self.change < limits.CONVERGED

    def held_out(self, balance: str) -> float:
        """Held-out RMSE of a balance [N m]."""
        return rms(self.residuals[balance][self.data.rows.score])

    def smooth_residual(self, balance: str = "mechanical") -> Array:
        """The residual (rows,) [N m at this fit's scale] below the low pass; rows that are averages stay."""
        residual = self.residuals[balance]
        if self.data.rows.operator is not None:
            return residual
        return self.data.drive.channels.smooth_residual(residual, self._filtered(balance))

    @property
    def band(self) -> Band | None:
        """The band of the held-out error; None where rows are averages."""
        rows, channels = self.data.rows, self.data.drive.channels
        if rows.operator is not None:
            return None
        return band_of(
            self.residuals["mechanical"], self._filtered("mechanical"), rows, channels, drive_noise(self.data)
        )

    def _filtered(self, balance: str) -> Array:
        """What of a residual (n,) [N m] follows the motion, which has passed the low pass already."""
        parts = self.data.drive.filtered(balance, Machine(self.model), self.values)
        return np.sum([part.value for part in parts], axis=0)

    @property
    def unresolved_rows(self) -> NDArray[np.bool_]:
        """Rows (rows,) where a torque of the effects repeats faster than half of the log's rate."""
        drive, rows = self.data.drive, self.data.rows
        fast = drive.unresolved(self.model, self.values)
        if not fast:
            return np.zeros(len(rows), dtype=bool)
        return rows.plain_mean(fast[0][1].astype(float)) > 0.0

    def residual_like(self, other: Refit, balance: str = "mechanical", *, smooth: bool = False) -> Array:
        """The residual (rows,) at the scale of another fit; with `smooth`, below the low pass.

        Models that identify different scales are compared in the unit of the drive.
        """
        residual = self.smooth_residual(balance) if smooth else self.residuals[balance]
        return residual * ((self.scale or 1.0) / (other.scale or 1.0))


def refit(
    base: Model,
    effects: tuple[tuple[Effect, Values], ...],
    data: FitData,
    bounds: bool = True,
    linear: bool = False,
    without: int | None = None,
) -> Refit:
    """Fit friction, effect coefficients and what the rig leaves open by least squares on the training rows.

    Args:
        base: the paper's model.
        effects: adopted effects, each with the values of its shapes.
        data: the log.
        bounds: whether friction coefficients are constrained to be nonnegative. Otherwise the paper's model
            may use them to imitate what it lacks: its best case.
        linear: Coulomb and viscous friction only.
        without: number of a run to leave out; then all other runs are fitted on, held out or not.
    """
    model, rows = base, data.rows
    for effect, own in effects:
        model = effect.extend(model, own)
    if without is not None:
        rows = rows.trained_on((rows.train | rows.score) & (rows.run != without))
    columns = data.signals.columns(base)
    friction = base_coefficients(base, data.signals)[: len(columns)]
    groups = alike(columns) if linear else [(k,) for k in range(len(columns))]
    groups = tuple(tuple(friction[k] for k in group) for group in groups)
    drive = _with_any_inertia(data.drive) if linear else data.drive
    fitted = Extended(model, effects, replace(data, rows=rows, drive=drive), groups, bounds)
    step, change = fitted.fitted(base)
    found, covariance = ({}, np.empty((0, 0))) if without is not None else estimates(fitted, step)
    values = step.point.values
    return Refit(
        fitted.model,
        tuple((e, {q.name: values[q.name] for q in e.parameters}) for e, _ in effects),
        values,
        step.point.scale,
        found,
        covariance,
        dict(step.residuals),
        shares(fitted, step, base) if effects and without is None else {},
        step.target,
        data,
        change,
    )


def _with_any_inertia(drive: Drive) -> Drive:
    """The drive whose open inertia has the range that the rig gives it, as in the baseline of `identify.fit`.

    Otherwise a link that the rig does not know has at least the inertia of its mass: friction without F_N
    would like less, and the rotor, which stands for all of it here, cannot have less than nothing.
    """
    machine, rig = drive.machine, drive.channels.rig
    if not drive.opens("inertia") or not machine.link or machine.link in rig.known:
        return drive
    known = {**drive.known, machine.link: rig.unknown.get(machine.link, (0.0, 0.0))[0]}
    least = rig.known.get(machine.rotor, 0.0)
    opened = tuple(replace(c, lower=least) if c.role == "inertia" else c for c in drive.open)
    return replace(drive, known=known, open=opened)


def residual_samples(fitted: Refit) -> Array:
    """The mechanical residual on the samples (n,) [N m], up to a constant; for fits with bounds."""
    residuals = fitted.data.residuals(fitted.model, fitted.shapes, fitted.values, fitted.scale)
    return residuals.samples("mechanical", fitted.values)
