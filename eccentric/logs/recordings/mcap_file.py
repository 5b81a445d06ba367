"""MCAP recordings by mcap: messages of ROS 2 and JSON; other encodings are left out with a note."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from eccentric.logs.assemble import Read
from eccentric.logs.foreign import library, reading
from eccentric.logs.recordings.messages import Message, of_messages
from eccentric.logs.recordings.ros_types import Types
from eccentric.logs.room import require_room_for_numbers

__all__ = ["read_mcap"]


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
        read = of_messages(_messages(recording, path, left_out), path)
        notes += [f"left out: {topic}, {why}" for topic, why in left_out.items()]
        return Read(read.columns, notes=(*notes, *read.notes), units=read.units)


def _messages(recording: Any, path: Path, left_out: dict[str, str]) -> Iterator[Message]:
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
