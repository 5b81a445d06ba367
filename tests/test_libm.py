"""With ECCENTRIC_LIBM sine and cosine are the library's: all bounds in the header hold, too."""

from pathlib import Path

import numpy as np
import pytest

from tests import accelerated, accuracy, oracle
from tests.compiled import FLAGS, GENERATED, REAL, Library, Real, run
from tests.emitted import PRECISIONS, labels
from tests.promised import given, gradient_error
from tests.random_drives import FUNCTIONS
from tests.test_accuracy import bound, letters

LIBM = "-DECCENTRIC_LIBM"
SIZE = 80  # states of each set
DRIVES = ("mu = 1/5", "mu = 1/30", "much unbalance")


@pytest.mark.parametrize(
    ("name", "dtype"),
    [
        pytest.param(one, dtype, id=f"{one}-{precision}", marks=() if precision == few else pytest.mark.slow)
        for one, few in (("c1_perpendicular", "double"), ("c2_parallel", ""))
        for precision, dtype in PRECISIONS.items()
    ],
)
def test_steady(name: str, dtype: Real, tmp_path: Path) -> None:
    """F_N, friction and its derivatives keep their bounds, held to 50 digits."""
    library = Library(name, dtype, tmp_path, LIBM)
    for drive in DRIVES:
        p, coefficients = oracle.exact(letters(drive)), library.coefficients(given(name, letters(drive)))
        for at in accuracy.sets(p, dtype, SIZE):
            states = [getattr(at, one) for one in oracle.inputs(name, "friction_torque")]
            found = {f: library.many(f, states, coefficients) for f in FUNCTIONS}
            slopes = accuracy.gradient(name, at, p)
            wanted = [slopes[one] for one in labels(name, "friction_torque_gradient")]
            worst = {
                "friction_torque_gradient": gradient_error(found.pop("friction_torque_gradient"), wanted)
            }
            columns = accuracy.jacobian(name, at, p, labels(name, "friction_torque_jacobian"))
            for function, actual in found.items():
                vector = actual.ndim > 1
                exact = columns if vector else [getattr(accuracy, function)(name, at, p)]
                pairs = zip(np.atleast_2d(actual.T), exact, strict=True)
                worst[function] = np.max([accuracy.units(*pair) for pair in pairs])
            for function, error in worst.items():
                assert error <= bound(name, function, drive), (function, drive, at.name)


@pytest.mark.parametrize(
    ("phi", "dtype"),
    [
        pytest.param(one, dtype, id=f"{one}-{precision}", marks=pytest.mark.slow)
        for one in (0.0, 0.75)
        for precision, dtype in PRECISIONS.items()
    ],
)
def test_accelerated(phi: float, dtype: Real, tmp_path: Path) -> None:
    """With an acceleration, in a tilted plane, they are within the eps that the header states."""
    name = accelerated.NAME
    library = Library(name, dtype, tmp_path, LIBM)
    for drive in DRIVES:
        values = letters(drive) | {"phi": phi}
        p, coefficients = oracle.exact(values), library.coefficients(given(name, values))
        for make in (accelerated.at_any_scale, accelerated.near_no_load):
            at, alpha_m = make(p, dtype, SIZE)
            for function, exact in accelerated.exact(at, alpha_m, p).items():
                actual = library.many(function, [at.theta_m, at.omega_m, alpha_m], coefficients)
                for pair in zip(np.atleast_2d(actual.T), exact, strict=True):
                    assert np.max(accuracy.relative(*pair)) <= bound(name, function, drive), (function, drive)


@pytest.mark.parametrize(
    ("name", "dtype"),
    [
        pytest.param(one, dtype, id=f"{one}-{precision}", marks=() if precision == few else pytest.mark.slow)
        for one, few in (("c2_parallel", "single"), ("rotating_link", "double"))
        for precision, dtype in PRECISIONS.items()
    ],
)
def test_the_library_is_called(name: str, dtype: Real, tmp_path: Path) -> None:
    """The object needs sine and cosine of its precision."""
    source, model = GENERATED / f"{name}.c", tmp_path / "model.o"
    run("gcc", *FLAGS, LIBM, f"-DECCENTRIC_REAL={REAL[dtype]}", "-fno-builtin", "-c", source, "-o", model)
    undefined = {line.split()[-1] for line in run("nm", "-u", model).splitlines()}

    assert ({"sinf", "cosf"} if dtype is np.float32 else {"sin", "cos"}) <= undefined
