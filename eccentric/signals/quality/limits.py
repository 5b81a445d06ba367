"""Every threshold of data quality, each with its reason."""

import math

# Single signals.

SHORT_RUN = 3
"""Equal values in a row that count as clipping: noise occasionally gives two of them."""
CLIPPED_RUN = 3
"""The same over the longest run of equal values elsewhere: a coarse or stepped channel has some."""
CLIPPED = 0.01
"""Least fraction of rows at the limit: below it, clipping changes a least-squares fit by less than its
noise."""
FROZEN_ROWS, FROZEN_S = 25, 0.5
"""Least length of a frozen stretch; a slow constant speed can be as steady for half as long."""
CHANCE = 1e-6
"""Chance of that many equal values in a row by noise alone; if smaller, the channel is frozen."""
MOST_EQUAL = 0.5
"""A channel that repeats itself more often than this is too coarse to be distinguished from a frozen one."""
LEAST_EQUAL = 1e-3
"""Least chance of two equal values that a log can show: it may have none by luck."""
MOSTLY_MOVING = 0.5
"""Least part of a frozen stretch in which the drive moves: at rest a channel may keep its value."""
TOP_SPEED = 0.95
"""Quantile of the speed that counts as the top one: single rows are noise."""
STEADY = 0.01
"""Change of the speed over a frozen stretch, as a fraction of the top speed, that counts as none."""
JUMP = 3.0
"""An angle that was frozen catches up in one step, this many times as large as its largest usual one."""
LARGEST_STEP = 0.999
"""Quantile of the steps of an angle that counts as the largest usual one, the jumps themselves not."""
BEHIND = 20.0
"""Motion by a logged speed while the angle is frozen, in such steps: no speed filter lags that long."""
NEARLY_ALL = 0.1, 0.9
"""Quantiles of the speed: "nearly all" rows are between them."""
ONE_SPEED = 1.25
"""Speeds within this factor are one level: over it, Coulomb and viscous friction differ by a ninth, less than
the friction's own scatter from turn to turn."""

# The drive against the motion, on means of blocks.

MEAN_S, MEAN_ROWS = 0.15, 5
"""Averaging time: longer than delays and noise, shorter than a swing."""
LEAST_MEANS = 30
"""With fewer blocks, six coefficients would be left to chance."""
SIGMAS = 9.0
"""Least distance from zero in standard errors. They assume independent blocks and Coulomb and viscous
friction; an error that lasts ten blocks makes them three times too small, and three are required."""
EXPLAINED = 0.5
"""Least fraction of the drive's variance explained by the rigid body for its coefficients to count."""

SEEN = 0.5
"""Part of the amplitude of gravity that the travel must show, as between 30 deg to either side of where the
mass hangs."""

# Log and rig.

FACTOR = 2.0
"""Inertia and gravity of a rig are known to better than this factor, and no effect of the library hides that
much of them in a mean."""
AGREES = 1.05
"""Beyond the uncertainty by this factor a declared value is doubted: gear losses move gravity as much."""
FACTOR_MOTOR = 1.5
"""The same for R and k_e, which are easily measured; a hot winding adds 0.4 to R."""
WARM = 1.2
"""Beyond the uncertainty by this factor R and k_e are doubted, though not wrong: copper has 1.2 times its
resistance 50 K warmer, which is more than most logs show, and magnets lose less."""
IDEAL = 5.0
"""k_i and k_e are one constant in SI. Conventions of phases (sqrt 3, 1.5, rms) and of the side of the gear's
losses part them by up to 3; a decade is a wrong unit."""
LEAST_OHM = 5e-3
"""Less resistance than any winding with its leads that a drive of a few kilowatts has."""
NOTICED = 0.1
"""Least fraction of the drive that accelerates, by log or rig, to judge the inertia: below it, the lag
of a drive that averages its signals looks like inertia."""
TURNED = math.radians(45.0)
"""An imbalance of another part turns gravity by a few degrees, a wrong zero angle by any amount."""
BETTER = 0.5
"""A different unit of the angle has to leave less than this fraction of the variance."""
NEAR = math.log(1.2)
"""A cause is named if its factor matches this closely; friction other than Coulomb and viscous, and a warm
winding, change the value from the log by less, and units differ by more."""
DIRECT = 0.5, 2.0
"""Gears between these are nearly direct: a channel on the wrong side looks like friction or a wrong scale."""
REDUCED = 0.7
"""Gears below this square to less than a half: an inertia on the wrong side differs from a right one."""
DEPENDENT = 1e-6
"""Relative singular value of a design below which coefficients cannot be separated; far above rounding."""
ROUNDING = 1e-8
"""The same of a design, below which a direction is left out of the solution."""
LEVEL = 1e-9
"""Part of the upright gravity that rounding leaves of it in a level plane, at most."""
LEVEL_PLANE = 0.2
"""Less gravity than this fraction of the rig's means a nearly horizontal plane."""
ONE_WAY = 0.2
"""Least part of the means in each direction for a drive's sign to be looked at."""
ONE_SIGN, SAME_SIZE = 0.99, 0.8
"""Part of the means of one sign, and the smaller mean of a direction over the larger, from which on the sign
is missing: a load that does the same is nine times the friction."""
