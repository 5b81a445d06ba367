"""JSON logs: those of Rhoban BAM's recorder, and tables as pandas writes them.

BAM's recorder writes one object: the settings of the run (mass, length, kp, vin, motor, trajectory) and a
list `entries` of one object per row (timestamp, position, speed, load, input_volts, temp, goal_position,
torque_enable). A file of lists of numbers instead, one for each column, is read as well.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

from eccentric.core import InputError, few
from eccentric.logs.assemble import Read, assemble
from eccentric.logs.csv_file import text_of
from eccentric.logs.foreign import require_room_for_text
from eccentric.logs.limits import MOST_LISTS


def read_json(path: Path) -> Read:
    """Read a JSON log: columns by the entries' keys, NaN for a missing key, 1 and 0 for true and false.

    Numbers and text beside the rows become columns that repeat them in every row, so that arithmetic in the
    rig can use them.
    """
    text = text_of(path)
    require_room_for_text(
        path, text, _rows(text), 1 + text.count(","), parts=text.count("{") + text.count("[")
    )
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: not a valid JSON file ({error})") from None
    if isinstance(content, list):
        content = {"": content}
    if not isinstance(content, dict):
        raise InputError(path, "a JSON object with a list of entries", f"{content!r:.40}")
    _require_table(content, path)
    read = assemble(content)
    if not read.columns:
        keys = ", ".join(map(repr, list(content)[:8]))
        raise InputError(path, "a JSON log with a list of entries", f"keys {keys or 'none'}")
    return read


def _require_table(content: object, path: Path, name: str = "") -> None:
    """Raise InputError for objects with lists of several lengths: they are recordings, no rows of a table."""
    if isinstance(content, dict):
        for key, inner in content.items():
            _require_table(inner, path, f"{name}.{key}" if name else key)
    if not isinstance(content, list) or not all(isinstance(item, dict) for item in content):
        return
    keys = dict.fromkeys(key for item in content for key in item)
    lists = {key: {len(item[key]) for item in content if isinstance(item.get(key), list)} for key in keys}
    uneven = [key for key, lengths in lists.items() if len(lengths) > 1]
    if uneven:
        lengths = sorted(lists[uneven[0]])
        raise InputError(
            path,
            "one table",
            f"{len(content)} objects in {name or 'a list'!r}, each with lists ({few(uneven, 3)}) of a length"
            f" of its own, {lengths[0]} to {lengths[-1]}: write a row for each sample, with a column for the"
            " run",
        )


def _rows(text: str) -> int:
    """Number of rows, before anything is read: of entries, or of the numbers of the longest column."""
    records = text.count("{") - text[:100].lstrip().startswith("{")
    return max(records, max(islice(_lengths(text), MOST_LISTS), default=0))


def _lengths(text: str) -> Iterator[int]:
    """The length of each list that holds neither lists nor objects."""
    start = text.find("[")
    while start >= 0:
        end = text.find("]", start)
        end = len(text) if end < 0 else end
        inner = max(text.rfind("[", start + 1, end), text.find("{", start, end))
        if inner < 0:
            yield 1 + text.count(",", start, end)
        start = text.find("[", end if inner < 0 else inner)
