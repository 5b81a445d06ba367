"""Findings of a careful reading of the paper: each computed from the derivation, with our interpretation."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import sympy as sp

from eccentric.emission import load_module
from eccentric.model import Quantity, load_model
from eccentric.model import vocabulary as v

# Printed in Table 1, digit by digit: compared with the derivation; nothing is computed from it.
PRINTED = {
    sp.Rational(1, 5): ("8.0000e-7", "8.0000e-5", "4.7139e-3", "3.9392e-2"),
    sp.Rational(1, 30): ("6.1728e-10", "3.7037e-7", "4.4087e-3", "1.3232e-2"),
}
_NAMES = ("F_3", "F_2", "F_1", "F_0")


def polynomial(mu: sp.Rational, **changed: sp.Expr) -> tuple[sp.Expr, ...]:
    """F_3, F_2, F_1, F_0 for omega_m > 0 from the derivation of C1, at Table 1's values, exactly.

    Args:
        mu: gear ratio.
        changed: parameters that differ from Table 1, by their letters.
    """
    model = load_model("c1_perpendicular")
    column = [*model.equation("polynomial_high").right, *model.equation("polynomial_low").right]
    return tuple(sp.nsimplify(_at_table(entry, mu, changed)) for entry in column)


def _at_table(expression: sp.Expr, mu: sp.Rational, changed: Mapping[str, sp.Expr]) -> sp.Expr:
    model = load_model("c1_perpendicular")
    table = {q.symbol: q.default for q in model.parameters if q.default is not None}
    table |= {v.mu.symbol: mu} | {q.symbol: changed[q.name] for q in model.parameters if q.name in changed}
    transversal = {
        v.beta_T.symbol: v.B_lT.symbol * v.F_T.symbol,
        v.gamma_T.symbol: v.C_lT.symbol * v.F_T.symbol,
    }
    forward = {sp.sign(v.omega_m.symbol): 1}
    return expression.subs(forward).subs(transversal).subs(v.F_T.symbol, table[v.F_T.symbol]).subs(table)


def _listed(quantity: Quantity) -> sp.Expr:
    """The quantity's value in Table 1; ValueError if the table has none."""
    if quantity.default is None:
        raise ValueError(f"{quantity.name}: Table 1 lists no value")
    return quantity.default


def agrees(printed: str, value: sp.Expr) -> bool:
    """Whether a printed decimal is the value rounded to that many digits."""
    digits = len(printed.split("e", maxsplit=1)[0].replace(".", ""))
    return math.isclose(float(f"{float(value):.{digits - 1}e}"), float(printed), rel_tol=1e-12)


def table_1() -> str:
    """Table 1's coefficients for both gear ratios next to the derivation's, as text."""
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


def findings() -> tuple[str, ...]:
    """The findings, each as a short text with its numbers computed."""
    return (
        _transversal_force(),
        _back_emf_unit(),
        _global_minimum(),
        _ideal_motor(),
        _sign_in_14(),
        _gear_ratio(),
    )


def _transversal_force() -> str:
    weight = (v.M.symbol + v.M_l.symbol) * v.g.symbol
    lines = [
        (
            "F_T in Table 1 is the weight of the link alone, M_l g;"
            " the derivation gives (M + M_l) g, as in case C2."
        )
    ]
    for mu in PRINTED:
        own, whole = polynomial(mu), polynomial(mu, F_T=weight)
        lines.append(
            f"   mu = {mu}: F_1 = {float(own[2]):.4e}, F_0 = {float(own[3]):.4e} with M_l g;"
            f" F_1 = {float(whole[2]):.4e}, F_0 = {float(whole[3]):.5e} with (M + M_l) g."
        )
    return "\n".join([*lines, "   Reading: F_T is a parameter in newtons, by default Table 1's M_l g."])


def _back_emf_unit() -> str:
    per_revolution = _listed(v.k_e) / (2 * sp.pi)
    mu = sp.Rational(1, 5)
    taken, converted = polynomial(mu)[2], polynomial(mu, k_e=per_revolution)[2]
    listed = f"{float(_listed(v.k_e)):.2f} V s"
    return (
        f"k_e is listed as {listed}/rev, but F_1 takes it as {listed}/rad.\n"
        f"   mu = {mu}: F_1 = {float(taken):.4e} as printed;"
        f" with k_e = {float(per_revolution):.5f} V s/rad it would be {float(converted):.4e}.\n"
        f"   Reading: the default is {listed}/rad, which reproduces Table 1;"
        " figure 4 requires the other (finding 3)."
    )


