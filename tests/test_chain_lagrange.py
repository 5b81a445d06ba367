"""The recursion beside Lagrange: energies, differentiated, give the same torques; and no power is lost."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import mpmath as mp
import numpy as np
import pytest
import sympy as sp

from eccentric.model import Body, Chain, Joint, Load, Placement, Sgn, arm, quantity, recursion
from tests.arms import behind, evaluated, number, random_chain

ONE, ZERO = sp.Integer(1), sp.Integer(0)
# All is done with polynomials in the letters of the arm and in sine, cosine, velocity and acceleration of
# every motor; a derivative in time is the chain rule over these.


@dataclass(frozen=True)
class Part:
    """A joint and its body, for Lagrange.

    Attributes:
        motion: the transform of its frame in the parent's, from cosine and sine of its angle.
        axis: of its rotor, in the parent's frame.
        body: mass, centre of mass, inertia about it (letters by name).
        mu, J_m: gear ratio and inertia of the rotor.
    """

    motion: Callable[[Any, Any], sp.Matrix]
    axis: tuple[int, int, int]
    body: tuple[sp.Expr, tuple, sp.Matrix]
    mu: sp.Expr = ONE
    J_m: sp.Expr = ZERO


class Motion:
    """The letters of n motors: cosine and sine of the joint, velocity and acceleration of the motor."""

    def __init__(self, parts: list[Part]) -> None:
        n = range(len(parts))
        self.cos, self.sin, self.velocity, self.acceleration, self.angle = (
            [sp.Symbol(f"{name}{k}") for k in n] for name in ("c", "s", "v", "a", "q")
        )
        self.mu = [part.mu for part in parts]
        every = (*self.cos, *self.sin, *self.velocity, *self.acceleration, *self.angle)
        own = set().union(
            *(sp.Matrix([*p.body[1], *p.body[2], p.body[0], p.mu, p.J_m]).free_symbols for p in parts)
        )
        self.others = sorted(own, key=str)
        self.every = every

    def by_angle(self, f: Any, k: int) -> Any:
        """The derivative by the angle of motor k."""
        return self.mu[k] * (self.cos[k] * f.diff(self.sin[k]) - self.sin[k] * f.diff(self.cos[k]))

    def rate(self, f: Any) -> Any:
        """The derivative in time."""
        return sp.Add(
            *(
                self.by_angle(f, k) * self.velocity[k] + f.diff(self.velocity[k]) * self.acceleration[k]
                for k in range(len(self.cos))
            )
        )


def lagrange(parts: list[Part], gravity: tuple, motion: Motion) -> list[sp.Expr]:
    """Torque of every motor: d/dt dT/dv - dT/dq + dV/dq."""
    pose, L = sp.eye(4), sp.Integer(0)
    for k, part in enumerate(parts):
        # The rotor is carried by the parent, whose inertia has it locked: what its own turning adds.
        own, carrier = motion.velocity[k], spin(pose, motion)
        L += part.J_m * (own**2 / 2 + own * sp.Matrix(part.axis).dot(carrier))
        pose = pose * part.motion(motion.cos[k], motion.sin[k])
        mass, centre, inertia = part.body
        place = (pose * sp.Matrix([*centre, 1]))[:3, :]
        speed, turning = place.applyfunc(motion.rate), spin(pose, motion)
        L += mass * speed.dot(speed) / 2 + turning.dot(inertia * turning) / 2
        L += mass * sp.Matrix(gravity).dot(place)
    return [motion.rate(L.diff(v)) - motion.by_angle(L, k) for k, v in enumerate(motion.velocity)]


def spin(pose: sp.Matrix, motion: Motion) -> sp.Matrix:
    """The angular velocity in the frame's own components."""
    R = pose[:3, :3]
    found = R.T * R.applyfunc(motion.rate)
    return sp.Matrix([found[2, 1], found[0, 2], found[1, 0]])


