"""Time of the emitted array function beside a -ffast-math loop over libmvec's cosine, paired in one program.

Run: python benchmarks/host.py     (gcc and glibc; double precision, blocks of 4096)
"""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
GENERATED = HERE.parent / "generated"
_OWN = ("-O3", "-fno-math-errno", "-fno-trapping-math")


def measured(machine: str) -> tuple[float, float]:
    """(emitted, peer) in ns an element, both built for `machine`."""
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
        own, peer = subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout.split()
    return float(own), float(peer)


def asked() -> list[tuple[str, str, str, bool]]:
    """(what, asked, measured with its peer, whether it is reached)."""
    own, peer = measured("native")
    told = f"{own / peer:.2f} ({own:.2f} / {peer:.2f} ns)"
    rows = [("C, array, native: emitted / libmvec with -ffast-math", "at most 1.1", told, own <= 1.1 * peer)]
    own, peer = measured("x86-64-v3")
    told = f"{own:.2f} ns (libmvec: {peer:.2f})"
    return [*rows, ("C, array, x86-64-v3, an element", "at most 2 ns", told, own <= 2.0)]


if __name__ == "__main__":
    for row in asked():
        print(*row[:3], "" if row[3] else "not reached", sep=" | ")
