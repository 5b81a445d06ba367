/*
 * Generated: do not edit. Written by `make derive` from derivations/c2_parallel.py
 * (eccentric 0.1.0, program 70a139fb).
 * Case C2: gravity parallel to the motion plane, steady motion.
 */
#include "c2_parallel.h"

#include <float.h>
#include <math.h>

#if C2_PARALLEL_PROGRAM != 0x70a139fbUL
#error "c2_parallel.c and c2_parallel.h are of different derivations: write both again"
#endif

#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || \
    (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "-ffast-math undoes the split of parameters into leading and further digits, and drops NaN"
#endif

/* Short names for this file alone, taken back at its end: several models may share a translation unit. */
#define real ECCENTRIC_REAL
#if ECCENTRIC_PRECISION == 1
#define REAL(x) x##f
#define REAL_SQRT(x) sqrtf(x)
#define REAL_FABS(x) fabsf(x)
#define REAL_FLOOR(x) floorf(x)
#define REAL_LARGEST FLT_MAX
#else
#define REAL(x) x
#define REAL_SQRT(x) sqrt(x)
#define REAL_FABS(x) fabs(x)
#define REAL_FLOOR(x) floor(x)
#define REAL_LARGEST DBL_MAX
#endif

static inline real c2_parallel_sgn(const real x)
{
    return (x > REAL(0.0)) ? REAL(1.0) : ((x < REAL(0.0)) ? REAL(-1.0) : ((x == REAL(0.0)) ? REAL(0.0) : x));
}

/* sin(h)/h at x = h^2, |h| within a quarter turn; error of the fit 4.3e-9 and 2.1e-19. */
static inline real c2_parallel_sine_series(const real x)
{
#if ECCENTRIC_PRECISION == 1
    real value = REAL(2.60481395e-6);
    value = value * x + REAL(-1.98088904e-4);
    value = value * x + REAL(8.33304849e-3);
    value = value * x + REAL(-1.66666579e-1);
    return value * x + REAL(9.99999996e-1);
#else
    real value = REAL(2.7213978552799456e-15);
    value = value * x + REAL(-7.6430101545396992e-13);
    value = value * x + REAL(1.6058940263949843e-10);
    value = value * x + REAL(-2.5052106878642193e-8);
    value = value * x + REAL(2.7557319211102121e-6);
    value = value * x + REAL(-1.984126984120794e-4);
    value = value * x + REAL(8.3333333333331843e-3);
    value = value * x + REAL(-1.6666666666666665e-1);
    return value * x + REAL(1.0);
#endif
}

/* cos(h) at x = h^2, |h| within a quarter turn; error of the fit 2.2e-10 and 4.0e-18. */
static inline real c2_parallel_cosine_series(const real x)
{
#if ECCENTRIC_PRECISION == 1
    real value = REAL(-2.6047719e-7);
    value = value * x + REAL(2.47599463e-5);
    value = value * x + REAL(-1.38883571e-3);
    value = value * x + REAL(4.16666359e-2);
    value = value * x + REAL(-4.99999993e-1);
    return value * x + REAL(1.0);
#else
    real value = REAL(4.608641632733578e-14);
    value = value * x + REAL(-1.1462870836348485e-11);
    value = value * x + REAL(2.0876560676087604e-9);
    value = value * x + REAL(-2.7557316368436772e-7);
    value = value * x + REAL(2.4801587277173477e-5);
    value = value * x + REAL(-1.3888888888771598e-3);
    value = value * x + REAL(4.1666666666663843e-2);
    value = value * x + REAL(-4.9999999999999974e-1);
    return value * x + REAL(1.0);
#endif
}

/* The leading digits of x, so few that an odd number of half turns times them is exact. */
static inline double c2_parallel_leading(const double x)
{
    const double scaled = x * (ECCENTRIC_PRECISION == 1 ? 4398046511105.0 : 1048577.0);
    return scaled - (scaled - x);
}

const c2_parallel_parameters c2_parallel_default_parameters = {
    0.5, /* M [kg] */
    0.2, /* M_l [kg] */
    0.25, /* L [m] */
    0.2, /* mu [1] */
    1.0, /* R [Ohm] */
    0.02, /* k_i [N m/A] */
    0.2, /* k_e [V s/rad] */
    9.81, /* g [m/s^2] */
    0.004, /* B_lN [m s/rad] */
    0.08, /* C_lN [m] */
    4.0e-4, /* B_m [N m s/rad] */
    0.008, /* C_m [N m] */
    NAN, /* J_m [kg m^2] */
    NAN, /* J_l [kg m^2] */
};

const c2_parallel_coefficients c2_parallel_default = {
#if ECCENTRIC_PRECISION == 1
    (real)(0.004), /* B_lN */
    (real)(4.0e-4), /* B_m */
    (real)(0.08), /* C_lN */
    (real)(0.008), /* C_m */
    (real)(0.02), /* k_i */
    (real)(0.2), /* mu */
    (real)(0.005), /* scale_N */
    (real)(1.0), /* unbalanced */
    (real)(74.1188235), /* twice_omega_star */
    (real)(37.0594101), /* omega_star_1 */
    (real)(1.66482255e-6), /* omega_star_2 */
    (real)(15.7109375), /* half_period_1 */
    (real)(-0.00297355652), /* half_period_2 */
    (real)(-6.75532476e-7), /* half_period_3 */
    (real)(0.0318309886), /* turns_per_rad */
    (real)(0.1), /* half_mu */
    (real)(31.4159265), /* period */
    (real)(1.6e-4), /* B_lN_mu2 */
    (real)(0.0044), /* B_m_plus_k_e_k_i_per_R */
    (real)(0.016), /* C_lN_mu */
    (real)(0.0370594118), /* mu_omega_star_scale_N */
    (real)(0.04), /* mu2 */
    (real)(0.117872), /* C_lN_mu_weight_plus_C_m */
    (real)(0.4905), /* twice_L_M_g_mu */
    (real)(NAN), /* J */
    (real)(0.008), /* B_lN_R_mu2_per_k_i */
    (real)(0.22), /* B_m_R_per_k_i_plus_k_e */
    (real)(0.8), /* C_lN_R_mu_per_k_i */
    (real)(0.4), /* C_m_R_per_k_i */
    (real)(50.0), /* R_per_k_i */
    (real)(24.525), /* twice_L_M_R_g_mu_per_k_i */
    (real)(0.008), /* B_lN_mu2_per_k_i */
    (real)(0.02), /* B_m_per_k_i */
    (real)(50.0), /* per_k_i */
    (real)(0.8), /* C_lN_mu_per_k_i */
    (real)(0.4), /* C_m_per_k_i */
    (real)(24.525), /* twice_L_M_g_mu_per_k_i */
    (real)(0.02), /* k_i_per_R */
    (real)(0.004), /* k_e_k_i_per_R */
#else
    0.004, /* B_lN */
    4.0e-4, /* B_m */
    0.08, /* C_lN */
    0.008, /* C_m */
    0.02, /* k_i */
    0.2, /* mu */
    0.005, /* scale_N */
    1.0, /* unbalanced */
    74.118823520074845, /* twice_omega_star */
    37.05941176003742, /* omega_star_1 */
    1.9391227281942644e-15, /* omega_star_2 */
    15.707963267341256, /* half_period_1 */
    6.0771005068460671e-10, /* half_period_2 */
    -3.3987446136315715e-20, /* half_period_3 */
    0.031830988618379067, /* turns_per_rad */
    0.1, /* half_mu */
    31.415926535897932, /* period */
    1.6e-4, /* B_lN_mu2 */
    0.0044, /* B_m_plus_k_e_k_i_per_R */
    0.016, /* C_lN_mu */
    0.037059411760037422, /* mu_omega_star_scale_N */
    0.04, /* mu2 */
    0.117872, /* C_lN_mu_weight_plus_C_m */
    0.4905, /* twice_L_M_g_mu */
    NAN, /* J */
    0.008, /* B_lN_R_mu2_per_k_i */
    0.22, /* B_m_R_per_k_i_plus_k_e */
    0.8, /* C_lN_R_mu_per_k_i */
    0.4, /* C_m_R_per_k_i */
    50.0, /* R_per_k_i */
    24.525, /* twice_L_M_R_g_mu_per_k_i */
    0.008, /* B_lN_mu2_per_k_i */
    0.02, /* B_m_per_k_i */
    50.0, /* per_k_i */
    0.8, /* C_lN_mu_per_k_i */
    0.4, /* C_m_per_k_i */
    24.525, /* twice_L_M_g_mu_per_k_i */
    0.02, /* k_i_per_R */
    0.004, /* k_e_k_i_per_R */
#endif
};

void c2_parallel_prepare(const c2_parallel_parameters *p, c2_parallel_coefficients *c)
{
    const double weight = p->g * (p->M + p->M_l);
    const double critical_squared = (p->L * p->M == 0.0) ? 1.0 : (weight / (p->L * p->M));
    const double omega_star = (p->L * p->M == 0.0) ? 1.0 : (sqrt(critical_squared) / p->mu);
    const double scale_N = (p->L * p->M == 0.0) ? weight / (omega_star * omega_star) : (p->L * p->M * p->mu *
        p->mu);
    const double unbalanced = (p->L * p->M == 0.0) ? 0.0 : (1.0);
    const double twice_omega_star = 2.0 * omega_star;
    const double omega_star_1 = (double)(real)(omega_star);
    const double omega_star_2 = (double)(real)(omega_star - omega_star_1);
    const double half_period = 3.1415926535897932 / p->mu;
    const double half_period_1 = c2_parallel_leading(half_period);
    const double half_period_2 = c2_parallel_leading(half_period - half_period_1);
    const double half_period_3 = (double)(real)(half_period - half_period_1 - half_period_2);
    const double turns_per_rad = 0.5 * p->mu / 3.1415926535897932;
    const double half_mu = 0.5 * p->mu;
    const double period = 2.0 * 3.1415926535897932 / p->mu;
    const double B_lN_mu2 = p->B_lN * p->mu * p->mu;
    const double B_m_plus_k_e_k_i_per_R = p->B_m + p->k_e * p->k_i / p->R;
    const double C_lN_mu = p->C_lN * p->mu;
    const double mu_omega_star_scale_N = p->mu * omega_star * scale_N;
    const double mu2 = p->mu * p->mu;
    const double C_lN_mu_weight_plus_C_m = p->C_lN * p->mu * weight + p->C_m;
    const double twice_L_M_g_mu = 2.0 * p->L * p->M * p->g * p->mu;
    const double J = p->J_l * p->mu * p->mu + p->J_m;
    const double B_lN_R_mu2_per_k_i = p->B_lN * p->R * p->mu * p->mu / p->k_i;
    const double B_m_R_per_k_i_plus_k_e = p->B_m * p->R / p->k_i + p->k_e;
    const double C_lN_R_mu_per_k_i = p->C_lN * p->R * p->mu / p->k_i;
    const double C_m_R_per_k_i = p->C_m * p->R / p->k_i;
    const double R_per_k_i = p->R / p->k_i;
    const double twice_L_M_R_g_mu_per_k_i = 2.0 * p->L * p->M * p->R * p->g * p->mu / p->k_i;
    const double B_lN_mu2_per_k_i = p->B_lN * p->mu * p->mu / p->k_i;
    const double B_m_per_k_i = p->B_m / p->k_i;
    const double per_k_i = 1.0 / p->k_i;
    const double C_lN_mu_per_k_i = p->C_lN * p->mu / p->k_i;
    const double C_m_per_k_i = p->C_m / p->k_i;
    const double twice_L_M_g_mu_per_k_i = 2.0 * p->L * p->M * p->g * p->mu / p->k_i;
    const double k_i_per_R = p->k_i / p->R;
    const double k_e_k_i_per_R = p->k_e * p->k_i / p->R;
    c->B_lN = (real)(p->B_lN);
    c->B_m = (real)(p->B_m);
    c->C_lN = (real)(p->C_lN);
    c->C_m = (real)(p->C_m);
    c->k_i = (real)(p->k_i);
    c->mu = (real)(p->mu);
    c->scale_N = (real)(scale_N);
    c->unbalanced = (real)(unbalanced);
    c->twice_omega_star = (real)(twice_omega_star);
    c->omega_star_1 = (real)(omega_star_1);
    c->omega_star_2 = (real)(omega_star_2);
    c->half_period_1 = (real)(half_period_1);
    c->half_period_2 = (real)(half_period_2);
    c->half_period_3 = (real)(half_period_3);
    c->turns_per_rad = (real)(turns_per_rad);
    c->half_mu = (real)(half_mu);
    c->period = (real)(period);
    c->B_lN_mu2 = (real)(B_lN_mu2);
    c->B_m_plus_k_e_k_i_per_R = (real)(B_m_plus_k_e_k_i_per_R);
    c->C_lN_mu = (real)(C_lN_mu);
    c->mu_omega_star_scale_N = (real)(mu_omega_star_scale_N);
    c->mu2 = (real)(mu2);
    c->C_lN_mu_weight_plus_C_m = (real)(C_lN_mu_weight_plus_C_m);
    c->twice_L_M_g_mu = (real)(twice_L_M_g_mu);
    c->J = (real)(J);
    c->B_lN_R_mu2_per_k_i = (real)(B_lN_R_mu2_per_k_i);
    c->B_m_R_per_k_i_plus_k_e = (real)(B_m_R_per_k_i_plus_k_e);
    c->C_lN_R_mu_per_k_i = (real)(C_lN_R_mu_per_k_i);
    c->C_m_R_per_k_i = (real)(C_m_R_per_k_i);
    c->R_per_k_i = (real)(R_per_k_i);
    c->twice_L_M_R_g_mu_per_k_i = (real)(twice_L_M_R_g_mu_per_k_i);
    c->B_lN_mu2_per_k_i = (real)(B_lN_mu2_per_k_i);
    c->B_m_per_k_i = (real)(B_m_per_k_i);
    c->per_k_i = (real)(per_k_i);
    c->C_lN_mu_per_k_i = (real)(C_lN_mu_per_k_i);
    c->C_m_per_k_i = (real)(C_m_per_k_i);
    c->twice_L_M_g_mu_per_k_i = (real)(twice_L_M_g_mu_per_k_i);
    c->k_i_per_R = (real)(k_i_per_R);
    c->k_e_k_i_per_R = (real)(k_e_k_i_per_R);
}

ECCENTRIC_REAL c2_parallel_normal_force(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    const c2_parallel_coefficients *c)
{
    /* magnitude of the motor velocity, 0 if the mass is balanced [rad/s] */
    const real speed = c->unbalanced * REAL_FABS(omega_m);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    /* the odd number of half turns up to the top that is nearest */
    const real halves = REAL(2.0) * REAL_FLOOR(theta_m * c->turns_per_rad) + REAL(1.0);
    /* the half turns go off in three parts, the leading digits first: both products are exact */
    const real rest = theta_m - halves * c->half_period_1;
    /* angle from the top */
    const real from_top = rest - halves * c->half_period_2 - halves * c->half_period_3;
    /* an angle so large that nothing is left of its phase counts as the top */
    const real bounded = ((REAL_FABS(from_top) <= c->period) ? from_top : theta_m - theta_m);
    /* half angle from the top */
    const real half_angle = bounded * c->half_mu;
    const real half_angle_squared = half_angle * half_angle;
    /* sine of the half angle from the top: the cosine of half the angle but for its sign */
    const real half_cosine = half_angle * c2_parallel_sine_series(half_angle_squared);
    const real p = square_difference;
    const real q = half_cosine * speed * c->twice_omega_star;
    const real magnitude = REAL_SQRT(p * p + q * q);
    /* normal force on the axis of rotation [N], eq (17) */
    const real F_N = magnitude * c->scale_N;
    return F_N;
}

void c2_parallel_normal_force_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c2_parallel_coefficients *c)
{
    for (size_t k = 0; k < n; ++k) {
        out[k] = c2_parallel_normal_force(theta_m[k], omega_m[k], c);
    }
}

