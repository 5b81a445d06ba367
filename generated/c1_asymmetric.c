/*
 * Generated: do not edit. Written by `make derive` from derivations/c1_asymmetric.py
 * (eccentric 0.2.0b1, program 2d39efa4).
 * Case C1 with friction that differs between the directions of motion.
 */
#include "c1_asymmetric.h"

#if !defined(__cplusplus) && (!defined(__STDC_VERSION__) || (__STDC_VERSION__ < 199901L))
#error "C99 or later is required: compile with -std=c99"
#else /* up to the end of the file, so that this is the only error */

#include <float.h>
#include <math.h>

#if C1_ASYMMETRIC_PROGRAM != 0x2d39efa4UL
#error "c1_asymmetric.c and c1_asymmetric.h are of different derivations: write both again"
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
extern const char c1_asymmetric_double_constants[(sizeof(1.0) == sizeof(double)) ? 1 : -1];

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

REAL_INLINE real c1_asymmetric_sgn(const real x)
{
    return (x > REAL(0.0)) ? REAL(1.0) : ((x < REAL(0.0)) ? REAL(-1.0) : (x + REAL(0.0)));
}

REAL_INLINE real c1_asymmetric_forward(const real x)
{
    return (x > REAL(0.0)) ? REAL(1.0) : ((x <= REAL(0.0)) ? REAL(0.0) : x);
}

const c1_asymmetric_parameters c1_asymmetric_default_parameters = {
    .M = 0.5, /* [kg] */
    .M_l = 0.2, /* [kg] */
    .L = 0.25, /* [m] */
    .mu = 0.2, /* [1] */
    .R = 1.0, /* [Ohm] */
    .k_i = 0.02, /* [N m/A] */
    .k_e = 0.2, /* [V s/rad] */
    .g = 9.81, /* [m/s^2] */
    .B_lN_pos = 0.004, /* [m s/rad] */
    .B_lN_neg = 0.004, /* [m s/rad] */
    .C_lN_pos = 0.08, /* [m] */
    .C_lN_neg = 0.08, /* [m] */
    .B_lT_pos = 0.004, /* [m s/rad] */
    .B_lT_neg = 0.004, /* [m s/rad] */
    .C_lT_pos = 0.08, /* [m] */
    .C_lT_neg = 0.08, /* [m] */
    .B_m_pos = 4.0e-4, /* [N m s/rad] */
    .B_m_neg = 4.0e-4, /* [N m s/rad] */
    .C_m_pos = 0.008, /* [N m] */
    .C_m_neg = 0.008, /* [N m] */
    .F_T = 1.962, /* [N] */
    .J_m = ECCENTRIC_NOT_GIVEN, /* [kg m^2] */
    .J_l = ECCENTRIC_NOT_GIVEN, /* [kg m^2] */
};

