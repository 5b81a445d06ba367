"""The emitted C on targets, under QEMU: the same bits as NumPy, within the promised instructions and bytes.

A Cortex-M4F in single precision, and for double precision in hardware a Cortex-M7. Double on the M4F is left
out: libgcc subtracts in software there, not always to the nearest number (1 - 0x1.990c0672887a0p-33 is off by
one in the last place), so that no source has the same bits.
"""

import re
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from benchmarks import cortex_m4
from benchmarks.asked import CODE
from benchmarks.calls import host_counts
from benchmarks.cortex_m4 import GENERATED, M4F, M7, OPTIMISED, build, emulate, missing, run
from benchmarks.target import GRADIENT, TORQUE, grown, target_counts
from tests.emitted import MODELS

CHECK = GENERATED / "check"
TARGETS = {
    "m4f-O2-float": (M4F, "-O2", "float"),
    "m4f-Os-float": (M4F, "-Os", "float"),
    "m7-O2-double": (M7, "-O2", "double"),
}
CALLS = {"torque": TORQUE, "torque and gradient": GRADIENT}
"""What a call gives -> its function."""

absent = cache(missing)


def need(*tools: str) -> None:
    """Skip the test where a tool is not installed, and say which."""
    if lacking := absent(tools):
        pytest.skip(f"not installed: {', '.join(lacking)}")


FEW = {("rotating_link", "m4f-O2-float")}
"""What `make test` runs: on the smaller target the largest model."""


@cache
def counted_on_the_target() -> dict[str, list[int]]:
    """Return the instructions of all calls on a Cortex-M4F: one firmware counts them."""
    with TemporaryDirectory() as folder:
        return target_counts(Path(folder))


@cache
def counted_on_the_host(real: str) -> dict[str, float]:
    """Return the instructions of both calls on x86-64."""
    with TemporaryDirectory() as folder:
        return host_counts(Path(folder), real)


@pytest.mark.parametrize(
    ("name", "target", "optimisation", "real"),
    [
        pytest.param(
            name, *how, id=f"{name}-{target}", marks=() if (name, target) in FEW else pytest.mark.slow
        )
        for name in MODELS
        for target, how in TARGETS.items()
    ],
)
def test_same_bits_on_targets(
    tmp_path: Path, name: str, target: tuple[str, ...], optimisation: str, real: str
) -> None:
    """NumPy's bits on a Cortex-M."""
    need(*cortex_m4.TOOLS)
    sources = [CHECK / f"{name}_selftest.c", GENERATED / f"{name}.c"]
    elf = build(tmp_path / "selftest.elf", sources, [optimisation, f"-DECCENTRIC_REAL={real}"], target)

    status, said = emulate(elf, target=target)

    assert (0, f"{name}: ok") == (status, said[: len(f"{name}: ok")])


def test_counts_are_exact() -> None:
    """The counter counts 1, 11 and 101 instructions of functions that have as many."""
    need(*cortex_m4.TOOLS)

    counts = counted_on_the_target()

    known = {f"nops_{n}": {n + 1} for n in (0, 10, 100)}
    assert known == {name: set(counts[name]) for name in known}


@pytest.mark.parametrize("call", CALLS)
def test_instructions_on_the_target(call: str) -> None:
    """No call takes more instructions on a Cortex-M4F than is promised."""
    need(*cortex_m4.TOOLS)

    assert CODE[f"instructions {call}"].reached(max(counted_on_the_target()[CALLS[call]]))


@pytest.mark.parametrize("call", [pytest.param("torque", marks=pytest.mark.slow), "torque and gradient"])
def test_bytes_on_the_target(tmp_path: Path, call: str) -> None:
    """A firmware grows by no more bytes than is promised, coefficients included."""
    need(*cortex_m4.TOOLS)

    assert CODE[f"bytes {call}"].reached(grown(tmp_path, CALLS[call]))


@pytest.mark.parametrize("call", CALLS)
@pytest.mark.parametrize("real", ["float", "double"])
def test_instructions_on_the_host(call: str, real: str) -> None:
    """No call takes more instructions on x86-64 than is promised, on average over the samples."""
    need("valgrind")

    assert CODE[f"host {call} {real}"].reached(counted_on_the_host(real)[CALLS[call]])


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name == "rotating_link" else pytest.mark.slow) for name in MODELS]
)
def test_no_software_arithmetic_on_the_target(tmp_path: Path, name: str) -> None:
    """With the emitted coefficients nothing is computed in double on a Cortex-M4F: it has no such unit."""
    need(*cortex_m4.TOOLS)
    object_file = tmp_path / f"{name}.o"
    options = ["-std=c99", *M4F, *OPTIMISED, "-DECCENTRIC_REAL=float", "-ffunction-sections"]
    run("arm-none-eabi-gcc", *options, "-c", "-o", object_file, GENERATED / f"{name}.c")
    listed = run("arm-none-eabi-objdump", "-dr", object_file)

    header = (GENERATED / f"{name}.h").read_text(encoding="utf-8")
    public = set(re.findall(rf"\b({name}_\w+)\(", header)) - {f"{name}_prepare"}
    parts = [part.split(":", 1) for part in listed.split("Disassembly of section .text.")[1:]]
    called = {section.removesuffix("_float"): re.findall(r"__aeabi_\w+", part) for section, part in parts}

    assert {} == {function: called[function] for function in public if called[function]}