ECCENTRIC_REAL c2_parallel_friction_torque(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    const c2_parallel_coefficients *c)
{
    /* magnitude of the motor velocity, 0 if the mass is balanced [rad/s] */
    const real speed = c->unbalanced * REAL_FABS(omega_m);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    /* the odd number of half turns up to the top that is nearest */
    const real halves = REAL(2.0) * REAL_FLOOR(theta_m * c->turns_per_rad) + REAL(1.0);
    /* the half turns go off in three parts, the leading digits first: both products are exact */
    const real rest = theta_m - halves * c->half_period_1;
    /* angle from the top */
    const real from_top = rest - halves * c->half_period_2 - halves * c->half_period_3;
    /* an angle so large that nothing is left of its phase counts as the top */
    const real bounded = ((REAL_FABS(from_top) <= c->period) ? from_top : theta_m - theta_m);
    /* half angle from the top */
    const real half_angle = bounded * c->half_mu;
    const real half_angle_squared = half_angle * half_angle;
    /* sine of the half angle from the top: the cosine of half the angle but for its sign */
    const real half_cosine = half_angle * c2_parallel_sine_series(half_angle_squared);
    const real p = square_difference;
    const real q = half_cosine * speed * c->twice_omega_star;
    const real magnitude = REAL_SQRT(p * p + q * q);
    /* normal force on the axis of rotation [N], eq (17) */
    const real F_N = magnitude * c->scale_N;
    const real direction_of_motion = c2_parallel_sgn(omega_m);
    const real part_1 = omega_m * (c->B_lN_mu2 * F_N + c->B_m_plus_k_e_k_i_per_R);
    return direction_of_motion * (c->C_lN_mu * F_N + c->C_m) + part_1;
}

