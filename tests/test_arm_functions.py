"""The functions of an arm beyond its motion: friction by the loads, gravity, regressors, gradient."""

from types import ModuleType

import numpy as np
import pytest

from eccentric.core import InputError
from eccentric.emission import Choice, executed, render
from eccentric.model import Body, Chain, Joint, Placement, arm
from tests.arms import random_chain
from tests.test_chain_numpy import TWO_LINKS, motions

GRADIENT = "mechanical_friction_torque_gradient"
LOADED = {"N": "F_N", "T": "F_T", "M": "M_B", "G": "T"}


def emitted(chain: Chain, *functions: str) -> ModuleType:
    """The module of a chain, from memory."""
    choice = Choice(functions, "none") if functions else Choice()
    return executed(render(arm(chain, "An arm"), "a test", "a test", choice=choice), chain.name)


@pytest.fixture(scope="module")
def chain() -> Chain:
    """Three joints at odd angles, one of which slides, with gears and rotors."""
    return random_chain(np.random.default_rng(7), 3, geared=True, rotors=True)


@pytest.fixture(scope="module")
def module(chain: Chain) -> ModuleType:
    """All functions of that chain, the gradient included."""
    names = [name for name in emitted(TWO_LINKS).__all__ if name.islower()]
    return emitted(chain, *names, GRADIENT)


@pytest.fixture(scope="module")
def friction(module: ModuleType) -> dict[str, float]:
    """A value for every coefficient of friction."""
    rng = np.random.default_rng(22)
    return {name: float(rng.uniform(0.5, 2) * 1e-3) for name in module.REGRESSOR}


def of_joint(labels: tuple[str, ...], values: np.ndarray, name: str) -> np.ndarray:
    """One labelled value of every sample."""
    return values[..., labels.index(name)]


def test_friction_follows_every_load(chain: Chain, module: ModuleType, friction: dict[str, float]) -> None:
    """Joint by joint the postulate (7): viscous and Coulomb friction by each load, and the motor's own."""
    q, w, a = motions(np.random.default_rng(23), 3)
    loads, labels = module.bearing_loads(q, w, a), module.BEARING_LOADS
    found = module.mechanical_friction_torque(q, w, a, module.Parameters(**friction))
    for j, joint in enumerate(chain.joints):
        mu, sgn = float(joint.mu), np.sign(w[:, j])
        expected = friction[f"B_m_{j}"] * w[:, j] + friction[f"C_m_{j}"] * sgn
        for letter, load in LOADED.items():
            if f"{load}_{j}" in labels:
                link = friction[f"B_l{letter}_{j}"] * mu * w[:, j] + friction[f"C_l{letter}_{j}"] * sgn
                expected = expected + mu * of_joint(labels, loads, f"{load}_{j}") * link

        assert np.allclose(expected, found[:, j], rtol=1e-12)


def test_the_motor_gives_all_of_it(module: ModuleType, friction: dict[str, float]) -> None:
    """motor_torque is inverse dynamics plus friction; friction_torque has the back-EMF in addition."""
    q, w, a = motions(np.random.default_rng(24), 3)
    plain = module.Parameters(**friction)
    driven = module.Parameters(
        **friction, **{f"{letter}_{j}": 0.5 + j for letter in ("R", "k_i", "k_e") for j in range(3)}
    )
    rubbing = module.mechanical_friction_torque(q, w, a, plain)
    damping = (0.5 + np.arange(3)) * w

    assert np.allclose(
        module.inverse_dynamics(q, w, a) + rubbing, module.motor_torque(q, w, a, plain), rtol=1e-12
    )
    assert np.allclose(rubbing + damping, module.friction_torque(q, w, a, driven), rtol=1e-12)


def test_back_emf_that_is_not_given_is_nan(module: ModuleType, friction: dict[str, float]) -> None:
    """Without R, k_i and k_e there is no resultant friction torque, and no number that looks like one."""
    q, w, a = motions(np.random.default_rng(25), 3)

    assert np.all(np.isnan(module.friction_torque(q, w, a, module.Parameters(**friction))))


def test_gravity_is_what_is_left_at_rest(module: ModuleType) -> None:
    """gravity_torque takes angles only, and is the inverse dynamics without motion."""
    q, w, a = motions(np.random.default_rng(26), 3)

    assert np.allclose(
        module.inverse_dynamics(q, 0 * w, 0 * a), module.gravity_torque(q), rtol=1e-12, atol=1e-12
    )


def test_the_regressor_times_the_coefficients(module: ModuleType, friction: dict[str, float]) -> None:
    """Its columns, each of the joint that its label ends in."""
    q, w, a = motions(np.random.default_rng(27), 3)
    columns = module.regressor(q, w, a)
    expected = module.mechanical_friction_torque(q, w, a, module.Parameters(**friction))
    for j in range(3):
        total = sum(
            of_joint(module.REGRESSOR, columns, name) * friction[name]
            for name in module.REGRESSOR
            if name.endswith(f"_{j}")
        )

        assert np.allclose(expected[:, j], total, rtol=1e-12)


