/*
 * Generated: do not edit. Written by `make derive` from derivations/rotating_link.py
 * (eccentric 0.2.0b1, program 09c928c4).
 * Rotating link with an unbalanced mass, in a plane tilted by phi, with angular acceleration.
 */
#include "rotating_link.h"

#if !defined(__cplusplus) && (!defined(__STDC_VERSION__) || (__STDC_VERSION__ < 199901L))
#error "C99 or later is required: compile with -std=c99"
#else /* up to the end of the file, so that this is the only error */

#include <float.h>
#include <math.h>

#if ROTATING_LINK_PROGRAM != 0x09c928c4UL
#error "rotating_link.c and rotating_link.h are of different derivations: write both again"
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
extern const char rotating_link_double_constants[(sizeof(1.0) == sizeof(double)) ? 1 : -1];

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
REAL_INLINE real rotating_link_square_root(const real x)
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

REAL_INLINE real rotating_link_sgn(const real x)
{
    return (x > REAL(0.0)) ? REAL(1.0) : ((x < REAL(0.0)) ? REAL(-1.0) : (x + REAL(0.0)));
}

REAL_INLINE real rotating_link_within(const real x, const real most)
{
    const real below = (x > most) ? most : x;
    return (below < -most) ? -most : below;
}

/* sin(h)/h - 1, |h| within a quarter turn: minimax in x = h^2. */
REAL_INLINE real rotating_link_sine_ratio(const real h)
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
REAL_INLINE real rotating_link_cosine(const real h)
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
static double rotating_link_leading(const double x)
{
    const double scaled = x * REAL_IN_SINGLE(8796093022209.0, 1048577.0);
    return scaled - (scaled - x);
}

/* Motor angle from the nearest top of the link [rad]. */
REAL_INLINE real rotating_link_from_top(real theta_m, const rotating_link_coefficients *c)
{
    /* whole turns of the link plus a half, up to the nearest top */
    const real turns = theta_m * c->turns_per_rad - REAL(0.5) + REAL_ROUNDER - REAL_ROUNDER + REAL(0.5);
    /* the turns are subtracted in parts of few digits: all products but the last are exact */
    const real rest = theta_m - turns * c->period_1;
    const real left = rest - turns * c->period_2 - turns * c->period_3;
    const real reduced = REAL_IN_SINGLE(left - turns * c->period_4 - turns * c->period_5, left);
    /* bounded for angles too large to have any phase; infinity gives NaN */
    return rotating_link_within(reduced, c->period_1);
}

/* 2 sin(half the link angle from the top)/mu. */
REAL_INLINE real rotating_link_chord(real from_top, const rotating_link_coefficients *c)
{
    const real half_angle = from_top * c->half_mu;
    return from_top + from_top * rotating_link_sine_ratio(half_angle);
}

/* Cosine of half the link angle from the top. */
REAL_INLINE real rotating_link_half_sine(real from_top, const rotating_link_coefficients *c)
{
    const real half_angle = from_top * c->half_mu;
    return rotating_link_cosine(half_angle);
}

/* Numbers beyond double precision: unevaluated sums high + low, with results correct to some 104 bits. */
typedef struct {
    double high;
    double low;
} rotating_link_pair;

static rotating_link_pair rotating_link_exact(const double x)
{
    const rotating_link_pair result = {.high = x, .low = 0.0};
    return result;
}

/* a + b without error. */
static rotating_link_pair rotating_link_sum(const double a, const double b)
{
    const double high = a + b;
    const double part = high - a;
    const rotating_link_pair result = {.high = high, .low = (a - (high - part)) + (b - part)};
    return result;
}

/* a b without error: both factors are split into halves with exact products. */
static rotating_link_pair rotating_link_product(const double a, const double b)
{
    const double high = a * b;
    const double a_scaled = a * 134217729.0;
    const double b_scaled = b * 134217729.0;
    const double a_1 = a_scaled - (a_scaled - a);
    const double b_1 = b_scaled - (b_scaled - b);
    const double a_2 = a - a_1;
    const double b_2 = b - b_1;
    const rotating_link_pair result = {
        .high = high,
        .low = (((a_1 * b_1 - high) + a_1 * b_2) + a_2 * b_1) + a_2 * b_2,
    };
    return result;
}

static rotating_link_pair rotating_link_plus(const rotating_link_pair x, const rotating_link_pair y)
{
    const rotating_link_pair highs = rotating_link_sum(x.high, y.high);
    return rotating_link_sum(highs.high, highs.low + (x.low + y.low));
}

static rotating_link_pair rotating_link_times(const rotating_link_pair x, const rotating_link_pair y)
{
    const rotating_link_pair highs = rotating_link_product(x.high, y.high);
    return rotating_link_sum(highs.high, highs.low + (x.high * y.low + x.low * y.high));
}

static rotating_link_pair rotating_link_over(const rotating_link_pair x, const rotating_link_pair y)
{
    const double quotient = x.high / y.high;
    const rotating_link_pair taken = rotating_link_product(quotient, y.high);
    const double left = (((x.high - taken.high) - taken.low) + x.low) - quotient * y.low;
    return rotating_link_sum(quotient, left / y.high);
}

static rotating_link_pair rotating_link_root(const rotating_link_pair x)
{
    const double root = sqrt(x.high);
    const rotating_link_pair taken = rotating_link_product(root, root);
    const double left = ((x.high - taken.high) - taken.low) + x.low;
    return rotating_link_sum(root, (root > 0.0) ? (left / (2.0 * root)) : 0.0);
}

/* 2 pi - a b, for a b close to 2 pi. */
static rotating_link_pair rotating_link_turn_left(const double a, const double b)
{
    const rotating_link_pair taken = rotating_link_product(a, b);
    const rotating_link_pair first = rotating_link_sum(6.283185307179586 - taken.high, -taken.low);
    const rotating_link_pair second = rotating_link_sum(first.high, 2.4492935982947064e-16);
    return rotating_link_sum(second.high, second.low + (first.low - 5.989539619436679e-33));
}

