"""The drive of a log from a first fit of the paper's model: delay, zero angle, offset, inertia and scale."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import sympy as sp

from eccentric.core import InputError, MissingValueError
from eccentric.identification import limits
from eccentric.identification.columns import following_letters, require_case, with_own
from eccentric.identification.drive import LOAD, PER_INERTIA, Drive, Machine, evaluated
from eccentric.identification.expressions import seen_columns
from eccentric.identification.problem import Problem, massless, pose, profiled, solved, warnings_of
from eccentric.identification.regression import Coefficient, Solution
from eccentric.model import Model, regressor
from eccentric.model import vocabulary as v
from eccentric.rigs import ALIGNMENT, Rig, mass_alone
from eccentric.signals import Channels


def drive_of(channels: Channels, rig: Rig, base: Model) -> Drive:
    """Return the drive of a log; `base` is the paper's model, without load.

    Raises InputError for what `problem.pose` refuses, for a drive whose sign contradicts the motion, and for
    a plane of motion that is level for a model with a tilt.
    """
    require_case(rig, base)
    if base.tilted:
        _require_in_plane(rig, "known", rig.known.get("phi", 0.0))
    machine, rig = Machine(base), with_own(rig, base)
    open_inertia = not set(machine.inertias) <= set(rig.known)
    by = channels.motor.measured_by
    measured = by == "torque" or (by == "current" and machine.torque_letters <= set(rig.known))
    if measured and not open_inertia and not rig.unknown and not rig.estimate:
        unit = PER_INERTIA if rig.per_inertia else "N m"
        kept = seen_columns(base, {} if channels.carried else rig.known)
        gone = [column.name for k, column in enumerate(regressor(base)) if k not in kept]
        known = _needed(channels, rig, base, machine)
        return Drive(machine, channels, known, None, unit, warnings=tuple(massless(gone, rig.axis)))
    problem = pose(channels.driven, rig, base)
    first = solved(problem, rig.path, positive={"scale", "inertia"})
    found = {c.role: float(x) for c, x in zip(problem.coefficients, first.values, strict=True)}
    aligned = {k: x for k, x in first.at.items() if k in ALIGNMENT}
    if "offset" in found:
        aligned["voltage_offset_V"] = found["offset"]
    letters = {k: x for k, x in first.at.items() if k not in aligned}
    _require_in_plane(rig, "unknown", letters.get("phi", 0.0))
    rig = dataclasses.replace(rig, known={**rig.known, **letters})
    s = found.get("scale", 1.0)
    scale = None if problem.drive.scale is None else problem.drive.scale * s
    known = _needed(channels, rig, base, machine)
    unit = "N m" if problem.has("scale") else problem.drive.unit
    rotor = None
    if open_inertia and unit == "N m":
        known |= inertias(rig, machine, found["inertia"] / s)
        rotor = rig.known.get(machine.rotor)
    elif open_inertia:
        # Volts have no part in kg m^2 that could be subtracted: the rotor stands for all of the inertia.
        known |= {machine.rotor: found["inertia"]} | ({machine.link: 0.0} if machine.link else {})
    opened, adjusts = _open(channels, rig, problem, open_inertia)
    warnings = (*problem.warnings, *warnings_of(problem, *profiled(problem, first)))
    return Drive(
        machine,
        channels.realigned(rig, dataclasses.replace(channels.alignment, **aligned)),
        known,
        scale,
        unit,
        opened,
        adjusts,
        _identified(
            first, scale if unit == "N m" else None, machine if open_inertia else None, rig, by == "voltage"
        ),
        tuple(w for w in warnings if w not in channels.intake.warnings),
        rotor,
    )


def _require_in_plane(rig: Rig, table: str, phi: float) -> None:
    if math.cos(phi) < limits.LEAST_IN_PLANE:
        raise InputError(
            f"{rig.path}: [{table}] phi",
            "gravity in the plane of motion",
            'none: case = "C1" in [known] is a level plane',
        )


def _identified(
    first: Solution, scale: float | None, inertia: Machine | None, rig: Rig, by_voltage: bool
) -> tuple[str, ...]:
    """Parameters that were estimated from the log; a current shows no resistance."""
    motor = {"R", "k_i"} if by_voltage else {"k_i"}
    scaled = set[str]() if scale is None or motor <= set(rig.known) else motor - ({"k_i"} & set(rig.known))
    letters = set() if inertia is None else {*inertia.inertias} - set(rig.known)
    return tuple(sorted({*first.at, *scaled, *letters, *({LOAD} & set(rig.unknown))}))


def _needed(channels: Channels, rig: Rig, base: Model, machine: Machine) -> dict[str, float]:
    """Values of the model's parameters other than friction coefficients, as far as they are known.

    A torque signal is a current with k_i = 1 N m/A; of a scale only R/k_i matters.
    """
    needed = {q.name for q in base.parameters if q not in base.friction_parameters} - {LOAD}
    # Parameters to be estimated, and those that only a rig with both voltage and current requires.
    follows = following_letters(base)
    motor = machine.resistance_letters | machine.back_emf_letters
    given = {*machine.torque_letters, *motor, *machine.inertias, *follows}
    if rig.case == "C1":
        # There it is only in F_T, whose friction no log separates from the motor's.
        given |= {"M_l"}
    if channels.motor.measured_by == "current" and channels.motor.voltage is not None:
        given -= motor
        if missing := sorted(motor - set(rig.known)):
            what = "them" if len(missing) > 1 else "it"
            received = "a range" if set(missing) & set(rig.unknown) else "none"
            raise MissingValueError(
                rig.path,
                f"[known] {' and '.join(missing)}",
                f"{received}: add {what}, or remove the voltage from [columns]",
                why=", since current and voltage are mapped",
                letter=missing[0],
            )
    known = {name: rig.value(name) for name in sorted(needed - given)}
    known |= {name: rig.known[name] for name in sorted(needed & given) if name in rig.known}
    # The gear of the rig, also for a model with one of its own: signals of the link are converted by it.
    if v.mu.name in rig.known:
        known[v.mu.name] = rig.known[v.mu.name]
    if "M_l" in needed:
        known.setdefault("M_l", 0.0)
    for name, default in follows.items():
        if name in needed - set(known) and {s.name for s in default.free_symbols} <= {"M_l", *known}:
            known[name] = float(evaluated(default, {"M_l": 0.0, **known}))
    if channels.motor.measured_by == "torque" or not machine.torque_letters <= set(known):
        known |= dict.fromkeys(machine.torque_letters, 1.0)
    if LOAD in rig.known or LOAD in rig.unknown:
        known[LOAD] = rig.known.get(LOAD, 0.0)  # one known by a range is free, a column
    return known


def inertias(rig: Rig, machine: Machine, total: float) -> dict[str, float]:
    """J_m and J_l for the identified inertia; a link of unknown inertia is taken as a point mass."""
    rotor, link = machine.rotor, machine.link
    if not link:
        return {rotor: total}
    others = {name: rig.value(name) for name in sorted(machine.inertia_letters - {rotor, link})}

    def beyond(inertia: float) -> float:
        rest = total - machine.inertia({**others, rotor: inertia, link: 0.0})
        return max(rest, 0.0) / machine.inertia_per(link, others)

    if rotor in rig.known:
        return {link: beyond(rig.known[rotor])}
    own = rig.known[link] if link in rig.known else mass_alone(rig.known)
    rest = max(total - machine.inertia({**others, rotor: 0.0, link: own}), 0.0)
    return {rotor: rest, link: own if rest else beyond(0.0)}


def _open(
    channels: Channels, rig: Rig, problem: Problem, open_inertia: bool
) -> tuple[tuple[Coefficient, ...], str]:
    """The free columns, and the letter that the gravity column changes."""
    found: list[Coefficient] = []
    gravity = problem.model.expand(problem.model.balance("mechanical").sum_of("gravity"))
    turning = gravity != 0
    factors = {v.L: v.L.symbol, v.M: v.M.symbol, v.phi: sp.Abs(sp.cos(v.phi.symbol))}
    free = (q.name for q, x in factors.items() if q.name in rig.unknown and _proportional(gravity, x))
    adjusts = "scale" if problem.has("scale") else next(free, "")
    by_voltage = channels.motor.measured_by == "voltage"
    if open_inertia:
        found.append(Coefficient(problem.drive.machine.rotor, "inertia", "kg m^2", 0.0))
    if LOAD in rig.unknown:
        found.append(Coefficient(LOAD, "load", "N m"))
    if turning and adjusts == "scale":
        own, by = next(c for c in problem.coefficients if c.role == "scale"), problem.drive.scale or 1.0
        found.append(Coefficient("gravity", "gravity", "", by * own.lower, by * own.upper))
    elif turning and adjusts:
        low, high = sorted(math.cos(x) if adjusts == "phi" else x for x in rig.unknown[adjusts])
        found.append(Coefficient("gravity", "gravity", "", low, high))
    swings = by_voltage and np.any(channels.motor.off & channels.selection.fit_rows)
    emf_known = problem.drive.machine.back_emf_letters <= set(rig.known)
    if swings and problem.scale is not None and not emf_known:
        found.append(Coefficient("back_emf", "back_emf", "V s/rad", *rig.unknown.get("k_e", (0.0, math.inf))))
    if by_voltage and "voltage_offset_V" in rig.estimate:
        found.append(Coefficient("offset", "offset", ""))
    if turning and "theta_zero_rad" in rig.estimate:
        found.append(Coefficient("zero_angle", "zero_angle", ""))
    return tuple(found), adjusts if turning else ""


def _proportional(torque: sp.Expr, part: sp.Expr) -> bool:
    """Whether a torque is a multiple of a part of it: then a factor on the one is a factor on the other."""
    x = sp.Dummy()
    rest = torque.xreplace({part: x})
    return not rest.free_symbols & part.free_symbols and sp.expand(sp.diff(rest, x) * x - rest) == 0
