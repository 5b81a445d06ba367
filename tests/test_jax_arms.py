"""The JAX module of an arm: its NumPy module, and oracles that share no code with either.

They are Lagrange's equations from the energies of two links, differentiated by JAX; Pinocchio's mass matrix;
and the normal force that the paper prints.
"""

import itertools
from collections.abc import Callable, Iterator
from functools import cache
from types import ModuleType, SimpleNamespace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from eccentric import emission
from eccentric.emission import Choice
from eccentric.model import Body, Chain, Joint, Model, arm
from tests import paper
from tests.arms import random_chain
from tests.emitted import quick
from tests.jaxed import executed
from tests.test_arm_extended import called, emitted, followed, of_arm
from tests.test_chain_numpy import I_0, I_1, TWO_LINKS, c_0, c_1, g, l_0, m_0, m_1, motions

CHAINS = {
    "two links": TWO_LINKS,
    "three joints, geared, one slides": random_chain(np.random.default_rng(7), 3, geared=True, rotors=True),
}
GRADIENT = "mechanical_friction_torque_gradient"
SAMPLES = 6
MOST_APART = 16  # eps of the greatest value of a function: XLA may fuse products and sums
LOADED = {"N": "F_N", "T": "F_T", "M": "M_B", "G": "T"}


@pytest.fixture(autouse=True)
def _double() -> Iterator[None]:
    with jax.enable_x64(True):
        yield


@cache
def model(name: str) -> Model:
    """The model of a chain."""
    return arm(CHAINS[name], "An arm")


@cache
def jaxed(name: str) -> ModuleType:
    """Its JAX module."""
    return executed(model(name))


@cache
def by_numpy(name: str, *functions: str) -> ModuleType:
    """Its NumPy module."""
    choice = Choice(functions, "none") if functions else Choice()
    files = emission.render(model(name), backends=("numpy",), choice=choice)
    return emission.executed(files, model(name).name)


def with_friction(module: ModuleType) -> Any:
    """Parameters with a value for every coefficient of friction, and every motor."""
    rng = np.random.default_rng(22)
    chosen = {letter: float(rng.uniform(0.5, 2) * 1e-3) for letter in module.REGRESSOR}
    motors = [name for name in module.Parameters.__dataclass_fields__ if name[:-2] in {"R", "k_i", "k_e"}]
    return module.Parameters(**chosen, **{name: float(rng.uniform(0.5, 2)) for name in motors})


def given(function: Callable[..., Any], *motion: np.ndarray) -> tuple[np.ndarray, ...]:
    """What of the motion a function takes."""
    alone = {"gravity_torque", "breakaway_torque", "mass_matrix"}
    return motion[:1] if function.__name__ in alone else motion


@pytest.mark.parametrize(
    ("name", "dtype"),
    quick(itertools.product(CHAINS, (np.float64, np.float32)), {("two links", np.float64)}),
)
def test_every_function_is_that_of_numpy(name: str, dtype: type) -> None:
    """Names, constants, shapes and precisions are those of NumPy, and values to a few roundings."""
    ours, theirs = jaxed(name), by_numpy(name)
    n = len(CHAINS[name].joints)
    motion = [x.astype(dtype).reshape(2, -1, n) for x in motions(np.random.default_rng(3), n, SAMPLES)]
    p, q = with_friction(ours), with_friction(theirs)

    assert set(ours.__all__) == set(theirs.__all__)
    for public in theirs.__all__:
        if public.isupper():
            assert getattr(theirs, public) == getattr(ours, public)
        elif public.islower():
            expected = getattr(theirs, public)(*given(getattr(theirs, public), *motion), q)
            found = getattr(ours, public)(*given(getattr(theirs, public), *motion), p)
            greatest = np.max(np.abs(expected))

            assert (expected.shape, expected.dtype) == (found.shape, found.dtype)
            assert np.max(np.abs(expected - found)) <= MOST_APART * np.finfo(dtype).eps * greatest, public


