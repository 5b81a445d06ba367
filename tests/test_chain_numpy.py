"""The NumPy module of a chain: the textbook's arm, the rotating link, arrays of samples, single precision."""

from types import ModuleType

import numpy as np
import pytest

from eccentric.emission import executed, load_module, render
from eccentric.model import Body, Chain, Joint, Placement, arm, load_model, recursion
from eccentric.model import vocabulary as v
from tests.arms import evaluated, number, random_chain

g, m_0, m_1, l_0, c_0, c_1, I_0, I_1 = 9.81, 2.0, 1.5, 0.4, 0.2, 0.15, 0.03, 0.02
TWO_LINKS = Chain(
    "two_links",
    [Joint(), Joint(placement=Placement((0, -l_0, 0)))],
    [
        Body(m_0, (0, -c_0, 0), np.diag([I_0, 0, I_0])),
        Body(m_1, (0, -c_1, 0), np.diag([I_1, 0, I_1])),
    ],
    (0, -g, 0),
)


def emitted(chain: Chain) -> ModuleType:
    """The module of a chain, from memory."""
    return executed(render(arm(chain, "An arm"), "a test", "a test"), chain.name)


@pytest.fixture(scope="module")
def two_links() -> ModuleType:
    """The arm of two links."""
    return emitted(TWO_LINKS)


