"""Every threshold of this room, each with its reason; those of data quality are in `quality`."""

# Which rows of a file count.

MOST_REJECTED = 0.2
"""A log with more than this fraction of rows that are not numbers is refused."""
LARGEST, SMALLEST = 1e12, 1e-12
"""Size of a value in SI: no clock or sensor gives a larger one, and the largest of a drive that works is not
smaller. Fourth powers of both are numbers."""
MUCH_LOST = 0.05
"""Losing this fraction of the log is a warning: beyond it, the rest may not represent the whole."""
GAP_STEPS = 5.0
"""A time step longer than this many median steps is a gap."""
LINE_ORDERS, LINE_REACH = 5, 0.08
"""Highest order of a line that gives the angle, and how far from the logged speed it may be: closer than half
the distance between two orders."""
LINE_POWER = 50.0
"""Power of such a line over the median around it: of white noise, the largest of thousands has 15."""
SAME_CLOCK = 0.005
"""Part by which the line and the logged speed may differ if both clocks are right: a quartz is far better, a
speed in whole revolutions per minute is not."""
LINE_TRACK = 8.0
"""Cycles of a line over which its phase is a mean."""
LINE_TURNS = 20
"""Turns that tell a line from its neighbours."""
NEAR_PEAK = 0.99
"""Part of the highest speed down to which a coast-down may still have been driven: a speed loop keeps it."""
FEWEST_TURNS = 8
"""Turns of a run whose rows are turns: a quintic spline and a held-out part need some more than six."""
SAME_TURN = 0.2
"""Part by which two turns may differ that count as equally long: a missed event makes one 100 % longer."""
CHANGED_TURN = 2.0
"""Ratio of a turn to the one before that begins another piece: a shaft pushed by hand, or nearly at rest."""
TURNS_SMOOTHER = 0.5
"""Roughness of turns read from the row before over that from the row of the count, from which it is taken."""
JITTER = 0.1
"""Time stamps within this fraction of a step of an even grid count as even (stamps are often rounded)."""
RATE_LOW, RATE_HIGH = 0.9, 1.1
"""The rate of a log over the declared one: outside, time is in another unit."""
ROUNDED_RATE = 1e-6
"""Sampling rates of the windows of a log within this fraction are one: stamps are rounded."""
UNEVEN_STEP = 0.2
"""A time step this far from the median, as a fraction of it, is counted as uneven."""

WINDOWS_OF_A_COAST = 100.0
"""Windows of the longest coast-down: over each the speed falls by a hundredth, which a cubic follows."""

# Rows that are damaged.

FEWEST_OF_A_RECORDING = 3
"""Rows of a recording after which time starts again: of fewer there is no acceleration."""
FROZEN_ROWS, FROZEN_TIMES, CHANGING = 20, 5, 0.9
"""Rows at the end that repeat one: at least so many, so many times the most before them, in a log in which
this part of the rows differs from the one before. The last digit of a sensor alone changes that often."""
FEWEST_BESIDE, ASTRAY, LONE = 50, 20.0, 3
"""Rows of a run of which one may be damaged; by how many times the largest other step it has to be off: no
acceleration reaches that and is gone again; and how many such rows there may be: more are a signal's way."""
WRAPS = 0.1
"""How close, in parts of it, a step comes to the range or to a turn where an angle wraps."""
MOST_NEW, AT_ONCE = 0.5, 1.15
"""A log that is written faster than its source changes: at most this part of its rows has anything new, and
as many, up to this factor, as the channel has that changes most. Steps of two sensors coincide by chance."""
MOST_TOO_LARGE = 0.01
"""A few values beyond any sensor's are damaged rows; more of them are a wrong unit."""

# Which rows move.

