"""The thresholds of the regression, each with its reason."""

LEAST_PART = 1e-4
"""A combination of unit columns smaller than this counts as zero: no sensor is that precise."""
MEMBER_PART = 0.1
"""Least contribution of a column to such a combination for its coefficient to be named."""
NO_INFLUENCE = 1e-200
"""A column of this size has no influence: units differ, and sizes differ by orders of magnitude."""
BLOCK_ROWS = 256
"""Rows of one block of a QR decomposition: small enough to stay in the cache."""
ROUNDING = 1e-14
"""Relative change that ends a bounded fit: rounding, so that a bound is active or it is not."""

# Search over nonlinear values.

VALUE_CHANGE, COST_CHANGE, LEAST_SLOPE = 1e-6, 1e-9, 1e-14
"""Relative changes of values and cost, and a slope of the cost, that end a search.

Results have four digits. The slope is above zero: a value without any influence would cause a division by it.
"""
MOST_EVALUATIONS = 30
"""Designs of one search at most: it converges in ten, and a delay moves over the kinks between its rows."""
SLOPE_STEP = 0.05
"""Step of a slope, in typical steps of its value: far above rounding, well below the curvature."""
PROFILE_POINTS = 9
"""Points of a profile: its ends, its middle, and enough in between to show a second minimum."""
NEAR_END = 1e-3
"""Fraction of a range within which a value counts as being at its end: the search stays inside."""

# Uncertainty.

REPLACED = 1e-7
"""A column whose part that others do not make up is smaller than this: its square is lost in rounding."""
LITTLE_STEP = 1e-6
"""A part of a joint move that is smaller than this beside the largest is rounding."""
LITTLE = 0.01
"""An active bound that changes a value by less than this fraction of its interval is not worth mentioning."""
FRACTION = 0.1
"""Longest lag of the correlated noise over the number of rows; `uncertainty` says why."""
BLOCKS, DRAWS = 20, 2000
"""Blocks of a bootstrap, and draws: the ends of a 95 % interval have 50 of these beyond each."""
DEPENDENT = 1e-8
"""A singular value of columns of unit length below this part of the largest is zero: slopes are
differences, right to eight digits."""
PART_OF_IT = 1e-3
"""A coefficient with this part of such a direction is not determined: smaller parts are rounding."""
