"""The self-test of the emitted C: every compiler of the host has the bits of NumPy, sanitizers included."""

import re
import subprocess
from pathlib import Path

import pytest

from benchmarks.cortex_m4 import GENERATED, run
from eccentric.emission import render_check
from tests import extended
from tests.compiled import FLAGS
from tests.emitted import MODELS, every_model, quick
from tests.hosts import CHECK, HOSTS, REALS, need, on_host

FEW = {
    ("c1_asymmetric", "gcc-sanitized"),
    ("c2_parallel", "gcc-O3-avx2"),
    ("rotating_link", "clang"),
}
"""What `make test` has: each compiler, the sanitizers and vector instructions once."""


@pytest.mark.parametrize(
    ("name", "compiler", "real"),
    [
        pytest.param(
            *(name, compiler, REALS[(j + k) % 2]),
            id=f"{name}-{host}",
            marks=() if (name, host) in FEW else pytest.mark.slow,
        )
        for j, name in enumerate(MODELS)
        for k, (host, compiler) in enumerate(HOSTS.items())
    ],
)
def test_same_bits_on_hosts(tmp_path: Path, name: str, compiler: tuple[str, ...], real: str) -> None:
    """NumPy's bits, the precisions by turns, from every compiler, without a word of the sanitizers'."""
    need(*compiler)

    assert f"{name}: ok" in run(on_host(tmp_path, name, compiler, real))


@every_model
def test_every_function_is_tested(name: str) -> None:
    """The self-test calls all that the header declares, array functions as well, and reads the constants."""
    header, test = (
        path.read_text(encoding="utf-8") for path in (GENERATED / f"{name}.h", CHECK / f"{name}_selftest.c")
    )
    declared = set(re.findall(rf"^(?:void|int|ECCENTRIC_REAL) ({name}_\w+)\(", header, re.MULTILINE))
    constants = set(re.findall(rf"^extern const \w+ ({name}_\w+);", header, re.MULTILINE))

    assert declared == set(re.findall(rf"\b({name}_\w+)\(", test))
    assert constants <= set(re.findall(rf"\b{name}_\w+", test))


@pytest.mark.parametrize("name", ["c2_parallel", "c2_asymmetric", "rotating_link"])
def test_arrays_end_within_a_block(name: str) -> None:
    """The arrays are a whole block of the array functions, and of the next one a part that is odd."""
    source, vectors = (
        path.read_text(encoding="utf-8") for path in (GENERATED / f"{name}.c", CHECK / f"{name}_vectors.h")
    )
    (block,) = map(int, re.findall(r"#define REAL_BLOCK (\d+)u", source))
    (array,) = map(int, re.findall(r"#define ARRAY (\d+)u", vectors))

    assert block < array
    assert 1 == array % block % 2


def exponential(folder: Path, case: str, effect_id: str, *options: str) -> subprocess.CompletedProcess[str]:
    """Compile and run the self-test of an extended model that includes its own source."""
    one = extended.with_effect(case, effect_id)
    for file, text in (one.texts | render_check(one.model, one.texts)).items():
        (folder / file).parent.mkdir(exist_ok=True)
        (folder / file).write_text(text, encoding="utf-8")
    test = folder / "check" / f"{one.model.name}_selftest.c"
    run("gcc", *FLAGS, f"-I{folder}", "-o", folder / "test", test, *options, "-lm")
    return subprocess.run([folder / "test"], capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    ("case", "effect_id", "real"),
    quick(
        [
            (case, effect_id, real)
            for case, effect_id in (
                ("C2", "hidden_thermal_drift"),
                ("C2", "load_dependent[progressive]"),
                ("C2", "stribeck_load[F_N]"),
                ("C1", "sensor_delay"),
                ("C1", "magnetic_hysteresis[play]"),
            )
            for real in REALS
        ],
        {("C2", "hidden_thermal_drift", "float"), ("C1", "sensor_delay", "double")},
    ),
)
def test_models_with_an_exponential(tmp_path: Path, case: str, effect_id: str, real: str) -> None:
    """Where an exponential is called, for each sample or in `prepare`, all bits but its own are NumPy's."""
    done = exponential(tmp_path, case, effect_id, f"-DECCENTRIC_REAL={real}")

    assert (0, True) == (done.returncode, ": ok, " in done.stdout), done.stdout


def test_a_bad_exponential_is_seen(tmp_path: Path) -> None:
    """A library whose exponential is off by three units is reported."""
    bad = tmp_path / "bad.h"
    bad.write_text(
        "#include <math.h>\n"
        "static inline double bad(double x) { return exp(x) * (1.0 + 3 * 2.3e-16); }\n"
        "#define exp bad\n"
    )

    done = exponential(tmp_path, "C2", "hidden_thermal_drift", "-include", str(bad))

    assert 1 == done.returncode
    assert "exp of the library is" in done.stdout
