"""Fitted models driven by the input of a log: their motion, and how far it is from the measured one.

In: fitted models (`Refit`, `Fit`) and the log that they were fitted on.  Out: `simulated_errors` ->
`SimulatedErrors`: mean absolute errors of the angle over horizons and whole runs, with the controller of the
rig where it has one; `refine` -> a fit refined on the simulated error of its training runs.

    law         a model as torques, levels of dry friction and damping, each parameter a number or an array
    recording   a log as what a simulation is driven by, and the spans of it that are simulated
    plant       a fitted model with its parameters and the torque of a drive signal
    controller  the drive signal by the controller of the rig
    integrate   many spans and parameter sets at once
    scalar      NumPy's functions of one number, for few spans
    errors      simulated errors of models
    refine      parameters that minimise them
    predicted   the drive of any log by a fitted model, and what it leaves
    draws       parameter sets drawn from the joint uncertainty of a fit
    limits      every threshold, with its reason

May import: `identification` and all rooms below it.
"""

from eccentric.simulation.draws import Draws, draws_of_fit, draws_of_refit
from eccentric.simulation.errors import (
    FittedDrive,
    ModelErrors,
    MotionTrace,
    Predicted,
    SimulatedErrors,
    WholeRunErrors,
    fitted_drive,
    simulated_errors,
)
from eccentric.simulation.integrate import SimulatedMotion, integrate
from eccentric.simulation.law import Law, step
from eccentric.simulation.plant import DrivePlant, Servo, plants_of, servo_of, together
from eccentric.simulation.recording import Recording, Spans, recording_of, whole_runs, windows
from eccentric.simulation.refine import Refined, refine
