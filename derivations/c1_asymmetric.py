"""Case C1 with friction that differs between the directions of motion, eq (14).

Run it to read the derivation: python derivations/c1_asymmetric.py
"""

import sympy as sp

from eccentric.core import show
from eccentric.model import Backward, Equation, Forward, Identity, law_at_rest, load_model, symbols
from eccentric.model import vocabulary as v
from eccentric.model.limit import directed

omega_m, F = symbols(v.omega_m, v.F)
symmetric = load_model("c1_perpendicular")
resultant = sp.expand(symmetric.equation("resultant").right)

# One direction: the sign is known, and each friction coefficient has its own value.
split = (v.B_lN, v.C_lN, v.beta_T, v.gamma_T, v.B_m, v.C_m)
own = {d: {q.symbol: v.directed(q, d).symbol for q in split} for d in ("pos", "neg")}


def polynomial(direction: str) -> sp.Matrix:
    """F_3, F_2, F_1, F_0 for one direction of motion."""
    torque = resultant.subs(sp.sign(omega_m), {"pos": 1, "neg": -1}[direction]).subs(own[direction])
    return sp.Matrix([torque.coeff(omega_m, power) for power in (3, 2, 1, 0)])


positive, negative = polynomial("pos"), polynomial("neg")
alike = {new: old for letters in own.values() for old, new in letters.items()}
powers = sp.Matrix([omega_m**3, omega_m**2, omega_m, 1])

POLYNOMIAL = ("N m s^3/rad^3", "N m s^2/rad^2", "N m s/rad", "N m")
friction = symmetric.equation("friction").right
equations = (
    *(symmetric.equation(name) for name in ("normal_force", "normal_force_motor", "friction", "resultant")),
    Equation(
        "polynomial_pos",
        "(14)",
        sp.Matrix(sp.symbols("F_3^+ F_2^+ F_1^+ F_0^+")),
        positive,
        POLYNOMIAL,
        "Coefficients for omega_m > 0.",
        (
            Identity(
                "with equal coefficients F is the symmetric one for omega_m > 0",
                sp.expand((positive.subs(alike).T * powers)[0] - resultant.subs(sp.sign(omega_m), 1)),
            ),
        ),
    ),
    Equation(
        "polynomial_neg",
        "(14)",
        sp.Matrix(sp.symbols("F_3^- F_2^- F_1^- F_0^-")),
        negative,
        POLYNOMIAL,
        "Coefficients for omega_m < 0. The paper prints F_0^- = -mu gamma^- + C_m^-; the derivation gives the"
        " same sign as in (13) and (21).",
        (
            Identity(
                "with equal coefficients F is the symmetric one for omega_m < 0",
                sp.expand((negative.subs(alike).T * powers)[0] - resultant.subs(sp.sign(omega_m), -1)),
            ),
        ),
    ),
    *law_at_rest(friction.subs(own["pos"]), v.J.symbol, friction.subs(own["neg"])),
)

model = directed(
    symmetric,
    name="c1_asymmetric",
    title="Case C1 with friction that differs between the directions of motion",
    gates={"pos": Forward(omega_m), "neg": Backward(omega_m)},
    equations=equations,
)

if __name__ == "__main__":
    show(model)
