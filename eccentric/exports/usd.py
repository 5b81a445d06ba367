"""A pendulum as USD: a revolute joint with the attributes of Newton, friction, damping and armature."""

from __future__ import annotations

import math

from eccentric.emission import template
from eccentric.exports.drive import ExportedDrive
from eccentric.exports.export import Exported, decimal, head, stated
from eccentric.exports.law import nearest


def write(drive: ExportedDrive) -> Exported:
    """NAME.usda; angles of USD are in degrees, and so is the damping [N m s/deg].

    Raises:
        InputError: the drive has no inertia, or friction that depends on more than its motion.
    """
    law, names = nearest(drive, (1,), symmetric=True), head(drive)
    half = drive.tilt / 2.0
    values = {
        "stated": template("exports/stated").render(names | stated(drive, law)).splitlines(),
        "turned": (decimal(math.cos(half)), decimal(math.sin(half))),
        "g": decimal(drive.p.g),
        "mass": decimal(drive.mass),
        "centre": decimal(-drive.centre),
        "inertia": decimal(drive.inertia),
        "armature": decimal(drive.armature),
        "damping": decimal(math.radians(law.damping[0])),
        "friction": decimal(law.level),
        "L": decimal(drive.p.L),
        "radius": decimal(0.12 * drive.p.L or 0.03),
    }
    return Exported(
        {f"{drive.name}.usda": template("exports/usda").render(names | values)}, law, drive.gravity[1]
    )
