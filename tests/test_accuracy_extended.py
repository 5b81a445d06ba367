"""The bounds that headers of extended models state, measured against 50 digits."""

import dataclasses
import math
import re
from collections.abc import Callable
from functools import cache

import mpmath
import numpy as np
import pytest
from mpmath import mpf

from eccentric.effects import Effect
from eccentric.emission import executed, render
from eccentric.emission.program.accuracy import (
    FRICTION_TORQUE,
    GRADIENT,
    LARGEST_SHIFT,
    NORMAL_FORCE,
    WITHOUT_ANGLE,
    promises,
)
from eccentric.model import Model, load_model
from tests import accuracy, extended
from tests.compiled import Real
from tests.emitted import PRECISIONS, by_turns
from tests.paper import Parameters
from tests.promised import DERIVATIVES, gradient_error
from tests.test_accuracy import DRIVES, drive_parameters

# `make test` has the models themselves, in test_accuracy.
pytestmark = pytest.mark.slow

# Every drive in both precisions with the models of the paper: test_accuracy.py. Here precisions take turns.
BOTH = {"mu = 1/5", "exact velocity"}


FEW = {np.float64: 80, np.float32: 40}  # states of each set
TILT, MORE = 0.3, 0.4  # rad; and the share by which the mass is greater
FORCE, FRICTION = "normal force", "friction and its derivatives"
# What keeps its bounds beside which effects, for which reason: of their physics, nothing of the code's.
KEPT = {
    (FORCE, FRICTION): {
        "the drive": (
            "kt_ripple", "kt_saturation", "magnet_temperature", "magnetic_hysteresis",
            "magnetic_hysteresis[play]", "current_bias", "sensor_delay",
        ),
        "the angle read": ("encoder_eccentricity[motor]", "encoder_eccentricity[link]"),
        "the angle of the link": (
            "kinematic_error[motor,n=1]", "kinematic_error[motor,n=2]",
            "kinematic_error[link,n=1]", "kinematic_error[link,n=2]",
        ),
        "the voltage": (
            "inverter_deadtime", "resistance_mismatch", "resistance_temperature",
            "resistance_temperature[hidden]", "armature_inductance",
        ),
        "torques that store energy": (
            "cogging", "cable_spring", "angle_offset[torque]", "mass_mismatch[torque]", "backlash[lag]",
            "inertia_mismatch", "ki_mismatch", "joint_compliance",
        ),
        "parameters of F_N, which stays a product or a difference that is taken once": (
            "gravity_tilt", "angle_offset", "mass_mismatch", "mass_mismatch[inertia]",
        ),
        "a power of the speed, added": (
            "oneway_windage[+]", "oneway_windage[-]", "quadratic_drag", "cubic_drag",
        ),
    },
    (FORCE,): {
        "of either sign, so that friction may cancel": (
            "coulomb_asymmetry", "viscous_asymmetry", "link_harmonic_friction", "ke_mismatch", "wear_runin",
            "motor_harmonic_friction", "wear_runin[travel]", "time_drift", "coulomb_temperature[bearing]",
            "nonsynchronous_friction",
        ),
        "taken off friction": (
            "backlash", "presliding", "presliding[lugre]", "hidden_thermal_drift[bearing]",
            "hidden_thermal_drift[coulomb]", "viscosity_temperature[bearing]",
        ),
        "a factor on friction that is a difference or an exponential": (
            "time_drift[all]", "hidden_thermal_drift", "hidden_thermal_drift[viscous]",
            "viscosity_temperature", "viscosity_temperature[arrhenius]", "coulomb_temperature",
        ),
        "by the load on the gear, which may cancel": (
            "load_dependent[transmitted]", "load_dependent[progressive]", "load_dependent[gravity]",
            "gear_efficiency[transmitted]", "gear_efficiency[gravity]",
            "gear_efficiency[transmitted,driven]", "gear_efficiency[gravity,driven]",
            "stribeck_load[transmitted,d=1]", "stribeck_load[transmitted,d=2]",
            "stribeck_load[gravity,d=1]", "stribeck_load[gravity,d=2]",
        ),
        "an exponential, a root or a quotient, which have errors of their own": (
            "stribeck[d=0.5]", "stribeck[d=1]", "stribeck[d=1.5]", "stribeck[d=2]", "local_defect",
            "sublinear_viscous[n=0.5]", "sublinear_viscous[n=0]", "eddy_current", "stribeck_load[F_N]",
            "stribeck_temperature",
            "bearing_load[degressive]", "bearing_load[progressive]", "bearing_load[preload]",
        ),
    },
    (): {"weight and centrifugal force, added as vectors in F_N": ("gravity_tilt[load]",)},
}  # fmt: skip
# What adds powers of the speed to the friction, and the power.
DRAGS = ("oneway_windage",)  # families whose effects go together
DRAG = {"windage_pos": (2e-6, 2), "windage_neg": (3e-6, 2), "drag_2": (5e-6, 2), "drag_3": (7e-8, 3)}


