/* Feed-forward friction compensation in a 1 kHz loop.
 *
 * A current-controlled drive swings an arm with an unbalanced mass along a reference, beyond the velocity at
 * which the centrifugal force carries the whole weight at the top: there the bearing bears no load. It does
 * so twice: with the torque that inertia and gravity need fed forward, then with the friction torque of
 * c2_parallel.c on top. Printed is the tracking error. */
#include "arm.h"
#include "c2_parallel.h"
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
#define SAMPLES 8000u /* of one run: two swings forth and back */
#define LEAST_GAIN 5u /* of the compensation: less is a failure */

/* The reference: a sine of the motor velocity. */
#define PEAK_VELOCITY 60.0f          /* [rad/s] */
#define ANGULAR_FREQUENCY 1.5707963f /* [rad/s] */

#define STIFFNESS 2.0f /* position feedback [N m/rad] */
#define DAMPING 0.08f  /* velocity feedback [N m s/rad] */
#define SMOOTHING 0.2f /* of the velocity estimate, per sample */
#define RAD_PER_COUNT (6.28318531f / (float)ENCODER_COUNTS)

/* One run of the loop; written by the interrupt, read by main when `finished` is set. */
typedef struct {
    drive plant;
    bool compensated;
    uint32_t sample;
    int32_t encoder;
    float omega_m;       /* velocity estimate [rad/s] */
    float squared_error; /* sum over the samples [rad^2] */
    volatile bool finished;
} run;

static run current_run;

void SysTick_Handler(void);

/* The work of one millisecond: measure, compare, drive. */
void SysTick_Handler(void)
{
    run *const r = &current_run;
    if (r->finished) {
        return;
    }
    const float phase = ANGULAR_FREQUENCY * (float)r->sample / (float)LOOP_HZ;
    const float theta_ref = PEAK_VELOCITY / ANGULAR_FREQUENCY * (1.0f - cosf(phase));
    const float omega_ref = PEAK_VELOCITY * sinf(phase);
    const float alpha_ref = PEAK_VELOCITY * ANGULAR_FREQUENCY * cosf(phase);

    const int32_t encoder = drive_encoder(&r->plant);
    const float measured = (float)(encoder - r->encoder) * RAD_PER_COUNT * (float)LOOP_HZ;
    r->encoder = encoder;
    r->omega_m += SMOOTHING * (measured - r->omega_m);
    const float error = theta_ref - (float)encoder * RAD_PER_COUNT;

    float torque = arm_inertia() * alpha_ref + c2_parallel_gravity_torque(theta_ref, &c2_parallel_default);
    if (r->compensated) {
        torque += c2_parallel_mechanical_friction_torque(theta_ref, omega_ref, &c2_parallel_default);
    }
    torque += STIFFNESS * error + DAMPING * (omega_ref - r->omega_m);
    drive_run(&r->plant, torque / arm_torque_constant());

    r->squared_error += error * error;
    ++r->sample;
    r->finished = (r->sample == SAMPLES);
}

/* Root mean square of the tracking error over one run [0.1 mrad]. */
static uint32_t tracking_error(bool compensated)
{
    const run fresh = {.compensated = compensated};
    SYST_CSR = 0u;
    current_run = fresh;
    SYST_RVR = CORE_HZ / LOOP_HZ - 1u;
    SYST_CVR = 0u;
    SYST_CSR = SYST_RUN;
    while (!current_run.finished) {
        __asm__ volatile("wfi");
    }
    SYST_CSR = 0u;
    return (uint32_t)(1.0e4f * sqrtf(current_run.squared_error / (float)SAMPLES) + 0.5f);
}

/* Write a label and a number of tenths of a unit: further digits change with compiler and libm. */
static void print(const char *label, uint32_t tenths, const char *unit)
{
    char digits[12] = "00000000.0";
    uint32_t rest = tenths;
    for (int32_t place = 9; place >= 0; --place) {
        if (place != 8) {
            digits[place] = (char)('0' + (char)(rest % 10u));
            rest /= 10u;
        }
    }
    const char *first = digits;
    while ((*first == '0') && (first[1] != '.')) {
        ++first;
    }
    semihosting_write(label);
    semihosting_write(first);
    semihosting_write(unit);
}

int main(void)
{
    const uint32_t without = tracking_error(false);
    const uint32_t with = tracking_error(true);
    print("tracking error without friction compensation: ", without, " mrad rms\n");
    print("tracking error with friction compensation:    ", with, " mrad rms\n");
    if (with >= without / LEAST_GAIN) {
        semihosting_write("failed: the compensation gains less than a factor of 5.\n"
                          "Either the drive (drive.c) is not the one that c2_parallel was emitted for,\n"
                          "or the reference or the feedback of main.c does not suit it,\n"
                          "or it has little friction to compensate: LEAST_GAIN says what is asked.\n");
        return 1;
    }
    return 0;
}
