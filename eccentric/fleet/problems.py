"""What could not be done, one row each: the run goes on, and its exit status says that there are some."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from dataclasses import astuple, dataclass, fields

__all__ = [
    "NOT_GROUPED",
    "NOT_TESTED",
    "NO_RIG",
    "OTHER_RIG",
    "SCHEDULER",
    "UNREAD",
    "FleetProblem",
    "as_csv",
]

NOT_GROUPED = "not grouped"
"""Kind of the problem of a file that belongs to no joint or period."""
NO_RIG = "no rig"
"""Kind of the problem of a joint without a rig, or whose rig cannot be used."""
OTHER_RIG = "another rig"
"""Kind of the problem of a joint whose inertia and gravity are not those of its rig."""
NOT_TESTED = "not tested"
"""Kind of the problem of a joint with too few periods."""
SCHEDULER = "scheduler"
"""Kind of the problem of a run whose scheduler went away."""
UNREAD = frozenset({"worker", "cannot be used"})
"""Kinds of problems of a file that has no sums."""


@dataclass(frozen=True, order=True)
class FleetProblem:
    """A problem of a joint, period or file, as far as known; `kind` in a word or two, `text` in a line."""

    joint: str
    period: str
    file: str
    kind: str
    text: str


def as_csv(problems: Iterable[FleetProblem]) -> str:
    """The content of problems.csv, in order."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([field.name for field in fields(FleetProblem)])
    writer.writerows(astuple(problem) for problem in sorted(set(problems)))
    return text.getvalue()
