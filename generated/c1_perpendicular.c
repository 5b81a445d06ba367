/*
 * Generated: do not edit. Written by `make derive` from derivations/c1_perpendicular.py
 * (eccentric 0.2.0b1, program b6caacd1).
 * Case C1: gravity perpendicular to the motion plane, steady motion.
 */
#include "c1_perpendicular.h"

#if !defined(__cplusplus) && (!defined(__STDC_VERSION__) || (__STDC_VERSION__ < 199901L))
#error "C99 or later is required: compile with -std=c99"
#else /* up to the end of the file, so that this is the only error */

#include <float.h>
#include <math.h>

#if C1_PERPENDICULAR_PROGRAM != 0xb6caacd1UL
#error "c1_perpendicular.c and c1_perpendicular.h are of different derivations: write both again"
#endif

/* Under any flags, gcc and clang do not re-associate the code below, gcc does not contract a * b + c, and
 * flags that would still break the bounds are refused. Other compilers obey the standard pragma. */
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || \
    (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "-ffast-math, -Ofast and -funsafe-math-optimizations spoil prepare and drop NaN: leave them out"
#endif
#if defined(FLT_EVAL_METHOD) && ((FLT_EVAL_METHOD < 0) || (FLT_EVAL_METHOD == 1) || (FLT_EVAL_METHOD == 2))
#error "operations must round to their own type: on x86, compile with -msse2 -mfpmath=sse"
#endif
#if defined(FLT_MANT_DIG) && defined(DBL_MANT_DIG)
#if (FLT_MANT_DIG != 24) || (DBL_MANT_DIG != 53)
#error "float and double must be the 32 and 64 bits of IEEE 754: prepare splits parameters in double"
#endif
#endif
#if defined(__clang__)
#if __clang_major__ >= 13 /* clang 12 knows the pragma as well, but Apple's does not */
#pragma clang fp reassociate(off) contract(off)
#else
#pragma STDC FP_CONTRACT OFF
#endif
#elif defined(__GNUC__)
#pragma GCC push_options
#pragma GCC optimize("no-unsafe-math-optimizations", "no-associative-math", "no-reciprocal-math")
#pragma GCC optimize("fp-contract=off", "signed-zeros")
/* With fused multiply-add, gcc's straight-line vectorizer still contracts a b + c next to d e - f. */
#pragma GCC optimize("no-tree-slp-vectorize")
#if defined(__riscv_vector)
#pragma GCC optimize("no-tree-vectorize") /* and so does its loop vectorizer here */
#endif
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunknown-pragmas"
#pragma STDC FP_CONTRACT OFF /* gcc has no such pragma, but others that define __GNUC__ */
#pragma GCC diagnostic pop
#else
#pragma STDC FP_CONTRACT OFF
#endif
/* An error with -fsingle-precision-constant: constants without suffix must be double. Never defined. */
extern const char c1_perpendicular_double_constants[(sizeof(1.0) == sizeof(double)) ? 1 : -1];

/* Short names for this file only, undefined at its end: several models may share a translation unit. */
#define real ECCENTRIC_REAL
#if defined(__GNUC__)
#define REAL_INLINE static inline __attribute__((always_inline))
#else
#define REAL_INLINE static inline
#endif
#if ECCENTRIC_PRECISION == 1
#define REAL(x) x##f
#define REAL_GIVEN(x) (((x) == (real)ECCENTRIC_NOT_GIVEN) ? (real)NAN : (x))
#else
#define REAL(x) x
#define REAL_GIVEN(x) (((x) == (real)ECCENTRIC_NOT_GIVEN) ? (real)NAN : (x))
#endif

REAL_INLINE real c1_perpendicular_sgn(const real x)
{
    return (x > REAL(0.0)) ? REAL(1.0) : ((x < REAL(0.0)) ? REAL(-1.0) : (x + REAL(0.0)));
}

REAL_INLINE real c1_perpendicular_within(const real x, const real most)
{
    const real below = (x > most) ? most : x;
    return (below < -most) ? -most : below;
}

const c1_perpendicular_parameters c1_perpendicular_default_parameters = {
    .M = 0.5, /* [kg] */
    .M_l = 0.2, /* [kg] */
    .L = 0.25, /* [m] */
    .mu = 0.2, /* [1] */
    .R = 1.0, /* [Ohm] */
    .k_i = 0.02, /* [N m/A] */
    .k_e = 0.2, /* [V s/rad] */
    .g = 9.81, /* [m/s^2] */
    .B_lN = 0.004, /* [m s/rad] */
    .C_lN = 0.08, /* [m] */
    .B_lT = 0.004, /* [m s/rad] */
    .C_lT = 0.08, /* [m] */
    .B_m = 4.0e-4, /* [N m s/rad] */
    .C_m = 0.008, /* [N m] */
    .F_T = 1.962, /* [N] */
    .J_m = ECCENTRIC_NOT_GIVEN, /* [kg m^2] */
    .J_l = ECCENTRIC_NOT_GIVEN, /* [kg m^2] */
};

const c1_perpendicular_coefficients c1_perpendicular_default = {
#if ECCENTRIC_PRECISION == 1
    .B_lN = (real)(0.004),
    .C_lN = (real)(0.08),
    .k_i = (real)(0.02),
    .mu = (real)(0.2),
    .L_M_mu2 = (real)(0.005),
    .B_lN_mu2 = (real)(1.6e-4),
    .B = (real)(7.1392e-4),
    .B_plus_k_e_k_i_per_R = (real)(0.00471392),
    .C_lN_mu = (real)(0.016),
    .C = (real)(0.039392),
    .twice_L_M_mu2 = (real)(0.01),
    .mu2 = (real)(0.04),
    .F_T_mu2 = (real)(0.07848),
    .F_T_mu = (real)(0.3924),
    .J = (real)(ECCENTRIC_NOT_GIVEN),
    .B_lN_R_mu2_per_k_i = (real)(0.008),
    .B_R_per_k_i_plus_k_e = (real)(0.235696),
    .C_lN_R_mu_per_k_i = (real)(0.8),
    .C_R_per_k_i = (real)(1.9696),
    .R_per_k_i = (real)(50.0),
    .B_lN_mu2_per_k_i = (real)(0.008),
    .B_per_k_i = (real)(0.035696),
    .per_k_i = (real)(50.0),
    .C_lN_mu_per_k_i = (real)(0.8),
    .C_per_k_i = (real)(1.9696),
    .k_i_per_R = (real)(0.02),
    .k_e_k_i_per_R = (real)(0.004),
    .B_lN_L_M_mu4 = (real)(8.0e-7),
    .C_lN_L_M_mu3 = (real)(8.0e-5),
#else
    .B_lN = 0.004,
    .C_lN = 0.08,
    .k_i = 0.02,
    .mu = 0.2,
    .L_M_mu2 = 0.005,
    .B_lN_mu2 = 1.6e-4,
    .B = 7.1392e-4,
    .B_plus_k_e_k_i_per_R = 0.00471392,
    .C_lN_mu = 0.016,
    .C = 0.039392,
    .twice_L_M_mu2 = 0.01,
    .mu2 = 0.04,
    .F_T_mu2 = 0.07848,
    .F_T_mu = 0.3924,
    .J = ECCENTRIC_NOT_GIVEN,
    .B_lN_R_mu2_per_k_i = 0.008,
    .B_R_per_k_i_plus_k_e = 0.235696,
    .C_lN_R_mu_per_k_i = 0.8,
    .C_R_per_k_i = 1.9696,
    .R_per_k_i = 50.0,
    .B_lN_mu2_per_k_i = 0.008,
    .B_per_k_i = 0.035696,
    .per_k_i = 50.0,
    .C_lN_mu_per_k_i = 0.8,
    .C_per_k_i = 1.9696,
    .k_i_per_R = 0.02,
    .k_e_k_i_per_R = 0.004,
    .B_lN_L_M_mu4 = 8.0e-7,
    .C_lN_L_M_mu3 = 8.0e-5,
#endif
};

int c1_perpendicular_prepare(const c1_perpendicular_parameters *p, c1_perpendicular_coefficients *c)
{
    const double L_M_mu2 = p->L * p->M * p->mu * p->mu;
    const double B_lN_mu2 = p->B_lN * p->mu * p->mu;
    const double B = p->B_lT * p->F_T * p->mu * p->mu + p->B_m;
    const double B_plus_k_e_k_i_per_R = B + p->k_e * p->k_i / p->R;
    const double C_lN_mu = p->C_lN * p->mu;
    const double C = p->C_lT * p->F_T * p->mu + p->C_m;
    const double twice_L_M_mu2 = 2.0 * p->L * p->M * p->mu * p->mu;
    const double mu2 = p->mu * p->mu;
    const double F_T_mu2 = p->F_T * p->mu * p->mu;
    const double F_T_mu = p->F_T * p->mu;
    const double J = ((p->J_l == ECCENTRIC_NOT_GIVEN) || (p->J_m == ECCENTRIC_NOT_GIVEN)) ?
        ECCENTRIC_NOT_GIVEN : (p->J_l * p->mu * p->mu + p->J_m);
    const double B_lN_R_mu2_per_k_i = p->B_lN * p->R * p->mu * p->mu / p->k_i;
    const double B_R_per_k_i_plus_k_e = B * p->R / p->k_i + p->k_e;
    const double C_lN_R_mu_per_k_i = p->C_lN * p->R * p->mu / p->k_i;
    const double C_R_per_k_i = C * p->R / p->k_i;
    const double R_per_k_i = p->R / p->k_i;
    const double B_lN_mu2_per_k_i = p->B_lN * p->mu * p->mu / p->k_i;
    const double B_per_k_i = B / p->k_i;
    const double per_k_i = 1.0 / p->k_i;
    const double C_lN_mu_per_k_i = p->C_lN * p->mu / p->k_i;
    const double C_per_k_i = C / p->k_i;
    const double k_i_per_R = p->k_i / p->R;
    const double k_e_k_i_per_R = p->k_e * p->k_i / p->R;
    const double B_lN_L_M_mu4 = p->B_lN * p->L * p->M * p->mu * p->mu * p->mu * p->mu;
    const double C_lN_L_M_mu3 = p->C_lN * p->L * p->M * p->mu * p->mu * p->mu;
    c->B_lN = (real)(p->B_lN);
    c->C_lN = (real)(p->C_lN);
    c->k_i = (real)(p->k_i);
    c->mu = (real)(p->mu);
    c->L_M_mu2 = (real)(L_M_mu2);
    c->B_lN_mu2 = (real)(B_lN_mu2);
    c->B = (real)(B);
    c->B_plus_k_e_k_i_per_R = (real)(B_plus_k_e_k_i_per_R);
    c->C_lN_mu = (real)(C_lN_mu);
    c->C = (real)(C);
    c->twice_L_M_mu2 = (real)(twice_L_M_mu2);
    c->mu2 = (real)(mu2);
    c->F_T_mu2 = (real)(F_T_mu2);
    c->F_T_mu = (real)(F_T_mu);
    c->J = (real)(J);
    c->B_lN_R_mu2_per_k_i = (real)(B_lN_R_mu2_per_k_i);
    c->B_R_per_k_i_plus_k_e = (real)(B_R_per_k_i_plus_k_e);
    c->C_lN_R_mu_per_k_i = (real)(C_lN_R_mu_per_k_i);
    c->C_R_per_k_i = (real)(C_R_per_k_i);
    c->R_per_k_i = (real)(R_per_k_i);
    c->B_lN_mu2_per_k_i = (real)(B_lN_mu2_per_k_i);
    c->B_per_k_i = (real)(B_per_k_i);
    c->per_k_i = (real)(per_k_i);
    c->C_lN_mu_per_k_i = (real)(C_lN_mu_per_k_i);
    c->C_per_k_i = (real)(C_per_k_i);
    c->k_i_per_R = (real)(k_i_per_R);
    c->k_e_k_i_per_R = (real)(k_e_k_i_per_R);
    c->B_lN_L_M_mu4 = (real)(B_lN_L_M_mu4);
    c->C_lN_L_M_mu3 = (real)(C_lN_L_M_mu3);
    int invalid = 0;
    invalid = (((p->J_l < 0.0) && (p->J_l != ECCENTRIC_NOT_GIVEN)) || (p->J_l > DBL_MAX)) ? 17 : invalid;
    invalid = (((p->J_m < 0.0) && (p->J_m != ECCENTRIC_NOT_GIVEN)) || (p->J_m > DBL_MAX)) ? 16 : invalid;
    invalid = (!((p->F_T >= 0.0) && (p->F_T <= DBL_MAX))) ? 15 : invalid;
    invalid = (!((p->C_m >= 0.0) && (p->C_m <= DBL_MAX))) ? 14 : invalid;
    invalid = (!((p->B_m >= 0.0) && (p->B_m <= DBL_MAX))) ? 13 : invalid;
    invalid = (!((p->C_lT >= 0.0) && (p->C_lT <= DBL_MAX))) ? 12 : invalid;
    invalid = (!((p->B_lT >= 0.0) && (p->B_lT <= DBL_MAX))) ? 11 : invalid;
    invalid = (!((p->C_lN >= 0.0) && (p->C_lN <= DBL_MAX))) ? 10 : invalid;
    invalid = (!((p->B_lN >= 0.0) && (p->B_lN <= DBL_MAX))) ? 9 : invalid;
    invalid = (!((p->g >= 0.0) && (p->g <= DBL_MAX))) ? 8 : invalid;
    invalid = (!((p->k_e >= 0.0) && (p->k_e <= DBL_MAX))) ? 7 : invalid;
    invalid = (!((p->k_i > 0.0) && (p->k_i <= DBL_MAX))) ? 6 : invalid;
    invalid = (!((p->R > 0.0) && (p->R <= DBL_MAX))) ? 5 : invalid;
    invalid = (!((p->mu > 0.0) && (p->mu <= DBL_MAX))) ? 4 : invalid;
    invalid = (!((p->L >= 0.0) && (p->L <= DBL_MAX))) ? 3 : invalid;
    invalid = (!((p->M_l >= 0.0) && (p->M_l <= DBL_MAX))) ? 2 : invalid;
    invalid = (!((p->M >= 0.0) && (p->M <= DBL_MAX))) ? 1 : invalid;
    if (invalid != 0) {
        const c1_perpendicular_coefficients zero = {0};
        *c = zero;
    }
    return invalid;
}

REAL_INLINE real c1_perpendicular_normal_force_at(real omega_m, const c1_perpendicular_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    return F_N;
}

ECCENTRIC_REAL c1_perpendicular_normal_force(ECCENTRIC_REAL omega_m, const c1_perpendicular_coefficients *c)
{
    return c1_perpendicular_normal_force_at(omega_m, c);
}

void c1_perpendicular_normal_force_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    const c1_perpendicular_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = c1_perpendicular_normal_force_at(omega_m[k], &own);
    }
}

