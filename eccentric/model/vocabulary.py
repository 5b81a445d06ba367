"""The vocabulary: every symbol of the paper, its unit and equation number, used by docs, NumPy and C.

Defaults are the paper's Table 1 (gear ratio mu = 1/5), with one interpretation: Table 1 lists
k_e = 0.20 "V s/rev" but computes F_1 with 0.20 V s/rad, so the default is 0.20 V s/rad (`eccentric audit`,
finding 2).
"""

from __future__ import annotations

from eccentric.model.quantity import Quantity, quantity

# Time and motion. Inputs of the emitted functions are on the motor side.
t = quantity("t", "s", "time since the start of the log")
dt = quantity("dt", "s", "time step, positive", "", "positive", letter="Delta t")
temperature = quantity("temperature", "K", "temperature in degC (differences count only)", letter="T")
theta_m = quantity("theta_m", "rad", "motor angle", "(3)")
omega_m = quantity("omega_m", "rad/s", "motor velocity", "(3)")
omega_after = quantity("omega_after", "rad/s", "motor velocity after a time step", letter="omega_m^+")
alpha_m = quantity("alpha_m", "rad/s^2", "motor acceleration", "(1)")
theta_l = quantity("theta_l", "rad", "link angle, 0 where the mass hangs lowest", "(3)")
omega_l = quantity("omega_l", "rad/s", "link velocity", "(3)")
alpha_l = quantity("alpha_l", "rad/s^2", "link acceleration", "(3)")

# The link.
M = quantity("M", "kg", "unbalanced mass", "(5)", "nonnegative", "0.50")
M_l = quantity("M_l", "kg", "mass of the link without M", "(15)", "nonnegative", "0.20")
L = quantity("L", "m", "distance of M from the axis", "(5)", "nonnegative", "0.25")
g = quantity("g", "m/s^2", "gravitational acceleration", "(5)", "nonnegative", "9.81")
phi = quantity(
    "phi", "rad", "tilt of the motion plane: 0 holds gravity (C2), pi/2 is level (C1)", "", "tilt", "0"
)
J_l = quantity("J_l", "kg m^2", "inertia of the link about its axis, M L^2 included", "(3)", "nonnegative")

# The drive.
mu = quantity("mu", "1", "gear ratio theta_l/theta_m", "(3)", "positive", "1/5")
R = quantity("R", "Ohm", "armature resistance", "(2)", "positive", "1.00")
k_i = quantity("k_i", "N m/A", "torque constant", "(2)", "positive", "0.02")
k_e = quantity("k_e", "V s/rad", "back-EMF constant", "(2)", "nonnegative", "0.20")
J_m = quantity("J_m", "kg m^2", "inertia of the motor", "(1)", "nonnegative")
J = quantity("J", "kg m^2", "inertia on the motor side, J_m + mu^2 J_l", "(4)", "nonnegative")

# Friction. Per newton of load, B is the viscous coefficient (N m s/rad per N = m s/rad), C the Coulomb one.
B_lN = quantity(
    "B_lN", "m s/rad", "viscous friction of the link per normal force", "(9)", "nonnegative", "0.0040"
)
C_lN = quantity("C_lN", "m", "Coulomb friction of the link per normal force", "(9)", "nonnegative", "0.0800")
B_lT = quantity(
    "B_lT", "m s/rad", "viscous friction of the link per transversal force", "(9)", "nonnegative", "0.0040"
)
C_lT = quantity(
    "C_lT", "m", "Coulomb friction of the link per transversal force", "(9)", "nonnegative", "0.0800"
)
B_m = quantity("B_m", "N m s/rad", "viscous friction of the motor", "(10)", "nonnegative", "0.0004")
C_m = quantity("C_m", "N m", "Coulomb friction of the motor", "(10)", "nonnegative", "0.0080")
# Table 1 uses the weight of the link alone; the derivation gives the total weight (audit, finding 1).
F_T = quantity("F_T", "N", "transversal force of a level plane", "(9)", "nonnegative", M_l.symbol * g.symbol)
beta_T = quantity(
    "beta_T", "N m s/rad", "viscous friction of the link by the transversal force", "(9)", "nonnegative"
)
gamma_T = quantity(
    "gamma_T", "N m", "Coulomb friction of the link by the transversal force", "(9)", "nonnegative"
)

# Electrical.
u = quantity("u", "V", "armature voltage", "(2)")
i = quantity("i", "A", "armature current", "(2)")

# Torques and forces.
torque = quantity("torque", "N m", "torque on the motor side of everything but friction", "(4)")
tau_m = quantity("tau_m", "N m", "torque of the motor", "(2)")
tau_l = quantity("tau_l", "N m", "torque on the link, link side", "(3)")
f_m = quantity("f_m", "N m", "friction torque of the motor", "(10)")
f_l = quantity("f_l", "N m", "friction torque of the link, link side", "(9)")
f = quantity("f", "N m", "mechanical friction torque f_m + mu f_l, motor side", "(6)")
F = quantity("F", "N m", "resultant friction torque, back-EMF damping included, motor side", "(6)")
G = quantity("G", "N m", "gravity torque, motor side", "(5)")
f_upper = quantity("f_upper", "N m", "level of dry friction forwards, at least 0")
f_lower = quantity("f_lower", "N m", "level of dry friction backwards, at most 0")
b = quantity("b", "N m s/rad", "viscous coefficient at this state", "", "nonnegative")
p = quantity("p", "N m s", "momentum after a time step, if there were no friction")
F_N = quantity("F_N", "N", "normal force on the axis of rotation", "(8)", "nonnegative")

# Quantities derived from the parameters.
g_p = quantity("g_p", "m/s^2", "gravity in the motion plane, g cos(phi)")
weight = quantity(
    "weight", "N", "weight in the motion plane, (M + M_l) g_p", "(22)", "nonnegative", letter="W"
)
critical_squared = quantity(
    "critical_squared",
    "rad^2/s^2",
    "squared link velocity at which M L omega_l^2 equals the weight",
    "(22)",
    "nonnegative",
)
omega_star = quantity(
    "omega_star", "rad/s", "the critical velocity on the motor side", "(22)", "nonnegative", letter="omega^*"
)
scale_N = quantity("scale_N", "N s^2/rad^2", "normal force per squared motor velocity, M L mu^2", "(8)")
fastest = quantity("fastest", "1", "largest speed in rad/s used in F_N: 2^30, or 0 if M L = 0")
speed = quantity("speed", "rad/s", "magnitude of the motor velocity, at most 2^30, 0 if M L = 0")

B = quantity("B", "N m s/rad", "viscous friction on the motor side, B_m + mu^2 beta_T", "(13)", "nonnegative")
C = quantity("C", "N m", "Coulomb friction on the motor side, C_m + mu gamma_T", "(13)", "nonnegative")


def directed(base: Quantity, direction: str) -> Quantity:
    """The coefficient of one direction of motion, eqs (14) and (21): `directed(B_m, "pos")` is B_m_pos."""
    sign = {"pos": ">", "neg": "<"}[direction]
    return quantity(
        f"{base.name}_{direction}",
        base.unit,
        f"{base.meaning}, omega_m {sign} 0",
        base.equation,
        base.domain,
        base.default,
        letter=f"{base.letter or base.name}^{'+' if direction == 'pos' else '-'}",
    )