const rotating_link_parameters rotating_link_default_parameters = {
    .M = 0.5, /* [kg] */
    .M_l = 0.2, /* [kg] */
    .L = 0.25, /* [m] */
    .mu = 0.2, /* [1] */
    .R = 1.0, /* [Ohm] */
    .k_i = 0.02, /* [N m/A] */
    .k_e = 0.2, /* [V s/rad] */
    .g = 9.81, /* [m/s^2] */
    .phi = 0.0, /* [rad] */
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

const rotating_link_coefficients rotating_link_default = {
#if ECCENTRIC_PRECISION == 1
    .B_lN = (real)(0.004),
    .C_lN = (real)(0.08),
    .k_i = (real)(0.02),
    .scale_N = (real)(0.005),
    .fastest = (real)(1.07374182e+9),
    .half_mu2_omega_star2 = (real)(27.468),
    .mu_omega_star2 = (real)(274.68),
    .per_mu = (real)(5.0),
    .fastest2 = (real)(1.1529215e+18),
    .turns_per_rad = (real)(0.0318309886),
    .period_1 = (real)(31.40625),
    .period_2 = (real)(0.00967407227),
    .period_3 = (real)(2.46241689e-6),
    .half_mu = (real)(0.1),
    .omega_star_1 = (real)(37.0594101),
    .omega_star_2 = (real)(1.66482255e-6),
    .B_lN_mu2_scale_N = (real)(8.0e-7),
    .B = (real)(4.0e-4),
    .B_plus_k_e_k_i_per_R = (real)(0.0044),
    .C_lN_mu_scale_N = (real)(8.0e-5),
    .C = (real)(0.008),
    .quarter_mu3_omega_star2 = (real)(2.7468),
    .mu2_omega_star2 = (real)(54.936),
    .mu2_scale_N = (real)(2.0e-4),
    .mu_scale_N = (real)(0.001),
    .F_T_mu2_sin_phi = (real)(0.0),
    .F_T_mu_sin_phi = (real)(0.0),
    .omega_star2 = (real)(1373.4),
    .L_M_g_p_mu2 = (real)(0.04905),
    .J = (real)(ECCENTRIC_NOT_GIVEN),
    .B_lN_R_mu2_scale_N_per_k_i = (real)(4.0e-5),
    .B_R_per_k_i_plus_k_e = (real)(0.22),
    .C_lN_R_mu_scale_N_per_k_i = (real)(0.004),
    .C_R_per_k_i = (real)(0.4),
    .R_per_k_i = (real)(50.0),
    .L_M_R_g_p_mu2_per_k_i = (real)(2.4525),
    .B_lN_mu2_scale_N_per_k_i = (real)(4.0e-5),
    .B_per_k_i = (real)(0.02),
    .per_k_i = (real)(50.0),
    .C_lN_mu_scale_N_per_k_i = (real)(0.004),
    .C_per_k_i = (real)(0.4),
    .L_M_g_p_mu2_per_k_i = (real)(2.4525),
    .k_i_per_R = (real)(0.02),
    .k_e_k_i_per_R = (real)(0.004),
    .period_4 = (real)(1.21508492e-9),
    .period_5 = (real)(3.35179719e-13),
#else
    .B_lN = 0.004,
    .C_lN = 0.08,
    .k_i = 0.02,
    .scale_N = 0.005,
    .fastest = 1.073741824e+9,
    .half_mu2_omega_star2 = 27.468,
    .mu_omega_star2 = 274.68,
    .per_mu = 5.0,
    .fastest2 = 1.152921504606847e+18,
    .turns_per_rad = 0.031830988618379067,
    .period_1 = 31.415926534682512,
    .period_2 = 1.2154201013692134e-9,
    .period_3 = -6.7974892272631429e-20,
    .half_mu = 0.1,
    .omega_star_1 = 37.05941176003742,
    .omega_star_2 = 1.9391227281942644e-15,
    .B_lN_mu2_scale_N = 8.0e-7,
    .B = 4.0e-4,
    .B_plus_k_e_k_i_per_R = 0.0044,
    .C_lN_mu_scale_N = 8.0e-5,
    .C = 0.008,
    .quarter_mu3_omega_star2 = 2.7468,
    .mu2_omega_star2 = 54.936,
    .mu2_scale_N = 2.0e-4,
    .mu_scale_N = 0.001,
    .F_T_mu2_sin_phi = 0.0,
    .F_T_mu_sin_phi = 0.0,
    .omega_star2 = 1373.4,
    .L_M_g_p_mu2 = 0.04905,
    .J = ECCENTRIC_NOT_GIVEN,
    .B_lN_R_mu2_scale_N_per_k_i = 4.0e-5,
    .B_R_per_k_i_plus_k_e = 0.22,
    .C_lN_R_mu_scale_N_per_k_i = 0.004,
    .C_R_per_k_i = 0.4,
    .R_per_k_i = 50.0,
    .L_M_R_g_p_mu2_per_k_i = 2.4525,
    .B_lN_mu2_scale_N_per_k_i = 4.0e-5,
    .B_per_k_i = 0.02,
    .per_k_i = 50.0,
    .C_lN_mu_scale_N_per_k_i = 0.004,
    .C_per_k_i = 0.4,
    .L_M_g_p_mu2_per_k_i = 2.4525,
    .k_i_per_R = 0.02,
    .k_e_k_i_per_R = 0.004,
#endif
};

int rotating_link_prepare(const rotating_link_parameters *p, rotating_link_coefficients *c)
{
    const rotating_link_pair g_p = rotating_link_times(rotating_link_exact(p->g),
        rotating_link_exact(fabs(cos(p->phi))));
    const rotating_link_pair weight = rotating_link_times(g_p, rotating_link_plus(rotating_link_exact(p->M),
        rotating_link_exact(p->M_l)));
    const rotating_link_pair critical_squared = (p->L * p->M == 0.0) ? rotating_link_exact(1.0) :
        (rotating_link_over(weight, rotating_link_times(rotating_link_exact(p->L),
        rotating_link_exact(p->M))));
    const rotating_link_pair omega_star = (p->L * p->M == 0.0) ? rotating_link_exact(1.0) :
        (rotating_link_over(rotating_link_root(critical_squared), rotating_link_exact(p->mu)));
    const double scale_N = (p->L * p->M == 0.0) ? weight.high / (omega_star.high * omega_star.high) : (p->L *
        p->M * p->mu * p->mu);
    const double fastest = (p->L * p->M == 0.0) ? 0.0 : (1073741824.0);
    const double half_mu2_omega_star2 = 0.5 * p->mu * p->mu * omega_star.high * omega_star.high;
    const double mu_omega_star2 = p->mu * omega_star.high * omega_star.high;
    const double per_mu = 1.0 / p->mu;
    const double fastest2 = fastest * fastest;
    const double turns_per_rad = 0.5 * p->mu / 3.1415926535897932;
    const double period_1 = rotating_link_leading(2.0 * 3.1415926535897932 / p->mu);
    const rotating_link_pair period_left = rotating_link_over(rotating_link_turn_left(period_1, p->mu),
        rotating_link_exact(p->mu));
    const double period_2 = rotating_link_leading(period_left.high);
    const double period_rest = period_left.high - period_2 + period_left.low;
    const double period_3 = REAL_IN_SINGLE(rotating_link_leading(period_rest), (double)(real)(period_rest));
    const double half_mu = 0.5 * p->mu;
    const double omega_star_1 = (double)(real)(omega_star.high);
    const double omega_star_2 = (double)(real)(omega_star.high - omega_star_1 + omega_star.low);
    const double B_lN_mu2_scale_N = p->B_lN * p->mu * p->mu * scale_N;
    const double B = p->B_lT * p->F_T * p->mu * p->mu * sin(p->phi) + p->B_m;
    const double B_plus_k_e_k_i_per_R = B + p->k_e * p->k_i / p->R;
    const double C_lN_mu_scale_N = p->C_lN * p->mu * scale_N;
    const double C = p->C_lT * p->F_T * p->mu * sin(p->phi) + p->C_m;
    const double quarter_mu3_omega_star2 = 0.25 * p->mu * p->mu * p->mu * omega_star.high * omega_star.high;
    const double mu2_omega_star2 = p->mu * p->mu * omega_star.high * omega_star.high;
    const double mu2_scale_N = p->mu * p->mu * scale_N;
    const double mu_scale_N = p->mu * scale_N;
    const double F_T_mu2_sin_phi = p->F_T * p->mu * p->mu * sin(p->phi);
    const double F_T_mu_sin_phi = p->F_T * p->mu * sin(p->phi);
    const double omega_star2 = omega_star.high * omega_star.high;
    const double L_M_g_p_mu2 = p->L * p->M * g_p.high * p->mu * p->mu;
    const double J = ((p->J_l == ECCENTRIC_NOT_GIVEN) || (p->J_m == ECCENTRIC_NOT_GIVEN)) ?
        ECCENTRIC_NOT_GIVEN : (p->J_l * p->mu * p->mu + p->J_m);
    const double B_lN_R_mu2_scale_N_per_k_i = p->B_lN * p->R * p->mu * p->mu * scale_N / p->k_i;
    const double B_R_per_k_i_plus_k_e = B * p->R / p->k_i + p->k_e;
    const double C_lN_R_mu_scale_N_per_k_i = p->C_lN * p->R * p->mu * scale_N / p->k_i;
    const double C_R_per_k_i = C * p->R / p->k_i;
    const double R_per_k_i = p->R / p->k_i;
    const double L_M_R_g_p_mu2_per_k_i = p->L * p->M * p->R * g_p.high * p->mu * p->mu / p->k_i;
    const double B_lN_mu2_scale_N_per_k_i = p->B_lN * p->mu * p->mu * scale_N / p->k_i;
    const double B_per_k_i = B / p->k_i;
    const double per_k_i = 1.0 / p->k_i;
    const double C_lN_mu_scale_N_per_k_i = p->C_lN * p->mu * scale_N / p->k_i;
    const double C_per_k_i = C / p->k_i;
    const double L_M_g_p_mu2_per_k_i = p->L * p->M * g_p.high * p->mu * p->mu / p->k_i;
    const double k_i_per_R = p->k_i / p->R;
    const double k_e_k_i_per_R = p->k_e * p->k_i / p->R;
    c->B_lN = (real)(p->B_lN);
    c->C_lN = (real)(p->C_lN);
    c->k_i = (real)(p->k_i);
    c->scale_N = (real)(scale_N);
    c->fastest = (real)(fastest);
    c->half_mu2_omega_star2 = (real)(half_mu2_omega_star2);
    c->mu_omega_star2 = (real)(mu_omega_star2);
    c->per_mu = (real)(per_mu);
    c->fastest2 = (real)(fastest2);
    c->turns_per_rad = (real)(turns_per_rad);
    c->period_1 = (real)(period_1);
    c->period_2 = (real)(period_2);
    c->period_3 = (real)(period_3);
    c->half_mu = (real)(half_mu);
    c->omega_star_1 = (real)(omega_star_1);
    c->omega_star_2 = (real)(omega_star_2);
    c->B_lN_mu2_scale_N = (real)(B_lN_mu2_scale_N);
    c->B = (real)(B);
    c->B_plus_k_e_k_i_per_R = (real)(B_plus_k_e_k_i_per_R);
    c->C_lN_mu_scale_N = (real)(C_lN_mu_scale_N);
    c->C = (real)(C);
    c->quarter_mu3_omega_star2 = (real)(quarter_mu3_omega_star2);
    c->mu2_omega_star2 = (real)(mu2_omega_star2);
    c->mu2_scale_N = (real)(mu2_scale_N);
    c->mu_scale_N = (real)(mu_scale_N);
    c->F_T_mu2_sin_phi = (real)(F_T_mu2_sin_phi);
    c->F_T_mu_sin_phi = (real)(F_T_mu_sin_phi);
    c->omega_star2 = (real)(omega_star2);
    c->L_M_g_p_mu2 = (real)(L_M_g_p_mu2);
    c->J = (real)(J);
    c->B_lN_R_mu2_scale_N_per_k_i = (real)(B_lN_R_mu2_scale_N_per_k_i);
    c->B_R_per_k_i_plus_k_e = (real)(B_R_per_k_i_plus_k_e);
    c->C_lN_R_mu_scale_N_per_k_i = (real)(C_lN_R_mu_scale_N_per_k_i);
    c->C_R_per_k_i = (real)(C_R_per_k_i);
    c->R_per_k_i = (real)(R_per_k_i);
    c->L_M_R_g_p_mu2_per_k_i = (real)(L_M_R_g_p_mu2_per_k_i);
    c->B_lN_mu2_scale_N_per_k_i = (real)(B_lN_mu2_scale_N_per_k_i);
    c->B_per_k_i = (real)(B_per_k_i);
    c->per_k_i = (real)(per_k_i);
    c->C_lN_mu_scale_N_per_k_i = (real)(C_lN_mu_scale_N_per_k_i);
    c->C_per_k_i = (real)(C_per_k_i);
    c->L_M_g_p_mu2_per_k_i = (real)(L_M_g_p_mu2_per_k_i);
    c->k_i_per_R = (real)(k_i_per_R);
    c->k_e_k_i_per_R = (real)(k_e_k_i_per_R);
#if ECCENTRIC_PRECISION == 1
    const double period_4 = rotating_link_leading(period_rest - period_3);
    const double period_last = period_rest - period_3 - period_4;
    const double period_5 = (double)(real)(period_last);
    c->period_4 = (real)(period_4);
    c->period_5 = (real)(period_5);
#endif
    int invalid = 0;
    invalid = (((p->J_l < 0.0) && (p->J_l != ECCENTRIC_NOT_GIVEN)) || (p->J_l > DBL_MAX)) ? 18 : invalid;
    invalid = (((p->J_m < 0.0) && (p->J_m != ECCENTRIC_NOT_GIVEN)) || (p->J_m > DBL_MAX)) ? 17 : invalid;
    invalid = (!((p->F_T >= 0.0) && (p->F_T <= DBL_MAX))) ? 16 : invalid;
    invalid = (!((p->C_m >= 0.0) && (p->C_m <= DBL_MAX))) ? 15 : invalid;
    invalid = (!((p->B_m >= 0.0) && (p->B_m <= DBL_MAX))) ? 14 : invalid;
    invalid = (!((p->C_lT >= 0.0) && (p->C_lT <= DBL_MAX))) ? 13 : invalid;
    invalid = (!((p->B_lT >= 0.0) && (p->B_lT <= DBL_MAX))) ? 12 : invalid;
    invalid = (!((p->C_lN >= 0.0) && (p->C_lN <= DBL_MAX))) ? 11 : invalid;
    invalid = (!((p->B_lN >= 0.0) && (p->B_lN <= DBL_MAX))) ? 10 : invalid;
    invalid = (!((p->phi >= 0.0) && (p->phi <= 1.5707964))) ? 9 : invalid;
    invalid = (!((p->g >= 0.0) && (p->g <= DBL_MAX))) ? 8 : invalid;
    invalid = (!((p->k_e >= 0.0) && (p->k_e <= DBL_MAX))) ? 7 : invalid;
    invalid = (!((p->k_i > 0.0) && (p->k_i <= DBL_MAX))) ? 6 : invalid;
    invalid = (!((p->R > 0.0) && (p->R <= DBL_MAX))) ? 5 : invalid;
    invalid = (!((p->mu > 0.0) && (p->mu <= DBL_MAX))) ? 4 : invalid;
    invalid = (!((p->L >= 0.0) && (p->L <= DBL_MAX))) ? 3 : invalid;
    invalid = (!((p->M_l >= 0.0) && (p->M_l <= DBL_MAX))) ? 2 : invalid;
    invalid = (!((p->M >= 0.0) && (p->M <= DBL_MAX))) ? 1 : invalid;
    if (invalid != 0) {
        const rotating_link_coefficients zero = {0};
        *c = zero;
    }
    return invalid;
}

REAL_INLINE real rotating_link_normal_force_at(
    real omega_m,
    real alpha_m,
    real chord,
    real half_sine,
    const rotating_link_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real size_2 = alpha_m * c->per_mu;
    const real p = chord * chord * c->half_mu2_omega_star2 + square_difference;
    const real part_1 = ((size_2 > c->fastest2) ? c->fastest2 : ((size_2 < -c->fastest2) ? -c->fastest2 :
        size_2));
    const real q = part_1 + (-c->mu_omega_star2) * chord * half_sine;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = rotating_link_square_root(p * p + q * q);
    return load * c->scale_N;
}

ECCENTRIC_REAL rotating_link_normal_force(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c)
{
    const real from_top = rotating_link_from_top(theta_m, c);
    const real chord = rotating_link_chord(from_top, c);
    const real half_sine = rotating_link_half_sine(from_top, c);
    return rotating_link_normal_force_at(omega_m, alpha_m, chord, half_sine, c);
}

void rotating_link_normal_force_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const rotating_link_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = rotating_link_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = rotating_link_chord(from_top[k], &own);
            half_sine[k] = rotating_link_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            out[first + k] = rotating_link_normal_force_at(omega_m[first + k], alpha_m[first + k], chord[k],
                half_sine[k], &own);
        }
    }
}

