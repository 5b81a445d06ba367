/* What the firmware takes the arm for: the parameters that c2_parallel was emitted with. */
#ifndef ARM_H
#define ARM_H

#include "c2_parallel.h"

#include <math.h>

/** Inertia where the model was emitted without J_m and J_l, as the paper's is: its Table 1 names none. */
#define PAPERS_INERTIA 0.0018f

/** Inertia on the motor side [kg m^2]. */
static inline float arm_inertia(void)
{
    const c2_parallel_parameters *const p = &c2_parallel_default_parameters;
    const float inertia = (float)(p->J_m + p->mu * p->mu * p->J_l);
    return isnan(inertia) ? PAPERS_INERTIA : inertia;
}

/** Torque constant [N m/A]. */
static inline float arm_torque_constant(void)
{
    return (float)c2_parallel_default_parameters.k_i;
}

#endif
