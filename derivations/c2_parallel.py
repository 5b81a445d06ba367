"""Case C2, section 4 of the paper: gravity parallel to the motion plane, steady motion, eqs (15)-(25).

Run it to read the derivation: python derivations/c2_parallel.py
"""

import sympy as sp

from eccentric.model import Equation, Identity, load_model, symbols
from eccentric.model import vocabulary as v
from eccentric.model.limit import limit
from eccentric.model.steps import HalfCosine, Magnitude, SquareDifference, meaning
from eccentric.output import show

theta_m, omega_m, theta_l, omega_l, alpha_l = symbols(v.theta_m, v.omega_m, v.theta_l, v.omega_l, v.alpha_l)
M, M_l, L, g, phi, mu = symbols(v.M, v.M_l, v.L, v.g, v.phi, v.mu)
R, k_i, k_e, B_lN, C_lN, B_m, C_m = symbols(v.R, v.k_i, v.k_e, v.B_lN, v.C_lN, v.B_m, v.C_m)
f, F, G, F_N, J, alpha_m, u = symbols(v.f, v.F, v.G, v.F_N, v.J, v.alpha_m, v.u)
weight, omega_star, scale_N, speed = symbols(v.weight, v.omega_star, v.scale_N, v.speed)

general = load_model("rotating_link")
parallel = {phi: 0}
steady = {alpha_l: 0}

# --- The normal force ---------------------------------------------------------------------------------------

load = general.equation("load").right.subs(parallel).subs(steady)
F_N_squared = general.equation("normal_force").right.subs(parallel).subs(steady)
on_motor_side = {theta_l: mu * theta_m, omega_l: mu * omega_m}

weight_plain = (M + M_l) * g
# Extremal values: F_N^2 is linear in cos(theta_l), so they are at cos = 1 and cos = -1, both perfect squares.
at_bottom = sp.factor(F_N_squared.subs(theta_l, 0))
at_top = sp.factor(F_N_squared.subs(theta_l, sp.pi))
F_N_max, F_N_min = sp.sqrt(at_bottom), sp.sqrt(at_top)
square = sp.Symbol("omega_l^2", positive=True)
(critical_square,) = sp.roots(at_top.subs(omega_l, sp.sqrt(square)), square)
omega_critical = sp.sqrt(critical_square, evaluate=False)

# The careful form: with the half angle F_N^2 = (a - b)^2 + 4 a b cos^2(theta_l/2); divided by scale_N^2 it is
# the square of omega_m^2 - omega_star^2 plus the square of 2 omega_m omega_star cos(theta_l/2).
careful = scale_N * Magnitude(
    SquareDifference(speed, omega_star), 2 * omega_star * HalfCosine(theta_m, mu) * speed
)
plain = {
    scale_N: M * L * mu**2,
    omega_star: sp.sqrt((M + M_l) * g / (M * L)) / mu,
    speed: sp.Abs(omega_m),
}

# --- The friction torque ------------------------------------------------------------------------------------

friction = general.equation("friction").right.subs(parallel)
resultant = sp.collect(sp.expand(friction + k_i * k_e / R * omega_m), [omega_m, sp.sign(omega_m)])
F_1 = resultant.coeff(omega_m, 1)
F_0 = sp.expand(resultant) - sp.expand(F_1 * omega_m)
F_0 = sp.collect(F_0, sp.sign(omega_m))

# At the bottom and at the top F_N is a polynomial in the velocity (omega_m > 0 here), and so is F.
s = sp.Symbol("s")  # +1 below the critical velocity, -1 above
forward = sp.Symbol("omega_m", positive=True)
at_velocity = {omega_m: forward, sp.sign(omega_m): 1}


def polynomial(normal_force: sp.Expr) -> sp.Poly:
    """F as a polynomial in the motor velocity, for a normal force at a fixed link angle."""
    return sp.Poly(sp.expand(resultant.subs(at_velocity).subs(F_N, normal_force)), forward)


bottom = polynomial(weight_plain + M * L * mu**2 * forward**2)
top = polynomial(s * (weight_plain - M * L * mu**2 * forward**2))


def column(poly: sp.Poly) -> sp.Matrix:
    """Coefficients F_3, F_2, F_1, F_0 as a column."""
    return sp.Matrix(
        [
            sp.collect(sp.expand(c), g, lambda part: sp.factor(part) if part.has(M) else part)
            for c in poly.all_coeffs()
        ]
    )


gravity_torque = general.equation("gravity_torque").right.subs(parallel)