def kinetic_energy(q: jax.Array, w: jax.Array) -> jax.Array:
    """Of the two links, by the velocities of their centres of mass and their angular velocities."""

    def centres(q: jax.Array) -> jax.Array:
        first, both = q[0], q[0] + q[1]
        elbow = l_0 * jnp.array([jnp.sin(first), -jnp.cos(first)])
        return jnp.stack(
            [
                c_0 / l_0 * elbow,
                elbow + c_1 * jnp.array([jnp.sin(both), -jnp.cos(both)]),
            ]
        )

    _, velocities = jax.jvp(centres, (q,), (w,))
    moving = m_0 * velocities[0] @ velocities[0] + m_1 * velocities[1] @ velocities[1]
    return 0.5 * (moving + I_0 * w[0] ** 2 + I_1 * (w[0] + w[1]) ** 2)


def height_energy(q: jax.Array) -> jax.Array:
    """Of the weight of the two links."""
    return -g * ((m_0 * c_0 + m_1 * l_0) * jnp.cos(q[0]) + m_1 * c_1 * jnp.cos(q[0] + q[1]))


def test_the_torques_are_lagranges() -> None:
    """d/dt dT/dw - dT/dq + dV/dq, all by JAX from the energies."""
    module = jaxed("two links")

    def lagrange(q: jax.Array, w: jax.Array, a: jax.Array) -> jax.Array:
        momentum = jax.grad(kinetic_energy, 1)
        _, change = jax.jvp(momentum, (q, w), (w, a))
        return change - jax.grad(kinetic_energy)(q, w) + jax.grad(height_energy)(q)

    motion = motions(np.random.default_rng(5), 2, SAMPLES)
    expected = jax.vmap(lagrange)(*map(jnp.asarray, motion))
    weight = jax.vmap(jax.grad(height_energy))(jnp.asarray(motion[0]))

    np.testing.assert_allclose(module.inverse_dynamics(*motion), expected, 1e-11, 1e-10)
    np.testing.assert_allclose(module.gravity_torque(motion[0]), weight, 1e-11, 1e-11)


def test_the_slope_by_the_acceleration_is_pinocchios_mass_matrix() -> None:
    """One sample, differentiated and mapped over samples, of joints without gear and rotor."""
    pin = pytest.importorskip("pinocchio", reason="Pinocchio (`pip install pin`) is not installed")
    from tests.test_chain_pinocchio import pinocchio_of

    module = jaxed("two links")
    motion = motions(np.random.default_rng(6), 2, SAMPLES)
    matrices = jax.jit(jax.vmap(jax.jacfwd(module.inverse_dynamics, 2)))(*motion)
    pinocchio, data = pinocchio_of(TWO_LINKS)
    for q, found in zip(motion[0], matrices, strict=True):
        upper = np.triu(pin.crba(pinocchio, data, q))

        np.testing.assert_allclose(found, upper + np.triu(upper, 1).T, 1e-12, 1e-12)


def test_one_joint_carries_the_papers_normal_force() -> None:
    """Equation (16) at constant speed, and friction per newton of it."""
    p = SimpleNamespace(M=0.5, M_l=0.2, L=0.25, g=9.81, mu=0.2)
    link = Chain(
        "link", [Joint(mu=p.mu)], [Body(p.M_l)], (0, -p.g, 0), Body(p.M, (0, -p.L, 0)), ()
    )  # the balanced link, and the mass
    module = executed(arm(link, "One joint"))
    q, w, a = motions(np.random.default_rng(8), 1, SAMPLES)
    loads = module.bearing_loads(q, w, 0 * a)[:, module.BEARING_LOADS.index("F_N_0")]
    expected = paper.normal_force_c2(q[:, 0], w[:, 0], p, np)
    friction = module.mechanical_friction_torque(q, w, 0 * a, module.Parameters(C_lN_0=0.08))[:, 0]

    np.testing.assert_allclose(loads, expected, 1e-13)
    np.testing.assert_allclose(friction, p.mu * 0.08 * expected * np.sign(w[:, 0]), 1e-13)