REAL_INLINE real c1_perpendicular_friction_torque_at(real omega_m, const c1_perpendicular_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    const real direction_of_motion = c1_perpendicular_sgn(omega_m);
    const real part_1 = omega_m * (c->B_lN_mu2 * F_N + c->B_plus_k_e_k_i_per_R);
    return direction_of_motion * (c->C + c->C_lN_mu * F_N) + part_1;
}

ECCENTRIC_REAL c1_perpendicular_friction_torque(
    ECCENTRIC_REAL omega_m,
    const c1_perpendicular_coefficients *c)
{
    return c1_perpendicular_friction_torque_at(omega_m, c);
}

void c1_perpendicular_friction_torque_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    const c1_perpendicular_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = c1_perpendicular_friction_torque_at(omega_m[k], &own);
    }
}

REAL_INLINE real c1_perpendicular_mechanical_friction_torque_at(
    real omega_m,
    const c1_perpendicular_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    const real direction_of_motion = c1_perpendicular_sgn(omega_m);
    const real part_1 = direction_of_motion * (c->C + c->C_lN_mu * F_N);
    return omega_m * (c->B + c->B_lN_mu2 * F_N) + part_1;
}

ECCENTRIC_REAL c1_perpendicular_mechanical_friction_torque(
    ECCENTRIC_REAL omega_m,
    const c1_perpendicular_coefficients *c)
{
    return c1_perpendicular_mechanical_friction_torque_at(omega_m, c);
}

