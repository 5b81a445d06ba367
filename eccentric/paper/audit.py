"""Table 1 compared with the derivation, and findings on C1, C2 and the gear ratio."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import sympy as sp

from eccentric.emission import load_module
from eccentric.model import Quantity, load_model
from eccentric.model import vocabulary as v

# Table 1: its printed coefficients compared with those of the derivation, and its values.

# As printed in Table 1: only compared with the derivation, never used in a computation.
PRINTED = {
    sp.Rational(1, 5): ("8.0000e-7", "8.0000e-5", "4.7139e-3", "3.9392e-2"),
    sp.Rational(1, 30): ("6.1728e-10", "3.7037e-7", "4.4087e-3", "1.3232e-2"),
}
_NAMES = ("F_3", "F_2", "F_1", "F_0")


def polynomial(mu: sp.Rational, **changed: sp.Expr) -> tuple[sp.Expr, ...]:
    """F_3, F_2, F_1, F_0 for omega_m > 0 from the derivation of C1, at Table 1's values, exactly.

    Args:
        mu: gear ratio.
        changed: parameters that differ from Table 1, by symbol.
    """
    model = load_model("c1_perpendicular")
    column = [*model.equation("polynomial_high").right, *model.equation("polynomial_low").right]
    return tuple(sp.nsimplify(at_table(entry, mu, changed)) for entry in column)


def values(name: str, **changed: sp.Expr) -> dict[sp.Symbol, sp.Expr]:
    """Table 1 for a model, symbol -> value; `changed`: parameters that differ from it, by symbol."""
    table = {q: changed.get(q.name, q.default) for q in load_model(name).parameters}
    return {q.symbol: value for q, value in table.items() if value is not None}


def at_table(expression: sp.Expr, mu: sp.Rational, changed: Mapping[str, sp.Expr]) -> sp.Expr:
    """An expression of C1 at Table 1's values for omega_m > 0; `changed` as in `polynomial`."""
    model = load_model("c1_perpendicular")
    table = {q.symbol: q.default for q in model.parameters if q.default is not None}
    table |= {v.mu.symbol: mu} | {q.symbol: changed[q.name] for q in model.parameters if q.name in changed}
    transversal = {
        v.beta_T.symbol: v.B_lT.symbol * v.F_T.symbol,
        v.gamma_T.symbol: v.C_lT.symbol * v.F_T.symbol,
    }
    forward = {sp.sign(v.omega_m.symbol): 1}
    return expression.subs(forward).subs(transversal).subs(v.F_T.symbol, table[v.F_T.symbol]).subs(table)


def listed(quantity: Quantity) -> sp.Expr:
    """The quantity's value in Table 1; ValueError if the table has none."""
    if quantity.default is None:
        raise ValueError(f"{quantity.name}: Table 1 lists no value")
    return quantity.default


def agrees(printed: str, value: sp.Expr) -> bool:
    """Whether a printed decimal is the value rounded to that many digits."""
    digits = len(printed.split("e", maxsplit=1)[0].replace(".", ""))
    return math.isclose(float(f"{float(value):.{digits - 1}e}"), float(printed), rel_tol=1e-12)


def table_1() -> str:
    """Table 1's coefficients for both gear ratios compared with the derivation's, as text."""
    lines = [
        (
            "Table 1, coefficients of (11) for omega_m > 0:"
            " printed, derived, and whether all printed digits agree"
        ),
        "",
    ]
    for mu, printed in PRINTED.items():
        for name, text, value in zip(_NAMES, printed, polynomial(mu), strict=True):
            verdict = "agrees" if agrees(text, value) else "DIFFERS"
            lines.append(f"  mu = {mu!s:<5} {name}  {text:>10}  {float(value):.8e}  {verdict}")
    return "\n".join(lines)


def transversal_force() -> str:
    """Table 1: the weight that F_T stands for."""
    weight = (v.M.symbol + v.M_l.symbol) * v.g.symbol
    lines = [
        (
            "F_T in Table 1 is the weight of the link alone, M_l g;"
            " the derivation gives (M + M_l) g, as in case C2."
        )
    ]
    for mu in PRINTED:
        link, total = polynomial(mu), polynomial(mu, F_T=weight)
        lines.append(
            f"   mu = {mu}: F_1 = {float(link[2]):.4e}, F_0 = {float(link[3]):.4e} with M_l g;"
            f" F_1 = {float(total[2]):.4e}, F_0 = {float(total[3]):.5e} with (M + M_l) g."
        )
    return "\n".join([*lines, "   Reading: F_T is a parameter in newtons, by default Table 1's M_l g."])