void c2_parallel_friction_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c2_parallel_coefficients *c)
{
    for (size_t k = 0; k < n; ++k) {
        out[k] = c2_parallel_friction_torque(theta_m[k], omega_m[k], c);
    }
}

ECCENTRIC_REAL c2_parallel_mechanical_friction_torque(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    const c2_parallel_coefficients *c)
{
    /* magnitude of the motor velocity, 0 if the mass is balanced [rad/s] */
    const real speed = c->unbalanced * REAL_FABS(omega_m);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    /* the odd number of half turns up to the top that is nearest */
    const real halves = REAL(2.0) * REAL_FLOOR(theta_m * c->turns_per_rad) + REAL(1.0);
    /* the half turns go off in three parts, the leading digits first: both products are exact */
    const real rest = theta_m - halves * c->half_period_1;
    /* angle from the top */
    const real from_top = rest - halves * c->half_period_2 - halves * c->half_period_3;
    /* an angle so large that nothing is left of its phase counts as the top */
    const real bounded = ((REAL_FABS(from_top) <= c->period) ? from_top : theta_m - theta_m);
    /* half angle from the top */
    const real half_angle = bounded * c->half_mu;
    const real half_angle_squared = half_angle * half_angle;
    /* sine of the half angle from the top: the cosine of half the angle but for its sign */
    const real half_cosine = half_angle * c2_parallel_sine_series(half_angle_squared);
    const real p = square_difference;
    const real q = half_cosine * speed * c->twice_omega_star;
    const real magnitude = REAL_SQRT(p * p + q * q);
    /* normal force on the axis of rotation [N], eq (17) */
    const real F_N = magnitude * c->scale_N;
    const real direction_of_motion = c2_parallel_sgn(omega_m);
    const real part_1 = direction_of_motion * (c->C_lN_mu * F_N + c->C_m);
    return omega_m * (c->B_lN_mu2 * F_N + c->B_m) + part_1;
}

