/*
 * Generated: do not edit. Written by `make derive` from derivations/rotating_link.py
 * (eccentric 0.2.0b1, program 09c928c4).
 * Rotating link with an unbalanced mass, in a plane tilted by phi, with angular acceleration.
 */
/* Start with rotating_link_mechanical_friction_torque, the friction to compensate, at the reference velocity, or
 * rotating_link_normal_force; `c` is &rotating_link_default, or the output of rotating_link_prepare for your own parameters.
 * rotating_link_prepare returns 0, or the number of the first invalid parameter, such as a negative mass: the coefficients
 * are then all 0, like those of a static variable that has not been prepared, and friction is 0. */
#ifndef ROTATING_LINK_H
#define ROTATING_LINK_H

#include <stddef.h>

/* ROTATING_LINK_PROGRAM identifies the derivation of header and source; the source checks it. */
#define ROTATING_LINK_PROGRAM 0x09c928c4UL

/* The working precision: double, or float with -DECCENTRIC_REAL=float. It is part of all names, as in
 * rotating_link_mechanical_friction_torque_double: code compiled for one cannot use a model compiled only for the other. */
#ifndef ECCENTRIC_REAL
#define ECCENTRIC_REAL double
#endif
#define ECCENTRIC_PRECISION_float 1
#define ECCENTRIC_PRECISION_double 2
#define ECCENTRIC_PRECISION_long 0 * /* turns "long double" into a number, which is refused */
#define ECCENTRIC_JOIN_(a, b) a##b
#define ECCENTRIC_JOIN(a, b) ECCENTRIC_JOIN_(a, b)
#define ECCENTRIC_PRECISION ECCENTRIC_JOIN(ECCENTRIC_PRECISION_, ECCENTRIC_REAL)
#if ECCENTRIC_PRECISION != 1 && ECCENTRIC_PRECISION != 2
#error "ECCENTRIC_REAL must be float or double"
#undef ECCENTRIC_REAL /* one error is enough */
#define ECCENTRIC_REAL double
#endif
#define rotating_link_prepare ECCENTRIC_JOIN(rotating_link_prepare_, ECCENTRIC_REAL)
#define rotating_link_default ECCENTRIC_JOIN(rotating_link_default_, ECCENTRIC_REAL)
#define rotating_link_default_parameters ECCENTRIC_JOIN(rotating_link_default_parameters_, ECCENTRIC_REAL)
#define rotating_link_normal_force ECCENTRIC_JOIN(rotating_link_normal_force_, ECCENTRIC_REAL)
#define rotating_link_normal_force_n ECCENTRIC_JOIN(rotating_link_normal_force_n_, ECCENTRIC_REAL)
#define rotating_link_friction_torque ECCENTRIC_JOIN(rotating_link_friction_torque_, ECCENTRIC_REAL)
#define rotating_link_friction_torque_n ECCENTRIC_JOIN(rotating_link_friction_torque_n_, ECCENTRIC_REAL)
#define rotating_link_mechanical_friction_torque ECCENTRIC_JOIN(rotating_link_mechanical_friction_torque_, ECCENTRIC_REAL)
#define rotating_link_mechanical_friction_torque_n ECCENTRIC_JOIN(rotating_link_mechanical_friction_torque_n_, ECCENTRIC_REAL)
#define rotating_link_friction_torque_gradient ECCENTRIC_JOIN(rotating_link_friction_torque_gradient_, ECCENTRIC_REAL)
#define rotating_link_friction_torque_gradient_n ECCENTRIC_JOIN(rotating_link_friction_torque_gradient_n_, ECCENTRIC_REAL)
#define rotating_link_friction_torque_with_gradient ECCENTRIC_JOIN(rotating_link_friction_torque_with_gradient_, ECCENTRIC_REAL)
#define rotating_link_friction_torque_with_gradient_n ECCENTRIC_JOIN(rotating_link_friction_torque_with_gradient_n_, ECCENTRIC_REAL)
#define rotating_link_friction_torque_jacobian ECCENTRIC_JOIN(rotating_link_friction_torque_jacobian_, ECCENTRIC_REAL)
#define rotating_link_friction_torque_jacobian_n ECCENTRIC_JOIN(rotating_link_friction_torque_jacobian_n_, ECCENTRIC_REAL)
#define rotating_link_regressor ECCENTRIC_JOIN(rotating_link_regressor_, ECCENTRIC_REAL)
#define rotating_link_regressor_n ECCENTRIC_JOIN(rotating_link_regressor_n_, ECCENTRIC_REAL)
#define rotating_link_friction_coefficients ECCENTRIC_JOIN(rotating_link_friction_coefficients_, ECCENTRIC_REAL)
#define rotating_link_breakaway_torque ECCENTRIC_JOIN(rotating_link_breakaway_torque_, ECCENTRIC_REAL)
#define rotating_link_breakaway_torque_n ECCENTRIC_JOIN(rotating_link_breakaway_torque_n_, ECCENTRIC_REAL)
#define rotating_link_friction_budget ECCENTRIC_JOIN(rotating_link_friction_budget_, ECCENTRIC_REAL)
#define rotating_link_friction_budget_n ECCENTRIC_JOIN(rotating_link_friction_budget_n_, ECCENTRIC_REAL)
#define rotating_link_gravity_torque ECCENTRIC_JOIN(rotating_link_gravity_torque_, ECCENTRIC_REAL)
#define rotating_link_gravity_torque_n ECCENTRIC_JOIN(rotating_link_gravity_torque_n_, ECCENTRIC_REAL)
#define rotating_link_voltage ECCENTRIC_JOIN(rotating_link_voltage_, ECCENTRIC_REAL)
#define rotating_link_voltage_n ECCENTRIC_JOIN(rotating_link_voltage_n_, ECCENTRIC_REAL)
#define rotating_link_current ECCENTRIC_JOIN(rotating_link_current_, ECCENTRIC_REAL)
#define rotating_link_current_n ECCENTRIC_JOIN(rotating_link_current_n_, ECCENTRIC_REAL)
#define rotating_link_mechanical_residual ECCENTRIC_JOIN(rotating_link_mechanical_residual_, ECCENTRIC_REAL)
#define rotating_link_mechanical_residual_n ECCENTRIC_JOIN(rotating_link_mechanical_residual_n_, ECCENTRIC_REAL)
#define rotating_link_electrical_residual ECCENTRIC_JOIN(rotating_link_electrical_residual_, ECCENTRIC_REAL)
#define rotating_link_electrical_residual_n ECCENTRIC_JOIN(rotating_link_electrical_residual_n_, ECCENTRIC_REAL)
#define rotating_link_friction_step ECCENTRIC_JOIN(rotating_link_friction_step_, ECCENTRIC_REAL)
#define rotating_link_friction_step_n ECCENTRIC_JOIN(rotating_link_friction_step_n_, ECCENTRIC_REAL)
#define rotating_link_acceleration ECCENTRIC_JOIN(rotating_link_acceleration_, ECCENTRIC_REAL)
#define rotating_link_acceleration_n ECCENTRIC_JOIN(rotating_link_acceleration_n_, ECCENTRIC_REAL)

