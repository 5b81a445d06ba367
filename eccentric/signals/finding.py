"""What is odd about a log: one record for each oddity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Severity = Literal["note", "warning"]


@dataclass(frozen=True)
class Finding:
    """One line on the data: `kind` (a word for tests and tables), the channel or letter, the text.

    `rows` counts the rows concerned. A "warning" makes results wrong unless it is dealt with; a "note" is
    dealt with already, or harms little.
    """

    kind: str
    channel: str
    text: str
    rows: int
    severity: Severity
