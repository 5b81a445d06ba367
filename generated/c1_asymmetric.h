/*
 * Generated: do not edit. Written by `make derive` from derivations/c1_asymmetric.py
 * (eccentric 0.2.0b1, program 2d39efa4).
 * Case C1 with friction that differs between the directions of motion.
 */
/* Start with c1_asymmetric_mechanical_friction_torque, the friction to compensate, at the reference velocity, or
 * c1_asymmetric_normal_force; `c` is &c1_asymmetric_default, or the output of c1_asymmetric_prepare for your own parameters.
 * c1_asymmetric_prepare returns 0, or the number of the first invalid parameter, such as a negative mass: the coefficients
 * are then all 0, like those of a static variable that has not been prepared, and friction is 0. */
#ifndef C1_ASYMMETRIC_H
#define C1_ASYMMETRIC_H

#include <stddef.h>

/* C1_ASYMMETRIC_PROGRAM identifies the derivation of header and source; the source checks it. */
#define C1_ASYMMETRIC_PROGRAM 0x2d39efa4UL

/* The working precision: double, or float with -DECCENTRIC_REAL=float. It is part of all names, as in
 * c1_asymmetric_mechanical_friction_torque_double: code compiled for one cannot use a model compiled only for the other. */
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
#define c1_asymmetric_prepare ECCENTRIC_JOIN(c1_asymmetric_prepare_, ECCENTRIC_REAL)
#define c1_asymmetric_default ECCENTRIC_JOIN(c1_asymmetric_default_, ECCENTRIC_REAL)
#define c1_asymmetric_default_parameters ECCENTRIC_JOIN(c1_asymmetric_default_parameters_, ECCENTRIC_REAL)
#define c1_asymmetric_normal_force ECCENTRIC_JOIN(c1_asymmetric_normal_force_, ECCENTRIC_REAL)
#define c1_asymmetric_normal_force_n ECCENTRIC_JOIN(c1_asymmetric_normal_force_n_, ECCENTRIC_REAL)
#define c1_asymmetric_friction_torque ECCENTRIC_JOIN(c1_asymmetric_friction_torque_, ECCENTRIC_REAL)
#define c1_asymmetric_friction_torque_n ECCENTRIC_JOIN(c1_asymmetric_friction_torque_n_, ECCENTRIC_REAL)
#define c1_asymmetric_mechanical_friction_torque ECCENTRIC_JOIN(c1_asymmetric_mechanical_friction_torque_, ECCENTRIC_REAL)
#define c1_asymmetric_mechanical_friction_torque_n ECCENTRIC_JOIN(c1_asymmetric_mechanical_friction_torque_n_, ECCENTRIC_REAL)
#define c1_asymmetric_friction_torque_gradient ECCENTRIC_JOIN(c1_asymmetric_friction_torque_gradient_, ECCENTRIC_REAL)
#define c1_asymmetric_friction_torque_gradient_n ECCENTRIC_JOIN(c1_asymmetric_friction_torque_gradient_n_, ECCENTRIC_REAL)
#define c1_asymmetric_friction_torque_with_gradient ECCENTRIC_JOIN(c1_asymmetric_friction_torque_with_gradient_, ECCENTRIC_REAL)
#define c1_asymmetric_friction_torque_with_gradient_n ECCENTRIC_JOIN(c1_asymmetric_friction_torque_with_gradient_n_, ECCENTRIC_REAL)
#define c1_asymmetric_friction_torque_jacobian ECCENTRIC_JOIN(c1_asymmetric_friction_torque_jacobian_, ECCENTRIC_REAL)
#define c1_asymmetric_friction_torque_jacobian_n ECCENTRIC_JOIN(c1_asymmetric_friction_torque_jacobian_n_, ECCENTRIC_REAL)
#define c1_asymmetric_regressor ECCENTRIC_JOIN(c1_asymmetric_regressor_, ECCENTRIC_REAL)
#define c1_asymmetric_regressor_n ECCENTRIC_JOIN(c1_asymmetric_regressor_n_, ECCENTRIC_REAL)
#define c1_asymmetric_friction_coefficients ECCENTRIC_JOIN(c1_asymmetric_friction_coefficients_, ECCENTRIC_REAL)
#define c1_asymmetric_breakaway_torque ECCENTRIC_JOIN(c1_asymmetric_breakaway_torque_, ECCENTRIC_REAL)
#define c1_asymmetric_friction_budget ECCENTRIC_JOIN(c1_asymmetric_friction_budget_, ECCENTRIC_REAL)
#define c1_asymmetric_friction_budget_n ECCENTRIC_JOIN(c1_asymmetric_friction_budget_n_, ECCENTRIC_REAL)
#define c1_asymmetric_gravity_torque ECCENTRIC_JOIN(c1_asymmetric_gravity_torque_, ECCENTRIC_REAL)
#define c1_asymmetric_voltage ECCENTRIC_JOIN(c1_asymmetric_voltage_, ECCENTRIC_REAL)
#define c1_asymmetric_voltage_n ECCENTRIC_JOIN(c1_asymmetric_voltage_n_, ECCENTRIC_REAL)
#define c1_asymmetric_current ECCENTRIC_JOIN(c1_asymmetric_current_, ECCENTRIC_REAL)
#define c1_asymmetric_current_n ECCENTRIC_JOIN(c1_asymmetric_current_n_, ECCENTRIC_REAL)
#define c1_asymmetric_mechanical_residual ECCENTRIC_JOIN(c1_asymmetric_mechanical_residual_, ECCENTRIC_REAL)
#define c1_asymmetric_mechanical_residual_n ECCENTRIC_JOIN(c1_asymmetric_mechanical_residual_n_, ECCENTRIC_REAL)
#define c1_asymmetric_electrical_residual ECCENTRIC_JOIN(c1_asymmetric_electrical_residual_, ECCENTRIC_REAL)
#define c1_asymmetric_electrical_residual_n ECCENTRIC_JOIN(c1_asymmetric_electrical_residual_n_, ECCENTRIC_REAL)
#define c1_asymmetric_friction_step ECCENTRIC_JOIN(c1_asymmetric_friction_step_, ECCENTRIC_REAL)
#define c1_asymmetric_friction_step_n ECCENTRIC_JOIN(c1_asymmetric_friction_step_n_, ECCENTRIC_REAL)
#define c1_asymmetric_acceleration ECCENTRIC_JOIN(c1_asymmetric_acceleration_, ECCENTRIC_REAL)
#define c1_asymmetric_acceleration_n ECCENTRIC_JOIN(c1_asymmetric_acceleration_n_, ECCENTRIC_REAL)
#define c1_asymmetric_polynomial ECCENTRIC_JOIN(c1_asymmetric_polynomial_, ECCENTRIC_REAL)
#define c1_asymmetric_polynomial_neg ECCENTRIC_JOIN(c1_asymmetric_polynomial_neg_, ECCENTRIC_REAL)

