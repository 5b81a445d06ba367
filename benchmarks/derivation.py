"""`make derive` of all models beside the import of SymPy: wall time, medians of paired rounds."""

from __future__ import annotations

import resource
import statistics
import subprocess
import sys
import time
from pathlib import Path

from benchmarks.record import Measured, Part, progress

ROOT = Path(__file__).resolve().parent.parent
_DERIVE = [sys.executable, "-m", "eccentric", "derive"]
_IMPORT = [sys.executable, "-c", "import sympy"]


def measured(quick: bool) -> Part:
    """Measure seven rounds, or three if quick, after one that is not timed."""
    times = []
    for turn in range(4 if quick else 8):
        progress(f"derivation: round {turn}")
        times.append([*_taken(_DERIVE), *_taken(_IMPORT)])
    own, own_processor, peer, peer_processor = map(statistics.median, zip(*times[1:], strict=True))
    ratio = statistics.median(one[0] / one[2] for one in times[1:])
    return Part(
        {
            "derive": Measured(
                ratio,
                f"{ratio:.1f} ({own:.2f} s; processor time {own_processor:.2f} s)",
                f"import sympy {peer:.2f} s ({peer_processor:.2f} s)",
            )
        }
    )


def _taken(command: list[str]) -> tuple[float, float]:
    """Wall time and processor time [s]."""
    start, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, capture_output=True, check=True, cwd=ROOT)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
