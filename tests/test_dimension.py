"""Dimensions of units and of expressions, against exponents of kg, m, s, A and K written out explicitly."""

import pytest
import sympy as sp

from eccentric.model import steps
from eccentric.model.limit import PURE, of_expression, of_unit

x, y, t, n = sp.symbols("x y t n")
UNITS = {x: "m", y: "m", t: "s", n: "1"}
METRE, SECOND = (0, 1, 0, 0, 0), (0, 0, 1, 0, 0)


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        ("1", (0, 0, 0, 0, 0)),
        ("rad", (0, 0, 0, 0, 0)),
        ("N", (1, 1, -2, 0, 0)),
        ("J", (1, 2, -2, 0, 0)),
        ("W", (1, 2, -3, 0, 0)),
        ("V", (1, 2, -3, -1, 0)),
        ("Ohm", (1, 2, -3, -2, 0)),
        ("N m s/rad", (1, 2, -1, 0, 0)),
        ("kg m^2", (1, 2, 0, 0, 0)),
        ("s^-2", (0, 0, -2, 0, 0)),
        ("m/s/s", (0, 1, -2, 0, 0)),
        ("J/kg/K", (0, 2, -2, 0, -1)),
        ("J/(kg K)", (0, 2, -2, 0, -1)),
        ("W/m/K/s", (1, 1, -4, 0, -1)),
    ],
)
def test_unit(unit: str, expected: tuple[int, ...]) -> None:
    """A unit has its SI exponents; everything after a slash divides, also after the second and third."""
    assert expected == of_unit(unit)


def test_an_unknown_unit_is_named() -> None:
    """The factor that is unknown is in the message, and so are the known ones."""
    said = r"^unit 'N lbf': unknown factor 'lbf'; known are 1, rad, radian, kg"
    with pytest.raises(ValueError, match=said):
        of_unit("N lbf")


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        (x / t**2, (0, 1, -2, 0, 0)),
        (x + 2 * y, METRE),
        (sp.sqrt(x * y), METRE),
        (sp.Abs(x), METRE),
        (sp.sin(x / y), PURE),
        (sp.sign(x), PURE),
        (sp.Integer(7), PURE),
        (steps.Gated(x, 1 / t), (0, 1, -1, 0, 0)),
        (steps.Bounded(x, n), METRE),
        (steps.Leading(t), SECOND),
        (steps.SquareDifference(x, y), (0, 2, 0, 0, 0)),
        (steps.Magnitude(x, y), METRE),
        (steps.Along(x, y), PURE),
        (steps.Across(x, y), PURE),
        (steps.Forward(x), PURE),
        (sp.Piecewise((1, sp.Eq(n, 0)), (x, True)), METRE),
    ],
    ids=str,
)
def test_expression(expression: sp.Expr, expected: tuple[int, ...]) -> None:
    """An expression has the dimension that its letters give it."""
    assert expected == of_expression(expression, UNITS)


@pytest.mark.parametrize(
    "expression",
    [
        x + t,
        steps.Magnitude(x, t),
        steps.Along(x, t),
        steps.SquareDifference(x, t),
        sp.Piecewise((x, sp.Eq(n, 0)), (t, True)),
    ],
    ids=str,
)
def test_addends_of_different_dimension_are_refused(expression: sp.Expr) -> None:
    """Metres and seconds do not add up, in a sum or in a step that is one."""
    with pytest.raises(ValueError, match="addends of different dimension"):
        of_expression(expression, UNITS)


@pytest.mark.parametrize("expression", [sp.exp(x), sp.cos(t), steps.HalfCosine(x, n)], ids=str)
def test_functions_of_a_number_require_one(expression: sp.Expr) -> None:
    """The exponential of a length has no meaning."""
    with pytest.raises(ValueError, match="expected a pure number"):
        of_expression(expression, UNITS)