def test_the_gradient_is_the_slope(module: ModuleType, friction: dict[str, float]) -> None:
    """Against central differences, away from reversals."""
    rng = np.random.default_rng(28)
    q, w, a = motions(rng, 3)
    w = np.sign(w) * (np.abs(w) + 0.5)
    given, step = module.Parameters(**friction), 1e-5
    slopes = getattr(module, GRADIENT)(q, w, a, given).reshape(len(q), 3, 9)
    scale = np.max(np.abs(slopes))
    for k in range(9):
        moved = []
        for sign in (1, -1):
            motion = [x.copy() for x in (q, w, a)]
            motion[k // 3][:, k % 3] += sign * step
            moved.append(module.mechanical_friction_torque(*motion, given))

        assert np.allclose((moved[0] - moved[1]) / (2 * step), slopes[..., k], rtol=2e-5, atol=1e-6 * scale)


def moments(chain: Chain) -> dict[str, float]:
    """The inertial parameters of a chain by their names."""
    found = {}
    for j, (joint, body) in enumerate(zip(chain.joints, chain.bodies, strict=True)):
        own = body.moments
        found |= {f"mass_{j}": float(own.mass), f"J_m_{j}": float(joint.J_m)}
        for k, axis in enumerate("xyz"):
            found[f"h_{j}_{axis}"] = float(own.first[k])
            found |= {f"Sigma_{j}_{axis}{'xyz'[i]}": float(own.second[k, i]) for i in range(k, 3)}
    return found


def summed(words: str, values: dict[str, float]) -> float:
    """What a line such as "mass_1 + 0.4 h_2_x - mass_3" adds up to."""
    signs = words.replace(" - ", " + -").split(" + ")
    total = 0.0
    for term in signs:
        factor, _, name = term.rpartition(" ")
        sign = -1.0 if name.startswith("-") else 1.0
        total += sign * float(factor or 1) * values[name.removeprefix("-")]
    return total


@pytest.mark.parametrize("n", [2, *(pytest.param(n, marks=pytest.mark.slow) for n in (1, 5))])
def test_the_inertial_regressor_times_the_base_parameters(n: int) -> None:
    """The torques of random chains, by columns that are independent, from sums that are printed."""
    chain = random_chain(np.random.default_rng(30 + n), n, geared=True, rotors=True)
    module = emitted(chain)
    q, w, a = motions(np.random.default_rng(31), n, 400)
    columns = module.inertial_regressor(q, w, a).reshape(len(q) * n, -1)
    base = np.array([summed(words, moments(chain)) for words in module.INERTIAL_PARAMETERS])
    expected = module.inverse_dynamics(q, w, a).ravel()
    scaled = columns / np.linalg.norm(columns, axis=0)

    # Sums are printed to six digits.
    assert np.max(np.abs(columns @ base - expected)) < 1e-5 * np.max(np.abs(expected))
    assert np.linalg.svd(scaled, compute_uv=False)[-1] > 1e-6


def test_two_links_have_the_textbooks_parameters() -> None:
    """Two links in a plane: their first moments, and their inertias about the joints."""
    expected = (
        "h_0_x",
        "h_0_y - 0.4 mass_1",
        "Sigma_0_xx + Sigma_0_yy + 0.16 mass_1 + J_m_0 - J_m_1",
        "h_1_x",
        "h_1_y",
        "Sigma_1_xx + Sigma_1_yy + J_m_1",
    )

    assert expected == emitted(TWO_LINKS).INERTIAL_PARAMETERS


def test_as_many_base_parameters_as_pinocchio_finds() -> None:
    """The rank of Pinocchio's regressor: another formula, and other parameters."""
    pin = pytest.importorskip("pinocchio", reason="Pinocchio (`pip install pin`) is not installed")
    from tests.test_chain_pinocchio import pinocchio_of

    chain = random_chain(np.random.default_rng(33), 4, aligned=True)
    model, data = pinocchio_of(chain)
    rows = [
        pin.computeJointTorqueRegressor(model, data, *motion).copy()
        for motion in zip(*motions(np.random.default_rng(34), 4, 60), strict=True)
    ]
    ours = [name for name in emitted(chain).INERTIAL_PARAMETERS if not name.startswith("J_m")]

    assert len(ours) == np.linalg.matrix_rank(np.vstack(rows), tol=1e-8)


def test_a_slide_shows_one_sum() -> None:
    """Without gravity, mass and rotor of one slide cannot be told apart."""
    still = Chain("still", [Joint("prismatic", placement=Placement())], [Body(0)], (0, 0, 0))

    assert emitted(still).INERTIAL_PARAMETERS == ("mass_0 + J_m_0",)


def test_an_unknown_function_is_refused() -> None:
    """The message lists those of an arm."""
    with pytest.raises(InputError, match=r"one of inverse_dynamics, .* got 'inverse_dynamic'"):
        emitted(TWO_LINKS, "inverse_dynamic")