/* With gcc, and with clang from version 13, the bounds below hold under any flags: the source turns off or refuses every
 * flag that would break them. Other compilers must round to nearest and obey the pragma FP_CONTRACT.
 * Every platform with correctly rounded arithmetic then gives the same bits, and no input causes undefined
 * behaviour. Of clang's flags, -ffp-contract=fast, -freciprocal-math, -fno-signed-zeros and -fapprox-func change bits, and
 * -fno-honor-nans changes the results for NaN.
 * A NaN gives NaN. Finite inputs give NaN only if a sum overflows or a required inertia is not set.
 * An infinity gives NaN, infinity, or a finite value that follows from it.
 * In F_N, a speed above 2^30 rad/s is limited to 2^30 rad/s.
 * An angle too large to resolve its phase gives finite but meaningless values.
 * ECCENTRIC_LIBM uses sine and cosine from libm instead of the polynomials in the source. Errors of the polynomials in
 * float and double, where h is half the link angle and the rounding error is proved by Gappa:
 *   sin(h)/h: method 1.4e-8 and 4.3e-18, rounding 6.2e-8 and 1.2e-16
 *   cos(h): method 4.1e-9 and 1.4e-17, rounding 2.3e-7 and 4.2e-16
 * Bounds of the rounding error in float and double, found by search unless marked "proved", with eps = 2^-23
 * and 2^-52; inputs and parameters count as exact, |theta_m| to 10000 rad, mu to 5:
 *   normal_force within 12 eps (M L (omega_l^2 + |alpha_l|) + weight)
 *   friction_torque, mechanical_friction_torque, friction_torque_jacobian within 12 eps of what they are at that load
 *   friction_torque_gradient within 12 (Table 1: 7) eps of its largest value, any direction of F_N, times that load over F_N
 *     Table 1: with its parameters, mu 1/5 or 1/30
 */
