/* Equation of motion of the paper's case C2, written out with libm: of the emitted code it takes the parameters
 * alone. The friction of the link and the inertia differ from these, as they would on a machine. */
#include "drive.h"

#include "arm.h"
#include "c2_parallel.h"

#include <math.h>

#define STEPS 10                /* of integration within a millisecond */
#define STEP (1.0e-3f / STEPS)  /* [s] */
#define CREEP 0.02f             /* speed below which Coulomb friction fades, instead of stiction [rad/s] */

/* What the machine is, beside what the firmware takes it for. */
#define TRUE_B_lN 1.10f
#define TRUE_C_lN 0.95f
#define TRUE_INERTIA 1.03f

/* Motor acceleration [rad/s^2]. */
static float acceleration(float theta_m, float omega_m, float current)
{
    const c2_parallel_parameters *const p = &c2_parallel_default_parameters;
    const float M = (float)p->M, L = (float)p->L, mu = (float)p->mu, g = (float)p->g;
    const float B_lN = TRUE_B_lN * (float)p->B_lN, C_lN = TRUE_C_lN * (float)p->C_lN;
    const float B_m = (float)p->B_m, C_m = (float)p->C_m;

    const float omega_l = mu * omega_m;
    const float centrifugal = M * L * omega_l * omega_l;
    const float weight = (M + (float)p->M_l) * g;
    const float along = centrifugal + weight * cosf(mu * theta_m);
    const float across = weight * sinf(mu * theta_m);
    const float normal_force = sqrtf(along * along + across * across);

    const float direction = tanhf(omega_m / CREEP);
    const float link = normal_force * (B_lN * omega_l + C_lN * direction);
    const float motor = B_m * omega_m + C_m * direction;
    const float gravity = mu * M * g * L * sinf(mu * theta_m);
    return (arm_torque_constant() * current - gravity - motor - mu * link) / (TRUE_INERTIA * arm_inertia());
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
