/*
 * Generated: do not edit. Written by `make derive` from derivations/c2_asymmetric.py
 * (eccentric 0.2.0b1, program 49117124).
 * Case C2 with friction that differs between the directions of motion.
 */
#include "c2_asymmetric.h"

#if !defined(__cplusplus) && (!defined(__STDC_VERSION__) || (__STDC_VERSION__ < 199901L))
#error "C99 or later is required: compile with -std=c99"
#else /* up to the end of the file, so that this is the only error */

#include <float.h>
#include <math.h>

#if C2_ASYMMETRIC_PROGRAM != 0x49117124UL
#error "c2_asymmetric.c and c2_asymmetric.h are of different derivations: write both again"
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
extern const char c2_asymmetric_double_constants[(sizeof(1.0) == sizeof(double)) ? 1 : -1];

/* Short names for this file only, undefined at its end: several models may share a translation unit. */
#define real ECCENTRIC_REAL
#if defined(__GNUC__)
#define REAL_INLINE static inline __attribute__((always_inline))
#else
#define REAL_INLINE static inline
#endif
/* Samples per block: array functions process a block stage by stage, to keep the arithmetic units busy. */
#define REAL_BLOCK 32u
#if ECCENTRIC_PRECISION == 1
#define REAL(x) x##f
#define REAL_GIVEN(x) (((x) == (real)ECCENTRIC_NOT_GIVEN) ? (real)NAN : (x))
#define REAL_SQRT(x) sqrtf(x)
#define REAL_FABS(x) fabsf(x)
#define REAL_IN_SINGLE(x, y) (x)
#define REAL_ROUNDER 12582912.0f
#define REAL_SIN(x) sinf(x)
#define REAL_COS(x) cosf(x)
#else
#define REAL(x) x
#define REAL_GIVEN(x) (((x) == (real)ECCENTRIC_NOT_GIVEN) ? (real)NAN : (x))
#define REAL_SQRT(x) sqrt(x)
#define REAL_FABS(x) fabs(x)
#define REAL_IN_SINGLE(x, y) (y)
#define REAL_ROUNDER 6755399441055744.0
#define REAL_SIN(x) sin(x)
#define REAL_COS(x) cos(x)
#endif

/* The square root of an Arm FPU: the library function sets errno, which costs a branch and a call. */
REAL_INLINE real c2_asymmetric_square_root(const real x)
{
#if defined(__GNUC__) && defined(__arm__) && defined(__ARM_FP) && (!defined(__thumb__) || defined(__thumb2__))
#if (ECCENTRIC_PRECISION == 1) && ((__ARM_FP & 4) != 0)
    real y;
    __asm__("vsqrt.f32 %0, %1" : "=t"(y) : "t"(x));
    return y;
#elif (ECCENTRIC_PRECISION == 2) && ((__ARM_FP & 8) != 0)
    real y;
    __asm__("vsqrt.f64 %P0, %P1" : "=w"(y) : "w"(x));
    return y;
#else
    return REAL_SQRT(x);
#endif
#else
    return REAL_SQRT(x);
#endif
}

REAL_INLINE real c2_asymmetric_sgn(const real x)
{
    return (x > REAL(0.0)) ? REAL(1.0) : ((x < REAL(0.0)) ? REAL(-1.0) : (x + REAL(0.0)));
}

REAL_INLINE real c2_asymmetric_forward(const real x)
{
    return (x > REAL(0.0)) ? REAL(1.0) : ((x <= REAL(0.0)) ? REAL(0.0) : x);
}

REAL_INLINE real c2_asymmetric_within(const real x, const real most)
{
    const real below = (x > most) ? most : x;
    return (below < -most) ? -most : below;
}

/* sin(h)/h - 1, |h| within a quarter turn: minimax in x = h^2. */
REAL_INLINE real c2_asymmetric_sine_ratio(const real h)
{
#ifdef ECCENTRIC_LIBM
    return (h == REAL(0.0)) ? REAL(0.0) : (REAL_SIN(h) / h - REAL(1.0));
#else
    const real x = h * h;
#if ECCENTRIC_PRECISION == 1
    real y = REAL(2.60548113e-6);
    y = y * x + REAL(-1.98094749e-4);
    y = y * x + REAL(8.33306462e-3);
    y = y * x + REAL(-1.66666595e-1);
    return y * x;
#else
    real y = REAL(2.7209972799826466e-15);
    y = y * x + REAL(-7.6429749659503679e-13);
    y = y * x + REAL(1.6058939085095993e-10);
    y = y * x + REAL(-2.5052106860746877e-8);
    y = y * x + REAL(2.7557319211008999e-6);
    y = y * x + REAL(-1.9841269841208492e-4);
    y = y * x + REAL(8.3333333333331924e-3);
    y = y * x + REAL(-1.6666666666666666e-1);
    return y * x;
#endif
#endif
}

/* cos(h), |h| within a quarter turn: minimax in x = h^2. */
REAL_INLINE real c2_asymmetric_cosine(const real h)
{
#ifdef ECCENTRIC_LIBM
    return REAL_COS(h);
#else
    const real x = h * h;
#if ECCENTRIC_PRECISION == 1
    real y = REAL(-2.60742068e-7);
    y = y * x + REAL(2.47617292e-5);
    y = y * x + REAL(-1.38884006e-3);
    y = y * x + REAL(4.16666405e-2);
    y = y * x + REAL(-4.99999995e-1);
    return y * x + REAL(1.0);
#else
    real y = REAL(4.6099547638170315e-14);
    y = y * x + REAL(-1.1463008250042011e-11);
    y = y * x + REAL(2.0876566590691354e-9);
    y = y * x + REAL(-2.7557316503307265e-7);
    y = y * x + REAL(2.4801587278920885e-5);
    y = y * x + REAL(-1.3888888888784392e-3);
    y = y * x + REAL(4.1666666666664337e-2);
    y = y * x + REAL(-4.9999999999999982e-1);
    return y * x + REAL(1.0);
#endif
#endif
}

/* The leading digits of x, so few that their product with a number of half turns is exact. */
static double c2_asymmetric_leading(const double x)
{
    const double scaled = x * REAL_IN_SINGLE(8796093022209.0, 1048577.0);
    return scaled - (scaled - x);
}

/* Motor angle from the nearest top of the link [rad]. */
REAL_INLINE real c2_asymmetric_from_top(real theta_m, const c2_asymmetric_coefficients *c)
{
    /* whole turns of the link plus a half, up to the nearest top */
    const real turns = theta_m * c->turns_per_rad - REAL(0.5) + REAL_ROUNDER - REAL_ROUNDER + REAL(0.5);
    /* the turns are subtracted in parts of few digits: all products but the last are exact */
    const real rest = theta_m - turns * c->period_1;
    const real left = rest - turns * c->period_2 - turns * c->period_3;
    const real reduced = REAL_IN_SINGLE(left - turns * c->period_4 - turns * c->period_5, left);
    /* bounded for angles too large to have any phase; infinity gives NaN */
    return c2_asymmetric_within(reduced, c->period_1);
}

