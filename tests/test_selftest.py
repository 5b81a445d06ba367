"""The self-test of the emitted C: every compiler of the host has the bits of NumPy, sanitizers included."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from benchmarks.cortex_m4 import GENERATED, run
from eccentric.emit import render
from eccentric.emit.check import render_check
from eccentric.model import load_model
from tests import extended
from tests.compiled import FLAGS
from tests.emitted import every_model

CHECK = GENERATED / "check"
REALS = ("float", "double")
# Without contraction of products and sums: gcc's -std=c99 forbids it, clang has an option.
HOSTS = {
    "gcc-O0": ("gcc", "-O0"),
    "gcc-O2-fma": ("gcc", "-O2", "-mfma"),
    "clang": ("clang", "-O2", "-ffp-contract=off"),
    "gcc-sanitized": (
        "gcc", "-O1", "-fsanitize=undefined,address,float-cast-overflow", "-fno-sanitize-recover=all"
    ),
}  # fmt: skip


def need_fma() -> None:
    """Skip the test where the processor has no fused multiply-add."""
    information = Path("/proc/cpuinfo")
    if not information.is_file() or " fma " not in information.read_text(encoding="utf-8"):
        pytest.skip("this processor has no fused multiply-add")


def on_host(
    folder: Path, name: str, compiler: tuple[str, ...], real: str, source: Path | None = None
) -> Path:
    """Compile the self-test of a model."""
    program = folder / f"{name}_{real}"
    sources = [CHECK / f"{name}_selftest.c", source or GENERATED / f"{name}.c"]
    run(*compiler, "-std=c99", f"-DECCENTRIC_REAL={real}", f"-I{GENERATED}", "-o", program, *sources, "-lm")
    return program


@every_model
def test_check_files_are_fresh(name: str) -> None:
    """Self-test, vectors and proof driver are what would be written now, byte for byte."""
    model = load_model(name)

    for file, text in render_check(model, render(model)).items():
        assert text == (GENERATED / file).read_text(encoding="utf-8"), f"{file} is stale: make derive"


@pytest.mark.parametrize("compiler", HOSTS.values(), ids=HOSTS)
@every_model
def test_same_bits_on_hosts(tmp_path: Path, name: str, compiler: tuple[str, ...]) -> None:
    """NumPy's bits in both precisions, from every compiler, without a word of the sanitizers'."""
    if shutil.which(compiler[0]) is None:
        pytest.skip(f"not installed: {compiler[0]}")
    if "-mfma" in compiler:
        need_fma()

    for real in REALS:
        assert f"{name}: ok" in run(on_host(tmp_path, name, compiler, real))


@pytest.mark.parametrize("real", REALS)
def test_selftest_sees_a_changed_digit(tmp_path: Path, real: str) -> None:
    """A polynomial coefficient that is off in its last digit fails, and the function is named."""
    text = (GENERATED / "c2_parallel.c").read_text(encoding="utf-8")
    digits = re.findall(r"REAL\((-1\.66666\d+)e-1\)", text)[REALS.index(real)]
    changed = tmp_path / "changed.c"
    changed.write_text(text.replace(digits, digits[:-2] + "00"), encoding="utf-8")

    done = subprocess.run(
        [on_host(tmp_path, "c2_parallel", ("gcc", "-O2"), real, changed)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip

    assert 1 == done.returncode
    assert re.match(
        r"c2_parallel: vector \d+, \w+, value \d:\n expected 0x\w+ got 0x\w+ theta_m", done.stdout
    )


def test_selftest_sees_contraction(tmp_path: Path) -> None:
    """A compiler that fuses products and sums has other bits, and the self-test says so."""
    need_fma()
    fused = on_host(tmp_path, "c2_parallel", ("gcc", "-O2", "-mfma", "-ffp-contract=fast"), "float")

    assert 1 == subprocess.run([fused], capture_output=True, check=False).returncode


def exponential(folder: Path, case: str, effect_id: str, *options: str) -> subprocess.CompletedProcess[str]:
    """Compile and run the self-test of an extended model that includes its own source."""
    one = extended.with_effect(case, effect_id)
    for file, text in (one.texts | render_check(one.model, one.texts)).items():
        (folder / file).parent.mkdir(exist_ok=True)
        (folder / file).write_text(text, encoding="utf-8")
    test = folder / "check" / f"{one.model.name}_selftest.c"
    run("gcc", *FLAGS, f"-I{folder}", "-o", folder / "test", test, *options, "-lm")
    return subprocess.run([folder / "test"], capture_output=True, text=True, check=False)


@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize(
    ("case", "effect_id"),
    [
        ("C2", "hidden_thermal_drift"),
        ("C2", "load_dependent[progressive]"),
        ("C2", "angle_offset"),
        ("C1", "sensor_delay"),
        ("C1", "magnetic_hysteresis[play]"),
    ],
)
def test_models_with_an_exponential(tmp_path: Path, case: str, effect_id: str, real: str) -> None:
    """Where an exponential is called, for each sample or in `prepare`, all bits but its own are NumPy's."""
    done = exponential(tmp_path, case, effect_id, f"-DECCENTRIC_REAL={real}")

    assert (0, True) == (done.returncode, ": ok, " in done.stdout), done.stdout


def test_selftest_sees_a_bad_exponential(tmp_path: Path) -> None:
    """A library whose exponential is off by three units is told so."""
    bad = tmp_path / "bad.h"
    bad.write_text(
        "#include <math.h>\n"
        "static inline double bad(double x) { return exp(x) * (1.0 + 3 * 2.3e-16); }\n"
        "#define exp bad\n"
    )

    done = exponential(tmp_path, "C2", "hidden_thermal_drift", "-include", str(bad))

    assert 1 == done.returncode
    assert "of the library is" in done.stdout
