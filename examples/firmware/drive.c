/* Equation of motion of the paper's case C2, written out with libm: it shares nothing with the emitted code.
 * The friction of the link and the inertia differ from what the firmware assumes, as they would on a machine. */
#include "drive.h"

#include <math.h>

#define STEPS 10                /* of integration within a millisecond */
#define STEP (1.0e-3f / STEPS)  /* [s] */
#define CREEP 0.02f             /* speed below which Coulomb friction fades, instead of stiction [rad/s] */

/* Table 1 of the paper, mu = 1/5; B_lN, C_lN and J deviate by 10, -5 and 3 per cent. */
static const float M = 0.5f, M_l = 0.2f, L = 0.25f, mu = 0.2f, k_i = 0.02f, g = 9.81f;
static const float B_lN = 0.0044f, C_lN = 0.076f, B_m = 4.0e-4f, C_m = 0.008f;
static const float J = 0.0018f * 1.03f;

/* Motor acceleration [rad/s^2]. */
static float acceleration(float theta_m, float omega_m, float current)
{
    const float omega_l = mu * omega_m;
    const float centrifugal = M * L * omega_l * omega_l;
    const float weight = (M + M_l) * g;
    const float along = centrifugal + weight * cosf(mu * theta_m);
    const float across = weight * sinf(mu * theta_m);
    const float normal_force = sqrtf(along * along + across * across);

    const float direction = tanhf(omega_m / CREEP);
    const float link = normal_force * (B_lN * omega_l + C_lN * direction);
    const float motor = B_m * omega_m + C_m * direction;
    const float gravity = mu * M * g * L * sinf(mu * theta_m);
    return (k_i * current - gravity - motor - mu * link) / J;
}

void drive_run(drive *state, float current)
{
    for (int32_t step = 0; step < STEPS; ++step) {
        /* Midpoint rule. */
        const float half = 0.5f * STEP;
        const float theta = state->theta_m + half * state->omega_m;
        const float omega =
            state->omega_m + half * acceleration(state->theta_m, state->omega_m, current);
        state->theta_m += STEP * omega;
        state->omega_m += STEP * acceleration(theta, omega, current);
    }
}

int32_t drive_encoder(const drive *state)
{
    const float counts_per_rad = (float)ENCODER_COUNTS / 6.28318531f;
    return (int32_t)floorf(state->theta_m * counts_per_rad);
}
