"""A rig and a model as a linear problem: target = columns @ coefficients, for given nonlinear values.

    torque:  tau                = J alpha + G + f                       [N m]
    current: k_i i              = J alpha + G + f                       [N m]
    voltage: (k_i/R) u          = J alpha + G + f + (k_i k_e/R) w       [N m]   R and k_i known
    voltage: u                  = (R/k_i) (J alpha + G + f) + k_e w     [V]     else
    current: i                  = (1/k_i) (J alpha + G + f)             [A]     k_i known by a range only

Friction and inertia are unit steps of the emitted residual (`residuals`).  Known parts move to the left; with
an unknown scale s (R/k_i or 1/k_i) the known part of J alpha + G becomes the column of s, and without it only
products with s are identifiable.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.core import InputError, MissingValueError, few
from eccentric.identification import limits
from eccentric.identification.columns import (
    Combination,
    bounded_letters,
    combinations_of,
    load_letters,
    require_case,
    scale_of,
    with_own,
)
from eccentric.identification.drive import (
    DRIVE_UNITS,
    LOAD,
    PER_INERTIA,
    Drive,
    Machine,
    inputs_of,
    load_gain,
)
from eccentric.identification.expressions import alike, seen_columns
from eccentric.identification.fit_data import Emitted, Residuals
from eccentric.identification.regression import (
    ColumnRole,
    Design,
    Nonlinear,
    Profile,
    Solution,
    profile,
    require_rank,
    search,
)
from eccentric.model import AxisKind, Column, Load, Model, Role, regressor
from eccentric.model import vocabulary as v
from eccentric.rigs import KNOWNS, Rig
from eccentric.signals import Channels, Rows, fit_rows, rows_of, rows_of_each, with_doubts

_UNITS = {known.name: known.unit for known in KNOWNS}


def nonlinear_of(channels: Channels, rig: Rig, model: Model, needed: set[str]) -> list[Nonlinear]:
    """Return the nonlinear values: delay and zero angle to estimate, `needed` letters with ranges."""
    step = channels.time.logged_step_s
    turning = any(
        "theta_m" in {x.name for x in model.expand(e).free_symbols}
        for e in (*(c.basis for c in regressor(model)), model.balance("mechanical").sum_of("gravity"))
    )
    found: list[Nonlinear] = []
    if "input_delay_s" in rig.estimate and channels.motor.measured_by == "voltage":
        starts, most = (
            tuple(k * step for k in limits.DELAYS),
            max(limits.LONGEST_DELAY_S, limits.LONGEST_DELAY_STEPS * step),
        )
        found.append(Nonlinear("input_delay_s", "s", 0.0, most, starts, step))
    if "theta_zero_rad" in rig.estimate and turning:
        found.append(Nonlinear("theta_zero_rad", "rad", -math.pi, math.pi, (0.0,), limits.ANGLE_STEP))
    for letter, (low, high) in rig.unknown.items():
        if letter in needed:
            starts, step = (
                tuple(low + part * (high - low) for part in limits.STARTS),
                (high - low) / limits.STEPS_OF_A_RANGE,
            )
            found.append(Nonlinear(letter, _UNITS[letter], low, high, starts, step))
    return found


Array = NDArray[np.float64]
_ALIGNED = ("input_delay_s", "theta_zero_rad")


@dataclass(frozen=True)
class Problem:
    """What is minimised.

    `drive` is as the rig describes it, its unit that of target and residual; `scale` is s if the log has to
    determine it, else None; `friction` are the columns of the regressor, those of one coefficient together:
    the first coefficients, in this order. `newtons` is what the unit of target and residual is in N m, for
    friction that follows the torque of the motor.
    """

    drive: Drive
    rig: Rig
    model: Model
    emitted: Emitted
    rows: Rows
    scale: sp.Expr | None
    coefficients: tuple[Combination, ...]
    nonlinear: tuple[Nonlinear, ...]
    friction: tuple[tuple[Column, ...], ...]
    warnings: tuple[str, ...]
    newtons: float = 1.0

    def design(self, at: Mapping[str, float]) -> Design:
        """Return the design for given nonlinear values."""
        drive, values, rotor = self.aligned(at), self.values_at(at), self.drive.machine.rotor
        residuals = Residuals(self.model, drive, self.rows, values)
        unknown = [tuple(column.parameter.name for column in columns) for columns in self.friction]
        unknown += [(rotor,)] if self.has("inertia") else []
        try:
            current = None if self.newtons == 1.0 else residuals.inputs["i"] * self.newtons
            target, steps = residuals.design("mechanical", values, unknown, current)
        except ValueError as error:
            raise InputError(self.rig.path, problem=str(error)) from None
        if self.has("inertia"):
            # The column is that of the whole inertia: a part that the rig knows is in it, not in the target.
            target = target + drive.machine.inertia({**values, rotor: 0.0}) * steps[:, -1]
        one = np.ones(len(target))
        # What the rig says of a constant load is added beside the model, whether the model has it or not.
        target = target - self.rig.known.get(LOAD, 0.0) * load_gain(self.rig) * one
        torque = target if self.scale is None else self.rows.mean(residuals.torque)
        beside: dict[ColumnRole, Array] = {
            "scale": torque - target,
            "load": load_gain(self.rig) * one,
            "offset": one / (drive.scale or 1.0),
        }
        columns = [beside[c.role] for c in self.coefficients if c.role in beside]
        return Design(
            self.coefficients, torque, np.column_stack([steps, *columns]), self.rows.train, self.rows.weights
        )

    @property
    def baseline(self) -> Problem:
        """The problem of Coulomb + viscous friction: one coefficient of each, for both directions."""
        alone = [column for column, *_ in self.friction]
        groups, bench = alike(alone), self.coefficients[len(alone) :]
        return dataclasses.replace(
            self,
            friction=tuple(tuple(alone[k] for k in group) for group in groups),
            coefficients=(*(self.coefficients[first] for first, *_ in groups), *bench),
        )

    @property
    def without_current(self) -> Problem:
        """The problem without friction that follows the current, which no regression on the drive shows."""
        bases = [self.model.expand(column.basis) for column, *_ in self.friction]
        kept = [k for k, basis in enumerate(bases) if v.i.symbol not in basis.free_symbols]
        bench = self.coefficients[len(self.friction) :]
        return dataclasses.replace(
            self,
            friction=tuple(self.friction[k] for k in kept),
            coefficients=(*(self.coefficients[k] for k in kept), *bench),
        )

    @property
    def is_baseline(self) -> bool:
        """Whether the model itself is Coulomb + viscous friction, as that of a carriage."""
        roles = sorted(column.role.name for columns in self.friction for column in columns)
        unloaded = all(column.load is Load.NONE for columns in self.friction for column in columns)
        return unloaded and roles == [Role.COULOMB.name, Role.VISCOUS.name]

    @property
    def narrowed(self) -> Problem | None:
        """The same problem below a lower cut-off; None where no low pass is used."""
        if self.rows.smooth is None or self.drive.channels.time.points_per_row > 1:
            return None
        drive = self.drive.narrowed()
        channels, rig = drive.channels, drive.channels.rig
        return dataclasses.replace(self, drive=drive, rig=rig, rows=fit_rows(channels, rig))

    @property
    def later(self) -> Problem | None:
        """The same problem with the current sampled one standard error later in its row."""
        drive = self.drive.later
        return None if drive is None else dataclasses.replace(self, drive=drive)

    def held_out(self, solution: Solution) -> tuple[Array, Array]:
        """Residual and drive signal on the held-out rows that every command compares models on."""
        residual, rows = self.compared(solution)
        signal = rows.mean(self.aligned(solution.at).driven_by(self._found(solution)))
        return residual[rows.score], signal[rows.score]

    def compared(self, solution: Solution) -> tuple[Array, Rows]:
        """Residual (m,) on the rows that every command compares models on, and these rows."""
        judged = dataclasses.replace(self, rows=rows_of(self.drive.channels, self.rig))
        design = judged.design(solution.at)
        return design.target - design.columns @ solution.values, judged.rows

    def moving(self, solution: Solution) -> Array:
        """What accelerates the inertia (n,), in the unit of the residual."""
        of = {c.role: value for c, value in zip(self.coefficients, solution.values, strict=True)}
        drive, values = self.aligned(solution.at), self.values_at(solution.at)
        channels, machine, scale = drive.channels, drive.machine, of.get("scale", 1.0)
        inertia = machine.inertia(values)
        carried = machine.inertia_along(values, channels.carried) - inertia
        return (of.get("inertia", inertia * scale) + carried * scale) * channels.motion.alpha_m

    def with_scale_of(self, values: Array) -> Problem:
        """The same with `newtons` by the scale among values of the coefficients."""
        of = {c.role: float(x) for c, x in zip(self.coefficients, values, strict=True)}
        return dataclasses.replace(self, newtons=1.0 / of.get("scale", 1.0))

    def _found(self, solution: Solution) -> dict[str, float] | None:
        """The inertia that a coast-down under gravity was found to have; None where the rig has it."""
        if not self.drive.channels.motor.coasting:
            return None
        free = [x for c, x in zip(self.coefficients, solution.values, strict=True) if c.role == "inertia"]
        rotor = self.drive.machine.rotor
        return {**dict.fromkeys(self.drive.machine.inertias, 0.0), rotor: free[0]} if free else None

    @property
    def unit(self) -> str:
        """Unit of target and residual."""
        return self.drive.unit

    def has(self, role: ColumnRole) -> bool:
        """Whether a coefficient has this role."""
        return any(c.role == role for c in self.coefficients)

    def aligned(self, at: Mapping[str, float]) -> Drive:
        """The drive with the delay and the zero angle of some nonlinear values."""
        aligned = {name: value for name, value in at.items() if name in _ALIGNED}
        return self.drive.aligned(self.rig, aligned) if aligned else self.drive

    def values_at(self, at: Mapping[str, float]) -> dict[str, float]:
        """Every parameter of the model: as the rig has it, else as the model has it; none for friction."""
        given = {**self.drive.machine.absent, **self.drive.known}
        unfitted = dict.fromkeys((q.name for q in self.model.friction_parameters), 0.0)
        return {**given, **self.drive.scaled(), **at, **unfitted, LOAD: 0.0}


def pose(channels: Channels, rig: Rig, model: Model, *, by_current: bool = False) -> Problem:
    """Return the problem of a log under a rig and a model; `by_current` lets its friction follow the current.

    Raises InputError for a model of another case than the rig's, a letter that the model needs and the rig
    gives neither as a value nor as a range, a current without k_i, and friction that depends on what the log
    does not have, on the current or on hidden states.
    """
    require_case(rig, model)
    channels, given, rig = channels.driven, rig, with_own(rig, model)
    # What friction follows of the current is a torque: with a scale, k_i is 1 by convention.
    motor = Machine(model).torque_letters if by_current else frozenset[str]()
    if lacking := sorted(load_letters(model) - motor - set(rig.known) - set(rig.unknown)):
        several = len(lacking) > 1
        raise MissingValueError(
            rig.path,
            f"[known] {rig.axis.named(few(lacking))}",
            "none of them" if several else "neither",
            why=f"for {model.name}, or {'their ranges' if several else 'its range'} in [unknown]",
            letter=lacking[0],
        )
    emitted = Emitted(model)
    used = {*emitted.inputs_of("regressor"), *emitted.inputs_of("gravity_torque")}
    used |= {"i"} if model.balance("mechanical").sum_of("actuator") != 0 else set()
    if missing := used - set(inputs_of(channels)) - ({"i"} if by_current else set()):
        # What follows the current would explain the drive by the drive; hidden states need a past.
        raise InputError(
            model.name,
            problem=f"fit requires friction and load that depend on motion, time and logged temperature"
            f", got some that depend on {', '.join(sorted(missing))}",
        )
    by = channels.motor.measured_by
    machine = Machine(model)
    scale = scale_of(by, rig, machine)
    rows, drive = fit_rows(channels, rig), _posed(channels, rig, machine, scale)
    warnings = list(channels.intake.warnings)
    if rows.operator is not None:
        compared = rows_of(channels, rig).description
        on = f", and its error taken, on {compared}" if compared == rows.description else ""
        on = on or f" on {rows.description}, and its error taken on {compared}"
        warnings.append(f"the log is fitted{on}")
    coefficients = combinations_of(drive, rig, model, scale)
    kept = seen_columns(model, {} if drive.channels.carried else rig.known)
    gone = [c.letter for k, c in enumerate(coefficients) if c.role == "friction" and k not in kept]
    warnings += massless(gone, rig.axis)
    coefficients = [c for c in coefficients if c.letter not in gone]
    nonlinear = nonlinear_of(channels, rig, model, load_letters(model))
    searched = {s.name for s in nonlinear}
    idle = set(rig.unknown) - searched - bounded_letters(coefficients, drive.machine)
    idle |= rig.estimate - searched - {c.letter for c in coefficients}
    warnings += [
        f"{rig.axis.named(name)} has no effect on {model.name} driven by {rig.axis.named(by)}"
        for name in sorted(idle)
    ]
    return Problem(
        drive,
        given,
        model,
        emitted,
        rows,
        scale,
        tuple(coefficients),
        tuple(nonlinear),
        tuple((regressor(model)[k],) for k in kept),
        tuple(warnings),
    )


def _posed(channels: Channels, rig: Rig, machine: Machine, scale: sp.Expr | None) -> Drive:
    """The drive as the rig describes it: with a scale for the log to determine, in its own unit."""
    by = channels.motor.measured_by
    if scale is not None:
        return Drive(machine, channels, rig.known, 1.0, DRIVE_UNITS[by])
    if by != "voltage":
        return Drive(machine, channels, rig.known, None, PER_INERTIA if rig.per_inertia else "N m")
    per_volt = machine.torque(rig.known, machine.current({**machine.absent, **rig.known}, 1.0, 0.0))
    return Drive(machine, channels, rig.known, 1.0 / float(per_volt), "N m")


def massless(letters: Sequence[str], axis: AxisKind) -> list[str]:
    """The warning of friction that has no mass to follow; nothing without any."""
    names = ", ".join(map(axis.named, letters))
    return [f"no unbalanced mass: {names} have no effect and are omitted"] if letters else []


def solved(problem: Problem, where: str, positive: Collection[ColumnRole]) -> Solution:
    """The best solution; `where` opens a message, coefficients of `positive` roles have to be above zero.

    Raises InputError for columns that are dependent on this log, and for a drive that contradicts the motion.
    """
    found = search(problem)
    axis = problem.rig.axis
    names = [axis.named(c.name) for c in problem.coefficients]
    with with_doubts(problem.drive.channels.intake.findings):
        require_rank(found.design.columns[problem.rows.train], names, where, axis)
        for c, value in zip(problem.coefficients, found.values, strict=True):
            if c.role in positive and value <= 0.0:
                load = f", and that of {axis.named(LOAD)}" if problem.rig.known.get(LOAD) else ""
                by = axis.named(problem.drive.channels.motor.measured_by)
                signs = f"do the signs of {by} and {axis.term('angle')} agree{load}?"
                why = delay_or_inertia(found.at, axis) if c.role == "inertia" else ""
                raise InputError(
                    where,
                    f"{axis.named(c.name)} ({axis.term(c.role)} of the drive) above 0",
                    f"{value:.3g}: {why or signs}",
                )
    return found


def delay_or_inertia(at: Mapping[str, float], axis: AxisKind) -> str:
    """That an estimated delay takes the place of an inertia, "" where none is estimated."""
    if not at.get("input_delay_s"):
        return ""
    inertia = axis.term("inertia")
    return (
        f"input_delay_s = {at['input_delay_s']:.3g} s is estimated as well, and at one frequency a delay"
        f" and an {inertia} cannot be told apart: declare the {inertia} or the delay, or log several"
        " frequencies"
    )


# What is unusual about the solution of a problem.


def profiled(problem: Problem, paper: Solution) -> tuple[Solution, dict[str, Profile]]:
    """The best solution along the ranges of the rig, and the profile of each by letter."""
    profiles = {
        s.name: profile(problem, paper, s) for s in problem.nonlinear if s.name in problem.rig.unknown
    }
    return min([paper, *(p.best for p in profiles.values())], key=lambda one: one.cost), profiles


def no_friction(channels: Channels, axis: AxisKind) -> list[str]:
    """The warning of a fit with all friction at 0; nothing where a check of the log has found a reason."""
    if any(f.doubts_the_rig for f in channels.intake.findings):
        return []
    measured = axis.named(channels.motor.measured_by)
    return [f"the fit leaves no friction: do the signs of {measured} and {axis.term('angle')} agree?"]


def warnings_of(problem: Problem, paper: Solution, profiles: Mapping[str, Profile]) -> list[str]:
    """What is unusual about a solution: no friction, an inertia or range at its end, what a range leaves."""
    found, axis = [], problem.rig.axis
    friction = [a for c, a in zip(problem.coefficients, paper.active, strict=True) if c.role == "friction"]
    if all(a == -1 for a in friction):
        found += no_friction(problem.drive.channels, axis)
    for c, active in zip(problem.coefficients, paper.active, strict=True):
        if c.role != "inertia":
            continue
        declared = _declared_alone(problem, paper)
        at_bound = active == -1 or bool(declared)
        if at_bound or _one_frequency_for_both(problem):
            where = "is at its bound" if at_bound else "may be wrong"
            why = delay_or_inertia(paper.at, axis) or declared
            found += [f"{axis.named(c.name)} {where}: {why}"] if why else []
    for s in problem.nonlinear:
        value = paper.at[s.name]
        if s.end_at(value):
            found.append(
                f"{axis.named(s.name)} ="
                f" {value:.4g}{'' if s.unit == '1' else f' {axis.unit(s.unit)}'} is at the end of its range"
                f" {s.lower:g} to {s.upper:g}"
            )
    for name, p in profiles.items():
        change = 100.0 * (max(p.rmse) / min(p.rmse) - 1.0)
        found.append(
            f"{axis.named(name)} is known only as a range; within it, the training error changes"
            f" by {change:.1f} %"
        )
    return found


def _declared_alone(problem: Problem, paper: Solution) -> str:
    """The one inertia that the rig declares, where it is all of that which the log shows, else ""."""
    of = {c.role: float(x) for c, x in zip(problem.coefficients, paper.values, strict=True)}
    machine, rig = problem.drive.machine, with_own(problem.rig, problem.model)
    opened = [name for name in (machine.rotor, machine.link) if name not in rig.known]
    if not machine.link or len(opened) != 1 or not (problem.scale is None or "scale" in of):
        return ""
    (name,) = {machine.rotor, machine.link} - set(opened)
    least = machine.inertia({**rig.known, opened[0]: 0.0})
    spent = of["inertia"] / of.get("scale", 1.0) <= least * (1.0 + limits.SAME)
    return f"[known] {name} = {rig.known[name]:.4g} kg m^2" if spent else ""


def _one_frequency_for_both(problem: Problem) -> bool:
    """Whether delay and inertia are both open, and the motion has one frequency.

    A voltage that acts later by dt lacks dt du/dt, which at one frequency is in phase with the acceleration.
    """
    open_inertia = any(c.role == "inertia" for c in problem.coefficients)
    if not open_inertia or "input_delay_s" not in {s.name for s in problem.nonlinear}:
        return False
    time, speed = problem.drive.channels.time, problem.drive.channels.motion.omega_m
    stretches = rows_of_each(time.segment)
    least = 0.5 * max(map(len, stretches))
    found = [_one_frequency(time.t[rows], speed[rows]) for rows in stretches if len(rows) >= least]
    return min(found) > 0.0 and max(found) < limits.SAME_FREQUENCY * min(found)


def _one_frequency(t: Array, speed: Array) -> float:
    """The frequency [Hz] that has nearly all power of a speed (n,), 0 without one of several cycles."""
    power = np.abs(np.fft.rfft((speed - speed.mean()) * np.hanning(len(speed)))) ** 2
    peak = int(np.argmax(power))
    # A Hann window spreads a frequency over two steps of the spectrum to either side.
    about = float(np.sum(power[max(peak - 2, 0) : peak + 3]))
    if peak < limits.LEAST_CYCLES or about < limits.ONE_FREQUENCY * float(np.sum(power)):
        return 0.0
    return peak / float(t[-1] - t[0])
