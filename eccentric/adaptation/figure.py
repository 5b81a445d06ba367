"""The figure of a course: each coefficient over time with its band, grey where it was not excited."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from eccentric.adaptation.course import Replay

# The colours of Okabe and Ito, as in the report of a diagnosis.
_LINE, _START, _ALARM, _UNSEEN = "#0072b2", "#8a8a8a", "#d55e00", "#b5b5b5"


def plot_course(course: Replay, axes: Sequence[Any]) -> None:
    """Draw a coefficient on each of the axes, one below the other: band of 95 %, start, alarms."""
    for j, (name, unit, ax) in enumerate(zip(course.names, course.units, axes, strict=True)):
        value, half = course.values[:, j], 1.96 * course.deviations[:, j]
        seen = course.seen[:, j]
        for shown, colour, label in ((seen, _LINE, "learned"), (~seen, _UNSEEN, "not excited")):
            if not np.any(shown):
                continue
            ax.fill_between(
                course.t,
                value - half,
                value + half,
                where=_wide(shown),
                color=colour,
                alpha=0.25,
                linewidth=0,
            )
            ax.plot(course.t, np.where(_wide(shown), value, np.nan), color=colour, linewidth=1.2, label=label)
        ax.axhline(course.start[j], color=_START, linestyle=":", linewidth=1.0, label="start")
        for t, _ in course.alarms:
            ax.axvline(t, color=_ALARM, linewidth=0.8)
        low, high = np.min(value), np.max(value)
        margin = max(high - low, 0.1 * abs(course.start[j]), 1e-12)
        ax.set_ylim(min(low, course.start[j]) - margin, max(high, course.start[j]) + margin)
        ax.set_ylabel(f"{name}\n[{unit}]")
        ax.spines[["top", "right"]].set_visible(False)
    if course.alarms:
        axes[0].plot([], [], color=_ALARM, linewidth=0.8, label="alarm")
    axes[0].legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4, frameon=False)
    axes[-1].set_xlabel("time [s]")


def _wide(shown: np.ndarray) -> np.ndarray:
    """With its neighbour on the right, so that the pieces of a line meet."""
    return shown | np.concatenate(([False], shown[:-1]))
