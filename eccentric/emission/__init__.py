"""Emission: Model to Program to text, for every target.

    program    Model -> Program: routines in primitive operations, bounds of their rounding
    backends   Program -> text: a folder for each target
    check      emitted C -> a self-test and a driver for its proof
    adapt      Model, fit -> an estimator of the friction coefficients beside the C
    compensate Model, fit -> a compensation of friction for a loop, beside the C
    fitted_friction  whether friction that follows the acceleration stays below the inertia, and where
                     levels are cut at 0
    defaults   names and fitted values of the parameters;  templates  the environment of Jinja
    render     the emitted files of a model, name -> text, and on the disk;  hot  the module, loaded

In: a `Model`. Out: files, or the loaded module. It imports `eccentric.model` and
`eccentric.core`; it knows no data, and its templates know no physics.
"""

from eccentric.emission.adapt import Adaptation, prior_of, render_adapt
from eccentric.emission.backends import BACKENDS, DEFAULT, Language, printed
from eccentric.emission.check import complete, joints_of, render_check
from eccentric.emission.compensate import gain_of, gravity_apart, render_compensation, sure_share
from eccentric.emission.defaults import FittedValues, checked_name, document_of, read_parameters, with_fitted
from eccentric.emission.fitted_friction import (
    InertialLoss,
    LevelCut,
    cut_levels,
    inertial_loss,
    require_solvable,
)
from eccentric.emission.hot import executed, executed_beside, inputs_of, load_module
from eccentric.emission.program import WHOLE, Arrays, Call, Choice, InSingle, Program, Routine, build_program
from eccentric.emission.render import differences, render, render_code, render_program, write
from eccentric.emission.templates import plain, template
