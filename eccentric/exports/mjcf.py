"""A pendulum as a model of MuJoCo (MJCF): a hinge with friction, armature and gear of the drive."""

from __future__ import annotations

from collections.abc import Sequence

from eccentric.emission import template
from eccentric.exports.drive import ConstantLaw, ExportedDrive, nearest
from eccentric.exports.export import Exported, decimal, pendulum, stated

FREE = ConstantLaw(0.0, 0.0, (0.0, 0.0, 0.0), 0.0, 0.0, 0.0, (0.0, 0.0))
"""No friction: that of a joint whose friction is written before each step."""


def write(drive: ExportedDrive) -> Exported:
    """NAME.xml, with the nearest friction with constant coefficients.

    Raises:
        InputError: the drive has no inertia, or friction that depends on more than its motion.
    """
    law = nearest(drive)
    return Exported({f"{drive.name}.xml": written(drive, law, stated(drive, law))}, law, drive.gravity[1])


def written(drive: ExportedDrive, law: ConstantLaw, lines: Sequence[str] = ()) -> str:
    """The model with this friction; `lines` state how close it is, none that it is written at run time."""
    p, left_out = drive.p, drive.gravity[1]
    about = max(p.M * p.g * p.L, law.level)
    return template("exports/mjcf.xml").render(
        pendulum(drive)
        | {
            "stated": lines,
            "left_out": f"{left_out:.3g}" if left_out > 1e-9 * about else "",
            "frictionloss": decimal(law.level),
            "damping": " ".join(map(decimal, law.damping)),
            "thickness": decimal(0.04 * p.L or 0.01),
            "gear": decimal(1.0 / p.mu),
            "offset": decimal(-law.offset) if law.offset else "",
            "upper": f"{law.upper:.4g}",
            "lower": f"{law.lower:.4g}",
        }
    )