/* MISRA C:2012 by cppcheck: no required rule is violated; deviations from advisory rules:
 *  Rule 2.5: macros of the other working precision are unused.
 *  Rule 12.1: products in a sum have no parentheses, as in formulas.
 *  Rule 20.5: short names are undefined at the end of the source, so that models may share a translation unit.
 *  Rule 20.10: the suffix of constants, and the precision in names, are pasted with ##.
 */

#ifdef __cplusplus
extern "C" {
#endif

/** Value of a parameter without a default until it is set: exact in both precisions, so that no initialiser is NaN. */
#define ECCENTRIC_NOT_GIVEN (-170141183460469231731687303715884105728.0)

/** Parameters, with the paper's letters, in SI units. */
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
    double F_T; /**< transversal force of a level plane [N], eq. (9), by default M_l g: set it along */
    double J_m; /**< inertia of the motor [kg m^2], eq. (1), no default */
    double J_l; /**< inertia of the link about its axis, M L^2 included [kg m^2], eq. (3), no default */
} rotating_link_parameters;

/** Values that depend on parameters only. Call rotating_link_prepare first to compute them: while they are all 0,
 *  as in a static variable, friction is 0. */
typedef struct {
    ECCENTRIC_REAL B_lN; /**< viscous friction of the link per normal force [m s/rad] */
    ECCENTRIC_REAL C_lN; /**< Coulomb friction of the link per normal force [m] */
    ECCENTRIC_REAL k_i; /**< torque constant [N m/A] */
    ECCENTRIC_REAL scale_N; /**< normal force per squared motor velocity, M L mu^2 [N s^2/rad^2] */
    ECCENTRIC_REAL fastest; /**< largest speed in rad/s used in F_N: 2^30, or 0 if M L = 0 [1] */
    ECCENTRIC_REAL half_mu2_omega_star2; /**< mu^2 omega_star^2/2 */
    ECCENTRIC_REAL mu_omega_star2; /**< mu omega_star^2 */
    ECCENTRIC_REAL per_mu; /**< 1/mu */
    ECCENTRIC_REAL fastest2; /**< fastest^2 */
    ECCENTRIC_REAL turns_per_rad; /**< mu/(2 pi) */
    ECCENTRIC_REAL period_1; /**< 2 pi/mu, leading digits */
    ECCENTRIC_REAL period_2; /**< remainder after the previous parts, leading digits */
    ECCENTRIC_REAL period_3; /**< remainder after the previous parts, leading digits (in double: all) */
    ECCENTRIC_REAL half_mu; /**< mu/2 */
    ECCENTRIC_REAL omega_star_1; /**< omega_star, in the working precision */
    ECCENTRIC_REAL omega_star_2; /**< omega_star - omega_star_1, in the working precision */
    ECCENTRIC_REAL B_lN_mu2_scale_N; /**< B_lN mu^2 scale_N */
    ECCENTRIC_REAL B; /**< viscous friction on the motor side, B_m + mu^2 beta_T [N m s/rad] */
    ECCENTRIC_REAL B_plus_k_e_k_i_per_R; /**< B + k_e k_i/R */
    ECCENTRIC_REAL C_lN_mu_scale_N; /**< C_lN mu scale_N */
    ECCENTRIC_REAL C; /**< Coulomb friction on the motor side, C_m + mu gamma_T [N m] */
    ECCENTRIC_REAL quarter_mu3_omega_star2; /**< mu^3 omega_star^2/4 */
    ECCENTRIC_REAL mu2_omega_star2; /**< mu^2 omega_star^2 */
    ECCENTRIC_REAL mu2_scale_N; /**< mu^2 scale_N */
    ECCENTRIC_REAL mu_scale_N; /**< mu scale_N */
    ECCENTRIC_REAL F_T_mu2_sin_phi; /**< F_T mu^2 sin(phi) */
    ECCENTRIC_REAL F_T_mu_sin_phi; /**< F_T mu sin(phi) */
    ECCENTRIC_REAL omega_star2; /**< omega_star^2 */
    ECCENTRIC_REAL L_M_g_p_mu2; /**< L M g_p mu^2 */
    ECCENTRIC_REAL J; /**< inertia on the motor side, J_m + mu^2 J_l [kg m^2] */
    ECCENTRIC_REAL B_lN_R_mu2_scale_N_per_k_i; /**< B_lN R mu^2 scale_N/k_i */
    ECCENTRIC_REAL B_R_per_k_i_plus_k_e; /**< B R/k_i + k_e */
    ECCENTRIC_REAL C_lN_R_mu_scale_N_per_k_i; /**< C_lN R mu scale_N/k_i */
    ECCENTRIC_REAL C_R_per_k_i; /**< C R/k_i */
    ECCENTRIC_REAL R_per_k_i; /**< R/k_i */
    ECCENTRIC_REAL L_M_R_g_p_mu2_per_k_i; /**< L M R g_p mu^2/k_i */
    ECCENTRIC_REAL B_lN_mu2_scale_N_per_k_i; /**< B_lN mu^2 scale_N/k_i */
    ECCENTRIC_REAL B_per_k_i; /**< B/k_i */
    ECCENTRIC_REAL per_k_i; /**< 1/k_i */
    ECCENTRIC_REAL C_lN_mu_scale_N_per_k_i; /**< C_lN mu scale_N/k_i */
    ECCENTRIC_REAL C_per_k_i; /**< C/k_i */
    ECCENTRIC_REAL L_M_g_p_mu2_per_k_i; /**< L M g_p mu^2/k_i */
    ECCENTRIC_REAL k_i_per_R; /**< k_i/R */
    ECCENTRIC_REAL k_e_k_i_per_R; /**< k_e k_i/R */
#if ECCENTRIC_PRECISION == 1
    ECCENTRIC_REAL period_4; /**< remainder after the previous parts, leading digits */
    ECCENTRIC_REAL period_5; /**< remainder after the previous parts, in the working precision */
#endif
} rotating_link_coefficients;

