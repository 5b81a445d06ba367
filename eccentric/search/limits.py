"""Every threshold of the search, each with its reason.

Those of the decision were calibrated on the development seeds of the virtual bench, of which the published
benchmark uses none.
"""

from __future__ import annotations

__all__ = [
    "AT_FLOOR",
    "BELOW_NOISE",
    "CHANGES",
    "CLEARS",
    "DRAWS",
    "EVALUATIONS",
    "EXTRAPOLATED",
    "FIRST_EVALUATIONS",
    "FOLDS",
    "FORMS_OF_A_PATCH",
    "LEADERS",
    "LEADERS_OF_A_PARTNER",
    "LEADERS_OF_A_SWAP",
    "LEAST_DEVIANCE",
    "LEAST_PART",
    "LEAST_SHARE",
    "LEVEL",
    "MOST_EFFECTS",
    "MOST_KEPT",
    "MOST_LAGS",
    "PARTNERS",
    "POSSIBLE",
    "ROWS_FOR_ONE",
    "SPECIAL",
    "SURE",
    "SWAPPED",
    "TINY_COLUMN",
    "TRIED",
    "UNEXPLAINED",
    "UNEXPLAINED_OVER_RUNS",
]

# What an effect must gain to be adopted.

LEAST_DEVIANCE = 20.0
"""Twice the log-likelihood that an addition must gain: below it may be chance.

Controls of the bench stay below 16; `nulltest.null_quantile` gives a log's own level beside it.
"""
LEAST_SHARE = 0.002
"""RMS that an addition must take out of the residual, as a fraction of the balance's scale: below it lie the
errors of filters and of the sampling of voltage and current."""
LEAST_PART = 0.0003
"""The same squared, as a fraction of all the structure found so far: a trace beside a large effect is an
error of that effect's form."""
CLEARS = 0.5
"""Part of what is left above the sensors' floor that a second or third effect must take out: less is a patch
on the form of the first."""
AT_FLOOR = 1.02
"""Sum of squares, in units of the sensors' floor, at which nothing further is looked for: 2 % is what the
estimate of the noise is uncertain by."""
BELOW_NOISE = 0.8
"""Part of the sensors' floor below which a fit has noise on both sides of its equation (the measured current
as a regressor of itself): the floor is known to some 10 %, no honest fit comes out a fifth below it."""
MOST_EFFECTS = 3
"""Adopted at most per balance: a log of a minute has not shown more."""

# How alternatives are weighed.

SURE = 0.8
"""Probability from which an effect is named: a special case tied with its general form has 0.88, a third
family tied with both takes it below."""
SPECIAL = 2.0
"""Log-odds that a special case has over the family that contains it: it says as much with less."""
POSSIBLE = 0.05
"""Probability from which a family is among those that explain the log alike."""
FORMS_OF_A_PATCH = 3
"""Members of one family that no longer are an effect: one order or two is one, three trace a shape that none
of them is."""

# What no effect explains.

UNEXPLAINED = 0.04
"""Part of the structure that a smooth term must take out beyond the effects to refuse a name."""
UNEXPLAINED_OVER_RUNS = 0.15
"""The same where every run is predicted from the others: no two runs are quite alike, and what is named has
yet to predict those that were not seen."""
EXTRAPOLATED = 4.0
"""Times the loss without it from which a smooth term says nothing of a block: it had to extrapolate there."""

# What chance reaches.

LEVEL = 0.99
"""Quantile: what chance reaches in one log of a hundred."""
DRAWS = 200
"""Random signs of the blocks: two of them lie above the 99 % quantile."""
MOST_LAGS = 60
"""Rows over which a residual is correlated with itself, at most: a second of windows that overlap."""
ROWS_FOR_ONE = 2.0
"""Rows that count as one, at least: windows overlap by half."""

# How far the search looks.

FOLDS = 8
"""Of the cross-validation: an eighth of the blocks is predicted from seven."""
LEADERS = 8
"""Candidates whose shapes are refined; four times as many are cross-validated at their grid point."""
EVALUATIONS = 30
"""Of a simplex search, for each shape: a hundredth of the range is reached by then."""
FIRST_EVALUATIONS = 10
"""The same before the comparison, of what changes the base: its grid is coarse."""
TRIED = 2
"""Leaders of a step that are refined in all their shapes and compared."""
PARTNERS = 3
"""Families, the first one included, beyond which no further one is tried as half of a pair."""
LEADERS_OF_A_PARTNER = 3
LEADERS_OF_A_SWAP = 4
"""Candidates refined beside a variant that is kept: the place is given, the best few decide it."""
SWAPPED = 0.995
"""Part of a score that a swap must come below, so that two effects do not take turns."""
CHANGES = 3
"""Times that the comparison with alternatives may change what is adopted: it ends, whatever the log."""
TINY_COLUMN = 1e-4
"""Part of its length that a column keeps beside base and variants, below which it is one of theirs."""
MOST_KEPT = 400
"""Columns and changed bases kept in memory: a simplex search comes back to a few."""
