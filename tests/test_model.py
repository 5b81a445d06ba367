"""A model of one's own, with nothing of the paper in it: its parts, its equations, its dimensions."""

import pickle
from dataclasses import replace

import pytest
import sympy as sp

from eccentric.core import InputError
from eccentric.model import (
    Balance,
    Change,
    Definition,
    Equation,
    Extension,
    Identity,
    Model,
    Role,
    Term,
    extended,
    interface_of,
    load_model,
    quantity,
    steps,
)
from eccentric.model import vocabulary as v
from eccentric.model.balance import equation_named
from eccentric.model.limit import PURE, of_expression, of_unit

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


# An equation as a person reads it: for a terminal and in LaTeX.


k_i, k_e, R, omega_m, mu, s = sp.symbols("k_i k_e R omega_m mu s")
DAMPING = Equation(
    "damping",
    "(6)",
    sp.Symbol("F"),
    k_i * k_e / R * omega_m,
    "N m",
    "Damping by the back-EMF.",
    (Identity("it is zero at rest", sp.Integer(0)),),
)


def test_text_has_the_origin_the_formula_its_number_its_unit_and_what_follows() -> None:
    """Letters are as in code, Greek ones in Greek; number and unit are in the line of the equals sign."""
    assert [
        "Damping by the back-EMF.",
        "",
        "        k_e⋅k_i⋅ω_m",
        f"    F = {'───────────':80}(6)  [N m]",
        "             R",
        "",
        "    Check: it is zero at rest.",
    ] == DAMPING.text().split("\n")


@pytest.mark.parametrize(
    ("right", "lines"),
    [
        (mu**2, ["     2", "F = μ"]),
        (-omega_m / 2, ["    -ω_m", "F = ─────", "      2"]),
        (2 * omega_m / 3, ["    2⋅ω_m", "F = ─────", "      3"]),
        (sp.Rational(3, 2) / R, ["     3", "F = ───", "    2⋅R"]),
        (sp.sqrt(R), ["F = √R"]),
        ((k_i + k_e) * omega_m, ["F = ω_m⋅(k_e + k_i)"]),
    ],
    ids=str,
)
def test_formulas_are_printed_on_fractions_and_powers(right: sp.Expr, lines: list[str]) -> None:
    """A fraction has a bar, a power a line above, a root its sign, and a sum as factor its brackets."""
    printed = Equation("one", "", sp.Symbol("F"), right, "1", "One.").text().split("\n")[2:]
    formula = [line[4:88].rstrip() for line in printed if line.strip()]

    assert lines == [line for line in formula if line]


def test_a_wide_formula_has_its_number_on_a_line_of_its_own() -> None:
    """Number and unit never run into the formula."""
    wide = sp.Add(*sp.symbols("a_long_letter:12"))
    lines = Equation("wide", "(9)", sp.Symbol("F"), wide, "N", "Wide.").text().split("\n")

    assert f"{'':88}(9)  [N]" == lines[-1]
    assert "(9)" not in lines[-2]


def test_latex_has_the_number_as_tag() -> None:
    """The tag is the number without its brackets; an equation of no number has none."""
    said = DAMPING.latex().split("\n")
    unnumbered = Equation("one", "", sp.Symbol("F"), R, "Ohm", "One.").latex()

    assert ["Damping by the back-EMF.", r"\[ F = \frac{k_{e} k_{i} \omega_{m}}{R} \tag{6} \]"] == said[:2]
    assert "Check: it is zero at rest." in said
    assert "tag" not in unnumbered


def test_a_vector_of_different_quantities_has_a_unit_for_each() -> None:
    """There is one unit for all rows, or one for each."""
    column = sp.Matrix([R, mu])
    several = Equation("several", "", sp.Matrix(sp.symbols("a b")), column, ("Ohm", "1"), "Two.")

    assert ("Ohm", "1") == several.units()
    assert "[Ohm, 1]" in several.text()
    assert ("N m",) == DAMPING.units()


def test_an_unknown_equation_is_refused_with_the_names_there_are() -> None:
    """Asking for a name that is not there lists those that are."""
    assert DAMPING is equation_named([DAMPING], "damping")
    with pytest.raises(KeyError, match="no equation 'friction'; there are damping"):
        equation_named([DAMPING], "friction")


# Dimensions of units and of expressions, against exponents of kg, m, s, A and K written out explicitly.


x, y, t, n = sp.symbols("x y t n")
UNITS = {x: "m", y: "m", t: "s", n: "1"}
METRE, SECOND = (0, 1, 0, 0, 0), (0, 0, 1, 0, 0)


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        ("1", (0, 0, 0, 0, 0)), ("rad", (0, 0, 0, 0, 0)), ("N", (1, 1, -2, 0, 0)),
        ("J", (1, 2, -2, 0, 0)), ("W", (1, 2, -3, 0, 0)), ("V", (1, 2, -3, -1, 0)),
        ("Ohm", (1, 2, -3, -2, 0)), ("N m s/rad", (1, 2, -1, 0, 0)), ("kg m^2", (1, 2, 0, 0, 0)),
        ("s^-2", (0, 0, -2, 0, 0)), ("m/s/s", (0, 1, -2, 0, 0)), ("J/kg/K", (0, 2, -2, 0, -1)),
        ("J/(kg K)", (0, 2, -2, 0, -1)), ("W/m/K/s", (1, 1, -4, 0, -1)),
    ],
)  # fmt: skip
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


def test_a_model_whose_outputs_are_cached_can_be_pickled() -> None:
    """What is cached of it stays outside: only the model itself is written."""
    model = replace(load_model("c2_parallel"), name="own")
    assert interface_of(model).outputs
    written = pickle.dumps(model)

    assert b"Interface" not in written
    assert pickle.loads(written).name == "own"  # noqa: S301 - what was just pickled
