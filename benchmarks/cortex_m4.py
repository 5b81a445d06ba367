"""Compile for a Cortex-M4F, run under QEMU, count instructions and linked bytes: for benchmark and tests."""

from __future__ import annotations

import random
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
FIRMWARE = HERE.parent / "examples" / "firmware"
GENERATED = HERE.parent / "generated"
TOOLS = ("arm-none-eabi-gcc", "arm-none-eabi-size", "qemu-system-arm")
SAMPLES = 64

# Single precision in hardware, and for a double precision in hardware the Cortex-M7 with its larger unit.
M4F = ("-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard")
M7 = ("-mcpu=cortex-m7", "-mthumb", "-mfpu=fpv5-d16", "-mfloat-abi=hard")
# QEMU has no board with one that is large enough; its instructions are a part of the M4F's.
M0 = ("-mcpu=cortex-m0plus", "-mthumb")
MACHINES = {M0: "mps2-an386", M4F: "mps2-an386", M7: "mps2-an500"}
OPTIMISED = ("-O2", "-fno-math-errno")


@dataclass(frozen=True)
class Subject:
    """A function to count: `result name(types)`, called with `arguments` in terms of x, y and out."""

    name: str
    types: str
    arguments: str
    result: str = "float"


def missing(tools: Sequence[str] = TOOLS) -> list[str]:
    """Return those of the tools that are not installed; newlib counts as one."""
    absent = [tool for tool in tools if shutil.which(tool) is None]
    if "arm-none-eabi-gcc" in tools and not absent:
        specs = run("arm-none-eabi-gcc", "-print-file-name=nosys.specs").strip()
        absent += [] if Path(specs).is_file() else ["newlib for arm-none-eabi"]
    return absent


def run(*command: str | Path, timeout: float = 120) -> str:
    """Run a tool and return what it prints.

    Raises:
        RuntimeError: it failed; the message is what it said.
    """
    done = subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=False)
    if done.returncode:
        raise RuntimeError(f"{command[0]}: {done.stdout}{done.stderr}")
    return done.stdout


def build(elf: Path, sources: Sequence[Path], options: Sequence[str], target: tuple[str, ...] = M4F) -> Path:
    """Link sources with the start-up code and linker script of the firmware example."""
    board = [FIRMWARE / "startup.c", FIRMWARE / "semihosting.c", HERE / "stdout.c"]
    script = ["-nostartfiles", "--specs=nosys.specs", "-T", FIRMWARE / "mps2_an386.ld"]
    sections = ["-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections", "-Wl,--no-warnings"]
    include = [f"-I{FIRMWARE}", f"-I{GENERATED}"]
    options = ["-std=c99", *target, *options]
    run("arm-none-eabi-gcc", *options, *script, *sections, *include, "-o", elf, *board, *sources, "-lm")
    return elf


def emulate(elf: Path, *options: str, target: tuple[str, ...] = M4F) -> tuple[int, str]:
    """Run a firmware; return its exit status and what it wrote."""
    command = ["qemu-system-arm", "-M", MACHINES[target], "-nographic", "-monitor", "none", "-serial", "none"]
    semihosting = ["-semihosting-config", "enable=on,target=native"]
    done = subprocess.run(
        [*command, *semihosting, *options, "-kernel", str(elf)],
        capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    # QEMU writes what the firmware says to its standard error.
    return done.returncode, done.stdout + done.stderr


def instructions(
    folder: Path,
    declarations: str,
    subjects: Sequence[Subject],
    sources: Sequence[Path],
    options: Sequence[str],
) -> dict[str, list[int]]:
    """Count the executed instructions of each subject, from its entry to its return, over SAMPLES inputs.

    Returns:
        Subject -> count per sample; with them nops_0, nops_10 and nops_100, whose counts are known.
    """
    generator = random.Random(5)  # noqa: S311 - sample inputs
    first = [generator.uniform(-50.0, 50.0) for _ in range(SAMPLES)]
    second = [generator.uniform(-90.0, 90.0) for _ in range(SAMPLES)]
    known = [Subject(f"nops_{n}", "(void)", "()", "void") for n in (0, 10, 100)]
    counted = [*known, *subjects]
    source = (HERE / "count.c.in").read_text(encoding="utf-8")
    for hole, text in {
        "DECLARATIONS": declarations,
        "SAMPLES": str(SAMPLES),
        "FIRST": ", ".join(f"{x:.8g}f" for x in first),
        "SECOND": ", ".join(f"{x:.8g}f" for x in second),
        "MEASURES": "\n".join(f"MEASURE({s.name}, {s.result}, {s.types}, {s.arguments})" for s in counted),
        "PRINTS": "\n".join(f"    {s.name}_print();" for s in counted),
    }.items():
        source = source.replace(f"@{hole}@", text)
    (folder / "count.c").write_text(source, encoding="utf-8")
    build(folder / "count.elf", [folder / "count.c", *sources], options)
    status, said = emulate(folder / "count.elf", "-icount", "shift=10,sleep=off")
    if status:
        raise RuntimeError(f"QEMU ended with {status}: {said}")
    lines = [line.split() for line in said.splitlines()]
    return {name: list(map(int, counts)) for name, *counts in lines}


def linked_growth(folder: Path, name: str, main: str, sources: Sequence[Path], options: Sequence[str]) -> int:
    """Bytes by which a firmware that reads two volatiles and writes one grows with a call in between.

    Args:
        folder: to build in.
        name: of the files.
        main: C with two definitions of `float work(float x, float y)`, chosen by `CALLED`.
        sources: what the call needs.
        options: of the compiler.
    """
    file = folder / f"{name}.c"
    file.write_text(f"{main}\n{_MAIN}", encoding="utf-8")
    sizes = []
    for called in ("-DCALLED=0", "-DCALLED=1"):
        elf = build(folder / f"{name}.elf", [file, *sources], [*options, called])
        text, data, *_ = run("arm-none-eabi-size", elf).splitlines()[1].split()
        sizes.append(int(text) + int(data))
    return sizes[1] - sizes[0]


_MAIN = """
volatile float input[2], output;
int main(void)
{
    const float x = input[0], y = input[1];
    output = work(x, y);
    return 0;
}
"""
