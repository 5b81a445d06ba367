"""Identify a model on a log: coefficients with uncertainty, alignment, and the error on the held-out part.

Three models are fitted on the same training rows: the paper's with physical bounds, the same without bounds
(if it does better, a bound hides something that the model lacks), and Coulomb + viscous friction. Delay, zero
angle and masses known only by a range are searched for each of them (variable projection: for given values of
those the rest is linear). The held-out rows are used once, at the end.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.core import InputError, MissingValueError
from eccentric.identification import limits
from eccentric.identification.coast_down import free_cubic
from eccentric.identification.columns import (
    combinations,
    following_letters,
    identified_letters,
    require_case,
    with_own,
)
from eccentric.identification.detection import Undetected, undetected
from eccentric.identification.drive import LOAD, PER_INERTIA, Drive
from eccentric.identification.machine import Machine, evaluated
from eccentric.identification.problem import Problem, pose
from eccentric.identification.regression import (
    Coefficient,
    ColumnRole,
    Nonlinear,
    Profile,
    Solution,
    profile,
    require_rank,
    search,
)
from eccentric.identification.uncertainty import Estimate, Spread, improvement, r_squared, rms
from eccentric.model import AxisKind, Model
from eccentric.model import vocabulary as v
from eccentric.rigs import ALIGNMENT, Rig, mass_alone
from eccentric.signals import (
    LEAST_HELD_OUT,
    Band,
    Channels,
    band_of,
    require_rows,
    rows_of,
    rows_of_each,
    white_noise,
    with_doubts,
)

Array = NDArray[np.float64]

# The fit of a model and of Coulomb + viscous friction, on the same rows.


@dataclass(frozen=True)
class Fit:
    """The result of a fit; `solutions` and held-out `rmse` by model: linear, paper, paper_unbounded.

    `coefficients` are those of the columns, `searched` the nonlinear values (with `profiles` over the ranges
    of unknown quantities), `combinations` coefficients that are not a single letter; `identified` the letters
    that the log identifies, and those that it does not. `spread` is that of coefficients and searched
    values, in this order. `percent` is 100 (1 - paper/linear). `r_squared`
    by model is that of the drive signal on the held-out rows; `band` is that of the error of `paper`.
    `structured` says whether waves of the angle and steps of the speed explain what `paper` does not;
    `cubic` are the coefficients of a free cubic, of a coast-down only.
    """

    problem: Problem
    solutions: Mapping[str, Solution]
    coefficients: Mapping[str, Estimate]
    combinations: Mapping[str, Estimate]
    searched: Mapping[str, Estimate]
    profiles: Mapping[str, Profile]
    identified: tuple[list[str], list[str]]
    spread: Spread
    rmse: Mapping[str, float]
    percent: float
    percent_interval: tuple[float, float]
    r_squared: Mapping[str, float]
    band: Band | None
    warnings: tuple[str, ...]
    structured: bool = False
    cubic: Mapping[str, Estimate] = field(default_factory=dict)

    @property
    def fits_the_rig(self) -> bool:
        """Whether the log can be from this rig, in these units."""
        return self.r_squared["paper"] >= limits.LEAST_R_SQUARED or self.structured

    @property
    def undetected(self) -> dict[str, Undetected]:
        """Friction by F_N that the log does not show: its upper bounds, and what could have been seen."""
        shown = {**self.coefficients, **self.combinations}
        return undetected(self.problem, self.solutions["paper_unbounded"], shown)

    @property
    def bounds_active(self) -> list[str]:
        """Names of the coefficients with an active bound."""
        return [name for name, e in self.coefficients.items() if e.bound_active]


def fit(channels: Channels, rig: Rig, model: Model, where: str = "log", *, by_current: bool = False) -> Fit:
    """Fit a model; `where` names the log in messages.

    With `by_current`, friction of the model may follow the current; it is left at 0, since regression on the
    drive would explain the drive by itself.

    Raises InputError for whatever `pose` refuses, too few rows, and columns that are dependent on this log.
    """
    whole = pose(channels, rig, model, by_current=by_current)
    problem = whole.without_current if by_current else whole
    _require_rows(problem, where)
    paper, baseline = solved(problem, where, positive={"scale"}), problem.baseline
    solutions = {
        "linear": search(baseline),
        "paper": paper,
        "paper_unbounded": search(problem, bounds=False, start=paper.at),
    }
    profiles = {s.name: profile(problem, paper, s) for s in problem.nonlinear if s.name in rig.unknown}
    better = min(profiles.values(), key=lambda p: p.best.cost, default=None)
    if better is not None and better.best.cost < paper.cost:
        solutions["paper"] = paper = better.best
    narrowed = problem.narrowed
    filtered = None if narrowed is None else (paper.design, narrowed.design(paper.at))
    error = paper.spread(problem.nonlinear, filtered)
    return _judged(problem, solutions, profiles, error, problem)


def posed_for_motion(found: Fit, model: Model) -> tuple[Problem, Solution]:
    """The problem of a fit as simulated motion shows it, and a solution to start from.

    Friction may follow the current: it is 0 in the fit. The back-EMF of a voltage stands apart from viscous
    friction where the motor is off at times or friction follows its torque: the search starts from all of it.
    """
    narrow, paper = found.problem, found.solutions["paper"]
    rig, channels, letters = narrow.rig, narrow.drive.channels, narrow.drive.machine.back_emf_letters
    whole = pose(channels, rig, model, by_current=True)
    follows = len(whole.coefficients) > len(narrow.coefficients)
    if not narrow.drive.back_emf_in_friction or not (follows or np.any(channels.motor.off)):
        return whole, _widened(paper, narrow, whole, paper.at)
    (letter,) = letters
    shared = [
        k for k, c in enumerate(narrow.coefficients) if letter in {s.name for s in c.expression.free_symbols}
    ]
    per_unit = narrow.drive.machine.damping({**narrow.values_at(paper.at), letter: 1.0})
    value = float(np.mean(paper.values[shared])) / per_unit
    known = dataclasses.replace(rig, known={**rig.known, letter: value})
    whole = pose(channels, known, model, by_current=True)
    emf = Nonlinear(letter, _EMF_UNIT, 0.0, math.inf, (value,), max(value, 1e-6))
    whole = dataclasses.replace(whole, rig=rig, nonlinear=(*whole.nonlinear, emf))
    start = _widened(paper, narrow, whole, {**paper.at, letter: value})
    friction = [narrow.coefficients[k].letter for k in shared]
    rest = np.array([c.letter not in friction for c in whole.coefficients])
    return whole, dataclasses.replace(start, values=np.where(rest, start.values, start.design.lower))


_EMF_UNIT = "V s/rad"


def _widened(solution: Solution, narrow: Problem, whole: Problem, at: Mapping[str, float]) -> Solution:
    """A solution with 0 for the coefficients that its problem does not have."""
    place = {c.letter: k for k, c in enumerate(narrow.coefficients)}
    own = [place.get(c.letter) for c in whole.coefficients]
    values = np.array([0.0 if k is None else solution.values[k] for k in own])
    active = np.array([-1 if k is None else solution.active[k] for k in own], np.int64)
    return dataclasses.replace(solution, design=whole.design(at), values=values, active=active, at=at)


def with_solution(found: Fit, problem: Problem, solution: Solution, error: Spread) -> Fit:
    """A fit with other values of the paper's model, and their spread, judged on the same held-out rows."""
    problem = problem.with_scale_of(solution.values)
    return _judged(problem, {**found.solutions, "paper": solution}, found.profiles, error, found.problem)