REAL_INLINE real rotating_link_friction_torque_at(
    real omega_m,
    real alpha_m,
    real chord,
    real half_sine,
    const rotating_link_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real size_2 = alpha_m * c->per_mu;
    const real p = chord * chord * c->half_mu2_omega_star2 + square_difference;
    const real part_1 = ((size_2 > c->fastest2) ? c->fastest2 : ((size_2 < -c->fastest2) ? -c->fastest2 :
        size_2));
    const real q = part_1 + (-c->mu_omega_star2) * chord * half_sine;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = rotating_link_square_root(p * p + q * q);
    const real direction_of_motion = rotating_link_sgn(omega_m);
    const real part_2 = omega_m * (c->B_lN_mu2_scale_N * load + c->B_plus_k_e_k_i_per_R);
    return direction_of_motion * (c->C + c->C_lN_mu_scale_N * load) + part_2;
}

ECCENTRIC_REAL rotating_link_friction_torque(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c)
{
    const real from_top = rotating_link_from_top(theta_m, c);
    const real chord = rotating_link_chord(from_top, c);
    const real half_sine = rotating_link_half_sine(from_top, c);
    return rotating_link_friction_torque_at(omega_m, alpha_m, chord, half_sine, c);
}

void rotating_link_friction_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const rotating_link_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = rotating_link_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = rotating_link_chord(from_top[k], &own);
            half_sine[k] = rotating_link_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            out[first + k] = rotating_link_friction_torque_at(omega_m[first + k], alpha_m[first + k],
                chord[k], half_sine[k], &own);
        }
    }
}