@pytest.mark.slow
def test_the_slopes_of_friction_are_the_emitted_gradient() -> None:
    """By angles, velocities and accelerations of all joints: of the NumPy module, and central differences."""
    name = "three joints, geared, one slides"
    module, theirs = jaxed(name), by_numpy(name, GRADIENT, "mechanical_friction_torque", "regressor")
    motion, p, q = motions(np.random.default_rng(9), 3, 1), with_friction(module), with_friction(theirs)
    one = [x[0] for x in motion]
    slopes = np.concatenate(jax.jacfwd(module.mechanical_friction_torque, (0, 1, 2))(*one, p), -1)
    scale, step = np.max(np.abs(slopes)), 1e-5

    np.testing.assert_allclose(getattr(theirs, GRADIENT)(*one, q).reshape(3, 9), slopes, 1e-11, 1e-11 * scale)
    for k in range(9):
        moved = []
        for sign in (1, -1):
            beside = [x.copy() for x in one]
            beside[k // 3][k % 3] += sign * step
            moved.append(theirs.mechanical_friction_torque(*beside, q))
        np.testing.assert_allclose((moved[0] - moved[1]) / (2 * step), slopes[:, k], 2e-5, 1e-6 * scale)


@pytest.mark.slow
def test_the_slopes_by_the_coefficients_are_the_loads() -> None:
    """The postulate (7): C_lN multiplies mu sgn(omega_m) and the load of its joint, B_lN mu^2 omega_m."""
    name = "three joints, geared, one slides"
    module, chain = jaxed(name), CHAINS[name]
    motion = [x[0] for x in motions(np.random.default_rng(10), 3, 1)]
    slopes = vars(jax.jacfwd(lambda p: module.mechanical_friction_torque(*motion, p))(with_friction(module)))
    loads = dict(zip(module.BEARING_LOADS, module.bearing_loads(*motion).tolist(), strict=True))
    for j, joint in enumerate(chain.joints):
        mu, w = float(joint.mu), motion[1][j]
        factors = {"C_m": np.sign(w), "B_m": w}
        for letter, load in LOADED.items():
            if f"{load}_{j}" in loads:
                factors[f"C_l{letter}"] = mu * np.sign(w) * loads[f"{load}_{j}"]
                factors[f"B_l{letter}"] = mu**2 * w * loads[f"{load}_{j}"]
        for coefficient, factor in factors.items():
            expected = np.where(np.arange(3) == j, factor, 0.0)

            np.testing.assert_allclose(slopes[f"{coefficient}_{j}"], expected, 1e-11, 1e-12)


def test_motors_that_are_not_given() -> None:
    """Without R, k_i and k_e the resultant friction is NaN; what does not need them has finite slopes."""
    module = jaxed("two links")
    motion = motions(np.random.default_rng(11), 2, SAMPLES)
    p = module.Parameters(C_m_0=0.1, C_lN_1=0.2)
    slopes = jax.grad(lambda p: module.motor_torque(*motion, p).sum())(p)

    assert np.all(np.isnan(module.friction_torque(*motion, p)))
    assert all(np.isfinite(slope) for slope in jax.tree.leaves(slopes))


def test_another_number_of_joints_is_refused() -> None:
    """The message names the input and its shape, as in NumPy."""
    for module in (jaxed("two links"), by_numpy("two links")):
        with pytest.raises(ValueError, match=r"^omega_m: expected 2 values on the last axis, got shape"):
            module.inverse_dynamics(np.zeros(2), np.zeros(3), np.zeros(2))


@pytest.mark.parametrize(
    "name",
    quick(("hidden_thermal_drift", "backlash", "cogging[n=3]"), {"hidden_thermal_drift"}),
)
def test_hidden_states_of_all_joints(name: str) -> None:
    """Followed along a log by `lax.scan` they are those of NumPy, and so are the torques."""
    found = emitted(name)
    module, inputs = executed(found.model), of_arm()
    expected = followed(found.arm, inputs)
    ours = followed(module, inputs)
    for state in getattr(found.arm, "STATES", ()):
        np.testing.assert_allclose(ours[state], expected[state], 1e-9, 1e-12)

    np.testing.assert_allclose(
        called(module, "motor_torque", ours), called(found.arm, "motor_torque", expected), 1e-9, 1e-11
    )
