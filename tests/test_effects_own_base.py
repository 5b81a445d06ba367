"""Effects of gravity and inertia on a base model of one's own: they follow its gravity and inertia torque."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
import sympy as sp

from eccentric.effects import library
from eccentric.model import Model, load_model, meaning, quantity
from eccentric.model import vocabulary as v
from tests.extended import J_L, J_M, KNOWN, MU, G, L, M, setting

ANGLE, SPEED, ACCELERATION = 7.0, 30.0, 45.0
WHEEL = 0.03
"""Inertia of a wheel on the link, beside the declared J_l [kg m^2]."""
HALF = 0.5 * MU * M * G * L * math.sin(MU * ANGLE)
INERTIA = (J_M + MU**2 * (J_L + WHEEL)) * ACCELERATION
LINK = MU**2 * (J_L + WHEEL) * ACCELERATION


def counterweighted() -> Model:
    """Case C2 with a counterweight that takes half of the gravity torque, and a wheel on the link."""
    base = load_model("c2_parallel")
    wheel = quantity("J_wheel", "kg m^2", "inertia of a wheel on the link", "", "nonnegative", str(WHEEL))
    mechanical, electrical = base.balance("mechanical"), base.balance("electrical")
    gravity = {"gravity": sp.Rational(1, 2)}
    terms = tuple(replace(t, basis=t.basis * gravity.get(t.kind, 1)) for t in mechanical.terms)
    definitions = tuple(
        replace(d, value=d.value + v.mu.symbol**2 * wheel.symbol) if d.symbol == v.J.symbol else d
        for d in base.definitions
    )
    return replace(
        base,
        name="counterweighted",
        parameters=(*base.parameters, wheel),
        definitions=definitions,
        balances=(replace(mechanical, terms=terms), electrical),
    )


@pytest.mark.parametrize(
    ("name", "coefficient", "shapes", "expected"),
    [
        ("mass_mismatch[torque]", "mass_torque", {}, HALF),
        ("ki_mismatch", "current_scale", {}, INERTIA + HALF),
        ("load_dependent[gravity]", "load_eta", {}, abs(HALF)),
        ("load_dependent[transmitted]", "load_eta", {"load_share": 0.0}, abs(HALF + LINK)),
        ("gear_efficiency[gravity]", "gear_eta", {"gear_rho": 0.0}, max(HALF, 0.0)),
    ],
)
def test_an_effect_of_the_load_follows_the_gravity_and_inertia_of_its_base(
    name: str, coefficient: str, shapes: dict[str, float], expected: float
) -> None:
    """Per unit of its coefficient, the torque has half the gravity and the inertia of link and wheel."""
    base = counterweighted()
    # A first fit without friction: nothing but gravity and inertia is transmitted.
    rig = replace(setting("C2", warm=False), base=base, friction={})
    effect = next(effect for effect in library(rig) if effect.id == name)
    values = shapes | {q.name: 0.0 for q in effect.parameters if q.name not in shapes}
    model = effect.extend(base, values)
    term = next(t for t in model.balance("mechanical").terms if str(t.coefficient) == coefficient)
    given = KNOWN | shapes | {"theta_m": ANGLE, "omega_m": SPEED, "alpha_m": ACCELERATION, "J_wheel": WHEEL}
    basis = meaning(model.expand(term.basis))
    actual = basis.subs({symbol: given[symbol.name] for symbol in basis.free_symbols})
    assert expected == pytest.approx(float(actual), rel=1e-9)


def test_without_gravity_no_effect_has_any() -> None:
    """A level plane with friction that depends on the link angle is case C1, and has no mass to correct."""
    level = setting("C1", warm=False)
    ripple = next(effect for effect in library(level) if effect.id == "link_harmonic_friction[n=1]")
    model = ripple.extend(level.base, {q.name: 0.0 for q in ripple.parameters})
    rig = replace(level, base=model)
    assert "C1" == rig.case
    assert [] == [effect.id for effect in library(rig) if effect.family == "mass_mismatch"]
