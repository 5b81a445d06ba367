"""The bounds that emitted headers state, measured against 50 digits; full sets: benchmarks/accuracy.py."""

import dataclasses
from typing import Any

import numpy as np
import pytest

from eccentric.emit.accuracy import ACCELERATED_EPS, FRICTION_TORQUE_ULP, GRADIENT_EPS, NORMAL_FORCE_ULP
from tests import accuracy, extended, oracle
from tests.compiled import GENERATED, Library, Real
from tests.emitted import both_precisions, module
from tests.paper import Parameters

SIZE, FEW = 5000, 300  # states of each set, with the default parameters and with others
STEADY = ("c1_perpendicular", "c1_asymmetric", "c2_parallel", "c2_asymmetric")
# Table 1 with both of its gears, no gear, and links of little and of much unbalance.
DRIVES: dict[str, dict[str, str]] = {
    "mu = 1/5": {},
    "mu = 1/30": {"mu": "1/30"},
    "mu = 1": {"mu": "1"},
    "much unbalance": {"mu": "0.37", "M": "3.3", "L": "0.11", "g": "1.62"},
    "little unbalance": {"M": "0.013", "M_l": "7.1", "L": "1.7", "mu": "0.83"},
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
        (np.float32, "period_4"), (np.float64, "omega_star_2"), (np.float64, "period_2"),
        (np.float64, "period_3"),
    ],
)  # fmt: skip
def test_every_part_of_the_constants_is_needed(dtype: Real, part: str, tmp_path: Any) -> None:
    """Without the low part of the critical velocity, or a part of the period, the bound is missed."""
    library, p = Library("c2_parallel", dtype, tmp_path), accuracy.decimals()
    without = library.ffi.new("c2_parallel_coefficients *", library.coefficients()[0])
    setattr(without, part, 0.0)
    worst = 0.0
    for at in accuracy.sets(p, dtype, SIZE):
        actual = library.many("normal_force", [at.theta_m, at.omega_m], without)
        worst = max(worst, np.max(accuracy.units(actual, accuracy.normal_force("c2_parallel", at, p))))

    assert worst > NORMAL_FORCE_ULP


@both_precisions
@every_drive
@pytest.mark.parametrize("name", STEADY)
def test_friction_torque(name: str, drive: str, dtype: Real) -> None:
    """Friction is a sum of terms of one sign and loses little on top of F_N."""
    given, p = drive_parameters(name, drive)
    for at in accuracy.sets(p, dtype, FEW):
        actual = np.asarray(module(name).friction_torque(*arguments(name, "friction_torque", at), given))
        worst = np.max(accuracy.units(actual, accuracy.friction_torque(name, at, p)))
        assert worst <= FRICTION_TORQUE_ULP, at.name


@both_precisions
@every_drive
def test_derivatives(drive: str, dtype: Real) -> None:
    """The derivatives are right to some eps of what they are at most at that speed, in the hollow, too."""
    given, p = drive_parameters("c2_parallel", drive)
    for at in accuracy.sets(p, dtype, FEW):
        actual = module("c2_parallel").friction_torque_gradient(at.theta_m, at.omega_m, given)
        for k, exact in enumerate(zip(*accuracy.gradient(at, p), strict=True)):
            assert np.max(accuracy.relative(actual[:, k], list(exact))) <= GRADIENT_EPS, at.name


@both_precisions
@every_drive
@pytest.mark.parametrize("phi", [0.0, 0.75])
def test_accelerated_normal_force(drive: str, phi: float, dtype: Real) -> None:
    """With an acceleration F_N vanishes along a curve: its error is a few eps of what it is made of."""
    given, p = drive_parameters("rotating_link", drive)
    given, p.phi = dataclasses.replace(given, phi=phi), oracle.mpf(phi)
    alpha_m = np.random.default_rng(2).uniform(-500, 500, FEW).astype(dtype)
    for at in accuracy.sets(p, dtype, FEW):
        actual = module("rotating_link").normal_force(at.theta_m, at.omega_m, alpha_m, given)
        worst = np.max(accuracy.relative(actual, accuracy.accelerated(at, alpha_m, p)))
        assert worst <= ACCELERATED_EPS, at.name


@both_precisions
@pytest.mark.parametrize("case", extended.CASES)
def test_extended_models(case: str, dtype: Real) -> None:
    """Effects leave F_N as exact as it was, but where they shift the angle; a replaced mass does, too."""
    name = extended.BASE[case]
    for one in extended.extended(case):
        if "angle_offset" in {effect.id for effect in one.effects}:
            continue
        heavier = {"mass_ratio": 0.25} if "mass_ratio" in one.texts[f"{one.model.name}.py"] else {}
        p = oracle.exact(extended.KNOWN)
        p.M = p.M * oracle.mpf(1.25) if heavier else p.M
        for at in accuracy.sets(p, dtype, FEW // 3):
            given = {"theta_m": at.theta_m, "omega_m": at.omega_m}
            actual = np.asarray(extended.call(one.module, "normal_force", given, **heavier))
            worst = np.max(accuracy.units(actual, accuracy.normal_force(name, at, p)))
            assert worst <= NORMAL_FORCE_ULP, (one.model.name, at.name)


@pytest.mark.parametrize("name", [*STEADY, "rotating_link"])
def test_the_header_states_the_bounds(name: str) -> None:
    """What is measured here is what the header promises."""
    bound = (
        f"normal_force within {ACCELERATED_EPS} eps (M L (omega_l^2 + |alpha_l|) + weight)"
        if name == "rotating_link"
        else f"normal_force within {NORMAL_FORCE_ULP} units in the last place"
    )

    assert bound in (GENERATED / f"{name}.h").read_text(encoding="utf-8")
