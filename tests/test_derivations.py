"""The derivations: from first principles follows what the paper prints, in every equation and unit."""

import math
import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import pytest
import sympy as sp

from eccentric.model import Equation, load_model, meaning, model_names, regressor
from eccentric.model import vocabulary as v
from eccentric.model.chain import motion
from eccentric.model.limit import of_expression, of_unit
from tests import paper

ROOT = Path(__file__).resolve().parent.parent
NAMES = "M M_l L g phi mu R k_i k_e J_m J_l F_T B_lN C_lN B_lT C_lT B_m C_m"
LETTERS = SimpleNamespace(**{name: getattr(v, name).symbol for name in NAMES.split()})
theta_m, omega_m, alpha_m = v.theta_m.symbol, v.omega_m.symbol, v.alpha_m.symbol
theta_l, omega_l, alpha_l = v.theta_l.symbol, v.omega_l.symbol, v.alpha_l.symbol
sgn = sp.sign(omega_m)
TRANSVERSAL = {v.beta_T.symbol: v.B_lT.symbol * v.F_T.symbol, v.gamma_T.symbol: v.C_lT.symbol * v.F_T.symbol}


def is_zero(expression: sp.Expr) -> bool:
    """Whether an expression expands, or simplifies, to zero."""
    # Half angles become whole ones, which expand_trig knows.
    halves = sp.expand(expression).subs(theta_m, 2 * theta_m / v.mu.symbol)
    expanded = sp.expand(sp.expand_trig(halves))
    return expanded == 0 or sp.simplify(expanded) == 0


EQUATIONS = [
    pytest.param(name, equation, id=f"{name}-{equation.name}")
    for name in (*model_names(), "linear_axis", "serial_chain")
    for equation in load_model(name).equations
]


@pytest.mark.parametrize(("name", "equation"), EQUATIONS)
def test_every_identity_is_true(name: str, equation: Equation) -> None:
    """What a derivation says to follow from an equation does follow."""
    for identity in equation.identities:
        assert is_zero(identity.zero), f"{name}: {identity.statement}"


@cache
def units(name: str) -> dict[sp.Symbol, str]:
    """Units of the symbols of a model and of all others in its derivation."""
    coefficients = (v.B_lN, v.C_lN, v.B_lT, v.C_lT, v.B_m, v.C_m, v.beta_T, v.gamma_T)
    papers = [q for q in vars(v).values() if hasattr(q, "symbol")]
    papers += [v.directed(q, d) for d in ("pos", "neg") for q in coefficients]
    named = {q.symbol: q.unit for q in papers} | {sp.Symbol("s"): "1"}
    if name == "serial_chain":
        named |= units_of_a_chain()
    return named | load_model(name).units()


def units_of_a_chain() -> dict[sp.Symbol, str]:
    """Units of the letters of a frame, a body and a joint."""
    vectors = {
        "rad/s": motion.w, "rad/s^2": motion.alpha, "m/s^2": [*motion.a, *motion.s_ddot],
        "m": [*motion.s, *motion.letters("p"), sp.Symbol("b", real=True)], "m/s": motion.s_dot,
        "1/s^2": list(motion.U), "kg m": motion.h, "kg m^2": [*motion.Sigma, motion.J_m],
        "kg": [motion.m], "N": [*motion.letters("f"), *sp.symbols("F_N F_T", real=True)],
        "N m": [*motion.letters("n"), *sp.symbols("M_B T", real=True)], "1": [motion.cosine, motion.sine],
    }  # fmt: skip
    named = {letter: unit for unit, letters in vectors.items() for letter in letters}
    named |= {motion.rate_l: "rad/s", motion.acceleration_l: "rad/s^2"}
    named |= {motion.omega_m: "rad/s", motion.alpha_m: "rad/s^2"}
    named |= {sp.Symbol(name, nonnegative=True): "s/rad" for name in ("B_lM", "B_lG")}
    named |= {sp.Symbol(name, nonnegative=True): "1" for name in ("C_lM", "C_lG")}
    named |= {sp.Symbol("M_jj", positive=True): "kg m^2", sp.Symbol("M_jk", real=True): "kg m^2"}
    return named | dict.fromkeys(sp.symbols("omega_m_k omega_after_k", real=True), "rad/s")


