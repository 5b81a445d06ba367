"""Signals and a model in, coefficients with uncertainty out. The first room that knows a model.

In: `Channels`, a `Rig`, a `Model`, for an extended model its effects.  Out: `fit` -> `Fit` (one model against
Coulomb + viscous friction, as `eccentric fit` shows it); `drive_of` -> `Drive`, `FitData`, `refit` -> `Refit`
(any model on its own emitted module, as `eccentric diagnose` needs it).

    expressions  smooth signals, compiled expressions, and the columns of a base with their coefficients
    machine      motor, armature and inertia as numbers
    drive        the drive torque of a log, the columns that its rig leaves open, external loads on a joint
    columns      the coefficients of a fit: names, roles, units, bounds; which parameters the rig gives
    problem      drive, rig and model as a linear problem for given nonlinear values
    identify     its solution for `eccentric fit`; `document`, `words`, `figure` present it
    first_fit    its solution as the drive of a log, for `eccentric diagnose`
    fit_data     the log with this drive, prepared for any model
    extended     a model with effects as a linear problem at a point
    refitting    its solution, and the estimates
    residuals    the residuals of an emitted module on a log, and their columns: the design of every fit
    states       hidden states along a log
    limits       every threshold, with its reason

May import: `signals`, `rigs`, `model`, `effects`, `emission`, `estimation`.
"""

from eccentric.fitting.columns import back_emf_columns, load_letters, require_case, with_own
from eccentric.fitting.document import emitted_parameters, fit_document
from eccentric.fitting.drive import (
    DRIVE_UNITS,
    LOAD,
    NO_BACK_EMF,
    Drive,
    MetAlong,
    in_drive_unit,
    load_gain,
    loaded_model,
)
from eccentric.fitting.expressions import Signals, base_coefficients, base_columns, compiled, load_torque
from eccentric.fitting.figure import NEEDS_MATPLOTLIB, Comparison, compare, plot_fit
from eccentric.fitting.first_fit import drive_of
from eccentric.fitting.fit_data import FitData, drive_noise, fit_data_of, with_model_current
from eccentric.fitting.identify import Fit, fit
from eccentric.fitting.limits import LEAST_R_SQUARED
from eccentric.fitting.machine import Machine
from eccentric.fitting.refitting import Refit, refit, residual_samples
from eccentric.fitting.residuals import Emitted
from eccentric.fitting.states import States
from eccentric.fitting.words import estimate_table, fit_lines, fit_sentence

__all__ = [
    "DRIVE_UNITS",
    "LEAST_R_SQUARED",
    "LOAD",
    "NEEDS_MATPLOTLIB",
    "NO_BACK_EMF",
    "Comparison",
    "Drive",
    "Emitted",
    "Fit",
    "FitData",
    "Machine",
    "MetAlong",
    "Refit",
    "Signals",
    "States",
    "back_emf_columns",
    "base_coefficients",
    "base_columns",
    "compare",
    "compiled",
    "drive_noise",
    "drive_of",
    "emitted_parameters",
    "estimate_table",
    "fit",
    "fit_data_of",
    "fit_document",
    "fit_lines",
    "fit_sentence",
    "in_drive_unit",
    "load_gain",
    "load_letters",
    "load_torque",
    "loaded_model",
    "plot_fit",
    "refit",
    "require_case",
    "residual_samples",
    "with_model_current",
    "with_own",
]
