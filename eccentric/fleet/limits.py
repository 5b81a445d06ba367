"""Every threshold of this room, each with its reason."""

# How a file becomes sums.

BATCH_ROWS = 2**19
"""Rows of a file in memory at a time: with some ten columns of 8 bytes, twice, below 100 MB."""
WINDOW_PERIODS = 2.4
"""Length of a window in periods of the cut-off: the weight (1 - s^2)^4 then halves a signal at half of it."""
SHARES = 4
"""Windows are spaced by a quarter of their length: closer ones repeat what these have."""
LEAST_SHARE = 2
"""Samples between windows: eight in a window are the fewest whose second derivative is not a difference."""
LEAST_STEPS = 2
"""Fewest steps in a stretch that tell its sampling rate."""
SLOW = 0.03
"""A window moves above this fraction of the fast speed of the file, unless the rig has a threshold ..."""
FAST_PART = 0.95
"""... which is the speed that is not exceeded in this part of the way: of the time, it would be noise in a
file that mostly stands still."""
QUANTA = 10.0
"""A window moves by at least this many encoder steps, where the rig gives them: an encoder at rest may jitter
by one or two."""
SPEED_BIN = 1.01
"""Ratio of the bins of speeds: the threshold is then that of the file to 1 %, whatever its length."""
STUCK_PART = 0.5
"""A drive that repeats its value in this part of the moving rows is not measured: a sensor of few bits, or a
zero of a loop, repeats less."""
BLOCKS = 32
"""Parts of a file with sums of their own: intervals come from how these differ, and to know a variance to a
fourth takes some 32."""

MADE_WITH = (
    *(WINDOW_PERIODS, SHARES, LEAST_SHARE, LEAST_STEPS, SLOW, FAST_PART, QUANTA, SPEED_BIN, STUCK_PART),
    *(BLOCKS,),
)
"""Sums that were made with other values are made anew."""

# Which sums have an answer.

LEAST_SECONDS = 5.0
"""A period with less motion, s, is not excited: a few moves say nothing about a month."""
LEAST_BLOCKS = 4.0
"""Blocks in motion per coefficient: with fewer, the variance between them is that of a few numbers."""
NO_COLUMN = 1e-10
"""A column of which the size is no more than this part of the largest is none."""
MEMBER_PART = 0.3
"""A column belongs to a dependency with this part of its direction: that of ten equal columns is 0.32."""
LEAST_DIRECTION = 0.02
"""Part of the motion in the rarer direction, below which offset and Coulomb friction are one column."""
STUCK_PERIODS = 3
"""Periods on end in which a temperature sensor shows one value: a cold store may do so twice."""

MOST_SCALE = 1.5
"""Inertia and gravity over those of the rig, or the inverse, from which the rig is that of another joint: a
payload or a wrong k_i of a third are told as changes or as values, this is not."""

# What drifts.

LEAST_PERIODS = 5
"""Fewest periods for a test: intercept, temperature, change, and two that say how far periods scatter."""
PERIODS_FOR_CURVATURE = 10
"""From this many periods on, the curvature of a coefficient over temperature is taken out as well: lubricants
are exponential, and over the 16 K of a season the second order is 1 to 2 % of their friction."""
LEAST_RANGE_K = 2.0
"""A temperature that varies less over the periods explains nothing: it would cost a degree of freedom."""
LEAST_SIDE = 2
"""Fewest periods before and after a change: one alone is an outlier."""
LEAST_CHANGE = 0.05
"""Part of the friction torque that a change has to move: what a law of temperature leaves is some 2 %, and
with thousands of joints the smallest of those would be significant."""
LEAST_RESIDUAL = 0.15
"""Part by which what the model leaves has to change: sensors differ by less from month to month."""
MOST_PRIOR = 60.0
"""Degrees of freedom of the fleet's scatter at most: joints are not copies of each other."""
RATE = 0.01
"""False discovery rate of the tests, unless another is asked for. A joint that changed has several, so the
part of the joints that are looked at in vain may be larger."""

# What changed.

LEAST_PAST = 3
"""Periods before a change that show what temperature does: where there are fewer, all periods are asked."""
EXPLAINED = 0.8
"""Part of the new error (squared) that a change of coefficients has to explain: what is beyond is due to
something that the model has no column for."""
SECOND = 0.15
"""Part of the new error that a second coefficient has to explain to be named beside the first: coefficients
that are alike share a change, and of two the second takes some 10 % by noise."""
SAMPLE_ROWS = 20_000
"""Rows of a log that a diagnosis sees, of the past and of now: it names effects of a tenth of the friction
from a minute of motion, and takes 0.5 ms and 9 kB a row, here 180 MB, a fifth of a worker."""
EFFECT_PERCENT = 15.0
"""Least reduction of the held-out error by a new effect, in percent of what the coefficients leave."""

# How the work is spread.

TASK_BYTES = 2**26
"""Files of one task: tens of times the work that the scheduler has with it."""
TASK_PART = 0.5
"""Part of a thread's share of what is left that is one task, where that is less: all then end together ..."""
LAST_BYTES = 2**22
"""... to within the time that so much takes; smaller tasks cost more than is waited for."""
TASK_FILES = 64
"""Files of one task at most."""
PART_FILES = 64
"""Logs of a joint whose sums are written together at most: what a run that is killed has to do again."""
MOST_PARTS = 32
"""Files of sums of a joint, before one is made of them: each costs a reader some 0.1 ms."""
AHEAD = 4
"""Tasks per thread handed to the scheduler ahead of time."""
ALIVE_S = 3.0
"""A wait for results asks this often, in s, whether the scheduler is still there."""
WORKERLESS_S = 60.0
"""A scheduler without any worker is waited for so long, in s: to start one on demand takes some 10."""
CONNECT = "5s"
"""A scheduler that does not answer within this time is not there."""
DEATHS = 1
"""Workers that may die of a task before it is given up: one may by chance, and what takes too much
memory does so everywhere."""
WORKER_BYTES = 10**9
"""Memory of a local worker: what is asked of a fleet."""
KEPT_BYTES = 2**25
"""Freed memory that a local worker keeps for its next arrays: more than one of a batch, little beside
WORKER_BYTES."""
