/* What the firmware takes the arm for: the parameters that c2_parallel was emitted with. */
#ifndef ARM_H
#define ARM_H

#include "c2_parallel.h"

/** Inertia where the model was emitted without J_m and J_l, as the paper's is: its Table 1 names none. */
#define PAPERS_INERTIA 0.0018f

/** Inertia on the motor side [kg m^2]. */
static inline float arm_inertia(void)
{
    const c2_parallel_parameters *const p = &c2_parallel_default_parameters;
#ifdef ECCENTRIC_NOT_GIVEN /* absent where every parameter was given */
    if ((p->J_m == ECCENTRIC_NOT_GIVEN) || (p->J_l == ECCENTRIC_NOT_GIVEN)) {
        return PAPERS_INERTIA;
    }
#endif
    return (float)(p->J_m + p->mu * p->mu * p->J_l);
}

/** Torque constant [N m/A]. */
static inline float arm_torque_constant(void)
{
    return (float)c2_parallel_default_parameters.k_i;
}

#endif
