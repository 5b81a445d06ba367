"""Nothing is lost along a chain: what the motors deliver is stored as energy or dissipated by friction."""

import mpmath as mp
import numpy as np
import pytest
import sympy as sp

from eccentric.model import Body, Chain, Load, Sgn, arm, recursion
from tests.arms import evaluated, number, random_chain

CLOSES = 1e-13
"""Of the sum of the powers' sizes: some hundred roundings of 1e-16 each."""
STEP = mp.mpf(10) ** -20  # central differences in 80 digits: right to 40

LETTERS = {Load.NORMAL: "lN", Load.TRANSVERSAL: "lT", Load.BENDING: "lM", Load.TRANSMITTED: "lG"}


def rotation(axis: mp.matrix, angle: mp.mpf) -> mp.matrix:
    """Rodrigues' formula."""
    S = mp.matrix([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return mp.eye(3) + mp.sin(angle) * S + (1 - mp.cos(angle)) * S * S


def exactly(matrix: object) -> mp.matrix:
    """A matrix of the chain in 80 digits."""
    rows = matrix.tolist()  # pyright: ignore[reportAttributeAccessIssue]
    return mp.matrix([[mp.mpf(int(x.p)) / int(x.q) for x in row] for row in rows])


def one(x: object) -> mp.mpf:
    """An exact number in 80 digits."""
    return mp.mpf(int(x.p)) / int(x.q)  # pyright: ignore[reportAttributeAccessIssue]


def poses(chain: Chain, angles: list[mp.mpf]) -> list[tuple[mp.matrix, mp.matrix]]:
    """Rotation and origin of every body, the base first, by plain forward kinematics."""
    R, r = mp.eye(3), mp.zeros(3, 1)
    found = [(R, r)]
    for joint, theta in zip(chain.joints, angles, strict=True):
        q = one(joint.mu) * theta
        axis = exactly(joint.axis)
        r = r + R * exactly(joint.placement.position)
        R = R * exactly(joint.placement.rotation)
        if joint.turns:
            R = R * rotation(axis, q)
        else:
            r = r + R * axis * q
        found.append((R, r))
    return found


def energy(chain: Chain, motion: list[tuple[float, float, float]], time: mp.mpf) -> mp.mpf:
    """Kinetic and potential energy along theta + omega t + alpha t^2/2, of bodies and of rotors."""

    def at(moment: mp.mpf) -> list[tuple[mp.matrix, mp.matrix]]:
        return poses(chain, [mp.mpf(q) + v * moment + a * moment**2 / 2 for q, v, a in motion])

    before, now, after = at(time - STEP), at(time), at(time + STEP)
    total, gravity, carrier = mp.mpf(0), exactly(chain.gravity), mp.zeros(3, 1)
    for k, (joint, body) in enumerate(zip(chain.joints, chain.bodies, strict=True), start=1):
        (R_0, r_0), (R, r), (R_1, r_1) = before[k], now[k], after[k]
        assert isinstance(body, Body)
        centre, inertia, mass = exactly(body.centre), exactly(body.inertia), one(body.mass)
        speed = ((r_1 + R_1 * centre) - (r_0 + R_0 * centre)) / (2 * STEP)
        S = R.T * (R_1 - R_0) / (2 * STEP)
        spin = mp.matrix([S[2, 1], S[0, 2], S[1, 0]])
        total += mass * (speed.T * speed)[0] / 2 + (spin.T * inertia * spin)[0] / 2
        total -= mass * (gravity.T * (r + R * centre))[0]
        _, v, a = motion[k - 1]
        own = v + a * time
        axis = exactly(joint.placement.rotation) * exactly(joint.axis)
        total += one(joint.J_m) * (own**2 / 2 + own * (axis.T * carrier)[0])
        carrier = spin
    return total


@pytest.mark.parametrize("n", [1, 2, 3, 7])
def test_the_sum_of_powers_closes(n: int) -> None:
    """Motor power is the change of kinetic and potential energy, rotors included, plus that of friction."""
    rng = np.random.default_rng(n)
    chain = random_chain(rng, n, geared=True, rotors=True)
    found = recursion(chain)
    model = arm(chain, "arm", found=found)
    constants = {q.symbol: rng.uniform(0.01, 0.1) for q in model.parameters}
    for _ in range(2):
        motion = [(float(q), float(v), float(a)) for q, v, a in rng.normal(size=(n, 3)) * (2, 3, 5)]
        given = {}
        for inputs, values in zip(found.inputs, motion, strict=True):
            letters = (inputs.theta_m.symbol, inputs.omega_m.symbol, inputs.alpha_m.symbol)
            given |= dict(zip(letters, values, strict=True))
        known = evaluated(found.definitions, given | constants)
        powers, lost = [], []
        for j, (joint, (_, v, _)) in enumerate(zip(chain.joints, motion, strict=True)):
            balance = model.balance(f"mechanical_{j}")
            torque = balance.sum_of("inertial", "bodies", "friction").replace(Sgn, sp.sign)
            powers.append(number(torque, known) * v)
            on_link = float(joint.mu) * abs(v)
            coefficients = {q.name: constants[q.symbol] for q in model.parameters}
            for load, letter in LETTERS.items():
                size = found.bearings[j].loads.get(load)
                if size is not None:
                    B, C = coefficients[f"B_{letter}_{j}"], coefficients[f"C_{letter}_{j}"]
                    lost.append(number(size, known) * (B * on_link**2 + C * on_link))
            lost.append(coefficients[f"B_m_{j}"] * v**2 + coefficients[f"C_m_{j}"] * abs(v))
        with mp.workdps(80):
            stored = (energy(chain, motion, STEP) - energy(chain, motion, -STEP)) / (2 * STEP)
        gap = sum(powers) - float(stored) - sum(lost)

        assert min(lost) > 0
        assert abs(gap) < CLOSES * (sum(map(abs, powers)) + sum(lost))
