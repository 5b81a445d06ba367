"""What a benchmark passes to the page, and how a figure is judged."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

HEAD = ("| what | required | measured | peer | |", "|---|---|---|---|---|")


@dataclass(frozen=True)
class Asked:
    """A required figure; `up_to` is the other end of a range."""

    what: str
    bound: Literal["at most", "at least"]
    limit: float
    unit: str = ""
    up_to: float = math.inf

    def reached(self, value: float) -> bool:
        """Whether a value is within the limit; NaN is not."""
        return value <= self.limit if self.bound == "at most" else self.limit <= value <= self.up_to


@dataclass(frozen=True)
class Measured:
    """The value that is judged; its text, if not the value itself; what its peers reach."""

    value: float
    text: str = ""
    peer: str = ""


@dataclass(frozen=True)
class Part:
    """What one benchmark found.

    Attributes:
        figures: key of the required figure -> what was measured.
        details: lines of Markdown.
        curves: name -> (x, y), for the figure.
    """

    figures: Mapping[str, Measured]
    details: list[str] = field(default_factory=list)
    curves: Mapping[str, tuple[list[float], list[float]]] = field(default_factory=dict)


def table(asked: Mapping[str, Asked], figures: Mapping[str, Measured]) -> list[str]:
    """One row for each required figure, measured or not, and whether it is reached."""
    return [*HEAD, *(_row(one, figures.get(key)) for key, one in asked.items())]


def progress(text: str) -> None:
    """Show progress in one line, if the output is a terminal."""
    if sys.stderr.isatty():
        print(f"\r\x1b[K{text}", end="", file=sys.stderr, flush=True)


def _row(asked: Asked, measured: Measured | None) -> str:
    required = f"{asked.bound} {asked.limit:.3g} {asked.unit}".rstrip()
    required += "" if math.isinf(asked.up_to) else f" and at most {asked.up_to:.3g}"
    if measured is None:
        return f"| {asked.what} | {required} | | | not measured |"
    text = measured.text or f"{measured.value:.3g} {asked.unit}".rstrip()
    judged = "reached" if asked.reached(measured.value) else "not reached"
    return f"| {asked.what} | {required} | {text} | {measured.peer} | {judged} |"


def peak() -> float:
    """The largest memory that this process has had [B]."""
    status = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    return next(float(line.split()[1]) for line in status if line.startswith("VmHWM:")) * 1024