REAL_INLINE real rotating_link_mechanical_friction_torque_at(
    real omega_m,
    real alpha_m,
    real chord,
    real half_sine,
    const rotating_link_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real size_2 = alpha_m * c->per_mu;
    const real p = chord * chord * c->half_mu2_omega_star2 + square_difference;
    const real part_1 = ((size_2 > c->fastest2) ? c->fastest2 : ((size_2 < -c->fastest2) ? -c->fastest2 :
        size_2));
    const real q = part_1 + (-c->mu_omega_star2) * chord * half_sine;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = rotating_link_square_root(p * p + q * q);
    const real direction_of_motion = rotating_link_sgn(omega_m);
    const real part_2 = direction_of_motion * (c->C + c->C_lN_mu_scale_N * load);
    return omega_m * (c->B + c->B_lN_mu2_scale_N * load) + part_2;
}

ECCENTRIC_REAL rotating_link_mechanical_friction_torque(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c)
{
    const real from_top = rotating_link_from_top(theta_m, c);
    const real chord = rotating_link_chord(from_top, c);
    const real half_sine = rotating_link_half_sine(from_top, c);
    return rotating_link_mechanical_friction_torque_at(omega_m, alpha_m, chord, half_sine, c);
}

void rotating_link_mechanical_friction_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const rotating_link_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = rotating_link_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = rotating_link_chord(from_top[k], &own);
            half_sine[k] = rotating_link_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            out[first + k] = rotating_link_mechanical_friction_torque_at(omega_m[first + k], alpha_m[first +
                k], chord[k], half_sine[k], &own);
        }
    }
}