@cache
def promised(case: str) -> tuple[Effect, ...]:
    """Return the effects with which friction keeps its bounds, one harmonic of each."""
    chosen = [e for e in extended.effects(case).values() if "[n=" not in e.id or "[n=1]" in e.id]
    return tuple(e for e in chosen if FRICTION in kept(e))


def kept(effect: Effect) -> tuple[str, ...]:
    """Return what keeps its bounds beside the effect, whatever its order."""
    name = re.sub(r"\[n=[1-9]\d*\]", "", effect.id)
    return next(what for what, reasons in KEPT.items() if any(name in ids for ids in reasons.values()))


@cache
def models(case: str) -> tuple[extended.Extended, ...]:
    """Return the base model with six of them at a time, every linear one of a size that shows."""
    made, found, model = [], [], load_model(extended.BASE[case])
    for effect in promised(case):
        if len(found) == 6 or effect.family in {e.family for e in found if e.family not in DRAGS}:
            made.append((model, tuple(found)))
            found, model = [], load_model(extended.BASE[case])
        model = effect.extend(model, {q.name: 0.1 for q in effect.coefficients})
        found.append(effect)
    return tuple(emitted(model, found) for model, found in [*made, (model, tuple(found))])


def emitted(model: Model, found: tuple[Effect, ...]) -> extended.Extended:
    """Return a model as the tests call it."""
    texts = render(model)
    return extended.Extended(model, found, texts, executed(texts, model.name))


def of_drive(one: extended.Extended, drive: str, offset: float) -> tuple[Parameters, Parameters, mpf]:
    """Return a drive's parameters as emitted and at 50 digits, and by how much the motor angle is shifted."""
    name = next(base for base in extended.BASE.values() if one.model.name.startswith(base))
    _, p = drive_parameters(name, drive)
    known = {key: float(value) for key, value in vars(p).items()} | {key: c for key, (c, _) in DRAG.items()}
    known |= {"tilt_angle": TILT, "mass_ratio": MORE, "offset_angle": offset}
    there = {f.name for f in dataclasses.fields(one.module.Parameters)}
    given = one.module.Parameters(**{key: value for key, value in known.items() if key in there})
    p.M *= 1 + mpf(MORE) if "mass_ratio" in there else 1
    p.g *= mpf(math.cos(TILT)) if "tilt_angle" in there else 1
    return given, p, mpf(offset) / p.mu if "offset_angle" in there else mpf(0)


def called(one: extended.Extended, function: str, at: accuracy.Set, given: Parameters) -> np.ndarray:
    """Call an emitted function; friction takes nothing but angle and velocity."""
    asked = [getattr(at, x) for x in extended.arguments(one.module, function)]
    return np.asarray(getattr(one.module, function)(*asked, given))


def drag(one: extended.Extended, omega_m: np.ndarray) -> list[tuple[mpf, mpf]]:
    """Return what windage and drag add to the friction torque and to its slope."""
    powers = {key: by_power(key, omega_m) for key in DRAG if key in one.module.JACOBIAN}
    of = {key: mpf(c) for key, (c, _) in DRAG.items()}
    return [
        (
            mpmath.fsum(of[key] * row[k] for key, row in powers.items()),
            mpmath.fsum(of[key] * DRAG[key][1] * row[k] / mpf(float(w)) for key, row in powers.items()),
        )
        for k, w in enumerate(omega_m)
    ]


def by_power(key: str, omega_m: np.ndarray) -> list[mpf]:
    """Return what a coefficient of windage or drag multiplies: a power of the speed, against the motion."""
    gates = {"windage_pos": lambda w: w > 0, "windage_neg": lambda w: w < 0}
    acts, n = gates.get(key, bool), DRAG[key][1]
    return [acts(w) * mpmath.sign(w) * abs(w) ** n for w in map(mpf, map(float, omega_m))]


def columns(one: extended.Extended, name: str, at: accuracy.Set, p: Parameters) -> list[list[mpf]]:
    """Return what each coefficient of friction multiplies, those of windage and drag last."""
    own = [label for label in one.module.JACOBIAN if label not in DRAG]
    added = [by_power(label, at.omega_m) for label in one.module.JACOBIAN if label in DRAG]
    return [*accuracy.jacobian(name, at, p, own), *added]


