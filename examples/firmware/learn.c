/* A drive whose grease warms for 10^7 samples, 90 % of them at rest, and the firmware that follows its friction.
 *
 * It moves for 2 s in 20: swings of changing size, the friction fed forward from what c2_parallel_adapt has
 * learned. In motion the grease warms, at rest it cools, and viscous friction follows; after 10^7 samples
 * Coulomb friction steps by 20 %. The loop runs as fast as it can: a simulated millisecond takes less. */
#include "learn.h"

#include "c2_parallel.h"
#include "semihosting.h"

#include <math.h>

#define SAMPLES 10000000u
#define AFTER_STEP 60000u /* samples with the greater Coulomb friction */
#define CYCLE 20000u      /* samples from one swing to the next */
#define MOVING 2000u      /* samples of a swing */
#define REPORT 500000u    /* samples between two lines */
#define STEP 1.0e-3f      /* [s] */
#define SUBSTEPS 2        /* of integration */
#define ANGULAR 6.2831853f /* of a swing [rad/s] */
#define COUNTS 65536.0f   /* of the encoder, a turn */
#define CURRENT_NOISE 0.3f /* standard deviation [A] */
#define CREEP 0.02f       /* speed below which Coulomb friction fades [rad/s] */
#define BAND 157.0f       /* of the filter of angle and current, 25 Hz [rad/s] */
#define STIFFNESS 2.0f    /* [N m/rad] */
#define DAMPING 0.08f     /* [N m s/rad] */
#define JUMP 1.2f         /* of Coulomb friction */

/* The grease: viscous friction falls with temperature, which follows the power lost in friction. */
#define SOFTER 0.02f      /* per kelvin */
#define WARMING 0.3f      /* [K/s] at a loss of 1 W */
#define COOLING 400.0f    /* time constant [s] */

typedef struct {
    float theta, omega;     /* motor side */
    float warmer;           /* temperature above that of the room [K] */
    float friction[4];      /* B_lN, C_lN, B_m, C_m of this moment */
} plant;

typedef struct {
    float position, speed, acceleration; /* the same filter for angle and current: they stay in step */
} filter;

static uint32_t word = 0x2545f491u;

/* Standard normal, nearly: four bytes of a random word. */
static float normal(void)
{
    word ^= word << 13;
    word ^= word >> 17;
    word ^= word << 5;
    const uint32_t sum = (word & 255u) + ((word >> 8) & 255u) + ((word >> 16) & 255u) + (word >> 24);
    return ((float)sum - 510.0f) / 147.8f;
}

static void filtered(filter *f, float x)
{
    f->acceleration = BAND * BAND * (x - f->position) - 1.4142f * BAND * f->speed;
    f->speed += STEP * f->acceleration;
    f->position += STEP * f->speed;
}

/* Friction of this moment, from the temperature. */
static void grease(plant *d, float coulomb)
{
    const c2_parallel_parameters *const p = &c2_parallel_default_parameters;
    const float softer = expf(-SOFTER * d->warmer);
    d->friction[0] = (float)p->B_lN * softer;
    d->friction[1] = (float)p->C_lN * coulomb;
    d->friction[2] = (float)p->B_m * softer;
    d->friction[3] = (float)p->C_m * coulomb;
}

/* One millisecond of the equation of motion, written out as in drive.c. */
static void run(plant *d, float torque)
{
    const c2_parallel_parameters *const p = &c2_parallel_default_parameters;
    const float M = (float)p->M, L = (float)p->L, mu = (float)p->mu, g = (float)p->g;
    const float inertia = (float)p->J_m + mu * mu * (float)p->J_l;
    const float middle = mu * (d->theta + 0.5f * STEP * d->omega);
    const float sine = sinf(middle), cosine = cosf(middle);
    const float weight = (M + (float)p->M_l) * g;
    float lost = 0.0f;
    for (int32_t k = 0; k < SUBSTEPS; ++k) {
        const float link = mu * d->omega;
        const float along = M * L * link * link + weight * cosine;
        const float force = sqrtf(along * along + weight * sine * weight * sine);
        const float ratio = d->omega / CREEP;
        const float direction = (ratio > 1.0f) ? 1.0f : ((ratio < -1.0f) ? -1.0f : ratio);
        const float viscous = (d->friction[0] * mu * mu * force + d->friction[2]) * d->omega;
        const float friction = viscous + (d->friction[1] * mu * force + d->friction[3]) * direction;
        const float alpha = (torque - mu * M * g * L * sine - friction) / inertia;
        d->theta += STEP / (float)SUBSTEPS * (d->omega + 0.5f * STEP / (float)SUBSTEPS * alpha);
        d->omega += STEP / (float)SUBSTEPS * alpha;
        lost += friction * d->omega / (float)SUBSTEPS;
    }
    d->warmer += STEP * WARMING * lost;
}

static void put(uint32_t x)
{
    char digits[11];
    char *at = &digits[10];
    *at = '\0';
    do {
        *--at = (char)('0' + (char)(x % 10u));
        x /= 10u;
    } while (x != 0u);
    semihosting_write(at);
}

