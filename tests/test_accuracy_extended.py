"""The bounds that headers of extended models state, measured against 50 digits."""

import dataclasses
import math
from functools import cache

import mpmath
import numpy as np
import pytest
from mpmath import mpf

from eccentric.effects import Effect
from eccentric.emit import render
from eccentric.emit.accuracy import (
    FRICTION_TORQUE_ULP,
    GRADIENT_EPS,
    LARGEST_SHIFT,
    NORMAL_FORCE_ULP,
    SHIFTED_GRADIENT_EPS,
    promises,
)
from eccentric.model import Model, load_model
from tests import accuracy, extended
from tests.compiled import Real
from tests.emitted import both_precisions
from tests.paper import Parameters
from tests.test_accuracy import assert_gradient, drive_parameters, every_drive

FEW = 100  # states of each set
TILT, MORE = 0.3, 0.4  # rad; and the share by which the mass is greater
# What adds powers of the speed to the friction, and the power.
DRAGS = ("oneway_windage",)  # families whose effects go together
DRAG = {"windage_pos": (2e-6, 2), "windage_neg": (3e-6, 2), "drag_2": (5e-6, 2), "drag_3": (7e-8, 3)}


def promised(case: str) -> list[Effect]:
    """Return the effects with which friction keeps its bound, one harmonic of each."""
    base = load_model(extended.BASE[case])
    chosen = [e for e in extended.effects(case).values() if "[n=" not in e.id or "[n=1]" in e.id]
    return [e for e in chosen if len(promises(e.extend(base))) >= len(promises(base))]


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
    return extended.Extended(model, found, texts, extended.loaded(model.name, texts))


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
    there = {q.name for q in one.model.parameters}
    found = []
    for w in map(mpf, map(float, omega_m)):
        acting = [key for key in DRAG if key in there and (key != "windage_neg" or w < 0)]
        acting = [key for key in acting if key != "windage_pos" or w > 0]
        size = [(mpf(DRAG[key][0]), DRAG[key][1]) for key in acting]
        found.append((
            mpmath.sign(w) * mpmath.fsum(c * abs(w) ** n for c, n in size),
            mpmath.fsum(n * c * abs(w) ** (n - 1) for c, n in size),
        ))  # fmt: skip
    return found


@both_precisions
@every_drive
@pytest.mark.parametrize("case", extended.CASES)
def test_friction_keeps_its_bounds(case: str, drive: str, dtype: Real) -> None:
    """Effects that leave friction as it is, or add powers of the speed to it, leave it as exact as it was."""
    name = extended.BASE[case]
    for one in models(case):
        given, p, shift = of_drive(one, drive, 0.7)
        for at in accuracy.sets(p, dtype, FEW, shift):
            where, more = str(([e.id for e in one.effects], at.name)), drag(one, at.omega_m)
            for function in ("friction_torque", "mechanical_friction_torque"):
                paper = getattr(accuracy, function)(name, at, p)
                exact = [F + D for F, (D, _) in zip(paper, more, strict=True)]
                units = accuracy.units(called(one, function, at, given), exact)
                assert np.max(units) <= FRICTION_TORQUE_ULP, (function, where)
            slopes = accuracy.gradient(name, at, p)
            by_omega = zip(slopes["omega_m"], more, strict=True)
            slopes["omega_m"] = [(slope + D, size + D) for (slope, size), (_, D) in by_omega]
            gradient, wanted = called(one, "friction_torque_gradient", at, given), one.module.GRADIENT
            bound = SHIFTED_GRADIENT_EPS if shift else GRADIENT_EPS
            assert_gradient(gradient, [slopes[label] for label in wanted], where, bound)


@both_precisions
@pytest.mark.parametrize("case", extended.CASES)
def test_normal_force(case: str, dtype: Real) -> None:
    """Whatever effects a header promises it of, F_N is right to its last places, the angle shifted or not."""
    for one in (*extended.extended(case), *models(case)):
        assert promises(one.model)[0].startswith("normal_force within")
        given, p, shift = of_drive(one, "mu = 1/5", 0.3)
        for at in accuracy.sets(p, dtype, FEW, shift):
            exact = accuracy.normal_force(extended.BASE[case], at, p)
            units = accuracy.units(called(one, "normal_force", at, given), exact)
            assert np.max(units) <= NORMAL_FORCE_ULP, (one.model.name, at.name)


@both_precisions
@every_drive
@pytest.mark.parametrize("offset", [-LARGEST_SHIFT, -0.7, 1e-3, 1.5, LARGEST_SHIFT])
def test_shifted_angle(offset: float, drive: str, dtype: Real) -> None:
    """A shifted angle costs F_N nothing, next to the shifted hollow and far from theta_m = 0 either."""
    one = extended.with_effect("C2", "angle_offset")
    given, p, shift = of_drive(one, drive, offset)
    for at in accuracy.sets(p, dtype, FEW, shift):
        exact = accuracy.normal_force("c2_parallel", at, p)
        units = accuracy.units(called(one, "normal_force", at, given), exact)
        assert np.max(units) <= NORMAL_FORCE_ULP, at.name


def test_no_bound_is_promised_of_differences() -> None:
    """Friction that an effect may take away from is left out: where it cancels, no digit need be right."""
    for effect_id in ("coulomb_asymmetry", "viscous_asymmetry", "hidden_thermal_drift", "ke_mismatch"):
        one = extended.effects("C2")[effect_id].extend(load_model("c2_parallel"))
        assert 1 == len(promises(one)), effect_id
