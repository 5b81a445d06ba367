"""Lines that are not too long: a formula is broken before an operator that is in no bracket."""

from __future__ import annotations

from collections.abc import Iterator

WIDTH = 106  # behind the indentation of a function


def broken(before: str, text: str, width: int = WIDTH) -> list[str]:
    """The formula after `before`, on several lines in brackets if it is too long for one.

    A sum is broken between terms, a product between factors; what is neither stays as it is.
    """
    if len(before + text) <= width:
        return [before + text]
    parts = list(_parts(text, "+-"))
    parts = parts if len(parts) > 1 else list(_parts(text, "*/"))
    lines = parts[:1]
    for part in parts[1:]:
        if len(f"{lines[-1]} {part}") <= width - 4:
            lines[-1] += f" {part}"
        else:
            lines.append(part)
    return [f"{before}(", *(f"    {line}" for line in lines), ")"] if len(parts) > 1 else [before + text]


def _parts(text: str, operators: str) -> Iterator[str]:
    """The terms or factors, each but the first with its operator in front."""
    depth = start = 0
    for k, c in enumerate(text):
        depth += (c in "([") - (c in ")]")
        if not depth and c in operators and text[k - 1 : k + 2] == f" {c} ":
            yield text[start : k - 1]
            start = k
    yield text[start:]
