/*
 * Generated: do not edit. Belongs to rotating_link.c (program 09c928c4).
 * Proof driver: for all inputs in the ranges below and the parameters set in main, no function of rotating_link.c
 * has undefined behaviour, overflows, or returns NaN or infinity. Set your parameters in main.
 * Run Frama-C's Eva: the proof is complete with 0 alarms and 100 % of the logical properties proven. The printed
 * intervals contain the results:
 *
 *   frama-c -eva -eva-slevel 30 -eva-split-return full -eva-min-loop-unroll 3 -eva-subdivide-non-linear 20 \
 *     -eva-subdivide-non-linear-function rotating_link_from_top:500 \
 *     -warn-special-float non-finite -kernel-warn-key annot:missing-spec=abort \
 *     -cpp-extra-args="-DECCENTRIC_REAL=float -I.." rotating_link_proof.c
 *
 * and the same with -DECCENTRIC_REAL=double. Add your ranges after -I.. inside the quotes, with a backslash,
 * since Frama-C splits options at commas: -DRANGE_omega_m=-50\,50
 */
#include <float.h>
#include <math.h>
#include <stddef.h>
#include "__fc_builtin.h"

/* Lowest and highest value of the inputs and hidden states. */
#ifndef RANGE_theta_m
#define RANGE_theta_m -10000, 10000 /* motor angle [rad] */
#endif
#ifndef RANGE_omega_m
#define RANGE_omega_m -1000, 1000 /* motor velocity [rad/s] */
#endif
#ifndef RANGE_i
#define RANGE_i -1000, 1000 /* armature current [A] */
#endif
#ifndef RANGE_u
#define RANGE_u -1000, 1000 /* armature voltage [V] */
#endif
#ifndef RANGE_alpha_m
#define RANGE_alpha_m -10000, 10000 /* motor acceleration [rad/s^2] */
#endif
#ifndef RANGE_torque
#define RANGE_torque -10000, 10000 /* torque on the motor side of everything but friction [N m] */
#endif
#ifndef RANGE_dt
#define RANGE_dt -100, 100 /* time step, positive [s] */
#endif

/* Eva's specification of fabs loses the relation between argument and result; that of sqrt loses it for an
 * interval that starts at the smallest number. Written as cases, both keep it. */
static double proof_root(double x) { return (x == 0.0) ? 0.0 : sqrt(x); }
static float proof_rootf(float x) { return (x == 0.0f) ? 0.0f : sqrtf(x); }
static double proof_size(double x) { return (x < 0.0) ? -x : x; }
static float proof_sizef(float x) { return (x < 0.0f) ? -x : x; }
#define sqrt(x) proof_root(x)
#define sqrtf(x) proof_rootf(x)
#define fabs(x) proof_size(x)
#define fabsf(x) proof_sizef(x)

#include "rotating_link.c"

#define SAMPLES 2

static ECCENTRIC_REAL within(double low, double high)
{
#if ECCENTRIC_PRECISION == 1
    return Frama_C_float_interval((float)low, (float)high);
#else
    return Frama_C_double_interval(low, high);
#endif
}

