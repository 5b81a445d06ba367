"""Friction of the slides of an arm: a fit gives its coefficients in the units that the emitted arm has."""

from __future__ import annotations

import pytest

from eccentric.joints.fitted import _unit_of
from eccentric.joints.joint_model import EVERY, joint_model
from eccentric.model import Body, Chain, Joint, Load, Placement, arm, friction_units
from eccentric.model.limit import of_unit

COEFFICIENTS = {Load.NORMAL: "lN", Load.TRANSVERSAL: "lT", Load.BENDING: "lM", Load.TRANSMITTED: "lG"}


def joint(kind: str) -> Chain:
    """A chain of one joint with an unbalanced body, level enough that every load is there."""
    body = Body(2, (0.1, 0.2, 0.3), ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    return Chain("one", [Joint(kind, placement=Placement())], [body], (0, 1, -9))


@pytest.mark.parametrize(("kind", "turns"), [("revolute", True), ("prismatic", False)])
def test_a_fit_has_the_units_of_the_emitted_arm(kind: str, turns: bool) -> None:
    """Viscous and Coulomb friction by each load are in the unit of the arm's own parameters."""
    emitted = {q.name.removesuffix("_0"): q.unit for q in arm(joint(kind), "one").parameters}
    fitted = {q.name: q.unit for q in joint_model("one", "one", EVERY, turns=turns).parameters}
    both = [f"{letter}_{load}" for load in COEFFICIENTS.values() for letter in "BC"]

    assert {x: fitted[x] for x in both if x in emitted} == {x: emitted[x] for x in both if x in emitted}
    assert sum(x in emitted for x in both) >= 6


@pytest.mark.parametrize("turns", [True, False])
@pytest.mark.parametrize("load", [Load.NORMAL, Load.TRANSVERSAL, Load.BENDING])
def test_without_a_scale_a_coefficient_is_divided_by_the_torque(load: Load, turns: bool) -> None:
    """In amperes, each unit is that of the coefficient times A/(N m), by its dimension."""
    for letter, unit in zip("BC", friction_units(load, turns=turns), strict=True):
        shown = _unit_of(f"{letter}_{COEFFICIENTS[load]}", unit, "A")
        # A slide's gear is a length per radian: the ratio is part of the motor's torque.
        assert of_unit(shown) == tuple(
            a + b - c for a, b, c in zip(of_unit(unit), of_unit("A"), of_unit("N m"), strict=True)
        )
