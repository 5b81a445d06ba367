"""The rotating link with an unbalanced mass, in a plane tilted by phi, with angular acceleration.

All other cases are limits of this one: phi = pi/2 and alpha = 0 is C1, phi = 0 and alpha = 0 is C2.
Run it to read the derivation: python derivations/rotating_link.py
"""

import sympy as sp

from eccentric.core import show
from eccentric.model import (
    Bounded,
    Definition,
    DriveSymbols,
    Equation,
    Gated,
    HalfCosine,
    HalfSine,
    Identity,
    Load,
    Magnitude,
    Model,
    SquareDifference,
    drive_balances,
    law_at_rest,
    meaning,
    symbols,
)
from eccentric.model import vocabulary as v

t, theta_m, omega_m, alpha_m = symbols(v.t, v.theta_m, v.omega_m, v.alpha_m)
theta_l, omega_l, alpha_l = symbols(v.theta_l, v.omega_l, v.alpha_l)
M, M_l, L, g, phi, J_l = symbols(v.M, v.M_l, v.L, v.g, v.phi, v.J_l)
mu, R, k_i, k_e, J_m, J = symbols(v.mu, v.R, v.k_i, v.k_e, v.J_m, v.J)
u, i, tau_m, tau_l, f_m, f_l, f, F, G, F_N = symbols(
    v.u, v.i, v.tau_m, v.tau_l, v.f_m, v.f_l, v.f, v.F, v.G, v.F_N
)
B_lN, C_lN, B_lT, C_lT, B_m, C_m, F_T = symbols(v.B_lN, v.C_lN, v.B_lT, v.C_lT, v.B_m, v.C_m, v.F_T)
g_p, weight, critical_squared, omega_star, scale_N, fastest, speed = symbols(
    v.g_p, v.weight, v.critical_squared, v.omega_star, v.scale_N, v.fastest, v.speed
)

# --- The link: positions, differentiated. Frame: x level and y up in the plane of motion, z along the axis. -

theta = sp.Function("theta_l")(t)  # the link angle as a function of time
direction = sp.Matrix([sp.sin(theta), -sp.cos(theta), 0])
position, acceleration = L * direction, L * direction.applyfunc(lambda x: x.diff(t).diff(t))
acceleration = acceleration.subs({theta.diff(t, 2): alpha_l}).subs({theta.diff(t): omega_l})
position, acceleration = position.subs(theta, theta_l), acceleration.subs(theta, theta_l)
gravity = sp.Matrix([0, -g * sp.cos(phi), -g * sp.sin(phi)])

# Newton for both masses (M_l is balanced: its centre is on the axis). The bearing load is minus the reaction
# of the bearing.
reaction = M * acceleration - (M + M_l) * gravity
load = -reaction
in_plane = sp.Matrix(load[:2])
pythagoras = {sp.sin(theta_l) ** 2: 1 - sp.cos(theta_l) ** 2}
squared = sp.expand(sp.expand(in_plane.dot(in_plane)).subs(pythagoras))
F_N_squared = sp.Add(*(g**power * sp.factor(squared.coeff(g, power)) for power in range(3)))
transversal = -load[2]  # along minus z: the part of the weight that the bearing carries

# Euler about the axis: inertia of the link without M, and M at its distance.
J_0 = J_l - M * L**2
moment = position.cross(M * (acceleration - gravity))[2]
torque_on_link = sp.expand(sp.expand(J_0 * alpha_l + moment + f_l).subs(pythagoras))
gravity_on_link = torque_on_link - J_l * alpha_l - f_l

# --- The drive ----------------------------------------------------------------------------------------------

armature = sp.Eq(u, R * i + k_e * omega_m)  # Kirchhoff, armature inductance neglected
current = sp.solve(armature, i, simplify=False)[0]
motor_torque = k_i * current
gear = {theta_l: mu * theta_m, omega_l: mu * omega_m, alpha_l: mu * alpha_m}
# An ideal gear transmits power: the motor supplies at omega_m what the link takes at omega_l.
gear_torque = tau_l * gear[omega_l] / omega_m
newton_motor = sp.Eq(J_m * alpha_m, tau_m - f_m - gear_torque)