/* With gcc, and with clang from version 13, the bounds below hold under any flags: the source turns off or refuses every
 * flag that would break them. Other compilers must round to nearest and obey the pragma FP_CONTRACT.
 * Every platform with correctly rounded arithmetic then gives the same bits, and no input causes undefined
 * behaviour. Of clang's flags, -ffp-contract=fast, -freciprocal-math, -fno-signed-zeros and -fapprox-func change bits, and
 * -fno-honor-nans changes the results for NaN.
 * A NaN gives NaN. Finite inputs give NaN only if a sum overflows or a required inertia is not set.
 * An infinity gives NaN, infinity, or a finite value that follows from it.
 * Bounds of the rounding error in float and double, found by search unless marked "proved", with eps = 2^-23
 * and 2^-52; inputs and parameters count as exact:
 *   normal_force within 5 units in the last place (proved for parameters and speeds of 1e-6 to 1e6)
 *   friction_torque, mechanical_friction_torque, friction_torque_jacobian within 6 units in the last place
 *   friction_torque_gradient within 6 units in the last place
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
    double B_lN_pos; /**< viscous friction of the link per normal force, omega_m > 0 [m s/rad], eq. (9) */
    double B_lN_neg; /**< viscous friction of the link per normal force, omega_m < 0 [m s/rad], eq. (9) */
    double C_lN_pos; /**< Coulomb friction of the link per normal force, omega_m > 0 [m], eq. (9) */
    double C_lN_neg; /**< Coulomb friction of the link per normal force, omega_m < 0 [m], eq. (9) */
    double B_lT_pos; /**< viscous friction of the link per transversal force, omega_m > 0 [m s/rad], eq. (9) */
    double B_lT_neg; /**< viscous friction of the link per transversal force, omega_m < 0 [m s/rad], eq. (9) */
    double C_lT_pos; /**< Coulomb friction of the link per transversal force, omega_m > 0 [m], eq. (9) */
    double C_lT_neg; /**< Coulomb friction of the link per transversal force, omega_m < 0 [m], eq. (9) */
    double B_m_pos; /**< viscous friction of the motor, omega_m > 0 [N m s/rad], eq. (10) */
    double B_m_neg; /**< viscous friction of the motor, omega_m < 0 [N m s/rad], eq. (10) */
    double C_m_pos; /**< Coulomb friction of the motor, omega_m > 0 [N m], eq. (10) */
    double C_m_neg; /**< Coulomb friction of the motor, omega_m < 0 [N m], eq. (10) */
    double F_T; /**< transversal force of a level plane [N], eq. (9), by default M_l g: set it along */
    double J_m; /**< inertia of the motor [kg m^2], eq. (1), no default */
    double J_l; /**< inertia of the link about its axis, M L^2 included [kg m^2], eq. (3), no default */
} c1_asymmetric_parameters;

