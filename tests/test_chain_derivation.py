"""The derivation of the serial chain: what it says is true, in every unit, and it can be read."""

import subprocess
import sys
from pathlib import Path

import pytest
import sympy as sp

from eccentric.model import Equation, load_model, model_names
from eccentric.model import vocabulary as v
from eccentric.model.chain import motion
from eccentric.model.limit import of_expression, of_unit

ROOT = Path(__file__).resolve().parent.parent
MODEL = load_model("serial_chain")


def units() -> dict[sp.Symbol, str]:
    """Units of the letters of the derivation."""
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
    named |= dict.fromkeys(sp.symbols("omega_m_k omega_after_k", real=True), "rad/s")
    papers = {q.symbol: q.unit for q in vars(v).values() if hasattr(q, "symbol")}
    return papers | named | MODEL.units()


EQUATIONS = [pytest.param(equation, id=equation.name) for equation in MODEL.equations]


@pytest.mark.parametrize("equation", EQUATIONS)
def test_every_identity_is_true(equation: Equation) -> None:
    """What the derivation says to follow from an equation does follow."""
    for identity in equation.identities:
        assert sp.expand(sp.expand_trig(identity.zero)) == 0, identity.statement


@pytest.mark.parametrize("equation", EQUATIONS)
def test_every_equation_has_its_unit(equation: Equation) -> None:
    """The right side of every equation has the dimension that is printed with it."""
    rows = list(equation.right) if isinstance(equation.right, sp.MatrixBase) else [equation.right]
    each = [equation.unit] * len(rows) if isinstance(equation.unit, str) else equation.unit
    for entry, unit in zip(rows, each, strict=True):
        if entry != 0:
            assert of_unit(unit) == of_expression(entry, units()), f"{entry}"


def test_definitions_and_terms_have_their_units() -> None:
    """Every definition of the arm has the unit of its quantity, and every term that of its balance."""
    for definition in MODEL.definitions:
        unit, value = of_unit(definition.quantity.unit), of_expression(definition.value, units())
        assert unit == value, definition.quantity.name
    for balance in MODEL.balances:
        for term in balance.terms:
            assert of_unit(balance.unit) == of_expression(term.value, units()), term.name


def test_it_is_no_model_to_be_emitted_yet() -> None:
    """`eccentric derive` takes the models that can be emitted; this one can be read and evaluated."""
    assert "serial_chain" not in model_names()
    assert (ROOT / "derivations" / "serial_chain.py").is_file()


def test_the_script_prints_the_recursion_and_the_arm() -> None:
    """Run by its path it prints equations, checks, and the recursion as it is evaluated."""
    printed = subprocess.run(
        [sys.executable, "derivations/serial_chain.py"],
        capture_output=True, text=True, check=True, cwd=ROOT, env={"PYTHONPATH": str(ROOT),
        "PYTHONIOENCODING": "utf-8"},
    ).stdout  # fmt: skip

    assert [] == [number for number in ("(1)", "(3)", "(7)") if number not in printed]
    assert all(f"    {d.symbol} " in printed for d in MODEL.definitions)


def test_terms_say_what_they_follow() -> None:
    """Each joint has viscous and Coulomb friction by the loads that it carries, and free of load."""
    for joint in (0, 1):
        terms = MODEL.balance(f"mechanical_{joint}").terms
        friction = {(t.role.value, t.load.value, t.joint) for t in terms if t.kind == "friction"}

        # Gravity in the plane: nothing acts along the axis, nothing bends.
        loads = ("F_N", "transmitted_torque", "none")
        assert friction == {(role, load, joint) for role in ("viscous", "coulomb") for load in loads}