POLYNOMIAL = ("N m s^3/rad^3", "N m s^2/rad^2", "N m s/rad", "N m")
equations = (
    Equation(
        "load",
        "(15)",
        sp.Matrix(sp.symbols("F_x F_y")),
        sp.Matrix(load[:2]),
        "N",
        "The load on the bearing: weight of the link and of M, and the centrifugal force of M.",
    ),
    Equation(
        "normal_force",
        "(16)",
        F_N**2,
        F_N_squared,
        "N^2",
        "Its squared norm is the squared normal force.",
        (
            Identity(
                "F_N^2 is a square at the bottom: (weight + M L omega_l^2)^2",
                sp.expand(at_bottom - (weight_plain + M * L * omega_l**2) ** 2),
            ),
            Identity(
                "and at the top: (weight - M L omega_l^2)^2",
                sp.expand(at_top - (weight_plain - M * L * omega_l**2) ** 2),
            ),
        ),
    ),
    Equation(
        "normal_force_motor",
        "(17)",
        F_N**2,
        F_N_squared.subs(on_motor_side),
        "N^2",
        "The same on the motor side.",
        (
            Identity(
                "it is periodic in the link angle",
                F_N_squared.subs(theta_l, theta_l + 2 * sp.pi) - F_N_squared,
            ),
        ),
    ),
    Equation(
        "careful_normal_force",
        "",
        F_N,
        careful,
        "N",
        "As the code computes it: a difference of squares and the half angle from the top, divided by"
        " scale_N = M L mu^2 (omega_star is the critical velocity on the motor side).",
        (
            Identity(
                "it is equal to (17)",
                meaning(careful).xreplace(plain) ** 2 - F_N_squared.subs(on_motor_side),
            ),
        ),
    ),
    Equation(
        "friction", "(7)", f, friction, "N m", "Friction of both bearings, the transversal force neglected."
    ),
    Equation(
        "resultant", "(18)", F, resultant, "N m", "Resultant friction torque F = F_1 omega_m + F_0, where"
    ),
    Equation(
        "F_1", "(19)", sp.Symbol("F_1"), F_1, "N m s/rad", "the viscous part, back-EMF damping included, is"
    ),
    Equation("F_0", "(20)", sp.Symbol("F_0"), F_0, "N m", "and the Coulomb part is"),
    Equation(
        "F_N_min",
        "(22)",
        sp.Symbol("F_Nmin"),
        F_N_min,
        "N",
        "Least normal force of a revolution, theta_l = pi.",
        (
            Identity(
                "it is |weight - M L omega_l^2|",
                F_N_min - sp.Abs(sp.expand(weight_plain - M * L * omega_l**2)),
            ),
        ),
    ),
    Equation(
        "F_N_max",
        "(23)",
        sp.Symbol("F_Nmax"),
        F_N_max,
        "N",
        "Greatest normal force, theta_l = 0.",
        (Identity("it is weight + M L omega_l^2", F_N_max - (weight_plain + M * L * omega_l**2)),),
    ),
    Equation(
        "critical_velocity",
        "",
        sp.Symbol("omega_l^*"),
        omega_critical,
        "rad/s",
        "Link velocity at which the centrifugal force carries the weight at the top: there F_Nmin = 0.",
        (
            Identity("it is sqrt(weight/(M L))", omega_critical - sp.sqrt(weight_plain / (M * L))),
            Identity("F_N vanishes there", at_top.subs(omega_l, omega_critical)),
        ),
    ),
    Equation(
        "bottom",
        "(24)",
        sp.Matrix(sp.symbols("F_30 F_20 F_10 F_00")),
        column(bottom),
        POLYNOMIAL,
        "At the bottom F is a polynomial in omega_m (here omega_m > 0).",
    ),
    Equation(
        "top",
        "(25)",
        sp.Matrix(sp.symbols("F_3pi F_2pi F_1pi F_0pi")),
        column(top),
        POLYNOMIAL,
        "At the top too, with s = 1 below the critical velocity and s = -1 above.",
    ),
    Equation("gravity_torque", "(5)", G, gravity_torque, "N m", "Gravity torque."),
    Equation("voltage", "(4)", u, R / k_i * (J * alpha_m + G + F), "V", "Voltage of the drive."),
)

model = limit(
    general,
    name="c2_parallel",
    title="Case C2: gravity parallel to the motion plane, steady motion",
    substitutions=parallel,
    definitions={v.F_N: careful, v.g_p: g},
    equations=equations,
)

if __name__ == "__main__":
    show(model)
