"""Identify a model on a log: coefficients with uncertainty, alignment, and the error on the held-out part.

Three models are fitted on the same training rows: the paper's with physical bounds, the same without bounds
(if it does better, a bound hides something that the model lacks), and Coulomb + viscous friction. Delay, zero
angle and masses known only by a range are searched for each of them (variable projection: for given values of
those the rest is linear). The held-out rows are used once, at the end.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.core import InputError
from eccentric.identification.columns import as_text, following_letters
from eccentric.identification.drive import LOAD
from eccentric.identification.limits import LEAST_R_SQUARED
from eccentric.identification.problem import Problem, pose
from eccentric.identification.regression import (
    ColumnRole,
    Estimate,
    Profile,
    Solution,
    Spread,
    improvement,
    profile,
    r_squared,
    require_rank,
    rms,
    search,
)
from eccentric.signals import LEAST_HELD_OUT, Band, Channels, band_of, require_rows, white_noise, with_doubts

if TYPE_CHECKING:
    from eccentric.model import Model
    from eccentric.rigs import Rig


# Which letters of the paper a log identifies, and which it shows only in combination.
#
# Every column of the problem has a coefficient that is an expression in the letters.  A letter is
# identifiable if its direction is in the row space of the Jacobian of those expressions: then no change of
# the other letters compensates for a change of it.


Array = NDArray[np.float64]


def identified_letters(problem: Problem) -> tuple[list[str], list[str]]:
    """Return the letters among the unknown ones that are identified, and those that are not."""
    expressions = [c.meaning for c in problem.coefficients if c.role != "offset"]
    # What follows from others by default (F_T) counts as known: the other factor is a parameter by itself.
    searched = {s.name for s in problem.nonlinear}
    fixed = {*problem.drive.known, *searched, *following_letters(problem.model)}
    plain = [e.xreplace({x: sp.Symbol(x.name, positive=True) for x in e.free_symbols}) for e in expressions]
    letters = sorted({x for e in plain for x in e.free_symbols if x.name not in fixed}, key=str)
    # Distinct primes are a generic point: no accidental cancellation in these few products.
    everything = sorted({x for e in plain for x in e.free_symbols}, key=str)
    point = {x: sp.prime(k + 5) for k, x in enumerate(everything)}
    jacobian = sp.Matrix([[e.diff(x).subs(point) for x in letters] for e in plain])
    rank = jacobian.rank()
    told: list[str] = []
    for k, letter in enumerate(letters):
        own = sp.zeros(1, len(letters))
        own[k] = 1
        if jacobian.col_join(own).rank() == rank:
            told.append(letter.name)
    return told, [x.name for x in letters if x.name not in told]


def combinations(
    problem: Problem, values: Array, active: NDArray[np.int64], error: Spread
) -> dict[str, Estimate]:
    """Return combinations by name: coefficients of columns that are not a single letter.

    In newton metres if the scale is identified.
    `values` (k,) and `active` (k,) belong to the problem's coefficients, the spread to them and all that
    follow.
    """
    found: dict[str, Estimate] = {}
    where = next((k for k, c in enumerate(problem.coefficients) if c.role == "scale"), None)
    for k, c in enumerate(problem.coefficients):
        if c.role == "offset":
            continue
        slope = np.zeros(len(error.alone))
        slope[k] = 1.0
        if where is not None and k != where:
            s = values[where]
            slope[k], slope[where] = 1.0 / s, -values[k] / s**2
            name = as_text(sp.expand(c.expression / problem.coefficients[where].expression))
            bounds = (0.0 if c.lower == 0.0 else -np.inf, np.inf)
            found[name] = error.estimate(values[k] / s, slope, c.mechanical_unit, bounds, int(active[k]))
        elif not c.meaning.is_Symbol:
            found[c.name] = error.estimate(values[k], slope, c.unit, (c.lower, c.upper), int(active[k]))
    return found


# The fit of a model and of Coulomb + viscous friction, on the same rows.


@dataclass(frozen=True)
class Fit:
    """The result of a fit; `solutions` and held-out `rmse` by model: linear, paper, paper_unbounded.

    `coefficients` are those of the columns, `searched` the nonlinear values (with `profiles` over the ranges
    of unknown quantities), `combinations` coefficients that are not a single letter; `identified` the letters
    that the log identifies, and those that it does not. `spread` is that of coefficients and searched
    values, in this order. `percent` is 100 (1 - paper/linear). `r_squared`
    by model is that of the drive signal on the held-out rows; `band` is that of the error of `paper`.
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

    @property
    def fits_the_rig(self) -> bool:
        """Whether the log can be from this rig, in these units."""
        return self.r_squared["paper"] >= LEAST_R_SQUARED

    @property
    def bounds_active(self) -> list[str]:
        """Names of the coefficients with an active bound."""
        return [name for name, e in self.coefficients.items() if e.bound_active]


