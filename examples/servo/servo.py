"""A geared servo that swings a mass: gear friction that follows the motor torque and the gravity torque.

In the gear of a small servo the tooth force grows with the motor torque and with the load, so dry friction
grows with both, and with the square of the motor torque (M. Duclusaud, G. Passault, V. Padois and O. Ly,
arXiv:2410.08650).  At full duty cycle such a gear is self-locking.

Regression on a log with the drive signal alone cannot identify this friction, which depends on that signal;
`eccentric fit --simulated` identifies it from the motion.
"""

from dataclasses import replace

import sympy as sp

from eccentric.model import Equation, Load, Role, Sgn, Term, load_model, quantity
from eccentric.model import vocabulary as v
from eccentric.output import show

paper = load_model("c2_parallel")
mechanical, electrical = paper.balance("mechanical"), paper.balance("electrical")
motor, gravity = v.k_i.symbol * v.i.symbol, mechanical.sum_of("gravity")
direction = Sgn(v.omega_m.symbol)
REFERENCE = "arXiv:2410.08650"

K_m = quantity("K_m", "1", "friction of the gear per motor torque", "", "nonnegative")
K_m2 = quantity("K_m2", "1/(N m)", "its growth with the motor torque", "", "nonnegative")
K_g = quantity("K_g", "1", "friction of the gear per gravity torque", "", "nonnegative")
coefficients = tuple(replace(q, default=sp.Integer(0)) for q in (K_m, K_m2, K_g))
levels = (sp.Abs(motor), motor**2, sp.Abs(gravity))

terms = tuple(
    Term(q.name, "friction", q.symbol, level * direction, REFERENCE, role=Role.COULOMB, load=Load.TRANSMITTED)
    for q, level in zip(coefficients, levels, strict=True)
)
added = sp.Add(*(term.value for term in terms))

model = replace(
    paper,
    name="servo",
    title="Case C2, a servo whose gear friction follows the motor torque and the gravity torque",
    parameters=(*paper.parameters, *coefficients),
    balances=(replace(mechanical, terms=(*mechanical.terms, *terms)), electrical),
    equations=(
        *paper.equations,
        Equation("gear", "", sp.Symbol("f_g"), added, "N m", "Dry friction of the gear, on the motor side."),
    ),
)

if __name__ == "__main__":
    show(model)
