"""The files of a target, and how close the friction in them is to the drive's."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module

from eccentric.core import EXPORTS, InputError
from eccentric.emission import plain, template
from eccentric.exports.drive import ConstantLaw, ExportedArm, ExportedDrive
from eccentric.version import __version__


@dataclass(frozen=True)
class Exported:
    """What a target writes.

    Attributes:
        files: name -> content.
        law: the friction with constant coefficients in them, None if they have the drive's own.
        left_out: largest torque at the joint, cogging or of a spring, that they do not have [N m].
        unwritten: a file that is missing, and the parameters without a value that it requires.
    """

    files: Mapping[str, str | bytes]
    law: ConstantLaw | None = None
    left_out: float = 0.0
    unwritten: tuple[str, tuple[str, ...]] = ("", ())


OF_ARMS = ("budget",)
"""Targets that an arm can be exported to; the file of each has the name of the target and `_arm`."""


def export(drive: ExportedDrive | ExportedArm, to: str) -> Exported:
    """The files of a drive, or of an arm, for a target.

    Raises:
        InputError: there is no such target, or it cannot take this drive.
    """
    if to not in EXPORTS:
        near = [name for name, target in EXPORTS.items() if str(to).lower() in target.others]
        raise InputError(
            "to",
            f"one of {', '.join(EXPORTS)}",
            f"{to!r}",
            hint=f"did you mean {' or '.join(near)}?" if near else "",
        )
    of_arm = isinstance(drive, ExportedArm)
    if of_arm and to not in OF_ARMS:
        raise InputError("to", f"{' or '.join(OF_ARMS)} for an arm", f"{to!r}")
    module = import_module(f"eccentric.exports.{f'{to}_arm' if of_arm else to}")
    write: Callable[[ExportedDrive | ExportedArm], Exported] = module.write
    return write(drive)


def head(drive: ExportedDrive | ExportedArm) -> dict[str, object]:
    """The variables that the templates of all targets have: name, title, source, version."""
    # Two hyphens would end a comment of XML.
    title, origin = (plain(text).replace("--", "- -") for text in (drive.model.title, drive.origin))
    return {
        "name": drive.name,
        "title": title,
        "origin": origin,
        "version": __version__,
        "back_emf": drive.model.back_emf_in_friction,
    }


def pendulum(drive: ExportedDrive) -> dict[str, object]:
    """The variables of templates that have the pendulum, as decimals in SI units; `radius` is to be seen."""
    p = drive.p
    values = {
        "tilt": drive.tilt,
        "mass": drive.mass,
        "centre": -drive.centre,
        "armature": drive.armature,
        "inertia": drive.inertia,
        "radius": 0.12 * p.L or 0.03,
    }
    values |= {letter: getattr(p, letter) for letter in ("g", "M", "L", "M_l")}
    return head(drive) | {name: decimal(value) for name, value in values.items()}


def stated(drive: ExportedDrive, law: ConstantLaw) -> list[str]:
    """Lines for the head of a file that state how close a law is: error, range, levels at rest."""
    low, high = drive.link_speeds
    levels = dict.fromkeys(f"{x:.4g}" for x in law.breakaway)
    values = {
        "exact": law.exact and not drive.takes("alpha_m"),
        "accelerated": drive.takes("alpha_m"),
        "identified": drive.identified,
        "range": f"{low:.4g} to {high:.4g} rad/s",
        "error_rms": f"{law.error_rms:.3g}",
        "error_max": f"{law.error_max:.3g}",
        "error_percent": f"{100.0 * law.error_rms / law.friction_rms:.2g}" if law.friction_rms else "0",
        "breakaway": " to ".join(levels),
    }
    return template("exports/stated").render(head(drive) | values).splitlines()


def decimal(value: float) -> str:
    """The shortest decimal that is this number, or differs from it by the rounding of a quotient only."""
    short = float(f"{value:.12g}")
    return repr((short if math.isclose(short, value, rel_tol=1e-15) else float(value)) + 0.0)
