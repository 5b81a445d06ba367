"""A drive component for Newton: a subclass of its `DriveBase`, with `friction_step` as a function of Warp.

For solvers without dry friction: the torque of a step is that which stops the joint where friction can.
"""

from __future__ import annotations

from eccentric.core import InputError
from eccentric.emission import render, template
from eccentric.exports.drive import ExportedDrive
from eccentric.exports.export import Exported, head
from eccentric.exports.warp import functions


def write(drive: ExportedDrive) -> Exported:
    """NAME.py with its runtime, and NAME_newton.py.

    Raises:
        InputError: an inertia is not known, or friction depends on more than angle and velocity.
    """
    drive.require("J_m", "J_l")
    drive.require_motion_alone()
    if drive.takes("alpha_m"):
        raise InputError(
            f"model {drive.name}", "friction of angle and velocity", "one of the acceleration too"
        )
    step = functions(drive.model, "friction_step")
    names = head(drive) | step | {"taken": ", ".join(step["inputs"])}
    module = template("exports/newton.py").render(names)
    files = render(drive.model, "eccentric export", drive.origin, ("numpy",))
    return Exported({**files, f"{drive.name}_newton.py": module}, left_out=drive.gravity[1])
