"""A serial chain of joints: the recursion along it, then a two-link arm written out.

One joint is the rotating link. The recursion is derived once, for any joint: a frame moves in another one,
the carrier, and its position and rotation are differentiated in time (`eccentric.model.chain`). A chain
substitutes its numbers or symbols, joint by joint: outwards the motion, inwards force and moment.
Run it to read the derivation: python derivations/serial_chain.py
"""

import sympy as sp

from eccentric.core import show
from eccentric.model import (
    Body,
    Chain,
    Equation,
    Identity,
    Joint,
    Placement,
    arm,
    law_at_rest,
    quantity,
    recursion,
)
from eccentric.model import vocabulary as v
from eccentric.model.chain import motion

# --- A frame in its carrier: positions, differentiated ------------------------------------------------------

# The carrier has the rotation R(t) and the origin r(t), with R' = R S(w) and r'' = R a, in its components.
w, alpha, a, s, U = motion.w, motion.alpha, motion.a, motion.s, motion.U
S_w, S_alpha = motion.skew(w), motion.skew(alpha)
turning = motion.turning()
point = motion.acceleration()
frame = motion.turned(2)
along = sp.Matrix([0, 0, 1])
cosine, sine, omega_l, alpha_l = motion.cosine, motion.sine, motion.rate_l, motion.acceleration_l

# --- A body: its mass points, summed ------------------------------------------------------------------------

m, h, Sigma = motion.m, motion.h, motion.Sigma
force, moment = motion.force(), motion.moment()
rotor = motion.rotor(2)
tau_m, f_m, mu = v.tau_m.symbol, v.f_m.symbol, v.mu.symbol
J_m, omega_m, alpha_m = motion.J_m, motion.omega_m, motion.alpha_m
inertia = Sigma.trace() * sp.eye(3) - Sigma
at_centre = dict.fromkeys(h, sp.Integer(0)) | dict(zip(U, turning, strict=True))
euler = inertia * alpha + w.cross(inertia * w)

# --- A joint: its bearing loads and transmitted torque ------------------------------------------------------

f, n, p = motion.letters("f"), motion.letters("n"), motion.letters("p")
b, F_N, F_T, M_B, T = sp.symbols("b F_N F_T M_B T", real=True)
handed = n + p.cross(f)
about_centre = n - b * along.cross(f)
B_lN, B_lT, C_lN, C_lT = (q.symbol for q in (v.B_lN, v.B_lT, v.C_lN, v.C_lT))
B_lM, C_lM, B_lG, C_lG = sp.symbols("B_lM C_lM B_lG C_lG", nonnegative=True)
f_l = (B_lN * F_N + B_lT * F_T + B_lM * M_B + B_lG * sp.Abs(T)) * omega_l + (
    C_lN * F_N + C_lT * F_T + C_lM * M_B + C_lG * sp.Abs(T)
) * sp.sign(omega_l)
along_z = alpha[2]
motor_torque = J_m * (alpha_m + along_z) + mu * (T + v.f_l.symbol) + f_m

# --- The arm of two links, in a vertical plane --------------------------------------------------------------

