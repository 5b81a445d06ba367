"""Case C1, section 3 of the paper: gravity perpendicular to the motion plane, steady motion, eqs (8)-(13).

Run it to read the derivation: python derivations/c1_perpendicular.py
"""

import sympy as sp

from eccentric.core import show
from eccentric.model import Equation, Identity, law_at_rest, load_model, symbols
from eccentric.model import vocabulary as v
from eccentric.model.limit import limit

omega_m, omega_l, alpha_l, u = symbols(v.omega_m, v.omega_l, v.alpha_l, v.u)
M, M_l, L, g, phi, mu, J = symbols(v.M, v.M_l, v.L, v.g, v.phi, v.mu, v.J)
R, k_i, k_e, B_lN, C_lN, B_lT, C_lT, B_m, C_m, F_T = symbols(
    v.R, v.k_i, v.k_e, v.B_lN, v.C_lN, v.B_lT, v.C_lT, v.B_m, v.C_m, v.F_T
)
f, f_m, f_l, F, F_N, beta_T, gamma_T = symbols(v.f, v.f_m, v.f_l, v.F, v.F_N, v.beta_T, v.gamma_T)

general = load_model("rotating_link")
perpendicular = {phi: sp.pi / 2}
steady = {alpha_l: 0}

# --- The normal force: only the centrifugal force remains in the plane --------------------------------------

F_N_squared = general.equation("normal_force").right.subs(perpendicular).subs(steady)
F_N_link = sp.sqrt(F_N_squared)
F_N_motor = F_N_link.subs(omega_l, mu * omega_m)

# --- The friction torque is a polynomial of the third order -------------------------------------------------

transversal = {F_T * B_lT: beta_T, F_T * C_lT: gamma_T}
motor_friction = general.equation("motor_friction").right
link_friction = sp.expand(general.equation("link_friction").right.subs(perpendicular)).subs(transversal)
friction = sp.expand(motor_friction + mu * link_friction)
# (6) holds in every plane.
torques = {f_m: motor_friction, f_l: link_friction}
resultant = sp.expand(general.equation("resultant").right.subs(torques).subs(F_N, F_N_motor))
resultant = sp.collect(resultant, [omega_m, sp.sign(omega_m)])
sgn = sp.Symbol("sgn")  # a symbol for the sign, so that it does not count as a power of the velocity
signed = sp.expand(resultant).subs(sp.sign(omega_m), sgn)
coefficients = [
    sp.collect(signed.coeff(omega_m, power), sgn).subs(sgn, sp.sign(omega_m)) for power in (3, 2, 1, 0)
]
gravity_torque = general.equation("gravity_torque").right.subs(perpendicular)

# --- Where it becomes linear --------------------------------------------------------------------------------

balanced = resultant.subs(M, 0)
order_in_mu = [sp.degree(c.subs(sp.sign(omega_m), 1), mu) for c in coefficients[:2]]

equations = (
    Equation(
        "normal_force",
        "(8)",
        F_N,
        F_N_link,
        "N",
        "Normal force: of (16) only the centrifugal force remains, gravity acts along the axis.",
    ),
    Equation("normal_force_motor", "(8)", F_N, F_N_motor, "N", "The same on the motor side."),
    Equation(
        "link_friction",
        "(9)",
        f_l,
        sp.expand(link_friction.subs(F_N, F_N_motor)),
        "N m",
        "Friction of the link joint (link side), with beta_T = B_lT F_T and gamma_T = C_lT F_T.",
        (
            Identity(
                "it is what the paper prints",
                link_friction.subs(F_N, F_N_motor)
                - B_lN * M * L * mu**3 * omega_m**3
                - C_lN * M * L * mu**2 * omega_m**2 * sp.sign(omega_m)
                - beta_T * mu * omega_m
                - gamma_T * sp.sign(omega_m),
            ),
            Identity(
                "for a balanced mass (M = 0) only the friction of the transversal force remains",
                link_friction.subs(F_N, F_N_motor).subs(M, 0)
                - beta_T * mu * omega_m
                - gamma_T * sp.sign(omega_m),
            ),
        ),
    ),
    Equation(
        "motor_friction",
        "(10)",
        f_m,
        motor_friction,
        "N m",
        "Friction of the motor bearing.",
        (Identity("it is what the paper prints", motor_friction - B_m * omega_m - C_m * sp.sign(omega_m)),),
    ),
    Equation(
        "friction",
        "(7)",
        f,
        sp.collect(friction, [omega_m, sp.sign(omega_m)]),
        "N m",
        "Mechanical friction on the motor side, f_m + mu f_l of (9) and (10), with F_N from (8).",
    ),
    Equation(
        "resultant",
        "(11)",
        F,
        resultant,
        "N m",
        "Resultant friction torque, back-EMF damping included.",
        (
            Identity(
                "it is f_m + mu f_l of (9) and (10) plus the damping by the back-EMF, as in (6)",
                sp.expand(resultant - friction.subs(F_N, F_N_motor) - k_i * k_e / R * omega_m),
            ),
            Identity(
                "it is odd in the velocity",
                sp.expand(
                    resultant + resultant.subs(omega_m, -omega_m).subs(sp.Abs(-omega_m), sp.Abs(omega_m))
                ),
            ),
            Identity(
                "it is linear for a balanced mass (M = 0)",
                sp.expand(
                    balanced
                    - (mu**2 * beta_T + B_m + k_i * k_e / R) * omega_m
                    - (mu * gamma_T + C_m) * sp.sign(omega_m)
                ),
            ),
            Identity(
                "F_3 and F_2 fall with mu^4 and mu^3: it is linear for mu << 1",
                sp.Integer(abs(order_in_mu[0] - 4) + abs(order_in_mu[1] - 3)),
            ),
        ),
    ),
    Equation(
        "polynomial_high",
        "(12)",
        sp.Matrix(sp.symbols("F_3 F_2")),
        sp.Matrix(coefficients[:2]),
        ("N m s^3/rad^3", "N m s^2/rad^2"),
        "The coefficients of omega_m^3 and omega_m^2.",
    ),
    Equation(
        "polynomial_low",
        "(13)",
        sp.Matrix(sp.symbols("F_1 F_0")),
        sp.Matrix(coefficients[2:]),
        ("N m s/rad", "N m"),
        "The coefficients of omega_m and 1.",
    ),
    *law_at_rest(friction, J),
    Equation("gravity_torque", "(5)", v.G.symbol, gravity_torque, "N m", "There is no gravity torque."),
    Equation(
        "voltage_steady",
        "(4)",
        u,
        sp.expand(R / k_i * resultant),
        "V",
        "Velocity-voltage curve of the steady state, alpha_m = 0 (figure 2).",
    ),
)

model = limit(
    general,
    name="c1_perpendicular",
    title="Case C1: gravity perpendicular to the motion plane, steady motion",
    substitutions=perpendicular,
    definitions={v.F_N: F_N_motor},
    equations=equations,
)

if __name__ == "__main__":
    show(model)