@pytest.mark.parametrize(("case", "drive", "dtype"), by_turns(extended.CASES, DRIVES, both=BOTH))
def test_friction_keeps_its_bounds(case: str, drive: str, dtype: Real) -> None:
    """Effects that leave friction as it is, or add powers of the speed to it, leave it as exact as it was."""
    name = extended.BASE[case]
    friction = WITHOUT_ANGLE.anywhere if case == "C1" else FRICTION_TORQUE.anywhere
    for one in models(case):
        given, p, shift = of_drive(one, drive, 0.7)
        for at in accuracy.sets(p, dtype, FEW[dtype], shift):
            where, more = str(([e.id for e in one.effects], at.name)), drag(one, at.omega_m)
            for function in ("friction_torque", "mechanical_friction_torque"):
                paper = getattr(accuracy, function)(name, at, p)
                exact = [F + D for F, (D, _) in zip(paper, more, strict=True)]
                units = accuracy.units(called(one, function, at, given), exact)
                assert np.max(units) <= friction, (function, where)
            jacobian = called(one, "friction_torque_jacobian", at, given)
            for actual, column in zip(np.moveaxis(jacobian, -1, 0), columns(one, name, at, p), strict=True):
                assert np.max(accuracy.units(actual, column)) <= friction, where
            slopes = accuracy.gradient(name, at, p)
            by_omega = zip(slopes["omega_m"], more, strict=True)
            slopes["omega_m"] = [(slope + D, size + D) for (slope, size), (_, D) in by_omega]
            gradient, wanted = called(one, "friction_torque_gradient", at, given), one.module.GRADIENT
            slope = friction if case == "C1" else GRADIENT.anywhere
            assert gradient_error(gradient, [slopes[label] for label in wanted]) <= slope, where


@pytest.mark.parametrize(
    ("case", "made", "dtype"),
    [
        *((case, models, dtype) for case in extended.CASES for dtype in PRECISIONS.values()),
        ("C1", extended.extended, np.float32),
        ("C2", extended.extended, np.float64),
    ],
)
def test_normal_force(case: str, made: Callable[[str], tuple[extended.Extended, ...]], dtype: Real) -> None:
    """Whatever effects a header promises it of, F_N is right to its last places, the angle shifted or not."""
    for one in made(case):
        if any(FORCE not in kept(effect) for effect in one.effects):
            continue
        given, p, shift = of_drive(one, "mu = 1/5", 0.3)
        for at in accuracy.sets(p, dtype, FEW[dtype], shift):
            exact = accuracy.normal_force(extended.BASE[case], at, p)
            units = accuracy.units(called(one, "normal_force", at, given), exact)
            assert np.max(units) <= NORMAL_FORCE.anywhere, (one.model.name, at.name)


@pytest.mark.parametrize(
    ("offset", "drive", "dtype"), by_turns((-LARGEST_SHIFT, -0.7, 1e-3, 1.5, LARGEST_SHIFT), DRIVES)
)
def test_shifted_angle(offset: float, drive: str, dtype: Real) -> None:
    """A shifted angle costs F_N nothing, even near the shifted zero of F_N and far from theta_m = 0."""
    one = extended.with_effect("C2", "angle_offset")
    given, p, shift = of_drive(one, drive, offset)
    for at in accuracy.sets(p, dtype, FEW[dtype], shift):
        exact = accuracy.normal_force("c2_parallel", at, p)
        units = accuracy.units(called(one, "normal_force", at, given), exact)
        assert np.max(units) <= NORMAL_FORCE.anywhere, at.name


@pytest.mark.parametrize("case", extended.CASES)
def test_what_an_effect_leaves_is_promised(case: str) -> None:
    """Every effect of the library, of every order, keeps the bounds that its physics leaves, and no other."""
    base = load_model(extended.BASE[case])
    functions = {
        FORCE: {"normal_force"},
        FRICTION: {"friction_torque", "mechanical_friction_torque", *DERIVATIVES},
    }
    for effect in extended.effects(case).values():
        every = set().union(*functions.values())
        stated = [line.partition(" within ") for line in promises(effect.extend(base), every)]
        found = {name for names, within, _ in stated if within for name in names.split(", ")}
        assert set().union(*(functions[what] for what in kept(effect))) == found, effect.id


def test_the_table_is_of_the_library() -> None:
    """What the table names is the library's, each effect once."""
    named = [name for reasons in KEPT.values() for ids in reasons.values() for name in ids]
    library = {
        re.sub(r"\[n=[1-9]\d*\]", "", name) for case in extended.CASES for name in extended.effects(case)
    }
    assert sorted(library) == sorted(named)
