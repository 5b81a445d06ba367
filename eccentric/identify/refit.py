"""Fit a model, extended or not, on its own emitted module: what is scored is what is shipped.

The residual of the mechanical balance is linear in friction, in the coefficients of effects and in what the
rig leaves open; only the scale of the drive is not.  A free column of gravity finds it: where the fit wants
1 + g times the gravity torque, the scale (or the unknown arm) was too small by that factor, and the fit is
repeated with the better one until g vanishes.

Where one signal alone measures the drive, effects on the current take the one that the model asks for,
(torque - residual)/k_i of the turn before: with the measured one the drive would explain itself.
"""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from eccentric.effects.effect import Effect
from eccentric.emit import load_module
from eccentric.identify.adapter import Signals, state_series
from eccentric.identify.drive import Drive
from eccentric.identify.least_squares import bounded
from eccentric.identify.rows import Rows
from eccentric.identify.uncertainty import Estimate, spread
from eccentric.model import Model

__all__ = ["Bench", "Refit", "refit", "residual_samples"]

Array = np.ndarray
Values = dict[str, float]
_TURNS = 8
_SETTLED = 1e-9


@dataclass(frozen=True)
class Bench:
    """A log as models are fitted on it: drive, smooth signals, rows; gravity torque (samples,) [N m]."""

    drive: Drive
    signals: Signals
    rows: Rows
    gravity: Array


@dataclass(frozen=True)
class Refit:
    """A model fitted on the training part.

    Attributes:
        model: the model, extended by `effects`.
        effects: each with the values of all its parameters.
        values: every parameter of the model by name, as the emitted Parameters take it.
        scale: of the drive, V/(N m) or A/(N m); None where the torque is measured.
        estimates: fitted parameters with uncertainty, by name.
        residuals: balance -> (rows,) [N m at this fit's own scale].
        shares: effect id -> RMS of its torque as a fraction of that of the friction, on training rows.
        target: (rows,) what the mechanical friction, effects included, has to be [N m].
        bench: what it was fitted on.
    """

    model: Model
    effects: tuple[tuple[Effect, Values], ...]
    values: Values
    scale: float | None
    estimates: dict[str, Estimate]
    residuals: dict[str, Array]
    shares: dict[str, float]
    target: Array
    bench: Bench

    def held_out(self, balance: str, per: float = 1.0) -> float:
        """Held-out RMSE of a balance [N m], divided by `per`."""
        rows = self.bench.rows.score
        return float(np.sqrt(np.mean(self.residuals[balance][rows] ** 2))) / per


class Emitted:
    """The emitted module of a model on the samples of a log, for given values of what is searched."""

    def __init__(
        self, model: Model, bench: Bench, shapes: Mapping[str, float], known: Values, scale: float | None
    ) -> None:
        self.module, self.bench = load_module(model), bench
        self.drive, signals, channels = bench.drive, bench.signals, bench.drive.channels
        torque = self.drive.torque(known, scale)
        given: dict[str, Array | None] = {
            "theta_m": channels.theta_m,
            "omega_m": channels.omega_m,
            "alpha_m": channels.alpha_m,
            "i": torque / known["k_i"],
            "u": self.drive.signal() if self.drive.by_voltage else channels.voltage,
            "temperature": channels.temperature,
            "t": signals.values["t"],
        }
        self.inputs = {name: x for name, x in given.items() if x is not None}
        if model.states:
            self.inputs |= state_series(model, signals, dict(shapes))

    def residual(self, balance: str, values: Mapping[str, float], current: Array | None = None) -> Array:
        """The emitted residual of a balance on the rows [N m], with another current if given."""
        rows, found = self.bench.rows, self.samples(balance, values, current)
        if balance != "mechanical" or rows.smooth is None:
            return rows.mean(found)
        # The acceleration comes from the low-passed angle: it is not to pass the filter twice.
        alpha = self.drive.channels.alpha_m
        inertia = values["J_m"] + self.bench.signals.known["mu"] ** 2 * values["J_l"]
        return rows.mean(found) + inertia * (rows.mean(alpha) - rows.filtered(alpha))

    def samples(self, balance: str, values: Mapping[str, float], current: Array | None = None) -> Array:
        """The same on the samples.

        Where voltage alone drives, the two balances are one: i is the torque that the voltage leaves, so that
        the electrical residual holds nothing but the effects of the armature.
        """
        inputs = self.inputs if current is None else self.inputs | {"i": current}
        found = self._call(f"{balance}_residual", values, inputs)
        if balance == "mechanical" and self.drive.by_voltage:
            found = found + np.where(self.drive.off, 0.0, self._call("electrical_residual", values, inputs))
        return found

    def _call(self, name: str, values: Mapping[str, float], inputs: Mapping[str, Array]) -> Array:
        function = getattr(self.module, name)
        names = [n for n in inspect.signature(function).parameters if n not in {"parameters", "out"}]
        return function(*(inputs[n] for n in names), self.module.Parameters(**values))


