"""The bounds that emitted headers state, measured against 50 digits; full sets: benchmarks/accuracy.py."""

import itertools
import re
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest
import sympy as sp

from eccentric.emission.program import accuracy as stated
from eccentric.model import load_model, vocabulary, with_values
from tests import accelerated, accuracy, oracle, random_drives
from tests.compiled import GENERATED, Library, Real
from tests.emitted import PRECISIONS, both_precisions, by_turns, module, quick
from tests.paper import Parameters
from tests.promised import DERIVATIVES, NAMES, STEADY, arguments, bounds, errors, given, link_errors

SIZE = 5000  # states of each set with the constants of Table 1
AT_RANDOM = 5  # units of F_N with Table 1 at random states; a search finds more, and the header states that
# With other parameters: a float is held to the emitted double, too, at far more states.
FEW, LINK_FEW = {np.float64: 200, np.float32: 60}, {np.float64: 60, np.float32: 20}
MANY = 2000
# Table 1 with both of its gears, no gear, gears up, and links of little and of much unbalance.
DRIVES: dict[str, dict[str, str]] = {
    "mu = 1/5": {},
    "mu = 1/30": {"mu": "1/30"},
    "mu = 1": {"mu": "1"},
    "mu = 3": {"mu": "3"},
    "mu = 5": {"mu": "5"},
    "much unbalance": {"mu": "0.37", "M": "3.3", "L": "0.11", "g": "1.62"},
    "little unbalance": {"M": "0.013", "M_l": "7.1", "L": "1.7", "mu": "0.83"},
    # Both precisions have this one's critical velocity, 4 rad/s: at the zero of F_N only the angle remains.
    "exact velocity": {"M": "0.5", "M_l": "0.5", "L": "0.5", "mu": "1.25", "g": "6.25"},
}
TABLE_1 = ("mu = 1/5", "mu = 1/30")
SELDOM = {"mu = 1", "mu = 3", "little unbalance"}
"""Between the others, or easier: slow tests."""
every_drive = pytest.mark.parametrize("drive", quick(DRIVES, DRIVES.keys() - SELDOM))


def bound(name: str, function: str, drive: str) -> int:
    """Return what is promised of a drive, the paper's or another."""
    one = bounds(name)[function]
    return one.table_1 if drive in TABLE_1 else one.anywhere


def letters(drive: str) -> dict[str, float]:
    """Return the letters of a drive in double; the negative direction's are more by a quarter."""
    values = {letter: float(value) for letter, value in vars(accuracy.decimals(**DRIVES[drive])).items()}
    return random_drives.directed(values, 1.25)


def drive_parameters(name: str, drive: str) -> tuple[Any, Parameters]:
    """Return a drive as the emitted Parameters, in double, and at 50 digits what these are exactly."""
    return given(name, letters(drive)), oracle.exact(letters(drive))


@pytest.mark.parametrize(
    ("case", "drive", "dtype"),
    by_turns(
        *(("C1", "C2"), DRIVES),
        few={
            *(("C1", "mu = 1/5", "single"), ("C1", "much unbalance", "double")),
            *(("C2", "mu = 1/5", "double"), ("C2", "mu = 1/30", "single")),
            *(("C2", "mu = 5", "single"), ("C2", "exact velocity", "double")),
        },
    ),
)
def test_steady(case: str, drive: str, dtype: Real) -> None:
    """F_N, friction and derivatives keep their bounds in the plane, near F_N = 0 and at large angles."""
    chosen = accuracy.sets(oracle.exact(letters(drive)), dtype, FEW[dtype])
    for name in STEADY[case]:
        # Nothing depends on the angle in case C1: the sets that differ in it are one.
        for at in chosen if case == "C2" else chosen[:2]:
            for function, worst in errors(name, at, letters(drive)).items():
                assert worst <= bound(name, function, drive), (name, function, at.name)


