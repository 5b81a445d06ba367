"""The emitted C of case C2 on a Cortex-M4F and on x86-64, beside what other generators emit for the same model.

Instructions are counted under QEMU and callgrind, bytes are those by which a linked firmware grows.
Run: python benchmarks/target.py     (peers are installed with pip into build/bench-env; --no-peers leaves them out)
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
import venv
from pathlib import Path
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from benchmarks.cortex_m4 import (
    GENERATED,
    OPTIMISED,
    SAMPLES,
    Subject,
    instructions,
    linked_growth,
    missing,
    run,
)

ROOT = Path(__file__).resolve().parent.parent
TORQUE, GRADIENT = "c2_parallel_friction_torque", "c2_parallel_friction_torque_with_gradient"


class Asked(NamedTuple):
    """What is promised of a call, at most; `tests/test_target.py` holds it against what is measured."""

    instructions: int
    """on a Cortex-M4F, in single precision"""
    bytes: int
    """by which a firmware grows"""
    host_instructions: int
    """on x86-64, on average"""


ASKED = {TORQUE: Asked(95, 550, 85), GRADIENT: Asked(165, 750, 150)}
_HEADER = '#include "c2_parallel.h"\n'
_SINGLE = ("-DECCENTRIC_REAL=float",)
_SUBJECTS = (
    Subject(TORQUE, "(float, float, const c2_parallel_coefficients *)", "(x, y, &c2_parallel_default)"),
    Subject(
        GRADIENT,
        "(float, float, float *, const c2_parallel_coefficients *)",
        "(x, y, out, &c2_parallel_default)",
        "void",
    ),
)


def target_counts(folder: Path) -> dict[str, list[int]]:
    """Instructions of each call on a Cortex-M4F, over the samples; with those of known functions."""
    return instructions(folder, _HEADER, _SUBJECTS, [GENERATED / "c2_parallel.c"], [*OPTIMISED, *_SINGLE])


def grown(folder: Path, function: str) -> int:
    """Bytes by which a firmware grows with calls of a function."""
    call = "c2_parallel_friction_torque(x, y, &c2_parallel_default)"
    if function == GRADIENT:
        call = "out[0] + out[1] + out[2]"
    before = f"float out[3]; {GRADIENT}(x, y, out, &c2_parallel_default);" if function == GRADIENT else ""
    body = f"#if CALLED\n    {before}\n    return {call};\n#else\n    return x + y;\n#endif"
    main = f"{_HEADER}static float work(float x, float y)\n{{\n{body}\n}}"
    return linked_growth(folder, "grown", main, [GENERATED / "c2_parallel.c"], [*OPTIMISED, *_SINGLE])


_HOST = """
#include "c2_parallel.h"
#include <stdlib.h>
int main(void)
{
    volatile ECCENTRIC_REAL sink;
    ECCENTRIC_REAL out[3];
    srand(5);
    for (int k = 0; k < SAMPLES; ++k) {
        const ECCENTRIC_REAL x = (ECCENTRIC_REAL)(rand() % 100000 - 50000) / 1000;
        const ECCENTRIC_REAL y = (ECCENTRIC_REAL)(rand() % 180000 - 90000) / 1000;
        sink = c2_parallel_friction_torque(x, y, &c2_parallel_default);
        c2_parallel_friction_torque_with_gradient(x, y, out, &c2_parallel_default);
        sink = out[0] + out[1] + out[2];
    }
    (void)sink;
    return 0;
}
"""


def host_counts(folder: Path, real: str) -> dict[str, float]:
    """Instructions of a call on x86-64, with all that it calls, on average over the samples."""
    source, program = folder / "host.c", folder / "host"
    source.write_text(_HOST, encoding="utf-8")
    options = ["-std=c99", *OPTIMISED, f"-DECCENTRIC_REAL={real}", f"-DSAMPLES={SAMPLES}", f"-I{GENERATED}"]
    run("gcc", *options, "-o", program, source, GENERATED / "c2_parallel.c", "-lm")
    counts = {}
    for function in (TORQUE, GRADIENT):
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
    return counts


# What is emitted writes torque and slopes to `out`; CasADi has its own convention.
_PLAIN = ("(float, float, float *)", "(x, y, out)")
_CASADI = (
    "(const float **, float **, long long int *, float *, int)",
    "((const float *[]){&x, &y}, (float *[]){out, out + 1, out + 2}, 0, 0, 0)",
)
_FORCED = ("-ffast-math", "-include", str(ROOT / "benchmarks" / "floats.h"))


def peers(folder: Path, python: Path) -> list[str]:
    """Rows of the table for CasADi, SymPy and SymForce, as generated and with float functions and -ffast-math."""
    rows = []
    for name, package in (("CasADi", "casadi"), ("SymPy, cse", "sympy"), ("SymForce", "symforce")):
        own = folder / package
        own.mkdir()
        try:
            run(
                python,
                "-m",
                "pip",
                "install",
                "-q",
                "--disable-pip-version-check",
                package,
                "sympy",
                timeout=300,
            )
            run(python, ROOT / "benchmarks" / "peers.py", package, own, timeout=120)
        except (RuntimeError, subprocess.TimeoutExpired) as error:
            rows.append(f"| {name}: left out, {str(error).splitlines()[-1][:60]} | | | | |")
            continue
        for label, options in (("as generated", OPTIMISED), ("floats forced", (*OPTIMISED, *_FORCED))):
            counts, sizes = [], []
            for function in ("torque", "gradient"):
                types, arguments = _CASADI if package == "casadi" else _PLAIN
                result = "int" if package == "casadi" else "void"
                declared = f"{result} {function}{types};"
                called = [Subject(function, types, arguments, result)]
                counts.append(
                    max(instructions(own, declared, called, [own / f"{function}.c"], options)[function])
                )
                body = f"float out[3] = {{0}}; {function}{arguments}; return out[0] + out[1] + out[2];"
                work = f"{declared}\nstatic float work(float x, float y)\n{{\n"
                main = f"{work}#if CALLED\n{body}\n#else\nreturn x + y;\n#endif\n}}"
                sizes.append(linked_growth(own, f"{function}_grown", main, [own / f"{function}.c"], options))
            rows.append(f"| {name}, {label} | {counts[0]} | {counts[1]} | {sizes[0]} | {sizes[1]} |")
    return rows


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--no-peers", action="store_true", help="measure the emitted C only")
    wanted = parser.parse_args()
    if absent := missing():
        sys.exit(f"not installed: {', '.join(absent)}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        counts = target_counts(folder)
        print(
            "Cortex-M4F, single precision, instructions of a call (the most of 64) and bytes of growth, linked\n"
        )
        print("| | torque | with gradient | torque, bytes | with gradient, bytes |\n|---|---|---|---|---|")
        asked = [ASKED[f].instructions for f in ASKED] + [ASKED[f].bytes for f in ASKED]
        print("| asked, at most | " + " | ".join(map(str, asked)) + " |")
        measured = [
            *(max(counts[f]) for f in (TORQUE, GRADIENT)),
            *(grown(folder, f) for f in (TORQUE, GRADIENT)),
        ]
        print("| emitted | " + " | ".join(map(str, measured)) + " |", flush=True)
        if not wanted.no_peers:
            environment = ROOT / "build" / "bench-env"
            if not environment.is_dir():
                venv.create(environment, with_pip=True)
            print("\n".join(peers(folder, environment / "bin" / "python")))
        if absent := missing(["valgrind"]):
            sys.exit(f"not installed: {', '.join(absent)}")
        print("\nx86-64, instructions of a call on average\n\n| | torque | with gradient |\n|---|---|---|")
        print(f"| asked, at most | {ASKED[TORQUE].host_instructions} | {ASKED[GRADIENT].host_instructions} |")
        for real in ("float", "double"):
            host = host_counts(folder, real)
            print(f"| emitted, {real} | {host[TORQUE]:.1f} | {host[GRADIENT]:.1f} |")


if __name__ == "__main__":
    main()