const c1_asymmetric_coefficients c1_asymmetric_default = {
#if ECCENTRIC_PRECISION == 1
    .B_lN_neg = (real)(0.004),
    .B_lN_pos = (real)(0.004),
    .C_lN_neg = (real)(0.08),
    .C_lN_pos = (real)(0.08),
    .k_e = (real)(0.2),
    .k_i = (real)(0.02),
    .mu = (real)(0.2),
    .L_M_mu2 = (real)(0.005),
    .B_lN_pos_mu2 = (real)(1.6e-4),
    .B_lN_neg_mu2 = (real)(1.6e-4),
    .B_pos = (real)(7.1392e-4),
    .B_neg = (real)(7.1392e-4),
    .k_e_k_i_per_R = (real)(0.004),
    .C_lN_pos_mu = (real)(0.016),
    .C_lN_neg_mu = (real)(0.016),
    .C_pos = (real)(0.039392),
    .C_neg = (real)(0.039392),
    .twice_L_M_mu2 = (real)(0.01),
    .mu2 = (real)(0.04),
    .F_T_mu2 = (real)(0.07848),
    .F_T_mu = (real)(0.3924),
    .J = (real)(ECCENTRIC_NOT_GIVEN),
    .B_lN_pos_R_mu2_per_k_i = (real)(0.008),
    .B_lN_neg_R_mu2_per_k_i = (real)(0.008),
    .B_pos_R_per_k_i = (real)(0.035696),
    .B_neg_R_per_k_i = (real)(0.035696),
    .C_lN_pos_R_mu_per_k_i = (real)(0.8),
    .C_lN_neg_R_mu_per_k_i = (real)(0.8),
    .C_pos_R_per_k_i = (real)(1.9696),
    .C_neg_R_per_k_i = (real)(1.9696),
    .R_per_k_i = (real)(50.0),
    .B_lN_pos_mu2_per_k_i = (real)(0.008),
    .B_lN_neg_mu2_per_k_i = (real)(0.008),
    .B_pos_per_k_i = (real)(0.035696),
    .B_neg_per_k_i = (real)(0.035696),
    .per_k_i = (real)(50.0),
    .C_lN_pos_mu_per_k_i = (real)(0.8),
    .C_lN_neg_mu_per_k_i = (real)(0.8),
    .C_pos_per_k_i = (real)(1.9696),
    .C_neg_per_k_i = (real)(1.9696),
    .k_i_per_R = (real)(0.02),
    .B_lN_pos_L_M_mu4 = (real)(8.0e-7),
    .C_lN_pos_L_M_mu3 = (real)(8.0e-5),
    .B_pos_plus_k_e_k_i_per_R = (real)(0.00471392),
    .B_lN_neg_L_M_mu4 = (real)(8.0e-7),
    .C_lN_neg_L_M_mu3 = (real)(8.0e-5),
    .B_neg_plus_k_e_k_i_per_R = (real)(0.00471392),
#else
    .B_lN_neg = 0.004,
    .B_lN_pos = 0.004,
    .C_lN_neg = 0.08,
    .C_lN_pos = 0.08,
    .k_e = 0.2,
    .k_i = 0.02,
    .mu = 0.2,
    .L_M_mu2 = 0.005,
    .B_lN_pos_mu2 = 1.6e-4,
    .B_lN_neg_mu2 = 1.6e-4,
    .B_pos = 7.1392e-4,
    .B_neg = 7.1392e-4,
    .k_e_k_i_per_R = 0.004,
    .C_lN_pos_mu = 0.016,
    .C_lN_neg_mu = 0.016,
    .C_pos = 0.039392,
    .C_neg = 0.039392,
    .twice_L_M_mu2 = 0.01,
    .mu2 = 0.04,
    .F_T_mu2 = 0.07848,
    .F_T_mu = 0.3924,
    .J = ECCENTRIC_NOT_GIVEN,
    .B_lN_pos_R_mu2_per_k_i = 0.008,
    .B_lN_neg_R_mu2_per_k_i = 0.008,
    .B_pos_R_per_k_i = 0.035696,
    .B_neg_R_per_k_i = 0.035696,
    .C_lN_pos_R_mu_per_k_i = 0.8,
    .C_lN_neg_R_mu_per_k_i = 0.8,
    .C_pos_R_per_k_i = 1.9696,
    .C_neg_R_per_k_i = 1.9696,
    .R_per_k_i = 50.0,
    .B_lN_pos_mu2_per_k_i = 0.008,
    .B_lN_neg_mu2_per_k_i = 0.008,
    .B_pos_per_k_i = 0.035696,
    .B_neg_per_k_i = 0.035696,
    .per_k_i = 50.0,
    .C_lN_pos_mu_per_k_i = 0.8,
    .C_lN_neg_mu_per_k_i = 0.8,
    .C_pos_per_k_i = 1.9696,
    .C_neg_per_k_i = 1.9696,
    .k_i_per_R = 0.02,
    .B_lN_pos_L_M_mu4 = 8.0e-7,
    .C_lN_pos_L_M_mu3 = 8.0e-5,
    .B_pos_plus_k_e_k_i_per_R = 0.00471392,
    .B_lN_neg_L_M_mu4 = 8.0e-7,
    .C_lN_neg_L_M_mu3 = 8.0e-5,
    .B_neg_plus_k_e_k_i_per_R = 0.00471392,
#endif
};

