"""The picture of friction at rest for the manual: what should stand still, and a link that swings down.

Run `python benchmarks/rest_figure.py` in the root of the clone; it writes docs/rest.svg.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from benchmarks.rest import DT, HELD_S, STILL, ways  # noqa: E402 - the root of the clone comes first
from generated import c2_parallel  # noqa: E402

_HOLDS, _CREEPS, _SLOPE = "#0072b2", "#d55e00", "#8a8a8a"
_FALLS, _UNTIL_S = 2.1, 1.2


def _path(
    step: Callable[[float, float], float], theta_l: float, until: float
) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and link angles [rad] of a drive that starts at rest."""
    mu = c2_parallel.Parameters().mu
    theta_m, omega_m, angles = theta_l / mu, 0.0, [theta_l]
    for _ in range(round(until / DT)):
        omega_m = step(theta_m, omega_m)
        theta_m += DT * omega_m
        angles.append(mu * theta_m)
    return DT * np.arange(len(angles)), np.array(angles)


def main() -> None:
    """Integrate and draw."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    steps = ways()
    with rc_context({"svg.hashsalt": "eccentric", "font.size": 9.0}):
        figure = Figure(figsize=(8.0, 3.2), layout="constrained")
        left, right = figure.subplots(1, 2)
        drawn = zip(steps.items(), (_HOLDS, _CREEPS, _SLOPE), ("-", "-", "--"), strict=False)
        for (name, step), colour, line in drawn:
            t, angle = _path(step, STILL, HELD_S)
            left.plot(t, (STILL - angle) * 1e3, color=colour, linestyle=line, label=name.replace("`", ""))
        left.set(xlabel="time [s]", ylabel="creep of a link at rest [mrad]")
        left.legend(frameon=False, loc="upper left", fontsize=8.0)
        t, angle = _path(next(iter(steps.values())), _FALLS, _UNTIL_S)
        right.plot(t, angle, color=_HOLDS)
        right.axhline(0.0, color="#bbbbbb", linewidth=0.6)
        right.set(xlabel="time [s]", ylabel="link angle [rad]")
        stop = int(np.flatnonzero(np.diff(angle))[-1]) + 1
        right.annotate(
            f"at rest, {angle[stop]:.3f} rad", (t[stop], angle[stop]), (0.35, -0.9), textcoords="data",
            arrowprops={"arrowstyle": "-", "color": "#8a8a8a"},
        )  # fmt: skip
        right.set_ylim(-1.2, None)
        for ax in (left, right):
            ax.spines[["top", "right"]].set_visible(False)
        figure.savefig(ROOT / "docs" / "rest.svg", metadata={"Date": None})


if __name__ == "__main__":
    main()
