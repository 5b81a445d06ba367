"""An estimator of the friction coefficients beside the emitted model, in C99 and Python with the same bits.

    prior      a model, a fit.json -> where the estimator starts, how sure it is; its settings and its alarm
    update     the arithmetic of one row, as lines that C and Python share; inputs, invariant
    view       all of it -> the variables of `templates/adapt`, and the files

In: a `Model`, the content of a fit.json. Out: `render_adapt`, file name -> text. The model's own files are
only read here.
"""

from eccentric.emission.adapt.prior import (
    CONFIDENCE,
    Adaptation,
    alarm_of,
    covariance_of_fit,
    identified_states,
    prior_of,
    run_length,
    threshold_of,
)
from eccentric.emission.adapt.view import render_adapt
