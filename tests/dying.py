"""Work for a cluster that ends its process; alone in a file, since a worker that starts again imports it."""

import os
import signal
from collections.abc import Sequence
from pathlib import Path


def dying(items: Sequence[Path]) -> list[str]:
    """The names of items; the process is killed each time at "always", and the first time at "once"."""
    for item in items:
        if item.name == "always" or (item.name == "once" and not item.exists()):
            item.touch()
            os.kill(os.getpid(), signal.SIGKILL)
    return [item.name for item in items]
