"""Every threshold of this room, each with its reason."""

# Sums of a file.

BATCH_ROWS = 2**19
"""Rows of a file in memory at a time: two copies of about ten 8-byte columns stay below 100 MB."""
WINDOW_PERIODS = 2.4
"""Window length in cut-off periods: the weight (1 - s^2)^4 then halves a signal at half the cut-off."""
SHARES = 4
"""Windows are spaced by a quarter of their length: closer ones add no information."""
LEAST_SHARE = 2
"""Fewest samples between windows: below eight per window the second derivative is a mere difference."""
LEAST_STEPS = 2
"""Fewest steps in a stretch to determine its sampling rate."""
SLOW = 0.03
"""A window moves above this fraction of the file's fast speed, unless the rig has a threshold ..."""
FAST_PART = 0.95
"""... where fast is the speed not exceeded over this fraction of the travel; by time, it would be noise in a
file that is mostly at rest."""
QUANTA = 10.0
"""A moving window covers at least this many encoder counts, where the rig gives them: an encoder at rest may
jitter by one or two."""
SPEED_BIN = 1.01
"""Ratio of successive speed bins: the threshold is then accurate to 1 %, whatever the file's length."""
STUCK_PART = 0.5
"""A drive signal that repeats its value in this fraction of the moving rows is stuck: a sensor of few bits,
or a loop at zero, repeats less."""
BLOCKS = 32
"""Blocks of a file with separate sums: intervals come from the scatter between blocks, and a variance
accurate to a quarter takes about 32."""

MADE_WITH = (
    *(WINDOW_PERIODS, SHARES, LEAST_SHARE, LEAST_STEPS, SLOW, FAST_PART, QUANTA, SPEED_BIN, STUCK_PART),
    *(BLOCKS,),
)
"""Sums computed with other values are recomputed."""

# Sums that can be solved.

LEAST_SECONDS = 5.0
"""A period with less motion than this [s] is not excited: a few moves do not represent a month."""
LEAST_BLOCKS = 4.0
"""Moving blocks per coefficient: with fewer, the variance between them is poorly determined."""
NO_COLUMN = 1e-10
"""A column no larger than this fraction of the largest counts as zero."""
MEMBER_PART = 0.3
"""Component of the null direction from which a column belongs to it: ten equal columns have 0.32 each."""
LEAST_DIRECTION = 0.02
"""Fraction of motion in the rarer direction below which offset and Coulomb friction are one column."""
STUCK_PERIODS = 3
"""Consecutive periods with one temperature value that make a sensor stuck: a cold store may have two."""

MOST_SCALE = 1.5
"""Ratio of inertia and gravity to the rig's, or its inverse, from which the rig must be another joint's: a
payload, or a k_i wrong by a third, is reported as a change or a value instead."""

# Drift.

LEAST_PERIODS = 5
"""Fewest periods for a test: intercept, temperature, change, and two degrees of freedom for the scatter."""
PERIODS_FOR_CURVATURE = 10
"""From this many periods on, a quadratic temperature term is fitted too: viscosity is exponential in
temperature, and over the 16 K of a season the second order is 1 to 2 % of the friction."""
LEAST_RANGE_K = 2.0
"""A temperature that varies less over the periods is not fitted: it would only cost a degree of freedom."""
LEAST_SIDE = 2
"""Fewest periods before and after a change: a single one may be an outlier."""
LEAST_CHANGE = 0.05
"""Smallest change that counts, as a fraction of the friction torque: a temperature law leaves about 2 %, and
with thousands of joints even that would be significant."""
LEAST_RESIDUAL = 0.15
"""Smallest relative change of the residual that counts: sensors vary by less from month to month."""
MOST_PRIOR = 60.0
"""Largest degrees of freedom of the fleet's scatter: joints are not copies of each other."""
RATE = 0.01
"""Default false discovery rate of the tests. A changed joint has several discoveries, so the fraction of
joints inspected in vain may be larger."""

# Explanation of a change.

LEAST_PAST = 3
"""Fewest periods before a change that show the temperature dependence; with fewer, all periods are used."""
EXPLAINED = 0.8
"""Fraction of the new error (squared) that changed coefficients have to explain: otherwise the cause has no
column in the model."""
SECOND = 0.15
"""Fraction of the new error that a second coefficient has to explain to be named as well: correlated
coefficients share a change, and noise gives the second about 10 %."""
SAMPLE_ROWS = 20_000
"""Rows of each log in a diagnosis, past and recent: it identifies effects of a tenth of the friction from a
minute of motion, and takes 0.5 ms and 9 kB per row, here 180 MB, a fifth of a worker."""
EFFECT_PERCENT = 15.0
"""Smallest reduction of the held-out error by a new effect, in percent of the coefficients' residual."""

# Distribution of the work.

TASK_BYTES = 2**26
"""Size of a task: its work is tens of times the scheduler's overhead."""
TASK_PART = 0.5
"""Task size as a fraction of a thread's share of the remaining bytes, if smaller: all threads then finish
within the time of the last tasks ..."""
LAST_BYTES = 2**22
"""... which are at least this large: smaller tasks cost more overhead than they save waiting."""
TASK_FILES = 64
"""Most files in a task."""
PART_FILES = 64
"""Most logs of a joint whose sums are written together: the work lost when a run is killed."""
MOST_PARTS = 32
"""Sum files of a joint before they are merged: each costs a reader about 0.1 ms."""
AHEAD = 4
"""Tasks per thread submitted ahead of time."""
ALIVE_S = 3.0
"""Interval of checks that the scheduler is alive [s]."""
WORKERLESS_S = 60.0
"""Timeout for a scheduler without any worker [s]: starting one on demand takes about 10."""
CONNECT = "5s"
"""Timeout of a connection to the scheduler."""
DEATHS = 1
"""Worker deaths before a task is abandoned: one may be chance, and a task that needs too much memory kills
every worker."""
WORKER_BYTES = 10**9
"""Memory limit of a local worker, as documented for fleets."""
KEPT_BYTES = 2**25
"""Freed memory that a local worker retains for its next arrays: more than one array of a batch, small
compared with WORKER_BYTES."""