REAL_INLINE void rotating_link_friction_torque_gradient_at(
    real omega_m,
    real alpha_m,
    real chord,
    real half_sine,
    real *out,
    const rotating_link_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    const real direction_of_motion = rotating_link_sgn(omega_m);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real size_2 = alpha_m * c->per_mu;
    const real p = chord * chord * c->half_mu2_omega_star2 + square_difference;
    const real part_1 = ((size_2 > c->fastest2) ? c->fastest2 : ((size_2 < -c->fastest2) ? -c->fastest2 :
        size_2));
    const real q = part_1 + (-c->mu_omega_star2) * chord * half_sine;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = rotating_link_square_root(p * p + q * q);
    /* 1 at the apex, where F_N is 0 and its derivatives are taken as 0 */
    const real inverse = ((load == REAL(0.0)) ? REAL(1.0) : REAL(1.0) / load);
    const real part_2 = c->mu2_omega_star2 * (p * inverse) * chord * half_sine;
    const real part_3 = chord * chord * c->quarter_mu3_omega_star2 * (q * inverse);
    const real part_4 = -half_sine * half_sine * c->mu_omega_star2 * (q * inverse);
    const real load_d_theta_m = part_2 + part_3 + part_4;
    const real load_d_omega_m = REAL(2.0) * direction_of_motion * speed * (p * inverse);
    const real load_d_alpha_m = c->per_mu * (q * inverse);
    const real part_5 = c->B_lN_mu2_scale_N * omega_m + c->C_lN_mu_scale_N * direction_of_motion;
    out[0] = load_d_theta_m * part_5;
    const real part_6 = load_d_omega_m * part_5;
    out[1] = c->B_lN_mu2_scale_N * load + c->B_plus_k_e_k_i_per_R + part_6;
    out[2] = load_d_alpha_m * part_5;
}

void rotating_link_friction_torque_gradient(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const real from_top = rotating_link_from_top(theta_m, c);
    const real chord = rotating_link_chord(from_top, c);
    const real half_sine = rotating_link_half_sine(from_top, c);
    rotating_link_friction_torque_gradient_at(omega_m, alpha_m, chord, half_sine, out, c);
}

void rotating_link_friction_torque_gradient_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const rotating_link_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = rotating_link_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = rotating_link_chord(from_top[k], &own);
            half_sine[k] = rotating_link_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            rotating_link_friction_torque_gradient_at(omega_m[first + k], alpha_m[first + k], chord[k],
                half_sine[k], &out[3u * (first + k)], &own);
        }
    }
}

REAL_INLINE void rotating_link_friction_torque_with_gradient_at(
    real omega_m,
    real alpha_m,
    real chord,
    real half_sine,
    real *out,
    const rotating_link_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    const real direction_of_motion = rotating_link_sgn(omega_m);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real size_2 = alpha_m * c->per_mu;
    const real p = chord * chord * c->half_mu2_omega_star2 + square_difference;
    const real part_1 = ((size_2 > c->fastest2) ? c->fastest2 : ((size_2 < -c->fastest2) ? -c->fastest2 :
        size_2));
    const real q = part_1 + (-c->mu_omega_star2) * chord * half_sine;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = rotating_link_square_root(p * p + q * q);
    /* 1 at the apex, where F_N is 0 and its derivatives are taken as 0 */
    const real inverse = ((load == REAL(0.0)) ? REAL(1.0) : REAL(1.0) / load);
    const real part_2 = c->mu2_omega_star2 * (p * inverse) * chord * half_sine;
    const real part_3 = chord * chord * c->quarter_mu3_omega_star2 * (q * inverse);
    const real part_4 = -half_sine * half_sine * c->mu_omega_star2 * (q * inverse);
    const real load_d_theta_m = part_2 + part_3 + part_4;
    const real load_d_omega_m = REAL(2.0) * direction_of_motion * speed * (p * inverse);
    const real load_d_alpha_m = c->per_mu * (q * inverse);
    const real part_5 = omega_m * (c->B_lN_mu2_scale_N * load + c->B_plus_k_e_k_i_per_R);
    const real part_6 = direction_of_motion * (c->C + c->C_lN_mu_scale_N * load);
    out[0] = part_5 + part_6;
    const real part_7 = c->B_lN_mu2_scale_N * omega_m + c->C_lN_mu_scale_N * direction_of_motion;
    out[1] = load_d_theta_m * part_7;
    const real part_8 = load_d_omega_m * part_7;
    out[2] = c->B_lN_mu2_scale_N * load + c->B_plus_k_e_k_i_per_R + part_8;
    out[3] = load_d_alpha_m * part_7;
}

void rotating_link_friction_torque_with_gradient(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const real from_top = rotating_link_from_top(theta_m, c);
    const real chord = rotating_link_chord(from_top, c);
    const real half_sine = rotating_link_half_sine(from_top, c);
    rotating_link_friction_torque_with_gradient_at(omega_m, alpha_m, chord, half_sine, out, c);
}

void rotating_link_friction_torque_with_gradient_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const rotating_link_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = rotating_link_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = rotating_link_chord(from_top[k], &own);
            half_sine[k] = rotating_link_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            rotating_link_friction_torque_with_gradient_at(omega_m[first + k], alpha_m[first + k], chord[k],
                half_sine[k], &out[4u * (first + k)], &own);
        }
    }
}

