/*
 * Generated: do not edit. Written by `make derive` from derivations/rotating_link.py
 * (eccentric 0.1.0, program 3a862dfc).
 * Rotating link with an unbalanced mass, plane tilted by phi, angular acceleration kept.
 */
#ifndef ROTATING_LINK_H
#define ROTATING_LINK_H

#include <stddef.h>

/* ROTATING_LINK_PROGRAM names the derivation that header and source come from; the source checks it. */
#define ROTATING_LINK_PROGRAM 0x3a862dfcUL

/* The working precision: double, or float by -DECCENTRIC_REAL=float. Files of different precision do not link:
 * rotating_link_prepare and rotating_link_default carry it in their names. */
#ifndef ECCENTRIC_REAL
#define ECCENTRIC_REAL double
#endif
#define ECCENTRIC_PRECISION_float 1
#define ECCENTRIC_PRECISION_double 2
#define ECCENTRIC_JOIN_(a, b) a##b
#define ECCENTRIC_JOIN(a, b) ECCENTRIC_JOIN_(a, b)
#define ECCENTRIC_PRECISION ECCENTRIC_JOIN(ECCENTRIC_PRECISION_, ECCENTRIC_REAL)
#if ECCENTRIC_PRECISION != 1 && ECCENTRIC_PRECISION != 2
#error "ECCENTRIC_REAL must be float or double"
#endif
#define rotating_link_prepare ECCENTRIC_JOIN(rotating_link_prepare_, ECCENTRIC_REAL)
#define rotating_link_default ECCENTRIC_JOIN(rotating_link_default_, ECCENTRIC_REAL)

