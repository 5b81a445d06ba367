"""The opaque steps of the model: each means its formula, and its derivative is that of the formula."""

import pytest
import sympy as sp
from sympy.core.function import ArgumentIndexError

from eccentric.model import STEPS, Along, Chord, HalfCosine, HalfSine, Magnitude, OpaqueStep, meaning, steps

x, y, z = sp.symbols("x y z", real=True)
positive = sp.Symbol("positive", positive=True)

# Arguments, and the formula of each step, written down from its name: `p` and `q` are its legs, and so on.
FORMULA = {
    steps.Sgn: ((x,), sp.sign(x)),
    steps.Forward: ((x,), sp.Piecewise((1, x > 0), (0, True))),
    steps.Backward: ((x,), sp.Piecewise((1, x < 0), (0, True))),
    steps.ByDirection: ((x, y, z), sp.Piecewise((y, x > 0), (z, True))),
    steps.HalfCosine: ((x, positive), sp.sin((positive * x - sp.pi) / 2)),
    steps.HalfSine: ((x, positive), sp.cos((positive * x - sp.pi) / 2)),
    steps.Chord: ((x, positive), 2 / positive * sp.sin((positive * x - sp.pi) / 2)),
    steps.Bounded: ((x, positive), x),
    steps.SquareDifference: ((x, y), (x - y) * (x + y)),
    steps.Magnitude: ((x, y), sp.Abs(x + sp.I * y)),
    steps.Along: ((x, y), sp.cos(sp.atan2(y, x))),
    steps.Across: ((x, y), sp.sin(sp.atan2(y, x))),
    steps.Gated: ((x, y), x * y),
    steps.Leading: ((x,), x),
    steps.Quotient: ((x, y), x / y),
    steps.AtZero: ((x, y, z), sp.Piecewise((y, sp.Eq(x, 0)), (z, True))),
    steps.BySign: ((x, y, z, positive), sp.Piecewise((y, x > 0), (z, x < 0), (positive, True))),
    steps.Clipped: ((x, z, positive), sp.Piecewise((positive, x > positive), (z, x < z), (x, True))),
    # Where theta_m/turn is, to a whole number, by its tangent: the angle from the top of the turn.
    steps.FromTop: ((x, positive), 2 / positive * sp.atan(sp.tan((positive * x - sp.pi) / 2))),
    # The density of a sum of three uniform numbers, of Irwin and Hall.
    steps.Bump: (
        (x,),
        sp.Piecewise(
            (sp.Rational(3, 4) - x**2, sp.Abs(x) <= sp.Rational(1, 2)),
            ((sp.Abs(x) - sp.Rational(3, 2)) ** 2 / 2, sp.Abs(x) <= sp.Rational(3, 2)),
            (0, True),
        ),
    ),
    steps.Shrunk: ((x, z, positive), sp.Piecewise((x - positive, x > positive), (x - z, x < z), (0, True))),
}
# A point of every combination of signs, away from zero, and numbers that no formula is special at.
POINTS = tuple(
    {
        x: i * sp.Rational(13, 10),
        y: j * sp.Rational(7, 10),
        z: sp.Rational(-9, 4),
        positive: sp.Rational(3, 7),
    }
    for i in (1, -1)
    for j in (1, -1)
)
FIXED = {
    steps.HalfCosine: (2,),
    steps.HalfSine: (2,),
    steps.Chord: (2,),
    steps.FromTop: (2,),
    steps.Bounded: (2,),
}
"""Arguments that are parameters, which nothing is differentiated by."""


def value(expression: sp.Expr, point: dict[sp.Symbol, sp.Expr]) -> sp.Expr:
    """The expression's meaning at a point, to 30 digits."""
    return sp.N(meaning(expression).doit().subs(point), 30)


def test_every_step_is_tested_here() -> None:
    """The table of formulas has each step of the toolkit."""
    assert set(FORMULA) == set(STEPS)


@pytest.mark.parametrize("step", FORMULA, ids=lambda step: step.__name__)
def test_a_step_means_its_formula(step: type[OpaqueStep]) -> None:
    """At points of every sign the meaning is the formula, to 25 digits."""
    arguments, formula = FORMULA[step]
    for point in POINTS:
        error = value(step(*arguments), point) - sp.N(formula.subs(point), 30)

        assert abs(error) < sp.Float("1e-25"), point


@pytest.mark.parametrize("step", FORMULA, ids=lambda step: step.__name__)
def test_the_derivative_of_a_step_is_that_of_its_formula(step: type[OpaqueStep]) -> None:
    """By each argument, away from where the formula jumps, to 25 digits."""
    arguments, formula = FORMULA[step]
    for place, argument in enumerate(arguments, 1):
        if place in FIXED.get(step, ()):
            continue
        stated = step(*arguments).fdiff(place)
        for point in POINTS:
            error = value(stated, point) - sp.N(formula.diff(argument).subs(point), 30)

            assert abs(error) < sp.Float("1e-25"), (place, point)


@pytest.mark.parametrize("step", [HalfCosine, HalfSine, Chord, steps.FromTop], ids=lambda step: step.__name__)
def test_nothing_is_differentiated_by_the_gear_ratio(step: type[OpaqueStep]) -> None:
    """Where the second argument is a parameter, a derivative by it is refused, not made up."""
    with pytest.raises(ArgumentIndexError):
        step(x, positive).fdiff(2)


def test_a_chord_is_the_half_cosine_on_the_motor_side() -> None:
    """HalfCosine = mu/2 Chord: the same meaning."""
    rewritten = HalfCosine(x, positive).rewrite("chord")

    assert rewritten.has(Chord)
    assert 0 == sp.simplify(meaning(rewritten) - meaning(HalfCosine(x, positive)))


def test_direction_cosines_have_length_one() -> None:
    """Along^2 + Across^2 = 1, and p Along + q Across is the magnitude."""
    along, across = Magnitude(x, y).fdiff(1), Magnitude(x, y).fdiff(2)

    assert isinstance(along, Along)
    assert 0 == sp.simplify(meaning(along**2 + across**2) - 1)
    assert 0 == sp.simplify(meaning(x * along + y * across - Magnitude(x, y)))


def test_a_bound_of_zero_switches_off() -> None:
    """Bounded(x, 0) is 0, whatever x."""
    assert 0 == meaning(steps.Bounded(x, sp.Integer(0)))


def test_at_standstill_neither_direction_is_on() -> None:
    """At x = 0 the sign and both gates are 0, and a coefficient by direction is the second."""
    still = sp.Integer(0)

    assert [0, 0, 0] == [meaning(step(still)) for step in (steps.Sgn, steps.Forward, steps.Backward)]
    assert z == meaning(steps.ByDirection(still, y, z))


def test_a_step_stays_as_written_also_for_numbers() -> None:
    """SymPy evaluates no step: SquareDifference(3, 2) is not 5 until its meaning is requested."""
    difference = steps.SquareDifference(sp.Integer(3), sp.Integer(2))

    assert isinstance(difference, steps.SquareDifference)
    assert 5 == meaning(difference)