HALF_SPAN_S = 0.02
"""Half the span of the central difference that decides whether a row moves, s."""
REVERSAL_S = 0.06
"""A moving row has no reversal within this time, s."""
END_S = 0.5
"""Rows closer than this to either end of a stretch are not used, since filters have transients there, s."""
END_PART = 0.25
"""Of a stretch shorter than four times that, this part is left out at either end: three periods of 25 Hz in
half a second, after which the transient of the low pass is below a thousandth."""
SWITCHING_S = 0.1
"""Rows this close to switching the motor are not used, s: a filter mixes driven and free motion."""
QUANTA = 10.0
"""Default moving threshold: this many encoder steps within the 40 ms of the central difference ..."""
SLOW = 0.03
"""... and at least this fraction of the 95th percentile of the speed, outside the held-out part."""

# What is held out by default.

HELD_OUT_PART = 0.2
"""A fifth: an error on less is uncertain, and holding out more takes too much from the fit."""
FEWEST_RUNS_HELD_OUT = 3
"""Fewest runs of which whole ones are held out: of two, the other half would be too little to fit on."""
HELD_OUT_BLOCKS = 5
"""Contiguous blocks of one run: a single one might fall where the rig does something special."""

# What the angle can resolve.

LEAST_FILTERED = 30
"""Shorter stretches, in rows, are not filtered: three paddings of the filter."""
LEAST_STRETCH = 40
"""Stretches of at most this many rows say little about noise: the filter's ends are most of them."""
LEAST_DIFFERENCES = 30
"""Fewest fourth differences for an RMS of the noise: it is then known to a fifth."""
MOST_STRETCHES = 5
"""Windows of a long log, evenly spread, that its noise is measured on: each shows it to a few percent."""
TOO_NOISY = 0.1
"""Noise in the acceleration, as a fraction of it, above which the default low pass is unsuitable."""
QUIET = 0.02
"""The fraction that the chosen cut-off leaves: a term in the acceleration is then known to 2 %."""
FAST = 0.02
"""The part of the square of the acceleration, above a cut-off, from which that is too low: a seventh of
J alpha would be missing."""
RAISED = 0.2
"""Largest ratio of a raised cut-off to the sampling rate: the derivative is right to 0.5 % there."""
FILTERED = 3.0
"""An error above the low pass that exceeds this multiple of the sensors' noise there is not noise."""
LOWEST_HZ = 3.0
"""Lowest cut-off: below it, the swing of the link itself would be filtered out."""
NARROWER = 0.6
"""Cut-off of a narrower low pass, in that of the first: a quarter of the noise in the acceleration."""
COARSE = 0.4
"""Largest ratio of cut-off to sampling rate, else a log is too coarse to filter: Nyquist, with a margin."""
BELOW_COARSE = 0.9
"""Of that, the cut-off of an arm whose log is too coarse for the default: stamps are rounded."""
RATE_PER_CUT = 10.0
"""Least rate of the points of a thinned log, in its low pass: its derivatives are right to 0.02 % there."""
LEAST_RATE_HZ = 200.0
"""Least rate of them: which rows move is decided over 20 ms to either side."""
POINTS_PER_ROW = 4
"""Of a log that is too coarse: a reversal is then known to 2 % of a window."""
MAP_RUNS = 8
"""Least number of constant-speed runs for a map of friction over speed."""
MAP_PARTS = 8
"""The speed of such a run is taken over an eighth of it: ripple from encoder or firmware is not motion."""
MAP_STEADY = 0.3
"""Largest standard deviation of the speed within a run over its mean, for the median run."""
MAP_RANGE = 0.5
"""Least range of the runs' speeds, over the largest: runs at one speed are not a map."""
COARSE_ROW_S = 0.01
"""Rows this long may show that a drive is held over them: half of a shorter one changes the inertia of a
drive with a time constant of 0.3 s by less than 2 %, and what looks like it may be a delay."""
PROVED = 3.0
"""Standard errors of the evidence for a hold: one log in 700 of sampled drives would show as much."""
CIRCUIT_EXPLAINED = 0.9
"""R^2 of u = R i + k_e w from which the voltage beside a current that jumps is that of its winding."""
CIRCUIT_ROW_S = 0.02
"""Shorter rows are averaged to this for the circuit: the noise of the angle would be most of their speed."""
ANYWHERE = 12.0**-0.5
"""Standard deviation, in rows, of an instant that may be anywhere in its row."""
GUESSES = 5
"""Of when in its row a current was sampled: each leaves a tenth of the last one's error."""
JUMP = 5.0
"""Step of a voltage over the median step from which it is a jump: half of the steps of a log are noise."""
HOLD_WINDOW_S = 0.3
"""Shortest windows that the evidence is taken from: in shorter ones, the noise of an encoder of 2,000 counts
is most of the acceleration."""

