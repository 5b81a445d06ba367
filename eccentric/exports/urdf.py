"""A pendulum as URDF: `<dynamics damping friction>` of one joint, on the link side of the gear."""

from __future__ import annotations

from eccentric.emission import template
from eccentric.exports.drive import ExportedDrive, nearest
from eccentric.exports.export import Exported, decimal, pendulum, stated


def write(drive: ExportedDrive) -> Exported:
    """NAME.urdf, with one level for both directions and damping in proportion to the velocity.

    The armature J_m/mu^2, for which URDF has no word, is a comment.

    Raises:
        InputError: the drive has no inertia, or friction that depends on more than its motion.
    """
    law = nearest(drive, (1,), symmetric=True)
    values = {
        "stated": stated(drive, law),
        "damping": decimal(law.damping[0]),
        "friction": decimal(law.level),
    }
    text = template("exports/urdf").render(pendulum(drive) | values)
    return Exported({f"{drive.name}.urdf": text}, law, drive.gravity[1])
