"""The figure of a fit: measured against predicted friction, and both over speed, on the held-out rows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eccentric.identification import MOST_POINTS
from eccentric.model import model_names

if TYPE_CHECKING:
    from eccentric.identification import Fit


Array = NDArray[np.float64]

NEEDS_MATPLOTLIB = "matplotlib is required for the figure (extra `figures`): pip install matplotlib"
# As in the report of a diagnosis: the colours of Okabe and Ito.
_MEASURED, _LINEAR, _PAPER = "#8a8a8a", "#cc79a7", "#d55e00"


@dataclass(frozen=True)
class Comparison:
    """Measured and predicted friction on held-out rows, at most `MOST_POINTS` of them.

    Attributes:
        speed: of the motor [rad/s], of a carriage [m/s] (n,).
        measured: (n,) in `unit`.
        paper, linear: predicted by the fitted model and by Coulomb + viscous friction, (n,) in `unit`.
        rmse: model ("paper", "linear") -> held-out RMSE in `unit`.
        model: what the fitted model is called in a legend.
        quantity: what is compared, for an axis.
        unit: "N m", "V" or "A".
        title: rig, and what a row is.
        velocity: what `speed` is, for an axis.
    """

    speed: Array
    measured: Array
    paper: Array
    linear: Array
    rmse: Mapping[str, float]
    model: str
    quantity: str
    unit: str
    title: str
    velocity: str


def compare(fit: Fit) -> Comparison:
    """Return the data of the figure of a fit."""
    problem = fit.problem
    paper, linear = fit.solutions["paper"], fit.solutions["linear"]
    rows = np.flatnonzero(problem.rows.score)
    rows = rows[:: -(-len(rows) // MOST_POINTS)]
    friction = [k for k, c in enumerate(problem.coefficients) if c.role == "friction"]
    axis = problem.rig.axis
    predicted = paper.design.columns[rows][:, friction] @ paper.values[friction]
    measured = predicted + paper.residual[rows]
    return Comparison(
        speed=problem.rows.mean(problem.drive.channels.motion.omega_m)[rows],
        measured=measured,
        paper=predicted,
        linear=measured - linear.residual[rows],
        rmse={name: fit.rmse[name] for name in ("paper", "linear")},
        model="paper's model" if problem.model.name in model_names() else problem.model.name,
        quantity="friction" if problem.unit == "N m" else "friction (and back-EMF)",
        unit=axis.said(problem.unit),
        title=f"{problem.rig.name}: held-out {problem.rows.description}",
        velocity=axis.said("motor velocity [rad/s]"),
    )


def plot_fit(shown: Comparison, left: Any, right: Any) -> None:
    """Draw measured against predicted friction on the left axes, both over the speed on the right ones."""
    name, unit = shown.quantity, shown.unit
    both = np.concatenate([shown.measured, shown.paper, shown.linear])
    ends = [float(both.min()), float(both.max())]
    style = {"linestyle": "none", "marker": ".", "rasterized": True}
    # The linear model is drawn on top, in smaller dots: its few values would be hidden by the paper's.
    models = (
        (shown.paper, _PAPER, "paper", shown.model, 3.0),
        (shown.linear, _LINEAR, "linear", "Coulomb + viscous", 1.5),
    )
    right.plot(shown.speed, shown.measured, color=_MEASURED, label="measured", markersize=3.0, **style)
    for values, color, which, called, size in models:
        label = f"{called}: RMSE {shown.rmse[which]:.3g} {unit}"
        left.plot(values, shown.measured, color=color, label=label, markersize=size, **style)
        right.plot(shown.speed, values, color=color, label=called, markersize=size, **style)
    left.plot(ends, ends, color="black", linewidth=0.8)
    left.set(xlabel=f"predicted {name} [{unit}]", ylabel=f"measured {name} [{unit}]")
    right.set(xlabel=shown.velocity, ylabel=f"{name} [{unit}]")
    for axes in (left, right):
        axes.grid(linewidth=0.3)
        # Above the axes, where it never covers a dot.
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False, handletextpad=0.2)
        for handle in axes.get_legend().legend_handles:
            handle.set_markersize(10.0)
    left.figure.suptitle(shown.title, fontsize=9.0)
