"""The recursion grows with the number of joints, no faster."""

from itertools import pairwise

import numpy as np
import sympy as sp

from eccentric.model import Body, Chain, Joint, Placement, recursion
from tests.arms import random_inertia, symmetric

COUNTED = (3, 6, 7, 12)


def robot(n: int) -> Chain:
    """Joints about z at right angles to one another, as most arms have them, and bodies without symmetry."""
    rng = np.random.default_rng(1)
    joints = [
        Joint(placement=Placement.turned((0.1, 0.2, 0.3), (-1) ** j * np.pi / 2, 0.0, 0.0)) for j in range(n)
    ]
    bodies = [
        Body(rng.uniform(0.5, 5), rng.normal(size=3) * 0.1, symmetric(random_inertia(rng))) for _ in range(n)
    ]
    return Chain("robot", joints, bodies)


def operations(chain: Chain) -> dict[str, int]:
    """Multiplications, additions and others of a recursion; a fraction is one number, not a division."""
    number = sp.Symbol("number")
    values = [d.value for d in recursion(chain).definitions]
    written = [v.xreplace({x: number for x in v.atoms(sp.Rational) if not x.is_Integer}) for v in values]
    counted = [sp.count_ops(value, visual=True) for value in written]
    total = sp.Add(*counted).as_coefficients_dict()
    return {str(kind): int(number) for kind, number in total.items()}


def test_the_number_of_operations_is_linear() -> None:
    """From 3 to 12 joints every further joint costs the same within 10 %."""
    counts = {n: sum(operations(robot(n)).values()) for n in COUNTED}
    slopes = [(counts[more] - counts[fewer]) / (more - fewer) for fewer, more in pairwise(COUNTED)]

    assert max(slopes) < 1.1 * min(slopes), counts


def test_rotors_cost_less_than_a_tenth() -> None:
    """Gyroscopic torque and all, what rotors add to seven geared joints."""

    def geared(J_m: str) -> int:
        plain = robot(7)
        joints = [Joint(placement=joint.placement, mu="1/100", J_m=J_m) for joint in plain.joints]
        return sum(operations(Chain("robot", joints, plain.bodies)).values())

    assert geared("0") < geared("1/1000") < 1.1 * geared("0")


def test_no_definition_is_an_expanded_expression() -> None:
    """The longest formula of twelve joints is no longer than that of three."""
    longest = {n: max(sp.count_ops(d.value) for d in recursion(robot(n)).definitions) for n in (3, 12)}

    assert longest[3] == longest[12]


def test_sine_and_cosine_are_formed_once() -> None:
    """One sine and one cosine for each joint."""
    definitions = recursion(robot(6)).definitions

    assert 6 == sum(d.value.has(sp.sin) for d in definitions)
    assert 6 == sum(d.value.has(sp.cos) for d in definitions)


def test_right_angles_fold() -> None:
    """The cosine of a rounded right angle is 0: no definition multiplies by 1 or by what is nearly 0."""
    numbers = {abs(x) for d in recursion(robot(6)).definitions for x in d.value.atoms(sp.Number)}

    assert [x for x in numbers if 0 < x < 1e-9] == []
    assert all(1 not in d.value.args for d in recursion(robot(6)).definitions if d.value.is_Mul)
