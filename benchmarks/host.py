"""Time of the emitted array function beside a -ffast-math loop over libmvec's cosine, paired in one program.

It needs gcc and glibc; double precision, blocks of 4096.
"""

from __future__ import annotations

import statistics
import subprocess
import tempfile
import time
from pathlib import Path

from benchmarks.record import Measured, Part

HERE = Path(__file__).resolve().parent
GENERATED = HERE.parent / "generated"
# A shared processor is in one of two states for seconds, in which the two loops differ by different factors.
RUNS, PAUSE_S = 15, 0.5
_OWN = ("-O3", "-fno-math-errno", "-fno-trapping-math")


def times(machine: str) -> tuple[float, float, float]:
    """(emitted, peer, their ratio), ns an element, both built for `machine`: medians over RUNS of the program."""
    with tempfile.TemporaryDirectory() as name:
        folder, target = Path(name), f"-march={machine}"
        objects = []
        for source, options in (
            (GENERATED / "c2_parallel.c", ("-std=c99", *_OWN)),
            (HERE / "host.c.in", ("-std=c99", *_OWN)),
            (HERE / "libmvec.c.in", ("-O3", "-ffast-math")),
        ):
            objects.append(folder / f"{source.stem}.o")
            command = ["gcc", "-x", "c", *options, target, f"-I{GENERATED}", "-c", str(source)]
            subprocess.run([*command, "-o", str(objects[-1])], check=True)
        program = folder / "host"
        subprocess.run(["gcc", "-o", str(program), *map(str, objects), "-lmvec", "-lm"], check=True)
        runs = []
        for _ in range(RUNS):
            done = subprocess.run([str(program)], capture_output=True, text=True, check=True)
            own, peer = map(float, done.stdout.split())
            runs.append((own, peer, own / peer))
            time.sleep(PAUSE_S)
    own, peer, ratio = map(statistics.median, zip(*runs, strict=True))
    return own, peer, ratio


def measured(_: bool) -> Part:
    """Measure both machines."""
    own, peer, ratio = times("native")
    figures = {"libmvec": Measured(ratio, f"{ratio:.2f} ({own:.2f} ns)", f"libmvec {peer:.2f} ns")}
    own, peer = times("x86-64-v3")[:2]
    return Part({**figures, "v3": Measured(own, f"{own:.2f} ns", f"libmvec {peer:.2f} ns")})