void c2_parallel_mechanical_friction_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c2_parallel_coefficients *c)
{
    for (size_t k = 0; k < n; ++k) {
        out[k] = c2_parallel_mechanical_friction_torque(theta_m[k], omega_m[k], c);
    }
}

void c2_parallel_friction_torque_gradient(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c2_parallel_coefficients *c)
{
    /* magnitude of the motor velocity, 0 if the mass is balanced [rad/s] */
    const real speed = c->unbalanced * REAL_FABS(omega_m);
    const real direction_of_motion = c2_parallel_sgn(omega_m);
    const real speed_d_omega_m = direction_of_motion * c->unbalanced;
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    /* the odd number of half turns up to the top that is nearest */
    const real halves = REAL(2.0) * REAL_FLOOR(theta_m * c->turns_per_rad) + REAL(1.0);
    /* the half turns go off in three parts, the leading digits first: both products are exact */
    const real rest = theta_m - halves * c->half_period_1;
    /* angle from the top */
    const real from_top = rest - halves * c->half_period_2 - halves * c->half_period_3;
    /* an angle so large that nothing is left of its phase counts as the top */
    const real bounded = ((REAL_FABS(from_top) <= c->period) ? from_top : theta_m - theta_m);
    /* half angle from the top */
    const real half_angle = bounded * c->half_mu;
    const real half_angle_squared = half_angle * half_angle;
    /* sine of the half angle from the top: the cosine of half the angle but for its sign */
    const real half_cosine = half_angle * c2_parallel_sine_series(half_angle_squared);
    const real p = square_difference;
    const real q = half_cosine * speed * c->twice_omega_star;
    const real magnitude = REAL_SQRT(p * p + q * q);
    /* normal force on the axis of rotation [N], eq (17) */
    const real F_N = magnitude * c->scale_N;
    /* cosine of the half angle from the top */
    const real half_sine = c2_parallel_cosine_series(half_angle_squared);
    /* 0/0 at the apex, where F_N is 0 and its derivatives are taken as 0 */
    const real divisor = ((magnitude == REAL(0.0)) ? REAL(1.0) : magnitude);
    /* where the square overflows, the larger of the two decides */
    const real limit = ((REAL_FABS(q) > REAL_FABS(p)) ? c2_parallel_sgn(q) : REAL(0.0));
    const real cosine = ((magnitude > REAL_LARGEST) ? limit : q / divisor);
    const real ungated = half_sine * c->mu_omega_star_scale_N * speed;
    const real F_N_d_theta_m = ((cosine == REAL(0.0)) ? REAL(0.0) : ungated * cosine);
    /* where the square overflows, the larger of the two decides */
    const real limit_2 = ((REAL_FABS(p) > REAL_FABS(q)) ? c2_parallel_sgn(p) : REAL(0.0));
    const real cosine_2 = ((magnitude > REAL_LARGEST) ? limit_2 : p / divisor);
    const real ungated_2 = REAL(2.0) * speed;
    const real ungated_3 = half_cosine * c->twice_omega_star;
    const real part_2 = ((cosine_2 == REAL(0.0)) ? REAL(0.0) : ungated_2 * cosine_2);
    const real part_1 = part_2 + ((cosine == REAL(0.0)) ? REAL(0.0) : ungated_3 * cosine);
    const real F_N_d_omega_m = part_1 * c->scale_N * speed_d_omega_m;
    const real part_3 = c->B_lN_mu2 * omega_m + c->C_lN_mu * direction_of_motion;
    out[0] = F_N_d_theta_m * part_3;
    const real part_4 = c->C_lN_mu * F_N_d_omega_m * direction_of_motion;
    const real part_5 = c->B_lN_mu2 * F_N_d_omega_m * omega_m;
    const real part_6 = c->B_lN_mu2 * F_N;
    out[1] = c->B_m_plus_k_e_k_i_per_R + part_4 + part_5 + part_6;
}