/* 2 sin(half the link angle from the top)/mu. */
REAL_INLINE real c2_asymmetric_chord(real from_top, const c2_asymmetric_coefficients *c)
{
    const real half_angle = from_top * c->half_mu;
    return from_top + from_top * c2_asymmetric_sine_ratio(half_angle);
}

/* Cosine of half the link angle from the top. */
REAL_INLINE real c2_asymmetric_half_sine(real from_top, const c2_asymmetric_coefficients *c)
{
    const real half_angle = from_top * c->half_mu;
    return c2_asymmetric_cosine(half_angle);
}

/* Numbers beyond double precision: unevaluated sums high + low, with results correct to some 104 bits. */
typedef struct {
    double high;
    double low;
} c2_asymmetric_pair;

static c2_asymmetric_pair c2_asymmetric_exact(const double x)
{
    const c2_asymmetric_pair result = {.high = x, .low = 0.0};
    return result;
}

/* a + b without error. */
static c2_asymmetric_pair c2_asymmetric_sum(const double a, const double b)
{
    const double high = a + b;
    const double part = high - a;
    const c2_asymmetric_pair result = {.high = high, .low = (a - (high - part)) + (b - part)};
    return result;
}

/* a b without error: both factors are split into halves with exact products. */
static c2_asymmetric_pair c2_asymmetric_product(const double a, const double b)
{
    const double high = a * b;
    const double a_scaled = a * 134217729.0;
    const double b_scaled = b * 134217729.0;
    const double a_1 = a_scaled - (a_scaled - a);
    const double b_1 = b_scaled - (b_scaled - b);
    const double a_2 = a - a_1;
    const double b_2 = b - b_1;
    const c2_asymmetric_pair result = {
        .high = high,
        .low = (((a_1 * b_1 - high) + a_1 * b_2) + a_2 * b_1) + a_2 * b_2,
    };
    return result;
}

static c2_asymmetric_pair c2_asymmetric_plus(const c2_asymmetric_pair x, const c2_asymmetric_pair y)
{
    const c2_asymmetric_pair highs = c2_asymmetric_sum(x.high, y.high);
    return c2_asymmetric_sum(highs.high, highs.low + (x.low + y.low));
}

static c2_asymmetric_pair c2_asymmetric_times(const c2_asymmetric_pair x, const c2_asymmetric_pair y)
{
    const c2_asymmetric_pair highs = c2_asymmetric_product(x.high, y.high);
    return c2_asymmetric_sum(highs.high, highs.low + (x.high * y.low + x.low * y.high));
}

static c2_asymmetric_pair c2_asymmetric_over(const c2_asymmetric_pair x, const c2_asymmetric_pair y)
{
    const double quotient = x.high / y.high;
    const c2_asymmetric_pair taken = c2_asymmetric_product(quotient, y.high);
    const double left = (((x.high - taken.high) - taken.low) + x.low) - quotient * y.low;
    return c2_asymmetric_sum(quotient, left / y.high);
}

static c2_asymmetric_pair c2_asymmetric_root(const c2_asymmetric_pair x)
{
    const double root = sqrt(x.high);
    const c2_asymmetric_pair taken = c2_asymmetric_product(root, root);
    const double left = ((x.high - taken.high) - taken.low) + x.low;
    return c2_asymmetric_sum(root, (root > 0.0) ? (left / (2.0 * root)) : 0.0);
}

/* 2 pi - a b, for a b close to 2 pi. */
static c2_asymmetric_pair c2_asymmetric_turn_left(const double a, const double b)
{
    const c2_asymmetric_pair taken = c2_asymmetric_product(a, b);
    const c2_asymmetric_pair first = c2_asymmetric_sum(6.283185307179586 - taken.high, -taken.low);
    const c2_asymmetric_pair second = c2_asymmetric_sum(first.high, 2.4492935982947064e-16);
    return c2_asymmetric_sum(second.high, second.low + (first.low - 5.989539619436679e-33));
}

const c2_asymmetric_parameters c2_asymmetric_default_parameters = {
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
    .B_m_pos = 4.0e-4, /* [N m s/rad] */
    .B_m_neg = 4.0e-4, /* [N m s/rad] */
    .C_m_pos = 0.008, /* [N m] */
    .C_m_neg = 0.008, /* [N m] */
    .J_m = ECCENTRIC_NOT_GIVEN, /* [kg m^2] */
    .J_l = ECCENTRIC_NOT_GIVEN, /* [kg m^2] */
};

