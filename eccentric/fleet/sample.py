"""A part of a long log for a diagnosis: where its joint moves most."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from eccentric.fleet.limits import BLOCKS, SAMPLE_ROWS
from eccentric.fleet.sources import LogFile
from eccentric.fleet.store import Stored
from eccentric.logs import Log, stream_log
from eccentric.rigs import Rig
from eccentric.signals import stream_columns

__all__ = ["Sample", "sample_of"]


@dataclass(frozen=True)
class Sample:
    """Rows of a log file, at most SAMPLE_ROWS from the one numbered `first`; `name` names it in a report."""

    path: Path
    name: str
    first: int
    size: int
    changed: int

    def log(self, rig: Rig) -> Log:
        """The rows as a log. InputError if the file cannot be read."""
        stream = stream_log(self.path)
        spans = [(min(self.first, stream.rows), min(self.first + SAMPLE_ROWS, stream.rows))]
        read = stream.read(stream_columns(stream, rig), spans)
        return Log(self.name, read.columns, read.rows)


def sample_of(stored: Sequence[Stored], logs: Sequence[LogFile]) -> Sample | None:
    """The part of the files of a joint and period with the most motion; None if none of them is there."""
    there = {log.name: log for log in logs}
    best: tuple[int, Sample] | None = None
    for row in stored:
        log = there.get(row.name)
        if log is None:
            continue
        total = max(row.sums.coverage.rows, 1)
        span = max(1, min(BLOCKS, -(-SAMPLE_ROWS * BLOCKS // total)))
        moving = np.convolve(row.sums.windows, np.ones(span, dtype=np.int64), mode="valid")
        block = int(np.argmax(moving))
        sample = Sample(log.path, log.name, block * total // BLOCKS, log.size, log.changed)
        if best is None or int(moving[block]) > best[0]:
            best = int(moving[block]), sample
    return None if best is None else best[1]