def _judged(
    problem: Problem,
    solutions: Mapping[str, Solution],
    profiles: Mapping[str, Profile],
    error: Spread,
    others: Problem,
) -> Fit:
    """The fit with solutions by model; `others` is the problem of those but the paper's."""
    paper = solutions["paper"]
    coefficients, searched = _estimates(problem, paper, error)
    problems = {"linear": others.baseline, "paper": problem, "paper_unbounded": others}
    held_out = {name: problems[name].held_out(solution) for name, solution in solutions.items()}
    percent, interval = improvement(held_out["linear"][0], held_out["paper"][0])
    band = _band(problem, paper)
    # What follows from others by default (F_T) counts as known: the other factor is a parameter by itself.
    fixed = {*problem.drive.known, *(s.name for s in problem.nonlinear), *following_letters(problem.model)}
    said = [] if band is None or not band.filtered else [band.warning]
    explained = {name: r_squared(*pair) for name, pair in held_out.items()}
    beside = _beside_waves(problem, paper) if explained["paper"] < limits.LEAST_R_SQUARED else 0.0
    if beside >= limits.LEAST_R_SQUARED:
        angle = problem.rig.axis.term("angle")
        said.append(
            f"the model explains {explained['paper']:.0%} of the drive's mean square; with terms that are"
            f" periodic in the {angle} or follow the speed, {beside:.0%}: run diagnose to look for what is"
            " missing"
        )
    warnings = [*problem.warnings, *_warnings(problem, paper, profiles), *said]
    return Fit(
        problem,
        solutions,
        coefficients,
        combinations(problem.coefficients, paper.values, paper.active, error),
        searched,
        profiles,
        identified_letters(problem.coefficients, fixed),
        error,
        {name: rms(error) for name, (error, _) in held_out.items()},
        percent,
        interval,
        explained,
        band,
        tuple(warnings),
        beside >= limits.LEAST_R_SQUARED,
        free_cubic(problem, paper),
    )


