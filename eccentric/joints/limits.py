"""Every threshold of this room, each with its reason."""

from __future__ import annotations

# Base parameters.

RANK = 1e-4
"""A column of which less than this part is left beside those taken is a combination of them: filtered angles
are that precise at best, and what is weaker would be identified from their errors."""
LEAST_SHARE_IN_SUM = 1e-6
"""A coefficient below this is rounding and not part of a sum."""

# Bodies that could exist.

PROJECTIONS = 4000
"""Projections onto the conditions in turn: arms of six joints need some hundreds."""
LEAST_EIGENVALUE = 1e-7
"""Of the moments of a body, in units of the arm's own masses and lengths: none is exactly flat."""
TIGHTEST = 1e-9
"""Least standard error, by the largest: without noise rounding is left, which must not outweigh the rest."""
IN_ERRORS = 3.0
"""Standard errors by which a base parameter may miss the identified one: of fifty, one misses by 2.5."""

# Loads that friction may follow.

NEGLIGIBLE = 1e-3
"""A load below this part of the largest of its kind is the rounding of an angle in the arm file, or
too small to show: 1e-3 of the torque, times a coefficient of friction, is below any noise."""
VARIES = 3e-3
"""Part of a load's columns that Coulomb and viscous friction and the other loads must leave: a load that is
constant on the log, such as the weight on a vertical axis, is part of the Coulomb friction."""