int c1_asymmetric_prepare(const c1_asymmetric_parameters *p, c1_asymmetric_coefficients *c)
{
    const double L_M_mu2 = p->L * p->M * p->mu * p->mu;
    const double B_lN_pos_mu2 = p->B_lN_pos * p->mu * p->mu;
    const double B_lN_neg_mu2 = p->B_lN_neg * p->mu * p->mu;
    const double B_pos = p->B_lT_pos * p->F_T * p->mu * p->mu + p->B_m_pos;
    const double B_neg = p->B_lT_neg * p->F_T * p->mu * p->mu + p->B_m_neg;
    const double k_e_k_i_per_R = p->k_e * p->k_i / p->R;
    const double C_lN_pos_mu = p->C_lN_pos * p->mu;
    const double C_lN_neg_mu = p->C_lN_neg * p->mu;
    const double C_pos = p->C_lT_pos * p->F_T * p->mu + p->C_m_pos;
    const double C_neg = p->C_lT_neg * p->F_T * p->mu + p->C_m_neg;
    const double twice_L_M_mu2 = 2.0 * p->L * p->M * p->mu * p->mu;
    const double mu2 = p->mu * p->mu;
    const double F_T_mu2 = p->F_T * p->mu * p->mu;
    const double F_T_mu = p->F_T * p->mu;
    const double J = ((p->J_l == ECCENTRIC_NOT_GIVEN) || (p->J_m == ECCENTRIC_NOT_GIVEN)) ?
        ECCENTRIC_NOT_GIVEN : (p->J_l * p->mu * p->mu + p->J_m);
    const double B_lN_pos_R_mu2_per_k_i = p->B_lN_pos * p->R * p->mu * p->mu / p->k_i;
    const double B_lN_neg_R_mu2_per_k_i = p->B_lN_neg * p->R * p->mu * p->mu / p->k_i;
    const double B_pos_R_per_k_i = B_pos * p->R / p->k_i;
    const double B_neg_R_per_k_i = B_neg * p->R / p->k_i;
    const double C_lN_pos_R_mu_per_k_i = p->C_lN_pos * p->R * p->mu / p->k_i;
    const double C_lN_neg_R_mu_per_k_i = p->C_lN_neg * p->R * p->mu / p->k_i;
    const double C_pos_R_per_k_i = C_pos * p->R / p->k_i;
    const double C_neg_R_per_k_i = C_neg * p->R / p->k_i;
    const double R_per_k_i = p->R / p->k_i;
    const double B_lN_pos_mu2_per_k_i = p->B_lN_pos * p->mu * p->mu / p->k_i;
    const double B_lN_neg_mu2_per_k_i = p->B_lN_neg * p->mu * p->mu / p->k_i;
    const double B_pos_per_k_i = B_pos / p->k_i;
    const double B_neg_per_k_i = B_neg / p->k_i;
    const double per_k_i = 1.0 / p->k_i;
    const double C_lN_pos_mu_per_k_i = p->C_lN_pos * p->mu / p->k_i;
    const double C_lN_neg_mu_per_k_i = p->C_lN_neg * p->mu / p->k_i;
    const double C_pos_per_k_i = C_pos / p->k_i;
    const double C_neg_per_k_i = C_neg / p->k_i;
    const double k_i_per_R = p->k_i / p->R;
    const double B_lN_pos_L_M_mu4 = p->B_lN_pos * p->L * p->M * p->mu * p->mu * p->mu * p->mu;
    const double C_lN_pos_L_M_mu3 = p->C_lN_pos * p->L * p->M * p->mu * p->mu * p->mu;
    const double B_pos_plus_k_e_k_i_per_R = B_pos + p->k_e * p->k_i / p->R;
    const double B_lN_neg_L_M_mu4 = p->B_lN_neg * p->L * p->M * p->mu * p->mu * p->mu * p->mu;
    const double C_lN_neg_L_M_mu3 = p->C_lN_neg * p->L * p->M * p->mu * p->mu * p->mu;
    const double B_neg_plus_k_e_k_i_per_R = B_neg + p->k_e * p->k_i / p->R;
    c->B_lN_neg = (real)(p->B_lN_neg);
    c->B_lN_pos = (real)(p->B_lN_pos);
    c->C_lN_neg = (real)(p->C_lN_neg);
    c->C_lN_pos = (real)(p->C_lN_pos);
    c->k_e = (real)(p->k_e);
    c->k_i = (real)(p->k_i);
    c->mu = (real)(p->mu);
    c->L_M_mu2 = (real)(L_M_mu2);
    c->B_lN_pos_mu2 = (real)(B_lN_pos_mu2);
    c->B_lN_neg_mu2 = (real)(B_lN_neg_mu2);
    c->B_pos = (real)(B_pos);
    c->B_neg = (real)(B_neg);
    c->k_e_k_i_per_R = (real)(k_e_k_i_per_R);
    c->C_lN_pos_mu = (real)(C_lN_pos_mu);
    c->C_lN_neg_mu = (real)(C_lN_neg_mu);
    c->C_pos = (real)(C_pos);
    c->C_neg = (real)(C_neg);
    c->twice_L_M_mu2 = (real)(twice_L_M_mu2);
    c->mu2 = (real)(mu2);
    c->F_T_mu2 = (real)(F_T_mu2);
    c->F_T_mu = (real)(F_T_mu);
    c->J = (real)(J);
    c->B_lN_pos_R_mu2_per_k_i = (real)(B_lN_pos_R_mu2_per_k_i);
    c->B_lN_neg_R_mu2_per_k_i = (real)(B_lN_neg_R_mu2_per_k_i);
    c->B_pos_R_per_k_i = (real)(B_pos_R_per_k_i);
    c->B_neg_R_per_k_i = (real)(B_neg_R_per_k_i);
    c->C_lN_pos_R_mu_per_k_i = (real)(C_lN_pos_R_mu_per_k_i);
    c->C_lN_neg_R_mu_per_k_i = (real)(C_lN_neg_R_mu_per_k_i);
    c->C_pos_R_per_k_i = (real)(C_pos_R_per_k_i);
    c->C_neg_R_per_k_i = (real)(C_neg_R_per_k_i);
    c->R_per_k_i = (real)(R_per_k_i);
    c->B_lN_pos_mu2_per_k_i = (real)(B_lN_pos_mu2_per_k_i);
    c->B_lN_neg_mu2_per_k_i = (real)(B_lN_neg_mu2_per_k_i);
    c->B_pos_per_k_i = (real)(B_pos_per_k_i);
    c->B_neg_per_k_i = (real)(B_neg_per_k_i);
    c->per_k_i = (real)(per_k_i);
    c->C_lN_pos_mu_per_k_i = (real)(C_lN_pos_mu_per_k_i);
    c->C_lN_neg_mu_per_k_i = (real)(C_lN_neg_mu_per_k_i);
    c->C_pos_per_k_i = (real)(C_pos_per_k_i);
    c->C_neg_per_k_i = (real)(C_neg_per_k_i);
    c->k_i_per_R = (real)(k_i_per_R);
    c->B_lN_pos_L_M_mu4 = (real)(B_lN_pos_L_M_mu4);
    c->C_lN_pos_L_M_mu3 = (real)(C_lN_pos_L_M_mu3);
    c->B_pos_plus_k_e_k_i_per_R = (real)(B_pos_plus_k_e_k_i_per_R);
    c->B_lN_neg_L_M_mu4 = (real)(B_lN_neg_L_M_mu4);
    c->C_lN_neg_L_M_mu3 = (real)(C_lN_neg_L_M_mu3);
    c->B_neg_plus_k_e_k_i_per_R = (real)(B_neg_plus_k_e_k_i_per_R);
    int invalid = 0;
    invalid = (((p->J_l < 0.0) && (p->J_l != ECCENTRIC_NOT_GIVEN)) || (p->J_l > DBL_MAX)) ? 23 : invalid;
    invalid = (((p->J_m < 0.0) && (p->J_m != ECCENTRIC_NOT_GIVEN)) || (p->J_m > DBL_MAX)) ? 22 : invalid;
    invalid = (!((p->F_T >= 0.0) && (p->F_T <= DBL_MAX))) ? 21 : invalid;
    invalid = (!((p->C_m_neg >= 0.0) && (p->C_m_neg <= DBL_MAX))) ? 20 : invalid;
    invalid = (!((p->C_m_pos >= 0.0) && (p->C_m_pos <= DBL_MAX))) ? 19 : invalid;
    invalid = (!((p->B_m_neg >= 0.0) && (p->B_m_neg <= DBL_MAX))) ? 18 : invalid;
    invalid = (!((p->B_m_pos >= 0.0) && (p->B_m_pos <= DBL_MAX))) ? 17 : invalid;
    invalid = (!((p->C_lT_neg >= 0.0) && (p->C_lT_neg <= DBL_MAX))) ? 16 : invalid;
    invalid = (!((p->C_lT_pos >= 0.0) && (p->C_lT_pos <= DBL_MAX))) ? 15 : invalid;
    invalid = (!((p->B_lT_neg >= 0.0) && (p->B_lT_neg <= DBL_MAX))) ? 14 : invalid;
    invalid = (!((p->B_lT_pos >= 0.0) && (p->B_lT_pos <= DBL_MAX))) ? 13 : invalid;
    invalid = (!((p->C_lN_neg >= 0.0) && (p->C_lN_neg <= DBL_MAX))) ? 12 : invalid;
    invalid = (!((p->C_lN_pos >= 0.0) && (p->C_lN_pos <= DBL_MAX))) ? 11 : invalid;
    invalid = (!((p->B_lN_neg >= 0.0) && (p->B_lN_neg <= DBL_MAX))) ? 10 : invalid;
    invalid = (!((p->B_lN_pos >= 0.0) && (p->B_lN_pos <= DBL_MAX))) ? 9 : invalid;
    invalid = (!((p->g >= 0.0) && (p->g <= DBL_MAX))) ? 8 : invalid;
    invalid = (!((p->k_e >= 0.0) && (p->k_e <= DBL_MAX))) ? 7 : invalid;
    invalid = (!((p->k_i > 0.0) && (p->k_i <= DBL_MAX))) ? 6 : invalid;
    invalid = (!((p->R > 0.0) && (p->R <= DBL_MAX))) ? 5 : invalid;
    invalid = (!((p->mu > 0.0) && (p->mu <= DBL_MAX))) ? 4 : invalid;
    invalid = (!((p->L >= 0.0) && (p->L <= DBL_MAX))) ? 3 : invalid;
    invalid = (!((p->M_l >= 0.0) && (p->M_l <= DBL_MAX))) ? 2 : invalid;
    invalid = (!((p->M >= 0.0) && (p->M <= DBL_MAX))) ? 1 : invalid;
    if (invalid != 0) {
        const c1_asymmetric_coefficients zero = {0};
        *c = zero;
    }
    return invalid;
}