def turn(axis: str, c: Any, s: Any) -> sp.Matrix:
    """Rotation about an axis, as a transform."""
    rows = {
        "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }
    return sp.Matrix(rows[axis]).row_join(sp.zeros(3, 1)).col_join(sp.Matrix([[0, 0, 0, 1]]))


def move(x: Any, y: Any, z: Any) -> sp.Matrix:
    """Displacement, as a transform."""
    return sp.eye(3).row_join(sp.Matrix([x, y, z])).col_join(sp.Matrix([[0, 0, 0, 1]]))


def differences(chain: Chain, parts: list[Part]) -> list[Any]:
    """Our motor torque minus Lagrange's for every joint: polynomials, reduced by sin^2 + cos^2 = 1."""
    motion = Motion(parts)
    theirs = lagrange(parts, tuple(chain.gravity), motion)
    model = arm(chain, "arm")
    ours = [model.balance(f"mechanical_{j}").sum_of("inertial", "bodies") for j in range(len(parts))]
    letters = sorted(set().union(*(x.free_symbols for x in theirs), motion.every), key=str)
    ring, *gens = sp.ring([x.name for x in letters], sp.QQ)
    known = dict(zip((x.name for x in letters), gens, strict=True))
    place = {name: known.get(name, ring(0)) for name in (q.name for q in model.parameters)}
    for k in range(len(parts)):
        for ours_is, theirs_is in (("theta_m", "q"), ("omega_m", "v"), ("alpha_m", "a")):
            place[f"{ours_is}_{k}"] = known[f"{theirs_is}{k}"]
    sines = [(evaluate(mu * q, known), known[s.name], known[c.name]) for mu, q, s, c in zip(
        motion.mu, motion.angle, motion.sin, motion.cos, strict=True)]  # fmt: skip
    sin = {angle: s for angle, s, _ in sines} | {-angle: -s for angle, s, _ in sines}
    cos = {sign * angle: c for angle, _, c in sines for sign in (1, -1)}
    found = evaluated(
        behind(model.definitions, ours),
        {sp.Symbol(name): value for name, value in place.items()},
        {"sin": sin.__getitem__, "cos": cos.__getitem__},
    )
    values = {symbol.name: value for symbol, value in found.items()}
    circles = [
        known[s.name] ** 2 + known[c.name] ** 2 - 1 for s, c in zip(motion.sin, motion.cos, strict=True)
    ]
    return [
        (evaluate(mine, values) - evaluate(other, known)).rem(circles)
        for mine, other in zip(ours, theirs, strict=True)
    ]


def evaluate(expression: sp.Expr, values: dict[str, Any]) -> Any:
    """An expression in ring elements."""
    text = sp.sstr(expression).replace("/2", "*half").replace("/3", "*third").replace("/7", "*seventh")
    fractions = {"half": sp.QQ(1, 2), "third": sp.QQ(1, 3), "seventh": sp.QQ(1, 7)}
    return eval(text, {}, values | fractions)  # noqa: S307 - printed by SymPy


def parameters(*names: str) -> tuple:
    """Quantities of these names; units do not matter here."""
    return tuple(quantity(name, "1", name) for name in names)


def body(k: int) -> tuple[tuple, Body, tuple]:
    """A body with all ten parameters as letters."""
    names = [
        f"m{k}",
        *(f"c{k}{a}" for a in "xyz"),
        *(f"I{k}{a}" for a in ("xx", "xy", "xz", "yy", "yz", "zz")),
    ]
    given = parameters(*names)
    m, cx, cy, cz, xx, xy, xz, yy, yz, zz = (q.symbol for q in given)
    inertia = sp.Matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return given, Body(m, (cx, cy, cz), inertia.tolist()), (m, (cx, cy, cz), inertia)


def test_a_planar_arm_with_rotors_is_that_of_lagrange() -> None:
    """2R in a vertical plane: ten parameters for each body, two gears, two rotors."""
    given = parameters("mu0", "mu1", "J0", "J1", "l", "g")
    mu0, mu1, J0, J1, length, g = (q.symbol for q in given)
    bodies = [body(0), body(1)]
    chain = Chain(
        "planar",
        [Joint(mu=mu0, J_m=J0), Joint(mu=mu1, J_m=J1, placement=Placement((length, 0, 0)))],
        [b[1] for b in bodies],
        (0, -g, 0),
        parameters=(*given, *bodies[0][0], *bodies[1][0]),
    )
    parts = [
        Part(lambda c, s: turn("z", c, s), (0, 0, 1), bodies[0][2], mu0, J0),
        Part(lambda c, s: move(length, 0, 0) * turn("z", c, s), (0, 0, 1), bodies[1][2], mu1, J1),
    ]

    assert [0, 0] == differences(chain, parts)


@pytest.mark.slow
def test_an_arm_in_space_is_that_of_lagrange() -> None:
    """3R, a turret with shoulder and elbow; rotors turn in frames that turn: gyroscopic torque and all."""
    given = parameters("J0", "J1", "J2", "l1", "l2", "g")
    J0, J1, J2, l1, l2, g = (q.symbol for q in given)
    bodies = [body(k) for k in range(3)]
    chain = Chain(
        "turret",
        [
            Joint(axis=(0, 0, 1), J_m=J0),
            Joint(axis=(0, 1, 0), J_m=J1, placement=Placement((0, 0, l1)), mu="1/7"),
            Joint(axis=(-1, 0, 0), J_m=J2, placement=Placement((l2, 0, 0)), mu="1/3"),
        ],
        [b[1] for b in bodies],
        (0, 0, -g),
        parameters=(*given, *bodies[0][0], *bodies[1][0], *bodies[2][0]),
    )
    seventh, third = sp.Rational(1, 7), sp.Rational(1, 3)
    parts = [
        Part(lambda c, s: turn("z", c, s), (0, 0, 1), bodies[0][2], J_m=J0),
        Part(lambda c, s: move(0, 0, l1) * turn("y", c, s), (0, 1, 0), bodies[1][2], seventh, J1),
        Part(lambda c, s: move(l2, 0, 0) * turn("x", c, -s), (-1, 0, 0), bodies[2][2], third, J2),
    ]

    assert [0, 0, 0] == differences(chain, parts)


def test_a_mass_on_a_slide_is_the_textbooks() -> None:
    """Inclined by beta, the drive passes on m (a + g sin beta) and the guide carries m g cos beta."""
    given = parameters("m", "beta", "g")
    m, beta, g = (q.symbol for q in given)

    chain = Chain(
        "slide",
        [Joint("prismatic", (1, 0, 0))],
        [Body(m)],
        (-g * sp.sin(beta), 0, -g * sp.cos(beta)),
        parameters=given,
    )
    found = recursion(chain)
    model = arm(chain, "slide", found=found)
    acceleration = found.inputs[0].alpha_m.symbol
    across = model.expand(found.bearings[0].loads[Load.NORMAL])

    assert sp.expand(model.expand(found.torques[0]) - m * (acceleration + g * sp.sin(beta))) == 0
    assert sp.expand(across**2 - (m * g * sp.cos(beta)) ** 2) == 0


def test_a_pendulum_on_a_cart_is_the_textbooks() -> None:
    """(M+m) x'' + m l (a cos - w^2 sin) and m l^2 a + m l x'' cos + m g l sin, from the lowest point."""
    given = parameters("M", "m", "l", "g")
    M, m, length, g = (q.symbol for q in given)
    chain = Chain(
        "cart",
        [Joint("prismatic", (1, 0, 0)), Joint()],
        [Body(M), Body(m, (0, -length, 0))],
        (0, -g, 0),
        parameters=given,
    )

    found = recursion(chain)
    model = arm(chain, "cart", found=found)
    cart, pendulum = found.inputs
    theta, w, a = pendulum.theta_m.symbol, pendulum.omega_m.symbol, pendulum.alpha_m.symbol
    x = cart.alpha_m.symbol
    c, s = sp.cos(theta), sp.sin(theta)
    push, torque = (sp.expand(model.expand(found.torques[k])).subs(s**2, 1 - c**2) for k in (0, 1))

    assert 0 == sp.expand(push - (M + m) * x - m * length * (a * c - w**2 * s))
    assert 0 == sp.expand(torque - m * length**2 * a - m * length * x * c - m * g * length * s)


# Nothing is lost along a chain: what the motors deliver is stored as energy or dissipated by friction.


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