void c2_parallel_friction_torque_gradient_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c2_parallel_coefficients *c)
{
    for (size_t k = 0; k < n; ++k) {
        c2_parallel_friction_torque_gradient(theta_m[k], omega_m[k], out + 2 * k, c);
    }
}

void c2_parallel_friction_torque_jacobian(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c2_parallel_coefficients *c)
{
    /* magnitude of the motor velocity, 0 if the mass is balanced [rad/s] */
    const real speed = c->unbalanced * REAL_FABS(omega_m);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    /* the odd number of half turns up to the top that is nearest */
    const real halves = REAL(2.0) * REAL_FLOOR(theta_m * c->turns_per_rad) + REAL(1.0);
    /* the half turns go off in three parts, the leading digits first: both products are exact */
    const real rest = theta_m - halves * c->half_period_1;
    /* angle from the top */
    const real from_top = rest - halves * c->half_period_2 - halves * c->half_period_3;
    /* an angle so large that nothing is left of its phase counts as the top */
    const real bounded = ((REAL_FABS(from_top) <= c->period) ? from_top : theta_m - theta_m);
    /* half angle from the top */
    const real half_angle = bounded * c->half_mu;
    const real half_angle_squared = half_angle * half_angle;
    /* sine of the half angle from the top: the cosine of half the angle but for its sign */
    const real half_cosine = half_angle * c2_parallel_sine_series(half_angle_squared);
    const real p = square_difference;
    const real q = half_cosine * speed * c->twice_omega_star;
    const real magnitude = REAL_SQRT(p * p + q * q);
    /* normal force on the axis of rotation [N], eq (17) */
    const real F_N = magnitude * c->scale_N;
    out[0] = F_N * c->mu2 * omega_m;
    const real direction_of_motion = c2_parallel_sgn(omega_m);
    out[1] = F_N * direction_of_motion * c->mu;
    out[2] = omega_m;
    out[3] = direction_of_motion;
}

