"""What the results of a fit and of a diagnosis have in common."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING, Any

from eccentric.errors import InputError
from eccentric.fitting import NEEDS_MATPLOTLIB

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Result", "new_axes", "paragraphs"]


@dataclass(frozen=True, eq=False, kw_only=True)
class Result:
    """A result that prints as its summary and is a JSON document.

    Attributes:
        lines: the summary, line by line.
        warnings: what is odd about logs, rig or fit.
        document: the content of the JSON file that the command of this result writes.
    """

    lines: tuple[str, ...]
    warnings: tuple[str, ...]
    document: Mapping[str, Any]

    def summary(self) -> str:
        """What the command prints."""
        return "\n".join(self.lines)

    def to_json(self) -> str:
        """The text of the JSON file, strict: no NaN, no infinity."""
        return json.dumps(self.document, indent=1, ensure_ascii=False, allow_nan=False) + "\n"

    def to_dict(self) -> dict[str, Any]:
        """The content of the JSON file as its reader gets it: numbers, texts, lists and dictionaries."""
        return json.loads(self.to_json())

    def __str__(self) -> str:
        return self.summary()


def new_axes(rows: int, columns: int, size: tuple[float, float]) -> list[Axes]:
    """Axes of a new figure, row by row; InputError where matplotlib is not installed."""
    try:
        from matplotlib import pyplot as plt
    except ImportError:
        raise InputError(NEEDS_MATPLOTLIB) from None
    _, axes = plt.subplots(rows, columns, sharex=rows > 1, squeeze=False, figsize=size, layout="constrained")
    return list(axes.flat)


def paragraphs(*texts: str) -> str:
    """The texts as paragraphs of HTML, escaped."""
    return "".join(f"<p>{escape(text)}</p>" for text in texts)