def back_emf_unit() -> str:
    """Table 1: the unit of k_e."""
    per_revolution = listed(v.k_e) / (2 * sp.pi)
    mu = sp.Rational(1, 5)
    taken, converted = polynomial(mu)[2], polynomial(mu, k_e=per_revolution)[2]
    printed = f"{float(listed(v.k_e)):.2f} V s"
    return (
        f"k_e is listed as {printed}/rev, but F_1 takes it as {printed}/rad.\n"
        f"   mu = {mu}: F_1 = {float(taken):.4e} as printed;"
        f" with k_e = {float(per_revolution):.5f} V s/rad it would be {float(converted):.4e}.\n"
        f"   Reading: the default is {printed}/rad, which reproduces Table 1;"
        " figure 4 requires the other (finding 3)."
    )


def ideal_motor() -> str:
    """Table 1: k_e and k_i of one motor."""
    k_i, k_e = listed(v.k_i), listed(v.k_e)
    return (
        "An ideal DC motor has k_e = k_i in SI units (its electrical power is its mechanical power).\n"
        f"   Table 1: k_i = {float(k_i):.4f} N m/A, k_e = {float(k_e):.4f} V s/rad as used,"
        f" {float(k_e / (2 * sp.pi)):.4f} V s/rad converted: neither is equal.\n"
        "   Reading: k_i and k_e are two parameters; nothing is assumed about their ratio."
    )


def sign_in_14() -> str:
    """Equation (14): the sign of F_0^-."""
    model = load_model("c1_asymmetric")
    derived = model.equation("polynomial_neg").right[3]
    gamma, C_m, mu = v.directed(v.gamma_T, "neg").symbol, v.directed(v.C_m, "neg").symbol, v.mu.symbol
    printed = -mu * gamma + C_m
    symmetric = -polynomial(sp.Rational(1, 5))[3]
    force = at_table(v.F_T.symbol, sp.Rational(1, 5), {})
    table = {gamma: listed(v.C_lT) * force, C_m: listed(v.C_m), mu: sp.Rational(1, 5)}
    return (
        f"(14) prints F_0^- = {printed}; the derivation gives {derived}.\n"
        "   With equal coefficients, Table 1, mu = 1/5, F_0 for omega_m < 0 must be"
        f" {float(symmetric):.5f} N m, eq (13): printed form {float(printed.subs(table)):.5f},"
        f" derived form {float(derived.subs(table)):.5f}.\n"
        "   Reading: -(mu gamma^- + C_m^-), as in (13) and (21)."
    )


def gear_ratio() -> str:
    """Equation (3): mu below 1."""
    omega_m = v.omega_m.symbol
    same = sp.sign(v.mu.symbol * omega_m) == sp.sign(omega_m)  # the symbol mu is only positive
    verdict = "= sgn(omega_m) for every positive mu" if same else "DIFFERS from sgn(omega_m)"
    return (
        "(3) requires mu < 1, while section 3 mentions direct drives with mu = 1.\n"
        "   Nothing in the derivation requires mu < 1: it only divides by mu, and, by SymPy,"
        f" sgn(mu omega_m) {verdict}.\n"
        "   Reading: any mu > 0 is valid."
    )


# Findings on case C2: the normal force over a turn, and its consequences.


def global_minimum() -> str:
    """Figure 4: the location of the minimum friction torque."""
    model = load_model("c2_parallel")
    module = load_module(model)
    mu, k_e_listed = float(listed(v.mu)), float(listed(v.k_e))
    table = {q.symbol: q.default for q in model.parameters if q.default is not None}
    omega_l = float(model.equation("critical_velocity").right.subs(table))
    link_angle, link_velocity = np.meshgrid(
        np.linspace(0, 2 * np.pi, 721), np.linspace(0, 8 * np.pi, 1601)[1:]
    )
    lines = ["Figure 4's global minimum at (7.41 rad/s, pi) exists only with k_e converted from V s/rev."]
    unit = f"{k_e_listed:.2f} V s"
    for text, k_e in (
        (f"Table 1's {unit}/rad", k_e_listed),
        (f"{unit}/rev, converted", k_e_listed / (2 * math.pi)),
    ):
        parameters = module.Parameters(mu=mu, k_e=k_e)
        at_zero = module.friction_torque(math.pi / mu, omega_l / mu, parameters)
        torque = module.friction_torque(link_angle / mu, link_velocity / mu, parameters)
        lowest = np.unravel_index(np.argmin(torque), torque.shape)
        where = f"{link_velocity[lowest]:.2f} rad/s, {link_angle[lowest]:.2f} rad"
        lines.append(
            f"   {text}: {at_zero:.4f} N m at ({omega_l:.6f} rad/s, pi),"
            f" {module.breakaway_torque(parameters)[1]:.4f} N m as the velocity tends to 0;"
            f" minimum on a grid over the figure: {torque[lowest]:.4f} N m at ({where})."
        )
    return "\n".join([*lines, "   Reading: figure 4 is drawn with k_e converted, as its caption requires."])