@pytest.mark.parametrize(("name", "equation"), EQUATIONS)
def test_every_equation_has_its_unit(name: str, equation: Equation) -> None:
    """The right side of every equation has the dimension that is printed with it."""
    rows = list(equation.right) if isinstance(equation.right, sp.MatrixBase) else [equation.right]
    each = equation.units() * (len(rows) if isinstance(equation.unit, str) else 1)
    for entry, unit in zip(rows, each, strict=True):
        if entry != 0:
            assert of_unit(unit) == of_expression(entry, units(name)), f"{entry} [{unit}]"


@pytest.mark.parametrize("name", [*model_names(), "linear_axis", "serial_chain"])
def test_definitions_and_terms_have_their_units(name: str) -> None:
    """Every definition has the unit of its quantity, and every term that of its balance."""
    model = load_model(name)
    values = [(d.quantity.name, d.quantity.unit, d.value) for d in model.definitions]
    values += [(t.name, b.unit, t.value) for b in model.balances for t in b.terms]
    for what, unit, value in values:
        assert of_unit(unit) == of_expression(value, units(name)), what


def of_derivation(name: str, *equations: str) -> list[sp.Expr]:
    """The right sides of these equations, row by row, with the paper's coefficients of F_T."""
    sides = [load_model(name).equation(equation).right.subs(TRANSVERSAL) for equation in equations]
    return [x for side in sides for x in (side if isinstance(side, sp.MatrixBase) else [side])]


def stable_force(name: str) -> sp.Expr:
    """F_N in inputs and parameters, the opaque steps written out, for an unbalanced mass, squared."""
    model = load_model(name)
    expression = meaning(model.expand(model.definition("F_N").symbol))
    return expression.subs(sp.Eq(v.L.symbol * v.M.symbol, 0), sp.false).doit() ** 2


def printed() -> dict[str, tuple[list[sp.Expr], list[sp.Expr]]]:
    """Equations of the paper -> what a derivation gives, and what the paper prints."""
    p, C1, C2 = LETTERS, "c1_perpendicular", "c2_parallel"
    F_N, phi, w, s = v.F_N.symbol, v.phi.symbol, sp.Symbol("w", positive=True), sp.Symbol("s")
    by_load = (p.mu**2 * p.B_lN * F_N + p.B_m + p.k_i * p.k_e / p.R) * omega_m
    by_load += (p.mu * p.C_lN * F_N + p.C_m) * sgn
    F_1, F_0 = of_derivation(C2, "F_1", "F_0")
    c1, c2 = paper.normal_force_c1(omega_m, p), paper.normal_force_c2(theta_m, omega_m, p, sp)
    torque = paper.gravity_torque(theta_m, p, sp)
    tilted = torque.subs(p.g, p.g * sp.cos(phi))
    level, upright = (stable_force("rotating_link").subs(alpha_m, 0).subs(phi, x) for x in (sp.pi / 2, 0))
    extremal = [x.subs(omega_l, w) ** 2 for x in of_derivation(C2, "F_N_max", "F_N_min")]
    (critical,) = of_derivation(C2, "critical_velocity")
    # The reaction with acceleration and tilt, derived by hand.
    a, b, g = p.M * p.L, p.M + p.M_l, p.g * sp.cos(phi)
    pull = omega_l**2 * sp.cos(theta_l) + alpha_l * sp.sin(theta_l)
    reaction = a**2 * (omega_l**4 + alpha_l**2) + 2 * g * b * a * pull + b**2 * g**2
    return {
        "(4) with (11)": (
            of_derivation(C1, "voltage_steady"), [paper.steady_state_voltage_c1(omega_m, p, sp)],
        ),
        "(5)": (of_derivation(C2, "gravity_torque"), [torque]),
        "(5) in a tilted plane": (of_derivation("rotating_link", "gravity_torque"), [tilted]),
        "(8)": ([load_model(C1).definition("F_N").value], [c1]),
        "(9)": (of_derivation(C1, "link_friction"), [paper.link_friction_c1(omega_m, p, sp)]),
        "(10)": (of_derivation(C1, "motor_friction"), [paper.motor_friction(omega_m, p, sp)]),
        "(11) to (13)": (
            of_derivation(C1, "polynomial_high", "polynomial_low"), list(paper.polynomial_c1(sgn, p)),
        ),
        "(16)": (
            of_derivation(C2, "normal_force"), [paper.normal_force_c2_link(theta_l, omega_l, p, sp) ** 2],
        ),
        "(16) with acceleration and tilt": (of_derivation("rotating_link", "normal_force"), [reaction]),
        "(17)": ([*of_derivation(C2, "normal_force_motor"), stable_force(C2)], [c2**2, c2**2]),
        "(8) and (17) as limits": ([level, upright], [c1**2, c2**2]),
        "(18) to (20)": ([*of_derivation(C2, "resultant"), F_1 * omega_m + F_0], [by_load, by_load]),
        "(22) and (23)": (
            extremal, [paper.normal_force_maximum(w, p) ** 2, paper.normal_force_minimum(w, p) ** 2],
        ),
        "below (23)": ([critical**2], [paper.critical_velocity(p, sp) ** 2]),
        "(24) and (25)": (
            of_derivation(C2, "bottom", "top"),
            [*paper.polynomial_c2(None, sgn, p), *paper.polynomial_c2(s, sgn, p)],
        ),
    }  # fmt: skip


