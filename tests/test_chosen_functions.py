"""A choice of functions comes with the coefficients that they need, and with the bits of the whole model."""

import itertools
from pathlib import Path

import pytest

import eccentric
from benchmarks import cortex_m4
from benchmarks.asked import CODE
from benchmarks.footprint import footprint
from eccentric.core import InputError
from tests.compiled import FLAGS, GENERATED, run
from tests.emitted import CALLS, some_calls
from tests.hosts import REALS, both_reals, need

TORQUE = "mechanical_friction_torque"
BOTH = """#include <stdio.h>
#include <string.h>
#include "c2_parallel.h"
#include "small.h"
int main(void)
{
    unsigned differ = 0;
    for (int k = 0; k < 20000; ++k) {
        const ECCENTRIC_REAL theta = (ECCENTRIC_REAL)(k * 7919 % 20011 - 10000);
        const ECCENTRIC_REAL omega = (ECCENTRIC_REAL)(k * 104729 % 6007 - 3003) / 32;
        const ECCENTRIC_REAL a = c2_parallel_mechanical_friction_torque(theta, omega, &c2_parallel_default);
        const ECCENTRIC_REAL b = small_mechanical_friction_torque(theta, omega, &small_default);
        differ += memcmp(&a, &b, sizeof a) != 0;
    }
    printf("%u", differ);
    return 0;
}
"""


@both_reals
def test_a_function_alone_has_its_bits(tmp_path: Path, real: str) -> None:
    """With fixed parameters the torque alone gives the bits that it gives among all functions."""
    eccentric.emit("c2_parallel", tmp_path / "c", functions=[TORQUE], fixed=True, prefix="small")
    (tmp_path / "both.c").write_text(BOTH)

    run(
        *("gcc", *FLAGS, f"-DECCENTRIC_REAL={real}", f"-I{GENERATED}", f"-I{tmp_path / 'c'}"),
        *(
            "-o",
            tmp_path / "both",
            tmp_path / "both.c",
            GENERATED / "c2_parallel.c",
            tmp_path / "c" / "small.c",
        ),
        "-lm",
    )

    assert "0" == run(tmp_path / "both")


@pytest.mark.parametrize("arrays", [False, True])
def test_the_self_test_is_that_of_the_choice(tmp_path: Path, arrays: bool) -> None:
    """The self-test finds NumPy's bits in what is there; array functions have a header of their own."""
    eccentric.emit("rotating_link", tmp_path, functions=["friction_torque", "voltage"], arrays=arrays)
    header = (tmp_path / "rotating_link.h").read_text()

    assert arrays == (tmp_path / "rotating_link_arrays.h").is_file()
    assert "_n(" not in header
    assert "size_t" not in header
    for real in REALS:
        program = tmp_path / f"selftest_{real}"
        sources = (tmp_path / "check" / "rotating_link_selftest.c", tmp_path / "rotating_link.c")
        run("gcc", *FLAGS, f"-DECCENTRIC_REAL={real}", f"-I{tmp_path}", "-o", program, *sources, "-lm")
        assert "samples of 2 functions" in run(program)


def test_the_torque_alone_is_small(tmp_path: Path) -> None:
    """On a Cortex-M4F it takes no more code, constants and stack than is required."""
    if lacking := cortex_m4.missing():
        pytest.skip(f"not installed: {', '.join(lacking)}")

    found = footprint(tmp_path, TORQUE, "Cortex-M4F")

    assert CODE["text torque alone"].reached(found.text)
    assert CODE["constants torque alone"].reached(found.constants)
    assert CODE["stack torque alone"].reached(found.stack)


def compiler_says(folder: Path, model: str, function: str) -> set[str]:
    """Emit one function in every way, and return what the compiler says of each source."""
    said: set[str] = set()
    needs_inertia = function in {"voltage", "current", "mechanical_residual", "friction_step", "acceleration"}
    for arrays, fixed in ((True, False), (False, False), *([] if needs_inertia else [(False, True)])):
        out = folder / f"{arrays}-{fixed}"
        eccentric.emit(model, out, functions=[function], backend="c99", arrays=arrays, fixed=fixed)
        sources = [out / f"{model}.c", *out.glob("check/*_selftest.c")]
        for real, source in itertools.product(REALS, sources):
            options = (*FLAGS, f"-DECCENTRIC_REAL={real}", f"-I{out}", "-fsyntax-only")
            said.add(run("gcc", *options, source))
    return said


def test_every_way_to_choose_compiles(tmp_path: Path) -> None:
    """One function with fixed parameters, with array functions or without compiles without a warning."""
    need("gcc")

    assert {""} == compiler_says(tmp_path / "with", "c2_asymmetric", "friction_torque_gradient")
    assert {""} == compiler_says(tmp_path / "without", "c1_perpendicular", "breakaway_torque")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("model", "function"),
    sorted(some_calls(CALLS) | some_calls(CALLS, turn=2) | {("c1_perpendicular", "gravity_torque")}),
)
def test_every_function_compiles_alone(tmp_path: Path, model: str, function: str) -> None:
    """The same for every function, each of two models; one that is 0 in case C1 has no coefficients."""
    if function == "gravity_torque" and model.startswith("c1_"):
        with pytest.raises(InputError, match="expected one that depends on a parameter"):
            compiler_says(tmp_path, model, function)
        return
    assert {""} == compiler_says(tmp_path, model, function)


def test_fixed_parameters_must_be_given(tmp_path: Path) -> None:
    """A voltage needs an inertia: without one, C that nobody can give one to is refused."""
    with pytest.raises(InputError, match="fixed: expected a value of J_m and J_l"):
        eccentric.emit("rotating_link", tmp_path / "out", functions=["voltage"], fixed=True)


@pytest.mark.parametrize("wrong", ["mechanical_friction", "friction_torque_n", ""])
def test_unknown_functions_are_refused(tmp_path: Path, wrong: str) -> None:
    """One line lists those that there are; nothing is written."""
    with pytest.raises(InputError, match=rf"functions: expected one of normal_force, .*, got '{wrong}'"):
        eccentric.emit("c2_parallel", tmp_path / "out", functions=[wrong])

    assert not (tmp_path / "out").exists()