REAL_INLINE real c1_asymmetric_normal_force_at(real omega_m, const c1_asymmetric_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    return F_N;
}

ECCENTRIC_REAL c1_asymmetric_normal_force(ECCENTRIC_REAL omega_m, const c1_asymmetric_coefficients *c)
{
    return c1_asymmetric_normal_force_at(omega_m, c);
}

void c1_asymmetric_normal_force_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    const c1_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = c1_asymmetric_normal_force_at(omega_m[k], &own);
    }
}

REAL_INLINE real c1_asymmetric_friction_torque_at(real omega_m, const c1_asymmetric_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    const real direction_of_motion = c1_asymmetric_sgn(omega_m);
    const real part_3 = F_N * ((omega_m > REAL(0.0)) ? c->B_lN_pos_mu2 : c->B_lN_neg_mu2);
    const real part_2 = c->k_e_k_i_per_R + part_3 + ((omega_m > REAL(0.0)) ? c->B_pos : c->B_neg);
    const real part_1 = omega_m * part_2;
    const real part_6 = F_N * ((omega_m > REAL(0.0)) ? c->C_lN_pos_mu : c->C_lN_neg_mu);
    const real part_5 = part_6 + ((omega_m > REAL(0.0)) ? c->C_pos : c->C_neg);
    const real part_4 = direction_of_motion * part_5;
    return part_1 + part_4;
}

ECCENTRIC_REAL c1_asymmetric_friction_torque(ECCENTRIC_REAL omega_m, const c1_asymmetric_coefficients *c)
{
    return c1_asymmetric_friction_torque_at(omega_m, c);
}

