"""What headers promise of each function, and how far it is from 50 digits in the units that they word."""

import dataclasses
from typing import Any

import numpy as np
from mpmath import mpf

from eccentric.emission.program import Bound
from eccentric.emission.program import accuracy as stated
from tests import accelerated, accuracy, oracle, random_drives
from tests.emitted import module
from tests.paper import Parameters

DERIVATIVES = ("friction_torque_jacobian", "friction_torque_gradient")
STEADY = {"C1": ("c1_perpendicular", "c1_asymmetric"), "C2": ("c2_parallel", "c2_asymmetric")}
NAMES = (*STEADY["C1"], *STEADY["C2"], accelerated.NAME)


def bounds(name: str) -> dict[str, Bound]:
    """Return what is promised of each function of a model."""
    slopes = [stated.GRADIENT]
    force, friction = stated.NORMAL_FORCE, stated.FRICTION_TORQUE
    if name in STEADY["C1"]:
        force, friction, slopes = stated.PROVED_FORCE, stated.WITHOUT_ANGLE, [stated.WITHOUT_ANGLE]
    if name == accelerated.NAME:
        force, friction = stated.ACCELERATED_FORCE, stated.ACCELERATED_FRICTION
        slopes = [stated.ACCELERATED_GRADIENT]
    return dict(zip(random_drives.FUNCTIONS, (force, friction, friction, friction, *slopes), strict=True))


def given(name: str, values: dict[str, float]) -> Any:
    """Return the emitted Parameters with those letters that the model has."""
    cls = module(name).Parameters
    return cls(**{f.name: values[f.name] for f in dataclasses.fields(cls) if f.name in values})


def arguments(name: str, function: str, at: accuracy.Set) -> list[np.ndarray]:
    """Return the inputs of a steady model's function."""
    return [getattr(at, one) for one in oracle.inputs(name, function)]


def emitted(name: str, at: accuracy.Set, values: dict[str, float]) -> dict[str, np.ndarray]:
    """Return what each function of the emitted NumPy module of a steady model gives."""
    force, states = (arguments(name, by, at) for by in ("normal_force", "friction_torque"))
    return {
        function: np.asarray(
            getattr(module(name), function)(
                *(force if function == "normal_force" else states), given(name, values)
            )
        )
        for function in random_drives.FUNCTIONS
    }


def errors(name: str, at: accuracy.Set, values: dict[str, float]) -> dict[str, float]:
    """Return the worst error of each function of a steady model, in the units that its header words."""
    return errors_of(emitted(name, at, values), name, at, oracle.exact(values))


def errors_of(results: dict[str, np.ndarray], name: str, at: accuracy.Set, p: Parameters) -> dict[str, float]:
    """Return the same of the results of any code for a steady model, with its exact parameters."""
    found = {}
    for function in random_drives.FUNCTIONS[:3]:
        exact = getattr(accuracy, function)(name, at, p)
        found[function] = np.max(accuracy.units(results[function], exact))
    jacobian, gradient = (results[function] for function in DERIVATIVES)
    columns = accuracy.jacobian(name, at, p, module(name).JACOBIAN)
    pairs = zip(np.moveaxis(jacobian, -1, 0), columns, strict=True)
    found[DERIVATIVES[0]] = np.max([accuracy.units(*pair) for pair in pairs])
    slopes = [accuracy.gradient(name, at, p)[label] for label in module(name).GRADIENT]
    found[DERIVATIVES[1]] = gradient_error(gradient, slopes)
    return {function: float(worst) for function, worst in found.items()}


def gradient_error(actual: np.ndarray, exact: list[list[tuple[mpf, mpf]]]) -> float:
    """Return the worst error of a gradient; without the angle in it units in the last place count."""
    components = list(zip(np.moveaxis(actual, -1, 0), exact, strict=True))
    if len(components) == 1:
        ((got, slopes),) = components
        return float(np.max(accuracy.units(got, [slope for slope, _ in slopes])))
    return float(np.max([accuracy.relative(got, slopes) for got, slopes in components]))


def link_errors(
    at: accuracy.Set, alpha_m: np.ndarray, values: dict[str, float], exact: dict[str, accelerated.Columns]
) -> dict[str, float]:
    """Return the worst error of each function of `rotating_link`, in the units that its header words."""
    found = {}
    for function, columns in exact.items():
        call = getattr(module(accelerated.NAME), function)
        actual = call(at.theta_m, at.omega_m, alpha_m, given(accelerated.NAME, values))
        pairs = zip(np.atleast_2d(actual.T), columns, strict=True)
        found[function] = float(np.max([accuracy.relative(*pair) for pair in pairs]))
    return found


def at_50_digits(name: str, values: dict[str, float], states: list[np.ndarray]) -> dict[str, float]:
    """Return the worst error of each function at these states."""
    theta_m, omega_m = states[:2] if len(states) > 1 else (np.zeros_like(states[0]), states[0])
    at = accuracy.Set("random", theta_m, omega_m)
    if name != accelerated.NAME:
        return errors(name, at, values)
    exact = accelerated.exact(at, states[2], oracle.exact(values))
    return link_errors(at, states[2], values, exact)
