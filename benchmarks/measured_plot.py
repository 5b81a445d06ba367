"""Shared by the pictures: colours that colour-blind readers can distinguish, friction as measured, means in bins."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from eccentric.diagnosis import Diagnosis
from eccentric.identification import Refit

Array = np.ndarray

BEFORE, AFTER, INK, PALE = "#c04f00", "#0672b0", "#333333", "#8a8a8a"
STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "eccentric",
    "font.size": 9,
    "axes.titlesize": 9,
    "text.color": INK,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "legend.fontsize": 8,
}


def friction(fit: Refit) -> Array:
    """Friction as measured (rows,) [N m at the scale of the fit]: drive torque less inertia, gravity and load."""
    data, values = fit.data, fit.values
    drive, c = data.drive, data.drive.channels
    torque = drive.torque(values, fit.scale)
    if "voltage_offset_V" in fit.estimates:
        shift = fit.estimates["voltage_offset_V"].value - c.alignment.voltage_offset_V
        torque = torque - np.where(c.motor.off, 0.0, shift / (fit.scale or 1.0))
    gravity = data.gravity
    if drive.adjusts in drive.known:
        gravity = gravity * values[drive.adjusts] / drive.known[drive.adjusts]
    if "theta_zero_rad" in fit.estimates:
        shift = fit.estimates["theta_zero_rad"].value - c.alignment.theta_zero_rad
        gravity = gravity + shift * next(x for c, x in data.signals.open.items() if c.role == "zero_angle")
    inertia = values["J_m"] + values["mu"] ** 2 * values["J_l"]
    return data.rows.mean(torque - inertia * c.motion.alpha_m - gravity)


def pair(found: Diagnosis, before: str = "paper") -> list[tuple[Refit, str, str, str]]:
    """Fits before and after, with label, colour and line; one where nothing was adopted."""
    pairs = [(found.models.paper, before, BEFORE, "--")]
    if found.models.adopted:
        pairs.append((found.models.extended, "extended", AFTER, "-"))
    return pairs


def over_speed(axes: Axes, speed: Array, measured: Array, left: Array, edges: Array) -> None:
    """Friction as measured over the speed and as fitted, on the same rows: means in bins, by direction."""
    for sign, labels in ((1.0, ("measured: mean, 10 to 90 %", "Coulomb + viscous")), (-1.0, (None, None))):
        own = np.sign(speed) == sign
        band(axes, speed[own], measured[own], edges, labels[0], AFTER, "none")
        at, mean = means(speed[own], (measured - left)[own], edges)
        axes.plot(at, mean, "--", color=BEFORE, label=labels[1], linewidth=1.5)
    axes.legend(loc="upper left")


def means(x: Array, y: Array, edges: Array) -> tuple[Array, Array]:
    """Means of x and y in bins of x with at least five rows."""
    place = np.digitize(x, edges)
    kept = [k for k in range(1, len(edges)) if np.count_nonzero(place == k) >= 5]
    at, mean = np.array([(x[place == k].mean(), y[place == k].mean()) for k in kept]).T
    return at, mean


def band(axes: Axes, x: Array, y: Array, edges: Array, label: str | None, colour: str, line: str) -> None:
    """Means of y in bins of x with at least five rows, and the range of 10 to 90 % of the rows."""
    place = np.digitize(x, edges)
    kept = [k for k in range(1, len(edges)) if np.count_nonzero(place == k) >= 5]
    at = [x[place == k].mean() for k in kept]
    low, high = np.array([np.quantile(y[place == k], [0.1, 0.9]) for k in kept]).T
    axes.fill_between(at, low, high, color=colour, alpha=0.18, linewidth=0)
    axes.plot(*means(x, y, edges), linestyle=line, color=colour, marker="o", markersize=3, label=label)