void c1_asymmetric_friction_torque_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    const c1_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = c1_asymmetric_friction_torque_at(omega_m[k], &own);
    }
}

REAL_INLINE real c1_asymmetric_mechanical_friction_torque_at(
    real omega_m,
    const c1_asymmetric_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    const real direction_of_motion = c1_asymmetric_sgn(omega_m);
    const real part_3 = F_N * ((omega_m > REAL(0.0)) ? c->C_lN_pos_mu : c->C_lN_neg_mu);
    const real part_2 = part_3 + ((omega_m > REAL(0.0)) ? c->C_pos : c->C_neg);
    const real part_1 = direction_of_motion * part_2;
    const real part_6 = F_N * ((omega_m > REAL(0.0)) ? c->B_lN_pos_mu2 : c->B_lN_neg_mu2);
    const real part_5 = part_6 + ((omega_m > REAL(0.0)) ? c->B_pos : c->B_neg);
    const real part_4 = omega_m * part_5;
    return part_1 + part_4;
}

ECCENTRIC_REAL c1_asymmetric_mechanical_friction_torque(
    ECCENTRIC_REAL omega_m,
    const c1_asymmetric_coefficients *c)
{
    return c1_asymmetric_mechanical_friction_torque_at(omega_m, c);
}

void c1_asymmetric_mechanical_friction_torque_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    const c1_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = c1_asymmetric_mechanical_friction_torque_at(omega_m[k], &own);
    }
}

REAL_INLINE void c1_asymmetric_friction_torque_gradient_at(
    real omega_m,
    real *out,
    const c1_asymmetric_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    const real F_N_d_omega_m = omega_m * c->twice_L_M_mu2;
    const real direction_of_motion = c1_asymmetric_sgn(omega_m);
    const real part_4 = ((omega_m > REAL(0.0)) ? c->C_lN_pos_mu : c->C_lN_neg_mu);
    const real part_3 = direction_of_motion * part_4;
    const real part_5 = omega_m * ((omega_m > REAL(0.0)) ? c->B_lN_pos_mu2 : c->B_lN_neg_mu2);
    const real part_2 = part_3 + part_5;
    const real part_1 = F_N_d_omega_m * part_2;
    const real part_6 = F_N * ((omega_m > REAL(0.0)) ? c->B_lN_pos_mu2 : c->B_lN_neg_mu2);
    const real part_7 = ((omega_m > REAL(0.0)) ? c->B_pos : c->B_neg);
    out[0] = c->k_e_k_i_per_R + part_1 + part_6 + part_7;
}

void c1_asymmetric_friction_torque_gradient(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    c1_asymmetric_friction_torque_gradient_at(omega_m, out, c);
}

void c1_asymmetric_friction_torque_gradient_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    const c1_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        c1_asymmetric_friction_torque_gradient_at(omega_m[k], &out[1u * k], &own);
    }
}

REAL_INLINE void c1_asymmetric_friction_torque_with_gradient_at(
    real omega_m,
    real *out,
    const c1_asymmetric_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    const real F_N_d_omega_m = omega_m * c->twice_L_M_mu2;
    const real direction_of_motion = c1_asymmetric_sgn(omega_m);
    const real part_3 = F_N * ((omega_m > REAL(0.0)) ? c->B_lN_pos_mu2 : c->B_lN_neg_mu2);
    const real part_2 = c->k_e_k_i_per_R + part_3 + ((omega_m > REAL(0.0)) ? c->B_pos : c->B_neg);
    const real part_1 = omega_m * part_2;
    const real part_6 = F_N * ((omega_m > REAL(0.0)) ? c->C_lN_pos_mu : c->C_lN_neg_mu);
    const real part_5 = part_6 + ((omega_m > REAL(0.0)) ? c->C_pos : c->C_neg);
    const real part_4 = direction_of_motion * part_5;
    out[0] = part_1 + part_4;
    const real part_10 = ((omega_m > REAL(0.0)) ? c->C_lN_pos_mu : c->C_lN_neg_mu);
    const real part_9 = direction_of_motion * part_10;
    const real part_11 = omega_m * ((omega_m > REAL(0.0)) ? c->B_lN_pos_mu2 : c->B_lN_neg_mu2);
    const real part_8 = part_11 + part_9;
    const real part_7 = F_N_d_omega_m * part_8;
    const real part_13 = ((omega_m > REAL(0.0)) ? c->B_pos : c->B_neg);
    out[1] = c->k_e_k_i_per_R + part_13 + part_3 + part_7;
}

void c1_asymmetric_friction_torque_with_gradient(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    c1_asymmetric_friction_torque_with_gradient_at(omega_m, out, c);
}

void c1_asymmetric_friction_torque_with_gradient_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    const c1_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        c1_asymmetric_friction_torque_with_gradient_at(omega_m[k], &out[2u * k], &own);
    }
}

