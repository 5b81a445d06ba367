"""The figure of a fit: measured friction against predicted, and over speed, on the held-out rows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eccentric.errors import InputError

if TYPE_CHECKING:
    from pathlib import Path

    from eccentric.fitting.identify import Fit

MOST_POINTS = 4000
_MEASURED, _LINEAR, _PAPER = "0.55", "tab:orange", "tab:blue"


def draw_fit(fit: Fit, stem: Path) -> None:
    """Write `stem`.png and `stem`.svg. Raises InputError without matplotlib (extra `figures`)."""
    try:
        from matplotlib import rc_context
        from matplotlib.figure import Figure
    except ImportError:
        raise InputError(
            "matplotlib is required for the figure (extra `figures`): pip install matplotlib"
        ) from None
    # A fixed salt and no date: the same fit gives the same file.
    with rc_context({"svg.hashsalt": "eccentric", "font.size": 9.0}):
        figure = Figure(figsize=(9.0, 4.2), layout="constrained")
        left, right = figure.subplots(1, 2)
        _panels(fit, left, right)
        for suffix in (".png", ".svg"):
            metadata = {"Date": None} if suffix == ".svg" else {}
            figure.savefig(stem.with_suffix(suffix), dpi=150, metadata=metadata)


def _panels(fit: Fit, left: Any, right: Any) -> None:
    problem = fit.problem
    paper, linear = fit.solutions["paper"], fit.solutions["linear"]
    rows = np.flatnonzero(problem.rows.score)
    rows = rows[:: -(-len(rows) // MOST_POINTS)]
    friction = [k for k, c in enumerate(problem.coefficients) if c.role == "friction"]
    predicted = paper.design.columns[rows][:, friction] @ paper.values[friction]
    measured = predicted + paper.residual[rows]
    by_linear = measured - linear.residual[rows]
    speed = problem.rows.mean(problem.channels.omega_m)[rows]
    name = "friction" if problem.unit == "N m" else "friction (and back-EMF)"
    both = np.concatenate([measured, predicted, by_linear])
    ends = [float(both.min()), float(both.max())]
    style = {"linestyle": "none", "marker": ".", "rasterized": True}
    # The linear model goes on top, in smaller dots: its few values would vanish under the paper's.
    models = ((predicted, _PAPER, "paper", 3.0), (by_linear, _LINEAR, "linear", 1.5))
    right.plot(speed, measured, color=_MEASURED, label="measured", markersize=3.0, **style)
    for values, color, which, size in models:
        label = f"{which}: RMSE {fit.rmse[which]:.3g} {problem.unit}"
        left.plot(values, measured, color=color, label=label, markersize=size, **style)
        label = {"paper": problem.model.name, "linear": "Coulomb + viscous"}[which]
        right.plot(speed, values, color=color, label=label, markersize=size, **style)
    left.plot(ends, ends, color="black", linewidth=0.8)
    left.set(xlabel=f"predicted {name} [{problem.unit}]", ylabel=f"measured {name} [{problem.unit}]")
    right.set(xlabel="motor velocity [rad/s]", ylabel=f"{name} [{problem.unit}]")
    for axes in (left, right):
        axes.grid(linewidth=0.3)
        # Above the axes, where there is never a dot below it.
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, frameon=False, handletextpad=0.2)
        for handle in axes.get_legend().legend_handles:
            handle.set_markersize(10.0)
    left.figure.suptitle(f"{problem.rig.name}: held-out {problem.rows.description}", fontsize=9.0)
