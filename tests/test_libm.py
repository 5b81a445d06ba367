"""With ECCENTRIC_LIBM sine and cosine are the library's: the bounds of friction in the header hold, too."""

from pathlib import Path

import numpy as np
import pytest

from eccentric.emit.accuracy import ACCELERATED_EPS, FRICTION_TORQUE_ULP
from tests import accuracy, oracle
from tests.compiled import FLAGS, GENERATED, REAL, Library, Real, run
from tests.emitted import both_precisions, module

LIBM = "-DECCENTRIC_LIBM"
SIZE = 300  # states of each set
TILT = 0.75  # rad


@both_precisions
@pytest.mark.parametrize("name", ["c1_perpendicular", "c2_parallel"])
def test_steady(name: str, dtype: Real, tmp_path: Path) -> None:
    """Friction of Table 1 is within the units of the last place that the header states, of 50 digits."""
    library, p = Library(name, dtype, tmp_path, LIBM), accuracy.decimals()
    for at in accuracy.sets(p, dtype, SIZE):
        states = [getattr(at, one) for one in oracle.inputs(name, "friction_torque")]
        actual = library.many("friction_torque", states, library.coefficients())
        worst = np.max(accuracy.units(actual, accuracy.friction_torque(name, at, p)))
        assert worst <= FRICTION_TORQUE_ULP, at.name


@both_precisions
def test_accelerated(dtype: Real, tmp_path: Path) -> None:
    """With an acceleration, in a tilted plane, it is within the eps of a friction that the header states."""
    name = "rotating_link"
    library, law = Library(name, dtype, tmp_path, LIBM), oracle.CASES[name].friction_torque
    given = module(name).Parameters(phi=TILT)
    decimals = accuracy.decimals()
    p = oracle.exact({letter: float(value) for letter, value in vars(decimals).items()} | {"phi": TILT})
    alpha_m = np.random.default_rng(2).uniform(-500, 500, SIZE).astype(dtype)
    for at in accuracy.sets(p, dtype, SIZE):
        actual = library.many(
            "friction_torque", [at.theta_m, at.omega_m, alpha_m], library.coefficients(given)
        )
        exact = [
            (law(x, p), abs(oracle.friction_under_load(name, size, x.omega_m, p)))
            for x, size in accuracy.accelerated(at, alpha_m, p)
        ]
        assert np.max(accuracy.relative(actual, exact)) <= ACCELERATED_EPS, at.name


@both_precisions
@pytest.mark.parametrize("name", ["c2_parallel", "rotating_link"])
def test_the_library_is_called(name: str, dtype: Real, tmp_path: Path) -> None:
    """The object needs sine and cosine of its precision."""
    source, model = GENERATED / f"{name}.c", tmp_path / "model.o"
    run("gcc", *FLAGS, LIBM, f"-DECCENTRIC_REAL={REAL[dtype]}", "-fno-builtin", "-c", source, "-o", model)
    undefined = {line.split()[-1] for line in run("nm", "-u", model).splitlines()}

    assert ({"sinf", "cosf"} if dtype is np.float32 else {"sin", "cos"}) <= undefined
