"""ROS 2 bags of the kind `.db3`: an SQLite database of messages, which rosbags reads.

It is opened as a file that nobody changes: otherwise SQLite leaves files of its own beside the log.
"""

from __future__ import annotations

import contextlib
import sqlite3
from collections.abc import Iterator
from pathlib import Path

from eccentric.errors import InputError, few
from eccentric.logs.assemble import Read
from eccentric.logs.foreign import reading
from eccentric.logs.recordings.messages import Message, of_messages
from eccentric.logs.recordings.ros_types import Types
from eccentric.logs.room import require_room_for_numbers

__all__ = ["read_bag"]


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
        read = of_messages(_messages(file, topics, types, unknown), path)
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
                    f"{path}: a bag that was closed is required, received one with {journal.name} beside it:"
                    " end its recording, or open and close it once with sqlite3"
                )


def _messages(
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