const c2_asymmetric_coefficients c2_asymmetric_default = {
#if ECCENTRIC_PRECISION == 1
    .B_lN_neg = (real)(0.004),
    .B_lN_pos = (real)(0.004),
    .B_m_neg = (real)(4.0e-4),
    .B_m_pos = (real)(4.0e-4),
    .C_lN_neg = (real)(0.08),
    .C_lN_pos = (real)(0.08),
    .C_m_neg = (real)(0.008),
    .C_m_pos = (real)(0.008),
    .k_e = (real)(0.2),
    .k_i = (real)(0.02),
    .scale_N = (real)(0.005),
    .fastest = (real)(1.07374182e+9),
    .mu_omega_star = (real)(7.41188235),
    .omega_star_1 = (real)(37.0594101),
    .omega_star_2 = (real)(1.66482255e-6),
    .turns_per_rad = (real)(0.0318309886),
    .period_1 = (real)(31.40625),
    .period_2 = (real)(0.00967407227),
    .period_3 = (real)(2.46241689e-6),
    .half_mu = (real)(0.1),
    .B_lN_pos_mu2_scale_N = (real)(8.0e-7),
    .B_lN_neg_mu2_scale_N = (real)(8.0e-7),
    .k_e_k_i_per_R = (real)(0.004),
    .C_lN_pos_mu_scale_N = (real)(8.0e-5),
    .C_lN_neg_mu_scale_N = (real)(8.0e-5),
    .mu2_scale_N = (real)(2.0e-4),
    .mu_scale_N = (real)(0.001),
    .C_lN_neg_mu_weight_plus_C_m_neg = (real)(0.117872),
    .C_lN_pos_mu_weight_plus_C_m_pos = (real)(0.117872),
    .L_M_g_mu2 = (real)(0.04905),
    .J = (real)(ECCENTRIC_NOT_GIVEN),
    .B_lN_pos_R_mu2_scale_N_per_k_i = (real)(4.0e-5),
    .B_lN_neg_R_mu2_scale_N_per_k_i = (real)(4.0e-5),
    .B_m_pos_R_per_k_i = (real)(0.02),
    .B_m_neg_R_per_k_i = (real)(0.02),
    .C_lN_pos_R_mu_scale_N_per_k_i = (real)(0.004),
    .C_lN_neg_R_mu_scale_N_per_k_i = (real)(0.004),
    .C_m_pos_R_per_k_i = (real)(0.4),
    .C_m_neg_R_per_k_i = (real)(0.4),
    .R_per_k_i = (real)(50.0),
    .L_M_R_g_mu2_per_k_i = (real)(2.4525),
    .B_lN_pos_mu2_scale_N_per_k_i = (real)(4.0e-5),
    .B_lN_neg_mu2_scale_N_per_k_i = (real)(4.0e-5),
    .B_m_pos_per_k_i = (real)(0.02),
    .B_m_neg_per_k_i = (real)(0.02),
    .per_k_i = (real)(50.0),
    .C_lN_pos_mu_scale_N_per_k_i = (real)(0.004),
    .C_lN_neg_mu_scale_N_per_k_i = (real)(0.004),
    .C_m_pos_per_k_i = (real)(0.4),
    .C_m_neg_per_k_i = (real)(0.4),
    .L_M_g_mu2_per_k_i = (real)(2.4525),
    .k_i_per_R = (real)(0.02),
    .period_4 = (real)(1.21508492e-9),
    .period_5 = (real)(3.35179719e-13),
#else
    .B_lN_neg = 0.004,
    .B_lN_pos = 0.004,
    .B_m_neg = 4.0e-4,
    .B_m_pos = 4.0e-4,
    .C_lN_neg = 0.08,
    .C_lN_pos = 0.08,
    .C_m_neg = 0.008,
    .C_m_pos = 0.008,
    .k_e = 0.2,
    .k_i = 0.02,
    .scale_N = 0.005,
    .fastest = 1.073741824e+9,
    .mu_omega_star = 7.4118823520074845,
    .omega_star_1 = 37.05941176003742,
    .omega_star_2 = 1.9391227281942644e-15,
    .turns_per_rad = 0.031830988618379067,
    .period_1 = 31.415926534682512,
    .period_2 = 1.2154201013692134e-9,
    .period_3 = -6.7974892272631429e-20,
    .half_mu = 0.1,
    .B_lN_pos_mu2_scale_N = 8.0e-7,
    .B_lN_neg_mu2_scale_N = 8.0e-7,
    .k_e_k_i_per_R = 0.004,
    .C_lN_pos_mu_scale_N = 8.0e-5,
    .C_lN_neg_mu_scale_N = 8.0e-5,
    .mu2_scale_N = 2.0e-4,
    .mu_scale_N = 0.001,
    .C_lN_neg_mu_weight_plus_C_m_neg = 0.117872,
    .C_lN_pos_mu_weight_plus_C_m_pos = 0.117872,
    .L_M_g_mu2 = 0.04905,
    .J = ECCENTRIC_NOT_GIVEN,
    .B_lN_pos_R_mu2_scale_N_per_k_i = 4.0e-5,
    .B_lN_neg_R_mu2_scale_N_per_k_i = 4.0e-5,
    .B_m_pos_R_per_k_i = 0.02,
    .B_m_neg_R_per_k_i = 0.02,
    .C_lN_pos_R_mu_scale_N_per_k_i = 0.004,
    .C_lN_neg_R_mu_scale_N_per_k_i = 0.004,
    .C_m_pos_R_per_k_i = 0.4,
    .C_m_neg_R_per_k_i = 0.4,
    .R_per_k_i = 50.0,
    .L_M_R_g_mu2_per_k_i = 2.4525,
    .B_lN_pos_mu2_scale_N_per_k_i = 4.0e-5,
    .B_lN_neg_mu2_scale_N_per_k_i = 4.0e-5,
    .B_m_pos_per_k_i = 0.02,
    .B_m_neg_per_k_i = 0.02,
    .per_k_i = 50.0,
    .C_lN_pos_mu_scale_N_per_k_i = 0.004,
    .C_lN_neg_mu_scale_N_per_k_i = 0.004,
    .C_m_pos_per_k_i = 0.4,
    .C_m_neg_per_k_i = 0.4,
    .L_M_g_mu2_per_k_i = 2.4525,
    .k_i_per_R = 0.02,
#endif
};