def refit(
    base: Model,
    effects: tuple[tuple[Effect, Values], ...],
    bench: Bench,
    bounds: bool = True,
    linear: bool = False,
    without: int | None = None,
) -> Refit:
    """Fit friction, effect coefficients and what the rig leaves open by least squares on the training rows.

    Args:
        base: the paper's model.
        effects: adopted effects, each with the values of its shapes.
        bench: the log.
        bounds: whether friction coefficients are kept from being negative. Without, the paper's model may use
            them to imitate what it lacks: its best case.
        linear: Coulomb and viscous friction only.
        without: number of a run to leave out; then all other runs are fitted on, held out or not.
    """
    shapes = {name: value for _, own in effects for name, value in own.items()}
    model = base
    for effect, own in effects:
        model = effect.extend(model, own)
    one = _Fit(base, model, effects, bench, shapes, bounds, linear, without)
    one.run()
    fitted = Refit(
        model, effects, one.values, one.scale, {}, one.residuals, {}, one.residuals["mechanical"], bench
    )
    fitted = replace(fitted, target=one.residuals["mechanical"] + one.friction)
    if without is not None:
        return fitted
    estimates: dict[str, Estimate] = {}
    for solved in one.solved:
        estimates |= _estimates(fitted, one, solved)
    return replace(
        fitted,
        effects=tuple((e, {q.name: one.values[q.name] for q in e.parameters}) for e, _ in effects),
        estimates=estimates,
        shares=_shares(fitted, base, bench) if effects else {},
    )


def residual_samples(fitted: Refit) -> Array:
    """The mechanical residual on the samples (n,) [N m], up to a constant; for fits within the bounds."""
    shapes = {s.quantity.name: fitted.values[s.quantity.name] for e, _ in fitted.effects for s in e.shapes}
    emitted = Emitted(fitted.model, fitted.bench, shapes, fitted.values, fitted.scale)
    return emitted.samples("mechanical", fitted.values)


Limits = list[tuple[float | None, float | None]]


@dataclass(frozen=True)
class _Solved:
    """A balance solved for its linear unknowns."""

    balance: str
    names: tuple[str, ...]
    coefficients: Array
    low: Array
    high: Array
    active: Array
    design: Array
    rows: Array


