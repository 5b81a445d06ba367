"""The thresholds of the decisions of this room, each with its reason."""

LEAST_R_SQUARED = 0.5
"""R^2 of the drive below which a log is not of this rig, or not in its units: nothing is concluded from it.

On the bundled log a wrong sign or unit, another mu and a zero angle 1 rad off leave -4000 to 0.48, a k_i
wrong by 30 % leaves 0.95; logs with friction that the models lack have 0.98.
"""
LEAST_GAIN_PERCENT = 1.0
"""A gain of a model below this, in per cent of the held-out error, is not worth the words."""
LEAST_PART = 1e-4
"""A combination of unit columns smaller than this counts as zero: no sensor is as exact."""
MEMBER_PART = 0.1
"""Least part of a column in a combination that counts as zero for its coefficient to be named."""
NEAR_END = 1e-3
"""Part of a range within which a value counts as lying at its end: the search stays inside."""
CONVERGED = 1e-4
"""Relative change by a further step under which a fit has converged: results are shown with four digits."""
LITTLE = 0.01
"""An active bound that moves a value by less than this part of its interval is not worth mentioning."""
USABLE_PART = 0.5
"""Least part of a row's samples that is usable for an effect of the armature to be fitted on it."""