REAL_INLINE void c1_asymmetric_friction_torque_jacobian_at(
    real omega_m,
    real *out,
    const c1_asymmetric_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    const real is_forward = c1_asymmetric_forward(omega_m);
    const real ungated = F_N * c->mu2 * omega_m;
    out[0] = ((is_forward == REAL(0.0)) ? c1_asymmetric_sgn(ungated) : ungated) * is_forward;
    const real is_backward = c1_asymmetric_forward(-(omega_m));
    out[1] = ((is_backward == REAL(0.0)) ? c1_asymmetric_sgn(ungated) : ungated) * is_backward;
    const real direction_of_motion = c1_asymmetric_sgn(omega_m);
    const real ungated_2 = F_N * direction_of_motion * c->mu;
    out[2] = ((is_forward == REAL(0.0)) ? c1_asymmetric_sgn(ungated_2) : ungated_2) * is_forward;
    out[3] = ((is_backward == REAL(0.0)) ? c1_asymmetric_sgn(ungated_2) : ungated_2) * is_backward;
    const real ungated_3 = c->F_T_mu2 * omega_m;
    out[4] = ((is_forward == REAL(0.0)) ? c1_asymmetric_sgn(ungated_3) : ungated_3) * is_forward;
    out[5] = ((is_backward == REAL(0.0)) ? c1_asymmetric_sgn(ungated_3) : ungated_3) * is_backward;
    const real ungated_4 = c->F_T_mu * direction_of_motion;
    out[6] = ((is_forward == REAL(0.0)) ? c1_asymmetric_sgn(ungated_4) : ungated_4) * is_forward;
    out[7] = ((is_backward == REAL(0.0)) ? c1_asymmetric_sgn(ungated_4) : ungated_4) * is_backward;
    out[8] = ((is_forward == REAL(0.0)) ? c1_asymmetric_sgn(omega_m) : omega_m) * is_forward;
    out[9] = ((is_backward == REAL(0.0)) ? c1_asymmetric_sgn(omega_m) : omega_m) * is_backward;
    out[10] = direction_of_motion * is_forward;
    out[11] = direction_of_motion * is_backward;
}

void c1_asymmetric_friction_torque_jacobian(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    c1_asymmetric_friction_torque_jacobian_at(omega_m, out, c);
}

void c1_asymmetric_friction_torque_jacobian_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    const c1_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        c1_asymmetric_friction_torque_jacobian_at(omega_m[k], &out[12u * k], &own);
    }
}

REAL_INLINE void c1_asymmetric_regressor_at(real omega_m, real *out, const c1_asymmetric_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    const real is_forward = c1_asymmetric_forward(omega_m);
    const real ungated = F_N * c->mu2 * omega_m;
    out[0] = ((is_forward == REAL(0.0)) ? c1_asymmetric_sgn(ungated) : ungated) * is_forward;
    const real is_backward = c1_asymmetric_forward(-(omega_m));
    out[1] = ((is_backward == REAL(0.0)) ? c1_asymmetric_sgn(ungated) : ungated) * is_backward;
    const real direction_of_motion = c1_asymmetric_sgn(omega_m);
    const real ungated_2 = F_N * direction_of_motion * c->mu;
    out[2] = ((is_forward == REAL(0.0)) ? c1_asymmetric_sgn(ungated_2) : ungated_2) * is_forward;
    out[3] = ((is_backward == REAL(0.0)) ? c1_asymmetric_sgn(ungated_2) : ungated_2) * is_backward;
    out[4] = ((is_forward == REAL(0.0)) ? c1_asymmetric_sgn(omega_m) : omega_m) * is_forward;
    out[5] = ((is_backward == REAL(0.0)) ? c1_asymmetric_sgn(omega_m) : omega_m) * is_backward;
    out[6] = direction_of_motion * is_forward;
    out[7] = direction_of_motion * is_backward;
}

void c1_asymmetric_regressor(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    c1_asymmetric_regressor_at(omega_m, out, c);
}

void c1_asymmetric_regressor_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    const c1_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        c1_asymmetric_regressor_at(omega_m[k], &out[8u * k], &own);
    }
}

void c1_asymmetric_friction_coefficients(ECCENTRIC_REAL *out, const c1_asymmetric_coefficients *c)
{
    out[0] = c->B_lN_pos;
    out[1] = c->B_lN_neg;
    out[2] = c->C_lN_pos;
    out[3] = c->C_lN_neg;
    out[4] = c->B_pos;
    out[5] = c->B_neg;
    out[6] = c->C_pos;
    out[7] = c->C_neg;
}

void c1_asymmetric_breakaway_torque(ECCENTRIC_REAL *out, const c1_asymmetric_coefficients *c)
{
    out[0] = -c->C_neg;
    out[1] = c->C_pos;
}

REAL_INLINE void c1_asymmetric_friction_budget_at(
    real omega_m,
    real *out,
    const c1_asymmetric_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    out[0] = -c->C_lN_neg_mu * F_N - c->C_neg;
    out[1] = c->C_lN_pos_mu * F_N + c->C_pos;
    const real part_1 = c->B_lN_pos_mu2 * F_N + c->B_pos;
    const real part_2 = c->B_lN_neg_mu2 * F_N + c->B_neg;
    out[2] = ((omega_m > REAL(0.0)) ? part_1 : part_2);
}

void c1_asymmetric_friction_budget(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    c1_asymmetric_friction_budget_at(omega_m, out, c);
}

void c1_asymmetric_friction_budget_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    const c1_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        c1_asymmetric_friction_budget_at(omega_m[k], &out[3u * k], &own);
    }
}