# Each hangs lowest at angle 0: mass M at the distance c from its joint, inertia I about its centre of mass.
g = v.g
letters = [
    quantity("M_0", "kg", "mass of link 0", "", "nonnegative"),
    quantity("M_1", "kg", "mass of link 1", "", "nonnegative"),
    quantity("c_0", "m", "centre of mass of link 0, from its joint", "", "nonnegative"),
    quantity("c_1", "m", "centre of mass of link 1, from its joint", "", "nonnegative"),
    quantity("I_0", "kg m^2", "inertia of link 0 about its centre of mass", "", "nonnegative"),
    quantity("I_1", "kg m^2", "inertia of link 1 about its centre of mass", "", "nonnegative"),
    quantity("l_0", "m", "length of link 0, from joint to joint", "", "nonnegative"),
    quantity("mu_0", "1", "gear ratio of joint 0", "", "positive"),
    quantity("mu_1", "1", "gear ratio of joint 1", "", "positive"),
    quantity("J_m_0", "kg m^2", "inertia of rotor 0", "", "nonnegative"),
    quantity("J_m_1", "kg m^2", "inertia of rotor 1", "", "nonnegative"),
]
M_0, M_1, c_0, c_1, I_0, I_1, l_0, mu_0, mu_1, J_m_0, J_m_1 = (q.symbol for q in letters)
two_links = Chain(
    "serial_chain",
    joints=[Joint(mu=mu_0, J_m=J_m_0), Joint(mu=mu_1, J_m=J_m_1, placement=Placement((0, -l_0, 0)))],
    bodies=[
        Body(M_0, (0, -c_0, 0), [[0, 0, 0], [0, 0, 0], [0, 0, I_0]]),
        Body(M_1, (0, -c_1, 0), [[0, 0, 0], [0, 0, 0], [0, 0, I_1]]),
    ],
    gravity=(0, -g.symbol, 0),
    parameters=(*letters, g),
)
found = recursion(two_links)
theta_0, theta_1, omega_0, omega_1, alpha_0, alpha_1 = sp.symbols(
    "theta_l_0 theta_l_1 omega_l_0 omega_l_1 alpha_l_0 alpha_l_1", real=True
)
alpha_m_0, alpha_m_1 = (inputs.alpha_m.symbol for inputs in found.inputs)
on_link_side = {theta_0, theta_1, omega_0, omega_1, alpha_0, alpha_1}


def written_out(expression: sp.Expr) -> sp.Expr:
    """In angles, velocities and accelerations of the joints."""
    for definition in reversed(found.definitions):
        if definition.symbol not in on_link_side:
            expression = expression.xreplace({definition.symbol: definition.value})
    squares = {sp.sin(x) ** 2: 1 - sp.cos(x) ** 2 for x in (theta_0, theta_1)}
    return sp.collect(sp.expand(sp.expand(expression).subs(squares)), [alpha_0, alpha_1, g.symbol])


outer_force = found.wrenches[1].force.applyfunc(written_out)
inner_force = found.wrenches[0].force.applyfunc(written_out)
torque_0, torque_1 = map(written_out, found.torques)
bend = sp.cos(theta_1)
textbook_1 = (
    (I_1 + M_1 * c_1**2) * (alpha_0 + alpha_1)
    + M_1 * l_0 * c_1 * (bend * alpha_0 + sp.sin(theta_1) * omega_0**2)
    + M_1 * g.symbol * c_1 * sp.sin(theta_0 + theta_1)
)
textbook_0 = (
    (I_0 + M_0 * c_0**2 + M_1 * l_0**2) * alpha_0
    + M_1 * l_0 * c_1 * (bend * (alpha_0 + alpha_1) - sp.sin(theta_1) * (omega_0 + omega_1) ** 2)
    + (M_0 * c_0 + M_1 * l_0) * g.symbol * sp.sin(theta_0)
    + textbook_1
    + J_m_1 * alpha_m_1  # rotor 1, carried by link 0
)
first_alone = {M_1: 0, I_1: 0, J_m_1: 0}

# --- Its mass matrix on the motor side, and friction at rest ------------------------------------------------

