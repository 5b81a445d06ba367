"""A chain that cannot be is refused in one line that says what is required."""

import math
from collections.abc import Callable
from typing import Any

import pytest
import sympy as sp

from eccentric.core import InputError
from eccentric.model import Body, Chain, Joint, Placement

CASES = {
    "mass below zero": (lambda: Body(-1, name="arm"), "arm: mass: expected 0 or above, got -1 kg"),
    "mass not a number": (lambda: Body("heavy"), "body: mass: expected a number, got 'heavy'"),
    "mass not finite": (lambda: Body(math.nan), "body: mass: expected a finite number, got nan"),
    "mass infinite": (lambda: Body(sp.oo), "body: mass: expected a finite number, got oo"),
    "centre of two numbers": (lambda: Body(1, (0, 0)), "body: centre of mass: expected three numbers"),
    "inertia of two rows": (lambda: Body(1, inertia=[[1, 0, 0]] * 2), "three rows of three numbers"),
    "inertia not symmetric": (
        lambda: Body(1, inertia=[[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]),
        "body: inertia: expected a symmetric tensor",
    ),
    "inertia of no body": (
        lambda: Body(1, inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 3]]),
        "none exceeds the sum of the others, got 1, 1, 3 kg m^2",
    ),
    "inertia below zero": (
        lambda: Body(1, inertia=[[-1, 0, 0], [0, 1, 0], [0, 0, 1]]),
        "expected principal moments of 0 or above, got -1, 1, 1 kg m^2",
    ),
    "inertia turned out of sight": (
        # 1, 1, 3 about axes that are turned by 45 degrees: no entry of the diagonal shows it.
        lambda: Body(1, inertia=[[1, 0, 0], [0, 2, 1], [0, 1, 2]]),
        "got 1, 1, 3 kg m^2",
    ),
    "axis of no length": (
        lambda: Joint(axis=(0, 0, 0), name="elbow"),
        "elbow: axis: expected a vector of length 1, got (0, 0, 0) of length 0",
    ),
    "axis too long": (lambda: Joint(axis=(0, 1, 1)), "got (0, 1, 1) of length 1.41421"),
    "axis of letters": (lambda: Joint(axis=(sp.Symbol("x"), 0, 1)), "joint: axis: expected three numbers"),
    "unknown joint": (
        lambda: Joint("prismatik"),
        "joint: kind: expected one of revolute, prismatic, got 'prismatik'; did you mean",
    ),
    "gear that turns nothing": (lambda: Joint(mu=0), "mu: expected a positive gear ratio, got 0"),
    "rotor below zero": (lambda: Joint(J_m=-0.1), "joint: J_m: expected 0 or above, got -0.1 kg m^2"),
    "rotation that stretches": (
        lambda: Placement(rotation=[[2, 0, 0], [0, 1, 0], [0, 0, 1]]),
        "placement: rotation: expected columns that are a right-handed frame",
    ),
    "rotation that mirrors": (
        lambda: Placement(rotation=[[-1, 0, 0], [0, 1, 0], [0, 0, 1]]),
        "placement: rotation: expected columns that are a right-handed frame",
    ),
    "no joint": (lambda: Chain("arm", [], []), "arm: expected at least one joint, got none"),
    "a joint without a body": (
        lambda: Chain("arm", [Joint(), Joint()], [Body(1)]),
        "arm: expected one body for each joint, got 2 joints and 1 bodies",
    ),
    "a letter that nothing defines": (
        lambda: Chain("arm", [Joint()], [Body(sp.Symbol("m"))]),
        "arm: expected m among its parameters",
    ),
    "a keyword as a name": (lambda: Chain("while", [Joint()], [Body(1)]), "got 'while', a keyword of C"),
}


@pytest.mark.parametrize(("make", "complaint"), CASES.values(), ids=CASES)
def test_what_cannot_be_is_refused_in_one_line(make: Callable[[], Any], complaint: str) -> None:
    """The message names the part, what is required and what was received."""
    with pytest.raises(InputError) as caught:
        make()

    assert complaint in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_a_drawing_rounds_is_accepted() -> None:
    """A thin plate, a point, an axis and a rotation of six digits are a body and a joint."""
    Body(1, inertia=[[1, 0, 0], [0, 1, 0], [0, 0, 2]])
    Body(1, inertia=[[0.1, 0, 0], [0, 0.2, 0], [0, 0, 0.30000000000000004]])
    Body(0)
    joint = Joint(axis=(0.707107, 0, 0.707107))
    Placement.turned((0, 0, 0), 1.5707963, 0, 0)

    assert pytest.approx(1, abs=1e-15) == math.hypot(*map(float, joint.axis))


def test_decimals_are_exact() -> None:
    """0.1, "0.1" and "1/10" are one number, and a right angle of a computer is one."""
    assert {sp.Rational(1, 10)} == {Body(x).mass for x in (0.1, "0.1", "1/10")}
    assert (
        sp.ImmutableMatrix([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
        == Placement.turned((0, 0, 0), math.pi / 2, 0.0, 0.0).rotation
    )
