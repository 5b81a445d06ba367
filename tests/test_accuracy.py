"""The bounds that emitted headers state, measured against 50 digits; full sets: benchmarks/accuracy.py."""

import dataclasses
import re
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from mpmath import mpf

from eccentric.emit.accuracy import ACCELERATED_EPS, FRICTION_TORQUE_ULP, GRADIENT_EPS, NORMAL_FORCE_ULP
from tests import accelerated, accuracy, oracle
from tests.compiled import GENERATED, Library, Real
from tests.emitted import both_precisions, module
from tests.paper import Parameters

SIZE, FEW = 5000, 300  # states of each set, with the default parameters and with others
DERIVATIVES = ("friction_torque_jacobian", "friction_torque_gradient")
STEADY = ("c1_perpendicular", "c1_asymmetric", "c2_parallel", "c2_asymmetric")
# Table 1 with both of its gears, no gear, gears up, and links of little and of much unbalance.
DRIVES: dict[str, dict[str, str]] = {
    "mu = 1/5": {},
    "mu = 1/30": {"mu": "1/30"},
    "mu = 1": {"mu": "1"},
    "mu = 3": {"mu": "3"},
    "mu = 5": {"mu": "5"},
    "much unbalance": {"mu": "0.37", "M": "3.3", "L": "0.11", "g": "1.62"},
    "little unbalance": {"M": "0.013", "M_l": "7.1", "L": "1.7", "mu": "0.83"},
    # Both precisions have this one's critical velocity, 4 rad/s: in the hollow nothing but the angle is left.
    "exact velocity": {"M": "0.5", "M_l": "0.5", "L": "0.5", "mu": "1.25", "g": "6.25"},
}
every_drive = pytest.mark.parametrize("drive", DRIVES)


def drive_parameters(name: str, drive: str) -> tuple[Any, Parameters]:
    """Return a drive as the emitted Parameters, in double, and at 50 digits what these are exactly."""
    values = {letter: float(value) for letter, value in vars(accuracy.decimals(**DRIVES[drive])).items()}
    for letter in ("B_lN", "C_lN", "B_lT", "C_lT", "B_m", "C_m"):
        values |= {f"{letter}_pos": values[letter], f"{letter}_neg": 1.25 * values[letter]}
    cls = module(name).Parameters
    return cls(**{f.name: values[f.name] for f in dataclasses.fields(cls) if f.name in values}), oracle.exact(
        values
    )


def arguments(name: str, function: str, at: accuracy.Set) -> list[np.ndarray]:
    """Return the inputs of a steady model's function."""
    return [getattr(at, one) for one in oracle.inputs(name, function)]


@both_precisions
@every_drive
@pytest.mark.parametrize("name", STEADY)
def test_normal_force(name: str, drive: str, dtype: Real) -> None:
    """F_N is right to its last places: whole plane, in the hollow, at large angles, any parameters."""
    given, p = drive_parameters(name, drive)
    for at in accuracy.sets(p, dtype, FEW):
        actual = np.asarray(module(name).normal_force(*arguments(name, "normal_force", at), given))
        worst = np.max(accuracy.units(actual, accuracy.normal_force(name, at, p)))
        assert worst <= NORMAL_FORCE_ULP, at.name


@both_precisions
@every_drive
def test_beside_every_top(drive: str, dtype: Real) -> None:
    """F_N is right to its last places at the angles nearest to every top of the link, up to 1e4 rad."""
    given, p = drive_parameters("c2_parallel", drive)
    at = accuracy.beside_the_tops(p, dtype)
    actual = np.asarray(module("c2_parallel").normal_force(at.theta_m, at.omega_m, given))

    assert np.max(accuracy.units(actual, accuracy.normal_force("c2_parallel", at, p))) <= NORMAL_FORCE_ULP


@both_precisions
@pytest.mark.parametrize("name", ["c1_perpendicular", "c2_parallel"])
def test_default_coefficients(name: str, dtype: Real, tmp_path: Any) -> None:
    """The emitted constants are those of Table 1's decimals: nothing is lost to a parameter in double."""
    library, p = Library(name, dtype, tmp_path), accuracy.decimals()
    for at in accuracy.sets(p, dtype, SIZE):
        states = arguments(name, "normal_force", at)
        actual = library.many("normal_force", states, library.coefficients())
        worst = np.max(accuracy.units(actual, accuracy.normal_force(name, at, p)))
        assert worst <= NORMAL_FORCE_ULP, at.name


@pytest.mark.parametrize(
    ("dtype", "part"),
    [
        (np.float32, "omega_star_2"), (np.float32, "period_2"), (np.float32, "period_3"),
        (np.float32, "period_4"), (np.float32, "period_5"), (np.float64, "omega_star_2"),
        (np.float64, "period_2"), (np.float64, "period_3"),
    ],
)  # fmt: skip
def test_every_part_of_the_constants_is_needed(dtype: Real, part: str, tmp_path: Any) -> None:
    """Without the low part of the critical velocity, or a part of the period, the bound is missed."""
    library, p = Library("c2_parallel", dtype, tmp_path), accuracy.decimals()
    without = library.ffi.new("c2_parallel_coefficients *", library.coefficients()[0])
    setattr(without, part, 0.0)
    at = accuracy.beside_the_tops(p, dtype)
    actual = library.many("normal_force", [at.theta_m, at.omega_m], without)
    worst = np.max(accuracy.units(actual, accuracy.normal_force("c2_parallel", at, p)))

    assert worst > NORMAL_FORCE_ULP


