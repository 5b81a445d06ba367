"""Every threshold of long logs, each with its reason."""

LONG_ROWS = 100_000
"""A log of more rows is read in windows: whole, its diagnosis would take a minute and a gigabyte."""
WINDOW_S = 10.0
"""Length of a window: the filters leave 95 % of it, and an hour has enough of them for every state."""
FIT_POINTS, SEARCH_POINTS = 50_000, 75_000
"""Most points of the windows together, after thinning, for a fit and for a search: a minute of work and less
than a gigabyte."""
POINT_RATE_HZ = 250.0
"""Rate that the points of the windows are counted at: ten times the default low pass."""

# The survey.

CELL_S = 0.02
"""States are counted, and sums taken, on cells of this length: faster than any course moves."""
COLUMNS = 9
"""Columns of the sums: seven of the base, two of it that drift, with time and temperature."""
SLOW = 0.03
"""Least speed that counts as motion, as a fraction of the 95th percentile of a batch."""
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

# The choice.

ROUNDS = (0.25, 0.5, 0.75, 1.0)
"""Parts of the most points that are tried one after the other, until a further one says nothing new."""
LEAST_WINDOWS = 12
"""Fewer windows do not cover the course of an hour."""
RUNS_PART = 0.5
"""Part of the windows that may go to one for each run; with more runs, some are left out."""
AGREES = 0.01
"""Coefficients of the windows say the same as those of the whole log if they predict it this much worse, as a
fraction of the square of what both leave: half a percent of the error, less than any effect gains."""
HELD_OUT_PART = 0.2
"""Part of the windows that lie in the held-out intervals of the rig, where there are as many: a fifth, as
without them."""
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