on_motor_side = {alpha_0: mu_0 * alpha_m_0, alpha_1: mu_1 * alpha_m_1}
of_motors = [
    sp.expand((written_out(rotor) + ratio * torque).subs(on_motor_side))
    for rotor, ratio, torque in zip(found.rotors, (mu_0, mu_1), (torque_0, torque_1), strict=True)
]
mass_matrix = sp.Matrix(2, 2, lambda j, k: sp.diff(of_motors[j], (alpha_m_0, alpha_m_1)[k]))
# Kinetic energy from the velocities of both centres of mass, plus that of the rotors beyond locked ones.
omega_m_0, omega_m_1 = (inputs.omega_m.symbol for inputs in found.inputs)
turning_0, turning_1 = mu_0 * omega_m_0, mu_0 * omega_m_0 + mu_1 * omega_m_1
energy_doubled = (
    (I_0 + M_0 * c_0**2) * turning_0**2
    + I_1 * turning_1**2
    + M_1
    * (
        (l_0 * turning_0) ** 2
        + (c_1 * turning_1) ** 2
        + 2 * l_0 * c_1 * sp.cos(theta_1) * turning_0 * turning_1
    )
    + J_m_0 * omega_m_0**2
    + J_m_1 * (omega_m_1**2 + 2 * omega_m_1 * turning_0)
)
velocities = sp.Matrix([omega_m_0, omega_m_1])
# The step of n joints, shown for two with any symmetric matrix.
M_00, M_01, M_11, dt = *sp.symbols("M_00 M_01 M_11", real=True), v.dt.symbol
any_matrix = sp.Matrix([[M_00, M_01], [M_01, M_11]])
after, taken = (sp.Matrix(sp.symbols(f"{x}_0 {x}_1", real=True)) for x in ("omega_after", "f"))
without = after + dt * any_matrix.inv() * taken
lost = (without.T * any_matrix * without - after.T * any_matrix * after)[0]
in_step = 2 * dt * taken.dot(after) + dt**2 * (taken.T * any_matrix.inv() * taken)[0]
M_jj = sp.Symbol("M_jj", positive=True)
of_a_joint = f_l.subs(sp.Abs(T), T).subs({omega_l: mu * v.omega_m.symbol})
of_a_joint = (mu * of_a_joint).subs(sp.sign(mu * v.omega_m.symbol), sp.sign(v.omega_m.symbol))
of_a_joint += v.B_m.symbol * v.omega_m.symbol + v.C_m.symbol * sp.sign(v.omega_m.symbol)
M_jk, before_k, after_k = sp.symbols("M_jk omega_m_k omega_after_k", real=True)
momentum_of_joint = M_jj * v.omega_m.symbol + M_jk * (before_k - after_k) + dt * v.torque.symbol


def all_zero(matrix: sp.MatrixBase) -> sp.Expr:
    """An expression that is zero only if every entry is."""
    return sp.Add(*(entry * sp.Symbol(f"entry_{k}") for k, entry in enumerate(matrix)))


