"""Single calls of the emitted C of case C2 on x86-64, beside what other generators emit for the same model.

Instructions are counted by callgrind.
"""

from __future__ import annotations

import re
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks import generators
from benchmarks.cortex_m4 import GENERATED, OPTIMISED, SAMPLES, missing, run
from benchmarks.generators import FUNCTIONS, Generated
from benchmarks.record import Measured, Part
from benchmarks.target import GRADIENT, TORQUE

REALS = ("float", "double")
_WHAT = ("torque", "torque and gradient")
_MAIN = """
@DECLARATIONS@
#include <stdlib.h>
int main(void)
{
    volatile @REAL@ sink;
    @REAL@ out[3] = {0};
    srand(5);
    for (int k = 0; k < @SAMPLES@; ++k) {
        const @REAL@ x = (@REAL@)(rand() % 100000 - 50000) / 1000;
        const @REAL@ y = (@REAL@)(rand() % 180000 - 90000) / 1000;
        @CALLS@
        sink = out[0] + out[1] + out[2];
    }
    (void)sink;
    return 0;
}
"""


def host_counts(folder: Path, real: str) -> dict[str, float]:
    """Instructions of a call of the emitted functions, with all that it calls, on average over the samples."""
    calls = {
        f"{TORQUE}_{real}": f"out[0] = {TORQUE}(x, y, &c2_parallel_default);",
        f"{GRADIENT}_{real}": f"{GRADIENT}(x, y, out, &c2_parallel_default);",
    }
    options = [*OPTIMISED, f"-DECCENTRIC_REAL={real}", f"-I{GENERATED}"]
    counts = _counts(folder, real, '#include "c2_parallel.h"', calls, [GENERATED / "c2_parallel.c"], options)
    return {name.removesuffix(f"_{real}"): count for name, count in counts.items()}


def _peer(emitted: Generated, options: tuple[str, ...]) -> list[float]:
    counts = {}
    for function in FUNCTIONS:
        calls = {function: f"{function}{emitted.arguments};"}
        counts |= _counts(
            emitted.folder,
            emitted.real,
            emitted.declared(function),
            calls,
            [emitted.source(function)],
            options,
        )
    return [counts[function] for function in FUNCTIONS]


def _counts(
    folder: Path,
    real: str,
    declarations: str,
    calls: Mapping[str, str],
    sources: Sequence[Path],
    options: Sequence[str],
) -> dict[str, float]:
    """Function -> instructions of a call, given how each is called with x and y, and writes to out."""
    source, program = folder / "calls.c", folder / "calls"
    text = _MAIN.replace("@DECLARATIONS@", declarations).replace("@CALLS@", "\n        ".join(calls.values()))
    source.write_text(text.replace("@REAL@", real).replace("@SAMPLES@", str(SAMPLES)), encoding="utf-8")
    # Bound when it starts: the first call of a function of libm is as long as all others.
    run("gcc", "-std=c99", *options, "-Wl,-z,now", "-o", program, source, *sources, "-lm")
    counts = {}
    for function in calls:
        command = ["valgrind", "--tool=callgrind", f"--toggle-collect={function}"]
        done = subprocess.run(
            [*command, "--callgrind-out-file=/dev/null", str(program)],
            capture_output=True,
            text=True,
            check=True,
        )
        collected = re.search(r"Collected : (\d+)", done.stderr)
        assert collected is not None, done.stderr
        counts[function] = int(collected[1]) / SAMPLES
        assert counts[function] > 0, f"no call of {function} seen"
    return counts


def measured(_: bool) -> Part:
    """Measure both functions in both precisions."""
    if absent := missing(["valgrind"]):
        raise RuntimeError(f"not installed: {', '.join(absent)}")
    figures, details = {}, ["Instructions of a call with all that it calls, on average over 64 states."]
    with tempfile.TemporaryDirectory() as name:
        for real in REALS:
            counts = host_counts(Path(name), real)
            own = [counts[function] for function in (TORQUE, GRADIENT)]
            found, left_out = generators.measured(Path(name), real, _peer)
            for k, what in enumerate(_WHAT):
                figures[f"host {what} {real}"] = Measured(
                    own[k], f"{own[k]:.1f}", generators.as_text(found, k)
                )
            heads = [f"{what}, {real}" for what in _WHAT]
            details += ["", *generators.table(heads, own, found), *(f"\n{line}" for line in left_out)]
    return Part(figures, details)