/** Values that depend on parameters only. Call c1_asymmetric_prepare first to compute them: while they are all 0,
 *  as in a static variable, friction is 0. */
typedef struct {
    ECCENTRIC_REAL B_lN_neg; /**< viscous friction of the link per normal force, omega_m < 0 [m s/rad] */
    ECCENTRIC_REAL B_lN_pos; /**< viscous friction of the link per normal force, omega_m > 0 [m s/rad] */
    ECCENTRIC_REAL C_lN_neg; /**< Coulomb friction of the link per normal force, omega_m < 0 [m] */
    ECCENTRIC_REAL C_lN_pos; /**< Coulomb friction of the link per normal force, omega_m > 0 [m] */
    ECCENTRIC_REAL k_e; /**< back-EMF constant [V s/rad] */
    ECCENTRIC_REAL k_i; /**< torque constant [N m/A] */
    ECCENTRIC_REAL mu; /**< gear ratio theta_l/theta_m [1] */
    ECCENTRIC_REAL L_M_mu2; /**< L M mu^2 */
    ECCENTRIC_REAL B_lN_pos_mu2; /**< B_lN_pos mu^2 */
    ECCENTRIC_REAL B_lN_neg_mu2; /**< B_lN_neg mu^2 */
    ECCENTRIC_REAL B_pos; /**< viscous friction on the motor side, B_m + mu^2 beta_T, omega_m > 0 [N m s/rad] */
    ECCENTRIC_REAL B_neg; /**< viscous friction on the motor side, B_m + mu^2 beta_T, omega_m < 0 [N m s/rad] */
    ECCENTRIC_REAL k_e_k_i_per_R; /**< k_e k_i/R */
    ECCENTRIC_REAL C_lN_pos_mu; /**< C_lN_pos mu */
    ECCENTRIC_REAL C_lN_neg_mu; /**< C_lN_neg mu */
    ECCENTRIC_REAL C_pos; /**< Coulomb friction on the motor side, C_m + mu gamma_T, omega_m > 0 [N m] */
    ECCENTRIC_REAL C_neg; /**< Coulomb friction on the motor side, C_m + mu gamma_T, omega_m < 0 [N m] */
    ECCENTRIC_REAL twice_L_M_mu2; /**< 2 L M mu^2 */
    ECCENTRIC_REAL mu2; /**< mu^2 */
    ECCENTRIC_REAL F_T_mu2; /**< F_T mu^2 */
    ECCENTRIC_REAL F_T_mu; /**< F_T mu */
    ECCENTRIC_REAL J; /**< inertia on the motor side, J_m + mu^2 J_l [kg m^2] */
    ECCENTRIC_REAL B_lN_pos_R_mu2_per_k_i; /**< B_lN_pos R mu^2/k_i */
    ECCENTRIC_REAL B_lN_neg_R_mu2_per_k_i; /**< B_lN_neg R mu^2/k_i */
    ECCENTRIC_REAL B_pos_R_per_k_i; /**< B_pos R/k_i */
    ECCENTRIC_REAL B_neg_R_per_k_i; /**< B_neg R/k_i */
    ECCENTRIC_REAL C_lN_pos_R_mu_per_k_i; /**< C_lN_pos R mu/k_i */
    ECCENTRIC_REAL C_lN_neg_R_mu_per_k_i; /**< C_lN_neg R mu/k_i */
    ECCENTRIC_REAL C_pos_R_per_k_i; /**< C_pos R/k_i */
    ECCENTRIC_REAL C_neg_R_per_k_i; /**< C_neg R/k_i */
    ECCENTRIC_REAL R_per_k_i; /**< R/k_i */
    ECCENTRIC_REAL B_lN_pos_mu2_per_k_i; /**< B_lN_pos mu^2/k_i */
    ECCENTRIC_REAL B_lN_neg_mu2_per_k_i; /**< B_lN_neg mu^2/k_i */
    ECCENTRIC_REAL B_pos_per_k_i; /**< B_pos/k_i */
    ECCENTRIC_REAL B_neg_per_k_i; /**< B_neg/k_i */
    ECCENTRIC_REAL per_k_i; /**< 1/k_i */
    ECCENTRIC_REAL C_lN_pos_mu_per_k_i; /**< C_lN_pos mu/k_i */
    ECCENTRIC_REAL C_lN_neg_mu_per_k_i; /**< C_lN_neg mu/k_i */
    ECCENTRIC_REAL C_pos_per_k_i; /**< C_pos/k_i */
    ECCENTRIC_REAL C_neg_per_k_i; /**< C_neg/k_i */
    ECCENTRIC_REAL k_i_per_R; /**< k_i/R */
    ECCENTRIC_REAL B_lN_pos_L_M_mu4; /**< B_lN_pos L M mu^4 */
    ECCENTRIC_REAL C_lN_pos_L_M_mu3; /**< C_lN_pos L M mu^3 */
    ECCENTRIC_REAL B_pos_plus_k_e_k_i_per_R; /**< B_pos + k_e k_i/R */
    ECCENTRIC_REAL B_lN_neg_L_M_mu4; /**< B_lN_neg L M mu^4 */
    ECCENTRIC_REAL C_lN_neg_L_M_mu3; /**< C_lN_neg L M mu^3 */
    ECCENTRIC_REAL B_neg_plus_k_e_k_i_per_R; /**< B_neg + k_e k_i/R */
} c1_asymmetric_coefficients;

