"""Every threshold of the report, each with its reason."""

STRETCH_S = 6.0
"""Longest stretch of the measured and simulated drive: more, and lines of a page's width hide each other."""
GAP_STEPS = 3.0
"""A step of time this many usual ones long ends a line: rows at standstill are left out in between."""
BLOCK_S = 1.0
"""Residuals this far apart count as independent, as in the intervals of the scores."""
LEAST_BLOCKS = 5
"""Fewest of them for a standard error: of fewer, it is left to chance, and of one it is zero."""
SIGMAS, LEAST_DIFFERENCE = 5.0, 0.05
"""A run's friction is another one beyond this many standard errors and by this part: that of a greased gear
differs by some per cent from day to day."""
SHOWN_RUNS = 12
"""Runs of the table that are not folded."""
MOST_NAMED = 3
"""Tied effects in a headline: more are a list, which follows below it."""
CLOSE = 0.9
"""Correlation from which two estimates are named: their own errors are then more than twice those of their
combination."""
