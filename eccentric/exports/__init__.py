"""Export: a drive as a model of a simulator, with friction in the form that the simulator's own solver takes.

    drive   what is exported: a drive, its levels and damping at its joint, on the link side; or an arm
    law     the nearest friction with constant coefficients, and its error
    export  the files of a target; each target is a file of its name

In: a `Model` with values. Out: files as text, and how close the friction in them is. What the simulator has a
solver for is exported as levels of dry friction and damping, never as a torque.
May import: `core`, `model`, `emission`.
"""

from eccentric.exports.drive import DEFAULT_SPEEDS, ConstantLaw, ExportedArm, ExportedDrive
from eccentric.exports.export import Exported, export