void c1_perpendicular_mechanical_friction_torque_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    const c1_perpendicular_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = c1_perpendicular_mechanical_friction_torque_at(omega_m[k], &own);
    }
}

REAL_INLINE void c1_perpendicular_friction_torque_gradient_at(
    real omega_m,
    real *out,
    const c1_perpendicular_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    const real F_N_d_omega_m = omega_m * c->twice_L_M_mu2;
    const real direction_of_motion = c1_perpendicular_sgn(omega_m);
    const real part_1 = F_N_d_omega_m * (c->B_lN_mu2 * omega_m + c->C_lN_mu * direction_of_motion);
    out[0] = c->B_lN_mu2 * F_N + c->B_plus_k_e_k_i_per_R + part_1;
}

void c1_perpendicular_friction_torque_gradient(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    c1_perpendicular_friction_torque_gradient_at(omega_m, out, c);
}

void c1_perpendicular_friction_torque_gradient_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    const c1_perpendicular_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        c1_perpendicular_friction_torque_gradient_at(omega_m[k], &out[1u * k], &own);
    }
}

REAL_INLINE void c1_perpendicular_friction_torque_with_gradient_at(
    real omega_m,
    real *out,
    const c1_perpendicular_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    const real F_N_d_omega_m = omega_m * c->twice_L_M_mu2;
    const real direction_of_motion = c1_perpendicular_sgn(omega_m);
    const real part_1 = omega_m * (c->B_lN_mu2 * F_N + c->B_plus_k_e_k_i_per_R);
    out[0] = direction_of_motion * (c->C + c->C_lN_mu * F_N) + part_1;
    const real part_2 = F_N_d_omega_m * (c->B_lN_mu2 * omega_m + c->C_lN_mu * direction_of_motion);
    out[1] = c->B_lN_mu2 * F_N + c->B_plus_k_e_k_i_per_R + part_2;
}

