"""The drive of a log from a first fit of the paper's model: delay, zero angle, offset, inertia and scale."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping

import numpy as np

from eccentric.errors import InputError
from eccentric.estimation import Solution, require_rank, search
from eccentric.fitting.drive import Drive
from eccentric.fitting.machine import Machine
from eccentric.fitting.problem import Problem, own_letters, pose, require_case
from eccentric.model import Model
from eccentric.rigs import Rig, mass_alone
from eccentric.signals import Channels

__all__ = ["drive_of"]

_UNITS = {"voltage": "V", "current": "A", "torque": "N m"}


def drive_of(channels: Channels, rig: Rig, base: Model) -> Drive:
    """Return the drive of a log; `base` is the paper's model, without load.

    Raises InputError for what `problem.pose` refuses, and for a drive whose sign contradicts the motion.
    """
    require_case(rig, base)
    open_inertia = not {"J_m", "J_l"} <= set(rig.known)
    by = channels.motor.measured_by
    measured = by == "torque" or (by == "current" and "k_i" in rig.known)
    complete = measured and not open_inertia and not rig.unknown and not rig.estimate
    if complete:
        known = _needed(channels, rig, base) | {k: v for k, v in rig.known.items() if k == "T_load"}
        return Drive(Machine(base), channels, known, None, "N m", (), "", ())
    problem = pose(channels.driven, rig, base)
    first = search(problem, problem.every)
    names = [c.name for c in problem.coefficients]
    require_rank(first.design.columns[problem.rows.train], names, rig.path)
    found = {c.role: float(v) for c, v in zip(problem.coefficients, first.values, strict=True)}
    _require_sign(found, problem)
    letters = {k: v for k, v in first.at.items() if k not in ("input_delay_s", "theta_zero_rad")}
    aligned = {k: v for k, v in first.at.items() if k not in letters}
    if "offset" in found:
        aligned["voltage_offset_V"] = found["offset"]
    channels = channels.realigned(rig, dataclasses.replace(channels.alignment, **aligned))
    rig = dataclasses.replace(rig, known={**rig.known, **letters})
    scale = None if measured else _scale(problem, found)
    unit = "N m" if measured or _has_scale(problem) else _UNITS[by]
    known = _needed(channels, rig, base)
    if open_inertia:
        total = found["inertia"] / (found.get("scale", 1.0) if scale else 1.0)
        known |= _inertias(rig, problem.machine, total)
    if "T_load" in rig.known:
        known["T_load"] = rig.known["T_load"]
    elif "T_load" in rig.unknown:
        known["T_load"] = 0.0  # free, a column
    return Drive(
        problem.machine,
        channels,
        known,
        scale,
        unit,
        *_open(channels, rig, problem, open_inertia),
        _identified(first, scale, open_inertia, rig),
        tuple(w for w in problem.warnings if w not in channels.intake.warnings),
        rig.known.get("J_m") if open_inertia else None,
        rig.unknown.get("k_e", (0.0, math.inf)),
    )


def _identified(first: Solution, scale: float | None, open_inertia: bool, rig: Rig) -> tuple[str, ...]:
    """Parameters that were estimated from the log."""
    scaled = {"R", "k_i"} if scale is not None else set()
    inertia = {"J_m", "J_l"} - set(rig.known) if open_inertia else set()
    load = {"T_load"} & set(rig.unknown)
    return tuple(sorted({*first.at, *scaled, *inertia, *load}))


def _needed(channels: Channels, rig: Rig, base: Model) -> dict[str, float]:
    """Values of the model's parameters other than friction coefficients, as far as they are known.

    A torque signal is a current with k_i = 1 N m/A; of a scale only R/k_i matters.
    """
    needed = {q.name for q in base.parameters if q not in base.friction_parameters} - {"T_load"}
    # Parameters to be estimated, and those that only a rig with both voltage and current requires.
    given = {"k_i", "R", "k_e", "J_m", "J_l", "F_T"}
    if rig.case == "C1":
        # There it is only in F_T, whose friction no log separates from the motor's.
        given |= {"M_l"}
    if channels.motor.measured_by == "current" and channels.motor.voltage is not None:
        given -= {"R", "k_e"}
        if missing := sorted({"R", "k_e"} - set(rig.known)):
            verb = "are" if len(missing) > 1 else "is"
            received = "a range" if set(missing) & set(rig.unknown) else "none"
            raise InputError(
                f"{rig.path}: [known] {' and '.join(missing)} {verb} required, since current and voltage"
                f" are mapped, received {received}: add it, or remove the voltage from [columns]"
            )
    known = {name: value for name, value in own_letters(base).items() if name in needed}
    known |= {name: rig.value(name) for name in sorted(needed - given - set(known))}
    known |= {name: rig.known[name] for name in sorted(needed & given) if name in rig.known}
    if "M_l" in needed:
        known.setdefault("M_l", 0.0)
    if "F_T" in needed:
        known.setdefault("F_T", known.get("M_l", 0.0) * known["g"])
    if channels.motor.measured_by == "torque" or "k_i" not in known:
        known["k_i"] = 1.0
    return known


def _scale(problem: Problem, found: Mapping[str, float]) -> float:
    """One newton metre in the unit of the drive."""
    if problem.channels.motor.measured_by == "voltage" and problem.scale is None:
        return 1.0 / problem.per_volt
    return found.get("scale", 1.0)


def _has_scale(problem: Problem) -> bool:
    return problem.scale is None or any(c.role == "scale" for c in problem.coefficients)


def _inertias(rig: Rig, machine: Machine, total: float) -> dict[str, float]:
    """J_m and J_l for the identified inertia; a link of unknown inertia is taken as a point mass."""
    mu = {"mu": rig.value("mu")}

    def link_of(rotor: float) -> float:
        rest = total - machine.inertia({**mu, "J_m": rotor, "J_l": 0.0})
        return max(rest, 0.0) / machine.inertia_per("J_l", mu)

    if "J_m" in rig.known:
        return {"J_l": link_of(rig.known["J_m"])}
    link = rig.known.get("J_l", mass_alone(rig.known))
    rotor = max(total - machine.inertia({**mu, "J_m": 0.0, "J_l": link}), 0.0)
    return {"J_m": rotor, "J_l": link if rotor else link_of(0.0)}


def _open(channels: Channels, rig: Rig, problem: Problem, open_inertia: bool) -> tuple[tuple[str, ...], str]:
    """Names of the free columns, and the letter that the gravity column changes."""
    names, adjusts, rows = [], "", channels.selection
    turning = problem.model.balance("mechanical").sum_of("gravity") != 0
    if open_inertia:
        names.append("J_m")
    if "T_load" in rig.unknown:
        names.append("T_load")
    if any(c.role == "scale" for c in problem.coefficients):
        adjusts = "scale"
    else:
        adjusts = next((letter for letter in ("L", "M") if letter in rig.unknown), "")
    if turning and adjusts:
        names.append("gravity")
    scaled = problem.scale is not None
    by_voltage = channels.motor.measured_by == "voltage"
    if by_voltage and scaled and "k_e" not in rig.known and np.any(channels.motor.off & rows.fit_rows):
        names.append("back_emf")
    if "voltage_offset_V" in rig.estimate and by_voltage:
        names.append("offset")
    if "theta_zero_rad" in rig.estimate and turning:
        names.append("zero_angle")
    return tuple(names), adjusts if "gravity" in names else ""


def _require_sign(found: Mapping[str, float], problem: Problem) -> None:
    for role in ("scale", "inertia"):
        if found.get(role, 1.0) <= 0.0:
            raise InputError(
                f"{problem.rig.path}: {'scale' if role == 'scale' else 'inertia'} of the drive above 0 is"
                f" required, received {found[role]:.3g} from the log: do the signs of"
                f" {problem.channels.motor.measured_by} and angle agree?"
            )
