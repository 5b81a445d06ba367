"""Identify a model on a log: coefficients with uncertainty, alignment, and the error on the held-out part.

Three models are fitted on the same training rows: the paper's with physical bounds, the same without bounds
(if it does better, a bound hides something that the model lacks), and Coulomb + viscous friction. Delay, zero
angle and masses known only by a range are searched for each of them (variable projection: for given values of
those the rest is linear). The held-out rows are used once, at the end.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from eccentric.identification import limits
from eccentric.identification.columns import (
    combinations,
    following_letters,
    identified_letters,
    own_letters,
)
from eccentric.identification.drive import in_drive_unit
from eccentric.identification.problem import Problem, pose, profiled, solved, warnings_of
from eccentric.identification.regression import (
    Coefficient,
    Design,
    Nonlinear,
    Profile,
    Solution,
    search,
)
from eccentric.identification.uncertainty import TWO_SIDED, Estimate, Spread, improvement, r_squared, rms
from eccentric.model import Load, Model
from eccentric.rigs import Rig
from eccentric.signals import (
    LEAST_HELD_OUT,
    Band,
    Channels,
    band_of,
    require_rows,
    rows_of,
    white_noise,
)

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Undetected:
    """A coefficient of friction by F_N whose interval reaches 0.

    Attributes:
        upper: end of its 95 % interval, in `unit`.
        reference: the model's own value, None where the log has no newton metres to compare it in.
        z: the reference in standard errors of the coefficient when it is free.
    """

    upper: float
    unit: str
    reference: float | None
    z: float | None

    @property
    def power(self) -> float | None:
        """The probability that the interval of such a log excludes 0 if the reference is true."""
        return None if self.z is None else detection_power(self.z)


def detection_power(z: float) -> float:
    """The probability that a coefficient of z standard errors has an interval without 0."""
    return float(ndtr(z - TWO_SIDED))


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
        """Friction by F_N that the log does not show, by letter: its upper bounds, what could have been seen.

        A coefficient whose interval reaches 0 is not detected, and its upper bound is the end of that
        interval. Whether this is news depends on the value that one expects: z is that of the model (Table 1
        of the paper, for the bundled models) in standard errors of the coefficient, with all others free and
        no bounds. At z = 5 the log would have shown it nearly always, at z = 1 hardly ever.
        """
        problem, free = self.problem, self.solutions["paper_unbounded"]
        shown = {**self.coefficients, **self.combinations}
        error = free.spread([one for one in problem.nonlinear if one.name in free.at])
        roles = {c.role: float(x) for c, x in zip(free.design.coefficients, free.values, strict=True)}
        torque = problem.scale is None and problem.unit == "N m"
        per_newton = roles.get("scale", 1.0 if torque else 0.0)
        own = own_letters(problem.model) if per_newton > 0.0 else {}
        found: dict[str, Undetected] = {}
        for k, (columns, c) in enumerate(zip(problem.friction, problem.coefficients, strict=False)):
            estimate = shown.get(c.letter)
            if columns[0].load is not Load.NORMAL or estimate is None or estimate.interval[0] > 0.0:
                continue
            size, reference = float(np.sqrt(error.matrix[k, k])), own.get(c.letter)
            z = reference * per_newton / size if reference and 0.0 < size < math.inf else None
            found[c.letter] = Undetected(estimate.interval[1], estimate.unit, reference, z)
        return found

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
    rows = problem.rows
    least = rows.per_coefficient * (len(problem.coefficients) + len(problem.nonlinear))
    require_rows(rows, "train", least, where)
    require_rows(rows, "score", LEAST_HELD_OUT, where)
    paper, baseline = solved(problem, where, positive={"scale"}), problem.baseline
    solutions = {
        "linear": search(baseline),
        "paper": paper,
        "paper_unbounded": search(problem, bounds=False, start=paper.at),
    }
    paper, profiles = profiled(problem, paper)
    solutions["paper"] = paper
    others = [one.design(paper.at) for one in (problem.narrowed, problem.later) if one is not None]
    error = paper.spread(problem.nonlinear, (paper.design, *others))
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
    emf = Nonlinear(letter, "V s/rad", 0.0, math.inf, (value,), max(value, 1e-6))
    whole = dataclasses.replace(whole, rig=rig, nonlinear=(*whole.nonlinear, emf))
    start = _widened(paper, narrow, whole, {**paper.at, letter: value})
    friction = [narrow.coefficients[k].letter for k in shared]
    rest = np.array([c.letter not in friction for c in whole.coefficients])
    return whole, dataclasses.replace(start, values=np.where(rest, start.values, start.design.lower))


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
    drive, (residual, rows) = problem.aligned(paper.at), problem.compared(paper)
    noise = white_noise(drive.torque(), drive.channels.time.segment)
    band = band_of(residual, problem.moving(paper), rows, drive.channels, noise)
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
    warnings = [*problem.warnings, *warnings_of(problem, paper, profiles), *said]
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
        _free_cubic(problem, paper),
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


# The free cubic of a coast-down: c_0 + c_1 |w| + c_2 w^2 + c_3 |w|^3 against the motion, without bounds.
#
# Spin-down tests publish these four, and a coast-down on a level axis shows no more: the speed is its only
# variable, so that air drag with w^2 has the same column as friction under a load that grows with w^2.

_UNITS = ("N m", "N m s/rad", "N m s^2/rad^2", "N m s^3/rad^3")


def _free_cubic(problem: Problem, paper: Solution) -> dict[str, Estimate]:
    """The coefficients c_0 to c_3, in the unit of the fit; none but of a coast-down in case C1."""
    drive, rows = problem.drive, problem.rows
    if not drive.channels.motor.coasting or problem.rig.case != "C1":
        return {}
    omega = drive.channels.motion.omega_m
    powers = np.stack([np.sign(omega) * np.abs(omega) ** n for n in range(len(_UNITS))], axis=1)
    free = [
        Coefficient(f"c_{n}", "friction", in_drive_unit(unit, problem.unit)) for n, unit in enumerate(_UNITS)
    ]
    target = problem.design(paper.at).target
    return Design(tuple(free), target, rows.mean(powers), rows.train, rows.weights).solve().estimates()