int c2_asymmetric_prepare(const c2_asymmetric_parameters *p, c2_asymmetric_coefficients *c)
{
    const c2_asymmetric_pair weight = c2_asymmetric_times(c2_asymmetric_exact(p->g),
        c2_asymmetric_plus(c2_asymmetric_exact(p->M), c2_asymmetric_exact(p->M_l)));
    const c2_asymmetric_pair critical_squared = (p->L * p->M == 0.0) ? c2_asymmetric_exact(1.0) :
        (c2_asymmetric_over(weight, c2_asymmetric_times(c2_asymmetric_exact(p->L),
        c2_asymmetric_exact(p->M))));
    const c2_asymmetric_pair omega_star = (p->L * p->M == 0.0) ? c2_asymmetric_exact(1.0) :
        (c2_asymmetric_over(c2_asymmetric_root(critical_squared), c2_asymmetric_exact(p->mu)));
    const c2_asymmetric_pair scale_N = (p->L * p->M == 0.0) ? c2_asymmetric_over(weight,
        c2_asymmetric_times(omega_star, omega_star)) :
        (c2_asymmetric_times(c2_asymmetric_times(c2_asymmetric_exact(p->L), c2_asymmetric_exact(p->M)),
        c2_asymmetric_times(c2_asymmetric_exact(p->mu), c2_asymmetric_exact(p->mu))));
    const double fastest = (p->L * p->M == 0.0) ? 0.0 : (1073741824.0);
    const c2_asymmetric_pair mu_omega_star = c2_asymmetric_times(c2_asymmetric_exact(p->mu), omega_star);
    const double omega_star_1 = (double)(real)(omega_star.high);
    const double omega_star_2 = (double)(real)(omega_star.high - omega_star_1 + omega_star.low);
    const double turns_per_rad = 0.5 * p->mu / 3.1415926535897932;
    const double period_1 = c2_asymmetric_leading(2.0 * 3.1415926535897932 / p->mu);
    const c2_asymmetric_pair period_left = c2_asymmetric_over(c2_asymmetric_turn_left(period_1, p->mu),
        c2_asymmetric_exact(p->mu));
    const double period_2 = c2_asymmetric_leading(period_left.high);
    const double period_rest = period_left.high - period_2 + period_left.low;
    const double period_3 = REAL_IN_SINGLE(c2_asymmetric_leading(period_rest), (double)(real)(period_rest));
    const double half_mu = 0.5 * p->mu;
    const double B_lN_pos_mu2_scale_N = p->B_lN_pos * p->mu * p->mu * scale_N.high;
    const double B_lN_neg_mu2_scale_N = p->B_lN_neg * p->mu * p->mu * scale_N.high;
    const double k_e_k_i_per_R = p->k_e * p->k_i / p->R;
    const double C_lN_pos_mu_scale_N = p->C_lN_pos * p->mu * scale_N.high;
    const double C_lN_neg_mu_scale_N = p->C_lN_neg * p->mu * scale_N.high;
    const double mu2_scale_N = p->mu * p->mu * scale_N.high;
    const double mu_scale_N = p->mu * scale_N.high;
    const double C_lN_neg_mu_weight_plus_C_m_neg = p->C_lN_neg * p->mu * weight.high + p->C_m_neg;
    const double C_lN_pos_mu_weight_plus_C_m_pos = p->C_lN_pos * p->mu * weight.high + p->C_m_pos;
    const double L_M_g_mu2 = p->L * p->M * p->g * p->mu * p->mu;
    const double J = ((p->J_l == ECCENTRIC_NOT_GIVEN) || (p->J_m == ECCENTRIC_NOT_GIVEN)) ?
        ECCENTRIC_NOT_GIVEN : (p->J_l * p->mu * p->mu + p->J_m);
    const double B_lN_pos_R_mu2_scale_N_per_k_i = p->B_lN_pos * p->R * p->mu * p->mu * scale_N.high / p->k_i;
    const double B_lN_neg_R_mu2_scale_N_per_k_i = p->B_lN_neg * p->R * p->mu * p->mu * scale_N.high / p->k_i;
    const double B_m_pos_R_per_k_i = p->B_m_pos * p->R / p->k_i;
    const double B_m_neg_R_per_k_i = p->B_m_neg * p->R / p->k_i;
    const double C_lN_pos_R_mu_scale_N_per_k_i = p->C_lN_pos * p->R * p->mu * scale_N.high / p->k_i;
    const double C_lN_neg_R_mu_scale_N_per_k_i = p->C_lN_neg * p->R * p->mu * scale_N.high / p->k_i;
    const double C_m_pos_R_per_k_i = p->C_m_pos * p->R / p->k_i;
    const double C_m_neg_R_per_k_i = p->C_m_neg * p->R / p->k_i;
    const double R_per_k_i = p->R / p->k_i;
    const double L_M_R_g_mu2_per_k_i = p->L * p->M * p->R * p->g * p->mu * p->mu / p->k_i;
    const double B_lN_pos_mu2_scale_N_per_k_i = p->B_lN_pos * p->mu * p->mu * scale_N.high / p->k_i;
    const double B_lN_neg_mu2_scale_N_per_k_i = p->B_lN_neg * p->mu * p->mu * scale_N.high / p->k_i;
    const double B_m_pos_per_k_i = p->B_m_pos / p->k_i;
    const double B_m_neg_per_k_i = p->B_m_neg / p->k_i;
    const double per_k_i = 1.0 / p->k_i;
    const double C_lN_pos_mu_scale_N_per_k_i = p->C_lN_pos * p->mu * scale_N.high / p->k_i;
    const double C_lN_neg_mu_scale_N_per_k_i = p->C_lN_neg * p->mu * scale_N.high / p->k_i;
    const double C_m_pos_per_k_i = p->C_m_pos / p->k_i;
    const double C_m_neg_per_k_i = p->C_m_neg / p->k_i;
    const double L_M_g_mu2_per_k_i = p->L * p->M * p->g * p->mu * p->mu / p->k_i;
    const double k_i_per_R = p->k_i / p->R;
    c->B_lN_neg = (real)(p->B_lN_neg);
    c->B_lN_pos = (real)(p->B_lN_pos);
    c->B_m_neg = (real)(p->B_m_neg);
    c->B_m_pos = (real)(p->B_m_pos);
    c->C_lN_neg = (real)(p->C_lN_neg);
    c->C_lN_pos = (real)(p->C_lN_pos);
    c->C_m_neg = (real)(p->C_m_neg);
    c->C_m_pos = (real)(p->C_m_pos);
    c->k_e = (real)(p->k_e);
    c->k_i = (real)(p->k_i);
    c->scale_N = (real)(scale_N.high);
    c->fastest = (real)(fastest);
    c->mu_omega_star = (real)(mu_omega_star.high);
    c->omega_star_1 = (real)(omega_star_1);
    c->omega_star_2 = (real)(omega_star_2);
    c->turns_per_rad = (real)(turns_per_rad);
    c->period_1 = (real)(period_1);
    c->period_2 = (real)(period_2);
    c->period_3 = (real)(period_3);
    c->half_mu = (real)(half_mu);
    c->B_lN_pos_mu2_scale_N = (real)(B_lN_pos_mu2_scale_N);
    c->B_lN_neg_mu2_scale_N = (real)(B_lN_neg_mu2_scale_N);
    c->k_e_k_i_per_R = (real)(k_e_k_i_per_R);
    c->C_lN_pos_mu_scale_N = (real)(C_lN_pos_mu_scale_N);
    c->C_lN_neg_mu_scale_N = (real)(C_lN_neg_mu_scale_N);
    c->mu2_scale_N = (real)(mu2_scale_N);
    c->mu_scale_N = (real)(mu_scale_N);
    c->C_lN_neg_mu_weight_plus_C_m_neg = (real)(C_lN_neg_mu_weight_plus_C_m_neg);
    c->C_lN_pos_mu_weight_plus_C_m_pos = (real)(C_lN_pos_mu_weight_plus_C_m_pos);
    c->L_M_g_mu2 = (real)(L_M_g_mu2);
    c->J = (real)(J);
    c->B_lN_pos_R_mu2_scale_N_per_k_i = (real)(B_lN_pos_R_mu2_scale_N_per_k_i);
    c->B_lN_neg_R_mu2_scale_N_per_k_i = (real)(B_lN_neg_R_mu2_scale_N_per_k_i);
    c->B_m_pos_R_per_k_i = (real)(B_m_pos_R_per_k_i);
    c->B_m_neg_R_per_k_i = (real)(B_m_neg_R_per_k_i);
    c->C_lN_pos_R_mu_scale_N_per_k_i = (real)(C_lN_pos_R_mu_scale_N_per_k_i);
    c->C_lN_neg_R_mu_scale_N_per_k_i = (real)(C_lN_neg_R_mu_scale_N_per_k_i);
    c->C_m_pos_R_per_k_i = (real)(C_m_pos_R_per_k_i);
    c->C_m_neg_R_per_k_i = (real)(C_m_neg_R_per_k_i);
    c->R_per_k_i = (real)(R_per_k_i);
    c->L_M_R_g_mu2_per_k_i = (real)(L_M_R_g_mu2_per_k_i);
    c->B_lN_pos_mu2_scale_N_per_k_i = (real)(B_lN_pos_mu2_scale_N_per_k_i);
    c->B_lN_neg_mu2_scale_N_per_k_i = (real)(B_lN_neg_mu2_scale_N_per_k_i);
    c->B_m_pos_per_k_i = (real)(B_m_pos_per_k_i);
    c->B_m_neg_per_k_i = (real)(B_m_neg_per_k_i);
    c->per_k_i = (real)(per_k_i);
    c->C_lN_pos_mu_scale_N_per_k_i = (real)(C_lN_pos_mu_scale_N_per_k_i);
    c->C_lN_neg_mu_scale_N_per_k_i = (real)(C_lN_neg_mu_scale_N_per_k_i);
    c->C_m_pos_per_k_i = (real)(C_m_pos_per_k_i);
    c->C_m_neg_per_k_i = (real)(C_m_neg_per_k_i);
    c->L_M_g_mu2_per_k_i = (real)(L_M_g_mu2_per_k_i);
    c->k_i_per_R = (real)(k_i_per_R);
#if ECCENTRIC_PRECISION == 1
    const double period_4 = c2_asymmetric_leading(period_rest - period_3);
    const double period_last = period_rest - period_3 - period_4;
    const double period_5 = (double)(real)(period_last);
    c->period_4 = (real)(period_4);
    c->period_5 = (real)(period_5);
#endif
    int invalid = 0;
    invalid = (((p->J_l < 0.0) && (p->J_l != ECCENTRIC_NOT_GIVEN)) || (p->J_l > DBL_MAX)) ? 18 : invalid;
    invalid = (((p->J_m < 0.0) && (p->J_m != ECCENTRIC_NOT_GIVEN)) || (p->J_m > DBL_MAX)) ? 17 : invalid;
    invalid = (!((p->C_m_neg >= 0.0) && (p->C_m_neg <= DBL_MAX))) ? 16 : invalid;
    invalid = (!((p->C_m_pos >= 0.0) && (p->C_m_pos <= DBL_MAX))) ? 15 : invalid;
    invalid = (!((p->B_m_neg >= 0.0) && (p->B_m_neg <= DBL_MAX))) ? 14 : invalid;
    invalid = (!((p->B_m_pos >= 0.0) && (p->B_m_pos <= DBL_MAX))) ? 13 : invalid;
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
        const c2_asymmetric_coefficients zero = {0};
        *c = zero;
    }
    return invalid;
}

