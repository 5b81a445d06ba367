"""The figure of a course: each coefficient over time with its band, grey where it was not excited."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from eccentric.adaptation.course import Replay

# The colours of Okabe and Ito, as in the report of a diagnosis.
_LINE, _START, _ALARM, _UNSEEN = "#0072b2", "#8a8a8a", "#d55e00", "#b5b5b5"


def plot_course(course: Replay, axes: Sequence[Any]) -> None:
    """Draw a coefficient on each of the axes, one below the other: band of 95 %, start, alarms.

    A band ends at the bounds that the estimator keeps: it is no claim that friction may be negative.
    """
    for j, (name, unit, ax) in enumerate(zip(course.names, course.units, axes, strict=True)):
        value, half = course.values[:, j], 1.96 * course.deviations[:, j]
        lowest, highest = course.lowest[j], course.highest[j]
        below, above = (np.clip(x, lowest, highest) for x in (value - half, value + half))
        seen = course.seen[:, j]
        for shown, colour in ((seen, _LINE), (~seen, _UNSEEN)):
            here = _wide(shown)
            ax.fill_between(course.t, below, above, where=here, color=colour, alpha=0.25, linewidth=0)
            ax.plot(course.t, np.where(here, value, np.nan), color=colour, linewidth=1.2)
        ax.axhline(course.start[j], color=_START, linestyle=":", linewidth=1.0)
        for t, _ in course.alarms:
            ax.axvline(t, color=_ALARM, linewidth=0.8)
        low, high = min(np.min(value), course.start[j]), max(np.max(value), course.start[j])
        margin = max(np.ptp(value), 0.1 * abs(course.start[j]), 1e-12)
        # A little more than the bound, so that a line on it is seen.
        ax.set_ylim(max(low - margin, lowest - 0.05 * (high - low + margin)), high + margin)
        ax.set_ylabel(f"{name}\n[{unit}]")
        ax.spines[["top", "right"]].set_visible(False)
    _add_legend(axes[0], alarms=bool(course.alarms))
    axes[-1].set_xlabel("time [s]")


def _add_legend(ax: Any, *, alarms: bool) -> None:
    """Above the first of the axes, for all of them."""
    entries = [
        ("learned", {"color": _LINE, "linewidth": 1.2}),
        ("not excited: std error above half of the prior's", {"color": _UNSEEN, "linewidth": 1.2}),
        ("start", {"color": _START, "linestyle": ":", "linewidth": 1.0}),
        *([("alarm", {"color": _ALARM, "linewidth": 0.8})] if alarms else []),
    ]
    lines = [ax.plot([], [], label=label, **style)[0] for label, style in entries]
    ax.legend(handles=lines, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4, frameon=False)


def _wide(shown: np.ndarray) -> np.ndarray:
    """With its neighbour on the right, so that the pieces of a line meet."""
    return shown | np.concatenate(([False], shown[:-1]))
