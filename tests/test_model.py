"""A model of one's own, with nothing of the paper in it: what its parts know of each other."""

import pytest
import sympy as sp

from eccentric.core import InputError
from eccentric.model import Balance, Change, Definition, Extension, Model, Role, Term, extended, quantity
from eccentric.model import vocabulary as v

speed = quantity("speed", "rad/s", "velocity")
b = quantity("b", "N m s/rad", "viscous friction", domain="nonnegative")
twice = quantity("twice", "N m s/rad", "twice the friction")
squared = quantity("squared", "rad^2/s^2", "squared velocity")
unknown = sp.Symbol("unknown")


def model(*definitions: Definition, basis: sp.Expr = speed.symbol) -> Model:
    """A balance with one friction term."""
    term = Term("viscous", "friction", b.symbol, basis, "own", role=Role.VISCOUS)
    balances = (Balance("mechanical", "N m", (term,)),)
    return Model("own", "Own", (speed,), (b,), definitions, balances)


def test_what_follows_from_parameters_alone_counts_as_one_of_them() -> None:
    """A definition by all parameters is among them, one by an input is not; the next may build on it."""
    again = quantity("again", "N m s/rad", "four times the friction")
    known = model(
        Definition(twice, 2 * b.symbol),
        Definition(squared, speed.symbol**2),
        Definition(again, 2 * twice.symbol),
    ).parameter_symbols

    assert {b.symbol, twice.symbol, again.symbol} == known


def test_definitions_are_put_in_down_to_inputs_and_parameters() -> None:
    """Expanding follows definitions that use definitions."""
    again = quantity("again", "N m s/rad", "four times the friction")
    chain = model(Definition(twice, 2 * b.symbol), Definition(again, 2 * twice.symbol))

    assert 4 * b.symbol * speed.symbol == chain.expand(again.symbol * speed.symbol)


def test_what_nothing_defines_is_refused_by_name() -> None:
    """A definition may use what is defined before it, a term anything; otherwise the name is reported."""
    with pytest.raises(InputError, match="model own: twice uses unknown before its definition"):
        model(Definition(twice, unknown))
    with pytest.raises(InputError, match="model own: term viscous uses unknown, which nothing defines"):
        model(basis=unknown)


def test_units_cover_every_symbol() -> None:
    """Inputs, parameters and definitions each have theirs."""
    units = model(Definition(twice, 2 * b.symbol)).units()

    assert {speed.symbol: "rad/s", b.symbol: "N m s/rad", twice.symbol: "N m s/rad"} == units


def test_a_balance_sums_its_terms_with_the_sign_of_their_kind() -> None:
    """What drives is positive, what is driven negative; friction alone is summed without a sign."""
    drive = Term("motor", "drive", sp.Integer(1), sp.Symbol("tau"), "own")
    friction = model().balance("mechanical").terms[0]
    balance = Balance("mechanical", "N m", (drive, friction))

    assert sp.Symbol("tau") - b.symbol * speed.symbol == balance.residual()
    assert b.symbol * speed.symbol == balance.sum_of("friction")
    assert sp.Symbol("tau") + b.symbol * speed.symbol == balance.sum_of("friction", "drive")


def test_further_inputs_come_in_their_usual_order_and_the_acceleration_last() -> None:
    """Angle before time, then what the vocabulary does not have, then the motor's acceleration."""
    change = Change(inputs=(v.alpha_m, v.t, v.theta_m))
    found = extended(model(), Extension("more", change)).inputs

    assert [v.theta_m, v.t, speed, v.alpha_m] == list(found)
