"""The thresholds of the decisions of this room, each with its reason."""

LEAST_PART = 1e-4
"""A combination of unit columns smaller than this counts as zero: no sensor is as exact."""
MEMBER_PART = 0.1
"""Least part of a column in such a combination for its coefficient to be named."""
NEAR_END = 1e-3
"""Part of a range within which a value counts as lying at its end: the search stays inside."""
LITTLE = 0.01
"""An active bound that moves a value by less than this part of its interval is not worth mentioning."""
