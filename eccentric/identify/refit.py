"""Fit a model, extended or not, on its own emitted module: what is scored is what is shipped."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from eccentric.effects.effect import Effect
from eccentric.emit import load_module
from eccentric.identify.adapter import Signals, state_series
from eccentric.identify.channels import Channels
from eccentric.identify.least_squares import bounded
from eccentric.identify.uncertainty import Estimate, spread
from eccentric.model import Model, regressor

__all__ = ["Refit", "linear_friction", "refit"]

Array = np.ndarray
Values = dict[str, float]


@dataclass(frozen=True)
class Refit:
    """A model fitted on the training part.

    Attributes:
        model: the model, extended by `effects`.
        effects: each with the values of all its parameters.
        values: every parameter of the model by name, as the emitted Parameters take it.
        estimates: fitted parameters with uncertainty, by name.
        residuals: balance -> (samples,) on all rows [N m].
        shares: effect id -> RMS of its torque as a fraction of that of the friction, on training rows.
        target: (samples,) what the mechanical friction has to be [N m].
        score_rows: rows of the held-out error.
    """

    model: Model
    effects: tuple[tuple[Effect, Values], ...]
    values: Values
    estimates: dict[str, Estimate]
    residuals: dict[str, Array]
    shares: dict[str, float]
    target: Array
    score_rows: Array

    def held_out(self, balance: str) -> float:
        """Held-out RMSE of a balance [N m]."""
        return float(np.sqrt(np.mean(self.residuals[balance][self.score_rows] ** 2)))


class Emitted:
    """The emitted module of a model on the rows of a log."""

    def __init__(
        self, model: Model, channels: Channels, signals: Signals, shapes: Mapping[str, float]
    ) -> None:
        self.module = load_module(model)
        drive = channels.current if channels.drive == "current" else channels.torque
        given: dict[str, Array | None] = {
            "theta_m": channels.theta_m,
            "omega_m": channels.omega_m,
            "alpha_m": channels.alpha_m,
            "i": drive,
            "u": channels.voltage,
            "temperature": channels.temperature,
            "t": signals.values["t"],
        }
        self.inputs = {name: x for name, x in given.items() if x is not None}
        if model.states:
            self.inputs |= state_series(model, signals, dict(shapes))

    def residual(self, balance: str, values: Mapping[str, float]) -> Array:
        """The emitted residual function of a balance on all rows [N m]."""
        function = getattr(self.module, f"{balance}_residual")
        names = [n for n in inspect.signature(function).parameters if n not in {"parameters", "out"}]
        return function(*(self.inputs[n] for n in names), self.module.Parameters(**values))

    def friction(self, values: Mapping[str, float]) -> Array:
        """The emitted mechanical friction torque on all rows [N m]."""
        function = self.module.mechanical_friction_torque
        names = [n for n in inspect.signature(function).parameters if n not in {"parameters", "out"}]
        return function(*(self.inputs[n] for n in names), self.module.Parameters(**values))


def refit(
    base: Model,
    effects: tuple[tuple[Effect, Values], ...],
    channels: Channels,
    signals: Signals,
    bounds: bool = True,
) -> Refit:
    """Fit friction and effect coefficients by least squares on the training rows.

    Args:
        base: the paper's model.
        effects: adopted effects, each with the values of its shapes.
        channels: rows, raw drive signals.
        signals: smooth signals and known parameters; hidden states run on them.
        bounds: whether friction coefficients are kept from being negative. Without, the paper's model may use
            them to imitate what it lacks: its best case.
    """
    shapes = {name: value for _, own in effects for name, value in own.items()}
    model = base
    for effect, own in effects:
        model = effect.extend(model, own)
    emitted = Emitted(model, channels, signals, shapes)
    own_letters = {q.name for q in model.parameters}
    friction = _friction_letters(base)
    values = {name: value for name, value in signals.known.items() if name in own_letters}
    values |= dict.fromkeys(_all_friction(base), 0.0) | shapes
    coefficients = {q.name: 0.0 for effect, _ in effects for q in effect.coefficients}
    values |= coefficients
    has_electrical = "u" in emitted.inputs and channels.drive == "current"
    solved: list[_Solved] = []
    if has_electrical:
        names, limits = _coefficients(effects, "electrical")
        if names:
            rows = ~channels.held_out & channels.usable
            solved.append(_solve(emitted, "electrical", values, names, limits, rows, bounds))
            values |= solved[-1].values
    names, limits = _coefficients(effects, "mechanical")
    names, limits = [*friction, *names], [(0.0, None)] * len(friction) + limits
    solved.append(_solve(emitted, "mechanical", values, names, limits, channels.fit_rows, bounds))
    found, design = solved[-1].values, solved[-1].design
    # By its columns, since Parameters refuse what is negative without bounds.
    residuals = {"mechanical": emitted.residual("mechanical", values) - design @ [found[n] for n in names]}
    values |= found
    if has_electrical:
        allowed = {n: max(x, 0.0) if n in friction else x for n, x in values.items()}
        residuals["electrical"] = emitted.residual("electrical", allowed)
    target = residuals["mechanical"] + design[:, : len(friction)] @ [found[n] for n in friction]
    fitted = Refit(model, effects, values, {}, residuals, {}, target, channels.score_rows)
    if not effects:
        return fitted
    estimates: dict[str, Estimate] = {}
    for one in solved:
        estimates |= _estimates(fitted, emitted, one, channels, signals)
    return replace(
        fitted,
        effects=tuple((e, {q.name: values[q.name] for q in e.parameters}) for e, _ in effects),
        estimates=estimates,
        shares=_shares(fitted, base, channels, signals),
    )


def linear_friction(paper: Refit, channels: Channels) -> float:
    """Held-out RMSE of Coulomb and viscous friction alone, fitted on the same training rows [N m]."""
    omega = channels.omega_m
    design = np.column_stack([omega, np.sign(omega)])
    rows = channels.fit_rows
    found = np.linalg.lstsq(design[rows], paper.target[rows], rcond=None)[0]
    rest = (paper.target - design @ found)[channels.score_rows]
    return float(np.sqrt(np.mean(rest**2)))


def _friction_letters(base: Model) -> list[str]:
    """One parameter for each column of the regressor: B_m stands for the sum B, C_m for C."""
    letters = {q.name for q in base.parameters}
    names = []
    for column in regressor(base):
        head, *tail = column.name.split("_")
        names.append(column.name if column.name in letters else "_".join([head, "m", *tail]))
    return names


def _all_friction(base: Model) -> list[str]:
    used = {str(t.coefficient) for t in base.balance("mechanical").terms if t.kind == "friction"}
    return [q.name for q in base.parameters if q.name in used]


Limits = list[tuple[float | None, float | None]]


def _coefficients(effects: tuple[tuple[Effect, Values], ...], balance: str) -> tuple[list[str], Limits]:
    """Names and bounds of the coefficients of the effects that a balance shows."""
    own = [effect for effect, _ in effects if effect.balance == balance]
    names = [q.name for effect in own for q in effect.coefficients]
    return names, [limit for effect in own for limit in effect.bounds]


@dataclass(frozen=True)
class _Solved:
    """A balance solved for its linear parameters."""

    balance: str
    values: Values
    low: Array
    high: Array
    active: Array
    design: Array
    rows: Array


def _solve(
    emitted: Emitted,
    balance: str,
    values: Values,
    names: list[str],
    limits: Limits,
    rows: Array,
    bounds: bool,
) -> _Solved:
    """The residual is linear in these parameters: unit steps of the emitted function give its columns."""
    rest = emitted.residual(balance, values)
    design = np.column_stack([rest - emitted.residual(balance, {**values, name: 1.0}) for name in names])
    low = np.array([-np.inf if a is None or not bounds else a for a, _ in limits])
    high = np.array([np.inf if b is None or not bounds else b for _, b in limits])
    found = bounded(design[rows], rest[rows], low, high)
    own = dict(zip(names, map(float, found.coefficients), strict=True))
    return _Solved(balance, own, low, high, found.active, design, rows)


def _estimates(
    fitted: Refit, emitted: Emitted, solved: _Solved, channels: Channels, signals: Signals
) -> dict[str, Estimate]:
    """Values with standard errors from one balance; shapes enter by the slope of the residual."""
    every = {s.quantity.name for e, _ in fitted.effects for s in e.shapes}
    shapes = {s.quantity.name: s for e, _ in fitted.effects if e.balance == solved.balance for s in e.shapes}
    residual = fitted.residuals[solved.balance]
    slopes = []
    for name, shape in shapes.items():
        step = 1e-3 * (shape.high - shape.low if shape.scale == "linear" else fitted.values[name])
        moved = fitted.values | {name: fitted.values[name] + step}
        there = emitted
        if fitted.model.states:
            there = Emitted(fitted.model, channels, signals, {n: moved[n] for n in every})
        slopes.append((residual - there.residual(solved.balance, moved)) / step)
    free = np.full(len(shapes), np.inf)
    low, high = np.r_[solved.low, -free], np.r_[solved.high, free]
    held = np.r_[solved.active, np.zeros(len(shapes), int)]
    full = np.column_stack([solved.design, *slopes])[solved.rows]
    error = spread(full, residual[solved.rows], held, low, high)
    units = {q.name: q.unit for q in fitted.model.parameters}
    unit = np.eye(full.shape[1])
    return {
        name: error.estimate(
            fitted.values[name], unit[k], units[name], (float(low[k]), float(high[k])), int(held[k])
        )
        for k, name in enumerate([*solved.values, *shapes])
    }


def _shares(fitted: Refit, base: Model, channels: Channels, signals: Signals) -> dict[str, float]:
    """RMS of what each effect adds beside the others, over that of the friction, on training rows."""
    rows = channels.fit_rows
    friction = float(np.sqrt(np.mean((fitted.target[rows]) ** 2)))
    shares = {}
    for effect, _ in fitted.effects:
        others = [(e, own) for e, own in fitted.effects if e is not effect]
        model = base
        for other, own in others:
            model = other.extend(model, own)
        letters = {q.name for q in model.parameters}
        values = {name: value for name, value in fitted.values.items() if name in letters}
        shapes = {s.quantity.name: fitted.values[s.quantity.name] for e, _ in others for s in e.shapes}
        without = Emitted(model, channels, signals, shapes).residual(effect.balance, values)
        torque = (without - fitted.residuals[effect.balance])[rows]
        shares[effect.id] = float(np.sqrt(np.mean(torque**2))) / friction
    return shares