equations = (
    Equation(
        "turning",
        "",
        sp.Symbol("U"),
        turning,
        "1/s^2",
        "A carrier turns with R' = R S(w), S(w) v = w x v; all components are its own. Differentiated once"
        " more, with alpha = w': U = R^T R''.",
        (Identity("it is S(alpha) + S(w)^2", all_zero(turning - S_alpha - S_w * S_w)),),
    ),
    Equation(
        "point",
        "",
        sp.Symbol("a_s"),
        point,
        "m/s^2",
        "Acceleration of a point at s(t) in the carrier, R^T (r + R s)'', with r'' = R a. At the base a is"
        " minus the gravity, which so acts on every body.",
        (
            Identity(
                "a point at rest has a + U s, a sliding one 2 w x s' and s'' as well",
                all_zero(sp.expand(point - a - U * s - 2 * w.cross(motion.s_dot) - motion.s_ddot)),
            ),
        ),
    ),
    Equation(
        "velocity",
        "",
        sp.Symbol("w_z"),
        frame.velocity,
        "rad/s",
        "Outwards, a revolute joint: angular velocity of a frame that turns by theta_l about z of its"
        " carrier, in its own components; for x and y alike. That of a sliding frame is the carrier's.",
        (
            Identity(
                "it is that of the carrier, turned back, and omega_l about the axis",
                all_zero(frame.velocity - frame.rotation.T * w - omega_l * along),
            ),
        ),
    ),
    Equation(
        "acceleration",
        "",
        sp.Symbol("alpha_z"),
        frame.acceleration,
        "rad/s^2",
        "Its derivative in time; w is now the frame's own angular velocity.",
        (
            Identity(
                "it is that of the carrier, turned back, alpha_l about the axis, and w x omega_l",
                all_zero(
                    sp.expand(
                        frame.acceleration
                        - frame.rotation.T * alpha
                        - alpha_l * along
                        - omega_l * w.cross(along)
                    )
                ),
            ),
        ),
    ),
    Equation(
        "force",
        "",
        sp.Symbol("f_b"),
        force,
        "N",
        "Newton for a body: the accelerations a + U rho of its mass points, summed over the mass; m is the"
        " mass, h the first moment, m times the centre of mass.",
    ),
    Equation(
        "moment",
        "",
        sp.Symbol("n_b"),
        moment,
        "N m",
        "Euler for a body: the sum of rho x (a + U rho); Sigma is the sum of rho rho^T, and tr(Sigma) - Sigma"
        " the inertia tensor. Force and moment are linear in m, h and Sigma.",
        (
            Identity(
                "about the centre of mass it is I alpha + w x I w",
                all_zero(sp.expand(moment.xreplace(at_centre) - euler)),
            ),
        ),
    ),
    Equation(
        "handed",
        "",
        sp.Symbol("n_p"),
        handed,
        "N m",
        "Inwards: a joint at p in its parent hands on its force f, and its moment n and p x f; the joint of"
        " the parent exerts these and what moves its own body.",
    ),
    Equation(
        "rotor",
        "",
        sp.Symbol("n_r"),
        rotor,
        "N m",
        "A rotor turns by theta_m about z of the parent that carries it, and is symmetrical about it. The"
        " same"
        " sum over its mass points, less that of a locked rotor, which is part of the parent: it is handed on"
        " to the parent. The gyroscopic torque across the axis is taken, not left out: beside the torque"
        " J_m/mu^2 alpha_l of the rotor on its own link it is small by mu only, a fifth for the paper's gear,"
        " and it costs less than a tenth of the recursion. An arm without rotors has none of it.",
        (
            Identity(
                "it is J_m alpha_m along the axis and the gyroscopic torque w x J_m omega_m",
                all_zero(sp.expand(rotor - J_m * alpha_m * along - w.cross(J_m * omega_m * along))),
            ),
            Identity(
                "across the axis it is mu times J_m/mu^2 alpha_l where omega_l w_y is as large as alpha_l",
                rotor[0].subs(omega_m, omega_l / mu).subs(omega_l, alpha_l / w[1])
                - mu * J_m / mu**2 * alpha_l,
            ),
        ),
    ),
    Equation(
        "motor",
        "(1)",
        tau_m,
        motor_torque,
        "N m",
        "Newton for the rotor of a joint: it is accelerated against its parent and with it, by alpha_z of the"
        " parent along the axis. T is the torque that the gear transmits, n_z; of a prismatic joint f_z.",
    ),
    Equation(
        "bearing",
        "",
        sp.Symbol("n_c"),
        about_centre,
        "N m",
        "The bearing of a revolute joint carries F_N = |(f_x, f_y)| and F_T = |f_z|, and M_B = |(n_x, n_y)|"
        " about its centre, at b along the axis. A guide carries F_N and the whole moment.",
    ),
    Equation(
        "friction",
        "(7)",
        v.f_l.symbol,
        f_l,
        "N m",
        "The postulate (7) for every load of a joint: viscous and Coulomb friction by F_N, F_T, M_B and by"
        " what"
        " the gear passes on. What follows no load is the motor's, f_m = B_m omega_m + C_m sgn(omega_m).",
    ),
    Equation(
        "outer_force",
        "",
        sp.Symbol("f_1"),
        outer_force,
        "N",
        "Two links in a vertical plane, 0 where they hang lowest: force on link 1 by its joint, in the frame"
        " of link 1. F_N_1 is its norm.",
        (
            Identity(
                "with joint 0 at rest it is the load of the rotating link, eq (15)",
                all_zero(
                    sp.expand(
                        outer_force.subs({omega_0: 0, alpha_0: 0, theta_0: 0})
                        - M_1
                        * sp.Matrix(
                            [
                                c_1 * alpha_1 + g.symbol * sp.sin(theta_1),
                                c_1 * omega_1**2 + g.symbol * sp.cos(theta_1),
                                0,
                            ]
                        )
                    )
                ),
            ),
        ),
    ),
    Equation(
        "inner_force",
        "",
        sp.Symbol("f_0"),
        inner_force,
        "N",
        "Force on link 0 by its joint, in the frame of link 0; F_N_0 is its norm.",
        (
            Identity(
                "without link 1 it is the load of the rotating link",
                all_zero(
                    sp.expand(
                        inner_force.subs(first_alone)
                        - M_0
                        * sp.Matrix(
                            [
                                c_0 * alpha_0 + g.symbol * sp.sin(theta_0),
                                c_0 * omega_0**2 + g.symbol * sp.cos(theta_0),
                                0,
                            ]
                        )
                    )
                ),
            ),
        ),
    ),
    Equation(
        "outer_torque",
        "(3)",
        sp.Symbol("T_1"),
        torque_1,
        "N m",
        "Torque that gear 1 transmits.",
        (
            Identity(
                "it is that of the textbook, with the inertia about the joint and the angle from the"
                " vertical",
                sp.expand(sp.expand_trig(textbook_1 - torque_1)),
            ),
        ),
    ),
    Equation(
        "inner_torque",
        "(3)",
        sp.Symbol("T_0"),
        torque_0,
        "N m",
        "Torque that gear 0 transmits.",
        (
            Identity("it is that of the textbook", sp.expand(sp.expand_trig(textbook_0 - torque_0))),
            Identity(
                "without link 1 it is that of the rotating link, J_l alpha_l + M g c sin(theta_l)",
                sp.expand(
                    torque_0.subs(first_alone)
                    - (I_0 + M_0 * c_0**2) * alpha_0
                    - M_0 * g.symbol * c_0 * sp.sin(theta_0)
                ),
            ),
        ),
    ),
    *(
        Equation(
            f"rotor_{j}",
            "(1)",
            sp.Symbol(f"tau_r_{j}"),
            written_out(torque),
            "N m",
            f"Torque that accelerates rotor {j}, motor side.",
        )
        for j, torque in enumerate(found.rotors)
    ),
    Equation(
        "mass_matrix",
        "",
        sp.Symbol("M"),
        mass_matrix,
        "kg m^2",
        "The slopes of both motors' torques by their accelerations: the mass matrix on the motor side.",
        (
            Identity("it is symmetric", sp.expand(mass_matrix[0, 1] - mass_matrix[1, 0])),
            Identity(
                "its quadratic form is twice the kinetic energy, rotors beside locked ones",
                sp.expand((velocities.T * mass_matrix * velocities)[0] - energy_doubled),
            ),
        ),
    ),
    *(
        equation
        if equation.name != "momentum"
        else Equation(
            "momentum",
            "",
            v.p.symbol,
            momentum_of_joint,
            "N m s",
            "Over a time step Delta t, M (omega_after - omega_m) = Delta t (T - f) for all joints at"
            " once. The others given, here k for all of them, this is the momentum of joint j, of which"
            " friction takes Delta t f; each joint makes the step below, until none changes.",
            (
                Identity(
                    "friction takes energy: against the step without, 2 Delta t f omega_after and more",
                    sp.simplify(lost - in_step),
                ),
            ),
        )
        for equation in law_at_rest(of_a_joint, M_jj)
    ),
)

model = arm(
    two_links,
    "Serial chain of joints, each with its bearing, drive and friction, and the arm of two links",
    equations,
    found,
)


def with_recursion() -> str:
    """The derivation, and the recursion of the arm in the order in which it is evaluated."""
    lines = [
        f"    {d.symbol!s:<14} = {d.value!s:<72} {d.quantity.meaning} [{d.quantity.unit}]"
        for d in model.definitions
    ]
    head = "The recursion of this arm, as it is evaluated; what is zero or one has folded away:"
    return "\n".join([str(model), "", head, "", *lines])


if __name__ == "__main__":
    show(with_recursion())