void c2_parallel_friction_torque_jacobian_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c2_parallel_coefficients *c)
{
    for (size_t k = 0; k < n; ++k) {
        c2_parallel_friction_torque_jacobian(theta_m[k], omega_m[k], out + 4 * k, c);
    }
}

void c2_parallel_regressor(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL *out,
    const c2_parallel_coefficients *c)
{
    /* magnitude of the motor velocity, 0 if the mass is balanced [rad/s] */
    const real speed = c->unbalanced * REAL_FABS(omega_m);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    /* the odd number of half turns up to the top that is nearest */
    const real halves = REAL(2.0) * REAL_FLOOR(theta_m * c->turns_per_rad) + REAL(1.0);
    /* the half turns go off in three parts, the leading digits first: both products are exact */
    const real rest = theta_m - halves * c->half_period_1;
    /* angle from the top */
    const real from_top = rest - halves * c->half_period_2 - halves * c->half_period_3;
    /* an angle so large that nothing is left of its phase counts as the top */
    const real bounded = ((REAL_FABS(from_top) <= c->period) ? from_top : theta_m - theta_m);
    /* half angle from the top */
    const real half_angle = bounded * c->half_mu;
    const real half_angle_squared = half_angle * half_angle;
    /* sine of the half angle from the top: the cosine of half the angle but for its sign */
    const real half_cosine = half_angle * c2_parallel_sine_series(half_angle_squared);
    const real p = square_difference;
    const real q = half_cosine * speed * c->twice_omega_star;
    const real magnitude = REAL_SQRT(p * p + q * q);
    /* normal force on the axis of rotation [N], eq (17) */
    const real F_N = magnitude * c->scale_N;
    out[0] = F_N * c->mu2 * omega_m;
    const real direction_of_motion = c2_parallel_sgn(omega_m);
    out[1] = F_N * direction_of_motion * c->mu;
    out[2] = omega_m;
    out[3] = direction_of_motion;
}

void c2_parallel_regressor_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    ECCENTRIC_REAL *out,
    const c2_parallel_coefficients *c)
{
    for (size_t k = 0; k < n; ++k) {
        c2_parallel_regressor(theta_m[k], omega_m[k], out + 4 * k, c);
    }
}

void c2_parallel_friction_coefficients(ECCENTRIC_REAL *out, const c2_parallel_coefficients *c)
{
    out[0] = c->B_lN;
    out[1] = c->C_lN;
    out[2] = c->B_m;
    out[3] = c->C_m;
}

ECCENTRIC_REAL c2_parallel_coulomb_torque(const c2_parallel_coefficients *c)
{
    return c->C_lN_mu_weight_plus_C_m;
}