void c1_perpendicular_friction_torque_with_gradient(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    c1_perpendicular_friction_torque_with_gradient_at(omega_m, out, c);
}

void c1_perpendicular_friction_torque_with_gradient_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    const c1_perpendicular_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        c1_perpendicular_friction_torque_with_gradient_at(omega_m[k], &out[2u * k], &own);
    }
}

REAL_INLINE void c1_perpendicular_friction_torque_jacobian_at(
    real omega_m,
    real *out,
    const c1_perpendicular_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    out[0] = F_N * c->mu2 * omega_m;
    const real direction_of_motion = c1_perpendicular_sgn(omega_m);
    out[1] = F_N * direction_of_motion * c->mu;
    out[2] = c->F_T_mu2 * omega_m;
    out[3] = c->F_T_mu * direction_of_motion;
    out[4] = omega_m;
    out[5] = direction_of_motion;
}

void c1_perpendicular_friction_torque_jacobian(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    c1_perpendicular_friction_torque_jacobian_at(omega_m, out, c);
}

void c1_perpendicular_friction_torque_jacobian_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    const c1_perpendicular_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        c1_perpendicular_friction_torque_jacobian_at(omega_m[k], &out[6u * k], &own);
    }
}

REAL_INLINE void c1_perpendicular_regressor_at(
    real omega_m,
    real *out,
    const c1_perpendicular_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    out[0] = F_N * c->mu2 * omega_m;
    const real direction_of_motion = c1_perpendicular_sgn(omega_m);
    out[1] = F_N * direction_of_motion * c->mu;
    out[2] = omega_m;
    out[3] = direction_of_motion;
}

