"""Colour, where a terminal has it: https://no-color.org is respected, and a file or pipe gets none."""

import os
import sys
from typing import TextIO

__all__ = ["coloured"]

_CODES = {"error": "31", "warning": "33", "good": "32", "answer": "1"}


def coloured(text: str, kind: str, stream: TextIO | None = None) -> str:
    """The text as an "error", "warning", "good" news or the "answer" on this stream, by default stdout."""
    if not _has_colour(sys.stdout if stream is None else stream):
        return text
    return f"\x1b[{_CODES[kind]}m{text}\x1b[0m"


def _has_colour(stream: TextIO | None) -> bool:
    """Whether a stream is a terminal that shows colour, and nobody asked for none."""
    if stream is None or os.environ.get("NO_COLOR") or os.environ.get("TERM", "dumb") == "dumb":
        return False
    return stream.isatty()