static uint32_t millionths(float x)
{
    return (x > 0.0f) ? (uint32_t)(1.0e6f * x + 0.5f) : 0u;
}

/* Sample, then learned and true coefficients in millionths of their unit. */
static void report(uint32_t sample, const c2_parallel_adapt_state *s, const plant *d)
{
    put(sample);
    for (uint32_t k = 0u; k < 4u; ++k) {
        semihosting_write((k == 0u) ? ": " : ", ");
        put(millionths(s->coefficient[k]));
        semihosting_write("/");
        put(millionths(d->friction[k]));
    }
    semihosting_write("\n");
}

int learn(void (*record)(const learn_row *row))
{
    static c2_parallel_adapt_state learned;
    static c2_parallel_coefficients live; /* what the feedforward uses */
    plant d = {.theta = 0.0f};
    filter angle = {.position = 0.0f}, current = {.position = 0.0f};
    const float k_i = c2_parallel_default.k_i, J = c2_parallel_default.J;
    uint32_t false_alarms = 0u, announced = 0u, broken = 0u, moved = 0u;
    float coulomb = 1.0f, peak = 30.0f, start = 0.0f;
    c2_parallel_adapt_init(&learned);
    live = c2_parallel_default;
    for (uint32_t sample = 0u; sample < SAMPLES + AFTER_STEP; ++sample) {
        const uint32_t phase = sample % CYCLE;
        if (sample == SAMPLES + 500u) { /* amid a swing */
            coulomb = JUMP;
            moved = 0u;
        }
        if (phase == 0u) {
            peak = 25.0f + 12.0f * (1.0f + 0.5f * normal());
            peak = (peak < 12.0f) ? 12.0f : ((peak > 60.0f) ? 60.0f : peak);
            start = d.theta;
        }
        const uint32_t in_motion = (phase < MOVING) ? 1u : 0u;
        const float before = d.theta;
        float torque = 0.0f;
        if (in_motion != 0u) {
            const float t = ANGULAR * STEP * (float)phase;
            const float omega_ref = peak * sinf(t), theta_ref = start + peak / ANGULAR * (1.0f - cosf(t));
            const float alpha_ref = peak * ANGULAR * cosf(t);
            torque = J * alpha_ref + c2_parallel_gravity_torque(theta_ref, &live) +
                c2_parallel_mechanical_friction_torque(theta_ref, omega_ref, &live) +
                STIFFNESS * (theta_ref - d.theta) + DAMPING * (omega_ref - d.omega);
            grease(&d, coulomb);
            run(&d, torque);
        } else { /* the brake holds */
            d.omega = 0.0f;
        }
        d.warmer -= d.warmer * STEP / COOLING;
        if ((in_motion != 0u) || (phase < MOVING + 200u)) {
            /* angle and current are of the middle of the millisecond */
            filtered(&angle, floorf(0.5f * (before + d.theta) * (COUNTS / 6.2831853f)) * (6.2831853f / COUNTS));
            filtered(&current, (in_motion != 0u) ? torque / k_i + CURRENT_NOISE * normal() : 0.0f);
        }
        const uint32_t flags = c2_parallel_adapt(
            angle.position, angle.speed, angle.acceleration, current.position, &learned, &c2_parallel_default);
        c2_parallel_adapt_apply(&learned, &live);
        moved += flags & C2_PARALLEL_ADAPT_UPDATED;
        if ((flags & (C2_PARALLEL_ADAPT_MORE | C2_PARALLEL_ADAPT_LESS)) != 0u) {
            if (sample < SAMPLES + 500u) {
                ++false_alarms;
                semihosting_write("false alarm at ");
                put(sample);
                semihosting_write("\n");
            } else if (announced == 0u) {
                announced = ((flags & C2_PARALLEL_ADAPT_MORE) != 0u) ? moved : 0u;
            }
        }
        for (uint32_t k = 0u; k < 4u; ++k) {
            broken += isfinite(learned.coefficient[k]) ? 0u : 1u;
        }
        if ((record != 0) && ((flags & C2_PARALLEL_ADAPT_STILL) == 0u)) {
            const learn_row row = {
                sample, flags, angle.position, angle.speed, angle.acceleration, current.position,
                {learned.coefficient[0], learned.coefficient[1], learned.coefficient[2], learned.coefficient[3]},
                {d.friction[0], d.friction[1], d.friction[2], d.friction[3]},
            };
            record(&row);
        }
        if ((sample + 1u) % REPORT == 0u) {
            report(sample + 1u, &learned, &d);
        }
    }
    put(false_alarms);
    semihosting_write(" false alarms, ");
    put(broken);
    semihosting_write(" numbers that are not finite\nCoulomb friction 20 % greater: announced after ");
    put(announced);
    semihosting_write(" samples in motion\n");
    return (broken != 0u) ? 1 : ((false_alarms > 1u) ? 2 : ((announced == 0u) ? 3 : 0));
}

#ifndef LEARN_ON_A_COMPUTER
int main(void)
{
    return learn(0);
}
#endif