def motions(rng: np.random.Generator, n: int, samples: int = 50) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angles over several turns, velocities, accelerations; shape (samples, n)."""
    q, w, a = (rng.normal(size=(samples, n)) * scale for scale in (6, 4, 20))
    return q, w, a


def test_two_links_are_those_of_the_textbook(two_links: ModuleType) -> None:
    """Torques and normal forces of the planar arm, by its closed formulas."""
    q, w, a = motions(np.random.default_rng(1), 2)
    (q0, q1), (w0, w1), (a0, a1) = q.T, w.T, a.T
    both = q0 + q1
    outer = (
        (I_1 + m_1 * c_1**2) * (a0 + a1)
        + m_1 * l_0 * c_1 * (np.cos(q1) * a0 + np.sin(q1) * w0**2)
        + m_1 * g * c_1 * np.sin(both)
    )
    inner = (
        (I_0 + m_0 * c_0**2 + m_1 * l_0**2) * a0
        + m_1 * l_0 * c_1 * (np.cos(q1) * (a0 + a1) - np.sin(q1) * (w0 + w1) ** 2)
        + (m_0 * c_0 + m_1 * l_0) * g * np.sin(q0)
        + outer
    )
    # Newton in the frame of the base: what hangs on joint 1, and on joint 0.
    away = np.array([np.cos(q0), np.sin(q0)]), np.array([np.cos(both), np.sin(both)])
    up = np.array([-np.sin(q0), np.cos(q0)]), np.array([-np.sin(both), np.cos(both)])
    elbow = l_0 * (a0 * away[0] + w0**2 * up[0])
    of_1 = m_1 * (elbow + c_1 * ((a0 + a1) * away[1] + (w0 + w1) ** 2 * up[1]) + [[0], [g]])
    of_0 = of_1 + m_0 * (c_0 * (a0 * away[0] + w0**2 * up[0]) + [[0], [g]])
    loads = dict(zip(two_links.BEARING_LOADS, two_links.bearing_loads(q, w, a).T, strict=True))

    assert np.allclose(
        np.stack([inner, outer], -1), two_links.inverse_dynamics(q, w, a), rtol=1e-12, atol=1e-12
    )
    assert np.allclose(np.hypot(*of_1), loads["F_N_1"], rtol=1e-12)
    assert np.allclose(np.hypot(*of_0), loads["F_N_0"], rtol=1e-12)
    assert np.allclose(np.abs(inner), loads["T_0"], rtol=1e-12, atol=1e-12)


def test_one_joint_with_letters_is_the_rotating_link() -> None:
    """With the paper's parameters at run time, the load is that of the emitted rotating link."""
    letters = (v.M, v.M_l, v.L, v.mu, v.g, v.J_l, v.J_m)
    M, M_l, L, mu, gravity, J_l, J_m = (q.symbol for q in letters)
    chain = Chain(
        "link",
        [Joint(mu=mu, J_m=J_m)],
        [Body(M_l, inertia=[[0, 0, 0], [0, 0, 0], [0, 0, J_l - M * L**2]])],
        (0, -gravity, 0),
        Body(M, (0, -L, 0)),
        letters,
    )
    ours, papers = emitted(chain), load_module(load_model("rotating_link"))
    values = {"M": 0.4, "M_l": 0.3, "L": 0.2, "mu": 0.25, "J_l": 0.05, "J_m": 0.002}
    q, w, a = motions(np.random.default_rng(2), 1)
    F_N = papers.normal_force(q[:, 0], w[:, 0], a[:, 0], papers.Parameters(**values))
    G = papers.gravity_torque(q[:, 0], papers.Parameters(**values))
    loads = ours.bearing_loads(q, w, a, ours.Parameters(**values))
    torque = ours.inverse_dynamics(q, w, a, ours.Parameters(**values))[:, 0]

    assert np.allclose(F_N, loads[:, ours.BEARING_LOADS.index("F_N_0")], rtol=1e-12)
    assert np.allclose(G + (0.002 + 0.25**2 * 0.05) * a[:, 0], torque, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("n", [3, pytest.param(5, marks=pytest.mark.slow)])
def test_a_random_chain_is_its_recursion(n: int) -> None:
    """All functions of joints with gears, rotors and slides agree with the definitions, one by one."""
    rng = np.random.default_rng(3)
    chain = random_chain(rng, n, geared=True, rotors=True)
    found, module = recursion(chain), emitted(chain)
    q, w, a = motions(rng, n, 3)
    torques, wrenches = module.inverse_dynamics(q, w, a), module.joint_wrenches(q, w, a)
    for k in range(3):
        given = {}
        for inputs, *values in zip(found.inputs, q[k], w[k], a[k], strict=True):
            symbols = (inputs.theta_m.symbol, inputs.omega_m.symbol, inputs.alpha_m.symbol)
            given |= dict(zip(symbols, map(float, values), strict=True))
        known = evaluated(found.definitions, given)
        for j, (joint, link) in enumerate(zip(chain.joints, found.chain.links, strict=True)):
            expected = number(found.rotors[j] + joint.mu * found.torques[j], known)
            tilt = np.array(link.tilt.tolist(), dtype=float)
            force = tilt @ [number(x, known) for x in found.wrenches[j].force]
            largest = np.max(np.abs(wrenches[k]))

            assert pytest.approx(expected, rel=1e-11, abs=1e-12 * largest) == torques[k, j]
            assert np.allclose(force, wrenches[k, 6 * j : 6 * j + 3], rtol=1e-11, atol=1e-12 * largest)


def test_samples_are_the_first_axes(two_links: ModuleType) -> None:
    """The joints are the last axis; any shape before it, and each sample as if it were alone."""
    q, w, a = (x.reshape(5, 10, 2) for x in motions(np.random.default_rng(4), 2))
    wrenches = two_links.joint_wrenches(q, w, a)

    assert (5, 10, 12) == wrenches.shape
    assert (12,) == two_links.joint_wrenches(q[1, 2], w[1, 2], a[1, 2]).shape
    assert np.array_equal(wrenches[1, 2], two_links.joint_wrenches(q[1, 2], w[1, 2], a[1, 2]))


def test_single_precision_stays(two_links: ModuleType) -> None:
    """float32 in, float32 out, right to its digits."""
    q, w, a = motions(np.random.default_rng(5), 2)
    short = [x.astype(np.float32) for x in (q, w, a)]
    exact = two_links.inverse_dynamics(*(x.astype(np.float64) for x in short))
    found = two_links.inverse_dynamics(*short)

    assert np.float32 == found.dtype
    assert np.allclose(exact, found, atol=2e-6 * np.max(np.abs(exact)))


def test_the_payload_is_a_parameter() -> None:
    """A payload with a letter for its mass: its weight appears at the joint without deriving again."""
    chain = Chain(
        "arm", [Joint()], [Body(1, (0, -0.1, 0))], (0, -g, 0), Body(v.M.symbol, (0, -0.5, 0)), (v.M,)
    )
    module = emitted(chain)
    level = np.array([np.pi / 2]), np.zeros(1), np.zeros(1)

    for mass in (0.0, 2.0):
        torque = module.inverse_dynamics(*level, module.Parameters(M=mass))
        assert torque == pytest.approx([g * (0.1 + 0.5 * mass)], rel=1e-15)