void c1_perpendicular_regressor(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    c1_perpendicular_regressor_at(omega_m, out, c);
}

void c1_perpendicular_regressor_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    const c1_perpendicular_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        c1_perpendicular_regressor_at(omega_m[k], &out[4u * k], &own);
    }
}

void c1_perpendicular_friction_coefficients(ECCENTRIC_REAL *out, const c1_perpendicular_coefficients *c)
{
    out[0] = c->B_lN;
    out[1] = c->C_lN;
    out[2] = c->B;
    out[3] = c->C;
}

void c1_perpendicular_breakaway_torque(ECCENTRIC_REAL *out, const c1_perpendicular_coefficients *c)
{
    out[0] = -c->C;
    out[1] = c->C;
}

REAL_INLINE void c1_perpendicular_friction_budget_at(
    real omega_m,
    real *out,
    const c1_perpendicular_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    out[0] = -c->C - c->C_lN_mu * F_N;
    out[1] = c->C + c->C_lN_mu * F_N;
    out[2] = c->B + c->B_lN_mu2 * F_N;
}

void c1_perpendicular_friction_budget(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    c1_perpendicular_friction_budget_at(omega_m, out, c);
}

void c1_perpendicular_friction_budget_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    const c1_perpendicular_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        c1_perpendicular_friction_budget_at(omega_m[k], &out[3u * k], &own);
    }
}