/** Default parameters: Table 1 of the paper with mu = 1/5. */
extern const c1_asymmetric_parameters c1_asymmetric_default_parameters;

/** Coefficients of the default parameters, computed with 50 digits and rounded to the working precision. */
extern const c1_asymmetric_coefficients c1_asymmetric_default;

/** Compute the coefficients of a set of parameters; call it once, and again when a parameter changes.
 *  Valid parameters: mu, R, k_i positive; the others not negative.
 *  @param[in]  p  parameters
 *  @param[out] c  coefficients, all 0 if a parameter is invalid
 *  @return 0, or the number of the first invalid parameter, counted in the order of the structure from 1 (M)
 */
int c1_asymmetric_prepare(const c1_asymmetric_parameters *p, c1_asymmetric_coefficients *c);

/** Normal force F_N on the axis of rotation.
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  c  coefficients
 *  @return normal_force [N]
 */
ECCENTRIC_REAL c1_asymmetric_normal_force(ECCENTRIC_REAL omega_m, const c1_asymmetric_coefficients *c);

/** normal_force for arrays of n samples. */
void c1_asymmetric_normal_force_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** Resultant friction torque F, back-EMF damping included, eq (6).
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  c  coefficients
 *  @return friction_torque [N m]
 */
ECCENTRIC_REAL c1_asymmetric_friction_torque(ECCENTRIC_REAL omega_m, const c1_asymmetric_coefficients *c);

