"""Lines of C, with long ones broken."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable

_WIDTH = 110


def filled(text: str, indent: int = 4) -> list[str]:
    """The lines of an indented text, with a further indent after the first."""
    return textwrap.wrap(
        text, _WIDTH - indent, subsequent_indent="    ", break_long_words=False, break_on_hyphens=False
    )


def code(lines: Iterable[str], indent: int = 4) -> list[str]:
    """The lines of a function's body, long ones broken."""
    return [part for line in lines for part in filled(line, indent)]


def wrapped(result: str, name: str, arguments: list[str]) -> str:
    """The head of a function, with one argument per line if it is long."""
    line = f"{result} {name}({', '.join(arguments)})"
    if len(line) < _WIDTH:
        return line
    return f"{result} {name}(\n    " + ",\n    ".join(arguments) + ")"