PRINTED = printed()


@pytest.mark.parametrize("number", PRINTED)
def test_a_derivation_gives_what_the_paper_prints(number: str) -> None:
    """Forces as their squares; with F_N as a symbol in (18) to (20), and s as one in (25)."""
    for derived, papers in zip(*PRINTED[number], strict=True):
        assert is_zero(derived - papers)


@pytest.mark.parametrize("share", ["1/100", "99/100", "101/100", "3"], ids=lambda share: f"{share} critical")
@pytest.mark.parametrize("direction", [1, -1], ids=["forwards", "backwards"])
def test_the_switch_of_the_polynomial_at_the_top(share: str, direction: int) -> None:
    """Equation (25): s is 1 below the critical velocity and -1 above it, in either direction."""
    model = load_model("c2_parallel")
    table = paper.table_1(sp.Rational)
    velocity = direction * sp.Rational(share) * paper.critical_velocity(table, sp) / table.mu
    values = {getattr(LETTERS, name): value for name, value in vars(table).items()} | {omega_m: velocity}

    assert paper.top_switch(velocity, table) == model.equation("switch").right.subs(values)


def test_normal_force_lies_between_its_extremal_values_at_every_angle() -> None:
    """Equations (22) and (23) are the least and the greatest of (16) over all degrees of a turn."""
    model = load_model("c2_parallel")
    table = paper.table_1(float)
    values = {getattr(LETTERS, name): value for name, value in vars(table).items()}
    for velocity in (0.5, 7.4, 7.5, 25.0):
        at = values | {omega_l: velocity}
        force = sp.lambdify(theta_l, sp.sqrt(model.equation("normal_force").right.subs(at)), "math")
        forces = [force(math.pi * k / 180) for k in range(360)]

        assert min(forces) == pytest.approx(float(model.equation("F_N_min").right.subs(at)), rel=1e-9)
        assert max(forces) == pytest.approx(float(model.equation("F_N_max").right.subs(at)), rel=1e-12)


def test_balanced_mass_carries_only_its_weight() -> None:
    """M L = 0 is a case of its own in the definitions: F_N is then the weight, whatever the velocity."""
    for name in ("c2_parallel", "rotating_link"):
        model = load_model(name)
        balanced = meaning(model.expand(model.definition("F_N").symbol).subs(v.L.symbol, 0)).subs(
            v.phi.symbol, 0
        )

        assert is_zero(balanced**2 - ((v.M.symbol + v.M_l.symbol) * v.g.symbol) ** 2)