ECCENTRIC_REAL c2_parallel_gravity_torque(ECCENTRIC_REAL theta_m, const c2_parallel_coefficients *c)
{
    /* the odd number of half turns up to the top that is nearest */
    const real halves = REAL(2.0) * REAL_FLOOR(theta_m * c->turns_per_rad) + REAL(1.0);
    /* the half turns go off in three parts, the leading digits first: both products are exact */
    const real rest = theta_m - halves * c->half_period_1;
    /* angle from the top */
    const real from_top = rest - halves * c->half_period_2 - halves * c->half_period_3;
    /* an angle so large that nothing is left of its phase counts as the top */
    const real bounded = ((REAL_FABS(from_top) <= c->period) ? from_top : theta_m - theta_m);
    /* half angle from the top */
    const real half_angle = bounded * c->half_mu;
    const real half_angle_squared = half_angle * half_angle;
    /* sine of the half angle from the top: the cosine of half the angle but for its sign */
    const real half_cosine = half_angle * c2_parallel_sine_series(half_angle_squared);
    /* cosine of the half angle from the top */
    const real half_sine = c2_parallel_cosine_series(half_angle_squared);
    return -half_cosine * half_sine * c->twice_L_M_g_mu;
}

void c2_parallel_gravity_torque_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    ECCENTRIC_REAL *out,
    const c2_parallel_coefficients *c)
{
    for (size_t k = 0; k < n; ++k) {
        out[k] = c2_parallel_gravity_torque(theta_m[k], c);
    }
}

ECCENTRIC_REAL c2_parallel_voltage(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const c2_parallel_coefficients *c)
{
    /* magnitude of the motor velocity, 0 if the mass is balanced [rad/s] */
    const real speed = c->unbalanced * REAL_FABS(omega_m);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    /* the odd number of half turns up to the top that is nearest */
    const real halves = REAL(2.0) * REAL_FLOOR(theta_m * c->turns_per_rad) + REAL(1.0);
    /* the half turns go off in three parts, the leading digits first: both products are exact */
    const real rest = theta_m - halves * c->half_period_1;
    /* angle from the top */
    const real from_top = rest - halves * c->half_period_2 - halves * c->half_period_3;
    /* an angle so large that nothing is left of its phase counts as the top */
    const real bounded = ((REAL_FABS(from_top) <= c->period) ? from_top : theta_m - theta_m);
    /* half angle from the top */
    const real half_angle = bounded * c->half_mu;
    const real half_angle_squared = half_angle * half_angle;
    /* sine of the half angle from the top: the cosine of half the angle but for its sign */
    const real half_cosine = half_angle * c2_parallel_sine_series(half_angle_squared);
    const real p = square_difference;
    const real q = half_cosine * speed * c->twice_omega_star;
    const real magnitude = REAL_SQRT(p * p + q * q);
    /* normal force on the axis of rotation [N], eq (17) */
    const real F_N = magnitude * c->scale_N;
    const real direction_of_motion = c2_parallel_sgn(omega_m);
    /* cosine of the half angle from the top */
    const real half_sine = c2_parallel_cosine_series(half_angle_squared);
    const real part_1 = direction_of_motion * (c->C_lN_R_mu_per_k_i * F_N + c->C_m_R_per_k_i);
    const real part_2 = omega_m * (c->B_lN_R_mu2_per_k_i * F_N + c->B_m_R_per_k_i_plus_k_e);
    const real part_3 = c->R_per_k_i * ((alpha_m == REAL(0.0)) ? REAL(0.0) : c->J * alpha_m);
    const real part_4 = -half_cosine * half_sine * c->twice_L_M_R_g_mu_per_k_i;
    return part_1 + part_2 + part_3 + part_4;
}

void c2_parallel_voltage_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const c2_parallel_coefficients *c)
{
    for (size_t k = 0; k < n; ++k) {
        out[k] = c2_parallel_voltage(theta_m[k], omega_m[k], alpha_m[k], c);
    }
}

ECCENTRIC_REAL c2_parallel_current(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL alpha_m,
    const c2_parallel_coefficients *c)
{
    /* magnitude of the motor velocity, 0 if the mass is balanced [rad/s] */
    const real speed = c->unbalanced * REAL_FABS(omega_m);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    /* the odd number of half turns up to the top that is nearest */
    const real halves = REAL(2.0) * REAL_FLOOR(theta_m * c->turns_per_rad) + REAL(1.0);
    /* the half turns go off in three parts, the leading digits first: both products are exact */
    const real rest = theta_m - halves * c->half_period_1;
    /* angle from the top */
    const real from_top = rest - halves * c->half_period_2 - halves * c->half_period_3;
    /* an angle so large that nothing is left of its phase counts as the top */
    const real bounded = ((REAL_FABS(from_top) <= c->period) ? from_top : theta_m - theta_m);
    /* half angle from the top */
    const real half_angle = bounded * c->half_mu;
    const real half_angle_squared = half_angle * half_angle;
    /* sine of the half angle from the top: the cosine of half the angle but for its sign */
    const real half_cosine = half_angle * c2_parallel_sine_series(half_angle_squared);
    const real p = square_difference;
    const real q = half_cosine * speed * c->twice_omega_star;
    const real magnitude = REAL_SQRT(p * p + q * q);
    /* normal force on the axis of rotation [N], eq (17) */
    const real F_N = magnitude * c->scale_N;
    const real direction_of_motion = c2_parallel_sgn(omega_m);
    /* cosine of the half angle from the top */
    const real half_sine = c2_parallel_cosine_series(half_angle_squared);
    const real part_1 = direction_of_motion * (c->C_lN_mu_per_k_i * F_N + c->C_m_per_k_i);
    const real part_2 = c->per_k_i * ((alpha_m == REAL(0.0)) ? REAL(0.0) : c->J * alpha_m);
    const real part_3 = -half_cosine * half_sine * c->twice_L_M_g_mu_per_k_i;
    const real part_4 = omega_m * (c->B_lN_mu2_per_k_i * F_N + c->B_m_per_k_i);
    return part_1 + part_2 + part_3 + part_4;
}