#ifdef __cplusplus
extern "C" {
#endif

/** Rotating link with an unbalanced mass, plane tilted by phi, angular acceleration kept: parameters, in SI units. */
typedef struct {
    double M; /**< unbalanced mass [kg], eq. (5) */
    double M_l; /**< mass of the link without M [kg], eq. (15) */
    double L; /**< distance of M from the axis [m], eq. (5) */
    double mu; /**< gear ratio theta_l/theta_m [1], eq. (3) */
    double R; /**< armature resistance [Ohm], eq. (2) */
    double k_i; /**< torque constant [N m/A], eq. (2) */
    double k_e; /**< back-EMF constant [V s/rad], eq. (2) */
    double g; /**< gravitational acceleration [m/s^2], eq. (5) */
    double phi; /**< tilt of the motion plane: 0 holds gravity (C2), pi/2 is level (C1) [rad] */
    double B_lN; /**< viscous friction of the link per normal force [m s/rad], eq. (9) */
    double C_lN; /**< Coulomb friction of the link per normal force [m], eq. (9) */
    double B_lT; /**< viscous friction of the link per transversal force [m s/rad], eq. (9) */
    double C_lT; /**< Coulomb friction of the link per transversal force [m], eq. (9) */
    double B_m; /**< viscous friction of the motor [N m s/rad], eq. (10) */
    double C_m; /**< Coulomb friction of the motor [N m], eq. (10) */
    double F_T; /**< transversal force of a level plane [N], eq. (9), M_l g for the defaults: set it along with them */
    double J_m; /**< inertia of the motor [kg m^2], eq. (1), no default */
    double J_l; /**< inertia of the link about its axis, M L^2 included [kg m^2], eq. (3), no default */
} rotating_link_parameters;

/** What depends on parameters only; filled by rotating_link_prepare. */
typedef struct {
    ECCENTRIC_REAL B_lN; /**< viscous friction of the link per normal force [m s/rad] */
    ECCENTRIC_REAL C_lN; /**< Coulomb friction of the link per normal force [m] */
    ECCENTRIC_REAL k_i; /**< torque constant [N m/A] */
    ECCENTRIC_REAL mu; /**< gear ratio theta_l/theta_m [1] */
    ECCENTRIC_REAL scale_N; /**< normal force per squared motor velocity, M L mu^2 [N s^2/rad^2] */
    ECCENTRIC_REAL unbalanced; /**< 1 if M L > 0, else 0 [1] */
    ECCENTRIC_REAL twice_omega_star2;
    ECCENTRIC_REAL unbalanced_per_mu;
    ECCENTRIC_REAL minus_twice_omega_star2;
    ECCENTRIC_REAL half_period_1;
    ECCENTRIC_REAL half_period_2;
    ECCENTRIC_REAL half_period_3;
    ECCENTRIC_REAL turns_per_rad;
    ECCENTRIC_REAL half_mu;
    ECCENTRIC_REAL period;
    ECCENTRIC_REAL omega_star_1;
    ECCENTRIC_REAL omega_star_2;
    ECCENTRIC_REAL C_lN_mu;
    ECCENTRIC_REAL C; /**< Coulomb friction on the motor side, C_m + mu gamma_T [N m] */
    ECCENTRIC_REAL B_lN_mu2;
    ECCENTRIC_REAL constant; /**< B_lT F_T mu^2 sin(phi) + B_m + k_e k_i/R */
    ECCENTRIC_REAL B; /**< viscous friction on the motor side, B_m + mu^2 beta_T [N m s/rad] */
    ECCENTRIC_REAL twice_mu_omega_star2;
    ECCENTRIC_REAL mu_omega_star2;
    ECCENTRIC_REAL minus_mu_omega_star2;
    ECCENTRIC_REAL twice_scale_N;
    ECCENTRIC_REAL scale_N_unbalanced_per_mu;
    ECCENTRIC_REAL mu2;
    ECCENTRIC_REAL F_T_mu2_sin_phi;
    ECCENTRIC_REAL F_T_mu_sin_phi;
    ECCENTRIC_REAL minus_omega_star2;
    ECCENTRIC_REAL C_lN_mu_scale_N;
    ECCENTRIC_REAL minus_twice_L_M_g_p_mu;
    ECCENTRIC_REAL J; /**< inertia on the motor side, J_m + mu^2 J_l [kg m^2] */
    ECCENTRIC_REAL R_per_k_i;
    ECCENTRIC_REAL constant_2; /**< -2 L M R g_p mu/k_i */
    ECCENTRIC_REAL C_lN_R_mu_per_k_i;
    ECCENTRIC_REAL constant_3; /**< C_lT F_T R mu sin(phi)/k_i + C_m R/k_i */
    ECCENTRIC_REAL B_lN_R_mu2_per_k_i;
    ECCENTRIC_REAL constant_4; /**< B_lT F_T R mu^2 sin(phi)/k_i + B_m R/k_i + k_e */
    ECCENTRIC_REAL per_k_i;
    ECCENTRIC_REAL minus_twice_L_M_g_p_mu_per_k_i;
    ECCENTRIC_REAL B_lN_mu2_per_k_i;
    ECCENTRIC_REAL constant_5; /**< B_lT F_T mu^2 sin(phi)/k_i + B_m/k_i */
    ECCENTRIC_REAL C_lN_mu_per_k_i;
    ECCENTRIC_REAL constant_6; /**< C_lT F_T mu sin(phi)/k_i + C_m/k_i */
    ECCENTRIC_REAL twice_L_M_g_p_mu;
    ECCENTRIC_REAL minus_B_lN_mu2;
    ECCENTRIC_REAL constant_7; /**< -B_lT F_T mu^2 sin(phi) - B_m */
    ECCENTRIC_REAL minus_C_lN_mu;
    ECCENTRIC_REAL constant_8; /**< -C_lT F_T mu sin(phi) - C_m */
    ECCENTRIC_REAL minus_k_i;
    ECCENTRIC_REAL k_i_per_R;
    ECCENTRIC_REAL minus_k_e_k_i_per_R;
} rotating_link_coefficients;

/** The default parameters: the paper's Table 1 with mu = 1/5, or those of the fit that this was emitted with. */
extern const rotating_link_parameters rotating_link_default_parameters;

/** The coefficients of the default parameters, computed to 50 digits when this file was written. */
extern const rotating_link_coefficients rotating_link_default;

/** Compute the coefficients of a set of parameters; run it once, or when a parameter changes.
 *  Valid parameters: mu, R, k_i positive; phi from 0 to pi/2; the others not negative. Others give coefficients that mean nothing.
 *  @param[in]  p  parameters
 *  @param[out] c  coefficients
 */
void rotating_link_prepare(const rotating_link_parameters *p, rotating_link_coefficients *c);

/** Normal force F_N on the axis of rotation [N].
 *  @param[in]  theta_m  motor angle [rad]
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[in]  c  coefficients
 */
ECCENTRIC_REAL rotating_link_normal_force(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c);

/** normal_force over arrays of n samples. */
void rotating_link_normal_force_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Resultant friction torque F, back-EMF damping included, eq (6) [N m].
 *  @param[in]  theta_m  motor angle [rad]
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[in]  c  coefficients
 */
ECCENTRIC_REAL rotating_link_friction_torque(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c);

/** friction_torque over arrays of n samples. */
void rotating_link_friction_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Mechanical friction torque f = f_m + mu f_l, without back-EMF [N m].
 *  @param[in]  theta_m  motor angle [rad]
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[in]  c  coefficients
 */
ECCENTRIC_REAL rotating_link_mechanical_friction_torque(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c);

/** mechanical_friction_torque over arrays of n samples. */
void rotating_link_mechanical_friction_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Slopes of friction_torque by its inputs [N m per rad, rad/s, rad/s^2].
 *  @param[in]  theta_m  motor angle [rad]
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[out] out  3 values: theta_m, omega_m, alpha_m
 *  @param[in]  c  coefficients
 */
void rotating_link_friction_torque_gradient(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** friction_torque_gradient over arrays of n samples, 3 values of `out` a sample. */
void rotating_link_friction_torque_gradient_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Slopes of friction_torque by all friction coefficients [N m per unit coefficient].
 *  @param[in]  theta_m  motor angle [rad]
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[out] out  6 values: B_lN, C_lN, B_lT, C_lT, B_m, C_m
 *  @param[in]  c  coefficients
 */
void rotating_link_friction_torque_jacobian(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** friction_torque_jacobian over arrays of n samples, 6 values of `out` a sample. */
void rotating_link_friction_torque_jacobian_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Columns with regressor @ friction_coefficients = mechanical_friction_torque [N m per unit coefficient].
 *  @param[in]  theta_m  motor angle [rad]
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[out] out  4 values: B_lN, C_lN, B, C
 *  @param[in]  c  coefficients
 */
void rotating_link_regressor(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** regressor over arrays of n samples, 4 values of `out` a sample. */
void rotating_link_regressor_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** What the columns of the regressor multiply [as the columns of the regressor].
 *  @param[out] out  4 values: B_lN, C_lN, B, C
 *  @param[in]  c  coefficients
 */
void rotating_link_friction_coefficients(ECCENTRIC_REAL *out, const rotating_link_coefficients *c);

/** Size of the friction torque at standstill, where it is set-valued [N m].
 *  @param[in]  theta_m  motor angle [rad]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[in]  c  coefficients
 */
ECCENTRIC_REAL rotating_link_coulomb_torque(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c);

/** coulomb_torque over arrays of n samples. */
void rotating_link_coulomb_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Gravity torque G, eq (5) [N m].
 *  @param[in]  theta_m  motor angle [rad]
 *  @param[in]  c  coefficients
 */
ECCENTRIC_REAL rotating_link_gravity_torque(ECCENTRIC_REAL theta_m, const rotating_link_coefficients *c);

/** gravity_torque over arrays of n samples. */
void rotating_link_gravity_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Armature voltage u = (R/k_i) (J alpha_m + G + F), eq (4) [V].
 *  @param[in]  theta_m  motor angle [rad]
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[in]  c  coefficients
 */
ECCENTRIC_REAL rotating_link_voltage(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c);

/** voltage over arrays of n samples. */
void rotating_link_voltage_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Armature current i = (J alpha_m + G + f)/k_i [A].
 *  @param[in]  theta_m  motor angle [rad]
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[in]  c  coefficients
 */
ECCENTRIC_REAL rotating_link_current(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c);

/** current over arrays of n samples. */
void rotating_link_current_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** What the mechanical balance leaves: k_i i - J alpha_m - G - f [N m].
 *  @param[in]  theta_m  motor angle [rad]
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  i  armature current [A]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[in]  c  coefficients
 */
ECCENTRIC_REAL rotating_link_mechanical_residual(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL i,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c);

/** mechanical_residual over arrays of n samples. */
void rotating_link_mechanical_residual_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *i,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** What the electrical balance leaves, as a torque: (k_i/R)(u - k_e omega_m) - k_i i [N m].
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  i  armature current [A]
 *  @param[in]  u  armature voltage [V]
 *  @param[in]  c  coefficients
 */
ECCENTRIC_REAL rotating_link_electrical_residual(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL i,
    ECCENTRIC_REAL u,
    const rotating_link_coefficients *c);

/** electrical_residual over arrays of n samples. */
void rotating_link_electrical_residual_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *i,
    const ECCENTRIC_REAL *u,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

#ifdef __cplusplus
}
#endif

#endif