class _Fit:
    """The turns of one fit; `values` and `scale` are what it has found so far."""

    def __init__(
        self,
        base: Model,
        model: Model,
        effects: tuple[tuple[Effect, Values], ...],
        bench: Bench,
        shapes: Values,
        bounds: bool,
        linear: bool,
        without: int | None,
    ) -> None:
        self.model, self.effects, self.bench, self.shapes, self.bounds = model, effects, bench, shapes, bounds
        drive, letters = bench.drive, {q.name for q in model.parameters}
        self.scale = drive.scale
        self.every = _friction_letters(base, bench.signals)
        self.fitted = [n for n in self.every if n[0] in "BC" and not (linear and "_lN" in n)]
        self.values = {name: value for name, value in drive.known.items() if name in letters}
        # What the log cannot show has no effect on it, but the module wants a number.
        absent = {"R": 1.0, "k_e": 0.0, "J_m": 0.0, "J_l": 0.0}
        self.values = {n: v for n, v in absent.items() if n in letters} | self.values
        self._scaled()
        self.values |= dict.fromkeys(_all_friction(base), 0.0) | shapes
        self.values |= {q.name: 0.0 for effect, _ in effects for q in effect.coefficients}
        self.offset = self.zero = 0.0
        self.current: Array | None = None
        used = bench.rows.train | bench.rows.score
        self.train = bench.rows.train if without is None else used & (bench.rows.run != without)
        self.solved: list[_Solved] = []
        self.residuals: dict[str, Array] = {}
        self.friction = np.empty(0)

    def run(self) -> None:
        """Turn until the scale has settled."""
        current = not self.bench.drive.measured_twice and bool(self.effects)
        turns = _TURNS if "gravity" in self.bench.drive.open or current else 1
        for turn in range(turns):
            if current:
                self.current = self.bench.signals.values["i"] if turn == 0 else self._model_current()
            change = self._turn()
            if abs(change) < _SETTLED and not current:
                return

    def _model_current(self) -> Array:
        """The current (samples,) that the model of the last turn asks for [A at the scale of the fit]."""
        emitted = self.emitted()
        quiet = self.values | {q.name: 0.0 for effect, _ in self.effects for q in effect.coefficients}
        effect = emitted.samples("mechanical", self.values, self.current)
        effect = effect - emitted.samples("mechanical", quiet, self.current)
        columns = self.bench.signals.open
        offset = columns["offset"] * self.offset / (self.scale or 1.0) if "offset" in columns else 0.0
        rest = emitted.samples("mechanical", quiet) + effect - offset
        return emitted.inputs["i"] - rest / self.values["k_i"]

    def emitted(self, model: Model | None = None, shapes: Mapping[str, float] | None = None) -> Emitted:
        """The module of a model under the present values."""
        given = self.shapes if shapes is None else shapes
        return Emitted(model or self.model, self.bench, given, self.values, self.scale)

    def _turn(self) -> float:
        """Solve, put the solution into the values, return what the free gravity column still wants."""
        drive, emitted = self.bench.drive, self.emitted()
        self.solved = []
        if drive.measured_twice:
            names, limits = _coefficients(self.effects, "electrical")
            rows = self.bench.rows.train & self._usable()
            if names:
                self.solved.append(self._solve(emitted, "electrical", names, limits, {}, rows)[0])
                self._take(self.solved[-1])
            both = True
        else:
            both = False
        names, limits = _coefficients(self.effects, "mechanical")
        count = len(self.fitted) + len(names)
        if drive.by_voltage:
            more = _coefficients(self.effects, "electrical")
            names, limits = names + more[0], limits + more[1]
        letters = [n for n in drive.open if n in ("J_m", "T_load")]
        names = [*self.fitted, *names, *letters]
        limits = [(0.0, None)] * len(self.fitted) + limits
        limits += [(0.0 if n == "J_m" else None, None) for n in letters]
        rows, columns = self.bench.rows, self.bench.signals.open
        outside = {n: rows.mean(-x) for n, x in columns.items() if n not in letters}
        solved, rest = self._solve(emitted, "mechanical", names, limits, outside, self.train)
        # By its columns, since Parameters refuse what is negative without bounds.
        self.residuals = {"mechanical": rest - solved.design @ solved.coefficients}
        self.friction = solved.design[:, :count] @ solved.coefficients[:count]
        self.solved.append(solved)
        change = self._take(solved)
        if both:
            allowed = {n: max(x, 0.0) if n in self.every else x for n, x in self.values.items()}
            self.residuals["electrical"] = emitted.residual("electrical", allowed)
        return change

    def _usable(self) -> Array:
        return self.bench.rows.mean(self.bench.drive.channels.usable.astype(float)) > 0.5

    def _solve(
        self,
        emitted: Emitted,
        balance: str,
        names: list[str],
        limits: Limits,
        outside: dict[str, Array],
        rows: Array,
    ) -> tuple[_Solved, Array]:
        """Solve a balance on these rows; and its residual (rows,) with all the unknowns at zero.

        It is linear in them: unit steps of the emitted function give its columns.
        """
        start = self.values | dict.fromkeys(names, 0.0)
        rest = emitted.residual(balance, start)
        there = rest if self.current is None else emitted.residual(balance, start, self.current)
        steps = [there - emitted.residual(balance, {**start, n: 1.0}, self.current) for n in names]
        # What is outside the module: gravity, back-EMF and offset, against the drive.
        steps += [-column for column in outside.values()]
        limits = limits + [(None, None)] * len(outside)
        design = np.column_stack(steps)
        # An inertia is never negative, whatever a friction coefficient has to imitate.
        kept = [self.bounds or name == "J_m" for name in (*names, *outside)]
        low = np.array([-np.inf if a is None or not k else a for (a, _), k in zip(limits, kept, strict=True)])
        high = np.array([np.inf if b is None or not k else b for (_, b), k in zip(limits, kept, strict=True)])
        found = bounded(design[rows], rest[rows], low, high)
        held = np.where(found.active < 0, low, np.where(found.active > 0, high, found.coefficients))
        solved = _Solved(balance, (*names, *outside), held, low, high, found.active, design, rows)
        return solved, rest

    def _take(self, solved: _Solved) -> float:
        """Put a solution into the values; what is outside the module changes scale, back-EMF and offset."""
        found = dict(zip(solved.names, map(float, solved.coefficients), strict=True))
        gravity = found.pop("gravity", 0.0)
        emf, offset = found.pop("back_emf", 0.0), found.pop("offset", 0.0)
        self.zero = found.pop("zero_angle", 0.0)
        adjusts = self.bench.drive.adjusts
        scale = self.scale or 1.0
        if emf:
            self.values["k_e"] += emf * scale
        self.offset = offset * scale
        # All of a scaled solution is too large by the same factor.
        factor = 1.0 + gravity if adjusts == "scale" else 1.0
        self.values |= {n: x / factor for n, x in found.items()}
        if (rotor := self.bench.drive.rotor) is not None and "J_m" in found:
            # The column is that of all inertia; what is beyond the known rotor is the link's.
            link = self.values["J_l"] + (self.values["J_m"] - rotor) / self.values["mu"] ** 2
            self.values |= {"J_m": rotor, "J_l": max(link, 0.0)}
        if adjusts == "scale" and self.scale is not None:
            self.scale *= factor
            self._scaled()
        elif gravity:
            self.values[adjusts] *= 1.0 + gravity
        return gravity

    def _scaled(self) -> None:
        """Write the scale as the letters that it stands for."""
        if self.scale is not None and self.bench.drive.by_voltage:
            self.values |= {"k_i": 1.0, "R": self.scale}
        elif self.scale is not None:
            self.values["k_i"] = 1.0 / self.scale


