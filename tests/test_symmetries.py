"""What must hold of the emitted models for any numbers: symmetries, dimensions, NaN."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests import oracle, paper, strategies
from tests.emitted import (
    CALLED_ON_STATES,
    INERTIA,
    MODELS,
    SWINGING,
    both_precisions,
    every_call,
    every_model,
    grid,
    module,
    parameters,
    width,
    with_inertia,
)
from tests.paper import Parameters

EPS = float(np.finfo(float).eps)
TORQUES = ("friction_torque", "mechanical_friction_torque")
ODD = (*TORQUES, "regressor", "friction_torque_jacobian", "voltage", "current")
SYMMETRIC = [name for name in MODELS if not oracle.CASES[name].asymmetric]
# Of kilogram, metre, second and ampere; angles have none.
FORCE, TORQUE = (1, 1, -2, 0), (1, 2, -2, 0)
DIMENSION = {
    "theta_m": (0, 0, 0, 0), "omega_m": (0, 0, -1, 0), "alpha_m": (0, 0, -2, 0),
    "i": (0, 0, 0, 1), "u": (1, 2, -3, -1), "torque": TORQUE, "dt": (0, 0, 1, 0),
    "mu": (0, 0, 0, 0), "phi": (0, 0, 0, 0),
    "M": (1, 0, 0, 0), "M_l": (1, 0, 0, 0), "L": (0, 1, 0, 0), "g": (0, 1, -2, 0), "F_T": FORCE,
    "R": (1, 2, -3, -2), "k_i": (1, 2, -2, -1), "k_e": (1, 2, -2, -1),
    "J_m": (1, 2, 0, 0), "J_l": (1, 2, 0, 0),
    "B_lN": (0, 1, 1, 0), "B_lT": (0, 1, 1, 0), "C_lN": (0, 1, 0, 0), "C_lT": (0, 1, 0, 0),
    "B_m": (1, 2, -1, 0), "C_m": TORQUE, "B": (1, 2, -1, 0), "C": TORQUE,
}  # fmt: skip
RESIDUALS = ("mechanical_residual", "electrical_residual")
RESULT = dict.fromkeys((*TORQUES, *RESIDUALS, "gravity_torque"), TORQUE) | {
    "normal_force": FORCE, "voltage": (1, 2, -3, -1), "current": (0, 0, 0, 1),
    "acceleration": (0, 0, -2, 0),
}  # fmt: skip


def reversed_motion(columns: dict[str, np.ndarray]) -> list[np.ndarray]:
    """Return the states run backwards in mirror image: angle, velocity and acceleration change sign."""
    return [-x for x in columns.values()]


# Exact in floating point as well: rounding to nearest has the symmetries.


@pytest.mark.parametrize("function", ODD)
@pytest.mark.parametrize("name", SYMMETRIC)
def test_odd_under_reversal(name: str, function: str) -> None:
    """Friction, voltage and current change sign, and nothing else, when the motion is mirrored."""
    f, p, columns = getattr(module(name), function), with_inertia(name), grid(name, function)

    assert np.array_equal(-f(*columns.values(), p), f(*reversed_motion(columns), p))


@pytest.mark.parametrize("function", TORQUES)
@pytest.mark.parametrize("name", ["c1_perpendicular", "c2_parallel"])
def test_odd_in_velocity(name: str, function: str) -> None:
    """In steady motion friction is odd in the velocity alone, at any angle."""
    f, columns = getattr(module(name), function), grid(name, function)

    assert np.array_equal(-f(*columns.values()), f(*(columns | {"omega_m": -columns["omega_m"]}).values()))


@every_model
def test_normal_force_is_even(name: str) -> None:
    """F_N is even in the mirrored motion, even in the velocity, and in steady motion even in the angle."""
    f, columns = module(name).normal_force, grid(name, "normal_force")
    expected = f(*columns.values())

    assert np.array_equal(expected, f(*reversed_motion(columns)))
    assert np.array_equal(expected, f(*(columns | {"omega_m": -columns["omega_m"]}).values()))
    if name.startswith("c2_"):
        assert np.array_equal(expected, f(*(columns | {"theta_m": -columns["theta_m"]}).values()))


@pytest.mark.parametrize("name", [name for name in MODELS if oracle.CASES[name].asymmetric])
def test_asymmetric_reversal_swaps_the_directions(name: str) -> None:
    """Mirrored motion with the coefficients of the two directions exchanged changes the sign only."""
    values = vars(paper.table_1(float)) | INERTIA
    ahead = {f"{one}_pos": (k + 1) * values[one] for k, one in enumerate(strategies.FRICTION)}
    back = {f"{one}_neg": values[one] / (k + 2) for k, one in enumerate(strategies.FRICTION)}
    swapped = {key.replace("_pos", "_neg"): value for key, value in ahead.items()}
    swapped |= {key.replace("_neg", "_pos"): value for key, value in back.items()}
    columns = grid(name, "friction_torque")
    f = module(name).friction_torque

    expected = -f(*columns.values(), parameters(name, values | ahead | back))
    assert np.array_equal(expected, f(*reversed_motion(columns), parameters(name, values | swapped)))


@pytest.mark.parametrize("name", SWINGING)
@given(data=st.data())
def test_periodic_in_the_link_angle(name: str, data: st.DataObject) -> None:
    """A whole turn of the link, which the angle holds to rounding, changes nothing but by rounding."""
    values = data.draw(strategies.parameters(name))
    points = data.draw(strategies.states(values, np.float64))
    turns = data.draw(st.integers(-50, 50))
    columns = strategies.arrays(points, np.float64)
    turned = columns | {"theta_m": columns["theta_m"] + turns * 2 * np.pi / values["mu"]}
    p, exact = parameters(name, values), oracle.exact(values)

    for function in ("normal_force", "friction_torque", "gravity_torque"):
        f, taken = getattr(module(name), function), oracle.inputs(name, function)
        here, there = (np.atleast_1d(f(*(x[one] for one in taken), p)) for x in (columns, turned))
        for k, x in enumerate(points):
            # Both have the error of their own angle, the second that of the turn as well.
            far = oracle.Point(
                max(abs(x.theta_m), abs(oracle.mpf(float(turned["theta_m"][k])))), x.omega_m, x.alpha_m
            )
            scale = float(oracle.expected(name, function, far, exact)[0][1])
            turn = abs(turns) * 2 * np.pi
            assert abs(here[k] - there[k]) <= oracle.K * EPS * scale * (3 + turn)


# Dimensions.


@every_call
def test_scales_with_its_dimension(name: str, function: str) -> None:
    """In other units of mass, length, time and current everything is the same number in these units.

    The factors are powers of two, so that no rounding differs and the results are the same to the bit.
    """
    emitted = module(name)
    units = np.array([2.0**3, 2.0**-4, 2.0**5, 2.0**-2])

    def factor(quantity: str) -> float:
        symmetric = quantity.removesuffix("_pos").removesuffix("_neg")
        return float(np.prod(units ** np.array(DIMENSION[symmetric])))

    def scaled(values: dict[str, float]) -> Parameters:
        return parameters(name, {letter: value * factor(letter) for letter, value in values.items()})

    values = vars(paper.table_1(float)) | {"phi": 0.75 if name == "rotating_link" else 0.0} | INERTIA
    values |= {one + end: values[one] for one in strategies.FRICTION for end in ("_pos", "_neg")}
    columns = grid(name, function, 300)
    f = getattr(emitted, function)

    result = f(*columns.values(), parameters(name, values))
    rescaled = f(*(x * factor(one) for one, x in columns.items()), scaled(values))

    F = float(np.prod(units ** np.array(TORQUE)))
    by_component = {
        "friction_torque_gradient": lambda: [F / factor(one) for one in emitted.GRADIENT],
        "friction_torque_with_gradient": lambda: [F, *(F / factor(one) for one in emitted.GRADIENT)],
        "friction_torque_jacobian": lambda: [F / factor(one) for one in emitted.JACOBIAN],
        "regressor": lambda: [F / factor(one) for one in emitted.REGRESSOR],
        "friction_coefficients": lambda: [factor(one) for one in emitted.REGRESSOR],
        "breakaway_torque": lambda: [F, F],
        "friction_budget": lambda: [F, F, F / factor("omega_m")],
        "friction_step": lambda: [factor("omega_m"), F],
        "polynomial_neg": lambda: [F / factor("omega_m") ** k for k in (3, 2, 1, 0)],
        "polynomial": lambda: [F / factor("omega_m") ** k for k in (3, 2, 1, 0)],
    }
    expected = (
        by_component[function]() if function in by_component else np.prod(units ** np.array(RESULT[function]))
    )
    assert np.array_equal(result * np.asarray(expected), rescaled)


# NaN in gives NaN out; that any bits do no harm is in the sanitized self-test.


SCALARS = [(name, function) for name, function in CALLED_ON_STATES if not width(name, function)]


@both_precisions
@pytest.mark.parametrize(("name", "function"), SCALARS, ids=map(".".join, SCALARS))
def test_nan_in_gives_nan_out(name: str, function: str, dtype: type[np.floating]) -> None:
    """A NaN in any input is in the result, whatever bits the other inputs have."""
    generator = np.random.default_rng(11)
    word = np.uint32 if dtype is np.float32 else np.uint64
    inputs = oracle.inputs(name, function)
    for k in range(len(inputs)):
        states = [generator.integers(0, np.iinfo(word).max, 5000, word).view(dtype) for _ in inputs]
        states[k] = np.full(5000, np.nan, dtype)

        result = getattr(module(name), function)(*states, with_inertia(name))

        assert np.all(np.isnan(result)), inputs[k]


VECTORS = [pair for pair in CALLED_ON_STATES if pair not in SCALARS]
PLAIN = (0.0, -0.0, 1.0, -2.5, 1e3)


@both_precisions
@pytest.mark.parametrize(("name", "function"), VECTORS, ids=map(".".join, VECTORS))
def test_nan_is_told_at_standstill_too(name: str, function: str, dtype: type[np.floating]) -> None:
    """A NaN in any input is in some element of the result, whatever the direction of motion.

    But not in a step without time, which takes no torque.
    """
    inputs = oracle.inputs(name, function)
    for k in range(len(inputs)):
        states = np.array(list(itertools.product(PLAIN, repeat=len(inputs))), dtype).T
        states[k] = np.nan
        states = states[:, ~(states[inputs.index("dt")] <= 0.0)] if "dt" in inputs else states

        result = getattr(module(name), function)(*states, with_inertia(name))

        assert np.all(np.any(np.isnan(result), axis=-1)), inputs[k]
