"""A linear axis: a carriage on its guide, with Coulomb and viscous friction and a constant load.

The rotating link without an unbalanced mass, whose coordinate is a position: no force on a bearing follows
the motion, so that friction follows the velocity alone.
Run it to read the derivation: python derivations/linear_axis.py
"""

import sympy as sp

from eccentric.core import show
from eccentric.model import (
    LINEAR,
    Balance,
    Equation,
    Gated,
    Identity,
    Model,
    Role,
    Sgn,
    Term,
    law_at_rest,
    quantity,
    symbols,
)
from eccentric.model import vocabulary as v

# The toolkit's symbols of a drive; LINEAR translates them for a carriage: theta_m is the position, J_m the
# mass, B_m and C_m the friction of the axis, T_load the load.
x, velocity, acceleration = symbols(v.theta_m, v.omega_m, v.alpha_m)
i, u, tau, f, F = symbols(v.i, v.u, v.tau_m, v.f, v.F)

mass = quantity("J_m", "kg m^2", "moving mass", "", "nonnegative")
k_f = quantity("k_i", "N m/A", "force constant", "", "positive")
R = quantity("R", "Ohm", "armature resistance", "", "positive")
k_e = quantity("k_e", "V s/rad", "back-EMF constant", "", "nonnegative")
B = quantity("B_m", "N m s/rad", "viscous friction of the axis", "", "nonnegative", "0")
C = quantity("C_m", "N m", "Coulomb friction of the axis", "", "nonnegative", "0")
load = quantity("T_load", "N m", "constant force against positive motion, such as a weight", "", "real", "0")

friction = B.symbol * velocity + C.symbol * Sgn(velocity)
plain = B.symbol * velocity + C.symbol * sp.sign(velocity)

# Newton along the guide, and Kirchhoff for the armature.
newton = sp.Eq(mass.symbol * acceleration, tau - f - load.symbol)
current = sp.solve(newton.subs(tau, k_f.symbol * i), i)[0]
armature = sp.Eq(u, R.symbol * i + k_e.symbol * velocity)
damping = k_f.symbol * k_e.symbol / R.symbol
# The rest of (k_f/R) u without mass and load.
resultant = sp.expand(
    sp.solve(newton.subs(tau, k_f.symbol * sp.solve(armature, i)[0]), u)[0] * k_f.symbol / R.symbol
    - mass.symbol * acceleration
    - load.symbol
)

equations = (
    Equation(
        "motion", "", tau, sp.solve(newton, tau)[0], "N m", "Newton along the guide: the force of the drive."
    ),
    Equation(
        "friction",
        "",
        f,
        plain,
        "N m",
        "Friction of guide, screw and motor together.",
        (Identity("it is odd in the velocity", plain + plain.subs(velocity, -velocity)),),
    ),
    *law_at_rest(plain, mass.symbol),
    Equation("current", "", i, current, "A", "The current that the motion requires."),
    Equation("voltage", "", u, armature.rhs, "V", "Kirchhoff, armature inductance neglected."),
    Equation(
        "resultant",
        "",
        F,
        resultant,
        "N m",
        "Resultant friction, back-EMF damping included.",
        (
            Identity(
                "it is the friction and the damping by the back-EMF",
                sp.expand(resultant - f - damping * velocity),
            ),
        ),
    ),
)

model = Model(
    name="linear_axis",
    title="A linear axis: Coulomb and viscous friction",
    inputs=(v.theta_m, v.omega_m, v.i, v.u, v.alpha_m),
    parameters=(R, k_f, k_e, mass, B, C, load),
    definitions=(),
    balances=(
        Balance(
            "mechanical",
            "N m",
            (
                Term("motor_torque", "drive", k_f.symbol, i, "", (None, None)),
                Term("inertia", "inertial", sp.Integer(1), Gated(mass.symbol, acceleration), ""),
                Term("load", "conservative", sp.Integer(1), load.symbol, ""),
                Term("viscous", "friction", B.symbol, velocity, "", role=Role.VISCOUS),
                Term("coulomb", "friction", C.symbol, Sgn(velocity), "", role=Role.COULOMB),
            ),
        ),
        Balance(
            "electrical",
            "V",
            (
                Term("voltage", "drive", sp.Integer(1), u, "", (None, None)),
                Term("resistance", "resistive", R.symbol, i, "", (0.0, None)),
                Term("back_emf", "back_emf", k_e.symbol, velocity, "", (None, None)),
            ),
        ),
    ),
    equations=equations,
    axis=LINEAR,
)

if __name__ == "__main__":
    show(model)
