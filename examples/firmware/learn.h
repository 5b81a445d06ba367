/* A drive whose grease warms, and the firmware that follows its friction. */
#ifndef LEARN_H
#define LEARN_H

#include <stdint.h>

#include "c2_parallel_adapt.h"

/** What the firmware saw in one sample, and what was true: for a program that checks it on a computer. */
typedef struct {
    uint32_t sample;
    uint32_t flags; /**< of c2_parallel_adapt */
    float theta_m, omega_m, alpha_m, i; /**< as filtered */
    float learned[4], real[4]; /**< B_lN, C_lN, B_m, C_m */
} learn_row;

/** Run the drive; call `record`, unless it is 0, for each sample in motion. Return 0, or what failed. */
int learn(void (*record)(const learn_row *row));

#endif
