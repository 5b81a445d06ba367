"""The emitted C of case C2 on a Cortex-M4F and on x86-64, beside what other generators emit for the same model.

Instructions are counted under QEMU and callgrind, bytes are those by which a linked firmware grows.
"""

from __future__ import annotations

import re
import subprocess
import tempfile
from pathlib import Path
from typing import NamedTuple

from benchmarks import environment
from benchmarks.cortex_m4 import (
    GENERATED,
    OPTIMISED,
    SAMPLES,
    TOOLS,
    Subject,
    instructions,
    linked_growth,
    missing,
    run,
)
from benchmarks.record import Measured, Part, tell

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
        command = ["valgrind", "--tool=callgrind", f"--toggle-collect={function}_{real}"]
        done = subprocess.run(
            [*command, "--callgrind-out-file=/dev/null", str(program)],
            capture_output=True,
            text=True,
            check=True,
        )
        collected = re.search(r"Collected : (\d+)", done.stderr)
        assert collected is not None, done.stderr
        counts[function] = int(collected[1]) / SAMPLES
        assert counts[function] > 0, f"no call of {function}_{real} seen"
    return counts


# What is emitted writes torque and slopes to `out`; CasADi has its own convention.
_PLAIN = ("(float, float, float *)", "(x, y, out)")
_CASADI = (
    "(const float **, float **, long long int *, float *, int)",
    "((const float *[]){&x, &y}, (float *[]){out, out + 1, out + 2}, 0, 0, 0)",
)
_FORCED = ("-ffast-math", "-include", str(ROOT / "benchmarks" / "floats.h"))


_PEERS = {"CasADi": "casadi", "SymPy cse": "sympy", "SymForce": "symforce"}
_COUNTS = (
    "instructions torque",
    "instructions torque and gradient",
    "bytes torque",
    "bytes torque and gradient",
)


_FORMS = {"as generated": OPTIMISED, "fast-math": (*OPTIMISED, *_FORCED)}


def peers(folder: Path) -> tuple[dict[str, list[list[int]]], list[str]]:
    """Peer -> its numbers as generated, and with float functions and -ffast-math; and who is left out."""
    found, left_out = {}, []
    reasons = environment.absent(*_PEERS.values())
    for name, package in _PEERS.items():
        tell(f"target: {name}")
        if package in reasons:
            left_out.append(f"{name}: left out, {reasons[package]}.")
            continue
        own = folder / package
        own.mkdir()
        try:
            run(environment.PYTHON, ROOT / "benchmarks" / "peers.py", package, own)
            found[name] = [_peer(own, package == "casadi", options) for options in _FORMS.values()]
        except (RuntimeError, subprocess.TimeoutExpired) as error:
            left_out.append(f"{name}: left out, {str(error).strip().splitlines()[-1]}.")
    return found, left_out


def _peer(own: Path, casadi: bool, options: tuple[str, ...]) -> list[int]:
    counts, sizes = [], []
    for function in ("torque", "gradient"):
        types, arguments = _CASADI if casadi else _PLAIN
        result = "int" if casadi else "void"
        declared = f"{result} {function}{types};"
        called = [Subject(function, types, arguments, result)]
        counts.append(max(instructions(own, declared, called, [own / f"{function}.c"], options)[function]))
        body = f"float out[3] = {{0}}; {function}{arguments}; return out[0] + out[1] + out[2];"
        work = f"{declared}\nstatic float work(float x, float y)\n{{\n"
        main = f"{work}#if CALLED\n{body}\n#else\nreturn x + y;\n#endif\n}}"
        sizes.append(linked_growth(own, f"{function}_grown", main, [own / f"{function}.c"], options))
    return counts + sizes


def measured(_: bool) -> Part:
    """Measure the Cortex-M4F: the most instructions of 64 calls, and bytes of growth."""
    _need(*TOOLS)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        counts = target_counts(folder)
        own = [*(max(counts[f]) for f in (TORQUE, GRADIENT)), *(grown(folder, f) for f in (TORQUE, GRADIENT))]
        found, left_out = peers(folder)
    figures, rows = {}, {"emitted": own}
    for k, what in enumerate(_COUNTS):
        told = [f"{name} {' / '.join(str(form[k]) for form in forms)}" for name, forms in found.items()]
        figures[what] = Measured(
            own[k], str(own[k]), f"as generated / -ffast-math: {'; '.join(told)}" if told else ""
        )
    for name, forms in found.items():
        rows |= {f"{name}, {label}": values for label, values in zip(_FORMS, forms, strict=True)}
    lines = [f"| | {' | '.join(_COUNTS)} |", "|---" * 5 + "|"]
    lines += [f"| {name} | {' | '.join(map(str, values))} |" for name, values in rows.items()]
    says = (
        "Single precision, instructions of a call (the most of 64), bytes of growth of a linked firmware."
        " Peers as generated / with float functions forced and -ffast-math."
    )
    return Part(figures, [says, "", *lines, *(f"\n{line}" for line in left_out)])


def measured_host(_: bool) -> Part:
    """Measure x86-64: instructions of a call on average."""
    _need("valgrind")
    figures = {}
    with tempfile.TemporaryDirectory() as name:
        for real in ("float", "double"):
            counts = host_counts(Path(name), real)
            for what, function in (("torque", TORQUE), ("torque and gradient", GRADIENT)):
                figures[f"host {what} {real}"] = Measured(counts[function], f"{counts[function]:.1f}")
    return Part(figures)


def _need(*tools: str) -> None:
    if absent := missing(tools):
        raise RuntimeError(f"not installed: {', '.join(absent)}")
