"""What the self-test of the emitted C detects and reports: the function, its inputs, both values."""

import re
import struct
import subprocess
from pathlib import Path

import numpy as np
import pytest
from mpmath import mpf

from benchmarks.cortex_m4 import GENERATED, TOOLS, build, emulate, missing, run
from tests import accuracy, oracle, paper
from tests.hosts import CHECK, REALS, both_reals, need, on_host

DTYPE = {"float": np.float32, "double": np.float64}
WORD = {"float": np.uint32, "double": np.uint64}
GRAVITY = "return (-c->L_M_g_mu2) * chord * half_sine"
TRIPLED = GRAVITY.replace("chord", "chord * REAL(-3.0)")


def changed(folder: Path, old: str, new: str) -> Path:
    """Write the source of case C2 with one text replaced, which occurs there once."""
    text = (GENERATED / "c2_parallel.c").read_text(encoding="utf-8")
    assert 1 == text.count(old), old
    (folder / "changed.c").write_text(text.replace(old, new), encoding="utf-8")
    return folder / "changed.c"


def failed(
    folder: Path, real: str, source: Path | None, *compiler: str, check: Path = CHECK
) -> tuple[str, dict[str, float]]:
    """Return what the self-test, which must fail, says of a source: what deviates, and values by name."""
    program = on_host(folder, "c2_parallel", compiler or ("gcc",), real, source, check)
    done = subprocess.run([program], capture_output=True, text=True, check=False)
    assert 1 == done.returncode
    return told(done.stdout)


def told(said: str) -> tuple[str, dict[str, float]]:
    """Return what deviates, and the values by name; each decimal is that of its bits to the sixth digit."""
    first, *lines = said.splitlines()
    values = {}
    for line in lines:
        ((name, bits, decimal),) = re.findall(r"^  (\w+) 0x([0-9a-f]+) (\S+)$", line)
        (values[name],) = struct.unpack({8: ">f", 16: ">d"}[len(bits)], bytes.fromhex(bits))
        assert [values[name]] == pytest.approx([float(decimal)], rel=1e-5, nan_ok=True), line
    return first, values


@pytest.mark.parametrize("real", ["float", pytest.param("double", marks=pytest.mark.slow)])
def test_a_failure(tmp_path: Path, real: str) -> None:
    """Told are the function, its own inputs, what came and what was required: the paper's value."""
    said, values = failed(tmp_path, real, changed(tmp_path, GRAVITY, TRIPLED))

    assert "c2_parallel: gravity_torque, value 0" == said
    assert_gravity(values, real)
    assert [-3 * values["required"]] == pytest.approx([values["came"]], rel=1e-6)


def assert_gravity(values: dict[str, float], real: str) -> None:
    """Assert that the inputs are those of the gravity torque, and that its value is required of it."""
    assert ["theta_m", "came", "required"] == list(values)
    exact = paper.gravity_torque(mpf(values["theta_m"]), accuracy.decimals())
    rounding = oracle.K * float(np.finfo(DTYPE[real]).eps)
    assert [float(exact)] == pytest.approx([values["required"]], rel=rounding, abs=rounding)


@pytest.mark.parametrize("real", [pytest.param("float", marks=pytest.mark.slow), "double"])
def test_an_array_function_that_writes_beside(tmp_path: Path, real: str) -> None:
    """An array function that forgets where its block begins is named, with the inputs of the sample."""
    line = "out[first + k] = c2_parallel_gravity_torque_at("

    said, values = failed(tmp_path, real, changed(tmp_path, line, line.replace("first + ", "")))

    assert "c2_parallel: gravity_torque_n, value 0" == said
    assert_gravity(values, real)
    assert values["came"] != values["required"]


@pytest.mark.parametrize(
    ("coefficient", "real"),
    [
        pytest.param(coefficient, real, marks=() if real == few else pytest.mark.slow)
        for coefficient, few in (("omega_star_1", "double"), ("period_2", ""), ("L_M_g_mu2", ""))
        for real in REALS
    ],
)
def test_a_changed_constant(tmp_path: Path, coefficient: str, real: str) -> None:
    """A constant of the default set that is off in its last digit fails, and is named."""
    text = (GENERATED / "c2_parallel.c").read_text(encoding="utf-8")
    line = re.findall(rf"^    \.{coefficient} = .*$", text, re.MULTILINE)[REALS.index(real)]
    (decimal,) = re.findall(r"\d[-+.e\d]+", line.partition("=")[2])
    value = DTYPE[real](decimal)
    above = float(np.nextafter(value, DTYPE[real](np.inf)))

    said, values = failed(tmp_path, real, changed(tmp_path, line, line.replace(decimal, repr(above))))

    assert f"c2_parallel: c2_parallel_default.{coefficient}" == said
    assert {"came": above, "required": float(value)} == values


