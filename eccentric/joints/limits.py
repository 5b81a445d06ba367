"""Every threshold of this room, each with its reason."""

from __future__ import annotations

# Base parameters.

RANK = 1e-4
"""Relative residual below which a column counts as a combination of those selected: filtered angles are no
more precise than that, and a weaker column would be identified from their errors."""
LEAST_SHARE_IN_SUM = 1e-6
"""A coefficient below this is rounding and not part of a sum."""

# Physically consistent bodies.

PROJECTIONS = 4000
"""Most alternating projections: arms of six joints need a few hundred."""
LEAST_EIGENVALUE = 1e-7
"""Least eigenvalue of a pseudo-inertia, in units of the arm's masses and lengths: no body is exactly flat."""
TIGHTEST = 1e-9
"""Least standard error relative to the largest: without noise only rounding remains, which must not dominate
the weights."""
IN_ERRORS = 3.0
"""Largest deviation of a base parameter in standard errors: of fifty, one deviates by 2.5."""

# Loads that friction may depend on.

NEGLIGIBLE = 1e-3
"""A load below this fraction of the largest of its kind is due to a rounded angle in the arm file, or too
small to show: 1e-3 of the torque, times a friction coefficient, is below any noise."""
VARIES = 3e-3
"""Least fraction of a load's columns independent of Coulomb and viscous friction and the other loads: a
constant load, such as the weight on a vertical axis, is part of the Coulomb friction."""
