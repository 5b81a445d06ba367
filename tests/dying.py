"""Work that ends or fills the process of a worker; a file alone, since one that starts again imports it."""

import os
import signal
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np


def dying(items: Sequence[Path]) -> list[str]:
    """The names of items; the process is killed each time at "always", and the first time at "once"."""
    for item in items:
        if item.name == "always" or (item.name == "once" and not item.exists()):
            item.touch()
            os.kill(os.getpid(), signal.SIGKILL)
    return [item.name for item in items]


_HOARD: list[np.ndarray] = []


def hoarding(items: Sequence[int]) -> list[int]:
    """On a worker: keep so many bytes for good, all of them touched."""
    _HOARD.extend(np.full(count, 1, np.uint8) for count in items)
    time.sleep(1.0)  # Dask looks at the memory of a worker every 100 ms
    return [os.getpid() for _ in items]
