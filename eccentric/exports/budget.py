"""Friction written into MuJoCo before each step: a module beside the emitted one, and a pendulum for it.

Levels and damping are those of the drive in its state; the solver of MuJoCo makes the torque of them, also at
rest.
"""

from __future__ import annotations

from eccentric.emission import render, template
from eccentric.exports.drive import ExportedDrive
from eccentric.exports.export import Exported, head
from eccentric.exports.mjcf import FREE, written
from eccentric.exports.warp import functions


def write(drive: ExportedDrive) -> Exported:
    """NAME.py with its runtime, NAME_budget.py, NAME_budget_warp.py, and NAME.xml, a bare pendulum.

    The pendulum is left out where an inertia is not known, the module for Warp where friction depends on more
    than the motion.
    """
    names, others = head(drive), list(drive.other_inputs())
    follows = drive.takes("alpha_m")
    motion = {"theta_m": "angle / mu", "omega_m": "velocity / mu", "alpha_m": "acceleration / mu"}
    given = ["angle", "velocity", *(["acceleration"] if follows else []), *others]
    at = {"angle": "data.qpos[self.angle]", "velocity": "data.qvel[dof]", "acceleration": "data.qacc[dof]"}
    module = template("exports/budget.py").render(
        names
        | {
            "others": others,
            "by_acceleration": follows,
            "given": ", ".join(given),
            "taken": ", ".join(motion.get(x, x) for x in drive.inputs),
            "passed": ", ".join(at.get(x, x) for x in given),
            "more": "".join(f"{x}, " for x in others),
        }
    )
    files: dict[str, str | bytes] = {
        **render(drive.model, "eccentric export", drive.origin, ("numpy",)),
        f"{drive.name}_budget.py": module,
    }
    if not others:  # a kernel has the state of the engine alone
        files[f"{drive.name}_budget_warp.py"] = template("exports/budget_warp.py").render(
            names | functions(drive.model, "friction_budget") | {"taken": ", ".join(drive.inputs)}
        )
    # A J_l of 0 is no body: the rig of a bare motor declares no link.
    absent = {"J_m": drive.p.J_m is None, "J_l": not drive.p.J_l}
    missing = tuple(name for name, is_missing in absent.items() if is_missing)
    if not missing:
        files[f"{drive.name}.xml"] = written(drive, FREE)
        return Exported(files, left_out=drive.gravity[1])
    return Exported(files, unwritten=(f"{drive.name}.xml", missing))
