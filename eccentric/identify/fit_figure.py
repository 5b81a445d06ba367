"""The figure of a fit: measured friction against predicted, and over speed, on the held-out rows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eccentric.errors import InputError

if TYPE_CHECKING:
    from pathlib import Path

    from eccentric.identify.fit import Fit

MOST_POINTS = 4000
_MEASURED, _LINEAR, _PAPER = "0.55", "tab:orange", "tab:blue"


def draw(fit: Fit, stem: Path) -> None:
    """Write `stem`.png and `stem`.svg. Raises InputError without matplotlib (extra `figures`)."""
    try:
        from matplotlib import rc_context
        from matplotlib.figure import Figure
    except ImportError:
        raise InputError(
            "matplotlib is required for the figure (extra `figures`), it is not installed"
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
    rows = np.flatnonzero(problem.sampling.score)
    rows = rows[:: -(-len(rows) // MOST_POINTS)]
    friction = [k for k, c in enumerate(problem.coefficients) if c.role == "friction"]
    predicted = paper.design[rows][:, friction] @ paper.coefficients[friction]
    measured = predicted + paper.residual[rows]
    by_linear = measured - linear.residual[rows]
    speed = problem.sampling.mean(problem.channels.omega_m)[rows]
    name = "friction" if problem.unit == "N m" else "friction (and back-EMF)"
    both = np.concatenate([measured, predicted, by_linear])
    ends = [float(both.min()), float(both.max())]
    style = {"linestyle": "none", "marker": ".", "markersize": 2.5, "rasterized": True}
    for values, color, which in ((by_linear, _LINEAR, "linear"), (predicted, _PAPER, "paper")):
        label = f"{which}: RMSE {fit.rmse[which]:.3g} {problem.unit}"
        left.plot(values, measured, color=color, alpha=0.5, label=label, **style)
    left.plot(ends, ends, color="black", linewidth=0.8)
    left.set(xlabel=f"predicted {name} [{problem.unit}]", ylabel=f"measured {name} [{problem.unit}]")
    right.plot(speed, measured, color=_MEASURED, label="measured", **style)
    right.plot(speed, by_linear, color=_LINEAR, label="linear (Coulomb + viscous)", **style)
    right.plot(speed, predicted, color=_PAPER, label=f"paper ({problem.model.name})", **style)
    right.set(xlabel="motor velocity [rad/s]", ylabel=f"{name} [{problem.unit}]")
    for axes in (left, right):
        axes.grid(linewidth=0.3)
        axes.legend(markerscale=4.0)
    left.set_title(f"{problem.rig.name}: held-out {problem.sampling.description}", fontsize=9.0)
