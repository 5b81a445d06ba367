"""Bags of ROS 1 by rosbags: the numbers of each message, by topic and field."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from eccentric.logs.assemble import Read
from eccentric.logs.foreign import library, reading, require_room_for_numbers
from eccentric.logs.ros_file import Message, of_messages


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
