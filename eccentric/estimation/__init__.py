"""Designs in, estimates with intervals out: bounded linear least squares, and iterations around it.

In: a `Design` (target, columns, named coefficients with bounds and roles), or a function that makes one from
nonlinear values.  Out: a `Solution`, by `search` over those values or by `iterate`; its `Spread` and an
`Estimate` of each value; the gain of one model over another (`improvement`).
May import: `errors`; no log, no model.
"""

from eccentric.estimation.design import (
    Coefficient,
    ColumnRole,
    Design,
    Nonlinear,
    Solution,
    bounded,
    require_rank,
)
from eccentric.estimation.solver import Profile, iterate, profile, search, slopes_between
from eccentric.estimation.uncertainty import (
    TWO_SIDED,
    Estimate,
    Spread,
    correlation,
    improvement,
    improvement_over_runs,
    r_squared,
    rms,
)

__all__ = [
    "TWO_SIDED",
    "Coefficient",
    "ColumnRole",
    "Design",
    "Estimate",
    "Nonlinear",
    "Profile",
    "Solution",
    "Spread",
    "bounded",
    "correlation",
    "improvement",
    "improvement_over_runs",
    "iterate",
    "profile",
    "r_squared",
    "require_rank",
    "rms",
    "search",
    "slopes_between",
]