# Which lines stand out of the spectrum over the angle.

LOW_ORDERS, LOW_ORDERS_OF_THE_LINK = 24, 12
"""Orders of motor and link that the library always offers: these are for the others."""
HIGHEST_LINE = 512
"""Cycles per turn: more have none of the motors that people log."""
PER_TURN = 0.4
"""Highest order over the rows of a turn at the median speed: half is Nyquist's."""
LEAST_TURNS = 1.0
"""Of the motor: in fewer, neighbouring orders are one."""
BINS_PER_CYCLE = 4
"""Of the highest order: the sum over a bin takes a tenth of its amplitude."""
AROUND_A_LINE = 31
"""Orders whose median is the floor of a line in their middle."""
STANDS_OUT = 25.0
"""Least power over that floor: among 500 orders of noise, one log in a hundred million has as much."""
LEAST_LINE_SHARE = 0.01
"""Least part of the square of what the low orders leave: less would hardly be seen in the error."""
MOST_LINES = 3
"""Lines that are offered, the strongest: a motor's own and two more."""
PARTS_OF_A_LOG, IN_PHASE = 8, 0.4
"""Parts whose phases are compared, and their agreement: half for a line in half of the log, an eighth for
none, and beyond two fifths by chance in 3 %."""
LINE_MARGIN = 1.5
"""Of the low pass over the frequency of a line at high speed."""

# Whether angle and speed belong together.

WRAP_SPAN = 1.02
"""Largest range of a wrapped angle, in periods: offsets and rounding of an encoder add a percent."""
WRAP_HOLE, WRAP_FULL = 0.25, 0.75
"""A wrapped angle steps by about a period, 0.75 to 1.25 of it, and never by about half of one."""
LEAST_SPEED_FACTOR, LARGEST_SPEED_FACTOR = 0.9, 1.1
"""A logged speed over the slope of its angle: the scales of drives and tachometers are better than this."""
LEAST_CORRELATION = 0.9
"""Least correlation of the two: below it, a fifth of the speed's square is something else."""
COMPARED_S, COMPARED_ROWS = 0.2, 5
"""Speed and angle are compared over this time: long enough that encoder steps and filters do not matter."""
NEAR_CAUSE = 0.03
"""A cause is named if its factor matches this closely; rpm (9.55) and a gear of 10 differ by 0.046."""

# The white noise of a sensor.

MEANS = (2, 4, 8)
"""Numbers of samples whose means show whether the noise is white: eight are some 30 ms of most logs, and in
longer ones the motion itself would count."""
LEAST_OF_MEANS = 1300
"""Fewest fourth differences of means: they give the noise to some 4.5 %."""
CLEARLY_LESS = 0.85
"""Noise whose means have less than this part of what they should have is not white: three standard errors."""

# How samples become rows.

