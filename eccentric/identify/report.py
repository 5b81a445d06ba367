"""`report.html`: the diagnosis for a person, one file that opens offline.

All text from logs and rigs is escaped; only the figure and the formulas, made here, go in as they are.
"""

from __future__ import annotations

import io
import re
from typing import Any

import jinja2
import numpy as np
import sympy as sp

from eccentric.identify.diagnose import Diagnosis
from eccentric.identify.diagnosis import sentence
from eccentric.model.steps import meaning
from eccentric.places import folder

__all__ = ["report"]

_CHANNELS = (
    ("omega_m", "motor velocity [rad/s]"),
    ("theta_l", "link angle [rad]"),
    ("i", "current [A]"),
    ("t", "time [s]"),
)


def report(found: Diagnosis) -> str:
    """The page."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(folder("templates")), undefined=jinja2.StrictUndefined, autoescape=True
    )
    return environment.get_template("report.html.jinja").render(_view(found))


def _view(found: Diagnosis) -> dict[str, Any]:
    a = found.attribution
    counts = found.channels.counts
    return {
        "title": f"What does the model lack? {', '.join(found.logs)}",
        "sentence": sentence(found),
        "errors": [
            (balance, [f"{m[name]:.4g}" if name in m else "" for name in ("linear", "paper", "extended")])
            for balance, m in found.rmse.items()
        ],
        "holdout": found.channels.holdout.rule,
        "noise": f"{found.noise_floor:.3g}",
        "figure": _figure(found),
        "equations": [
            {
                "formula": effect.formula,
                "mathml": _mathml(effect.equation()),
                "reference": effect.reference,
                "share": f"{100 * found.extended.shares.get(effect.id, 0.0):.1f}",
            }
            for effect, _ in found.effects
        ],
        "parameters": [
            {
                "name": name,
                "value": f"{e.value:.4g}",
                "error": f"{e.std_error:.2g}",
                "interval": f"{e.interval[0]:.4g} to {e.interval[1]:.4g}",
                "unit": e.unit,
            }
            for name, e in found.extended.estimates.items()
        ],
        "candidates": [
            {"id": c.id, "balance": c.balance, "rmse": f"{c.rmse:.4g}", "probability": f"{c.probability:.3f}"}
            for c in a.candidates[:12]
        ],
        "depends": ", ".join(a.depends_on),
        "next": a.next_measurement,
        "rows": ", ".join(f"{value} rows {name.replace('_', ' ')}" for name, value in counts.items()),
        "warnings": found.channels.warnings,
        "logs": " ".join(found.logs),
        "rig": found.rig_name,
    }


def _mathml(equation: Any) -> str:
    # For reading, the careful steps are written as what they mean.
    right = sp.trigsimp(meaning(equation.right))
    body = sp.mathml(sp.Eq(equation.left, right, evaluate=False), printer="presentation")
    return f'<math display="block">{body}</math>'


def _figure(found: Diagnosis) -> str | None:
    """Residual over channels before and after as inline SVG; None without matplotlib."""
    try:
        import matplotlib as mpl
        from matplotlib.figure import Figure
    except ModuleNotFoundError:
        return None
    channels = found.channels
    mu = found.setting.mu
    drive = channels.current if channels.drive == "current" else channels.torque
    over = {
        "omega_m": channels.omega_m,
        "theta_l": np.mod(mu * channels.theta_m, 2 * np.pi),
        "i": drive,
        "t": channels.t,
    }
    rows = channels.usable
    before, after = found.paper.residuals["mechanical"], found.extended.residuals["mechanical"]
    with mpl.rc_context({"svg.hashsalt": "eccentric", "svg.fonttype": "path"}):
        figure = Figure(figsize=(10, 6), layout="constrained")
        for axes, (name, label) in zip(figure.subplots(2, 2).flat, _CHANNELS, strict=True):
            x = np.asarray(over[name])[rows]
            for residual, colour, text in ((before, "#D55E00", "before"), (after, "#0072B2", "after")):
                at, median = _binned(x, residual[rows])
                axes.plot(at, median, color=colour, marker=".", label=text)
            axes.axhline(0.0, color="0.5", linewidth=0.8)
            axes.set(xlabel=label, ylabel="residual [N m]")
            axes.legend()
        buffer = io.StringIO()
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    return re.sub(r"^.*?(?=<svg)", "", buffer.getvalue(), flags=re.DOTALL)


def _binned(x: np.ndarray, y: np.ndarray, bins: int = 60) -> tuple[np.ndarray, np.ndarray]:
    """Medians of y in bins of x; bins with few rows are left out."""
    low, high = np.quantile(x, [0.001, 0.999])
    edges = np.linspace(float(low), float(high), bins + 1)
    which = np.digitize(x, edges)
    found = [
        (x[which == k].mean(), np.median(y[which == k]))
        for k in range(1, bins + 1)
        if np.sum(which == k) > 10
    ]
    return np.array([f[0] for f in found]), np.array([f[1] for f in found])
