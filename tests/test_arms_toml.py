"""Arm files: what they say is the chain that comes out, in SI, exact, symbolic where they ask for it."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

from eccentric.model import Body, Chain, Recursion, recursion
from eccentric.rigs import read_arm
from tests.arms import behind, bodies_of, evaluated, number

ARMS = Path(__file__).resolve().parents[1] / "examples" / "arms"


def written(folder: Path, text: str, name: str = "arm.toml") -> Path:
    """The path of a file with this text."""
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def torques(found: Recursion, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """Torques of the joints at motor angles, velocities and accelerations, parameters at their defaults."""
    values = {p.symbol: float(p.default or 0) for p in found.chain.parameters}
    for inputs, motion in zip(found.inputs, zip(q, v, a, strict=True), strict=True):
        letters = (inputs.theta_m.symbol, inputs.omega_m.symbol, inputs.alpha_m.symbol)
        values |= dict(zip(letters, map(float, motion), strict=True))
    known = evaluated(behind(found.definitions, found.torques), values)
    return np.array([number(torque, known) for torque in found.torques])


def test_the_planar_arm_moves_as_the_textbook_says() -> None:
    """Torques of the shipped 2R arm with its weight are those of the textbook's equations of motion."""
    chain = read_arm(ARMS / "planar_2r.toml")
    mu, g, l_0 = np.array([1 / 9, 1 / 6]), 9.81, 0.3
    q, v, a = np.array([0.7, -1.9]), np.array([3.1, 2.3]), np.array([-4.0, 9.0])
    # Link 1 and the weight as one: masses, first moments, inertia about the joint.
    mass, first = 0.42 + 0.5, 0.42 * 0.118 + 0.5 * 0.25
    about = 0.0031 + 0.42 * 0.118**2 + 2500e-7 + 0.5 * 0.25**2
    outer = (
        about * (a[0] + a[1])
        + l_0 * first * (math.cos(q[1]) * a[0] + math.sin(q[1]) * v[0] ** 2)
        + first * g * math.sin(q[0] + q[1])
    )
    inner = (
        (0.0162 + 1.35 * 0.21**2 + mass * l_0**2) * a[0]
        + l_0 * first * (math.cos(q[1]) * (a[0] + a[1]) - math.sin(q[1]) * (v[0] + v[1]) ** 2)
        + (1.35 * 0.21 + mass * l_0) * g * math.sin(q[0])
        + outer
        + 210e-7 * a[1] / mu[1]  # the rotor of the elbow, carried by the first link
    )

    assert pytest.approx([inner, outer], rel=1e-12) == torques(recursion(chain), q / mu, v / mu, a / mu)


def test_the_arm_of_six_joints_carries_its_weight() -> None:
    """Stretched to the side, the shoulder holds the moment of all outer weights; names and gears are read."""
    chain = read_arm(ARMS / "six_joints.toml")
    names = ["base", "shoulder", "elbow", "forearm", "wrist", "flange"]
    assert names == [joint.name for joint in chain.joints]
    assert [sp.Rational(1, k) for k in (120, 120, 100, 80, 80, 50)] == [j.mu for j in chain.joints]
    # Mass, distance along the arm and across it, from the shoulder.
    outer = [
        (8.9, 0.176, 0.003), (4.3, 0.42 + 0.074, 0.012), (2.6, 0.61 + 0.118, 0.03), (1.3, 0.83 + 0.021, 0.03),
        (0.31, 0.83 + 0.078, 0.03), (3.0, 0.83 + 0.15, 0.03),
    ]  # fmt: skip
    moment = -9.81 * sum(mass * along for mass, along, _ in outer)

    rest = np.zeros(6)
    found = torques(recursion(chain), np.array([0, 120 * math.pi / 2, 0, 0, 0, 0]), rest, rest)
    assert pytest.approx(moment, rel=1e-12) == found[1]