ECCENTRIC_REAL c1_asymmetric_gravity_torque(const c1_asymmetric_coefficients *c)
{
    (void)c;
    return REAL(0.0);
}

REAL_INLINE real c1_asymmetric_voltage_at(real omega_m, real alpha_m, const c1_asymmetric_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    const real direction_of_motion = c1_asymmetric_sgn(omega_m);
    const real part_4 = ((omega_m > REAL(0.0)) ? c->C_lN_pos_R_mu_per_k_i : c->C_lN_neg_R_mu_per_k_i);
    const real part_3 = F_N * part_4;
    const real part_2 = part_3 + ((omega_m > REAL(0.0)) ? c->C_pos_R_per_k_i : c->C_neg_R_per_k_i);
    const real part_1 = direction_of_motion * part_2;
    const real part_8 = ((omega_m > REAL(0.0)) ? c->B_lN_pos_R_mu2_per_k_i : c->B_lN_neg_R_mu2_per_k_i);
    const real part_7 = F_N * part_8;
    const real part_9 = ((omega_m > REAL(0.0)) ? c->B_pos_R_per_k_i : c->B_neg_R_per_k_i);
    const real part_6 = c->k_e + part_7 + part_9;
    const real part_5 = omega_m * part_6;
    const real part_10 = c->R_per_k_i * ((alpha_m == REAL(0.0)) ? REAL(0.0) : REAL_GIVEN(c->J) * alpha_m);
    return part_1 + part_10 + part_5;
}

ECCENTRIC_REAL c1_asymmetric_voltage(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const c1_asymmetric_coefficients *c)
{
    return c1_asymmetric_voltage_at(omega_m, alpha_m, c);
}

void c1_asymmetric_voltage_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    const c1_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = c1_asymmetric_voltage_at(omega_m[k], alpha_m[k], &own);
    }
}

REAL_INLINE real c1_asymmetric_current_at(real omega_m, real alpha_m, const c1_asymmetric_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    const real direction_of_motion = c1_asymmetric_sgn(omega_m);
    const real part_4 = ((omega_m > REAL(0.0)) ? c->C_lN_pos_mu_per_k_i : c->C_lN_neg_mu_per_k_i);
    const real part_3 = F_N * part_4;
    const real part_2 = part_3 + ((omega_m > REAL(0.0)) ? c->C_pos_per_k_i : c->C_neg_per_k_i);
    const real part_1 = direction_of_motion * part_2;
    const real part_8 = ((omega_m > REAL(0.0)) ? c->B_lN_pos_mu2_per_k_i : c->B_lN_neg_mu2_per_k_i);
    const real part_7 = F_N * part_8;
    const real part_6 = part_7 + ((omega_m > REAL(0.0)) ? c->B_pos_per_k_i : c->B_neg_per_k_i);
    const real part_5 = omega_m * part_6;
    const real part_9 = c->per_k_i * ((alpha_m == REAL(0.0)) ? REAL(0.0) : REAL_GIVEN(c->J) * alpha_m);
    return part_1 + part_5 + part_9;
}

ECCENTRIC_REAL c1_asymmetric_current(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const c1_asymmetric_coefficients *c)
{
    return c1_asymmetric_current_at(omega_m, alpha_m, c);
}

void c1_asymmetric_current_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    const c1_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = c1_asymmetric_current_at(omega_m[k], alpha_m[k], &own);
    }
}

REAL_INLINE real c1_asymmetric_mechanical_residual_at(
    real omega_m,
    real i,
    real alpha_m,
    const c1_asymmetric_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    const real direction_of_motion = c1_asymmetric_sgn(omega_m);
    const real part_3 = -F_N * ((omega_m > REAL(0.0)) ? c->C_lN_pos_mu : c->C_lN_neg_mu);
    const real part_2 = part_3 - ((omega_m > REAL(0.0)) ? c->C_pos : c->C_neg);
    const real part_1 = direction_of_motion * part_2;
    const real part_6 = -F_N * ((omega_m > REAL(0.0)) ? c->B_lN_pos_mu2 : c->B_lN_neg_mu2);
    const real part_5 = part_6 - ((omega_m > REAL(0.0)) ? c->B_pos : c->B_neg);
    const real part_4 = omega_m * part_5;
    const real part_7 = -((alpha_m == REAL(0.0)) ? REAL(0.0) : REAL_GIVEN(c->J) * alpha_m);
    return i * c->k_i + part_1 + part_4 + part_7;
}

ECCENTRIC_REAL c1_asymmetric_mechanical_residual(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL i,
    ECCENTRIC_REAL alpha_m,
    const c1_asymmetric_coefficients *c)
{
    return c1_asymmetric_mechanical_residual_at(omega_m, i, alpha_m, c);
}

void c1_asymmetric_mechanical_residual_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *i,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    const c1_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = c1_asymmetric_mechanical_residual_at(omega_m[k], i[k], alpha_m[k], &own);
    }
}

REAL_INLINE real c1_asymmetric_electrical_residual_at(
    real omega_m,
    real i,
    real u,
    const c1_asymmetric_coefficients *c)
{
    return -i * c->k_i - c->k_e_k_i_per_R * omega_m + c->k_i_per_R * u;
}

