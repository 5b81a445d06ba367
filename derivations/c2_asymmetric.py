"""Case C2 with friction that differs between the directions of motion, eq (21).

Run it to read the derivation: python derivations/c2_asymmetric.py
"""

import sympy as sp

from eccentric.core import show
from eccentric.model import Backward, Equation, Forward, Identity, law_at_rest, load_model, symbols
from eccentric.model import vocabulary as v
from eccentric.model.limit import directed

omega_m, F = symbols(v.omega_m, v.F)
symmetric = load_model("c2_parallel")
resultant = sp.expand(symmetric.equation("resultant").right)
split = (v.B_lN, v.C_lN, v.B_m, v.C_m)
own = {d: {q.symbol: v.directed(q, d).symbol for q in split} for d in ("pos", "neg")}


def one_direction(direction: str) -> sp.Expr:
    """F for one direction of motion: the sign is known, each friction coefficient has its own value."""
    torque = resultant.subs(sp.sign(omega_m), {"pos": 1, "neg": -1}[direction]).subs(own[direction])
    return sp.collect(torque, omega_m)


positive, negative = one_direction("pos"), one_direction("neg")
alike = {new: old for letters in own.values() for old, new in letters.items()}
friction = symmetric.equation("friction").right
equations = (
    *(
        symmetric.equation(name)
        for name in ("load", "normal_force", "normal_force_motor", "stable_normal_force")
    ),
    *(symmetric.equation(name) for name in ("friction", "resultant")),
    Equation(
        "resultant_pos",
        "(21)",
        F,
        positive,
        "N m",
        "For omega_m > 0: F_1^+ omega_m + F_0^+.",
        (
            Identity(
                "with equal coefficients it is the symmetric one",
                sp.expand(positive.subs(alike) - resultant.subs(sp.sign(omega_m), 1)),
            ),
        ),
    ),
    Equation(
        "resultant_neg",
        "(21)",
        F,
        negative,
        "N m",
        "For omega_m < 0: F_1^- omega_m + F_0^-.",
        (
            Identity(
                "with equal coefficients it is the symmetric one",
                sp.expand(negative.subs(alike) - resultant.subs(sp.sign(omega_m), -1)),
            ),
        ),
    ),
    *law_at_rest(friction.subs(own["pos"]), v.J.symbol, friction.subs(own["neg"])),
    symmetric.equation("gravity_torque"),
)

model = directed(
    symmetric,
    name="c2_asymmetric",
    title="Case C2 with friction that differs between the directions of motion",
    gates={"pos": Forward(omega_m), "neg": Backward(omega_m)},
    equations=equations,
)

if __name__ == "__main__":
    show(model)
