"""Lines with a label before every number, as microcontrollers print them: "t: 0.01, pos = 1.2 rad"."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np

from eccentric.core import counted
from eccentric.logs.assemble import Column, Read
from eccentric.logs.cells import TIME_OF_DAY, cells_to_column, is_number, signs_of

_NUMBER = r"[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|nan\b|inf\b)"
_VALUE = re.compile(rf"""["']?\s*[:=]\s*["']?({_NUMBER})(?![\d:])""", re.IGNORECASE)
_LABEL = re.compile(r"[^\W\d][\w .%/°-]*(?:[\[(][^\[\]()]*[\])])?$")
_STAMP = re.compile(rf"\s*\[?\s*({TIME_OF_DAY.pattern}|{_NUMBER})\s*\]?\s*(?:->|[-,;|:>\t])?\s*(?=\D)")
_APART = " \t,;|"


def has_labels(lines: Sequence[str]) -> bool:
    """Whether most lines have a label before each of two numbers or more."""
    given = [line for line in lines if line.strip()]
    return 2 * sum(len(_VALUE.findall(line)) > 1 and bool(_parts(line)) for line in given) > len(given)


def of_labels(lines: Sequence[str]) -> Read | None:
    """The columns of lines with labels, by label; None if a line between two has none, or others.

    Lines before and after are left out, with a note; a time of day or a number before the first label is a
    column, too.
    """
    rows = [(k, row) for k, line in enumerate(lines, start=1) if (row := _parts(line))]
    if not rows:
        return None
    names, count = Counter(tuple(name for name, _ in row) for _, row in rows).most_common(1)[0]
    rows = [(k, row) for k, row in rows if tuple(name for name, _ in row) == names]
    first, last = rows[0][0], rows[-1][0]
    within = sum(map(bool, map(str.strip, lines[first - 1 : last])))
    if within > count or len(set(names)) < len(names):
        return None  # what is between two rows may end a run
    others = sum(map(bool, map(str.strip, lines))) - count
    values = list(zip(*([cell for _, cell in row] for _, row in rows), strict=True))
    columns: dict[str, Column] = {}
    units: dict[str, str] = {}
    notes = [f"left out, unlabelled: {counted(others, 'line')}"] if others else []
    for name, cells, sign in zip(names, values, signs_of(values, ";"), strict=True):
        columns[name], unit, note = cells_to_column(name, cells, sign)
        notes += [note] if note else []
        units |= {name: unit} if unit else {}
    lines_of = np.array([k for k, _ in rows], dtype=np.int64)
    return Read(columns, lines_of, tuple(notes), units, ("labelled lines",))


def _parts(line: str) -> list[tuple[str, str]]:
    """The labels of a line, each with its number and what follows it as a unit; empty for another line."""
    found = list(_labels(line)) if len(_VALUE.findall(line)) > 1 else []
    return found if all(name for name, _ in found) else []


def _labels(line: str) -> Iterator[tuple[str, str]]:
    stamp = _STAMP.match(line)
    start = stamp.end() if stamp else 0
    if stamp:
        yield ("column 1" if is_number(stamp[1]) else "time"), stamp[1].strip()
    label, value = None, ""
    for one in _VALUE.finditer(line, start):
        between = line[start : one.start()]
        unit, found = _split(between) if value else ("", between)
        named = _LABEL.search(found.rstrip())
        if label is not None:
            yield label, f"{value} {unit}".strip()
        label, value, start = named[0].strip() if named else "", one[1], one.end()
    if label is not None:
        yield label, f"{value} {line[start:].strip(_APART + ']})*' + chr(10) + chr(13))}".strip()


def _split(between: str) -> tuple[str, str]:
    """The unit of a number and the next label: a comma or the like is between, or no blank is before."""
    apart = re.match(r"\s*([^\s,;|]*)\s*[,;|\t]", between) or re.match(r"([A-Za-z°µμΩ%]\S*)\s", between)
    return (apart[1], between[apart.end() :]) if apart else ("", between)