@pytest.mark.slow
@both_precisions
@every_drive
def test_beside_every_top(drive: str, dtype: Real) -> None:
    """F_N is right to its last places at the angles nearest to every top of the link, up to 1e4 rad."""
    name = "c2_parallel"
    given, p = drive_parameters(name, drive)
    at = accuracy.beside_the_tops(p, dtype)
    actual = np.asarray(module(name).normal_force(at.theta_m, at.omega_m, given))
    worst = np.max(accuracy.units(actual, accuracy.normal_force(name, at, p)))

    assert worst <= bound(name, "normal_force", drive)


@pytest.fixture(scope="module")
def library_of(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, Real], Library]:
    """Return what compiles a model in a precision, once."""
    folder = tmp_path_factory.mktemp("accuracy")
    return cache(lambda name, dtype: Library(name, dtype, folder))


@pytest.mark.parametrize(
    ("name", "dtype"),
    quick(
        itertools.product(("c1_perpendicular", "c2_parallel"), PRECISIONS.values()),
        {("c1_perpendicular", np.float64), ("c2_parallel", np.float32)},
    ),
)
def test_default_coefficients(name: str, dtype: Real, library_of: Callable[[str, Real], Library]) -> None:
    """The emitted constants are those of Table 1's decimals; at random states 5 units are not passed."""
    library, p = library_of(name, dtype), accuracy.decimals()
    for at in accuracy.sets(p, dtype, SIZE):
        states = arguments(name, "normal_force", at)
        actual = library.many("normal_force", states, library.coefficients())
        worst = np.max(accuracy.units(actual, accuracy.normal_force(name, at, p)))
        assert worst <= AT_RANDOM, at.name


LAST = {(np.float32, "omega_star_2"), (np.float32, "period_5"), (np.float64, "period_3")}
"""The smallest parts: quick tests."""


@pytest.mark.parametrize(
    ("dtype", "part"),
    quick(
        [
            *((np.float32, x) for x in ("omega_star_2", "period_2", "period_3", "period_4", "period_5")),
            *((np.float64, x) for x in ("omega_star_2", "period_2", "period_3")),
        ],
        LAST,
    ),
)
def test_every_part_of_the_constants_is_needed(
    dtype: Real, part: str, library_of: Callable[[str, Real], Library]
) -> None:
    """Without the low part of the critical velocity, or a part of the period, the bound is missed."""
    library, p = library_of("c2_parallel", dtype), accuracy.decimals()
    without = library.ffi.new("c2_parallel_coefficients *", library.coefficients()[0])
    setattr(without, part, 0.0)
    at = accuracy.beside_the_tops(p, dtype)
    actual = library.many("normal_force", [at.theta_m, at.omega_m], without)
    worst = np.max(accuracy.units(actual, accuracy.normal_force("c2_parallel", at, p)))

    assert worst > stated.NORMAL_FORCE.anywhere


@pytest.mark.parametrize(
    ("phi", "drive", "dtype"),
    by_turns(
        *((0.0, 0.75, 1.5), DRIVES),
        few={
            *((0.0, "mu = 1/5", "single"), (0.0, "exact velocity", "double"), (0.75, "mu = 1/30", "double")),
            *((1.5, "mu = 5", "single"), (1.5, "much unbalance", "double")),
        },
    ),
)
def test_accelerated(drive: str, phi: float, dtype: Real) -> None:
    """With an acceleration F_N vanishes along a curve: its error is a few eps of what it is made of.

    Those of friction and of what its coefficients multiply are as many eps of the same under that load;
    those of the slopes, which need the direction of F_N, of their greatest values times that load over F_N.
    """
    values, size = letters(drive) | {"phi": phi}, LINK_FEW[dtype]
    p = oracle.exact(values)
    anywhere = [(at, accelerated.alphas(p, dtype, size)) for at in accuracy.sets(p, dtype, size)]
    scaled, beside = accelerated.at_any_scale(p, dtype, 3 * size), accelerated.near_no_load(p, dtype, size)
    for at, alpha_m in (*anywhere, scaled, beside):
        exact = accelerated.exact(at, alpha_m, p)
        for function, worst in link_errors(at, alpha_m, values, exact).items():
            assert worst <= bound(accelerated.NAME, function, drive), (function, at.name)