ECCENTRIC_REAL c1_asymmetric_electrical_residual(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL i,
    ECCENTRIC_REAL u,
    const c1_asymmetric_coefficients *c)
{
    return c1_asymmetric_electrical_residual_at(omega_m, i, u, c);
}

void c1_asymmetric_electrical_residual_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *i,
    const ECCENTRIC_REAL *u,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    const c1_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = c1_asymmetric_electrical_residual_at(omega_m[k], i[k], u[k], &own);
    }
}

REAL_INLINE void c1_asymmetric_friction_step_at(
    real omega_m,
    real torque,
    real dt,
    real *out,
    const c1_asymmetric_coefficients *c)
{
    /* time step, at least the shortest [s] */
    const real elapsed = ((REAL(1.0e-9) > dt) ? REAL(1.0e-9) : dt);
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    /* levels of dry friction [N m] */
    const real upper = c->C_lN_pos_mu * F_N + c->C_pos;
    const real slope_forward = c->B_lN_pos_mu2 * F_N + c->B_pos;
    const real lower = -c->C_lN_neg_mu * F_N - c->C_neg;
    const real slope_backward = c->B_lN_neg_mu2 * F_N + c->B_neg;
    /* momentum at the end of the step, if there were no friction [N m s] */
    const real momentum = REAL_GIVEN(c->J) * omega_m + elapsed * torque;
    const real highest = elapsed * upper;
    const real lowest = elapsed * lower;
    const real held_back = ((momentum > highest) ? highest : ((momentum < lowest) ? lowest : momentum));
    /* its part that friction at rest does not take up [N m s] */
    const real excess = momentum - held_back + REAL(0.0) * (highest - lowest);
    const real damped = ((excess > REAL(0.0)) ? slope_forward : slope_backward);
    const real base = REAL_GIVEN(c->J) + damped * elapsed;
    const real velocity_after = excess / base;
    const real unlimited = momentum / elapsed;
    const real dry = ((unlimited > upper) ? upper : ((unlimited < lower) ? lower : unlimited));
    out[0] = ((dt < REAL(1.0e-9)) ? omega_m : velocity_after);
    const real part_1 = damped * velocity_after + dry;
    out[1] = ((dt < REAL(1.0e-9)) ? REAL(0.0) : part_1);
}

void c1_asymmetric_friction_step(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL torque,
    ECCENTRIC_REAL dt,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    c1_asymmetric_friction_step_at(omega_m, torque, dt, out, c);
}

void c1_asymmetric_friction_step_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *torque,
    const ECCENTRIC_REAL *dt,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    const c1_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        c1_asymmetric_friction_step_at(omega_m[k], torque[k], dt[k], &out[2u * k], &own);
    }
}

REAL_INLINE real c1_asymmetric_acceleration_at(
    real omega_m,
    real torque,
    const c1_asymmetric_coefficients *c)
{
    /* normal force on the axis of rotation [N], eq (8) */
    const real F_N = c->L_M_mu2 * omega_m * omega_m;
    /* levels of dry friction [N m] */
    const real upper = c->C_lN_pos_mu * F_N + c->C_pos;
    const real slope_forward = c->B_lN_pos_mu2 * F_N + c->B_pos;
    const real lower = -c->C_lN_neg_mu * F_N - c->C_neg;
    const real slope_backward = c->B_lN_neg_mu2 * F_N + c->B_neg;
    const real held_back = ((torque > upper) ? upper : ((torque < lower) ? lower : torque));
    const real starting = torque - held_back + REAL(0.0) * (upper - lower);
    const real part_3 = torque - upper;
    const real part_2 = ((omega_m > REAL(0.0)) ? part_3 : ((omega_m < REAL(0.0)) ? -lower + torque :
        starting));
    const real part_4 = -omega_m * ((omega_m > REAL(0.0)) ? slope_forward : slope_backward);
    const real part_1 = part_2 + part_4;
    return part_1 / REAL_GIVEN(c->J);
}

ECCENTRIC_REAL c1_asymmetric_acceleration(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL torque,
    const c1_asymmetric_coefficients *c)
{
    return c1_asymmetric_acceleration_at(omega_m, torque, c);
}

void c1_asymmetric_acceleration_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *torque,
    ECCENTRIC_REAL *out,
    const c1_asymmetric_coefficients *c)
{
    const c1_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = c1_asymmetric_acceleration_at(omega_m[k], torque[k], &own);
    }
}

void c1_asymmetric_polynomial(ECCENTRIC_REAL *out, const c1_asymmetric_coefficients *c)
{
    out[0] = c->B_lN_pos_L_M_mu4;
    out[1] = c->C_lN_pos_L_M_mu3;
    out[2] = c->B_pos_plus_k_e_k_i_per_R;
    out[3] = c->C_pos;
}

void c1_asymmetric_polynomial_neg(ECCENTRIC_REAL *out, const c1_asymmetric_coefficients *c)
{
    out[0] = c->B_lN_neg_L_M_mu4;
    out[1] = -c->C_lN_neg_L_M_mu3;
    out[2] = c->B_neg_plus_k_e_k_i_per_R;
    out[3] = -c->C_neg;
}

#undef real
#undef REAL_INLINE
#undef REAL
#undef REAL_GIVEN

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC pop_options
#endif

#endif
