"""A pendulum as USD: a revolute joint with the attributes of Newton, friction, damping and armature."""

from __future__ import annotations

import math

from eccentric.emission import template
from eccentric.exports.drive import ExportedDrive, nearest
from eccentric.exports.export import Exported, decimal, pendulum, stated


def write(drive: ExportedDrive) -> Exported:
    """NAME.usda; angles of USD are in degrees, and so is the damping [N m s/deg].

    Raises:
        InputError: the drive has no inertia, or friction that depends on more than its motion.
    """
    law, half = nearest(drive, (1,), symmetric=True), drive.tilt / 2.0
    values = {
        "stated": stated(drive, law),
        "turned": (decimal(math.cos(half)), decimal(math.sin(half))),
        "damping": decimal(math.radians(law.damping[0])),
        "friction": decimal(law.level),
    }
    text = template("exports/usda").render(pendulum(drive) | values)
    return Exported({f"{drive.name}.usda": text}, law, drive.gravity[1])