def _beside_waves(problem: Problem, paper: Solution) -> float:
    """R^2 on the held-out rows with waves of the angle and steps of the speed beside the model.

    0 where the log contradicts the rig, since these could be an image of a wrong unit or sign, and where
    there are too few rows for so many columns.
    """
    drive = problem.aligned(paper.at)
    if any(finding.doubts_the_rig for finding in drive.channels.intake.findings):
        return 0.0
    judged = dataclasses.replace(problem, rows=rows_of(drive.channels, problem.rig))
    design, rows, motion = judged.design(paper.at), judged.rows, drive.channels.motion
    link = {n * problem.rig.known.get("mu", 1.0) for n in range(1, limits.WAVES_OF_THE_LINK + 1)}
    orders = [*range(1, limits.WAVES_OF_THE_MOTOR + 1), *(nu for nu in sorted(link) if nu != round(nu))]
    waves = [f(nu * motion.theta_m) for nu in orders for f in (np.cos, np.sin)]
    edges = np.quantile(
        motion.omega_m[drive.channels.selection.fit_rows], np.linspace(0, 1, limits.SPEEDS + 1)[1:-1]
    )
    steps = [(np.digitize(motion.omega_m, edges) == k).astype(float) for k in range(limits.SPEEDS)]
    beside = rows.mean(np.column_stack([*waves, *steps]))
    if np.count_nonzero(rows.train) < rows.per_coefficient * beside.shape[1]:
        return 0.0
    left = design.target - design.columns @ paper.values
    found = np.linalg.lstsq(beside[rows.train], left[rows.train], rcond=limits.SAME)[0]
    return r_squared((left - beside @ found)[rows.score], rows.mean(drive.driven_by())[rows.score])


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
                why = _delay_or_inertia(found.at, axis) if c.role == "inertia" else ""
                raise InputError(
                    where,
                    f"{axis.named(c.name)} ({axis.term(c.role)} of the drive) above 0",
                    f"{value:.3g}: {why or signs}",
                )
    return found


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


def _band(problem: Problem, paper: Solution) -> Band | None:
    drive = problem.aligned(paper.at)
    noise = white_noise(drive.torque(), drive.channels.time.segment)
    residual, rows = problem.compared(paper)
    return band_of(residual, problem.moving(paper), rows, drive.channels, noise)


def _require_rows(problem: Problem, where: str) -> None:
    rows = problem.rows
    least = rows.per_coefficient * (len(problem.coefficients) + len(problem.nonlinear))
    require_rows(rows, "train", least, where)
    require_rows(rows, "score", LEAST_HELD_OUT, where)