drive = newton_motor.subs({tau_m: motor_torque}).subs({tau_l: torque_on_link}).subs(gear)
gravity_torque = mu * gravity_on_link.subs(gear)
inertia = sp.expand(drive.lhs - drive.rhs).coeff(alpha_m)
# (4) is (k_i/R) u = inertial + gravity + rest, and the rest is called F.
resultant = sp.expand(sp.solve(drive, u, simplify=False)[0] * k_i / R - inertia * alpha_m - gravity_torque)

# --- Friction: the postulate (7) for both bearings ----------------------------------------------------------

link_force_N, link_force_T = F_N, F_T * sp.sin(phi)
link_friction = (B_lN * link_force_N + B_lT * link_force_T) * omega_l + (
    C_lN * link_force_N + C_lT * link_force_T
) * sp.sign(omega_l)
motor_friction = B_m * omega_m + C_m * sp.sign(omega_m)
link_friction = link_friction.subs(gear)
mechanical = motor_friction + mu * link_friction

# --- The numerically stable form of F_N ---------------------------------------------------------------------

# With the half angle, a = M L omega_l^2 and b the weight: the radial part a + b cos(theta_l) becomes
# (a - b) + 2 b cos^2(theta_l/2), without cancellation near the top. Everything is divided by
# scale_N = M L mu^2, so that a becomes omega_m^2 and b becomes omega_star^2. A balanced mass (M L = 0) has
# F_N = b: then omega_star = 1 rad/s, scale_N = b/omega_star^2, and speed and acceleration are bounded by 0.
half_cosine, half_sine = HalfCosine(theta_m, mu), HalfSine(theta_m, mu)
radial = SquareDifference(speed, omega_star) + 2 * omega_star**2 * half_cosine**2
tangential = Bounded(alpha_m / mu, fastest**2) - 2 * omega_star**2 * half_cosine * half_sine
stable = scale_N * Magnitude(radial, tangential)
# (5) by the same half angle: sin(theta_l) is minus twice the product.
stable_gravity = -2 * mu * M * g_p * L * half_cosine * half_sine

balanced = sp.Eq(M * L, 0)
definitions = (
    Definition(v.J, inertia),
    Definition(v.g_p, g * sp.Abs(sp.cos(phi))),  # phi <= pi/2; rounding must not make the weight negative
    Definition(v.weight, (M + M_l) * g_p),
    Definition(v.critical_squared, sp.Piecewise((1, balanced), (weight / (M * L), True))),
    Definition(v.omega_star, sp.Piecewise((1, balanced), (sp.sqrt(critical_squared) / mu, True))),
    Definition(v.scale_N, sp.Piecewise((weight / omega_star**2, balanced), (M * L * mu**2, True))),
    Definition(v.fastest, sp.Piecewise((0, balanced), (2**30, True))),
    Definition(v.speed, Bounded(sp.Abs(omega_m), fastest)),
    Definition(v.F_N, stable),
    Definition(v.B, B_m + mu**2 * B_lT * link_force_T),
    Definition(v.C, C_m + mu * C_lT * link_force_T),
)

# The paper's drive: motor, gear and armature, and load-dependent friction of the link bearing.
letters = DriveSymbols(
    omega_m, i, u, mu, R, k_i, k_e, B_m, C_m, {Load.NORMAL: (B_lN, C_lN), Load.TRANSVERSAL: (B_lT, C_lT)}
)
moved = (("inertia", "inertial", Gated(J, alpha_m), "(4)"), ("gravity", "gravity", stable_gravity, "(5)"))
balance, electrical = drive_balances(
    letters, moved, {Load.NORMAL: link_force_N, Load.TRANSVERSAL: link_force_T}
)

