"""Lines with a label before every number, as microcontrollers print them: "t: 0.01, pos = 1.2 rad"."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

import numpy as np

from eccentric.core import counted, few
from eccentric.logs.assemble import Column, Read
from eccentric.logs.cells import TIME_OF_DAY, as_unit, cells_to_column, signs_of

_NUMBER = r"(?>[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|nan\b|inf\b))"
_VALUE = re.compile(rf"""(?<!\d:\d\d)["']?\s*[:=]\s*["']?({_NUMBER})(?![\d:]|,\d)""", re.IGNORECASE)
_LABEL = re.compile(r"(?<![\w.°%/^*·])[^\W\d][\w .%/°-]*(?:[\[(][^\[\]()]*[\])])?\s*$")
_STAMP = re.compile(
    rf"(?<![\w.])(?:(?=\d)(?P<time>{TIME_OF_DAY.pattern})|[-+]?\.?\d[\w.]*(?:(?<=[eE])[-+]\d+)?)"
)
_APART = " \t\r\n,;|*->\"'()[]{}"
_NO_UNIT = re.compile(r"[:=,;|]|(?<![\w^*/-])[-+.]*\d")
_TEXT_AFTER = re.compile(r"[:=](?!(?:[^\W\d]\w*:)*\W*$)")
"""A label with text after it, which is no name of a group, as in "motor: " and "INFO:root:"."""
_GROUP = re.compile(r"[^\W\d][\"']?\s*[:=]\s*$")
_WORDS = frozenset({"count", "min", "turn"})
"""Units that may as well begin a label."""


def has_labels(lines: Sequence[str]) -> bool:
    """Whether most lines have a label before each of two numbers or more."""
    given = [line for line in lines if line.strip()]
    return 2 * sum(_parts(line) is not None for line in given) > len(given)


def of_labels(lines: Sequence[str]) -> Read | None:
    """The columns of lines with labels, by label; None if a line between two has none, or others.

    Lines before and after are left out, with a note; a time of day or a number before the first label is a
    column, too, and words there are left out, with a note where they differ.
    """
    found = [(k, *parts) for k, line in enumerate(lines, start=1) if (parts := _parts(line))]
    if not found:
        return None
    names, count = Counter(tuple(name for name, _ in row) for _, _, row in found).most_common(1)[0]
    rows = [(k, row) for k, _, row in found if tuple(name for name, _ in row) == names]
    first, last = rows[0][0], rows[-1][0]
    within = sum(map(bool, map(str.strip, lines[first - 1 : last])))
    if within > count or len(set(names)) < len(names):
        return None  # what is between two rows may end a run
    others = sum(map(bool, map(str.strip, lines))) - count
    values = list(zip(*([cell for _, cell in row] for _, row in rows), strict=True))
    columns: dict[str, Column] = {}
    units: dict[str, str] = {}
    notes = [f"left out, unlabelled: {counted(others, 'line')}"] if others else []
    if len(words := dict.fromkeys(before for _, before, _ in found)) > 1:
        notes.append(f"not read: {few(filter(None, words), 5)}")
    for name, cells, sign in zip(names, values, signs_of(values, ";"), strict=True):
        columns[name], unit, note = cells_to_column(name, cells, sign)
        notes += [note] if note else []
        units |= {name: unit} if unit else {}
    lines_of = np.array([k for k, _ in rows], dtype=np.int64)
    return Read(columns, lines_of, tuple(notes), units, ("labelled lines",))


def _parts(line: str) -> tuple[str, list[tuple[str, str]]] | None:
    """The words before the first label of a line, and each label with its number and what follows as a unit.

    None for a line with anything else, such as text after a label, further numbers or a decimal comma.
    """
    values = list(_VALUE.finditer(line))
    if len(values) < 2:
        return None
    starts = [0, *(one.end() for one in values)]
    gaps = [line[start : one.start()] for start, one in zip(starts, values, strict=False)]
    labels = [label for gap in gaps if (label := _LABEL.search(gap))]
    if len(labels) < len(gaps):
        return None
    before, *units = [gap[: label.start()] for gap, label in zip(gaps, labels, strict=True)]
    names, numbers = [label[0].strip() for label in labels], [one[1] for one in values]
    units.append(line[starts[-1] :])
    stamps = list(_STAMP.finditer(before))
    rest = _STAMP.sub(lambda one: "" if one["time"] else "0", before)
    is_doubt = " " in names[0] and _GROUP.search(rest)  # "state: IDLE x: 2"
    if len(stamps) > 1 or _TEXT_AFTER.search(rest) or is_doubt:
        return None
    for stamp in stamps:
        after = before[stamp.end() :]
        unit = re.split(r"\W", after.lstrip())[0]
        names.insert(0, "time" if stamp["time"] else "column 1")
        numbers.insert(0, stamp[0].strip())
        units.insert(0, unit if as_unit(unit) else "," if after.strip() else " ")
    for k, unit in enumerate(units[:-1]):
        words = names[k + 1].split(" ")
        heads = (" ".join(words[:n]) for n in range(len(words) - 1, 0, -1))
        first = next(
            (head for head in heads if head not in _WORDS and as_unit(head)), "" if unit else words[0]
        )
        label = names[k + 1][len(first) :].lstrip(" -")
        if first and not unit.strip() and _LABEL.match(label):
            units[k], names[k + 1] = first, label
            if unit and len(first.split()[-1]) == 1 and any(name.endswith(f" {label}") for name in names):
                return None  # "A pos: 1 B pos: 2"
    units = [unit.strip(_APART) for unit in units]
    if any(map(_NO_UNIT.search, units)):
        return None
    cells = [f"{number} {unit}".strip() for number, unit in zip(numbers, units, strict=True)]
    return " ".join(re.findall(r"[^\W\d]\w*", rest)), list(zip(names, cells, strict=True))
