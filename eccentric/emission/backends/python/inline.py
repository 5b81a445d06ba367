"""Formulas reassembled: a part of a formula that is used once is written where it is used.

The parts were split for lines of C. Brackets keep the order of operations, and with it every bit.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from eccentric.emission.backends.python.shared import Line

_WIDTH = 102  # of `target = text`
_CHOICE, _SUM, _PRODUCT, _ATOM = range(4)
_PART = re.compile(r"part_\d+")


def inlined(lines: Iterable[Line]) -> list[Line]:
    """The lines, with each part that is used once put into the line that uses it, if that stays readable."""
    kept = list(lines)
    for line in [line for line in kept if _PART.fullmatch(line.targets[0])]:
        (name,) = line.targets
        place = re.compile(rf"(?<![\w.]){name}\b")
        readers = [k for k, other in enumerate(kept) if place.search(other.text)]
        at = kept.index(next(other for other in kept if other.targets == (name,)))
        text = kept[at].text
        if len(readers) != 1 or len(place.findall(kept[readers[0]].text)) != 1:
            continue
        reader = kept[readers[0]]
        put = Line(reader.targets, _put(reader.text, place, text), reader.note)
        if len(f"{put.targets[0]} = {put.text}") <= _WIDTH:
            kept[readers[0]] = put
            del kept[at]
    return kept


def _put(outer: str, place: re.Pattern[str], text: str) -> str:
    """The text in its place, in brackets if precedence requires them."""
    before, after = place.split(outer)
    needed = _SUM
    if before.endswith(("* ", "/ ", "-")):
        needed = _ATOM
    elif before.endswith(("+ ", "- ")) or after.startswith((" *", " /")):
        needed = _PRODUCT
    return f"{before}{text if _level(text) >= needed else f'({text})'}{after}"


def _level(text: str) -> int:
    """The precedence of a formula: that of its loosest operation outside brackets."""
    flat, before = text, ""
    while flat != before:
        flat, before = re.sub(r"\([^()]*\)", "", flat), flat
    if " if " in flat:
        return _CHOICE
    if " + " in flat or " - " in flat or flat.startswith("-"):
        return _SUM
    return _PRODUCT if " * " in flat or " / " in flat else _ATOM
