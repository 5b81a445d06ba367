"""What a fit found, with its uncertainty; and how much of the friction each effect is."""

from __future__ import annotations

import numpy as np

from eccentric.fitting.turns import Solved, Turns
from eccentric.fitting.uncertainty import Estimate, spread
from eccentric.model import Model

__all__ = ["estimates", "shares"]


def estimates(fit: Turns, solved: Solved) -> dict[str, Estimate]:
    """Values with standard errors from one balance; shapes enter by the slope of the residual."""
    drive = fit.data.drive
    every = {s.quantity.name for e, _ in fit.effects for s in e.shapes}
    own = {solved.balance} | ({"electrical"} if drive.by_voltage else set())
    shapes = {s.quantity.name: s for e, _ in fit.effects if e.balance in own for s in e.shapes}
    emitted, current = fit.emitted(), fit.current
    residual = emitted.residual(solved.balance, fit.values, current) if shapes else np.empty(0)
    slopes = []
    for name, shape in shapes.items():
        step = 1e-3 * (shape.high - shape.low if shape.scale == "linear" else fit.values[name])
        moved = fit.values | {name: fit.values[name] + step}
        there = emitted
        if fit.model.states:
            there = fit.emitted(shapes={n: moved[n] for n in every})
        slopes.append((residual - there.residual(solved.balance, moved, current)) / step)
    free = np.full(len(shapes), np.inf)
    low, high = np.r_[solved.low, -free], np.r_[solved.high, free]
    held = np.r_[solved.active, np.zeros(len(shapes), int)]
    full = np.column_stack([solved.design, *slopes])[solved.rows]
    error = spread(full, fit.residuals[solved.balance][solved.rows], held, low, high)
    units = {q.name: q.unit for q in fit.model.parameters}
    unit = np.eye(full.shape[1])
    found: dict[str, Estimate] = {}
    scaled = drive.adjusts == "scale" and "gravity" in solved.names
    shared = unit[solved.names.index("gravity")] if scaled else np.zeros(len(unit))
    for k, name in enumerate([*solved.names, *shapes]):
        if name == "J_m" and drive.rotor is not None:
            gear = fit.values["mu"] ** 2
            slope = (unit[k] - (fit.values["J_l"] * gear + drive.rotor) * shared) / gear
            found["J_l"] = error.estimate(fit.values["J_l"], slope, "kg m^2", (0.0, np.inf))
        elif name in units:
            bounds = (float(low[k]), float(high[k]))
            if name in shapes:
                bounds = (shapes[name].low, shapes[name].high)
            # All torques are divided by the scale, so that its error is theirs too.
            slope = unit[k] if name in shapes else unit[k] - fit.values[name] * shared
            found[name] = error.estimate(fit.values[name], slope, units[name], bounds, int(held[k]))
        else:
            shown, value, factor, of = _outside(name, fit)
            found[shown] = error.estimate(value, factor * unit[k], of)
    return found


def _outside(name: str, fit: Turns) -> tuple[str, float, float, str]:
    """Name, value, factor on the coefficient's error, unit of what the drive is described by."""
    drive, scale = fit.data.drive, fit.scale or 1.0
    if name == "gravity" and drive.adjusts == "scale":
        letters, unit = ("R/k_i", "V/(N m)") if drive.by_voltage else ("1/k_i", "A/(N m)")
        return letters, scale, scale, unit
    if name == "gravity":
        value = fit.values[drive.adjusts]
        return drive.adjusts, value, value, {"L": "m", "M": "kg"}[drive.adjusts]
    if name == "back_emf":
        return "k_e", fit.values["k_e"], scale, "V s/rad"
    if name == "zero_angle":
        return "theta_zero_rad", drive.channels.theta_zero_rad + fit.zero, 1.0, "rad"
    offset = drive.channels.voltage_offset_V + fit.offset
    return "voltage_offset_V", offset, scale, "V"


def shares(fit: Turns, base: Model) -> dict[str, float]:
    """RMS of what each effect adds beside the others, over that of the friction, on training rows."""
    data = fit.data
    rows = data.rows.train
    friction = float(np.sqrt(np.mean(fit.target[rows] ** 2)))
    found = {}
    whole = fit.emitted()
    for effect, _ in fit.effects:
        others = [(e, own) for e, own in fit.effects if e is not effect]
        model = base
        for other, own in others:
            model = other.extend(model, own)
        letters = {q.name for q in model.parameters}
        values = {name: value for name, value in fit.values.items() if name in letters}
        kept = {s.quantity.name: fit.values[s.quantity.name] for e, _ in others for s in e.shapes}
        balance = "mechanical" if data.drive.by_voltage else effect.balance
        without = fit.emitted(model, kept).residual(balance, values)
        torque = (without - whole.residual(balance, fit.values))[rows]
        found[effect.id] = float(np.sqrt(np.mean(torque**2))) / friction
    return found