# For M L > 0 the definitions become:
plain = {
    scale_N: M * L * mu**2,
    omega_star: sp.sqrt((M + M_l) * g * sp.cos(phi) / (M * L)) / mu,
    speed: sp.Abs(omega_m),
    fastest: sp.Integer(2**30),
}
stable_squared = meaning(stable).xreplace(plain) ** 2

as_in_C2 = {phi: 0, alpha_l: 0}
equations = (
    Equation(
        "position",
        "",
        sp.Symbol("r"),
        position,
        "m",
        "Position of the mass M; the link angle is 0 where the mass hangs lowest"
        " (x level and y up in the plane of motion, z along the axis).",
    ),
    Equation("acceleration", "", sp.Symbol("r''"), acceleration, "m/s^2", "Its second derivative in time."),
    Equation(
        "load",
        "",
        sp.Symbol("P"),
        load,
        "N",
        "Newton for both masses: the load P on the bearing; the plane is tilted by phi.",
        (
            Identity(
                "its horizontal part is that of (15) for phi = 0, alpha_l = 0",
                load[0].subs(as_in_C2) - M * L * omega_l**2 * sp.sin(theta_l),
            ),
            Identity(
                "its vertical part is that of (15) for phi = 0, alpha_l = 0",
                load[1].subs(as_in_C2) + M * L * omega_l**2 * sp.cos(theta_l) + (M + M_l) * g,
            ),
        ),
    ),
    Equation(
        "normal_force",
        "",
        F_N**2,
        F_N_squared,
        "N^2",
        "Squared norm of its part in the plane of motion: the normal force.",
        (
            Identity(
                "it is the square of (16) for phi = 0, alpha_l = 0",
                F_N_squared.subs(as_in_C2)
                - (M * L * omega_l**2) ** 2
                - 2 * g * (M + M_l) * M * L * omega_l**2 * sp.cos(theta_l)
                - ((M + M_l) * g) ** 2,
            ),
            Identity(
                "without weight and acceleration it is (M L omega_l^2)^2, the square of (8)",
                F_N_squared.subs({g: 0, alpha_l: 0}) - (M * L * omega_l**2) ** 2,
            ),
            Identity(
                "it is even under reversal of link angle and acceleration",
                F_N_squared - F_N_squared.subs({theta_l: -theta_l, alpha_l: -alpha_l}, simultaneous=True),
            ),
            Identity(
                "without unbalance it is the squared weight",
                F_N_squared.subs(L, 0) - ((M + M_l) * g * sp.cos(phi)) ** 2,
            ),
        ),
    ),
    Equation(
        "transversal_force",
        "",
        sp.Symbol("F_z"),
        transversal,
        "N",
        "Its part along the axis: the whole weight times sin(phi). Table 1 takes M_l g; F_T is a parameter.",
    ),
    Equation(
        "torque_on_link",
        "(3)",
        tau_l,
        torque_on_link,
        "N m",
        "Euler about the axis, J_l including M L^2: the torque that the drive must exert on the link.",
    ),
    Equation(
        "gear",
        "(3)",
        sp.Matrix([theta_l, omega_l, alpha_l]),
        sp.Matrix(list(gear.values())),
        ("rad", "rad/s", "rad/s^2"),
        "The gear couples the link to the motor.",
    ),
    Equation(
        "motor",
        "(1)",
        newton_motor.lhs,
        newton_motor.rhs,
        "N m",
        "Newton for the rotor; an ideal gear transmits the power of the link.",
    ),
    Equation(
        "motor_torque",
        "(2)",
        tau_m,
        motor_torque,
        "N m",
        "Kirchhoff for the armature, its inductance neglected, and tau_m = k_i i.",
        (
            Identity(
                "the electrical balance is Kirchhoff's law",
                electrical.residual() - (armature.lhs - armature.rhs),
            ),
        ),
    ),
    Equation(
        "gravity_torque",
        "(5)",
        G,
        gravity_torque,
        "N m",
        "Gravity torque on the motor side.",
        (
            Identity(
                "the numerically stable form of the code is equal to it",
                gravity_torque - meaning(stable_gravity).subs(g_p, g * sp.cos(phi)),
            ),
        ),
    ),
    Equation("inertia", "(4)", J, inertia, "kg m^2", "The factor of alpha_m, on the motor side."),
    Equation(
        "resultant",
        "(6)",
        F,
        resultant,
        "N m",
        "The remaining term of (k_i/R) u = J alpha_m + G + F is the resultant friction torque.",
        (
            Identity(
                "it is the friction of motor and link plus the damping by the back-EMF",
                sp.expand(resultant - f_m - mu * f_l - k_i * k_e / R * omega_m),
            ),
        ),
    ),
    Equation(
        "motor_friction",
        "(10)",
        f_m,
        motor_friction,
        "N m",
        "The postulate (7), viscous and Coulomb friction, for the motor bearing, whose load is constant.",
    ),
    Equation(
        "link_friction",
        "(7)",
        f_l,
        link_friction,
        "N m",
        "The same for the link joint, where both are proportional to the forces that it carries (link side).",
    ),
    Equation(
        "friction",
        "(7)",
        f,
        mechanical,
        "N m",
        "Mechanical friction on the motor side, f_m + mu f_l.",
        (
            Identity(
                "with the back-EMF damping it is the resultant friction torque (6)",
                sp.expand(
                    resultant.subs({f_m: motor_friction, f_l: link_friction})
                    - mechanical
                    - k_i * k_e / R * omega_m
                ),
            ),
            Identity(
                "the friction terms of the balance are (7)",
                sp.expand(meaning(balance.sum_of("friction")) - mechanical),
            ),
        ),
    ),
    *law_at_rest(mechanical, J),
    Equation(
        "loss",
        "",
        sp.Symbol("J_f"),
        (C_lN * mu**2 + B_lN * mu**3 * sp.Abs(omega_m)) * M * L,
        "kg m^2",
        "F_N contains the acceleration: friction changes with alpha_m by at most this. A step takes alpha_m"
        " from the step before, which converges while it is less than J.",
        (
            Identity(
                "F_N changes with alpha_l by at most M L, as it is at least its part along the link",
                (M * L) ** 2
                * (F_N_squared - (M * L * omega_l**2 + weight * sp.cos(theta_l)) ** 2).subs(
                    weight, (M + M_l) * g * sp.cos(phi)
                )
                - (sp.diff(F_N_squared, alpha_l) / 2) ** 2,
            ),
        ),
    ),
    Equation(
        "stable_normal_force",
        "",
        F_N,
        stable,
        "N",
        "F_N as computed in the code: half angle from the top and a difference of squares, for M L > 0"
        " divided by scale_N = M L mu^2; HalfCosine, HalfSine, SquareDifference and Magnitude keep their"
        " order of evaluation.",
        (Identity("its square is the squared normal force", stable_squared - F_N_squared.subs(gear)),),
    ),
)

model = Model(
    name="rotating_link",
    title="Rotating link with an unbalanced mass, in a plane tilted by phi, with angular acceleration",
    inputs=(v.theta_m, v.omega_m, v.i, v.u, v.alpha_m),
    parameters=(
        v.M,
        v.M_l,
        v.L,
        v.mu,
        v.R,
        v.k_i,
        v.k_e,
        v.g,
        v.phi,
        v.B_lN,
        v.C_lN,
        v.B_lT,
        v.C_lT,
        v.B_m,
        v.C_m,
        v.F_T,
        v.J_m,
        v.J_l,
    ),
    definitions=definitions,
    balances=(balance, electrical),
    equations=equations,
)

if __name__ == "__main__":
    show(model)
