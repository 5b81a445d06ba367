"""The course of the coefficients as text, as a document and as a figure."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from eccentric.adaptation import Replay

FORMAT = "eccentric-adapt/1"
_LONG_S = 10.0
"""Seconds unseen that are worth a line."""
_MOST_ALARMS = 5
_NOISIER, _QUIETER = 2.0, 0.5
_CORRELATED = 0.5
"""From one row to the next: with more, standard errors that count every row are far too small."""


def course_lines(course: Replay, log: str) -> list[str]:
    """What was learned, what was not seen, and what was announced; `log` is the name of the log."""
    lines = [
        f"{log}: {course.used} samples used, {course.still} skipped at rest or after a reversal"
        + (f", {course.unusable} excluded as in a fit" if course.unusable else "")
        + (f", {course.out_of_range} outside the range of an input" if course.out_of_range else "")
    ]
    width = max(map(len, course.names))
    lines.append(f"  {'':{width}}  {'start':>10}  {'end':>10}  {'std error':>10}  unit")
    for j, name in enumerate(course.names):
        cells = (course.start[j], course.values[-1, j], course.deviations[-1, j])
        numbers = "  ".join(f"{x:>10.4g}" for x in cells)
        lines.append(f"  {name:{width}}  {numbers}  {course.units[j]}")
    ages = zip(course.names, course.unseen[-1], strict=True)
    lines += [f"{name} not seen for {age:.0f} s" for name, age in ages if age > _LONG_S]
    lines += [f"alarm at {t:.6g} s: {kind} friction than learned" for t, kind in course.alarms[:_MOST_ALARMS]]
    if len(course.alarms) > _MOST_ALARMS:
        lines.append(f"and {len(course.alarms) - _MOST_ALARMS} more alarms")
    if not course.alarms:
        lines.append(
            f"no alarm; on average {course.asked.false_alarms:.3g} samples in motion give one false alarm"
        )
    if not _QUIETER < course.noise < _NOISIER:
        lines.append(
            f"the innovations are {course.noise:.2g} times the noise that the prior assumes"
            f" ({course.assumed:.3g} {course.axis.unit('N m')}): scale the standard errors by the same factor"
        )
    if course.correlation > _CORRELATED:
        lines.append(
            f"the innovations are correlated from row to row ({course.correlation:.2g}): the standard errors"
            " are too small; unless a filter in the log is the cause, an effect is missing: run eccentric"
            " diagnose"
        )
    return lines


def course_document(course: Replay, log: str) -> dict[str, Any]:
    """The content of adapt.json: strict JSON, format eccentric-adapt/1."""
    return {
        "format": FORMAT,
        "log": log,
        "asked": dataclasses.asdict(course.asked),
        "alarm_rows": dict(course.alarm),
        "samples": {
            "learned": course.used,
            "still": course.still,
            "out_of_range": course.out_of_range,
            "unusable": course.unusable,
        },
        "step_s": course.step,
        course.axis.named("assumed_noise_Nm"): course.assumed,
        "innovation": {"over_assumed": course.noise, "correlation": course.correlation},
        "alarms": [{"t_s": t, "friction": kind} for t, kind in course.alarms],
        "t_s": course.t.tolist(),
        "coefficients": {
            name: {
                "unit": course.units[j],
                "start": float(course.start[j]),
                "prior_std_error": float(course.prior[j]),
                "value": _rounded(course.values[:, j]),
                "std_error": _rounded(course.deviations[:, j]),
                "unseen_s": _rounded(course.unseen[:, j]),
            }
            for j, name in enumerate(course.names)
        },
    }


def _rounded(x: np.ndarray) -> list[float]:
    return [float(f"{value:.7g}") for value in x]


# The figure of a course: each coefficient over time with its band, grey where it was not excited.

# The colours of Okabe and Ito, as in the report of a diagnosis.
_LINE, _START, _ALARM, _UNSEEN = "#0072b2", "#8a8a8a", "#d55e00", "#b5b5b5"


def plot_course(course: Replay, axes: Sequence[Any]) -> None:
    """Draw a coefficient on each of the axes, one below the other: band of 95 %, start, alarms.

    A band ends at the bounds that the estimator keeps: it is no claim that friction may be negative.
    """
    for j, (name, unit, ax) in enumerate(zip(course.names, course.units, axes, strict=False)):
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
