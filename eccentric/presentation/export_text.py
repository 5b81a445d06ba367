"""How close the friction of an export is to the drive's, in words."""

from __future__ import annotations

from eccentric.exports import Exported, ExportedDrive
from eccentric.model import Model


def export_lines(drive: ExportedDrive, exported: Exported) -> list[str]:
    """What a person reads of an export; values at the joint, on the link side of the gear."""
    law = exported.law
    low, high = drive.link_speeds
    whence = ", as in the log" if drive.identified else ""
    lines = []
    if law is None:
        lines.append("friction: exact")
    elif law.exact and not drive.takes("alpha_m"):
        lines.append("friction: exact, since its coefficients are constant")
    else:
        share = 100.0 * law.error_rms / law.friction_rms
        lines.append(
            f"friction: the best fit with constant coefficients, link speeds {low:.4g} to {high:.4g} rad/s"
            f"{whence}: error {law.error_rms:.3g} N m RMS ({share:.2g} % of the friction),"
            f" {law.error_max:.3g} N m at most"
        )
        if drive.takes("alpha_m"):
            lines.append("friction that follows the acceleration is left out: the error is at constant speed")
        least, most = (f"{x:.4g}" for x in law.breakaway)
        own = f"{least} N m" if least == most else f"{least} to {most} N m, depending on the angle"
        lines.append(
            f"at rest it holds {law.lower:.4g} N m backwards and {law.upper:.4g} N m forwards;"
            f" the drive {own}"
        )
    if exported.left_out > 1e-9 * max(drive.p.M * drive.p.g * drive.p.L, 1e-9):
        lines.append(
            f"left out: a torque of up to {exported.left_out:.3g} N m that is not friction"
            " (cogging, a spring, a load)"
        )
    file, missing = exported.unwritten
    if missing:
        lines.append(
            f"left out: the pendulum {file}, which requires {' and '.join(missing)}: declare"
            f" {'it' if len(missing) == 1 else 'them'} in the rig, or give a value with --parameters"
        )
    if drive.model.back_emf_in_friction:
        lines.append(
            "friction contains the back-EMF: drive the joint by k_i u/R, the torque of the voltage u"
        )
    return lines


def left_out_sentence(model: Model, torque: float) -> str:
    """What a compensation of the friction leaves out: a torque [N m] that is not friction."""
    axis = model.axis
    return (
        f"the compensation leaves out a {axis.term('torque')} of up to {torque:.3g} {axis.unit('N m')}"
        " that is not friction (cogging, a spring, a load): add"
        f" {model.name}_{axis.named('gravity_torque')}"
    )
