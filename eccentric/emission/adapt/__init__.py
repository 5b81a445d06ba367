"""An estimator of the friction coefficients beside the emitted model, in C99 and Python with the same bits.

    settings   what the user asks for: forgetting, mean time between false alarms
    prior      a model, a fit.json -> where the estimator starts, and how sure it is
    alarm      mean time between false alarms -> the threshold of the alarm and its delay
    applied    a model -> how its coefficients in C follow from those of friction
    update     the arithmetic of one row, as lines that C and Python share
    inputs     what it takes in every sample, and the range of each
    constants  all numbers of the estimator, by name
    invariant  what holds of every state, and the options of its proof
    view       all of it -> what the templates in `templates/adapt` see
    files      `render_adapt`: the files

In: a `Model`, the content of a fit.json. Out: `render_adapt`, file name -> text. The model's own files are
only read here.
"""

from eccentric.emission.adapt.alarm import Alarm, alarm_of, run_length, threshold_of
from eccentric.emission.adapt.files import render_adapt
from eccentric.emission.adapt.prior import Prior, prior_of
from eccentric.emission.adapt.settings import Adaptation

__all__ = [
    "Adaptation",
    "Alarm",
    "Prior",
    "alarm_of",
    "prior_of",
    "render_adapt",
    "run_length",
    "threshold_of",
]