void c2_parallel_current_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const c2_parallel_coefficients *c)
{
    for (size_t k = 0; k < n; ++k) {
        out[k] = c2_parallel_current(theta_m[k], omega_m[k], alpha_m[k], c);
    }
}

ECCENTRIC_REAL c2_parallel_mechanical_residual(
    ECCENTRIC_REAL theta_m,
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL i,
    ECCENTRIC_REAL alpha_m,
    const c2_parallel_coefficients *c)
{
    /* magnitude of the motor velocity, 0 if the mass is balanced [rad/s] */
    const real speed = c->unbalanced * REAL_FABS(omega_m);
    /* speed^2 - omega_star^2; the difference is taken once, before anything is rounded */
    const real square_difference = (speed - c->omega_star_1 - c->omega_star_2) * (speed + c->omega_star_1);
    /* the odd number of half turns up to the top that is nearest */
    const real halves = REAL(2.0) * REAL_FLOOR(theta_m * c->turns_per_rad) + REAL(1.0);
    /* the half turns go off in three parts, the leading digits first: both products are exact */
    const real rest = theta_m - halves * c->half_period_1;
    /* angle from the top */
    const real from_top = rest - halves * c->half_period_2 - halves * c->half_period_3;
    /* an angle so large that nothing is left of its phase counts as the top */
    const real bounded = ((REAL_FABS(from_top) <= c->period) ? from_top : theta_m - theta_m);
    /* half angle from the top */
    const real half_angle = bounded * c->half_mu;
    const real half_angle_squared = half_angle * half_angle;
    /* sine of the half angle from the top: the cosine of half the angle but for its sign */
    const real half_cosine = half_angle * c2_parallel_sine_series(half_angle_squared);
    const real p = square_difference;
    const real q = half_cosine * speed * c->twice_omega_star;
    const real magnitude = REAL_SQRT(p * p + q * q);
    /* normal force on the axis of rotation [N], eq (17) */
    const real F_N = magnitude * c->scale_N;
    const real direction_of_motion = c2_parallel_sgn(omega_m);
    /* cosine of the half angle from the top */
    const real half_sine = c2_parallel_cosine_series(half_angle_squared);
    const real part_1 = -((alpha_m == REAL(0.0)) ? REAL(0.0) : c->J * alpha_m);
    const real part_2 = -direction_of_motion * (c->C_lN_mu * F_N + c->C_m);
    const real part_3 = half_cosine * half_sine * c->twice_L_M_g_mu;
    const real part_4 = -omega_m * (c->B_lN_mu2 * F_N + c->B_m);
    return i * c->k_i + part_1 + part_2 + part_3 + part_4;
}

void c2_parallel_mechanical_residual_n(
    size_t n,
    const ECCENTRIC_REAL *theta_m,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *i,
    const ECCENTRIC_REAL *alpha_m,
    ECCENTRIC_REAL *out,
    const c2_parallel_coefficients *c)
{
    for (size_t k = 0; k < n; ++k) {
        out[k] = c2_parallel_mechanical_residual(theta_m[k], omega_m[k], i[k], alpha_m[k], c);
    }
}

ECCENTRIC_REAL c2_parallel_electrical_residual(
    ECCENTRIC_REAL omega_m,
    ECCENTRIC_REAL i,
    ECCENTRIC_REAL u,
    const c2_parallel_coefficients *c)
{
    return -i * c->k_i - c->k_e_k_i_per_R * omega_m + c->k_i_per_R * u;
}

void c2_parallel_electrical_residual_n(
    size_t n,
    const ECCENTRIC_REAL *omega_m,
    const ECCENTRIC_REAL *i,
    const ECCENTRIC_REAL *u,
    ECCENTRIC_REAL *out,
    const c2_parallel_coefficients *c)
{
    for (size_t k = 0; k < n; ++k) {
        out[k] = c2_parallel_electrical_residual(omega_m[k], i[k], u[k], c);
    }
}

#undef real
#undef REAL
#undef REAL_SQRT
#undef REAL_FABS
#undef REAL_FLOOR
#undef REAL_LARGEST

