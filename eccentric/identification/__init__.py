"""Signals and a model in, coefficients with uncertainty out. The first room that knows a model.

In: `Channels`, a `Rig`, a `Model`, for an extended model its effects.  Out: `fit` -> `Fit` (one model against
Coulomb + viscous friction, as `eccentric fit` shows it); `drive_of` -> `Drive`, `FitData`, `refit` -> `Refit`
(any model on its own emitted module, as `eccentric diagnose` needs it).

    expressions  smooth signals, compiled expressions, hidden states along a log, and the columns of a base
                 with their coefficients
    drive        motor, armature and inertia as numbers; the drive torque of a log, the columns that its rig
                 leaves open, external loads on a joint
    columns      the coefficients of a fit: names, roles, units, bounds; which parameters the rig gives
    problem      drive, rig and model as a linear problem for given nonlinear values
    identify     its solution for `eccentric fit`; upper bounds of friction by F_N that a log does not show,
                 and the free cubic of a coast-down
    first_fit    its solution as the drive of a log, for `eccentric diagnose`
    fit_data     the log with this drive, prepared for any model; the residuals of an emitted module on it,
                 and their columns: the design of every fit
    extended     a model with effects as a linear problem at a point
    refitting    its solution, and the estimates
    regression   the regression of a balance: target, columns, named coefficients with bounds and roles; least
                 squares, iterations around it, and the search over nonlinear values
    uncertainty  intervals of the estimates; the gain of one model over another
    limits       every threshold, with its reason

May import: `signals`, `rigs`, `model`, `effects`, `emission`.
"""

from eccentric.identification.columns import (
    back_emf_columns,
    following_letters,
    k_e,
    load_letters,
    own_letters,
    require_case,
    with_own,
)
from eccentric.identification.drive import (
    DRIVE_UNITS,
    LOAD,
    NO_BACK_EMF,
    Drive,
    Machine,
    MetAlong,
    in_drive_unit,
    load_gain,
    loaded_model,
)
from eccentric.identification.expressions import (
    Signals,
    States,
    base_coefficients,
    base_columns,
    compiled,
    load_torque,
    state_series,
)
from eccentric.identification.first_fit import drive_of, inertias
from eccentric.identification.fit_data import (
    Emitted,
    FitData,
    deceleration_noise,
    drive_noise,
    fit_data_of,
    with_model_current,
)
from eccentric.identification.identify import (
    Fit,
    Undetected,
    detection_power,
    fit,
    posed_for_motion,
    with_solution,
)
from eccentric.identification.limits import LEAST_GAIN_PERCENT, LEAST_R_SQUARED, MOST_POINTS
from eccentric.identification.problem import Problem, no_friction
from eccentric.identification.refitting import Refit, refit, residual_samples
from eccentric.identification.regression import (
    BalanceDesign,
    Coefficient,
    ColumnRole,
    Design,
    Nonlinear,
    Solution,
    balance_design,
    inseparable,
    iterate,
    merged,
    profile,
    search,
    slopes_between,
    triangles,
)
from eccentric.identification.uncertainty import (
    TWO_SIDED,
    Estimate,
    Spread,
    correlation,
    covariance,
    improvement,
    improvement_over_runs,
    r_squared,
    rms,
    spread,
)
