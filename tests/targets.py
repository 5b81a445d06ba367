"""Where the emitted C is compiled and run: any compiler, dialect, target and flag, this machine or QEMU."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks import cortex_m4


@dataclass(frozen=True)
class Target:
    """Where the C runs.

    Attributes:
        gcc: the compiler, which also links.
        clang: the options by which clang compiles for it.
        options: those of both compilers.
        emulator: what runs a program, if it is not this machine.
        board: linked with start-up code, run by the emulator of a whole board.
    """

    gcc: str
    clang: tuple[str, ...] = ()
    options: tuple[str, ...] = ()
    emulator: str = ""
    board: bool = False


_M7EM, _M6 = ("--target=thumbv7em-none-eabihf",), ("--target=thumbv6m-none-eabi",)
TARGETS = {
    "x86-64": Target("gcc"),
    "x86-64-fma": Target("gcc", options=("-mavx2", "-mfma")),
    "aarch64": Target("aarch64-linux-gnu-gcc", ("--target=aarch64-linux-gnu",), emulator="qemu-aarch64"),
    "riscv64": Target(
        "riscv64-linux-gnu-gcc",
        ("--target=riscv64-linux-gnu", "-march=rv64gc", "-mabi=lp64d", "-I/usr/riscv64-linux-gnu/include"),
        emulator="qemu-riscv64",
    ),
    "m4f": Target("arm-none-eabi-gcc", _M7EM, cortex_m4.M4F, "qemu-system-arm", board=True),
    "m7": Target("arm-none-eabi-gcc", _M7EM, cortex_m4.M7, "qemu-system-arm", board=True),
    "m0+": Target("arm-none-eabi-gcc", _M6, cortex_m4.M0, "qemu-system-arm", board=True),
}


def compiler(family: str, target: str) -> tuple[str, ...]:
    """Return the command of a family, gcc or clang, for a target."""
    one = TARGETS[target]
    if family == "gcc":
        return (one.gcc, *one.options)
    headers = ("-isystem", "/usr/include/newlib") if one.board else ()
    return (family, *one.clang, *one.options, *headers)


def missing(family: str, target: str) -> list[str]:
    """Return the tools that are not installed."""
    one = TARGETS[target]
    tools = (family if family == "clang" else one.gcc, one.gcc, *([one.emulator] if one.emulator else []))
    return [tool for tool in dict.fromkeys(tools) if shutil.which(tool) is None]


def printed(
    folder: Path,
    family: str,
    target: str,
    options: tuple[str, ...],
    real: str,
    sources: Sequence[Path],
    driver: str,
) -> tuple[bool, str]:
    """Return whether the sources compile with these options, and what a driver that calls them prints.

    If they do not, it is what the compiler says. The sources are in one folder, with their headers.

    Raises:
        RuntimeError: what compiles does not link or run.
    """
    one, program = TARGETS[target], folder / "program"
    common = [f"-DECCENTRIC_REAL={real}", f"-I{sources[0].parent}"]
    made = subprocess.run(
        [*compiler(family, target), *options, *common, "-c", *sources],
        cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if made.returncode:
        return False, made.stderr
    main = folder / "driver.c"
    main.write_text(driver, encoding="utf-8")
    parts = [main, *(folder / f"{source.stem}.o" for source in sources)]
    if one.board:
        cortex_m4.build(program, parts, [*common, "-O1"], one.options)
        status, said = cortex_m4.emulate(program, target=one.options)
        if status:
            raise RuntimeError(f"{one.emulator}: {status}: {said}")
        return True, said
    linker = (one.gcc,) if family == "gcc" or one.emulator else (family,)
    static = ["-static"] if one.emulator else []
    together = [x for x in options if x == "-flto"]
    cortex_m4.run(*linker, *static, *together, *common, "-O1", "-o", program, *parts, "-lm")
    return True, cortex_m4.run(*([one.emulator] if one.emulator else []), program)