REAL_INLINE real c2_asymmetric_normal_force_at(real omega_m, real chord, const c2_asymmetric_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real q = c->mu_omega_star * speed * chord;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = c2_asymmetric_square_root(square_difference * square_difference + q * q);
    return load * c->scale_N;
}

ECCENTRIC_REAL c2_asymmetric_normal_force(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    const c2_asymmetric_coefficients *c)
{
    const real from_top = c2_asymmetric_from_top(theta_m, c);
    const real chord = c2_asymmetric_chord(from_top, c);
    return c2_asymmetric_normal_force_at(omega_m, chord, c);
}

void c2_asymmetric_normal_force_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const c2_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = c2_asymmetric_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = c2_asymmetric_chord(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            out[first + k] = c2_asymmetric_normal_force_at(omega_m[first + k], chord[k], &own);
        }
    }
}

REAL_INLINE real c2_asymmetric_friction_torque_at(
    real omega_m,
    real chord,
    const c2_asymmetric_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real q = c->mu_omega_star * speed * chord;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = c2_asymmetric_square_root(square_difference * square_difference + q * q);
    const real direction_of_motion = c2_asymmetric_sgn(omega_m);
    const real part_4 = ((omega_m > REAL(0.0)) ? c->B_lN_pos_mu2_scale_N : c->B_lN_neg_mu2_scale_N);
    const real part_3 = load * part_4;
    const real part_5 = ((omega_m > REAL(0.0)) ? c->B_m_pos : c->B_m_neg);
    const real part_2 = c->k_e_k_i_per_R + part_3 + part_5;
    const real part_1 = omega_m * part_2;
    const real part_9 = ((omega_m > REAL(0.0)) ? c->C_lN_pos_mu_scale_N : c->C_lN_neg_mu_scale_N);
    const real part_8 = load * part_9;
    const real part_7 = part_8 + ((omega_m > REAL(0.0)) ? c->C_m_pos : c->C_m_neg);
    const real part_6 = direction_of_motion * part_7;
    return part_1 + part_6;
}

ECCENTRIC_REAL c2_asymmetric_friction_torque(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    const c2_asymmetric_coefficients *c)
{
    const real from_top = c2_asymmetric_from_top(theta_m, c);
    const real chord = c2_asymmetric_chord(from_top, c);
    return c2_asymmetric_friction_torque_at(omega_m, chord, c);
}

void c2_asymmetric_friction_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const c2_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = c2_asymmetric_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = c2_asymmetric_chord(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            out[first + k] = c2_asymmetric_friction_torque_at(omega_m[first + k], chord[k], &own);
        }
    }
}

REAL_INLINE real c2_asymmetric_mechanical_friction_torque_at(
    real omega_m,
    real chord,
    const c2_asymmetric_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real q = c->mu_omega_star * speed * chord;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = c2_asymmetric_square_root(square_difference * square_difference + q * q);
    const real direction_of_motion = c2_asymmetric_sgn(omega_m);
    const real part_4 = ((omega_m > REAL(0.0)) ? c->C_lN_pos_mu_scale_N : c->C_lN_neg_mu_scale_N);
    const real part_3 = load * part_4;
    const real part_2 = part_3 + ((omega_m > REAL(0.0)) ? c->C_m_pos : c->C_m_neg);
    const real part_1 = direction_of_motion * part_2;
    const real part_8 = ((omega_m > REAL(0.0)) ? c->B_lN_pos_mu2_scale_N : c->B_lN_neg_mu2_scale_N);
    const real part_7 = load * part_8;
    const real part_6 = part_7 + ((omega_m > REAL(0.0)) ? c->B_m_pos : c->B_m_neg);
    const real part_5 = omega_m * part_6;
    return part_1 + part_5;
}

ECCENTRIC_REAL c2_asymmetric_mechanical_friction_torque(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    const c2_asymmetric_coefficients *c)
{
    const real from_top = c2_asymmetric_from_top(theta_m, c);
    const real chord = c2_asymmetric_chord(from_top, c);
    return c2_asymmetric_mechanical_friction_torque_at(omega_m, chord, c);
}

void c2_asymmetric_mechanical_friction_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const c2_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = c2_asymmetric_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = c2_asymmetric_chord(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            out[first + k] = c2_asymmetric_mechanical_friction_torque_at(omega_m[first + k], chord[k], &own);
        }
    }
}

REAL_INLINE void c2_asymmetric_friction_torque_gradient_at(
    real omega_m,
    real chord,
    real half_sine,
    real *out,
    const c2_asymmetric_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    const real direction_of_motion = c2_asymmetric_sgn(omega_m);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real q = c->mu_omega_star * speed * chord;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = c2_asymmetric_square_root(square_difference * square_difference + q * q);
    /* 1 at the apex, where F_N is 0 and its derivatives are taken as 0 */
    const real inverse = ((load == REAL(0.0)) ? REAL(1.0) : REAL(1.0) / load);
    const real part_1 = c->mu_omega_star * speed * (q * inverse);
    const real load_d_theta_m = part_1 * half_sine;
    const real part_3 = c->mu_omega_star * (q * inverse) * chord;
    const real part_2 = part_3 + REAL(2.0) * speed * (square_difference * inverse);
    const real load_d_omega_m = direction_of_motion * part_2;
    const real part_6 = ((omega_m > REAL(0.0)) ? c->C_lN_pos_mu_scale_N : c->C_lN_neg_mu_scale_N);
    const real part_5 = direction_of_motion * part_6;
    const real part_8 = ((omega_m > REAL(0.0)) ? c->B_lN_pos_mu2_scale_N : c->B_lN_neg_mu2_scale_N);
    const real part_7 = omega_m * part_8;
    const real part_4 = part_5 + part_7;
    out[0] = load_d_theta_m * part_4;
    const real part_9 = load_d_omega_m * part_4;
    const real part_15 = load * part_8;
    const real part_17 = ((omega_m > REAL(0.0)) ? c->B_m_pos : c->B_m_neg);
    out[1] = c->k_e_k_i_per_R + part_15 + part_17 + part_9;
}

