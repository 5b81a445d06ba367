"""The thresholds of the decisions of this room, each with its reason."""

LEAST_R_SQUARED = 0.5
"""R^2 of the drive below which a log is not from this rig, or not in its units: nothing is concluded from it.

On the bundled log a current with the wrong sign leaves -1.5, one in mA -5e5, twice the mu -1.4, half of it
0.48; a k_i wrong by 30 % leaves 0.96, and logs with friction that the models lack have 0.98. A zero angle
off by 1 rad leaves 0.55: the check of data quality finds that.
"""
LEAST_GAIN_PERCENT = 1.0
"""A gain below this, in per cent of the held-out error, is not worth reporting."""
CONVERGED = 1e-4
"""A fit has converged if a further step changes it by less than this, relative: results have four digits."""
USABLE_PART = 0.5
"""Least fraction of usable samples in a row for effects of the armature to be fitted on it."""
MOST_STEPS, LAST_STEP = 8, 1e-9
"""Steps of the refit at most, and the relative change that ends it earlier: far below the digits shown."""
