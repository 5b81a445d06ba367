"""Case C2, section 4 of the paper: gravity parallel to the motion plane, steady motion, eqs (15)-(25).

Run it to read the derivation: python derivations/c2_parallel.py
"""

import sympy as sp

from eccentric.core import show
from eccentric.model import (
    Equation,
    HalfCosine,
    Identity,
    Magnitude,
    SquareDifference,
    law_at_rest,
    load_model,
    meaning,
    symbols,
)
from eccentric.model import vocabulary as v
from eccentric.model.limit import limit

theta_m, omega_m, theta_l, omega_l, alpha_l = symbols(v.theta_m, v.omega_m, v.theta_l, v.omega_l, v.alpha_l)
M, M_l, L, g, phi, mu = symbols(v.M, v.M_l, v.L, v.g, v.phi, v.mu)
R, k_i, k_e, B_lN, C_lN, B_m, C_m = symbols(v.R, v.k_i, v.k_e, v.B_lN, v.C_lN, v.B_m, v.C_m)
f, f_m, f_l, F, G, F_N, J, alpha_m, u = symbols(v.f, v.f_m, v.f_l, v.F, v.G, v.F_N, v.J, v.alpha_m, v.u)
weight, omega_star, scale_N, speed = symbols(v.weight, v.omega_star, v.scale_N, v.speed)

general = load_model("rotating_link")
parallel = {phi: 0}
steady = {alpha_l: 0}

# --- The normal force ---------------------------------------------------------------------------------------

load = general.equation("load").right.subs(parallel).subs(steady)
F_N_squared = general.equation("normal_force").right.subs(parallel).subs(steady)
on_motor_side = {theta_l: mu * theta_m, omega_l: mu * omega_m}

weight_plain = (M + M_l) * g

# Extrema over a revolution: where the slope vanishes. The curvature distinguishes minimum from maximum.
slope = sp.diff(F_N_squared, theta_l)
curvature = sp.diff(slope, theta_l)
sine = sp.Symbol("sine")
(zero,) = sp.roots(slope.subs(sp.sin(theta_l), sine), sine)
stationary = (sp.asin(zero), sp.pi - sp.asin(zero))  # both angles of a revolution with this sine
(top_angle,) = (angle for angle in stationary if curvature.subs(theta_l, angle).is_nonnegative)
(bottom_angle,) = (angle for angle in stationary if curvature.subs(theta_l, angle).is_nonpositive)
at_bottom = sp.factor(F_N_squared.subs(theta_l, bottom_angle))
at_top = sp.factor(F_N_squared.subs(theta_l, top_angle))
F_N_max, F_N_min = sp.sqrt(at_bottom), sp.sqrt(at_top)
# They are global over the turn: the excess of F_N^2 over the top, and its deficit from the bottom.
over_top = 4 * weight_plain * M * L * omega_l**2 * sp.cos(theta_l / 2) ** 2
under_bottom = 4 * weight_plain * M * L * omega_l**2 * sp.sin(theta_l / 2) ** 2

# F_Nmin is the magnitude of the weight minus the centrifugal force: s times the difference, s its sign.
(net_weight,) = F_N_min.args
switch = sp.sign(net_weight)
square = sp.Symbol("omega_l^2", positive=True)
(critical_square,) = sp.roots(at_top.subs(omega_l, sp.sqrt(square)), square)
omega_critical = sp.sqrt(critical_square, evaluate=False)

# Numerically stable, by the half angle: F_N^2 = (a - b)^2 + 4 a b cos^2(theta_l/2). Over scale_N^2 it is
# the square of omega_m^2 - omega_star^2 plus the square of 2 omega_m omega_star cos(theta_l/2).
stable = scale_N * Magnitude(
    SquareDifference(speed, omega_star), 2 * omega_star * HalfCosine(theta_m, mu) * speed
)
plain = {scale_N: M * L * mu**2, omega_star: sp.sqrt((M + M_l) * g / (M * L)) / mu, speed: sp.Abs(omega_m)}

# --- The friction torque ------------------------------------------------------------------------------------

motor_friction = general.equation("motor_friction").right
link_friction = general.equation("link_friction").right.subs(parallel)
friction = motor_friction + mu * link_friction
torques = {f_m: motor_friction, f_l: link_friction}
resultant = sp.expand(general.equation("resultant").right.subs(torques))
resultant = sp.collect(resultant, [omega_m, sp.sign(omega_m)])
F_1 = resultant.coeff(omega_m, 1)
F_0 = sp.expand(resultant) - sp.expand(F_1 * omega_m)
F_0 = sp.collect(F_0, sp.sign(omega_m))