/* Call one function, each time from the same initial state. */
static void called(int function, const rotating_link_coefficients *c)
{
    const ECCENTRIC_REAL theta_m = within(RANGE_theta_m);
    ECCENTRIC_REAL theta_m_n[SAMPLES];
    const ECCENTRIC_REAL omega_m = within(RANGE_omega_m);
    ECCENTRIC_REAL omega_m_n[SAMPLES];
    const ECCENTRIC_REAL i = within(RANGE_i);
    ECCENTRIC_REAL i_n[SAMPLES];
    const ECCENTRIC_REAL u = within(RANGE_u);
    ECCENTRIC_REAL u_n[SAMPLES];
    const ECCENTRIC_REAL alpha_m = within(RANGE_alpha_m);
    ECCENTRIC_REAL alpha_m_n[SAMPLES];
    const ECCENTRIC_REAL torque = within(RANGE_torque);
    ECCENTRIC_REAL torque_n[SAMPLES];
    const ECCENTRIC_REAL dt = within(RANGE_dt);
    ECCENTRIC_REAL dt_n[SAMPLES];
    ECCENTRIC_REAL out[SAMPLES * 6];
    for (int k = 0; k < SAMPLES; ++k) {
        theta_m_n[k] = within(RANGE_theta_m);
        omega_m_n[k] = within(RANGE_omega_m);
        i_n[k] = within(RANGE_i);
        u_n[k] = within(RANGE_u);
        alpha_m_n[k] = within(RANGE_alpha_m);
        torque_n[k] = within(RANGE_torque);
        dt_n[k] = within(RANGE_dt);
    }
    switch (function) {
    case 0:
        out[0] = rotating_link_acceleration(theta_m, omega_m, alpha_m, torque, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_acceleration(out[0]);
        break;
    case 1:
        rotating_link_acceleration_n(SAMPLES, theta_m_n, omega_m_n, alpha_m_n, torque_n, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_acceleration_n(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_acceleration_n(out[1]);
        break;
    case 2:
        rotating_link_breakaway_torque(theta_m, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_breakaway_torque(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_breakaway_torque(out[1]);
        break;
    case 3:
        rotating_link_breakaway_torque_n(SAMPLES, theta_m_n, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_breakaway_torque_n(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_breakaway_torque_n(out[1]);
        //@ assert \is_finite(out[2]);
        Frama_C_show_each_breakaway_torque_n(out[2]);
        //@ assert \is_finite(out[3]);
        Frama_C_show_each_breakaway_torque_n(out[3]);
        break;
    case 4:
        out[0] = rotating_link_current(theta_m, omega_m, alpha_m, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_current(out[0]);
        break;
    case 5:
        rotating_link_current_n(SAMPLES, theta_m_n, omega_m_n, alpha_m_n, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_current_n(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_current_n(out[1]);
        break;
    case 6:
        out[0] = rotating_link_electrical_residual(omega_m, i, u, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_electrical_residual(out[0]);
        break;
    case 7:
        rotating_link_electrical_residual_n(SAMPLES, omega_m_n, i_n, u_n, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_electrical_residual_n(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_electrical_residual_n(out[1]);
        break;
    case 8:
        rotating_link_friction_budget(theta_m, omega_m, alpha_m, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_friction_budget(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_friction_budget(out[1]);
        //@ assert \is_finite(out[2]);
        Frama_C_show_each_friction_budget(out[2]);
        break;
    case 9:
        rotating_link_friction_budget_n(SAMPLES, theta_m_n, omega_m_n, alpha_m_n, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_friction_budget_n(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_friction_budget_n(out[1]);
        //@ assert \is_finite(out[2]);
        Frama_C_show_each_friction_budget_n(out[2]);
        //@ assert \is_finite(out[3]);
        Frama_C_show_each_friction_budget_n(out[3]);
        //@ assert \is_finite(out[4]);
        Frama_C_show_each_friction_budget_n(out[4]);
        //@ assert \is_finite(out[5]);
        Frama_C_show_each_friction_budget_n(out[5]);
        break;
    case 10:
        rotating_link_friction_coefficients(out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_friction_coefficients(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_friction_coefficients(out[1]);
        //@ assert \is_finite(out[2]);
        Frama_C_show_each_friction_coefficients(out[2]);
        //@ assert \is_finite(out[3]);
        Frama_C_show_each_friction_coefficients(out[3]);
        break;
    case 11:
        rotating_link_friction_step(theta_m, omega_m, alpha_m, torque, dt, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_friction_step(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_friction_step(out[1]);
        break;
    case 12:
        rotating_link_friction_step_n(SAMPLES, theta_m_n, omega_m_n, alpha_m_n, torque_n, dt_n, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_friction_step_n(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_friction_step_n(out[1]);
        //@ assert \is_finite(out[2]);
        Frama_C_show_each_friction_step_n(out[2]);
        //@ assert \is_finite(out[3]);
        Frama_C_show_each_friction_step_n(out[3]);
        break;
    case 13:
        out[0] = rotating_link_friction_torque(theta_m, omega_m, alpha_m, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_friction_torque(out[0]);
        break;
    case 14:
        rotating_link_friction_torque_n(SAMPLES, theta_m_n, omega_m_n, alpha_m_n, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_friction_torque_n(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_friction_torque_n(out[1]);
        break;
    case 15:
        rotating_link_friction_torque_gradient(theta_m, omega_m, alpha_m, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_friction_torque_gradient(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_friction_torque_gradient(out[1]);
        //@ assert \is_finite(out[2]);
        Frama_C_show_each_friction_torque_gradient(out[2]);
        break;
    case 16:
        rotating_link_friction_torque_gradient_n(SAMPLES, theta_m_n, omega_m_n, alpha_m_n, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_friction_torque_gradient_n(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_friction_torque_gradient_n(out[1]);
        //@ assert \is_finite(out[2]);
        Frama_C_show_each_friction_torque_gradient_n(out[2]);
        //@ assert \is_finite(out[3]);
        Frama_C_show_each_friction_torque_gradient_n(out[3]);
        //@ assert \is_finite(out[4]);
        Frama_C_show_each_friction_torque_gradient_n(out[4]);
        //@ assert \is_finite(out[5]);
        Frama_C_show_each_friction_torque_gradient_n(out[5]);
        break;
    case 17:
        rotating_link_friction_torque_jacobian(theta_m, omega_m, alpha_m, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_friction_torque_jacobian(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_friction_torque_jacobian(out[1]);
        //@ assert \is_finite(out[2]);
        Frama_C_show_each_friction_torque_jacobian(out[2]);
        //@ assert \is_finite(out[3]);
        Frama_C_show_each_friction_torque_jacobian(out[3]);
        //@ assert \is_finite(out[4]);
        Frama_C_show_each_friction_torque_jacobian(out[4]);
        //@ assert \is_finite(out[5]);
        Frama_C_show_each_friction_torque_jacobian(out[5]);
        break;
    case 18:
        rotating_link_friction_torque_jacobian_n(SAMPLES, theta_m_n, omega_m_n, alpha_m_n, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_friction_torque_jacobian_n(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_friction_torque_jacobian_n(out[1]);
        //@ assert \is_finite(out[2]);
        Frama_C_show_each_friction_torque_jacobian_n(out[2]);
        //@ assert \is_finite(out[3]);
        Frama_C_show_each_friction_torque_jacobian_n(out[3]);
        //@ assert \is_finite(out[4]);
        Frama_C_show_each_friction_torque_jacobian_n(out[4]);
        //@ assert \is_finite(out[5]);
        Frama_C_show_each_friction_torque_jacobian_n(out[5]);
        //@ assert \is_finite(out[6]);
        Frama_C_show_each_friction_torque_jacobian_n(out[6]);
        //@ assert \is_finite(out[7]);
        Frama_C_show_each_friction_torque_jacobian_n(out[7]);
        //@ assert \is_finite(out[8]);
        Frama_C_show_each_friction_torque_jacobian_n(out[8]);
        //@ assert \is_finite(out[9]);
        Frama_C_show_each_friction_torque_jacobian_n(out[9]);
        //@ assert \is_finite(out[10]);
        Frama_C_show_each_friction_torque_jacobian_n(out[10]);
        //@ assert \is_finite(out[11]);
        Frama_C_show_each_friction_torque_jacobian_n(out[11]);
        break;
    case 19:
        rotating_link_friction_torque_with_gradient(theta_m, omega_m, alpha_m, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_friction_torque_with_gradient(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_friction_torque_with_gradient(out[1]);
        //@ assert \is_finite(out[2]);
        Frama_C_show_each_friction_torque_with_gradient(out[2]);
        //@ assert \is_finite(out[3]);
        Frama_C_show_each_friction_torque_with_gradient(out[3]);
        break;
    case 20:
        rotating_link_friction_torque_with_gradient_n(SAMPLES, theta_m_n, omega_m_n, alpha_m_n, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_friction_torque_with_gradient_n(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_friction_torque_with_gradient_n(out[1]);
        //@ assert \is_finite(out[2]);
        Frama_C_show_each_friction_torque_with_gradient_n(out[2]);
        //@ assert \is_finite(out[3]);
        Frama_C_show_each_friction_torque_with_gradient_n(out[3]);
        //@ assert \is_finite(out[4]);
        Frama_C_show_each_friction_torque_with_gradient_n(out[4]);
        //@ assert \is_finite(out[5]);
        Frama_C_show_each_friction_torque_with_gradient_n(out[5]);
        //@ assert \is_finite(out[6]);
        Frama_C_show_each_friction_torque_with_gradient_n(out[6]);
        //@ assert \is_finite(out[7]);
        Frama_C_show_each_friction_torque_with_gradient_n(out[7]);
        break;
    case 21:
        out[0] = rotating_link_gravity_torque(theta_m, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_gravity_torque(out[0]);
        break;
    case 22:
        rotating_link_gravity_torque_n(SAMPLES, theta_m_n, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_gravity_torque_n(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_gravity_torque_n(out[1]);
        break;
    case 23:
        out[0] = rotating_link_mechanical_friction_torque(theta_m, omega_m, alpha_m, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_mechanical_friction_torque(out[0]);
        break;
    case 24:
        rotating_link_mechanical_friction_torque_n(SAMPLES, theta_m_n, omega_m_n, alpha_m_n, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_mechanical_friction_torque_n(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_mechanical_friction_torque_n(out[1]);
        break;
    case 25:
        out[0] = rotating_link_mechanical_residual(theta_m, omega_m, i, alpha_m, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_mechanical_residual(out[0]);
        break;
    case 26:
        rotating_link_mechanical_residual_n(SAMPLES, theta_m_n, omega_m_n, i_n, alpha_m_n, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_mechanical_residual_n(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_mechanical_residual_n(out[1]);
        break;
    case 27:
        out[0] = rotating_link_normal_force(theta_m, omega_m, alpha_m, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_normal_force(out[0]);
        break;
    case 28:
        rotating_link_normal_force_n(SAMPLES, theta_m_n, omega_m_n, alpha_m_n, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_normal_force_n(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_normal_force_n(out[1]);
        break;
    case 29:
        rotating_link_regressor(theta_m, omega_m, alpha_m, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_regressor(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_regressor(out[1]);
        //@ assert \is_finite(out[2]);
        Frama_C_show_each_regressor(out[2]);
        //@ assert \is_finite(out[3]);
        Frama_C_show_each_regressor(out[3]);
        break;
    case 30:
        rotating_link_regressor_n(SAMPLES, theta_m_n, omega_m_n, alpha_m_n, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_regressor_n(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_regressor_n(out[1]);
        //@ assert \is_finite(out[2]);
        Frama_C_show_each_regressor_n(out[2]);
        //@ assert \is_finite(out[3]);
        Frama_C_show_each_regressor_n(out[3]);
        //@ assert \is_finite(out[4]);
        Frama_C_show_each_regressor_n(out[4]);
        //@ assert \is_finite(out[5]);
        Frama_C_show_each_regressor_n(out[5]);
        //@ assert \is_finite(out[6]);
        Frama_C_show_each_regressor_n(out[6]);
        //@ assert \is_finite(out[7]);
        Frama_C_show_each_regressor_n(out[7]);
        break;
    case 31:
        out[0] = rotating_link_voltage(theta_m, omega_m, alpha_m, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_voltage(out[0]);
        break;
    case 32:
        rotating_link_voltage_n(SAMPLES, theta_m_n, omega_m_n, alpha_m_n, out, c);
        //@ assert \is_finite(out[0]);
        Frama_C_show_each_voltage_n(out[0]);
        //@ assert \is_finite(out[1]);
        Frama_C_show_each_voltage_n(out[1]);
        break;
    default: break;
    }
}

int main(void)
{
    rotating_link_parameters p = rotating_link_default_parameters;
    p.J_m = 0.0002;
    p.J_l = 0.04;
    p.phi = 0.6;
    rotating_link_coefficients c;
    if (rotating_link_prepare(&p, &c) != 0) {
        return 1;
    }
    called(Frama_C_interval(0, 32), &c);
    return 0;
}
