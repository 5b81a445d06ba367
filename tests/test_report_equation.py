"""The equation of the report: every term of the friction, with additions marked and replacements defined."""

from dataclasses import replace

import pytest
import sympy as sp

from eccentric.effects import Setting, library
from eccentric.model import load_model, quantity
from eccentric.presentation.html.equation import friction_equations


def test_the_equation_has_every_friction_term() -> None:
    """One line for each term; those of the effect, and no other, are marked; sgn as in the paper."""
    setting = Setting(load_model("c2_parallel"), 0.2, {"k_i": 0.06}, 0.5, 40.0, 10.0, 60.0, 5.0)
    effect = next(e for e in library(setting) if e.id == "link_harmonic_friction[n=2]")
    base = load_model("c2_parallel")
    friction, *where = friction_equations(effect.extend(base), [effect])

    assert (6, 2) == (friction.mathml.count("<mtr"), friction.mathml.count('<mtr class="added"'))
    assert [1, 1] == [friction.mathml.count(f"<msub><mi>{x}</mi><mn>2</mn></msub>") for x in "cs"]
    assert "Sgn" not in friction.mathml
    assert ["normal force on the axis of rotation [N]", "link angle"] == [
        where[0].note, where[1].note[:10]
    ]  # fmt: skip


def test_the_equation_tells_what_is_replaced() -> None:
    """A mass other than the declared one is printed with the friction, with its definition."""
    setting = Setting(load_model("c2_parallel"), 0.2, {"M": 0.5, "L": 0.2}, 0.5, 40.0, 10.0, 60.0, 5.0)
    effect = next(e for e in library(setting) if e.id == "mass_mismatch")
    notes = [
        equation.note for equation in friction_equations(effect.extend(load_model("c2_parallel")), [effect])
    ]
    meanings = [
        d.quantity.meaning for d in effect.change.definitions if d.symbol in effect.change.replaces.values()
    ]

    assert 1 == len(meanings) == sum(note.startswith(meanings[0]) for note in notes)


def test_a_letter_of_the_users_own_is_escaped() -> None:
    """A parameter can have any letter: in the formula it is text."""
    base = load_model("c1_perpendicular")
    bad = quantity("bold", "N m", "a letter with tags", letter="<b>bold</b>")
    mechanical = base.balance("mechanical")
    term = replace(mechanical.terms[-1], name="own", coefficient=bad.symbol, basis=sp.Integer(2))
    balances = (replace(mechanical, terms=(*mechanical.terms, term)), *base.balances[1:])
    (friction, *_) = friction_equations(
        replace(base, parameters=(*base.parameters, bad), balances=balances), []
    )

    assert "<b>" not in friction.mathml
    assert "&lt;b&gt;bold" in friction.mathml


@pytest.mark.parametrize(
    ("effect_id", "left", "minus"),
    [
        ("cable_spring", "torque of the drive", False),
        ("kt_ripple[n=2]", "torque of the drive", True),
        ("kt_ripple[n=2]", "voltage", False),
    ],
)
def test_what_an_effect_adds_has_the_sign_that_the_drive_needs(
    effect_id: str, left: str, minus: bool
) -> None:
    """A cable needs more torque, a larger flux less torque and more voltage."""
    base = load_model("c2_parallel")
    setting = Setting(base, 0.2, {"k_i": 0.06}, 0.5, 40.0, 10.0, 60.0, 5.0)
    effect = next(e for e in library(setting) if e.id == effect_id)
    (added,) = (
        one.mathml
        for one in friction_equations(effect.extend(base), [effect])
        if one.note.startswith(left) and "in addition" in one.note
    )

    assert minus == ("<mo>−</mo>" in added)