ECCENTRIC_REAL c1_perpendicular_gravity_torque(const c1_perpendicular_coefficients *c)
{
    (void)c;
    return REAL(0.0);
}

REAL_INLINE real c1_perpendicular_voltage_at(
    real omega_m,
    real alpha_m,
    const c1_perpendicular_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    const real direction_of_motion = c1_perpendicular_sgn(omega_m);
    const real part_1 = direction_of_motion * (c->C_R_per_k_i + c->C_lN_R_mu_per_k_i * F_N);
    const real part_2 = omega_m * (c->B_R_per_k_i_plus_k_e + c->B_lN_R_mu2_per_k_i * F_N);
    const real part_3 = c->R_per_k_i * ((alpha_m == REAL(0.0)) ? REAL(0.0) : REAL_GIVEN(c->J) * alpha_m);
    return part_1 + part_2 + part_3;
}

ECCENTRIC_REAL c1_perpendicular_voltage(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const c1_perpendicular_coefficients *c)
{
    return c1_perpendicular_voltage_at(omega_m, alpha_m, c);
}

void c1_perpendicular_voltage_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    const c1_perpendicular_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = c1_perpendicular_voltage_at(omega_m[k], alpha_m[k], &own);
    }
}

REAL_INLINE real c1_perpendicular_current_at(
    real omega_m,
    real alpha_m,
    const c1_perpendicular_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    const real direction_of_motion = c1_perpendicular_sgn(omega_m);
    const real part_1 = direction_of_motion * (c->C_lN_mu_per_k_i * F_N + c->C_per_k_i);
    const real part_2 = c->per_k_i * ((alpha_m == REAL(0.0)) ? REAL(0.0) : REAL_GIVEN(c->J) * alpha_m);
    const real part_3 = omega_m * (c->B_lN_mu2_per_k_i * F_N + c->B_per_k_i);
    return part_1 + part_2 + part_3;
}

ECCENTRIC_REAL c1_perpendicular_current(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const c1_perpendicular_coefficients *c)
{
    return c1_perpendicular_current_at(omega_m, alpha_m, c);
}

void c1_perpendicular_current_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    const c1_perpendicular_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = c1_perpendicular_current_at(omega_m[k], alpha_m[k], &own);
    }
}

REAL_INLINE real c1_perpendicular_mechanical_residual_at(
    real omega_m,
    real i,
    real alpha_m,
    const c1_perpendicular_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    const real direction_of_motion = c1_perpendicular_sgn(omega_m);
    const real part_1 = -((alpha_m == REAL(0.0)) ? REAL(0.0) : REAL_GIVEN(c->J) * alpha_m);
    const real part_2 = -direction_of_motion * (c->C + c->C_lN_mu * F_N);
    return i * c->k_i - omega_m * (c->B + c->B_lN_mu2 * F_N) + part_1 + part_2;
}

ECCENTRIC_REAL c1_perpendicular_mechanical_residual(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL i,
    ECCENTRIC_REAL alpha_m,
    const c1_perpendicular_coefficients *c)
{
    return c1_perpendicular_mechanical_residual_at(omega_m, i, alpha_m, c);
}

void c1_perpendicular_mechanical_residual_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *i,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    const c1_perpendicular_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = c1_perpendicular_mechanical_residual_at(omega_m[k], i[k], alpha_m[k], &own);
    }
}

