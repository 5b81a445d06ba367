"""The C of a chain: silent under strict warnings in both precisions, with the bits of its NumPy module."""

import ctypes
import subprocess
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.emission import Choice, executed, render
from eccentric.model import Body, Chain, Joint, arm
from eccentric.model import vocabulary as v
from tests.arms import random_chain

STRICT = (
    *("-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wdouble-promotion"),
    *("-Werror", "-shared", "-fPIC"),
)
REAL = {"double": np.float64, "float": np.float32}
rng = np.random.default_rng(11)
ARMS = {
    "one joint": Chain("arm", [Joint()], [Body(1, (0.2, 0, 0))], (0, "-9.81", 0)),
    "a turret, whose first angle is of no account": Chain(
        "arm", [Joint(), Joint(axis=(0, 1, 0))], [Body(2), Body(1, (0.2, 0, 0))]
    ),
    "seven joints at right angles": random_chain(rng, 7, aligned=True, sliding=0, geared=True, rotors=True),
    "five joints, oblique, some slide": random_chain(rng, 5, geared=True),
}


def chosen(precision: str, text: str) -> list[str]:
    """The compiler's option of a precision."""
    return [] if precision == "double" else [f"{text}=float"]


@cache
def emitted(name: str) -> dict[str, str]:
    """The files of an arm."""
    return render(arm(ARMS[name], "An arm"), "a test", "a test")


@pytest.mark.parametrize("precision", REAL)
@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.slow if len(ARMS[name].joints) > 2 else ()) for name in ARMS],
)
def test_c_has_the_bits_of_numpy(name: str, precision: str, tmp_path: Path) -> None:
    """Every result of every function, on motions over several turns."""
    n, real, files = len(ARMS[name].joints), REAL[precision], emitted(name)
    module = executed(files, "arm")
    for file, text in files.items():
        (tmp_path / file).write_text(text, encoding="utf-8")
    option = chosen(precision, "-DECCENTRIC_REAL")
    subprocess.run(["gcc", *STRICT, *option, "arm.c", "-o", "arm.so", "-lm"], check=True, cwd=tmp_path)
    library = ctypes.CDLL(str(tmp_path / "arm.so"))
    # Prepared, as in Python: those of `arm_default` are rounded once, and may differ in the last place.
    coefficients = ctypes.create_string_buffer(1 << 16)  # larger than any arm's
    given = ctypes.byref(ctypes.c_char.in_dll(library, f"arm_default_parameters_{precision}"))
    assert getattr(library, f"arm_prepare_{precision}")(given, coefficients) == 0
    motion = [rng.normal(size=(20, n)).astype(real) * real(scale) for scale in (6, 3, 5)]

    for function in (name for name in module.__all__ if name.islower()):
        labels, given = getattr(module, function.upper()), motion
        if function in {"gravity_torque", "breakaway_torque", "mass_matrix"}:
            given = motion[:1]
        found = np.full((20, len(labels)), np.nan, real)
        for k in range(20):
            rows = [np.ascontiguousarray(x[k]) for x in (*given, found)]
            getattr(library, f"arm_{function}_{precision}")(
                *(row.ctypes.data_as(ctypes.c_void_p) for row in rows), coefficients
            )
            found[k] = rows[-1]

        assert np.array_equal(getattr(module, function)(*given), found, equal_nan=True), function


def test_c_without_a_coefficient_is_refused() -> None:
    """The inverse dynamics of a slide depends on no parameter and no angle: C has no empty structure."""
    slide = arm(Chain("slide", [Joint("prismatic")], [Body(1)]), "A slide")
    choice = Choice(("inverse_dynamics",), "none")

    with pytest.raises(InputError, match="slide: expected a function of an angle or a parameter for C"):
        render(slide, "a test", "a test", choice=choice)
    assert "slide.py" in render(slide, "a test", "a test", ("numpy",), choice=choice)


def test_a_payload_is_prepared(tmp_path: Path) -> None:
    """A chain with a letter has parameters and `prepare`, and is as silent."""
    base = random_chain(np.random.default_rng(12), 2, aligned=True)
    chain = Chain("arm", base.joints, base.bodies, payload=Body(v.M.symbol, (0, 0, "0.1")), parameters=(v.M,))
    for file, text in render(arm(chain, "An arm"), "a test", "a test").items():
        (tmp_path / file).write_text(text, encoding="utf-8")

    subprocess.run(["gcc", *STRICT, "arm.c", "-o", "arm.so", "-lm"], check=True, cwd=tmp_path)

    assert "arm_prepare" in (tmp_path / "arm.h").read_text(encoding="utf-8")