void c2_asymmetric_friction_torque_gradient(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const real from_top = c2_asymmetric_from_top(theta_m, c);
    const real chord = c2_asymmetric_chord(from_top, c);
    const real half_sine = c2_asymmetric_half_sine(from_top, c);
    c2_asymmetric_friction_torque_gradient_at(omega_m, chord, half_sine, out, c);
}

void c2_asymmetric_friction_torque_gradient_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const c2_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = c2_asymmetric_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = c2_asymmetric_chord(from_top[k], &own);
            half_sine[k] = c2_asymmetric_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            c2_asymmetric_friction_torque_gradient_at(omega_m[first + k], chord[k], half_sine[k], &out[2u *
                (first + k)], &own);
        }
    }
}

REAL_INLINE void c2_asymmetric_friction_torque_with_gradient_at(
    real omega_m,
    real chord,
    real half_sine,
    real *out,
    const c2_asymmetric_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    const real direction_of_motion = c2_asymmetric_sgn(omega_m);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real q = c->mu_omega_star * speed * chord;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = c2_asymmetric_square_root(square_difference * square_difference + q * q);
    /* 1 at the apex, where F_N is 0 and its derivatives are taken as 0 */
    const real inverse = ((load == REAL(0.0)) ? REAL(1.0) : REAL(1.0) / load);
    const real part_1 = c->mu_omega_star * speed * (q * inverse);
    const real load_d_theta_m = part_1 * half_sine;
    const real part_3 = c->mu_omega_star * (q * inverse) * chord;
    const real part_2 = part_3 + REAL(2.0) * speed * (square_difference * inverse);
    const real load_d_omega_m = direction_of_motion * part_2;
    const real part_7 = ((omega_m > REAL(0.0)) ? c->B_lN_pos_mu2_scale_N : c->B_lN_neg_mu2_scale_N);
    const real part_6 = load * part_7;
    const real part_8 = ((omega_m > REAL(0.0)) ? c->B_m_pos : c->B_m_neg);
    const real part_5 = c->k_e_k_i_per_R + part_6 + part_8;
    const real part_4 = omega_m * part_5;
    const real part_12 = ((omega_m > REAL(0.0)) ? c->C_lN_pos_mu_scale_N : c->C_lN_neg_mu_scale_N);
    const real part_11 = load * part_12;
    const real part_10 = part_11 + ((omega_m > REAL(0.0)) ? c->C_m_pos : c->C_m_neg);
    const real part_9 = direction_of_motion * part_10;
    out[0] = part_4 + part_9;
    const real part_14 = direction_of_motion * part_12;
    const real part_16 = omega_m * part_7;
    const real part_13 = part_14 + part_16;
    out[1] = load_d_theta_m * part_13;
    const real part_18 = load_d_omega_m * part_13;
    out[2] = c->k_e_k_i_per_R + part_18 + part_6 + part_8;
}

void c2_asymmetric_friction_torque_with_gradient(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const real from_top = c2_asymmetric_from_top(theta_m, c);
    const real chord = c2_asymmetric_chord(from_top, c);
    const real half_sine = c2_asymmetric_half_sine(from_top, c);
    c2_asymmetric_friction_torque_with_gradient_at(omega_m, chord, half_sine, out, c);
}

void c2_asymmetric_friction_torque_with_gradient_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const c2_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = c2_asymmetric_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = c2_asymmetric_chord(from_top[k], &own);
            half_sine[k] = c2_asymmetric_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            c2_asymmetric_friction_torque_with_gradient_at(omega_m[first + k], chord[k], half_sine[k], &out[3u
                * (first + k)], &own);
        }
    }
}

REAL_INLINE void c2_asymmetric_friction_torque_jacobian_at(
    real omega_m,
    real chord,
    real *out,
    const c2_asymmetric_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real q = c->mu_omega_star * speed * chord;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = c2_asymmetric_square_root(square_difference * square_difference + q * q);
    const real is_forward = c2_asymmetric_forward(omega_m);
    const real ungated = load * c->mu2_scale_N * omega_m;
    out[0] = ((is_forward == REAL(0.0)) ? c2_asymmetric_sgn(ungated) : ungated) * is_forward;
    const real is_backward = c2_asymmetric_forward(-(omega_m));
    out[1] = ((is_backward == REAL(0.0)) ? c2_asymmetric_sgn(ungated) : ungated) * is_backward;
    const real direction_of_motion = c2_asymmetric_sgn(omega_m);
    const real ungated_2 = direction_of_motion * load * c->mu_scale_N;
    out[2] = ((is_forward == REAL(0.0)) ? c2_asymmetric_sgn(ungated_2) : ungated_2) * is_forward;
    out[3] = ((is_backward == REAL(0.0)) ? c2_asymmetric_sgn(ungated_2) : ungated_2) * is_backward;
    out[4] = ((is_forward == REAL(0.0)) ? c2_asymmetric_sgn(omega_m) : omega_m) * is_forward;
    out[5] = ((is_backward == REAL(0.0)) ? c2_asymmetric_sgn(omega_m) : omega_m) * is_backward;
    out[6] = direction_of_motion * is_forward;
    out[7] = direction_of_motion * is_backward;
}

void c2_asymmetric_friction_torque_jacobian(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const real from_top = c2_asymmetric_from_top(theta_m, c);
    const real chord = c2_asymmetric_chord(from_top, c);
    c2_asymmetric_friction_torque_jacobian_at(omega_m, chord, out, c);
}

void c2_asymmetric_friction_torque_jacobian_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const c2_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = c2_asymmetric_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = c2_asymmetric_chord(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            c2_asymmetric_friction_torque_jacobian_at(omega_m[first + k], chord[k], &out[8u * (first + k)],
                &own);
        }
    }
}

void c2_asymmetric_regressor(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    c2_asymmetric_friction_torque_jacobian(theta_m, omega_m, out, c);
}

void c2_asymmetric_regressor_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    c2_asymmetric_friction_torque_jacobian_n(n, theta_m, omega_m, out, c);
}

void c2_asymmetric_friction_coefficients(ECCENTRIC_REAL *out, const c2_asymmetric_coefficients *c)
{
    out[0] = c->B_lN_pos;
    out[1] = c->B_lN_neg;
    out[2] = c->C_lN_pos;
    out[3] = c->C_lN_neg;
    out[4] = c->B_m_pos;
    out[5] = c->B_m_neg;
    out[6] = c->C_m_pos;
    out[7] = c->C_m_neg;
}

void c2_asymmetric_breakaway_torque(ECCENTRIC_REAL *out, const c2_asymmetric_coefficients *c)
{
    out[0] = -c->C_lN_neg_mu_weight_plus_C_m_neg;
    out[1] = c->C_lN_pos_mu_weight_plus_C_m_pos;
}

