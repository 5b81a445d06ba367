"""The thresholds of the decisions of this room, each with its reason."""

LEAST_R_SQUARED = 0.5
"""R^2 of the drive below which a log is not of this rig, or not in its units: nothing is concluded from it.

On the bundled log a current with the wrong sign leaves -1.5, one in mA -5e5, twice the mu -1.4, half of it
0.48; a k_i wrong by 30 % leaves 0.96, and logs with friction that the models lack have 0.98. A zero angle
1 rad off leaves 0.55: that is for the quality of the record to find.
"""
LEAST_GAIN_PERCENT = 1.0
"""A gain of a model below this, in per cent of the held-out error, is not worth the words."""
CONVERGED = 1e-4
"""Relative change by a further step under which a fit has converged: results are shown with four digits."""
USABLE_PART = 0.5
"""Least part of a row's samples that is usable for an effect of the armature to be fitted on it."""
MOST_STEPS, LAST_STEP = 8, 1e-9
"""Steps of the refit at most, and the relative change that ends it earlier: far below the digits shown."""
