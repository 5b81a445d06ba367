"""Write the trio of a model, and tell whether what is written is fresh."""

from __future__ import annotations

import difflib
from pathlib import Path

from eccentric.emit.render import render
from eccentric.model import Model


def emit(model: Model, out: Path, command: str = "make derive", origin: str | None = None) -> list[Path]:
    """Write model.py, .h and .c into an existing folder; files that are fresh already are left alone.

    Returns:
        The paths, written or fresh.
    """
    paths = []
    for name, text in render(model, command, origin).items():
        path = out / name
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8", newline="\n")
        paths.append(path)
    return paths


def stale(model: Model, out: Path, command: str = "make derive") -> str:
    """The unified diff from what stands in the folder to what would be written; "" if it is fresh."""
    diffs = []
    for name, text in render(model, command).items():
        path = out / name
        found = path.read_text(encoding="utf-8") if path.is_file() else ""
        diffs += difflib.unified_diff(
            found.splitlines(keepends=True),
            text.splitlines(keepends=True),
            f"generated/{name}",
            f"derived/{name}",
        )
    return "".join(diffs)
