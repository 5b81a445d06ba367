"""Findings on Table 1, case C1 and the gear ratio."""

from __future__ import annotations

import sympy as sp

from eccentric.audit.printed import PRINTED, at_table, listed, polynomial
from eccentric.model import load_model
from eccentric.model import vocabulary as v

__all__ = ["back_emf_unit", "gear_ratio", "ideal_motor", "sign_in_14", "transversal_force"]


def transversal_force() -> str:
    """Table 1: which weight F_T is."""
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
        "(3) requires mu < 1, while section 3 speaks of direct drives with mu = 1.\n"
        "   Nothing in the derivation requires mu < 1: it only divides by mu, and, by SymPy,"
        f" sgn(mu omega_m) {verdict}.\n"
        "   Reading: any mu > 0 is valid."
    )
