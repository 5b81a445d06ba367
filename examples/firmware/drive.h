/* The drive that the firmware would have at its pins: here it is simulated. */
#ifndef DRIVE_H
#define DRIVE_H

#include <stdint.h>

#define ENCODER_COUNTS 4096 /* per turn of the motor */

/** State of the simulated drive; zero is at rest, the mass at the bottom. */
typedef struct {
    float theta_m;  /**< motor angle [rad] */
    float omega_m;  /**< motor velocity [rad/s] */
    uint32_t noise; /**< state of the encoder's noise */
} drive;

/** Run the drive for one millisecond.
 *  @param[in,out] state  of the drive
 *  @param[in]     current  in the armature [A]
 */
void drive_run(drive *state, float current);

/** What the encoder shows of the motor angle, in counts, with noise of up to half a count. */
int32_t drive_encoder(drive *state);

#endif
