"""ULog files of PX4 by pyulog: each topic has a clock of its own, in microseconds."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from eccentric.logs.assemble import Read, Recorded, on_one_clock
from eccentric.logs.foreign import library, reading, require_room_for_numbers


def read_ulog(path: Path) -> Read:
    """Read the fields of all topics as `topic.field`, put on the clock of the fastest topic."""
    pyulog = library("pyulog", "ulog", path)
    # Opened here: the library would leave the file open after an error.
    with reading(path, "ULog file"), path.open("rb") as stream:
        require_room_for_numbers(path, path.stat().st_size // 8, path.stat().st_size // 8)
        file = pyulog.ULog(stream)
        channels: list[Recorded] = []
        for topic in file.data_list:
            name = f"{topic.name}#{topic.multi_id + 1}" if topic.multi_id else str(topic.name)
            if "timestamp" not in topic.data:
                continue
            time = 1e-6 * np.asarray(topic.data["timestamp"], dtype=float)
            channels += [
                Recorded(f"{name}.{field}", time, np.asarray(values, dtype=float))
                for field, values in topic.data.items()
                if field != "timestamp" and np.asarray(values).dtype.kind in "biuf"
            ]
        notes = ["the file is damaged in places, which are left out"] if file.file_corruption else []
        return on_one_clock(channels, path, notes)
