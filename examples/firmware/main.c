/* Friction compensation in a 1 kHz loop.
 *
 * A current-controlled drive moves an arm with an unbalanced mass in three ways: it swings, beyond the velocity
 * at which the centrifugal force carries the whole weight at the top, so that the bearing bears no load there,
 * and reverses; it holds; it creeps. It does so without friction compensation, with the friction torque of
 * c2_parallel.c at the measured velocity, and with c2_parallel_compensation.c, which takes that of the
 * reference. What inertia and gravity need is always fed forward. Printed is what each makes of it. */
#include "arm.h"
#include "c2_parallel.h"
#include "c2_parallel_compensation.h"
#include "drive.h"
#include "semihosting.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

/* SysTick, clocked by the core. */
#define SYST_CSR (*(volatile uint32_t *)0xE000E010u)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014u)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018u)
#define SYST_RUN 7u /* enabled, with interrupt, from the core's clock */

#define CORE_HZ 25000000u
#define LOOP_HZ 1000u
#define LAST 1000u    /* samples at the end of a run that a hold is judged by */
#define LEAST_GAIN 5u /* of the compensation: less is a failure */

/* The swing: a sine of the motor velocity. */
#define PEAK_VELOCITY 60.0f          /* [rad/s] */
#define ANGULAR_FREQUENCY 1.5707963f /* [rad/s] */

#define CREEP_VELOCITY 0.3f /* [rad/s] */
#define HOLD_ANGLE 1.0f     /* [rad] */

#define STIFFNESS 2.0f /* position feedback [N m/rad] */
#define DAMPING 0.08f  /* velocity feedback [N m s/rad] */
#define SMOOTHING 0.2f /* of the velocity estimate, per sample */
#define RAD_PER_COUNT (6.28318531f / (float)ENCODER_COUNTS)

typedef enum { SWING, HOLD, CREEP, TASKS } task;
typedef enum { NONE, MEASURED, REFERENCE, LAWS } law;

static const uint32_t samples[TASKS] = {8000u, 3000u, 4000u};

/* One run of the loop; written by the interrupt, read by main when `finished` is set. */
typedef struct {
    drive plant;
    task task;
    law law;
    uint32_t sample;
    int32_t encoder;
    float omega_m;       /* velocity estimate [rad/s] */
    float torque;        /* demanded in the last sample [N m] */
    float squared_error; /* sum over the samples [rad^2] */
    float squared_step;  /* sum of the squared changes of the torque over the last samples [(N m)^2] */
    volatile bool finished;
} run;

static run current_run;
static c2_parallel_compensation_settings settings;

void SysTick_Handler(void);

/* The work of one millisecond: measure, compare, drive. */
void SysTick_Handler(void)
{
    run *const r = &current_run;
    if (r->finished) {
        return;
    }
    const float time = (float)r->sample / (float)LOOP_HZ;
    const float phase = ANGULAR_FREQUENCY * time;
    float theta_ref = HOLD_ANGLE, omega_ref = 0.0f, alpha_ref = 0.0f;
    if (r->task == SWING) {
        theta_ref = PEAK_VELOCITY / ANGULAR_FREQUENCY * (1.0f - cosf(phase));
        omega_ref = PEAK_VELOCITY * sinf(phase);
        alpha_ref = PEAK_VELOCITY * ANGULAR_FREQUENCY * cosf(phase);
    } else if (r->task == CREEP) {
        theta_ref = HOLD_ANGLE + CREEP_VELOCITY * time;
        omega_ref = CREEP_VELOCITY;
    }

    const int32_t encoder = drive_encoder(&r->plant);
    const float measured = (float)(encoder - r->encoder) * RAD_PER_COUNT * (float)LOOP_HZ;
    r->encoder = encoder;
    r->omega_m += SMOOTHING * (measured - r->omega_m);
    const float error = theta_ref - ((float)encoder + 0.5f) * RAD_PER_COUNT;

    float torque = arm_inertia() * alpha_ref + c2_parallel_gravity_torque(theta_ref, &c2_parallel_default);
    torque += STIFFNESS * error + DAMPING * (omega_ref - r->omega_m);
    if (r->law == MEASURED) {
        torque += c2_parallel_mechanical_friction_torque(theta_ref, r->omega_m, &c2_parallel_default);
    } else if (r->law == REFERENCE) {
        torque += c2_parallel_compensation(theta_ref, omega_ref, r->omega_m, error, torque, &settings, &c2_parallel_default);
    }
    drive_run(&r->plant, torque / arm_torque_constant());

    r->squared_error += error * error;
    if (r->sample >= samples[r->task] - LAST) {
        r->squared_step += (torque - r->torque) * (torque - r->torque);
    }
    r->torque = torque;
    ++r->sample;
    r->finished = (r->sample == samples[r->task]);
}