REAL_INLINE void c2_asymmetric_friction_budget_at(
    real omega_m,
    real chord,
    real *out,
    const c2_asymmetric_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real q = c->mu_omega_star * speed * chord;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = c2_asymmetric_square_root(square_difference * square_difference + q * q);
    out[0] = -c->C_lN_neg_mu_scale_N * load - c->C_m_neg;
    out[1] = c->C_lN_pos_mu_scale_N * load + c->C_m_pos;
    const real part_1 = c->B_lN_pos_mu2_scale_N * load + c->B_m_pos;
    const real part_2 = c->B_lN_neg_mu2_scale_N * load + c->B_m_neg;
    out[2] = ((omega_m > REAL(0.0)) ? part_1 : part_2);
}

void c2_asymmetric_friction_budget(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const real from_top = c2_asymmetric_from_top(theta_m, c);
    const real chord = c2_asymmetric_chord(from_top, c);
    c2_asymmetric_friction_budget_at(omega_m, chord, out, c);
}

void c2_asymmetric_friction_budget_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const c2_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = c2_asymmetric_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = c2_asymmetric_chord(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            c2_asymmetric_friction_budget_at(omega_m[first + k], chord[k], &out[3u * (first + k)], &own);
        }
    }
}

REAL_INLINE real c2_asymmetric_gravity_torque_at(
    real chord,
    real half_sine,
    const c2_asymmetric_coefficients *c)
{
    return (-c->L_M_g_mu2) * chord * half_sine;
}

ECCENTRIC_REAL c2_asymmetric_gravity_torque(ECCENTRIC_REAL theta_m, const c2_asymmetric_coefficients *c)
{
    const real from_top = c2_asymmetric_from_top(theta_m, c);
    const real chord = c2_asymmetric_chord(from_top, c);
    const real half_sine = c2_asymmetric_half_sine(from_top, c);
    return c2_asymmetric_gravity_torque_at(chord, half_sine, c);
}

void c2_asymmetric_gravity_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const c2_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = c2_asymmetric_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = c2_asymmetric_chord(from_top[k], &own);
            half_sine[k] = c2_asymmetric_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            out[first + k] = c2_asymmetric_gravity_torque_at(chord[k], half_sine[k], &own);
        }
    }
}

REAL_INLINE real c2_asymmetric_voltage_at(
    real omega_m,
    real alpha_m,
    real chord,
    real half_sine,
    const c2_asymmetric_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real q = c->mu_omega_star * speed * chord;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = c2_asymmetric_square_root(square_difference * square_difference + q * q);
    const real direction_of_motion = c2_asymmetric_sgn(omega_m);
    const real part_4 = ((omega_m > REAL(0.0)) ? c->C_lN_pos_R_mu_scale_N_per_k_i :
        c->C_lN_neg_R_mu_scale_N_per_k_i);
    const real part_3 = load * part_4;
    const real part_5 = ((omega_m > REAL(0.0)) ? c->C_m_pos_R_per_k_i : c->C_m_neg_R_per_k_i);
    const real part_2 = part_3 + part_5;
    const real part_1 = direction_of_motion * part_2;
    const real part_9 = ((omega_m > REAL(0.0)) ? c->B_lN_pos_R_mu2_scale_N_per_k_i :
        c->B_lN_neg_R_mu2_scale_N_per_k_i);
    const real part_8 = load * part_9;
    const real part_10 = ((omega_m > REAL(0.0)) ? c->B_m_pos_R_per_k_i : c->B_m_neg_R_per_k_i);
    const real part_7 = c->k_e + part_10 + part_8;
    const real part_6 = omega_m * part_7;
    const real part_11 = (-c->L_M_R_g_mu2_per_k_i) * chord * half_sine;
    const real part_12 = c->R_per_k_i * ((alpha_m == REAL(0.0)) ? REAL(0.0) : REAL_GIVEN(c->J) * alpha_m);
    return part_1 + part_11 + part_12 + part_6;
}

ECCENTRIC_REAL c2_asymmetric_voltage(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const c2_asymmetric_coefficients *c)
{
    const real from_top = c2_asymmetric_from_top(theta_m, c);
    const real chord = c2_asymmetric_chord(from_top, c);
    const real half_sine = c2_asymmetric_half_sine(from_top, c);
    return c2_asymmetric_voltage_at(omega_m, alpha_m, chord, half_sine, c);
}

void c2_asymmetric_voltage_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const c2_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = c2_asymmetric_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = c2_asymmetric_chord(from_top[k], &own);
            half_sine[k] = c2_asymmetric_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            out[first + k] = c2_asymmetric_voltage_at(omega_m[first + k], alpha_m[first + k], chord[k],
                half_sine[k], &own);
        }
    }
}

REAL_INLINE real c2_asymmetric_current_at(
    real omega_m,
    real alpha_m,
    real chord,
    real half_sine,
    const c2_asymmetric_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real q = c->mu_omega_star * speed * chord;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = c2_asymmetric_square_root(square_difference * square_difference + q * q);
    const real direction_of_motion = c2_asymmetric_sgn(omega_m);
    const real part_4 = ((omega_m > REAL(0.0)) ? c->C_lN_pos_mu_scale_N_per_k_i :
        c->C_lN_neg_mu_scale_N_per_k_i);
    const real part_3 = load * part_4;
    const real part_2 = part_3 + ((omega_m > REAL(0.0)) ? c->C_m_pos_per_k_i : c->C_m_neg_per_k_i);
    const real part_1 = direction_of_motion * part_2;
    const real part_8 = ((omega_m > REAL(0.0)) ? c->B_lN_pos_mu2_scale_N_per_k_i :
        c->B_lN_neg_mu2_scale_N_per_k_i);
    const real part_7 = load * part_8;
    const real part_6 = part_7 + ((omega_m > REAL(0.0)) ? c->B_m_pos_per_k_i : c->B_m_neg_per_k_i);
    const real part_5 = omega_m * part_6;
    const real part_9 = c->per_k_i * ((alpha_m == REAL(0.0)) ? REAL(0.0) : REAL_GIVEN(c->J) * alpha_m);
    const real part_10 = (-c->L_M_g_mu2_per_k_i) * chord * half_sine;
    return part_1 + part_10 + part_5 + part_9;
}

ECCENTRIC_REAL c2_asymmetric_current(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const c2_asymmetric_coefficients *c)
{
    const real from_top = c2_asymmetric_from_top(theta_m, c);
    const real chord = c2_asymmetric_chord(from_top, c);
    const real half_sine = c2_asymmetric_half_sine(from_top, c);
    return c2_asymmetric_current_at(omega_m, alpha_m, chord, half_sine, c);
}

void c2_asymmetric_current_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const c2_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = c2_asymmetric_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = c2_asymmetric_chord(from_top[k], &own);
            half_sine[k] = c2_asymmetric_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            out[first + k] = c2_asymmetric_current_at(omega_m[first + k], alpha_m[first + k], chord[k],
                half_sine[k], &own);
        }
    }
}