def _global_minimum() -> str:
    model = load_model("c2_parallel")
    module = load_module(model)
    mu, k_e_listed = float(_listed(v.mu)), float(_listed(v.k_e))
    table = {q.symbol: q.default for q in model.parameters if q.default is not None}
    omega_l = float(model.equation("critical_velocity").right.subs(table))
    link_angle, link_velocity = np.meshgrid(
        np.linspace(0, 2 * np.pi, 721), np.linspace(0, 8 * np.pi, 1601)[1:]
    )
    lines = ["Figure 4's global minimum at (7.41 rad/s, pi) exists only with k_e converted from V s/rev."]
    listed = f"{k_e_listed:.2f} V s"
    for text, k_e in (
        (f"Table 1's {listed}/rad", k_e_listed),
        (f"{listed}/rev, converted", k_e_listed / (2 * math.pi)),
    ):
        parameters = module.Parameters(mu=mu, k_e=k_e)
        at_zero = module.friction_torque(math.pi / mu, omega_l / mu, parameters)
        torque = module.friction_torque(link_angle / mu, link_velocity / mu, parameters)
        lowest = np.unravel_index(np.argmin(torque), torque.shape)
        where = f"{link_velocity[lowest]:.2f} rad/s, {link_angle[lowest]:.2f} rad"
        lines.append(
            f"   {text}: {at_zero:.4f} N m at ({omega_l:.6f} rad/s, pi),"
            f" {module.coulomb_torque(parameters):.4f} N m as the velocity tends to 0;"
            f" minimum on a grid over the figure: {torque[lowest]:.4f} N m at ({where})."
        )
    return "\n".join([*lines, "   Reading: figure 4 is drawn with k_e converted, as its caption requires."])


def _ideal_motor() -> str:
    k_i, k_e = _listed(v.k_i), _listed(v.k_e)
    return (
        "An ideal DC motor has k_e = k_i in SI units (its electrical power is its mechanical power).\n"
        f"   Table 1: k_i = {float(k_i):.4f} N m/A, k_e = {float(k_e):.4f} V s/rad as used,"
        f" {float(k_e / (2 * sp.pi)):.4f} V s/rad converted: neither is equal.\n"
        "   Reading: k_i and k_e are two parameters; nothing is assumed about their ratio."
    )


def _sign_in_14() -> str:
    model = load_model("c1_asymmetric")
    derived = model.equation("polynomial_neg").right[3]
    gamma, C_m, mu = v.directed(v.gamma_T, "neg").symbol, v.directed(v.C_m, "neg").symbol, v.mu.symbol
    printed = -mu * gamma + C_m
    symmetric = -polynomial(sp.Rational(1, 5))[3]
    force = _at_table(v.F_T.symbol, sp.Rational(1, 5), {})
    table = {gamma: _listed(v.C_lT) * force, C_m: _listed(v.C_m), mu: sp.Rational(1, 5)}
    return (
        f"(14) prints F_0^- = {printed}; the derivation gives {derived}.\n"
        "   With equal coefficients, Table 1, mu = 1/5, F_0 for omega_m < 0 must be"
        f" {float(symmetric):.5f} N m, eq (13): printed form {float(printed.subs(table)):.5f},"
        f" derived form {float(derived.subs(table)):.5f}.\n"
        "   Reading: -(mu gamma^- + C_m^-), as in (13) and (21)."
    )


def _gear_ratio() -> str:
    omega_m = v.omega_m.symbol
    same = sp.sign(v.mu.symbol * omega_m) == sp.sign(omega_m)  # the symbol mu is only positive
    verdict = "= sgn(omega_m) for every positive mu" if same else "DIFFERS from sgn(omega_m)"
    return (
        "(3) requires mu < 1, while section 3 speaks of direct drives with mu = 1.\n"
        "   Nothing in the derivation requires mu < 1: it only divides by mu, and, by SymPy,"
        f" sgn(mu omega_m) {verdict}.\n"
        "   Reading: any mu > 0 is valid."
    )
