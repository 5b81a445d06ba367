"""The thresholds of the decisions of this room, each with its reason."""

LEAST_PART = 1e-4
"""A combination of unit columns smaller than this counts as zero: no sensor is that precise."""
MEMBER_PART = 0.1
"""Least contribution of a column to such a combination for its coefficient to be named."""
NEAR_END = 1e-3
"""Fraction of a range within which a value counts as being at its end: the search stays inside."""
LITTLE = 0.01
"""An active bound that changes a value by less than this fraction of its interval is not worth mentioning."""