REAL_INLINE real c2_asymmetric_mechanical_residual_at(
    real omega_m,
    real i,
    real alpha_m,
    real chord,
    real half_sine,
    const c2_asymmetric_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real q = c->mu_omega_star * speed * chord;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = c2_asymmetric_square_root(square_difference * square_difference + q * q);
    const real direction_of_motion = c2_asymmetric_sgn(omega_m);
    const real part_4 = ((omega_m > REAL(0.0)) ? c->C_lN_pos_mu_scale_N : c->C_lN_neg_mu_scale_N);
    const real part_3 = -load * part_4;
    const real part_2 = part_3 - ((omega_m > REAL(0.0)) ? c->C_m_pos : c->C_m_neg);
    const real part_1 = direction_of_motion * part_2;
    const real part_8 = ((omega_m > REAL(0.0)) ? c->B_lN_pos_mu2_scale_N : c->B_lN_neg_mu2_scale_N);
    const real part_7 = -load * part_8;
    const real part_6 = part_7 - ((omega_m > REAL(0.0)) ? c->B_m_pos : c->B_m_neg);
    const real part_5 = omega_m * part_6;
    const real part_9 = -((alpha_m == REAL(0.0)) ? REAL(0.0) : REAL_GIVEN(c->J) * alpha_m);
    const real part_10 = c->L_M_g_mu2 * chord * half_sine;
    return i * c->k_i + part_1 + part_10 + part_5 + part_9;
}

ECCENTRIC_REAL c2_asymmetric_mechanical_residual(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL i,
    ECCENTRIC_REAL alpha_m,
    const c2_asymmetric_coefficients *c)
{
    const real from_top = c2_asymmetric_from_top(theta_m, c);
    const real chord = c2_asymmetric_chord(from_top, c);
    const real half_sine = c2_asymmetric_half_sine(from_top, c);
    return c2_asymmetric_mechanical_residual_at(omega_m, i, alpha_m, chord, half_sine, c);
}

void c2_asymmetric_mechanical_residual_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *i,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const c2_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = c2_asymmetric_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = c2_asymmetric_chord(from_top[k], &own);
            half_sine[k] = c2_asymmetric_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            out[first + k] = c2_asymmetric_mechanical_residual_at(omega_m[first + k], i[first + k],
                alpha_m[first + k], chord[k], half_sine[k], &own);
        }
    }
}

REAL_INLINE real c2_asymmetric_electrical_residual_at(
    real omega_m,
    real i,
    real u,
    const c2_asymmetric_coefficients *c)
{
    return -i * c->k_i - c->k_e_k_i_per_R * omega_m + c->k_i_per_R * u;
}

ECCENTRIC_REAL c2_asymmetric_electrical_residual(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL i,
    ECCENTRIC_REAL u,
    const c2_asymmetric_coefficients *c)
{
    return c2_asymmetric_electrical_residual_at(omega_m, i, u, c);
}

void c2_asymmetric_electrical_residual_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *i,
    const ECCENTRIC_REAL *u,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const c2_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = c2_asymmetric_electrical_residual_at(omega_m[k], i[k], u[k], &own);
    }
}

REAL_INLINE void c2_asymmetric_friction_step_at(
    real omega_m,
    real torque,
    real dt,
    real chord,
    real *out,
    const c2_asymmetric_coefficients *c)
{
    /* time step, at least the shortest [s] */
    const real elapsed = ((REAL(1.0e-9) > dt) ? REAL(1.0e-9) : dt);
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real q = c->mu_omega_star * speed * chord;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = c2_asymmetric_square_root(square_difference * square_difference + q * q);
    /* levels of dry friction [N m] */
    const real upper = c->C_lN_pos_mu_scale_N * load + c->C_m_pos;
    const real slope_forward = c->B_lN_pos_mu2_scale_N * load + c->B_m_pos;
    const real lower = -c->C_lN_neg_mu_scale_N * load - c->C_m_neg;
    const real slope_backward = c->B_lN_neg_mu2_scale_N * load + c->B_m_neg;
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

void c2_asymmetric_friction_step(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL torque,
    ECCENTRIC_REAL dt,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const real from_top = c2_asymmetric_from_top(theta_m, c);
    const real chord = c2_asymmetric_chord(from_top, c);
    c2_asymmetric_friction_step_at(omega_m, torque, dt, chord, out, c);
}

void c2_asymmetric_friction_step_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *torque,
    const ECCENTRIC_REAL *dt,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const c2_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = c2_asymmetric_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = c2_asymmetric_chord(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            c2_asymmetric_friction_step_at(omega_m[first + k], torque[first + k], dt[first + k], chord[k],
                &out[2u * (first + k)], &own);
        }
    }
}

REAL_INLINE real c2_asymmetric_acceleration_at(
    real omega_m,
    real torque,
    real chord,
    const c2_asymmetric_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real q = c->mu_omega_star * speed * chord;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = c2_asymmetric_square_root(square_difference * square_difference + q * q);
    /* levels of dry friction [N m] */
    const real upper = c->C_lN_pos_mu_scale_N * load + c->C_m_pos;
    const real slope_forward = c->B_lN_pos_mu2_scale_N * load + c->B_m_pos;
    const real lower = -c->C_lN_neg_mu_scale_N * load - c->C_m_neg;
    const real slope_backward = c->B_lN_neg_mu2_scale_N * load + c->B_m_neg;
    const real held_back = ((torque > upper) ? upper : ((torque < lower) ? lower : torque));
    const real starting = torque - held_back + REAL(0.0) * (upper - lower);
    const real part_3 = torque - upper;
    const real part_2 = ((omega_m > REAL(0.0)) ? part_3 : ((omega_m < REAL(0.0)) ? -lower + torque :
        starting));
    const real part_4 = -omega_m * ((omega_m > REAL(0.0)) ? slope_forward : slope_backward);
    const real part_1 = part_2 + part_4;
    return part_1 / REAL_GIVEN(c->J);
}

ECCENTRIC_REAL c2_asymmetric_acceleration(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL torque,
    const c2_asymmetric_coefficients *c)
{
    const real from_top = c2_asymmetric_from_top(theta_m, c);
    const real chord = c2_asymmetric_chord(from_top, c);
    return c2_asymmetric_acceleration_at(omega_m, torque, chord, c);
}

void c2_asymmetric_acceleration_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *torque,
    ECCENTRIC_REAL *out,
    const c2_asymmetric_coefficients *c)
{
    const c2_asymmetric_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = c2_asymmetric_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = c2_asymmetric_chord(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            out[first + k] = c2_asymmetric_acceleration_at(omega_m[first + k], torque[first + k], chord[k],
                &own);
        }
    }
}

#undef real
#undef REAL_INLINE
#undef REAL_BLOCK
#undef REAL
#undef REAL_GIVEN
#undef REAL_SQRT
#undef REAL_FABS
#undef REAL_IN_SINGLE
#undef REAL_ROUNDER
#undef REAL_SIN
#undef REAL_COS

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC pop_options
#endif

#endif