def _friction_letters(base: Model, signals: Signals) -> list[str]:
    """One parameter for each column of the regressor: B_m stands for the sum B, C_m for C."""
    letters = {q.name for q in base.parameters}
    names = []
    for column in signals.columns(base):
        head, *tail = column.name.split("_")
        names.append(column.name if column.name in letters else "_".join([head, "m", *tail]))
    return names


def _all_friction(base: Model) -> list[str]:
    used = {str(t.coefficient) for t in base.balance("mechanical").terms if t.kind == "friction"}
    return [q.name for q in base.parameters if q.name in used]


def _coefficients(effects: tuple[tuple[Effect, Values], ...], balance: str) -> tuple[list[str], Limits]:
    """Names and bounds of the coefficients of the effects that a balance shows."""
    own = [effect for effect, _ in effects if effect.balance == balance]
    names = [q.name for effect in own for q in effect.coefficients]
    return names, [limit for effect in own for limit in effect.bounds]


def _estimates(fitted: Refit, fit: _Fit, solved: _Solved) -> dict[str, Estimate]:
    """Values with standard errors from one balance; shapes enter by the slope of the residual."""
    drive = fitted.bench.drive
    every = {s.quantity.name for e, _ in fitted.effects for s in e.shapes}
    own = {solved.balance} | ({"electrical"} if drive.by_voltage else set())
    shapes = {s.quantity.name: s for e, _ in fitted.effects if e.balance in own for s in e.shapes}
    emitted, current = fit.emitted(), fit.current
    residual = emitted.residual(solved.balance, fitted.values, current) if shapes else np.empty(0)
    slopes = []
    for name, shape in shapes.items():
        step = 1e-3 * (shape.high - shape.low if shape.scale == "linear" else fitted.values[name])
        moved = fitted.values | {name: fitted.values[name] + step}
        there = emitted
        if fitted.model.states:
            there = fit.emitted(shapes={n: moved[n] for n in every})
        slopes.append((residual - there.residual(solved.balance, moved, current)) / step)
    free = np.full(len(shapes), np.inf)
    low, high = np.r_[solved.low, -free], np.r_[solved.high, free]
    held = np.r_[solved.active, np.zeros(len(shapes), int)]
    full = np.column_stack([solved.design, *slopes])[solved.rows]
    error = spread(full, fitted.residuals[solved.balance][solved.rows], held, low, high)
    units = {q.name: q.unit for q in fitted.model.parameters}
    unit = np.eye(full.shape[1])
    found: dict[str, Estimate] = {}
    scaled = drive.adjusts == "scale" and "gravity" in solved.names
    shared = unit[solved.names.index("gravity")] if scaled else np.zeros(len(unit))
    for k, name in enumerate([*solved.names, *shapes]):
        if name == "J_m" and drive.rotor is not None:
            gear = fitted.values["mu"] ** 2
            slope = (unit[k] - (fitted.values["J_l"] * gear + drive.rotor) * shared) / gear
            found["J_l"] = error.estimate(fitted.values["J_l"], slope, "kg m^2", (0.0, np.inf))
        elif name in units:
            bounds = (float(low[k]), float(high[k]))
            if name in shapes:
                bounds = (shapes[name].low, shapes[name].high)
            # All torques are divided by the scale, so that its error is theirs too.
            slope = unit[k] if name in shapes else unit[k] - fitted.values[name] * shared
            found[name] = error.estimate(fitted.values[name], slope, units[name], bounds, int(held[k]))
        else:
            shown, value, factor, of = _outside(name, fitted, fit)
            found[shown] = error.estimate(value, factor * unit[k], of)
    return found