# At the bottom and at the top F_N is a polynomial in the velocity, by (23) and (22), and so is F.
s, sgn = sp.symbols("s sgn")  # of (25); the sign of omega_m, a symbol so that it does not count as a power


def polynomial(normal_force: sp.Expr) -> sp.Matrix:
    """F_3, F_2, F_1, F_0 of F for a normal force, in omega_l, at a fixed link angle."""
    torque = resultant.subs(sp.sign(omega_m), sgn).subs(F_N, normal_force.subs(omega_l, mu * omega_m))
    weighed = [
        sp.collect(sp.expand(c), g, lambda part: sp.factor(part) if part.has(M) else part)
        for c in sp.Poly(torque, omega_m).all_coeffs()
    ]
    return sp.Matrix([sp.collect(c, sgn).subs(sgn, sp.sign(omega_m)) for c in weighed])


bottom, top = polynomial(F_N_max), polynomial(s * net_weight)
powers = sp.Matrix([omega_m**3, omega_m**2, omega_m, 1])


def bend(column: sp.Matrix) -> sp.Expr:
    """d^2F/d(omega_m)^2 for omega_m > 0: a friction torque is progressive where it is positive."""
    return sp.diff((column.T * powers)[0].subs(sp.sign(omega_m), 1), omega_m, 2)


gravity_torque = general.equation("gravity_torque").right.subs(parallel)