REAL_INLINE void rotating_link_friction_torque_jacobian_at(
    real omega_m,
    real alpha_m,
    real chord,
    real half_sine,
    real *out,
    const rotating_link_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real size_2 = alpha_m * c->per_mu;
    const real p = chord * chord * c->half_mu2_omega_star2 + square_difference;
    const real part_1 = ((size_2 > c->fastest2) ? c->fastest2 : ((size_2 < -c->fastest2) ? -c->fastest2 :
        size_2));
    const real q = part_1 + (-c->mu_omega_star2) * chord * half_sine;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = rotating_link_square_root(p * p + q * q);
    out[0] = load * c->mu2_scale_N * omega_m;
    const real direction_of_motion = rotating_link_sgn(omega_m);
    out[1] = direction_of_motion * load * c->mu_scale_N;
    out[2] = c->F_T_mu2_sin_phi * omega_m;
    out[3] = c->F_T_mu_sin_phi * direction_of_motion;
    out[4] = omega_m;
    out[5] = direction_of_motion;
}

void rotating_link_friction_torque_jacobian(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const real from_top = rotating_link_from_top(theta_m, c);
    const real chord = rotating_link_chord(from_top, c);
    const real half_sine = rotating_link_half_sine(from_top, c);
    rotating_link_friction_torque_jacobian_at(omega_m, alpha_m, chord, half_sine, out, c);
}

void rotating_link_friction_torque_jacobian_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const rotating_link_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = rotating_link_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = rotating_link_chord(from_top[k], &own);
            half_sine[k] = rotating_link_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            rotating_link_friction_torque_jacobian_at(omega_m[first + k], alpha_m[first + k], chord[k],
                half_sine[k], &out[6u * (first + k)], &own);
        }
    }
}

REAL_INLINE void rotating_link_regressor_at(
    real omega_m,
    real alpha_m,
    real chord,
    real half_sine,
    real *out,
    const rotating_link_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real size_2 = alpha_m * c->per_mu;
    const real p = chord * chord * c->half_mu2_omega_star2 + square_difference;
    const real part_1 = ((size_2 > c->fastest2) ? c->fastest2 : ((size_2 < -c->fastest2) ? -c->fastest2 :
        size_2));
    const real q = part_1 + (-c->mu_omega_star2) * chord * half_sine;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = rotating_link_square_root(p * p + q * q);
    out[0] = load * c->mu2_scale_N * omega_m;
    const real direction_of_motion = rotating_link_sgn(omega_m);
    out[1] = direction_of_motion * load * c->mu_scale_N;
    out[2] = omega_m;
    out[3] = direction_of_motion;
}

void rotating_link_regressor(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const real from_top = rotating_link_from_top(theta_m, c);
    const real chord = rotating_link_chord(from_top, c);
    const real half_sine = rotating_link_half_sine(from_top, c);
    rotating_link_regressor_at(omega_m, alpha_m, chord, half_sine, out, c);
}

void rotating_link_regressor_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const rotating_link_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = rotating_link_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = rotating_link_chord(from_top[k], &own);
            half_sine[k] = rotating_link_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            rotating_link_regressor_at(omega_m[first + k], alpha_m[first + k], chord[k], half_sine[k], &out[4u
                * (first + k)], &own);
        }
    }
}

void rotating_link_friction_coefficients(ECCENTRIC_REAL *out, const rotating_link_coefficients *c)
{
    out[0] = c->B_lN;
    out[1] = c->C_lN;
    out[2] = c->B;
    out[3] = c->C;
}

REAL_INLINE void rotating_link_breakaway_torque_at(
    real chord,
    real half_sine,
    real *out,
    const rotating_link_coefficients *c)
{
    const real p = chord * chord * c->half_mu2_omega_star2 - c->omega_star2;
    const real q = (-c->mu_omega_star2) * chord * half_sine;
    const real magnitude = rotating_link_square_root(p * p + q * q);
    out[0] = -c->C - c->C_lN_mu_scale_N * magnitude;
    out[1] = c->C + c->C_lN_mu_scale_N * magnitude;
}

void rotating_link_breakaway_torque(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const real from_top = rotating_link_from_top(theta_m, c);
    const real chord = rotating_link_chord(from_top, c);
    const real half_sine = rotating_link_half_sine(from_top, c);
    rotating_link_breakaway_torque_at(chord, half_sine, out, c);
}

void rotating_link_breakaway_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const rotating_link_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = rotating_link_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = rotating_link_chord(from_top[k], &own);
            half_sine[k] = rotating_link_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            rotating_link_breakaway_torque_at(chord[k], half_sine[k], &out[2u * (first + k)], &own);
        }
    }
}

REAL_INLINE void rotating_link_friction_budget_at(
    real omega_m,
    real alpha_m,
    real chord,
    real half_sine,
    real *out,
    const rotating_link_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real size_2 = alpha_m * c->per_mu;
    const real p = chord * chord * c->half_mu2_omega_star2 + square_difference;
    const real part_1 = ((size_2 > c->fastest2) ? c->fastest2 : ((size_2 < -c->fastest2) ? -c->fastest2 :
        size_2));
    const real q = part_1 + (-c->mu_omega_star2) * chord * half_sine;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = rotating_link_square_root(p * p + q * q);
    out[0] = -c->C - c->C_lN_mu_scale_N * load;
    out[1] = c->C + c->C_lN_mu_scale_N * load;
    out[2] = c->B + c->B_lN_mu2_scale_N * load;
}

void rotating_link_friction_budget(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const real from_top = rotating_link_from_top(theta_m, c);
    const real chord = rotating_link_chord(from_top, c);
    const real half_sine = rotating_link_half_sine(from_top, c);
    rotating_link_friction_budget_at(omega_m, alpha_m, chord, half_sine, out, c);
}

void rotating_link_friction_budget_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const rotating_link_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = rotating_link_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = rotating_link_chord(from_top[k], &own);
            half_sine[k] = rotating_link_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            rotating_link_friction_budget_at(omega_m[first + k], alpha_m[first + k], chord[k], half_sine[k],
                &out[3u * (first + k)], &own);
        }
    }
}

REAL_INLINE real rotating_link_gravity_torque_at(
    real chord,
    real half_sine,
    const rotating_link_coefficients *c)
{
    return (-c->L_M_g_p_mu2) * chord * half_sine;
}

ECCENTRIC_REAL rotating_link_gravity_torque(ECCENTRIC_REAL theta_m, const rotating_link_coefficients *c)
{
    const real from_top = rotating_link_from_top(theta_m, c);
    const real chord = rotating_link_chord(from_top, c);
    const real half_sine = rotating_link_half_sine(from_top, c);
    return rotating_link_gravity_torque_at(chord, half_sine, c);
}

