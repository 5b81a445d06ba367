"""The regression of a balance: a design in, estimates with intervals out.

    design       target, columns, named coefficients with bounds and roles; linear least squares
    solver       iterations around it, and the search over nonlinear values
    uncertainty  intervals of the estimates; the gain of one model over another
    limits       every threshold, with its reason

In: a `Design`, or a function that makes one from nonlinear values.  Out: a `Solution`, by `search` over those
values or by `iterate`; its `Spread` and an `Estimate` of each value; the gain of one model over another
(`improvement`).
May import: nothing of `identification`; `Rows` of the signals.
"""

from eccentric.identification.regression.design import (
    BalanceDesign,
    Coefficient,
    ColumnRole,
    Design,
    Nonlinear,
    Solution,
    balance_design,
    bounded,
    require_rank,
)
from eccentric.identification.regression.solver import Profile, iterate, profile, search, slopes_between
from eccentric.identification.regression.uncertainty import (
    TWO_SIDED,
    Estimate,
    Spread,
    correlation,
    improvement,
    improvement_over_runs,
    r_squared,
    rms,
)
