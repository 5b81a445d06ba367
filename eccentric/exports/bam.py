"""Parameters for BAM (Better Actuator Models, M. Duclusaud and others, 2024): friction of its model M1.

Its friction is friction_base against the motion and friction_viscous times the velocity of the joint; the
motor's torque is kt/R times the voltage less kt times the velocity: one constant for torque and back-EMF.
"""

from __future__ import annotations

import json

from eccentric.core import InputError
from eccentric.exports.drive import ExportedDrive, nearest
from eccentric.exports.export import Exported


def write(drive: ExportedDrive) -> Exported:
    """NAME.json; `actuator` is the name to register the drive under in BAM.

    Raises:
        InputError: R or the torque constant is not known; the drive has no inertia of the motor, or friction
            that depends on more than its motion.
    """
    model, p = drive.model, drive.p
    if model.back_emf_in_friction or not (model.voltage_known and model.current_known):
        raise InputError(
            f"model {drive.name}", "R and k_i", "one that a log did not determine", why="to export"
        )
    law = nearest(drive, (1,), symmetric=True)
    content = {
        "model": "m1",
        "actuator": drive.name,
        "kt": p.k_i / p.mu,
        "R": p.R,
        "armature": drive.armature,
        "friction_base": law.level,
        "friction_viscous": law.damping[0],
        "q_offset": 0.0,
    }
    return Exported({f"{drive.name}.json": json.dumps(content, indent=1) + "\n"}, law, drive.gravity[1])