void rotating_link_gravity_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const rotating_link_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = rotating_link_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = rotating_link_chord(from_top[k], &own);
            half_sine[k] = rotating_link_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            out[first + k] = rotating_link_gravity_torque_at(chord[k], half_sine[k], &own);
        }
    }
}

REAL_INLINE real rotating_link_voltage_at(
    real omega_m,
    real alpha_m,
    real chord,
    real half_sine,
    const rotating_link_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real size_2 = alpha_m * c->per_mu;
    const real p = chord * chord * c->half_mu2_omega_star2 + square_difference;
    const real part_1 = ((size_2 > c->fastest2) ? c->fastest2 : ((size_2 < -c->fastest2) ? -c->fastest2 :
        size_2));
    const real q = part_1 + (-c->mu_omega_star2) * chord * half_sine;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = rotating_link_square_root(p * p + q * q);
    const real direction_of_motion = rotating_link_sgn(omega_m);
    const real part_3 = c->C_R_per_k_i + c->C_lN_R_mu_scale_N_per_k_i * load;
    const real part_2 = direction_of_motion * part_3;
    const real part_4 = omega_m * (c->B_R_per_k_i_plus_k_e + c->B_lN_R_mu2_scale_N_per_k_i * load);
    const real part_5 = (-c->L_M_R_g_p_mu2_per_k_i) * chord * half_sine;
    const real part_6 = c->R_per_k_i * ((alpha_m == REAL(0.0)) ? REAL(0.0) : REAL_GIVEN(c->J) * alpha_m);
    return part_2 + part_4 + part_5 + part_6;
}

ECCENTRIC_REAL rotating_link_voltage(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c)
{
    const real from_top = rotating_link_from_top(theta_m, c);
    const real chord = rotating_link_chord(from_top, c);
    const real half_sine = rotating_link_half_sine(from_top, c);
    return rotating_link_voltage_at(omega_m, alpha_m, chord, half_sine, c);
}

void rotating_link_voltage_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const rotating_link_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = rotating_link_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = rotating_link_chord(from_top[k], &own);
            half_sine[k] = rotating_link_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            out[first + k] = rotating_link_voltage_at(omega_m[first + k], alpha_m[first + k], chord[k],
                half_sine[k], &own);
        }
    }
}

REAL_INLINE real rotating_link_current_at(
    real omega_m,
    real alpha_m,
    real chord,
    real half_sine,
    const rotating_link_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real size_2 = alpha_m * c->per_mu;
    const real p = chord * chord * c->half_mu2_omega_star2 + square_difference;
    const real part_1 = ((size_2 > c->fastest2) ? c->fastest2 : ((size_2 < -c->fastest2) ? -c->fastest2 :
        size_2));
    const real q = part_1 + (-c->mu_omega_star2) * chord * half_sine;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = rotating_link_square_root(p * p + q * q);
    const real direction_of_motion = rotating_link_sgn(omega_m);
    const real part_2 = direction_of_motion * (c->C_lN_mu_scale_N_per_k_i * load + c->C_per_k_i);
    const real part_3 = (-c->L_M_g_p_mu2_per_k_i) * chord * half_sine;
    const real part_4 = omega_m * (c->B_lN_mu2_scale_N_per_k_i * load + c->B_per_k_i);
    const real part_5 = c->per_k_i * ((alpha_m == REAL(0.0)) ? REAL(0.0) : REAL_GIVEN(c->J) * alpha_m);
    return part_2 + part_3 + part_4 + part_5;
}

ECCENTRIC_REAL rotating_link_current(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c)
{
    const real from_top = rotating_link_from_top(theta_m, c);
    const real chord = rotating_link_chord(from_top, c);
    const real half_sine = rotating_link_half_sine(from_top, c);
    return rotating_link_current_at(omega_m, alpha_m, chord, half_sine, c);
}

void rotating_link_current_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const rotating_link_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = rotating_link_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = rotating_link_chord(from_top[k], &own);
            half_sine[k] = rotating_link_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            out[first + k] = rotating_link_current_at(omega_m[first + k], alpha_m[first + k], chord[k],
                half_sine[k], &own);
        }
    }
}

REAL_INLINE real rotating_link_mechanical_residual_at(
    real omega_m,
    real i,
    real alpha_m,
    real chord,
    real half_sine,
    const rotating_link_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real size_2 = alpha_m * c->per_mu;
    const real p = chord * chord * c->half_mu2_omega_star2 + square_difference;
    const real part_1 = ((size_2 > c->fastest2) ? c->fastest2 : ((size_2 < -c->fastest2) ? -c->fastest2 :
        size_2));
    const real q = part_1 + (-c->mu_omega_star2) * chord * half_sine;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = rotating_link_square_root(p * p + q * q);
    const real direction_of_motion = rotating_link_sgn(omega_m);
    const real part_2 = -direction_of_motion * (c->C + c->C_lN_mu_scale_N * load);
    const real part_3 = c->L_M_g_p_mu2 * chord * half_sine;
    const real part_4 = -((alpha_m == REAL(0.0)) ? REAL(0.0) : REAL_GIVEN(c->J) * alpha_m);
    const real part_5 = -omega_m * (c->B + c->B_lN_mu2_scale_N * load);
    return i * c->k_i + part_2 + part_3 + part_4 + part_5;
}

ECCENTRIC_REAL rotating_link_mechanical_residual(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL i,
    ECCENTRIC_REAL alpha_m,
    const rotating_link_coefficients *c)
{
    const real from_top = rotating_link_from_top(theta_m, c);
    const real chord = rotating_link_chord(from_top, c);
    const real half_sine = rotating_link_half_sine(from_top, c);
    return rotating_link_mechanical_residual_at(omega_m, i, alpha_m, chord, half_sine, c);
}

void rotating_link_mechanical_residual_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *i,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const rotating_link_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = rotating_link_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = rotating_link_chord(from_top[k], &own);
            half_sine[k] = rotating_link_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            out[first + k] = rotating_link_mechanical_residual_at(omega_m[first + k], i[first + k],
                alpha_m[first + k], chord[k], half_sine[k], &own);
        }
    }
}