/** Default parameters: Table 1 of the paper with mu = 1/5. */
extern const rotating_link_parameters rotating_link_default_parameters;

/** Coefficients of the default parameters, computed with 50 digits and rounded to the working precision. */
extern const rotating_link_coefficients rotating_link_default;

/** Compute the coefficients of a set of parameters; call it once, and again when a parameter changes.
 *  Valid parameters: mu, R, k_i positive; phi from 0 to pi/2; the others not negative.
 *  @param[in]  p  parameters
 *  @param[out] c  coefficients, all 0 if a parameter is invalid
 *  @return 0, or the number of the first invalid parameter, counted in the order of the structure from 1 (M)
 */
int rotating_link_prepare(const rotating_link_parameters *p, rotating_link_coefficients *c);

/** Normal force F_N on the axis of rotation.
 *  @param[in]  theta_m  motor angle [rad], reduced exactly up to 2^20 half turns of the link (float: 2^14)
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[in]  c  coefficients
 *  @return normal_force [N]
 */
ECCENTRIC_REAL rotating_link_normal_force(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c);

/** normal_force for arrays of n samples. */
void rotating_link_normal_force_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Resultant friction torque F, back-EMF damping included, eq (6).
 *  @param[in]  theta_m  motor angle [rad], reduced exactly up to 2^20 half turns of the link (float: 2^14)
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[in]  c  coefficients
 *  @return friction_torque [N m]
 */
ECCENTRIC_REAL rotating_link_friction_torque(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c);