@both_precisions
@every_drive
@pytest.mark.parametrize("name", STEADY)
def test_friction_torque(name: str, drive: str, dtype: Real) -> None:
    """Friction, with the back EMF or without, sums terms of one sign and loses little on top of F_N."""
    given, p = drive_parameters(name, drive)
    for at in accuracy.sets(p, dtype, FEW):
        for function in ("friction_torque", "mechanical_friction_torque"):
            actual = np.asarray(getattr(module(name), function)(*arguments(name, function, at), given))
            worst = np.max(accuracy.units(actual, getattr(accuracy, function)(name, at, p)))
            assert worst <= FRICTION_TORQUE_ULP, (function, at.name)


@both_precisions
@every_drive
@pytest.mark.parametrize("name", STEADY)
def test_derivatives_by_coefficients(name: str, drive: str, dtype: Real) -> None:
    """What a coefficient of friction multiplies is as exact as friction itself."""
    given, p = drive_parameters(name, drive)
    for at in accuracy.sets(p, dtype, FEW):
        jacobian = module(name).friction_torque_jacobian(*arguments(name, "friction_torque", at), given)
        exact = accuracy.jacobian(name, at, p, module(name).JACOBIAN)
        for actual, column in zip(np.moveaxis(jacobian, -1, 0), exact, strict=True):
            assert np.max(accuracy.units(actual, column)) <= FRICTION_TORQUE_ULP, at.name


@both_precisions
@every_drive
@pytest.mark.parametrize("name", STEADY)
def test_derivatives_by_state(name: str, drive: str, dtype: Real) -> None:
    """They are right to some eps of the most they are at that speed; without gravity to the last places."""
    given, p = drive_parameters(name, drive)
    for at in accuracy.sets(p, dtype, FEW):
        gradient = module(name).friction_torque_gradient(*arguments(name, "friction_torque", at), given)
        exact = accuracy.gradient(name, at, p)
        assert_gradient(gradient, [exact[label] for label in module(name).GRADIENT], at.name)


def assert_gradient(
    actual: np.ndarray, exact: list[list[tuple[mpf, mpf]]], at: str, bound: int = GRADIENT_EPS
) -> None:
    """Hold a gradient against its bound; without the angle in it, the size is the slope, and units count."""
    for got, slopes in zip(np.moveaxis(actual, -1, 0), exact, strict=True):
        assert np.max(accuracy.relative(got, slopes)) <= bound, at
        if len(exact) == 1:
            assert np.max(accuracy.units(got, [slope for slope, _ in slopes])) <= FRICTION_TORQUE_ULP, at


@both_precisions
@every_drive
@pytest.mark.parametrize("phi", [0.0, 0.75, 1.5])
def test_accelerated(drive: str, phi: float, dtype: Real) -> None:
    """With an acceleration F_N vanishes along a curve: its error is a few eps of what it is made of.

    Those of friction and of what its coefficients multiply are as many eps of the same under that load;
    those of the slopes, which need the direction of F_N, of their greatest values times that load over F_N.
    """
    given, p = drive_parameters(accelerated.NAME, drive)
    given, p.phi = dataclasses.replace(given, phi=phi), mpf(phi)
    alpha_m = np.random.default_rng(2).uniform(-500, 500, FEW).astype(dtype)
    anywhere = [(at, alpha_m) for at in accuracy.sets(p, dtype, FEW)]
    for at, alpha in (*anywhere, accelerated.near_no_load(p, dtype, FEW)):
        for function in ("normal_force", "friction_torque", "mechanical_friction_torque", *DERIVATIVES):
            exact = accelerated.exact(function, at, alpha, p)
            actual = getattr(module(accelerated.NAME), function)(at.theta_m, at.omega_m, alpha, given)
            for got, wanted in zip(np.atleast_2d(actual.T), exact, strict=True):
                assert np.max(accuracy.relative(got, wanted)) <= ACCELERATED_EPS, (function, at.name)


@pytest.mark.parametrize("name", [*STEADY, "rotating_link"])
def test_the_header_states_the_bounds(name: str) -> None:
    """What is measured here is what the header promises, and nothing else is promised there."""
    ulp = f"within {FRICTION_TORQUE_ULP} units in the last place"
    greatest = f"within {GRADIENT_EPS} eps of its greatest value at that speed, any angle"
    friction = "friction_torque, mechanical_friction_torque"
    bounds = [
        f"normal_force within {NORMAL_FORCE_ULP} units in the last place"
        + " (proved for parameters and speeds of 1e-6 to 1e6)" * name.startswith("c1_"),
        f"{friction}, friction_torque_jacobian {ulp}",
        f"friction_torque_gradient {ulp if name.startswith('c1_') else greatest}",
    ]
    if name == accelerated.NAME:
        within = f"within {ACCELERATED_EPS} eps"
        anywhere = "its greatest value, any direction of F_N, times that load over F_N"
        bounds = [
            f"normal_force {within} (M L (omega_l^2 + |alpha_l|) + weight)",
            f"{friction}, friction_torque_jacobian {within} of what they are at that load",
            f"friction_torque_gradient {within} of {anywhere}",
        ]
    header = (GENERATED / f"{name}.h").read_text(encoding="utf-8")
    steepest = max(Fraction(changed.get("mu", 0)) for changed in DRIVES.values())
    reach = "" if name.startswith("c1_") else f", |theta_m| to {accuracy.FAR[-1]:.0f} rad, mu to {steepest}"

    stated, told = re.findall(r"parameters as exact(.*):\n((?: \*   .*\n)+)", header)[0]
    assert (reach, bounds) == (stated, [line.strip(" *") for line in told.splitlines()])
