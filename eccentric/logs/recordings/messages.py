"""Messages of a robot's recording as channels: the numbers in each message, named by topic and field."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.errors import few
from eccentric.logs.assemble import Read
from eccentric.logs.limits import MOST_PARTS
from eccentric.logs.one_clock import Recorded, on_one_clock

__all__ = ["Message", "of_messages"]

Message = tuple[str, int, Any]
"""Topic, time of recording [ns], and the content: a mapping, or an object with attributes."""


def of_messages(messages: Iterable[Message], path: Path, notes: Iterable[str] = ()) -> Read:
    """Return the numbers of all messages, put on the clock of the fastest topic.

    A message with a header counts from its stamp, any other from its recording. Entries of a list are named
    by the message's own names where it has as many, as joint states have, else by their number from 1.
    """
    times: dict[str, list[int]] = defaultdict(list)
    fields: dict[str, dict[str, list[float]]] = defaultdict(dict)
    uneven: set[str] = set()
    for topic, recorded, content in messages:
        values = dict(_numbers(content, "", 0))
        if not values:
            continue
        of, count = fields[topic], len(times[topic])
        times[topic].append(_stamp(content) or recorded)
        for name, value in values.items():
            # A field that comes later starts with what is missing.
            of.setdefault(name, [float("nan")] * count).append(value)
        for name, column in of.items():
            if len(column) <= count:
                column.append(float("nan"))
                uneven.add(f"{topic}.{name}")
    start = min((stamps[0] for stamps in times.values()), default=0)
    channels = [
        Recorded(
            f"{topic.strip('/')}.{name}",
            1e-9 * np.array([t - start for t in times[topic]], dtype=float),
            np.array(x),
        )
        for topic, of in fields.items()
        for name, x in of.items()
    ]
    said = [f"not in every message: {few(sorted(uneven), 5)}"] if uneven else []
    return on_one_clock(channels, path, [*notes, *said])


def _fields(content: Any) -> Mapping[str, Any]:
    if isinstance(content, Mapping):
        return content
    names = getattr(content, "__dataclass_fields__", {})
    return {name: getattr(content, name) for name in names if not name.startswith("__")}


def _stamp(content: Any) -> int:
    """Time of the header [ns], 0 without one."""
    header = _fields(content).get("header")
    stamp = _fields(_fields(header).get("stamp")) if header is not None else {}
    try:
        return int(stamp["sec"]) * 1_000_000_000 + int(stamp.get("nanosec", stamp.get("nsec", 0)))
    except (KeyError, TypeError, ValueError):
        return 0


def _numbers(value: Any, name: str, depth: int) -> Iterator[tuple[str, float]]:
    if isinstance(value, bool | int | float | np.integer | np.floating | np.bool_):
        yield name or "value", float(value)
    elif isinstance(value, str | bytes) or value is None or depth > 6:
        return
    elif isinstance(value, list | tuple | np.ndarray):
        if len(value) <= MOST_PARTS:
            for k, one in enumerate(value, start=1):
                yield from _numbers(one, f"{name}_{k}", depth + 1)
    else:
        inside = _fields(value)
        names = inside.get("name")
        for key, inner in inside.items():
            if key == "header":
                continue
            at = f"{name}.{key}" if name else str(key)
            if (
                isinstance(names, list)
                and isinstance(inner, list | np.ndarray)
                and len(inner) == len(names)
                and key != "name"
            ):
                for said, one in zip(names, inner, strict=True):
                    yield from _numbers(one, f"{at}.{said}", depth + 1)
            else:
                yield from _numbers(inner, at, depth + 1)