/** friction_torque for arrays of n samples. */
void rotating_link_friction_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Mechanical friction torque f = f_m + mu f_l, without back-EMF.
 *  @param[in]  theta_m  motor angle [rad], reduced exactly up to 2^20 half turns of the link (float: 2^14)
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[in]  c  coefficients
 *  @return mechanical_friction_torque [N m]
 */
ECCENTRIC_REAL rotating_link_mechanical_friction_torque(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c);

/** mechanical_friction_torque for arrays of n samples. */
void rotating_link_mechanical_friction_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Partial derivatives of friction_torque with respect to its inputs.
 *  @param[in]  theta_m  motor angle [rad], reduced exactly up to 2^20 half turns of the link (float: 2^14)
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[out] out  3 values: theta_m, omega_m, alpha_m [N m per rad, rad/s, rad/s^2]
 *  @param[in]  c  coefficients
 */
void rotating_link_friction_torque_gradient(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** friction_torque_gradient for arrays of n samples, with 3 values of `out` per sample. */
void rotating_link_friction_torque_gradient_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Friction torque and its partial derivatives, for linearisation.
 *  @param[in]  theta_m  motor angle [rad], reduced exactly up to 2^20 half turns of the link (float: 2^14)
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[out] out  4 values: friction_torque, theta_m, omega_m, alpha_m [N m, N m per rad, rad/s, rad/s^2]
 *  @param[in]  c  coefficients
 */
void rotating_link_friction_torque_with_gradient(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** friction_torque_with_gradient for arrays of n samples, with 4 values of `out` per sample. */
void rotating_link_friction_torque_with_gradient_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Partial derivatives of friction_torque with respect to all friction coefficients.
 *  @param[in]  theta_m  motor angle [rad], reduced exactly up to 2^20 half turns of the link (float: 2^14)
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[out] out  6 values: B_lN, C_lN, B_lT, C_lT, B_m, C_m [N m per unit coefficient]
 *  @param[in]  c  coefficients
 */
void rotating_link_friction_torque_jacobian(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** friction_torque_jacobian for arrays of n samples, with 6 values of `out` per sample. */
void rotating_link_friction_torque_jacobian_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Columns: regressor times friction_coefficients is mechanical_friction_torque.
 *  @param[in]  theta_m  motor angle [rad], reduced exactly up to 2^20 half turns of the link (float: 2^14)
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[out] out  4 values: B_lN, C_lN, B, C [N m per unit coefficient]
 *  @param[in]  c  coefficients
 */
void rotating_link_regressor(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** regressor for arrays of n samples, with 4 values of `out` per sample. */
void rotating_link_regressor_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Coefficients of the columns of the regressor.
 *  @param[out] out  4 values: B_lN, C_lN, B, C [m s/rad, m, N m s/rad, N m]
 *  @param[in]  c  coefficients
 */
void rotating_link_friction_coefficients(ECCENTRIC_REAL *out, const rotating_link_coefficients *c);

/** Levels of dry friction at rest: any torque between them holds the drive.
 *  @param[in]  theta_m  motor angle [rad], reduced exactly up to 2^20 half turns of the link (float: 2^14)
 *  @param[out] out  2 values: lower, upper [N m]
 *  @param[in]  c  coefficients
 */
void rotating_link_breakaway_torque(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);
/* The former name: calling it is an error that names this function. */
#define rotating_link_coulomb_torque rotating_link_coulomb_torque_is_now_breakaway_torque

/** breakaway_torque for arrays of n samples, with 2 values of `out` per sample. */
void rotating_link_breakaway_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Levels of dry friction at this state, and the viscous coefficient.
 *  @param[in]  theta_m  motor angle [rad], reduced exactly up to 2^20 half turns of the link (float: 2^14)
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[out] out  3 values: lower, upper, viscous [N m, N m, N m s/rad]
 *  @param[in]  c  coefficients
 */
void rotating_link_friction_budget(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** friction_budget for arrays of n samples, with 3 values of `out` per sample. */
void rotating_link_friction_budget_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Gravity torque G, eq (5).
 *  @param[in]  theta_m  motor angle [rad], reduced exactly up to 2^20 half turns of the link (float: 2^14)
 *  @param[in]  c  coefficients
 *  @return gravity_torque [N m]
 */
ECCENTRIC_REAL rotating_link_gravity_torque(ECCENTRIC_REAL theta_m, const rotating_link_coefficients *c);

/** gravity_torque for arrays of n samples. */
void rotating_link_gravity_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Armature voltage u = (R/k_i) (J alpha_m + G + F), eq (4).
 *  NaN unless alpha_m is 0 or the parameters give J_m and J_l.
 *  @param[in]  theta_m  motor angle [rad], reduced exactly up to 2^20 half turns of the link (float: 2^14)
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[in]  c  coefficients
 *  @return voltage [V]
 */
ECCENTRIC_REAL rotating_link_voltage(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c);

/** voltage for arrays of n samples. */
void rotating_link_voltage_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Armature current i = (J alpha_m + G + f)/k_i.
 *  NaN unless alpha_m is 0 or the parameters give J_m and J_l.
 *  @param[in]  theta_m  motor angle [rad], reduced exactly up to 2^20 half turns of the link (float: 2^14)
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[in]  c  coefficients
 *  @return current [A]
 */
ECCENTRIC_REAL rotating_link_current(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c);

/** current for arrays of n samples. */
void rotating_link_current_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Residual of the mechanical balance: k_i i - J alpha_m - G - f.
 *  NaN unless alpha_m is 0 or the parameters give J_m and J_l.
 *  @param[in]  theta_m  motor angle [rad], reduced exactly up to 2^20 half turns of the link (float: 2^14)
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  i  armature current [A]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[in]  c  coefficients
 *  @return mechanical_residual [N m]
 */
ECCENTRIC_REAL rotating_link_mechanical_residual(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL i,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c);

/** mechanical_residual for arrays of n samples. */
void rotating_link_mechanical_residual_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *i,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Residual of the electrical balance, as a torque: (k_i/R)(u - k_e omega_m) - k_i i.
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  i  armature current [A]
 *  @param[in]  u  armature voltage [V]
 *  @param[in]  c  coefficients
 *  @return electrical_residual [N m]
 */
ECCENTRIC_REAL rotating_link_electrical_residual(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL i,
    ECCENTRIC_REAL u,
    const rotating_link_coefficients *c);

/** electrical_residual for arrays of n samples. */
void rotating_link_electrical_residual_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *i,
    const ECCENTRIC_REAL *u,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Velocity after a time step and the friction torque in it, unchanged if dt is less than 1e-9 s.
 *  NaN unless dt is 0 or the parameters give J_m and J_l.
 *  @param[in]  theta_m  motor angle [rad], reduced exactly up to 2^20 half turns of the link (float: 2^14)
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2], of the step before, 0 at rest
 *  @param[in]  torque  torque on the motor side of everything but friction [N m]
 *  @param[in]  dt  time step, positive [s]
 *  @param[out] out  2 values: omega_m, friction [rad/s, N m]
 *  @param[in]  c  coefficients
 */
void rotating_link_friction_step(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    ECCENTRIC_REAL torque,
    ECCENTRIC_REAL dt,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** friction_step for arrays of n samples, with 2 values of `out` per sample. */
void rotating_link_friction_step_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    const ECCENTRIC_REAL *torque,
    const ECCENTRIC_REAL *dt,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

/** Acceleration by a torque, 0 at rest within the levels of dry friction.
 *  NaN unless torque is 0 or the parameters give J_m and J_l.
 *  @param[in]  theta_m  motor angle [rad], reduced exactly up to 2^20 half turns of the link (float: 2^14)
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2], of the step before, 0 at rest
 *  @param[in]  torque  torque on the motor side of everything but friction [N m]
 *  @param[in]  c  coefficients
 *  @return acceleration [rad/s^2]
 */
ECCENTRIC_REAL rotating_link_acceleration(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    ECCENTRIC_REAL torque,
    const rotating_link_coefficients *c);

/** acceleration for arrays of n samples. */
void rotating_link_acceleration_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    const ECCENTRIC_REAL *torque,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c);

#ifdef __cplusplus
}
#endif

#endif
