/* Equation of motion of the paper's case C2, written out with libm: of the emitted code it takes the parameters
 * alone. The friction of the link and the inertia differ from these, as they would on a machine. */
#include "drive.h"

#include "arm.h"
#include "c2_parallel.h"

#include <math.h>

#define STEPS 10                /* of integration within a millisecond */
#define STEP (1.0e-3f / STEPS)  /* [s] */

/* What the machine is, beside what the firmware takes it for. */
#define TRUE_B_lN 1.10f
#define TRUE_C_lN 0.95f
#define TRUE_INERTIA 1.03f
#define TRUE_STATIC 1.15f /* static over kinetic friction */
#define FALL 0.5f         /* speed over which it falls to that [rad/s] */

/* One step: friction at rest is any torque between its levels, so that a drive within them stays at exactly 0.
 * Solved for the velocity at its end, with the levels at its start (Moreau). */
static void advance(drive *state, float current)
{
    const c2_parallel_parameters *const p = &c2_parallel_default_parameters;
    const float M = (float)p->M, L = (float)p->L, mu = (float)p->mu, g = (float)p->g;
    const float B_lN = TRUE_B_lN * (float)p->B_lN, C_lN = TRUE_C_lN * (float)p->C_lN;
    const float B_m = (float)p->B_m, C_m = (float)p->C_m;
    const float theta = state->theta_m, omega = state->omega_m;

    const float centrifugal = M * L * (mu * omega) * (mu * omega);
    const float weight = (M + (float)p->M_l) * g;
    const float along = centrifugal + weight * cosf(mu * theta);
    const float across = weight * sinf(mu * theta);
    const float normal_force = sqrtf(along * along + across * across);

    const float sticking = 1.0f + (TRUE_STATIC - 1.0f) * expf(-(omega / FALL) * (omega / FALL));
    const float level = STEP * sticking * (C_m + mu * C_lN * normal_force);
    const float viscous = STEP * (B_m + mu * mu * B_lN * normal_force);
    const float inertia = TRUE_INERTIA * arm_inertia();
    const float gravity = mu * M * g * L * sinf(mu * theta);
    const float momentum = inertia * omega + STEP * (arm_torque_constant() * current - gravity);

    const float left = fmaxf(fabsf(momentum) - level, 0.0f);
    state->omega_m = copysignf(left, momentum) / (inertia + viscous);
    state->theta_m += STEP * state->omega_m;
}

void drive_run(drive *state, float current)
{
    for (int32_t step = 0; step < STEPS; ++step) {
        advance(state, current);
    }
}

int32_t drive_encoder(drive *state)
{
    const float counts_per_rad = (float)ENCODER_COUNTS / 6.28318531f;
    state->noise = state->noise * 1664525u + 1013904223u;
    const float noise = (float)(state->noise >> 8) / 16777216.0f - 0.5f;
    return (int32_t)floorf(state->theta_m * counts_per_rad + noise);
}
