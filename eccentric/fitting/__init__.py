"""Signals and a model in, coefficients with uncertainty out. The first room that knows a model.

In: `Channels`, a `Rig`, a `Model`, for an extended model its effects.  Out: `fit` -> `Fit` (one model against
Coulomb + viscous friction, as `eccentric fit` shows it); `drive_of` -> `Drive`, `FitData`, `refit` -> `Refit`
(any model on its own emitted module, as `eccentric diagnose` needs it).
May import: `signals`, `rigs`, `model`, `effects`, `emission`.
"""

from eccentric.fitting.constant_load import loaded_model
from eccentric.fitting.document import fit_document
from eccentric.fitting.drive import Drive, drive_of
from eccentric.fitting.expressions import Signals, base_columns, compiled
from eccentric.fitting.figure import NEEDS_MATPLOTLIB, Comparison, compare, draw_fit, plot_fit
from eccentric.fitting.identify import Fit, fit
from eccentric.fitting.least_squares import bounded
from eccentric.fitting.parameters import emitted_parameters
from eccentric.fitting.problem import seen_columns
from eccentric.fitting.refitting import Refit, refit, residual_samples
from eccentric.fitting.residuals import FitData
from eccentric.fitting.states import States
from eccentric.fitting.uncertainty import Estimate, improvement, improvement_over_runs
from eccentric.fitting.words import fit_lines, fit_sentence

__all__ = [
    "NEEDS_MATPLOTLIB",
    "Comparison",
    "Drive",
    "Estimate",
    "Fit",
    "FitData",
    "Refit",
    "Signals",
    "States",
    "base_columns",
    "bounded",
    "compare",
    "compiled",
    "draw_fit",
    "drive_of",
    "emitted_parameters",
    "fit",
    "fit_document",
    "fit_lines",
    "fit_sentence",
    "improvement",
    "improvement_over_runs",
    "loaded_model",
    "plot_fit",
    "refit",
    "residual_samples",
    "seen_columns",
]