@pytest.mark.parametrize(
    ("name", "drive"),
    [
        pytest.param(name, drive, marks=() if drive in few else pytest.mark.slow)
        for name, few in zip(
            NAMES,
            (("mu = 5",), ("much unbalance",), ("mu = 1/30", "mu = 5"), ("mu = 1/5",), ("exact velocity",)),
            strict=True,
        )
        for drive in DRIVES
    ],
)
def test_float_beside_double(name: str, drive: str) -> None:
    """At many more states, those of gravity alone among them, float keeps its bounds beside the double."""
    random = np.random.default_rng(6)
    for phi in (0.0, 0.75, 1.5) if name == accelerated.NAME else (0.0,):
        values = letters(drive) | {"phi": phi}
        states = random_drives.states(name, values, random, MANY)
        for function, found in random_drives.errors(name, values, states).items():
            assert np.max(found) <= bound(name, function, drive), (function, phi)


@pytest.mark.parametrize("name", NAMES)
def test_the_header_states_the_bounds(name: str) -> None:
    """What is measured here is what the header promises, and nothing else is promised there."""
    last, level = "units in the last place", name in STEADY["C1"]
    units = ["units in the last place", last, "eps of its largest value at that speed, any angle"]
    if level:
        units = [f"{last} (proved for parameters and speeds of 1e-6 to 1e6)", last, last]
    if name == accelerated.NAME:
        anywhere = "its largest value, any direction of F_N, times that load over F_N"
        units = ["(M L (omega_l^2 + |alpha_l|) + weight)", "of what they are at that load", f"of {anywhere}"]
        units = [f"eps {unit}" for unit in units]
    friction = "friction_torque, mechanical_friction_torque, friction_torque_jacobian"
    promised = [bounds(name)[function] for function in ("normal_force", *DERIVATIVES)]
    values = [f"{most} (Table 1: {tabled})" if tabled < most else f"{most}" for most, tabled in promised]
    heads = ["normal_force", friction, "friction_torque_gradient"]
    lines = [f"{head} within {n} {unit}" for head, n, unit in zip(heads, values, units, strict=True)]
    given = [] if level else ["Table 1: with its parameters, mu 1/5 or 1/30"]
    header = (GENERATED / f"{name}.h").read_text(encoding="utf-8")
    steepest = max(Fraction(changed.get("mu", 0)) for changed in DRIVES.values())
    reach = "" if level else f", |theta_m| to {accuracy.FAR[-1]:.0f} rad, mu to {steepest}"

    stated_reach, told = re.findall(r"parameters count as exact(.*):\n((?: \*   .*\n)+)", header)[0]
    assert (reach, lines + given) == (stated_reach, [line.strip(" *") for line in told.splitlines()])


def test_table_1_is_that_of_the_paper_s_parameters_without_values_of_their_own() -> None:
    """A model of the paper is, one with other parameters or with values of a fit is not."""
    paper = load_model("c2_parallel")
    fitted = with_values(paper, {"C_m": 0.02}, "fitted")

    assert [True, True, False, False] == [
        stated._of_table_1(model)
        for model in (paper, load_model("c2_asymmetric"), load_model("linear_axis"), fitted)
    ]


def test_a_torque_that_pushes_one_way_does_not_oppose_every_motion() -> None:
    """C_m sgn w does, C_m alone pushes where w is negative: then there is cancellation, and no bound."""
    model = load_model("c2_parallel")
    (mechanical,) = [balance for balance in model.balances if balance.name == "mechanical"]
    coulomb = next(t for t in mechanical.terms if t.kind == "friction" and t.value.has(vocabulary.C_m.symbol))
    pushing = replace(coulomb, basis=sp.Integer(1))
    beside = replace(model, balances=(replace(mechanical, terms=(*mechanical.terms, pushing)),))

    assert [True, False] == [stated._of_one_sign(one) for one in (model, beside)]
