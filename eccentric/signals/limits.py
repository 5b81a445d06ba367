"""Every threshold of this room, each with its reason; those of the record's quality are in its own folder."""

# Which rows of a file count.

MOST_REJECTED = 0.2
"""A log of which more than this part of the rows is not numbers is refused."""
MUCH_LOST = 0.05
"""A loss of this part of the log is a warning: above it, what is left may no longer be like the whole."""
GAP_STEPS = 5.0
"""A time step longer than this many median steps is a gap."""
JITTER = 0.1
"""Time stamps within this fraction of a step of an even grid count as even (stamps are often rounded)."""
RATE_LOW, RATE_HIGH = 0.9, 1.1
"""The rate of a log over the declared one: outside, time is in another unit."""
UNEVEN_STEP = 0.2
"""A time step this far from the median, as a fraction of it, is counted as uneven."""

# Which rows move.

HALF_SPAN_S = 0.02
"""Half the span of the central difference that decides whether a row moves, s."""
REVERSAL_S = 0.06
"""No reversal within this time of a moving row, s."""
END_S = 0.5
"""Rows closer than this to either end of a stretch are not used: filters have not settled there, s."""
SWITCHING_S = 0.1
"""Rows this near to a switching of the motor are not used, s: a filter mixes driven and free motion."""
QUANTA = 10.0
"""Default moving threshold: this many encoder steps within the 40 ms of the central difference ..."""
SLOW = 0.03
"""... and at least this fraction of the 95th percentile of the speed, outside the held-out part."""

# What is held out where the rig does not say.

HELD_OUT_PART = 0.2
"""A fifth: an error on less is uncertain, and more is missing from the fit."""
HELD_OUT_BLOCKS = 5
"""Contiguous blocks of one run: a single one might lie where the rig does something special."""

# What the angle can resolve.

TOO_NOISY = 0.1
"""Noise in the acceleration, as a part of it, from which the default low pass does not serve."""
QUIET = 0.02
"""The part that the chosen cut-off leaves: with it, a term in the acceleration is known to 2 %."""
LOWEST_HZ = 3.0
"""Cut-off below which the swing of the link itself would be filtered away."""
COARSE = 0.4
"""Cut-off over sampling rate above which a log is too coarse to be filtered: Nyquist's half, and a margin."""
POINTS_PER_ROW = 2
"""Of a log that is too coarse: a reversal is then known to 4 % of a window."""
MAP_RUNS = 8
"""Runs of constant speed from which they are a map of friction over speed."""
MAP_STEADY = 0.3
"""Standard deviation of the speed inside a run over its mean, at most, in the middle one of all runs."""
MAP_RANGE = 0.5
"""Least range of the runs' speeds, over the largest: runs of one speed are no map."""

# Whether angle and speed belong together.

WRAP_HOLE, WRAP_FULL = 0.25, 0.75
"""A wrapped angle steps by about a period, 0.75 to 1.25 of it, and never by something like half of one."""
LEAST_SPEED_FACTOR, LARGEST_SPEED_FACTOR = 0.9, 1.1
"""A logged speed over the slope of its angle: the scales of drives and tachometers are better than this."""
LEAST_CORRELATION = 0.9
"""Least correlation of the two: below, a fifth of the speed's square is something else."""
COMPARED_S, COMPARED_ROWS = 0.2, 5
"""Speed and angle are compared over this time: longer than encoder steps and filters of drives matter."""
NEAR_CAUSE = 0.03
"""A cause is named where its factor is met this closely; rpm (9.55) and a gear of 10 are 0.046 apart."""

# How samples become rows.

BLOCK_S = 1.0
"""Rows this far apart count as independent, s."""
MANY_RUNS = 5
"""Runs in the training part from which each is left out as a whole in cross-validation."""
LEAST_HELD_OUT = 2
"""Rows that an error on what is held out has an interval from."""
LEAST_RUN_PART = 1 / 3
"""Part of a run that has to be usable for a mean of it; the ends of a short run take a third themselves."""
LEAST_WINDOWS = 50
"""Fewer windows leave the search nothing to cross-validate on."""
MOST_WINDOWS = 8000
"""Windows of a long log are spaced wider, so that about so many remain."""
WINDOW_S = 0.064
"""Length of the search's windows for a low pass of 25 Hz, s; in proportion to its period for others."""
STEPS = 12
"""Steps in a window of a coarse log: 0.3 s at 40 rows per second, where a second difference is mostly
rounding."""
LEAST_WINDOW_ROWS = 7
"""Rows that a window integrated by parts has to hold: with fewer, its weights are those of a difference."""
MOVING_PART = 0.5
"""Least part of a window's weight on moving rows, in a log too coarse for windows that only move."""
PER_COEFFICIENT, PER_COEFFICIENT_OF_RUNS = 10, 3
"""Least rows for each coefficient of a fit: means over a time overlap and share what is slow, means of whole
runs do not."""