REAL_INLINE real rotating_link_electrical_residual_at(
    real omega_m,
    real i,
    real u,
    const rotating_link_coefficients *c)
{
    return -i * c->k_i - c->k_e_k_i_per_R * omega_m + c->k_i_per_R * u;
}

ECCENTRIC_REAL rotating_link_electrical_residual(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL i,
    ECCENTRIC_REAL u,
    const rotating_link_coefficients *c)
{
    return rotating_link_electrical_residual_at(omega_m, i, u, c);
}

void rotating_link_electrical_residual_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *i,
    const ECCENTRIC_REAL *u,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const rotating_link_coefficients own = *c; /* a copy that no store to `out` can change */
    for (size_t k = 0; k < n; ++k) {
        out[k] = rotating_link_electrical_residual_at(omega_m[k], i[k], u[k], &own);
    }
}

REAL_INLINE void rotating_link_friction_step_at(
    real omega_m,
    real alpha_m,
    real torque,
    real dt,
    real chord,
    real half_sine,
    real *out,
    const rotating_link_coefficients *c)
{
    /* time step, at least the shortest [s] */
    const real elapsed = ((REAL(1.0e-9) > dt) ? REAL(1.0e-9) : dt);
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real size_2 = alpha_m * c->per_mu;
    const real p = chord * chord * c->half_mu2_omega_star2 + square_difference;
    const real part_1 = ((size_2 > c->fastest2) ? c->fastest2 : ((size_2 < -c->fastest2) ? -c->fastest2 :
        size_2));
    const real q = part_1 + (-c->mu_omega_star2) * chord * half_sine;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = rotating_link_square_root(p * p + q * q);
    /* levels of dry friction [N m] */
    const real upper = c->C + c->C_lN_mu_scale_N * load;
    const real slope = c->B + c->B_lN_mu2_scale_N * load;
    /* momentum at the end of the step, if there were no friction [N m s] */
    const real momentum = REAL_GIVEN(c->J) * omega_m + elapsed * torque;
    const real highest = elapsed * upper;
    const real held_back = rotating_link_within(momentum, highest);
    /* its part that friction at rest does not take up [N m s] */
    const real excess = momentum - held_back + REAL(0.0) * highest;
    const real base = REAL_GIVEN(c->J) + elapsed * slope;
    const real velocity_after = excess / base;
    const real unlimited = momentum / elapsed;
    const real dry = rotating_link_within(unlimited, upper);
    out[0] = ((dt < REAL(1.0e-9)) ? omega_m : velocity_after);
    const real part_2 = dry + slope * velocity_after;
    out[1] = ((dt < REAL(1.0e-9)) ? REAL(0.0) : part_2);
}

void rotating_link_friction_step(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    ECCENTRIC_REAL torque,
    ECCENTRIC_REAL dt,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const real from_top = rotating_link_from_top(theta_m, c);
    const real chord = rotating_link_chord(from_top, c);
    const real half_sine = rotating_link_half_sine(from_top, c);
    rotating_link_friction_step_at(omega_m, alpha_m, torque, dt, chord, half_sine, out, c);
}

void rotating_link_friction_step_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    const ECCENTRIC_REAL *torque,
    const ECCENTRIC_REAL *dt,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const rotating_link_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = rotating_link_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = rotating_link_chord(from_top[k], &own);
            half_sine[k] = rotating_link_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            rotating_link_friction_step_at(omega_m[first + k], alpha_m[first + k], torque[first + k], dt[first
                + k], chord[k], half_sine[k], &out[2u * (first + k)], &own);
        }
    }
}

REAL_INLINE real rotating_link_acceleration_at(
    real omega_m,
    real alpha_m,
    real torque,
    real chord,
    real half_sine,
    const rotating_link_coefficients *c)
{
    const real size = REAL_FABS(omega_m);
    /* magnitude of the motor velocity, at most 2^30, 0 if M L = 0 [rad/s] */
    const real speed = ((size > c->fastest) ? c->fastest : size);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    const real size_2 = alpha_m * c->per_mu;
    const real p = chord * chord * c->half_mu2_omega_star2 + square_difference;
    const real part_1 = ((size_2 > c->fastest2) ? c->fastest2 : ((size_2 < -c->fastest2) ? -c->fastest2 :
        size_2));
    const real q = part_1 + (-c->mu_omega_star2) * chord * half_sine;
    /* normal force over scale_N [rad^2/s^2] */
    const real load = rotating_link_square_root(p * p + q * q);
    /* levels of dry friction [N m] */
    const real upper = c->C + c->C_lN_mu_scale_N * load;
    const real slope = c->B + c->B_lN_mu2_scale_N * load;
    const real held_back = rotating_link_within(torque, upper);
    const real starting = torque - held_back + REAL(0.0) * upper;
    const real part_4 = torque - upper;
    const real part_3 = ((omega_m > REAL(0.0)) ? part_4 : ((omega_m < REAL(0.0)) ? torque + upper :
        starting));
    const real part_2 = -omega_m * slope + part_3;
    return part_2 / REAL_GIVEN(c->J);
}

ECCENTRIC_REAL rotating_link_acceleration(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    ECCENTRIC_REAL torque,
    const rotating_link_coefficients *c)
{
    const real from_top = rotating_link_from_top(theta_m, c);
    const real chord = rotating_link_chord(from_top, c);
    const real half_sine = rotating_link_half_sine(from_top, c);
    return rotating_link_acceleration_at(omega_m, alpha_m, torque, chord, half_sine, c);
}

void rotating_link_acceleration_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    const ECCENTRIC_REAL *torque,
    ECCENTRIC_REAL *out,
    const rotating_link_coefficients *c)
{
    const rotating_link_coefficients own = *c; /* a copy that no store to `out` can change */
    real from_top[REAL_BLOCK];
    real chord[REAL_BLOCK];
    real half_sine[REAL_BLOCK];
    for (size_t first = 0; first < n; first += REAL_BLOCK) {
        const size_t count = (n - first < REAL_BLOCK) ? (n - first) : REAL_BLOCK;
        for (size_t k = 0; k < count; ++k) {
            from_top[k] = rotating_link_from_top(theta_m[first + k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            chord[k] = rotating_link_chord(from_top[k], &own);
            half_sine[k] = rotating_link_half_sine(from_top[k], &own);
        }
        for (size_t k = 0; k < count; ++k) {
            out[first + k] = rotating_link_acceleration_at(omega_m[first + k], alpha_m[first + k],
                torque[first + k], chord[k], half_sine[k], &own);
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