def balanced_mass() -> str:
    """Section 2: a mass without unbalance still has a weight."""
    squared = load_model("c2_parallel").equation("normal_force").right
    balanced = sp.sqrt(sp.factor(squared.subs(v.M.symbol, 0)))
    table = values("c2_parallel")
    force, dry = float(balanced.subs(table)), float((v.mu.symbol * v.C_lN.symbol * balanced).subs(table))
    return (
        "Section 2 says that the normal forces of an evenly distributed mass sum to zero;"
        f" in case C2, (16) with M = 0 gives F_N = {balanced}.\n"
        f"   Table 1, mu = 1/5: F_N = {force:.3f} N, or {dry:.4f} N m of Coulomb friction at the motor.\n"
        "   Reading: F_N of a balanced link is its weight: its friction does not depend on the angle, and is"
        " not zero."
    )


def motor_friction_alone() -> str:
    """Section 4: the remaining F where F_N vanishes."""
    model, table = load_model("c2_parallel"), values("c2_parallel")
    omega_m = model.equation("critical_velocity").right / v.mu.symbol
    at_top = {v.F_N.symbol: 0, v.omega_m.symbol: omega_m}
    motor = float(model.equation("motor_friction").right.subs(at_top).subs(table))
    lines = []
    for text, k_e in (
        (f"k_e = {float(listed(v.k_e)):.2f} V s/rad", listed(v.k_e)),
        ("k_e converted from V s/rev", listed(v.k_e) / (2 * sp.pi)),
    ):
        F = float(model.equation("resultant").right.subs(at_top).subs(values("c2_parallel", k_e=k_e)))
        lines.append(f"   {text}: F = {F:.4f} N m, of which {F - motor:.4f} N m is back-EMF damping.")
    return "\n".join(
        [
            (
                "Section 4 says that where F_N vanishes (18) is the motor's friction alone;"
                " (19) keeps the back-EMF damping k_i k_e/R there."
            ),
            f"   Motor friction (10) at the critical velocity, mu = 1/5: {motor:.4f} N m.",
            *lines,
            "   Reading: F is the resultant torque of (6); the mechanical friction is emitted as well.",
        ]
    )


def constant_speed() -> str:
    """Section 4: the voltage at constant speed."""
    model = load_model("c2_parallel")
    mu = float(listed(v.mu))
    omega_m = float(model.equation("critical_velocity").right.subs(values("c2_parallel"))) / mu
    theta_l = np.linspace(0.0, 2.0 * np.pi, 3601)
    module = load_module(model)
    u = module.voltage(theta_l / mu, omega_m, 0.0, module.Parameters(mu=mu, J_m=0.0, J_l=0.0))
    low, high = int(np.argmin(u)), int(np.argmax(u))
    return (
        "Section 4 assumes a constant velocity over the turn; by (4), G and F_N then make the voltage vary.\n"
        f"   Table 1, mu = 1/5, critical velocity: u from {u[low]:.2f} V at theta_l = {theta_l[low]:.2f} rad"
        f" to {u[high]:.2f} V at {theta_l[high]:.2f} rad.\n"
        "   Reading: a controller holds the speed; at constant voltage alpha_m is not zero in case C2."
    )


def progressive() -> str:
    """Figure 5: whether the friction torque is a progressive function of the velocity."""
    model, omega_m, s = load_model("c2_parallel"), v.omega_m.symbol, sp.Symbol("s")
    forward = {sp.sign(omega_m): 1}

    def curvature(name: str) -> sp.Expr:
        column = [c.subs(forward) for c in model.equation(name).right]
        F = sum(c * omega_m**k for c, k in zip(column, (3, 2, 1, 0), strict=True))
        return sp.factor(sp.diff(F, omega_m, 2))

    bottom = curvature("bottom")
    same = sp.expand(curvature("top") + s * bottom) == 0
    return (
        "Figure 5 and section 5 call the friction of case C2 progressive.\n"
        f"   d^2F/d(omega_m)^2 for omega_m > 0 is {str(bottom).replace('**', '^')} at the bottom, always"
        f" positive; at the top it {'is -s times that' if same else 'DIFFERS'}.\n"
        "   Reading: at the top F is degressive below the critical velocity (s = 1) and progressive above it."
    )


def findings() -> tuple[str, ...]:
    """The findings, each as a short text with its numbers computed."""
    return (
        transversal_force(),
        back_emf_unit(),
        global_minimum(),
        ideal_motor(),
        sign_in_14(),
        gear_ratio(),
        balanced_mass(),
        motor_friction_alone(),
        constant_speed(),
        progressive(),
    )
