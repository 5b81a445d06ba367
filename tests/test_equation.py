"""An equation as a person reads it: for a terminal and in LaTeX."""

import pytest
import sympy as sp

from eccentric.model import Equation, Identity
from eccentric.model.equation import equation_named

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