def _outside(name: str, fitted: Refit, fit: _Fit) -> tuple[str, float, float, str]:
    """Name, value, factor on the coefficient's error, unit of what the drive is described by."""
    drive, scale = fitted.bench.drive, fitted.scale or 1.0
    if name == "gravity" and drive.adjusts == "scale":
        letters, unit = ("R/k_i", "V/(N m)") if drive.by_voltage else ("1/k_i", "A/(N m)")
        return letters, scale, scale, unit
    if name == "gravity":
        value = fitted.values[drive.adjusts]
        return drive.adjusts, value, value, {"L": "m", "M": "kg"}[drive.adjusts]
    if name == "back_emf":
        return "k_e", fitted.values["k_e"], scale, "V s/rad"
    if name == "zero_angle":
        return "theta_zero", drive.channels.theta_zero_rad + fit.zero, 1.0, "rad"
    offset = drive.channels.voltage_offset_V + fit.offset
    return "voltage_offset", offset, scale, "V"


def _shares(fitted: Refit, base: Model, bench: Bench) -> dict[str, float]:
    """RMS of what each effect adds beside the others, over that of the friction, on training rows."""
    rows = bench.rows.train
    friction = float(np.sqrt(np.mean((fitted.target[rows]) ** 2)))
    shares = {}
    shapes = {s.quantity.name: fitted.values[s.quantity.name] for e, _ in fitted.effects for s in e.shapes}
    whole = Emitted(fitted.model, bench, shapes, fitted.values, fitted.scale)
    for effect, _ in fitted.effects:
        others = [(e, own) for e, own in fitted.effects if e is not effect]
        model = base
        for other, own in others:
            model = other.extend(model, own)
        letters = {q.name for q in model.parameters}
        values = {name: value for name, value in fitted.values.items() if name in letters}
        kept = {s.quantity.name: fitted.values[s.quantity.name] for e, _ in others for s in e.shapes}
        balance = "mechanical" if bench.drive.by_voltage else effect.balance
        without = Emitted(model, bench, kept, fitted.values, fitted.scale).residual(balance, values)
        torque = (without - whole.residual(balance, fitted.values))[rows]
        shares[effect.id] = float(np.sqrt(np.mean(torque**2))) / friction
    return shares