# Universal Robots' table of the UR10e: a, d, alpha, and mass and centre of mass in the frames of the table.
UR10E = (
    (0.0, 0.1807, math.pi / 2, 7.369, (0.021, 0.000, 0.027)),
    (-0.6127, 0.0, 0.0, 13.051, (0.38, 0.000, 0.158)),
    (-0.57155, 0.0, 0.0, 3.989, (0.24, 0.000, 0.068)),
    (0.0, 0.17415, math.pi / 2, 2.1, (0.000, 0.007, 0.018)),
    (0.0, 0.11985, -math.pi / 2, 1.98, (0.000, 0.007, 0.018)),
    (0.0, 0.11655, 0.0, 0.615, (0.0, 0.0, -0.026)),
)


def test_denavit_and_hartenberg_hold_the_arm_up(tmp_path: Path) -> None:
    """A UR10e by its maker's table: the torques at rest are the gradient of the potential energy.

    The energy comes from products of the table's matrices, its gradient from a complex step.
    """
    text = 'name = "ur10e"\n' + "".join(
        f'[[joint]]\nname = "joint {k}"\n'
        f'dh = {{ a_m = {a}, d = "{1e3 * d!r} mm", alpha = "{math.degrees(alpha)} deg", theta_rad = 0.1 }}\n'
        f"body = {{ mass_kg = {mass}, centre_m = {list(centre)} }}\n"
        for k, (a, d, alpha, mass, centre) in enumerate(UR10E)
    )
    text += '[payload]\nmass = "2 kg"\ncentre = [0, 0, "50 mm"]\n'

    def energy(q: np.ndarray) -> complex:
        place, found = np.eye(4, dtype=complex), 0j
        for k, (a, d, alpha, mass, centre) in enumerate(UR10E):
            c, s, ca, sa = np.cos(q[k] + 0.1), np.sin(q[k] + 0.1), math.cos(alpha), math.sin(alpha)
            place = place @ np.array(
                [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
            )
            found += mass * 9.81 * (place @ [*centre, 1])[2]
        return found + 2 * 9.81 * (place @ [0, 0, 0.05, 1])[2]

    q, rest = np.array([0.3, -1.1, 0.8, -2.0, 1.3, 0.4]), np.zeros(6)
    gradient = [energy(q + 1e-30j * row).imag / 1e-30 for row in np.eye(6)]

    found = torques(recursion(read_arm(written(tmp_path, text))), q, rest, rest)
    assert pytest.approx(gradient, rel=1e-12, abs=1e-12) == found


def same(one: Chain, other: Chain) -> bool:
    """Whether two chains have equal links, gravity and parameters."""
    seen = [
        [
            (x.joint.mu, x.joint.J_m, x.joint.bearing, x.axis, x.rotation, x.position, x.moments)
            for x in c.links
        ]
        for c in (one, other)
    ]
    return seen[0] == seen[1] and one.gravity == other.gravity and one.parameters == other.parameters


def test_both_ways_to_write_a_quantity_are_one(tmp_path: Path) -> None:
    """Texts with units, numbers under keys with a suffix, and the same in JSON give one chain."""
    by_hand = written(tmp_path, """
        name = "arm"
        gravity = [0, "-9.81 m/s^2", 0]
        [[joint]]
        name = "slide"
        kind = "prismatic"
        axis = [1, 0, 0]
        mu = "1 mm/rad"
        body = { mass = "600 g", centre = ["1 cm", 0, 0] }
        [[joint]]
        name = "turn"
        position = ["0.1 m", 0, "20 mm"]
        rpy = ["90 deg", 0, "-90 deg"]
        mu = "5 %"
        J_m = "30 g cm^2"
        bearing = "1 cm"
        [joint.body]
        mass = "2 kg"
        inertia = { xx = "300 g cm^2", yy = "200 g cm^2", zz = "200 g cm^2", yz = "-30 g cm^2" }
    """)  # fmt: skip
    content = {
        "name": "arm",
        "gravity_m_s2": [0, -9.81, 0],
        "joint": [
            {
                "name": "slide", "kind": "prismatic", "axis": [1, 0, 0], "mu_m_per_rad": 1e-3,
                "body": {"mass_kg": 0.6, "centre_m": [0.01, 0, 0]},
            },
            {
                "name": "turn", "position_m": [0.1, 0, 0.02], "mu": "1/20", "J_m_kgm2": 3e-6,
                "rotation": [[0, 0, -1], [-1, 0, 0], [0, 1, 0]], "bearing_m": 0.01,
                "body": {"mass_kg": 2, "inertia_kgm2": [[3e-5, 0, 0], [0, 2e-5, -3e-6], [0, -3e-6, 2e-5]]},
            },
        ],
    }  # fmt: skip
    by_program = written(tmp_path, json.dumps(content), "arm.json")

    assert same(read_arm(by_hand), read_arm(by_program))


SHORT = """
[[joint]]
name = "elbow"
body = { mass = "2 kg", centre = [0, 0, "100 mm"] }
"""


HALF = ["mass", "centre_x", "centre_y", "centre_z"]
TENSOR = ["inertia_xx", "inertia_xy", "inertia_xz", "inertia_yy", "inertia_yz", "inertia_zz"]
SYMBOLIC = {
    "payload that the file does not have": ('["payload.mass"]', {"payload_mass": 0}),
    "mass and centre": (
        '["elbow.mass", "elbow.centre"]',
        dict(zip((f"body_0_{part}" for part in HALF), (2, 0, 0, sp.Rational(1, 10)), strict=True)),
    ),
    "inertia": ('["elbow.inertia"]', {f"body_0_{part}": 0 for part in TENSOR}),
    "all of a body": ('["payload", "payload.mass"]', {f"payload_{part}": 0 for part in (*HALF, *TENSOR)}),
    "nothing": ("[]", {}),
}


@pytest.mark.parametrize(("symbolic", "expected"), SYMBOLIC.values(), ids=SYMBOLIC)
def test_what_stays_symbolic_has_the_numbers_as_defaults(
    symbolic: str, expected: dict, tmp_path: Path
) -> None:
    """Letters stand for what the file names, in the body that it names, and for nothing else."""
    chain = read_arm(written(tmp_path, f"symbolic = {symbolic}\n{SHORT}"))

    assert expected == {q.name: q.default for q in chain.parameters}
    assert {q.symbol for q in chain.parameters} == {
        symbol
        for body in (bodies_of(chain)[0], chain.payload)
        if body is not None
        for matrix in (sp.Matrix([body.mass]), body.centre, body.inertia)
        for symbol in matrix.free_symbols
    }


def test_letters_at_their_defaults_are_the_numbers(tmp_path: Path) -> None:
    """With all bodies symbolic behind oblique links, the torques are those of the numeric arm."""
    text = "".join(
        f'[[joint]]\nname = "{name}"\ndh = {{ a_m = 0.3, d_m = 0.1, alpha_rad = {alpha} }}\n'
        f"[joint.body]\nmass_kg = 2\ncentre_m = [0.1, 0.02, 0.03]\ninertia_kgm2 = {{ xx = 0.1, yy = 0.1 }}\n"
        for name, alpha in (("a", 0.4), ("b", 1.1))
    )
    motion = [np.array(x) for x in ([0.3, 0.4], [1.0, 2.0], [3.0, -4.0])]
    numeric = read_arm(written(tmp_path, text))
    letters = read_arm(written(tmp_path, f'symbolic = ["a", "b"]\n{text}'))

    assert len(letters.parameters) == 20
    assert pytest.approx(torques(recursion(numeric), *motion), rel=1e-13) == torques(
        recursion(letters), *motion
    )


def test_a_body_without_mass_between_others_is_read(tmp_path: Path) -> None:
    """Two axes that meet in a point have no body between them; the file says so."""
    chain = read_arm(written(tmp_path, '[[joint]]\nname = "pan"\nbody = { mass = 0 }\n' + SHORT))

    assert [0, 2] == [body.mass for body in bodies_of(chain)]
    assert "arm" == chain.name
    assert Body(0).moments == bodies_of(chain)[0].moments
