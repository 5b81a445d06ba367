"""Compensation of friction in a loop, beside the emitted model: C99 and Python with the same bits.

    slopes     an expression of friction -> the largest size and slopes that it can have, as formulas
    view       a model, a fit.json -> the share of its friction that is there for sure; what the templates
               see, and the files

In: a `Model`, the content of a fit.json. Out: `render_compensation`, file name -> text. The compensation is a
function of the model's `friction_budget`: its own code is the same for every model.
"""

from eccentric.emission.compensate.view import gain_of, gravity_apart, render_compensation, sure_share
