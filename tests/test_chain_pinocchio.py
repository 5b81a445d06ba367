"""The recursion beside Pinocchio, another implementation: torques and joint wrenches of random chains."""

import numpy as np
import pytest

from eccentric.model import Body, Chain, Load, Recursion, recursion
from tests.arms import evaluated, number, random_chain

pin = pytest.importorskip("pinocchio", reason="Pinocchio (`pip install pin`) is not installed")
# Relative to the largest entry: both sides sum a few hundred products, each rounded to 2e-16.
AGREE = 1e-12


def pinocchio_of(chain: Chain) -> tuple:
    """The same chain in Pinocchio."""
    model = pin.Model()
    model.gravity.linear = np.array(chain.gravity.tolist(), dtype=float).ravel()
    parent = 0
    for joint, body in zip(chain.joints, chain.bodies, strict=True):
        assert isinstance(body, Body)
        axis, position, centre = (
            np.array(x.tolist(), dtype=float).ravel()
            for x in (joint.axis, joint.placement.position, body.centre)
        )
        rotation, inertia = (
            np.array(x.tolist(), dtype=float) for x in (joint.placement.rotation, body.inertia)
        )
        kind = pin.JointModelRevoluteUnaligned if joint.turns else pin.JointModelPrismaticUnaligned
        parent = model.addJoint(
            parent, kind(axis / np.linalg.norm(axis)), pin.SE3(rotation, position), joint.name
        )
        model.appendBodyToJoint(parent, pin.Inertia(float(body.mass), centre, inertia), pin.SE3.Identity())
    return model, model.createData()


def moved(found: Recursion, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> dict:
    """The inputs of a recursion by their symbols."""
    values = {}
    for inputs, motion in zip(found.inputs, zip(q, v, a, strict=True), strict=True):
        letters = (inputs.theta_m.symbol, inputs.omega_m.symbol, inputs.alpha_m.symbol)
        values |= dict(zip(letters, map(float, motion), strict=True))
    return values


def ours(found: Recursion, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Torques (n) and wrenches (n, 6), force first, in the frames of the joints as they were given."""
    known = evaluated(found.definitions, moved(found, q, v, a))
    wrenches = []
    for link, wrench in zip(found.chain.links, found.wrenches, strict=True):
        tilt = np.array(link.tilt.tolist(), dtype=float)
        parts = (np.array([number(x, known) for x in part]) for part in (wrench.force, wrench.moment))
        wrenches.append(np.concatenate([tilt @ part for part in parts]))
    return np.array([number(torque, known) for torque in found.torques]), np.array(wrenches)


def loads(chain: Chain, wrenches: np.ndarray) -> list[dict[Load, float]]:
    """What each bearing carries, from the definition: across and along the axis, about its centre."""
    found = []
    for joint, wrench in zip(chain.joints, wrenches, strict=True):
        axis = np.array(joint.axis.tolist(), dtype=float).ravel()
        force, moment = wrench[:3], wrench[3:]
        centred = moment - np.cross(float(joint.bearing) * axis, force)
        across = {Load.NORMAL: np.linalg.norm(np.cross(axis, force))}
        if joint.turns:
            across |= {
                Load.BENDING: np.linalg.norm(np.cross(axis, centred)),
                Load.TRANSVERSAL: abs(axis @ force),
                Load.TRANSMITTED: abs(axis @ moment),
            }
        else:
            across |= {Load.BENDING: np.linalg.norm(centred), Load.TRANSMITTED: abs(axis @ force)}
        found.append({load: float(value) for load, value in across.items()})
    return found


def deviation(chain: Chain, rng: np.random.Generator) -> float:
    """The largest difference to Pinocchio over three motions, relative to the largest entry."""
    model, data = pinocchio_of(chain)
    found, worst = recursion(chain), 0.0
    for _ in range(3):
        q, v, a = (rng.normal(size=len(chain.joints)) * scale for scale in (2, 3, 5))
        torques = pin.rnea(model, data, q, v, a)
        wrenches = np.array([data.f[k + 1].vector for k in range(len(q))])
        for mine, theirs in zip(ours(found, q, v, a), (torques, wrenches), strict=True):
            worst = max(worst, float(np.max(np.abs(mine - theirs)) / np.max(np.abs(theirs))))
    return worst


@pytest.mark.parametrize("aligned", [False, True], ids=["oblique", "aligned"])
@pytest.mark.parametrize("n", [1, 2, 3, *(pytest.param(n, marks=pytest.mark.slow) for n in (6, 7, 12))])
def test_torques_and_wrenches_are_those_of_pinocchio(n: int, aligned: bool) -> None:
    """Random chains with revolute and prismatic joints, gravity in any direction: equal to 1e-12."""
    rng = np.random.default_rng(100 + n)
    worst = max(deviation(random_chain(rng, n, aligned=aligned), rng) for _ in range(2))

    assert worst < AGREE


@pytest.mark.parametrize("aligned", [False, True], ids=["oblique", "aligned"])
def test_bearings_carry_what_pinocchios_wrenches_give(aligned: bool) -> None:
    """F_N, F_T, M_B about the bearing's centre and the transmitted torque, behind gears, of five joints."""
    rng = np.random.default_rng(7)
    chain = random_chain(rng, 5, aligned=aligned, geared=True)
    model, data = pinocchio_of(chain)
    found = recursion(chain)
    mu = np.array([float(joint.mu) for joint in chain.joints])
    q, v, a = (rng.normal(size=5) * scale for scale in (2, 3, 5))
    pin.rnea(model, data, mu * q, mu * v, mu * a)
    expected = loads(chain, np.array([data.f[k + 1].vector for k in range(5)]))
    known = evaluated(found.definitions, moved(found, q, v, a))

    for bearing, theirs in zip(found.bearings, expected, strict=True):
        ours = {load: number(value, known) for load, value in bearing.loads.items()}
        assert pytest.approx(theirs, rel=1e-11) == ours