BLOCK_S = 1.0
"""Rows this far apart count as independent, s."""
MANY_RUNS = 5
"""Least number of training runs for cross-validation to leave out whole runs."""
LEAST_HELD_OUT = 2
"""Least number of held-out rows for an error with an interval."""
LEAST_RUN_PART = 1 / 3
"""Fraction of a run that has to be usable for its mean; the ends of a short run alone take a third."""
LEAST_WINDOWS = 50
"""Fewer windows are not enough for the search to cross-validate on."""
MOST_WINDOWS = 8000
"""Windows of a long log are spaced more widely, so that about this many remain."""
WINDOW_PERIODS = 1.6
"""Length of the search's windows, in periods of the cut-off: 64 ms for 25 Hz."""
WINDOW_GAP = 1.5
"""A window may last this many times its usual length, for uneven stamps; longer ones contain a gap."""
STEPS = 12
"""Steps in a window of a coarse log: 0.3 s at 40 rows per second, where a second difference is mostly
rounding."""
LONGER_STEPS = (18, 24, 36, 48)
"""The same for an angle that is noisy as well ..."""
QUIET_RATE = 0.03
"""... until its noise is this part of the acceleration: the inertia is then 0.1 % too small."""
LEAST_STEPS = 8
"""Steps in the shortest window that is advised: that of a low pass at a fifth of the rate."""
LEAST_WINDOW_ROWS = 7
"""Least rows of a window integrated by parts: with fewer, its weights are those of a difference."""
MOVING_PART = 0.5
"""Least fraction of a window's weight on moving rows, in a log too coarse for windows of moving rows only."""
TURNING_PARTS = (0.95, 0.8)
"""The same above the threshold of the speed, reversals included, where enough windows have it: at standstill
friction is less than its law says, and J would take that."""
PER_COEFFICIENT, PER_COEFFICIENT_OF_RUNS = 10, 3
"""Least rows per coefficient of a fit: means over a time overlap and share slow disturbances, means of whole
runs do not."""

# Long logs, which are read in windows.

LONG_ROWS = 100_000
"""A log of more rows is read in windows: whole, its diagnosis would take a minute and a gigabyte."""
WINDOW_S = 10.0
"""Length of a window: the filters leave 95 % of it, and an hour has enough of them for every state."""
FIT_POINTS, SEARCH_POINTS = 50_000, 75_000
"""Most points of the windows together, after thinning, for a fit and for a search: a minute of work and less
than a gigabyte."""
POINT_RATE_HZ = 250.0
"""Rate that the points of the windows are counted at: ten times the default low pass."""

# The survey of a long log.

CELL_S = 0.02
"""States are counted, and sums taken, on cells of this length: faster than any course moves."""
COLUMNS = 9
"""Columns of the sums: seven of the base, two of it that drift, with time and temperature."""
OCTAVES = 2.0
"""Bins of speed, acceleration and drive per factor of two: friction changes little within 1.4 ..."""
LEAST_BIN, LARGEST_BIN = -5, 30
"""... from a sixth of the 95th percentile of the first batch on, below which all is one bin; and up to more
than any log has."""
ANGLES = 12
"""Bins of the link angle in a turn: within one, gravity changes by a quarter of its range."""
DEGREES_A_BIN = 2.0
"""Bins of temperature, K: friction changes by some 2 % a kelvin at most."""
VISITED_S = 1.0
"""A state counts as visited from this long on: below it, no block of the search is in it."""
JUMP = 20.0
"""A step of the angle this many times as large as its 90th percentile is a wrap."""
SAME_STEP = 1.25
"""Windows whose steps between rows differ by more than this factor have cells of their own: a cell that is
half as long again as the others counts as one with a gap."""
LEAST_CELLS_OF_A_BATCH = 4
"""A shorter batch, at the end of a file, has no second differences."""

# The choice of its windows.

ROUNDS = (0.25, 0.5, 0.75, 1.0)
"""Parts of the most points that are tried one after the other, until a further one says nothing new."""
LEAST_LONG_WINDOWS = 12
"""Fewer windows do not cover the course of an hour."""
RUNS_PART = 0.5
"""Part of the windows that may go to one for each run; with more runs, some are left out."""
AGREES = 0.01
"""Coefficients of the windows say the same as those of the whole log if they predict it this much worse, as a
fraction of the square of what both leave: half a percent of the error, less than any effect gains."""
MOST_HELD = 0.5
"""Part of the windows that may be spent on held-out intervals shorter than a window: the rest of each is
fitted, and other windows shall be seen too."""
ODD = 4.0
"""A window whose mean square residual is this many times the median one is unlike others: twice in RMS."""
ODD_PART = 0.15
"""Most of the windows that are spent on such ones: they shall be seen, and not outvote the rest."""
LEAST_CELLS = 100
"""Moving cells of a window for its residual to count: two seconds."""
DEPENDENT = 1e-9
"""Least eigenvalue of the scaled sums, relative to the largest, of a direction that is solved for."""