@pytest.mark.parametrize("real", ["float", pytest.param("double", marks=pytest.mark.slow)])
def test_a_changed_digit(tmp_path: Path, real: str) -> None:
    """A polynomial coefficient that is off in its last digit fails."""
    text = (GENERATED / "c2_parallel.c").read_text(encoding="utf-8")
    digits = re.findall(r"REAL\((-1\.66666\d+)e-1\)", text)[REALS.index(real)]

    said, _ = failed(tmp_path, real, changed(tmp_path, digits, digits[:-2] + "00"))

    assert re.fullmatch(r"c2_parallel: \w+, value \d", said)


@pytest.mark.parametrize(
    ("place", "function", "row", "real"),
    [
        pytest.param(
            *(place, function, row, real),
            id=f"{place}-{function}-{name}-{real}",
            marks=() if (name, real) == few else pytest.mark.slow,
        )
        for place, function, few in (
            (7, "acceleration", ("first", "float")),
            (-1, "voltage", ("last", "double")),
        )
        for name, row in (("first", 0), ("last", -1))
        for real in REALS
    ],
)
def test_a_changed_vector(tmp_path: Path, place: int, function: str, row: int, real: str) -> None:
    """The first and the last vector count, from the value of the first function to that of the last."""
    text = (CHECK / "c2_parallel_vectors.h").read_text(encoding="utf-8")
    table = re.findall(r"(?<=vectors\[VECTORS\]\[NUMBERS\] = \{\n).*?(?=\n\};)", text, re.DOTALL)[
        REALS.index(real)
    ]
    line = table.splitlines()[row]
    words = np.array([int(word, 16) for word in line.strip(" {},").split(", ")], WORD[real])
    values = words.view(DTYPE[real])
    values[place] *= -1
    changed = line.replace(line.strip(), f"{{{', '.join(map(hex, words.tolist()))}}},")
    (tmp_path / "c2_parallel_vectors.h").write_text(
        text.replace(table, table.replace(line, changed)), encoding="utf-8"
    )
    (tmp_path / "c2_parallel_selftest.c").write_bytes((CHECK / "c2_parallel_selftest.c").read_bytes())

    said, named = failed(tmp_path, real, None, check=tmp_path)

    assert (f"c2_parallel: {function}, value 0", values[place]) == (said, named["required"])


def test_contraction(tmp_path: Path) -> None:
    """A compiler that fuses products and sums all the same has other bits, and the self-test says so."""
    fusing = ("gcc", "-O2", "-mfma", "-ffp-contract=fast", "-Wno-unknown-pragmas")
    need(*fusing)

    said, values = failed(
        tmp_path,
        "float",
        changed(tmp_path, '#pragma GCC optimize("fp-contract=off"', '#pragma unknown(""'),
        *fusing,
    )

    assert said.startswith("c2_parallel: ")
    assert "came" in values or "digest" in said


DECIMALS = {
    "0.0": "0.00000e0", "1.0": "1.00000e0", "-2.5e-3": "-2.50000e-3", "31415926.0": "3.14159e7",
    "9.999999e9": "1.00000e10", "-1e-30": "-1.00000e-30", "3e38": "3.00000e38",
    "1.0 / zero": "inf", "-1.0 / zero": "-inf", "zero / zero": "nan",
}  # fmt: skip


@both_reals
def test_decimals(tmp_path: Path, real: str) -> None:
    """Six digits of any number are printed."""
    program = tmp_path / "print.c"
    calls = "".join(f'    print_value("x", (real)({value}));\n' for value in DECIMALS)
    program.write_text(
        '#define main selftest\n#include "c2_parallel_selftest.c"\n#undef main\n'
        f"int main(void)\n{{\n    volatile double zero = 0.0;\n{calls}    return 0;\n}}\n",
        encoding="utf-8",
    )
    options = [f"-I{GENERATED}", f"-I{CHECK}", f"-DECCENTRIC_REAL={real}"]
    run("gcc", "-std=c99", *options, "-o", tmp_path / "print", program, GENERATED / "c2_parallel.c", "-lm")

    assert list(DECIMALS.values()) == [line.split()[-1] for line in run(tmp_path / "print").splitlines()]


def test_a_small_library_prints_them(tmp_path: Path) -> None:
    """On a Cortex-M4F with newlib-nano, whose printf knows no floating point, a failure reads the same."""
    if absent := missing(TOOLS):
        pytest.skip(f"not installed: {', '.join(absent)}")
    source = changed(tmp_path, GRAVITY, TRIPLED)
    options = ["-O2", "-DECCENTRIC_REAL=float", "--specs=nano.specs"]
    elf = build(tmp_path / "nano.elf", [CHECK / "c2_parallel_selftest.c", source], options)

    status, said = emulate(elf)

    assert (1, *failed(tmp_path, "float", source)) == (status, *told(said))