def test_c1_regressor_has_rank_four() -> None:
    """Six friction coefficients of C1 span four columns; which ones is computed, not declared."""
    model = load_model("c1_perpendicular")
    columns = regressor(model)
    p = LETTERS

    assert [column.name for column in columns] == ["B_lN", "C_lN", "B", "C"]
    assert is_zero(model.expand(columns[2].coefficient) - (p.B_m + p.mu**2 * p.B_lT * p.F_T))
    assert is_zero(model.expand(columns[3].coefficient) - (p.C_m + p.mu * p.C_lT * p.F_T))
    # Exact rank at random velocities of both signs.
    moving = [sp.Rational(k * k - 7, 3) for k in range(1, 9)]
    rows = [
        [model.expand(c.basis).subs(_at_table()).subs(omega_m, w).rewrite("meaning") for c in columns]
        for w in moving
    ]
    assert sp.Matrix(rows).rank() == 4


def _at_table() -> dict[sp.Symbol, sp.Rational]:
    return {v.M.symbol: sp.Rational(1, 2), v.L.symbol: sp.Rational(1, 4), v.mu.symbol: sp.Rational(1, 5)}


def test_regressor_spans_the_mechanical_friction() -> None:
    """The columns times their coefficients are the friction terms, in every model."""
    for name in model_names():
        model = load_model(name)
        spanned = sp.Add(*(column.coefficient * column.basis for column in regressor(model)))
        difference = model.expand(spanned - model.balance("mechanical").sum_of("friction"))

        assert is_zero(
            difference.replace(lambda e: type(e).__name__ == "Gated", lambda e: sp.Mul(*e.args))
        ), name


NUMBERS = {
    "c1_perpendicular": (8, 9, 10, 11, 12, 13),
    "c2_parallel": (10, 15, 16, 17, 18, 19, 20, 22, 23, 24, 25),
    "c1_asymmetric": (14,),
    "c2_asymmetric": (21,),
    "rotating_link": (1, 2, 3, 4, 5, 6, 7),
}


@pytest.mark.parametrize("name", model_names())
def test_a_derivation_has_the_papers_numbers(name: str) -> None:
    """It prints its equations with them."""
    printed = str(load_model(name))

    assert [number for number in NUMBERS[name] if f"({number})" not in printed] == []


def printed_by(name: str) -> str:
    """What a derivation prints that is run by its path."""
    command = [sys.executable, f"derivations/{name}.py"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"}
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT, env=environment)
    return done.stdout


def test_a_script_prints_its_derivation() -> None:
    """A derivation run by its path."""
    assert str(load_model("linear_axis")).strip() in printed_by("linear_axis")


@pytest.mark.slow
def test_the_script_of_the_chain_prints_the_recursion_and_the_arm() -> None:
    """Run by its path it prints equations, checks, and the recursion as it is evaluated."""
    printed = printed_by("serial_chain")

    assert [] == [number for number in ("(1)", "(3)", "(7)") if number not in printed]
    assert all(f"    {d.symbol} " in printed for d in load_model("serial_chain").definitions)


def test_the_chain_is_no_model_of_the_papers_drive() -> None:
    """`eccentric derive` takes those; the chain can be read and evaluated."""
    assert "serial_chain" not in model_names()
    assert (ROOT / "derivations" / "serial_chain.py").is_file()


@pytest.mark.parametrize("joint", [0, 1])
def test_terms_of_a_joint_say_what_they_follow(joint: int) -> None:
    """Viscous and Coulomb friction by the loads that it carries, and free of load."""
    terms = load_model("serial_chain").balance(f"mechanical_{joint}").terms
    friction = {(t.role.value, t.load.value, t.joint) for t in terms if t.kind == "friction"}

    # Gravity in the plane: nothing acts along the axis, nothing bends.
    loads = ("F_N", "transmitted_torque", "none")
    assert friction == {(role, load, joint) for role in ("viscous", "coulomb") for load in loads}
