"""Titles, meanings and units, as comments and docstrings can hold them."""

from __future__ import annotations

import re


def plain(text: str) -> str:
    """Free text that is safe in comments and docstrings: one line, no escape, no delimiter of C or Python."""
    line = "".join(c for c in " ".join(text.split()) if c.isprintable())
    line = line.replace("\\", "\\\\").replace('"', "'")
    return re.sub(r"(?<=\*)(?=/)|(?<=/)(?=\*)", " ", line)