POLYNOMIAL = ("N m s^3/rad^3", "N m s^2/rad^2", "N m s/rad", "N m")
equations = (
    Equation(
        "load",
        "(15)",
        sp.Matrix(sp.symbols("F_x F_y")),
        sp.Matrix(load[:2]),
        "N",
        "The load on the bearing: weight of the link and of M, plus the centrifugal force of M.",
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
        "stable_normal_force",
        "",
        F_N,
        stable,
        "N",
        "As computed in the code: a difference of squares and the half angle from the top, divided by"
        " scale_N = M L mu^2 (omega_star is the critical velocity on the motor side).",
        (
            Identity(
                "it is equal to (17)", meaning(stable).xreplace(plain) ** 2 - F_N_squared.subs(on_motor_side)
            ),
        ),
    ),
    Equation(
        "link_friction",
        "(7)",
        f_l,
        link_friction,
        "N m",
        "Friction of the link joint (link side), the transversal force neglected.",
    ),
    Equation("motor_friction", "(10)", f_m, motor_friction, "N m", "Friction of the motor bearing."),
    Equation("friction", "(7)", f, friction, "N m", "Mechanical friction on the motor side, f_m + mu f_l."),
    Equation(
        "resultant", "(18)", F, resultant, "N m", "Resultant friction torque F = F_1 omega_m + F_0, where"
    ),
    Equation(
        "F_1", "(19)", sp.Symbol("F_1"), F_1, "N m s/rad", "the viscous part, back-EMF damping included, is"
    ),
    Equation("F_0", "(20)", sp.Symbol("F_0"), F_0, "N m", "and the Coulomb part is"),
    Equation(
        "slope",
        "",
        sp.Derivative(F_N**2, theta_l, evaluate=False),
        slope,
        "N^2/rad",
        "Slope of F_N^2 over the link angle, at constant velocity: where it vanishes, F_N is extremal.",
        (
            Identity(
                "it is proportional to sin(theta_l): within a revolution it vanishes at 0 and at pi only",
                slope + 2 * weight_plain * M * L * omega_l**2 * sp.sin(theta_l),
            ),
        ),
    ),
    Equation(
        "curvature",
        "",
        sp.Derivative(F_N**2, (theta_l, 2), evaluate=False),
        curvature,
        "N^2/rad^2",
        "Its curvature distinguishes the minimum from the maximum.",
        (
            Identity(
                "at theta_l = pi it is never negative",
                curvature.subs(theta_l, sp.pi) - sp.Abs(curvature.subs(theta_l, sp.pi)),
            ),
            Identity(
                "at theta_l = 0 it is never positive",
                curvature.subs(theta_l, 0) + sp.Abs(curvature.subs(theta_l, 0)),
            ),
        ),
    ),
    Equation(
        "F_N_min",
        "(22)",
        sp.Symbol("F_Nmin"),
        F_N_min,
        "N",
        "Minimum normal force of a revolution, theta_l = pi.",
        (
            Identity("it is at theta_l = pi", top_angle - sp.pi),
            Identity(
                "it is |weight - M L omega_l^2|",
                F_N_min - sp.Abs(sp.expand(weight_plain - M * L * omega_l**2)),
            ),
            Identity(
                "F_N^2 exceeds it by 4 weight M L omega_l^2 cos^2(theta_l/2)",
                F_N_squared - F_N_min**2 - over_top,
            ),
            Identity("that is never negative: no angle has a smaller F_N", over_top - sp.Abs(over_top)),
        ),
    ),
    Equation(
        "F_N_max",
        "(23)",
        sp.Symbol("F_Nmax"),
        F_N_max,
        "N",
        "Maximum normal force, theta_l = 0.",
        (
            Identity("it is at theta_l = 0", bottom_angle),
            Identity("it is weight + M L omega_l^2", F_N_max - (weight_plain + M * L * omega_l**2)),
            Identity(
                "F_N^2 is less by 4 weight M L omega_l^2 sin^2(theta_l/2)",
                F_N_max**2 - F_N_squared - under_bottom,
            ),
            Identity(
                "that is never negative: no angle has a larger F_N", under_bottom - sp.Abs(under_bottom)
            ),
        ),
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
        bottom,
        POLYNOMIAL,
        "At the bottom F is a polynomial in omega_m, with F_N from (23).",
        (
            Identity(
                "it is what the paper prints",
                (bottom.T * powers)[0]
                - mu**4 * B_lN * M * L * omega_m**3
                - mu**3 * C_lN * M * L * sp.sign(omega_m) * omega_m**2
                - (mu**2 * B_lN * weight_plain + B_m + k_i * k_e / R) * omega_m
                - (mu * C_lN * weight_plain + C_m) * sp.sign(omega_m),
            ),
            Identity(
                "it is progressive: convex over omega_m > 0",
                bend(bottom) - 2 * mu**3 * M * L * (3 * B_lN * mu * omega_m + C_lN),
            ),
        ),
    ),
    Equation(
        "switch",
        "(25)",
        s,
        switch.subs(omega_l, mu * omega_m),
        "1",
        "At the top F_N is (22); s is the sign of weight minus centrifugal force: 1 below the critical"
        " velocity and -1 above it.",
        (
            Identity(
                "s (weight - M L omega_l^2) is F_Nmin", F_N_min - switch * (weight_plain - M * L * omega_l**2)
            ),
            Identity("at rest it is the sign of the weight", switch.subs(omega_l, 0) - sp.sign(weight_plain)),
            Identity("it is 0 at the critical velocity", switch.subs(omega_l, omega_critical)),
        ),
    ),
    Equation(
        "top",
        "(25)",
        sp.Matrix(sp.symbols("F_3pi F_2pi F_1pi F_0pi")),
        top,
        POLYNOMIAL,
        "So F is a polynomial in omega_m at the top as well, one below the critical velocity and one above.",
        (
            Identity(
                "it is what the paper prints",
                (top.T * powers)[0]
                + s * mu**4 * B_lN * M * L * omega_m**3
                + s * mu**3 * C_lN * M * L * sp.sign(omega_m) * omega_m**2
                - (s * mu**2 * B_lN * weight_plain + B_m + k_i * k_e / R) * omega_m
                - (s * mu * C_lN * weight_plain + C_m) * sp.sign(omega_m),
            ),
            Identity(
                "its curvature is -s times that at the bottom: negative below the critical velocity",
                bend(top) + s * bend(bottom),
            ),
            Identity(
                "it is (18) with s (weight - M L omega_l^2) as F_N",
                (top.T * powers)[0] - resultant.subs(F_N, s * net_weight.subs(omega_l, mu * omega_m)),
            ),
        ),
    ),
    *law_at_rest(friction, J),
    Equation("gravity_torque", "(5)", G, gravity_torque, "N m", "Gravity torque."),
    Equation("voltage", "(4)", u, R / k_i * (J * alpha_m + G + F), "V", "Voltage of the drive."),
)

model = limit(
    general,
    name="c2_parallel",
    title="Case C2: gravity parallel to the motion plane, steady motion",
    substitutions=parallel,
    definitions={v.F_N: stable, v.g_p: g},
    equations=equations,
)

if __name__ == "__main__":
    show(model)
