"""Findings about a log: one record for each anomaly."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Literal

from eccentric.core import InputError

Severity = Literal["note", "warning"]


_DOUBTFUL = {"wrong_sign", "wrong_unit", "contradiction", "another_rig", "mismatch", "zero_angle"}


@dataclass(frozen=True)
class Finding:
    """One line about the data: `kind` (a word for tests and tables), the channel or letter, the text.

    `rows` counts the rows concerned. A "warning" makes results wrong unless it is corrected; a "note" has
    already been handled, or does little harm. `mend` is the line of the rig file that would put it right, ""
    where the log does not say which.
    """

    kind: str
    channel: str
    text: str
    rows: int
    severity: Severity
    mend: str = ""

    @property
    def doubts_the_rig(self) -> bool:
        """Whether log and rig file contradict each other: then no other conclusion is safe."""
        return self.severity == "warning" and self.kind in _DOUBTFUL


@contextmanager
def with_doubts(findings: Sequence[Finding]) -> Iterator[None]:
    """Where a log cannot be fitted, first say what in it contradicts the rig: that may be the reason."""
    try:
        yield
    except InputError as error:
        doubts = [finding.text for finding in findings if finding.doubts_the_rig]
        if type(error) is not InputError or not doubts:
            raise
        problem = f"{doubts[0]}; as the rig is, {error.statement}"
        raise InputError(error.place, problem=problem, keys=error.keys) from None
