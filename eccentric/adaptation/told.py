"""The course of the coefficients as text and as a document."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from eccentric.adaptation.course import Replay

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
        f"{log}: {course.used} samples learned from, {course.still} at rest or after a reversal"
        + (f", {course.unusable} that no fit uses" if course.unusable else "")
        + (f", {course.out_of_range} beyond the range of an input" if course.out_of_range else "")
    ]
    width = max(map(len, course.names))
    lines.append(f"  {'':{width}}  {'start':>10}  {'end':>10}  {'std error':>10}  unit")
    for j, name in enumerate(course.names):
        cells = (course.start[j], course.values[-1, j], course.deviations[-1, j])
        numbers = "  ".join(f"{x:>10.4g}" for x in cells)
        lines.append(f"  {name:{width}}  {numbers}  {course.units[j]}")
    ages = zip(course.names, course.unseen[-1], strict=True)
    lines += [f"{name} not seen for {age:.0f} s" for name, age in ages if age > _LONG_S]
    lines += [
        f"alarm at {t:.6g} s: {kind} friction than was learned" for t, kind in course.alarms[:_MOST_ALARMS]
    ]
    if len(course.alarms) > _MOST_ALARMS:
        lines.append(f"and {len(course.alarms) - _MOST_ALARMS} more alarms")
    if not course.alarms:
        lines.append(
            f"no alarm; a false one is expected in {course.asked.false_alarms:.3g} samples in motion"
        )
    if not _QUIETER < course.noise < _NOISIER:
        lines.append(
            f"the innovations are {course.noise:.2g} times the noise that the prior assumes"
            f" ({course.assumed:.3g} {course.axis.said('N m')}): the standard errors are to be scaled alike"
        )
    if course.correlation > _CORRELATED:
        lines.append(
            f"the innovations are correlated from row to row ({course.correlation:.2g}): the standard errors"
            " are too small, and unless a filter of the log is the cause, the model lacks an effect:"
            " eccentric diagnose"
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
        course.axis.said("assumed_noise_Nm"): course.assumed,
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
