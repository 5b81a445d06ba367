"""Compilers of the host, and the self-test of the emitted C as they compile it."""

import shutil
import tempfile
from functools import cache
from pathlib import Path

import pytest

from benchmarks.cortex_m4 import GENERATED, run
from tests.compiled import FLAGS

CHECK = GENERATED / "check"
REALS = ("float", "double")
both_reals = pytest.mark.parametrize("real", REALS)
_SANITIZED = ("-O1", "-fsanitize=undefined,address,float-cast-overflow", "-fno-sanitize-recover=all")
# Without contraction of products and sums: gcc's -std=c99 forbids it, clang has an option.
HOSTS = {
    "gcc-O0": ("gcc", "-O0"),
    "gcc-O2-fma": ("gcc", "-O2", "-mfma"),
    "gcc-O3-avx2": ("gcc", "-O3", "-fno-math-errno", "-fno-trapping-math", "-mavx2", "-mfma"),
    "gcc-sanitized": ("gcc", *_SANITIZED),
    "clang": ("clang", "-O2", "-ffp-contract=off"),
    "clang-sanitized": ("clang", "-ffp-contract=off", *_SANITIZED),
}


@cache
def lacking(*compiler: str) -> str:
    """Return why a compiler with its options cannot be used: it, its libraries, the processor; else ""."""
    if shutil.which(compiler[0]) is None:
        return f"not installed: {compiler[0]}"
    information = Path("/proc/cpuinfo")
    units = information.read_text(encoding="utf-8").split() if information.is_file() else []
    if absent := [one for one in compiler if one.startswith("-m") and one[2:] not in units]:
        return f"the processor lacks what {' '.join(absent)} needs"
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "empty.c"
        source.write_text("int main(void) { return 0; }\n", encoding="utf-8")
        try:
            run(*compiler, source, "-o", source.with_suffix(""))
        except RuntimeError:
            return f"not installed: what {' '.join(compiler)} links with"
    return ""


def need(*compiler: str) -> None:
    """Skip the test where a compiler with its options cannot be used."""
    if reason := lacking(*compiler):
        pytest.skip(reason)


def on_host(
    folder: Path,
    name: str,
    compiler: tuple[str, ...],
    real: str,
    source: Path | None = None,
    check: Path = CHECK,
) -> Path:
    """Compile the self-test of a model, of which the strict warnings have nothing to say."""
    program = folder / f"{name}_{real}"
    sources = [check / f"{name}_selftest.c", source or GENERATED / f"{name}.c"]
    options = [*FLAGS, *compiler[1:], f"-DECCENTRIC_REAL={real}", f"-I{GENERATED}"]
    run(compiler[0], *options, "-o", program, *sources, "-lm")
    return program
