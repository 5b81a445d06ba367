"""Every threshold of this room, each with its reason."""

LEAST_R_SQUARED = 0.5
"""R^2 of the drive below which a log is not from this rig, or not in its units: nothing is concluded from it.

On the bundled log a current with the wrong sign leaves -1.5, one in mA -5e5, twice the mu -1.4, half of it
0.48; a k_i wrong by 30 % leaves 0.96, and logs with friction that the models lack have 0.98. A zero angle
off by 1 rad leaves 0.55: the check of data quality finds that.
"""
WAVES_OF_THE_MOTOR, WAVES_OF_THE_LINK, SPEEDS = 24, 4, 8
"""Orders of both angles and steps of the speed that may be most of what a drive does instead: cogging of a
bare motor is larger than its friction."""
ONE_FREQUENCY, LEAST_CYCLES, SAME_FREQUENCY = 0.95, 3, 1.2
"""Part of the power of the speed about one frequency from which on the log has no other to tell a delay by,
its cycles in a stretch, and its ratio between two."""
SAME = 1e-8
"""Of the largest singular value: columns that differ by less are the same, as waves of two angles can be."""
LEAST_GAIN_PERCENT = 1.0
"""A gain below this, in per cent of the held-out error, is not worth reporting."""
CONVERGED = 1e-4
"""A fit has converged if a further step changes it by less than this, relative: results have four digits."""
DELAYS = 1.0, 0.0, 2.0, 4.0
"""Where the search for a delay starts, in steps of the log: its cost has a minimum between any two rows."""
LONGEST_DELAY_S, LONGEST_DELAY_STEPS = 0.1, 6.0
"""The range of a delay ends at the longer of these: drives answer in far less, coarse logs round to steps."""
ANGLE_STEP = 0.1
"""Typical step of a zero angle [rad]: the torque of gravity is a sine of it."""
STARTS, STEPS_OF_A_RANGE = (0.5, 0.1, 0.9), 4.0
"""Where the search for a quantity known by a range starts, as parts of it, and how many steps span it."""
SHAPE_STEP = 1e-3
"""Step of the slope by a shape, over its range: a state along the log is smooth over it, rounding is not."""
FIRST_PART, HALVINGS = 1e-3, 6
"""Of the interval of a shape without a slope: the first step from it, over its range, which then doubles, and
the halvings of the last: an end is known to a part of its distance."""
AT_END = 1e-4
"""Part of its range within which a shape is at an end: a bounded search stops short of it."""
LEAST_RESOLVED = 0.02
"""Part of the rows of a fit that must resolve a ripple for the others to be left out of it."""
LEAST_IN_PLANE = 1e-3
"""Cosine of a tilt below which a plane counts as level: a thousandth of gravity acts in it."""
LEAST_TILT = 1e-6
"""Tilt [rad] below which gravity counts as independent of it to first order."""
AT_ONCE = 64
"""Samples of a hidden state that become numbers of Python at once: most of its excursions are shorter."""
MOST_KEPT = 40
"""Shapes whose states are kept: a search returns to the points of its grid."""
KEPT_STEPS = 200
"""Updates of hidden states that are kept: every effect has a few, and a fit returns to each many times."""
MOST_POINTS = 4000
"""Points of a figure: more cover each other, and make its file large."""
MOSTLY_OFF = 0.5
"""Part of a row with the motor off from which on the row has no drive to be compared in."""
USABLE_PART = 0.5
"""Least fraction of usable samples in a row for effects of the armature to be fitted on it."""
MOST_STEPS, LAST_STEP = 8, 1e-9
"""Steps of the refit at most, and the relative change that ends it earlier: far below the digits shown."""

# The regression.

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
