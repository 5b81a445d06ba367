"""What one emitted function costs on small processors: text, constants, stack and instructions, as a table.

`python benchmarks/footprint.py` writes the table into docs/firmware.md.
"""

from __future__ import annotations

import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

import eccentric
from benchmarks.cortex_m4 import HERE, M0, M4F, M7, build, emulate, run
from eccentric.model import Model

MODEL = "c2_parallel"
FUNCTIONS = (
    "normal_force",
    "mechanical_friction_torque",
    "friction_torque",
    "friction_torque_gradient",
    "friction_torque_with_gradient",
    "regressor",
    "gravity_torque",
    "voltage",
    "current",
)
_PAGE = HERE.parent / "docs" / "firmware.md"
_BEGIN, _END = "<!-- footprint: begin -->\n", "<!-- footprint: end -->\n"


@dataclass(frozen=True)
class Core:
    """A processor.

    Attributes:
        tools: prefix of its compiler and binary tools.
        options: of the compiler.
        real: the precision that its unit has, or float without one.
        board: whether QEMU runs a board; otherwise a program.
    """

    tools: str
    options: tuple[str, ...]
    real: str
    board: bool = True


@dataclass(frozen=True)
class Footprint:
    """Bytes of text, constants and stack."""

    text: int
    constants: int
    stack: int


CORES = {
    "Cortex-M0+": Core("arm-none-eabi-", M0, "float"),
    "Cortex-M4F": Core("arm-none-eabi-", M4F, "float"),
    "Cortex-M7": Core("arm-none-eabi-", M7, "double"),
    "RISC-V (rv64gc)": Core("riscv64-linux-gnu-", (), "double", board=False),
}
_STATES = ((0.4, 12.0), (9.5, -37.0), (-700.0, 80.0))
_CALL = """#include "{}.h"
volatile ECCENTRIC_REAL input[] = {{(ECCENTRIC_REAL){}, (ECCENTRIC_REAL){}, 0, 0, 0, 0, 0, 0}}, output;
int main(void)
{{
    ECCENTRIC_REAL {}, out[8] = {{0}};
#if CALLED
    {};
#endif
    output = out[0];
    return 0;
}}
"""


def footprint(folder: Path, function: str, core: str, model: str | Model = MODEL) -> Footprint:
    """The function of a model alone, with fixed parameters and -O2.

    Raises:
        RuntimeError: the compiler is missing or fails.
    """
    one, out, name = CORES[core], folder / function, model if isinstance(model, str) else model.name
    eccentric.emit(model, out, functions=[function], fixed=True, backend="c99")
    made = out / f"{name}.o"
    options = (*one.options, "-std=c99", "-O2", "-fstack-usage", f"-DECCENTRIC_REAL={one.real}")
    run(f"{one.tools}gcc", *options, "-c", out / f"{name}.c", "-o", made)
    listed = run(f"{one.tools}size", "-A", made)
    sections = re.findall(r"^\.(text|rodata|srodata)\S*\s+(\d+)", listed, re.MULTILINE)
    used = made.with_suffix(".su").read_text(encoding="utf-8").splitlines()
    return Footprint(
        text=sum(int(size) for name, size in sections if name == "text"),
        constants=sum(int(size) for name, size in sections if name != "text"),
        stack=max(int(line.split("\t")[1]) for line in used),
    )


def instructions(folder: Path, function: str, core: str, name: str = MODEL) -> int:
    """Executed instructions of a call, the greatest of three states; the call itself and its stores included."""
    one, out = CORES[core], folder / function
    header = (out / f"{name}.h").read_text(encoding="utf-8")
    (declared,) = re.findall(rf"(\w+) {name}_{function}\((.*?)\);", header, re.DOTALL)
    names = re.findall(r"ECCENTRIC_REAL (\w+)", declared[1])
    given = ", ".join([*names, *(["out"] if "*out" in declared[1] else []), f"&{name}_default"])
    call = f"{'' if declared[0] == 'void' else 'out[0] = '}{name}_{function}({given})"
    inputs = ", ".join(f"{name} = input[{k}]" for k, name in enumerate(names))
    counts = []
    for state in _STATES:
        lines = []
        for called in (0, 1):
            (out / "call.c").write_text(_CALL.format(name, *state, inputs, call), encoding="utf-8")
            lines.append(_lines(out, one, called, name))
        counts.append(lines[1] - lines[0])
    return max(counts)


def _lines(out: Path, one: Core, called: int, name: str) -> int:
    """Instructions of a whole run of call.c."""
    options = (f"-DCALLED={called}", f"-DECCENTRIC_REAL={one.real}", "-O2", "-std=c99", f"-I{out}")
    sources, program, log = (out / "call.c", out / f"{name}.c"), out / "call", out / "call.log"
    logged = ("-singlestep", "-d", "nochain,exec", "-D", str(log))
    if one.board:
        build(program, sources, options, one.options)
        emulate(program, *logged, target=one.options)
    else:
        run(f"{one.tools}gcc", *options, "-static", "-o", program, *sources, "-lm")
        run("qemu-riscv64", *logged, program)
    with log.open(encoding="utf-8") as lines:
        return sum(line.startswith("Trace") for line in lines)


def table() -> str:
    """The table of all functions and processors, in Markdown."""
    head = ["function", *CORES]
    lines = [head, ["---", *["--:" for _ in CORES]]]
    with tempfile.TemporaryDirectory() as folder:
        for function in FUNCTIONS:
            row = [f"`{function}`"]
            for core in CORES:
                found = footprint(Path(folder), function, core)
                counted = instructions(Path(folder), function, core)
                row.append(f"{found.text} / {found.constants} / {found.stack} / {counted}")
            lines.append(row)
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def main() -> int:
    """Write the table into the page."""
    page = _PAGE.read_text(encoding="utf-8")
    before, _, rest = page.partition(_BEGIN)
    _PAGE.write_text(before + _BEGIN + table() + _END + rest.partition(_END)[2], encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