/** friction_torque for arrays of n samples. */
void c1_asymmetric_friction_torque_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** Mechanical friction torque f = f_m + mu f_l, without back-EMF.
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  c  coefficients
 *  @return mechanical_friction_torque [N m]
 */
ECCENTRIC_REAL c1_asymmetric_mechanical_friction_torque(
    ECCENTRIC_REAL omega_m,
    const c1_asymmetric_coefficients *c);

/** mechanical_friction_torque for arrays of n samples. */
void c1_asymmetric_mechanical_friction_torque_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** Partial derivatives of friction_torque with respect to its inputs.
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[out] out  1 value: omega_m [N m per rad/s]
 *  @param[in]  c  coefficients
 */
void c1_asymmetric_friction_torque_gradient(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** friction_torque_gradient for arrays of n samples, with 1 values of `out` per sample. */
void c1_asymmetric_friction_torque_gradient_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** Friction torque and its partial derivatives, for linearisation.
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[out] out  2 values: friction_torque, omega_m [N m, N m per rad/s]
 *  @param[in]  c  coefficients
 */
void c1_asymmetric_friction_torque_with_gradient(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** friction_torque_with_gradient for arrays of n samples, with 2 values of `out` per sample. */
void c1_asymmetric_friction_torque_with_gradient_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** Partial derivatives of friction_torque with respect to all friction coefficients.
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[out] out  12 values: B_lN_pos, B_lN_neg, C_lN_pos, C_lN_neg, B_lT_pos, B_lT_neg, C_lT_pos,
 *      C_lT_neg, B_m_pos, B_m_neg, C_m_pos, C_m_neg [N m per unit coefficient]
 *  @param[in]  c  coefficients
 */
void c1_asymmetric_friction_torque_jacobian(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** friction_torque_jacobian for arrays of n samples, with 12 values of `out` per sample. */
void c1_asymmetric_friction_torque_jacobian_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** Columns: regressor times friction_coefficients is mechanical_friction_torque.
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[out] out  8 values: B_lN_pos, B_lN_neg, C_lN_pos, C_lN_neg, B_pos, B_neg, C_pos, C_neg [N m per
 *      unit coefficient]
 *  @param[in]  c  coefficients
 */
void c1_asymmetric_regressor(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** regressor for arrays of n samples, with 8 values of `out` per sample. */
void c1_asymmetric_regressor_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** Coefficients of the columns of the regressor.
 *  @param[out] out  8 values: B_lN_pos, B_lN_neg, C_lN_pos, C_lN_neg, B_pos, B_neg, C_pos, C_neg [m s/rad, m
 *      s/rad, m, m, N m s/rad, N m s/rad, N m, N m]
 *  @param[in]  c  coefficients
 */
void c1_asymmetric_friction_coefficients(ECCENTRIC_REAL *out, const c1_asymmetric_coefficients *c);

/** Levels of dry friction at rest: any torque between them holds the drive.
 *  @param[out] out  2 values: lower, upper [N m]
 *  @param[in]  c  coefficients
 */
void c1_asymmetric_breakaway_torque(ECCENTRIC_REAL *out, const c1_asymmetric_coefficients *c);
/* The former name: calling it is an error that names this function. */
#define c1_asymmetric_coulomb_torque c1_asymmetric_coulomb_torque_is_now_breakaway_torque

/** Levels of dry friction at this state, and the viscous coefficient.
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[out] out  3 values: lower, upper, viscous [N m, N m, N m s/rad]
 *  @param[in]  c  coefficients
 */
void c1_asymmetric_friction_budget(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** friction_budget for arrays of n samples, with 3 values of `out` per sample. */
void c1_asymmetric_friction_budget_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** Gravity torque G, eq (5).
 *  @param[in]  c  coefficients
 *  @return gravity_torque [N m]
 */
ECCENTRIC_REAL c1_asymmetric_gravity_torque(const c1_asymmetric_coefficients *c);

/** Armature voltage u = (R/k_i) (J alpha_m + G + F), eq (4).
 *  NaN unless alpha_m is 0 or the parameters give J_m and J_l.
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[in]  c  coefficients
 *  @return voltage [V]
 */
ECCENTRIC_REAL c1_asymmetric_voltage(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const c1_asymmetric_coefficients *c);

/** voltage for arrays of n samples. */
void c1_asymmetric_voltage_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** Armature current i = (J alpha_m + G + f)/k_i.
 *  NaN unless alpha_m is 0 or the parameters give J_m and J_l.
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[in]  c  coefficients
 *  @return current [A]
 */
ECCENTRIC_REAL c1_asymmetric_current(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const c1_asymmetric_coefficients *c);

/** current for arrays of n samples. */
void c1_asymmetric_current_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** Residual of the mechanical balance: k_i i - J alpha_m - G - f.
 *  NaN unless alpha_m is 0 or the parameters give J_m and J_l.
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  i  armature current [A]
 *  @param[in]  alpha_m  motor acceleration [rad/s^2]
 *  @param[in]  c  coefficients
 *  @return mechanical_residual [N m]
 */
ECCENTRIC_REAL c1_asymmetric_mechanical_residual(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL i,
    ECCENTRIC_REAL alpha_m,
    const c1_asymmetric_coefficients *c);

/** mechanical_residual for arrays of n samples. */
void c1_asymmetric_mechanical_residual_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *i,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** Residual of the electrical balance, as a torque: (k_i/R)(u - k_e omega_m) - k_i i.
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  i  armature current [A]
 *  @param[in]  u  armature voltage [V]
 *  @param[in]  c  coefficients
 *  @return electrical_residual [N m]
 */
ECCENTRIC_REAL c1_asymmetric_electrical_residual(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL i,
    ECCENTRIC_REAL u,
    const c1_asymmetric_coefficients *c);

/** electrical_residual for arrays of n samples. */
void c1_asymmetric_electrical_residual_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *i,
    const ECCENTRIC_REAL *u,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** Velocity after a time step and the friction torque in it, unchanged if dt is less than 1e-9 s.
 *  NaN unless dt is 0 or the parameters give J_m and J_l.
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  torque  torque on the motor side of everything but friction [N m]
 *  @param[in]  dt  time step, positive [s]
 *  @param[out] out  2 values: omega_m, friction [rad/s, N m]
 *  @param[in]  c  coefficients
 */
void c1_asymmetric_friction_step(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL torque,
    ECCENTRIC_REAL dt,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** friction_step for arrays of n samples, with 2 values of `out` per sample. */
void c1_asymmetric_friction_step_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *torque,
    const ECCENTRIC_REAL *dt,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** Acceleration by a torque, 0 at rest within the levels of dry friction.
 *  NaN unless torque is 0 or the parameters give J_m and J_l.
 *  @param[in]  omega_m  motor velocity [rad/s]
 *  @param[in]  torque  torque on the motor side of everything but friction [N m]
 *  @param[in]  c  coefficients
 *  @return acceleration [rad/s^2]
 */
ECCENTRIC_REAL c1_asymmetric_acceleration(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL torque,
    const c1_asymmetric_coefficients *c);

/** acceleration for arrays of n samples. */
void c1_asymmetric_acceleration_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *torque,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c);

/** Coefficients F_3, F_2, F_1, F_0 of F for omega_m > 0, eqs (11)-(14).
 *  @param[out] out  4 values: F_3, F_2, F_1, F_0 [N m s^3/rad^3, N m s^2/rad^2, N m s/rad, N m]
 *  @param[in]  c  coefficients
 */
void c1_asymmetric_polynomial(ECCENTRIC_REAL *out, const c1_asymmetric_coefficients *c);

/** Coefficients F_3, F_2, F_1, F_0 of F for omega_m < 0, eqs (11)-(14).
 *  @param[out] out  4 values: F_3, F_2, F_1, F_0 [N m s^3/rad^3, N m s^2/rad^2, N m s/rad, N m]
 *  @param[in]  c  coefficients
 */
void c1_asymmetric_polynomial_neg(ECCENTRIC_REAL *out, const c1_asymmetric_coefficients *c);

#ifdef __cplusplus
}
#endif

#endif