REAL_INLINE real c1_perpendicular_electrical_residual_at(
    real omega_m,
    real i,
    real u,
    const c1_perpendicular_coefficients *c)
{
    return -i * c->k_i - c->k_e_k_i_per_R * omega_m + c->k_i_per_R * u;
}

ECCENTRIC_REAL c1_perpendicular_electrical_residual(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL i,
    ECCENTRIC_REAL u,
    const c1_perpendicular_coefficients *c)
{
    return c1_perpendicular_electrical_residual_at(omega_m, i, u, c);
}

void c1_perpendicular_electrical_residual_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *i,
    const ECCENTRIC_REAL *u,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    const c1_perpendicular_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = c1_perpendicular_electrical_residual_at(omega_m[k], i[k], u[k], &own);
    }
}

REAL_INLINE void c1_perpendicular_friction_step_at(
    real omega_m,
    real torque,
    real dt,
    real *out,
    const c1_perpendicular_coefficients *c)
{
    /* time step, at least the shortest [s] */
    const real elapsed = ((REAL(1.0e-9) > dt) ? REAL(1.0e-9) : dt);
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    /* levels of dry friction [N m] */
    const real upper = c->C + c->C_lN_mu * F_N;
    const real slope = c->B + c->B_lN_mu2 * F_N;
    /* momentum at the end of the step, if there were no friction [N m s] */
    const real momentum = REAL_GIVEN(c->J) * omega_m + elapsed * torque;
    const real highest = elapsed * upper;
    const real held_back = c1_perpendicular_within(momentum, highest);
    /* its part that friction at rest does not take up [N m s] */
    const real excess = momentum - held_back + REAL(0.0) * highest;
    const real base = REAL_GIVEN(c->J) + elapsed * slope;
    const real velocity_after = excess / base;
    const real unlimited = momentum / elapsed;
    const real dry = c1_perpendicular_within(unlimited, upper);
    out[0] = ((dt < REAL(1.0e-9)) ? omega_m : velocity_after);
    const real part_1 = dry + slope * velocity_after;
    out[1] = ((dt < REAL(1.0e-9)) ? REAL(0.0) : part_1);
}

void c1_perpendicular_friction_step(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL torque,
    ECCENTRIC_REAL dt,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    c1_perpendicular_friction_step_at(omega_m, torque, dt, out, c);
}

void c1_perpendicular_friction_step_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *torque,
    const ECCENTRIC_REAL *dt,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    const c1_perpendicular_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        c1_perpendicular_friction_step_at(omega_m[k], torque[k], dt[k], &out[2u * k], &own);
    }
}

REAL_INLINE real c1_perpendicular_acceleration_at(
    real omega_m,
    real torque,
    const c1_perpendicular_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    /* levels of dry friction [N m] */
    const real upper = c->C + c->C_lN_mu * F_N;
    const real slope = c->B + c->B_lN_mu2 * F_N;
    const real held_back = c1_perpendicular_within(torque, upper);
    const real starting = torque - held_back + REAL(0.0) * upper;
    const real part_3 = torque - upper;
    const real part_2 = ((omega_m > REAL(0.0)) ? part_3 : ((omega_m < REAL(0.0)) ? torque + upper :
        starting));
    const real part_1 = -omega_m * slope + part_2;
    return part_1 / REAL_GIVEN(c->J);
}

ECCENTRIC_REAL c1_perpendicular_acceleration(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL torque,
    const c1_perpendicular_coefficients *c)
{
    return c1_perpendicular_acceleration_at(omega_m, torque, c);
}

void c1_perpendicular_acceleration_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *torque,
    ECCENTRIC_REAL *out,
    const c1_perpendicular_coefficients *c)
{
    const c1_perpendicular_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = c1_perpendicular_acceleration_at(omega_m[k], torque[k], &own);
    }
}

void c1_perpendicular_polynomial(ECCENTRIC_REAL *out, const c1_perpendicular_coefficients *c)
{
    out[0] = c->B_lN_L_M_mu4;
    out[1] = c->C_lN_L_M_mu3;
    out[2] = c->B_plus_k_e_k_i_per_R;
    out[3] = c->C;
}

#undef real
#undef REAL_INLINE
#undef REAL
#undef REAL_GIVEN

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC pop_options
#endif

#endif
