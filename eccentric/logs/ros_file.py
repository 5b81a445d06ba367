"""Recordings of ROS 1 and 2, bags and MCAP: the numbers of each message, by topic and field."""

from __future__ import annotations

import contextlib
import json
import sqlite3
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.core import InputError, few
from eccentric.logs import limits
from eccentric.logs.assemble import Read
from eccentric.logs.clocks import Recorded, on_one_clock
from eccentric.logs.foreign import library, reading, require_room_for_numbers

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
        if len(value) <= limits.MOST_PARTS:
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


# Messages of ROS 2 as objects: by the types that rosbags knows, and by definitions that a file brings along.
#
# A definition is text that is parsed by a grammar of names and types; nothing in it is run.


class Types:
    """The message types of one file."""

    def __init__(self, path: Path, extra: str) -> None:
        self._sys = library("rosbags.typesys", extra, path)
        self._store = self._sys.get_typestore(self._sys.Stores.ROS2_HUMBLE)

    def define(self, name: str, text: str) -> None:
        """Add a type by its definition, with those that it names in the same text."""
        if name not in self._store.types:
            found = self._sys.get_types_from_msg(text, name)
            self._store.register({key: value for key, value in found.items() if key not in self._store.types})

    def read(self, data: bytes, name: str) -> Any:
        """A message in CDR as an object with its fields as attributes; None for an unknown type."""
        if name not in self._store.types:
            return None
        return self._store.deserialize_cdr(data, name)


# ROS 2 bags of the kind `.db3`: an SQLite database of messages, which rosbags reads.
#
# It is opened as a file that nobody changes: otherwise SQLite leaves files of its own beside the log.


def read_bag(path: Path) -> Read:
    """Read the numbers of all messages, put on the clock of the fastest topic."""
    types = Types(path, "rosbag")
    _require_closed(path)
    with (
        reading(path, "ROS 2 bag"),
        contextlib.closing(
            sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro&immutable=1", uri=True)
        ) as file,
    ):
        held = int(file.execute("SELECT COUNT(*) FROM messages").fetchone()[0])
        require_room_for_numbers(path, held, 10 * held)
        topics = {
            row[0]: (str(row[1]), str(row[2])) for row in file.execute("SELECT id, name, type FROM topics")
        }
        tables = {row[0] for row in file.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
        if "message_definitions" in tables:
            query = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
            for name, encoding, text in file.execute(query):
                if encoding == "ros2msg":
                    types.define(str(name), str(text))
        unknown: set[str] = set()
        read = of_messages(_bag_messages(file, topics, types, unknown), path)
        notes = (
            [f"left out, of a type that the bag does not define: {few(sorted(unknown), 5)}"]
            if unknown
            else []
        )
        return Read(read.columns, notes=(*notes, *read.notes), units=read.units)


def _require_closed(path: Path) -> None:
    """Raise InputError if some of the messages are in a journal: it was not closed, or is being written."""
    for suffix in ("-wal", "-journal"):
        journal = path.with_name(path.name + suffix)
        if not journal.is_file():
            continue
        with journal.open("rb") as file:
            # SQLite clears the start of a journal that it keeps and no longer needs.
            if file.read(8).strip(b"\0"):
                raise InputError(
                    path,
                    "a bag that was closed",
                    (
                        f"one with {journal.name} next to it: end its recording, or open and close it"
                        " once with sqlite3"
                    ),
                )


def _bag_messages(
    file: sqlite3.Connection, topics: dict[int, tuple[str, str]], types: Types, unknown: set[str]
) -> Iterator[Message]:
    for topic, time, data in file.execute(
        "SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp"
    ):
        name, kind = topics[topic]
        content = types.read(bytes(data), kind)
        if content is None:
            unknown.add(f"{name} ({kind})")
        else:
            yield name, int(time), content


# MCAP recordings by mcap: messages of ROS 2 and JSON; other encodings are left out with a note.


def read_mcap(path: Path) -> Read:
    """Read the numbers of all messages, put on the clock of the fastest topic. Attachments are ignored."""
    reader = library("mcap.reader", "mcap", path)
    with reading(path, "MCAP file"), path.open("rb") as file:
        recording = reader.make_reader(file, validate_crcs=True)
        summary = recording.get_summary()
        held = summary.statistics.message_count if summary is not None and summary.statistics else 0
        require_room_for_numbers(path, held, 10 * held)
        left_out: dict[str, str] = {}
        notes: list[str] = []
        read = of_messages(_mcap_messages(recording, path, left_out), path)
        notes += [f"left out: {topic}, {why}" for topic, why in left_out.items()]
        return Read(read.columns, notes=(*notes, *read.notes), units=read.units)


def _mcap_messages(recording: Any, path: Path, left_out: dict[str, str]) -> Iterator[Message]:
    types: Types | None = None
    for schema, channel, message in recording.iter_messages():
        if channel.message_encoding == "json":
            yield channel.topic, message.log_time, json.loads(message.data)
        elif channel.message_encoding == "cdr" and schema is not None and schema.encoding == "ros2msg":
            types = types or Types(path, "mcap")
            types.define(schema.name, schema.data.decode())
            yield channel.topic, message.log_time, types.read(message.data, schema.name)
        else:
            left_out[channel.topic] = f"in {channel.message_encoding or 'an unnamed encoding'}"


def read_bag1(path: Path) -> Read:
    """Read the numbers of all messages, put on the clock of the fastest topic."""
    bags = library("rosbags.rosbag1", "rosbag", path)
    types = library("rosbags.typesys", "rosbag", path)
    with reading(path, "ROS 1 bag"), bags.Reader(path) as bag:
        require_room_for_numbers(path, bag.message_count, 10 * bag.message_count)
        return of_messages(_messages(bag, types), path)


def _messages(bag: Any, types: Any) -> Iterator[Message]:
    store = types.get_typestore(types.Stores.ROS1_NOETIC)
    # Every bag brings the definitions of its messages along; they are parsed, not run.
    for connection in bag.connections:
        found = types.get_types_from_msg(connection.msgdef.data, connection.msgtype)
        store.register({name: fields for name, fields in found.items() if name not in store.types})
    for connection, time, data in bag.messages():
        yield connection.topic, int(time), store.deserialize_ros1(data, connection.msgtype)
