"""A pendulum as URDF: `<dynamics damping friction>` of one joint, on the link side of the gear."""

from __future__ import annotations

from eccentric.emission import template
from eccentric.exports.drive import ExportedDrive
from eccentric.exports.export import Exported, decimal, head, stated
from eccentric.exports.law import nearest


def write(drive: ExportedDrive) -> Exported:
    """NAME.urdf, with one level for both directions and damping in proportion to the velocity.

    The armature J_m/mu^2, for which URDF has no word, is a comment.

    Raises:
        InputError: the drive has no inertia, or friction that depends on more than its motion.
    """
    law, names = nearest(drive, (1,), symmetric=True), head(drive)
    values = {
        "stated": template("exports/stated").render(names | stated(drive, law)).splitlines(),
        "tilt": decimal(drive.tilt),
        "mass": decimal(drive.mass),
        "centre": decimal(-drive.centre),
        "inertia": decimal(drive.inertia),
        "armature": decimal(drive.armature),
        "damping": decimal(law.damping[0]),
        "friction": decimal(law.level),
        "L": decimal(drive.p.L),
        "radius": decimal(0.12 * drive.p.L or 0.03),
    }
    text = template("exports/urdf").render(names | values)
    return Exported({f"{drive.name}.urdf": text}, law, drive.gravity[1])