/* Run a task with a law, from rest at its start. */
static void carry_out(task what, law with)
{
    run fresh = {.task = what, .law = with};
    fresh.plant.theta_m = (what == SWING) ? 0.0f : HOLD_ANGLE;
    fresh.encoder = drive_encoder(&fresh.plant);
    SYST_CSR = 0u;
    current_run = fresh;
    SYST_RVR = CORE_HZ / LOOP_HZ - 1u;
    SYST_CVR = 0u;
    SYST_CSR = SYST_RUN;
    while (!current_run.finished) {
        __asm__ volatile("wfi");
    }
    SYST_CSR = 0u;
}

/* Root mean square of the tracking error [0.1 mrad]. */
static uint32_t tracking_error(void)
{
    return (uint32_t)(1.0e4f * sqrtf(current_run.squared_error / (float)samples[current_run.task]) + 0.5f);
}

/* Root mean square of what the torque changes by from one sample to the next, at the end [0.1 mN m]. */
static uint32_t chatter(void)
{
    return (uint32_t)(1.0e4f * sqrtf(current_run.squared_step / (float)LAST) + 0.5f);
}

/* Write tenths of a unit in a column: further digits change with compiler and libm. */
static void print(uint32_t tenths)
{
    char digits[12] = "         .0";
    uint32_t rest = tenths;
    for (int32_t place = 10; (place >= 8) || (rest != 0u); --place) {
        if (place != 9) {
            digits[place] = (char)('0' + (char)(rest % 10u));
            rest /= 10u;
        }
    }
    semihosting_write(digits);
}

int main(void)
{
    static const char *const names[LAWS] = {"no compensation     ", "measured velocity   ", "reference velocity  "};
    uint32_t swing[LAWS];
    settings = c2_parallel_compensation_default;
    settings.encoder_step = RAD_PER_COUNT;
    settings.tick = 1.0f / (float)LOOP_HZ;
    settings.band = RAD_PER_COUNT * (float)LOOP_HZ;
    if (c2_parallel_compensation_prepare(&c2_parallel_default_parameters, &settings) != 0) {
        semihosting_write("failed: a setting of the compensation is invalid\n");
        return 1;
    }
    semihosting_write("friction at the          swing      creep  chatter at rest\n"
                      "                      mrad rms   mrad rms  mN m rms\n");
    for (law with = NONE; with < LAWS; ++with) {
        semihosting_write(names[with]);
        carry_out(SWING, with);
        swing[with] = tracking_error();
        print(swing[with]);
        carry_out(CREEP, with);
        print(tracking_error());
        carry_out(HOLD, with);
        print(chatter());
        semihosting_write("\n");
    }
    if (swing[REFERENCE] >= swing[NONE] / LEAST_GAIN) {
        semihosting_write("failed: the compensation gains less than a factor of 5.\n"
                          "Either the drive (drive.c) is not the one that c2_parallel was emitted for,\n"
                          "or the reference or the feedback of main.c does not suit it,\n"
                          "or it has little friction to compensate: LEAST_GAIN says what is asked.\n");
        return 1;
    }
    return 0;
}