def _estimates(
    problem: Problem, paper: Solution, error: Spread
) -> tuple[dict[str, Estimate], dict[str, Estimate]]:
    """Return estimates of the coefficients and of the searched values, by name."""
    coefficients, unit = paper.estimates(error), np.eye(len(error.alone))
    searched: dict[str, Estimate] = {}
    for k, s in enumerate(problem.nonlinear, start=len(coefficients)):
        value, ends = paper.at[s.name], (s.lower, s.upper)
        found = error.estimate(value, unit[k], s.unit, ends, s.end_at(value))
        if found.std_error == 0.0:
            # All friction terms that contain it are zero: nothing in the log depends on it.
            found = Estimate(value, s.upper - s.lower, ends, s.unit)
        searched[s.name] = found
    return coefficients, searched


def _delay_or_inertia(at: Mapping[str, float], axis: AxisKind) -> str:
    """That an estimated delay takes the place of an inertia, "" where none is estimated."""
    if not at.get("input_delay_s"):
        return ""
    inertia = axis.term("inertia")
    return (
        f"beside it input_delay_s = {at['input_delay_s']:.3g} s is estimated, and at one frequency a delay"
        f" and an {inertia} cannot be told apart: declare the {inertia} or the delay, or log several"
        " frequencies"
    )


def _warnings(problem: Problem, paper: Solution, profiles: Mapping[str, Profile]) -> list[str]:
    found, axis = [], problem.rig.axis
    friction = [a for c, a in zip(problem.coefficients, paper.active, strict=True) if c.role == "friction"]
    contradicted = any(f.doubts_the_rig for f in problem.drive.channels.intake.findings)
    if all(a == -1 for a in friction) and not contradicted:
        found.append(
            "the fit leaves no friction: do the signs of"
            f" {axis.named(problem.drive.channels.motor.measured_by)} and {axis.term('angle')} agree?"
        )
    for c, active in zip(problem.coefficients, paper.active, strict=True):
        at_bound = c.role == "inertia" and active == -1
        if at_bound or (c.role == "inertia" and _one_frequency_for_both(problem)):
            where = "is at its bound" if at_bound else "may be wrong"
            why = _delay_or_inertia(paper.at, axis)
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
            f"{axis.named(name)} is known only by a range: over it, the training error changes"
            f" by {change:.1f} %"
        )
    return found


# The drive of a log from a first fit of the paper's model: delay, zero angle, offset, inertia and scale.


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
        return Drive(machine, channels, _needed(channels, rig, base, machine), None, unit)
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
        known |= _inertias(rig, machine, found["inertia"] / s)
        rotor = rig.known.get(machine.rotor)
    elif open_inertia:
        # Volts have no part in kg m^2 that could be subtracted: the rotor stands for all of the inertia.
        known |= {machine.rotor: found["inertia"]} | ({machine.link: 0.0} if machine.link else {})
    opened, adjusts = _open(channels, rig, problem, open_inertia)
    return Drive(
        machine,
        channels.realigned(rig, dataclasses.replace(channels.alignment, **aligned)),
        known,
        scale,
        unit,
        opened,
        adjusts,
        _identified(first, scale if unit == "N m" else None, machine if open_inertia else None, rig),
        tuple(w for w in problem.warnings if w not in channels.intake.warnings),
        rotor,
    )


def _require_in_plane(rig: Rig, table: str, phi: float) -> None:
    if math.cos(phi) < limits.LEAST_IN_PLANE:
        raise InputError(
            f"{rig.path}: [{table}] phi",
            "gravity in the plane of motion",
            'none: case = "C1" in [known] is a level plane',
        )


def _identified(first: Solution, scale: float | None, inertia: Machine | None, rig: Rig) -> tuple[str, ...]:
    """Parameters that were estimated from the log."""
    scaled = set[str]() if scale is None or {"R", "k_i"} <= set(rig.known) else {"R", "k_i"}
    scaled -= {"k_i"} & set(rig.known)
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


def _inertias(rig: Rig, machine: Machine, total: float) -> dict[str, float]:
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
    own = rig.known.get(link, mass_alone(rig.known))
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
    if turning and adjusts:
        low, high = (-math.inf, math.inf) if adjusts != "phi" else sorted(map(math.cos, rig.unknown["phi"]))
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