def fit(channels: Channels, rig: Rig, model: Model, where: str = "log") -> Fit:
    """Fit a model; `where` names the log in messages.

    Raises InputError for whatever `pose` refuses, too few rows, and columns that are dependent on this log.
    """
    problem = pose(channels, rig, model)
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
    coefficients, searched = _estimates(problem, paper, error)
    problems = {name: baseline if name == "linear" else problem for name in solutions}
    held_out = {name: problems[name].held_out(solution) for name, solution in solutions.items()}
    percent, interval = improvement(held_out["linear"][0], held_out["paper"][0])
    band = _band(problem, paper)
    said = [] if band is None or not band.filtered else [band.warning]
    warnings = [*problem.warnings, *_warnings(problem, paper, profiles), *said]
    return Fit(
        problem,
        solutions,
        coefficients,
        combinations(problem, paper.values, paper.active, error),
        searched,
        profiles,
        identified_letters(problem),
        error,
        {name: rms(error) for name, (error, _) in held_out.items()},
        percent,
        interval,
        {name: r_squared(*pair) for name, pair in held_out.items()},
        band,
        tuple(warnings),
    )


def solved(problem: Problem, where: str, positive: Collection[ColumnRole]) -> Solution:
    """The best solution; `where` opens a message, coefficients of `positive` roles have to be above zero.

    Raises InputError for columns that are dependent on this log, and for a drive that contradicts the motion.
    """
    found = search(problem)
    names = [c.name for c in problem.coefficients]
    with with_doubts(problem.drive.channels.intake.findings):
        require_rank(found.design.columns[problem.rows.train], names, where)
        for c, value in zip(problem.coefficients, found.values, strict=True):
            if c.role in positive and value <= 0.0:
                load = f", and that of {LOAD}" if problem.rig.known.get(LOAD) else ""
                raise InputError(
                    where,
                    f"{c.name} ({c.role} of the drive) above 0",
                    (
                        f"{value:.3g}: do the signs of {problem.drive.channels.motor.measured_by} and"
                        f" angle agree{load}?"
                    ),
                )
    return found


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
    unit = np.eye(len(error.alone))
    coefficients = {
        c.name: error.estimate(paper.values[k], unit[k], c.unit, (c.lower, c.upper), int(paper.active[k]))
        for k, c in enumerate(problem.coefficients)
    }
    searched: dict[str, Estimate] = {}
    for k, s in enumerate(problem.nonlinear, start=len(coefficients)):
        value, ends = paper.at[s.name], (s.lower, s.upper)
        found = error.estimate(value, unit[k], s.unit, ends, s.end_at(value))
        if found.std_error == 0.0:
            # All friction terms that contain it are zero: nothing in the log depends on it.
            found = Estimate(value, s.upper - s.lower, ends, s.unit)
        searched[s.name] = found
    return coefficients, searched


def _warnings(problem: Problem, paper: Solution, profiles: Mapping[str, Profile]) -> list[str]:
    found = []
    friction = [a for c, a in zip(problem.coefficients, paper.active, strict=True) if c.role == "friction"]
    contradicted = any(f.doubts_the_rig for f in problem.drive.channels.intake.findings)
    if all(a == -1 for a in friction) and not contradicted:
        found.append(
            "the fit leaves no friction: do the signs of"
            f" {problem.drive.channels.motor.measured_by} and angle agree?"
        )
    for s in problem.nonlinear:
        value = paper.at[s.name]
        if s.end_at(value):
            found.append(
                f"{s.name} = {value:.4g}{'' if s.unit == '1' else f' {s.unit}'} is at the end of its range"
                f" {s.lower:g} to {s.upper:g}"
            )
    for name, p in profiles.items():
        change = 100.0 * (max(p.rmse) / min(p.rmse) - 1.0)
        found.append(
            f"{name} is known only by a range: over it, the training error changes by {change:.1f} %"
        )
    return found
