"""The emitted C of case C2 on a Cortex-M4F, beside what other generators emit for the same model.

Instructions are counted under QEMU, bytes are those by which a linked firmware grows.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from benchmarks import generators
from benchmarks.cortex_m4 import GENERATED, OPTIMISED, TOOLS, Subject, instructions, linked_growth, missing
from benchmarks.footprint import footprint
from benchmarks.generators import FUNCTIONS, Generated
from benchmarks.record import Measured, Part

TORQUE, GRADIENT = "c2_parallel_friction_torque", "c2_parallel_friction_torque_with_gradient"


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


_COUNTS = (
    "instructions torque",
    "instructions torque and gradient",
    "bytes torque",
    "bytes torque and gradient",
)


def _peer(emitted: Generated, options: tuple[str, ...]) -> list[int]:
    counts, sizes = [], []
    for function in FUNCTIONS:
        declared, arguments, sources = (
            emitted.declared(function),
            emitted.arguments,
            [emitted.source(function)],
        )
        called = [Subject(function, emitted.types, arguments, emitted.result)]
        counts.append(max(instructions(emitted.folder, declared, called, sources, options)[function]))
        body = f"float out[3] = {{0}}; {function}{arguments}; return out[0] + out[1] + out[2];"
        work = f"{declared}\nstatic float work(float x, float y)\n{{\n"
        main = f"{work}#if CALLED\n{body}\n#else\nreturn x + y;\n#endif\n}}"
        sizes.append(linked_growth(emitted.folder, f"{function}_grown", main, sources, options))
    return counts + sizes


def measured(_: bool) -> Part:
    """Measure the Cortex-M4F: the most instructions of 64 calls, and bytes of growth."""
    if absent := missing(TOOLS):
        raise RuntimeError(f"not installed: {', '.join(absent)}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        counts = target_counts(folder)
        own = [*(max(counts[f]) for f in (TORQUE, GRADIENT)), *(grown(folder, f) for f in (TORQUE, GRADIENT))]
        alone = footprint(folder, "mechanical_friction_torque", "Cortex-M4F")
        found, left_out = generators.measured(folder, "float", _peer)
    figures = {
        what: Measured(own[k], str(own[k]), generators.as_text(found, k)) for k, what in enumerate(_COUNTS)
    }
    figures |= {
        f"{what} torque alone": Measured(value, str(value))
        for what, value in (("text", alone.text), ("constants", alone.constants), ("stack", alone.stack))
    }
    says = (
        "Single precision, instructions of a call (the most of 64), bytes of growth of a linked firmware."
        " Peers as generated, and with float functions forced and -ffast-math."
    )
    table = generators.table(_COUNTS, own, found)
    return Part(figures, [says, "", *table, *(f"\n{line}" for line in left_out)])
