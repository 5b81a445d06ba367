"""Every threshold of what is odd about a record, each with its reason."""

import math

# One signal by itself.

SHORT_RUN = 3
"""Equal values from row to row that clipping is counted from: noise gives two of them now and then."""
CLIPPED = 0.01
"""Least part of the rows at the limit: below, clipping changes a least-squares fit by less than its noise."""
FROZEN_ROWS, FROZEN_S = 25, 0.5
"""Least length of a frozen stretch; a slow speed that is held can be as steady as that for half as long."""
CHANCE = 1e-6
"""Chance that a log of honest noise has so many equal values in a row; smaller is a frozen channel."""
MOST_EQUAL = 0.5
"""A channel that repeats itself more often than this is too coarse to be told from a frozen one."""
STEADY = 0.01
"""Change of the speed over a frozen stretch, as a part of the top speed, that counts as none."""
JUMP = 3.0
"""An angle that was frozen catches up in one step of this many of its largest usual ones."""
ONE_SPEED = 1.25
"""Speeds within this factor are one level: Coulomb and viscous friction differ by a ninth over it, which the
friction's own scatter from turn to turn hides."""

# The drive against the motion, on means of blocks.

MEAN_S, MEAN_ROWS = 0.15, 5
"""Means are taken over this: longer than delays and noise, shorter than a swing."""
LEAST_MEANS = 30
"""Fewer blocks leave six coefficients to chance."""
SIGMAS = 9.0
"""Least distance from zero in standard errors. They count blocks as independent and the friction as Coulomb
and viscous; an error that goes on over ten blocks makes them three times too small, and three are wanted."""
EXPLAINED = 0.5
"""Least part of the drive's variance that the rigid body explains before its coefficients are believed."""

# Log and rig.

FACTOR = 2.0
"""Inertia and gravity of a rig are known better than to this factor, and no effect of the library hides so
much of them in a mean."""
FACTOR_MOTOR = 1.5
"""The same for R and k_e, which are simply measured; a hot winding adds 0.4 to R."""
NOTICED = 0.1
"""Least part of the drive that accelerates, by log or rig, for the inertia to be judged: below, the lag of a
drive that averages its signals looks like inertia."""
TURNED = math.radians(45.0)
"""An unbalance of another part turns gravity by some degrees, a wrong zero angle by any."""
BETTER = 0.5
"""Another unit of the angle has to leave less than this part of the variance."""
NEAR = math.log(1.2)
"""A cause is named where its factor is met this closely; friction that is not Coulomb and viscous, and a warm
winding, move what the log gives by less, and units differ by more."""
LEVEL = 1e-9
"""Part of the upright gravity that rounding leaves of it in a level plane, at most."""
LEVEL_PLANE = 0.2
"""Less gravity than this part of the rig's is that of a plane which is all but level."""
