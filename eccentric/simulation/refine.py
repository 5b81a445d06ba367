"""Parameters refined on the simulated error of the training runs.

A fit compares torques at the measured motion; here the parameters minimise the error of the motion that they
make.  Errors of a motion that sticks somewhere else are large and rare: the loss is `soft_l1`, quadratic up
to the median error of the start and linear beyond it.  Over a whole run such an error has many minima, so
that windows of half a second come first; where the rig has a controller, whole runs follow from there.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from eccentric.core import InputError
from eccentric.identification import (
    LOAD,
    Fit,
    Problem,
    Solution,
    Spread,
    load_gain,
    posed_for_motion,
    spread,
    with_solution,
)
from eccentric.model import Model
from eccentric.simulation.integrate import integrate
from eccentric.simulation.law import Law
from eccentric.simulation.limits import (
    AT_BOUND,
    CONVERGED,
    LONGEST_STEP_S,
    LOST,
    MOST_EVALUATIONS,
    REFINED_S,
    STEP_PART,
)
from eccentric.simulation.plant import DrivePlant, Servo, complete, driven, servo_of, together
from eccentric.simulation.recording import Recording, Spans, recording_of, whole_runs, windows

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Refined:
    """A fit refined on its simulated error.

    Attributes:
        fit: with the refined values, and their spread.
        before, after: mean absolute error of the motor angle in the training spans [rad].
        held_out: the same of the held-out ones, before and after; None without one.
        spans: number of training spans.
        horizon_s: of the windows; None for whole runs with the controller of the rig.
    """

    fit: Fit
    before: float
    after: float
    held_out: tuple[float, float] | None
    spans: int
    horizon_s: float | None


def refine(found: Fit, model: Model, tell: Callable[[float], None] | None = None) -> Refined:
    """Refine a fit on the simulated error of its training part.

    Args:
        found: the fit that it starts from.
        model: its model, of which friction may follow the current.
        tell: called with the part that is done at most, 0 to 1.

    Raises:
        InputError: the training part has no whole run to simulate with the controller of the rig, and no
            window of half a second without one.
    """
    whole, start = posed_for_motion(found, model)
    task = _Task(whole, start)
    first, size = task.x, 0.0
    x = first
    for k, spans in enumerate(task.stages):
        part = None if tell is None else _counted(tell, k, len(task.stages))
        x, size = task.minimised(x, spans, part)
    refined = with_solution(found, whole, *task.solution(x, size))
    if tell is not None:
        tell(1.0)
    train = task.stages[-1]
    held = (task.mean(first, task.held_out), task.mean(x, task.held_out)) if len(task.held_out) else None
    return Refined(refined, task.mean(first, train), task.mean(x, train), held, len(train), task.horizon_s)


def _counted(tell: Callable[[float], None], stage: int, stages: int) -> Callable[[int], None]:
    """Takes the number of evaluations of a stage to the part that is done at most."""

    def count(number: int) -> None:
        tell((stage + min(number / MOST_EVALUATIONS, 0.99)) / stages)

    return count


class _Task:
    """The simulated errors of a problem as a function of its coefficients and nonlinear values."""

    def __init__(self, problem: Problem, start: Solution) -> None:
        self._problem, self._start = problem, start
        # A delay shifts the signal of a log, and remains as it was found.
        self._named = [s for s in problem.nonlinear if s.name != "input_delay_s"]
        self._aligned = problem.aligned(start.at)
        self._law = Law(problem.model)
        channels = self._aligned.channels
        self._recording = recording_of(channels)
        self._servo = servo_of(channels, self._recording.zero)
        self.horizon_s, self.stages, self.held_out = _spans(self._recording, self._servo, problem.rig.path)
        design = start.design
        self.x = np.concatenate([start.values, [start.at[s.name] for s in self._named]])
        self.lower = np.concatenate([design.lower, [s.lower for s in self._named]])
        self.upper = np.concatenate([design.upper, [s.upper for s in self._named]])
        self.scale = self._scales()

    def _scales(self) -> Array:
        """What each value would be if it made up all of the drive; a typical step of nonlinear values."""
        design = self._start.design
        columns = np.sqrt(np.mean(design.columns[design.train] ** 2, axis=0))
        drive = float(np.sqrt(np.mean(design.target[design.train] ** 2)))
        return np.concatenate([drive / np.maximum(columns, 1e-300), [s.step for s in self._named]])

    def errors(self, sets: Sequence[Array], spans: Spans, step_s: float = LONGEST_STEP_S) -> Array:
        """Simulated minus measured angle (sets, m) [rad], in order of time."""
        plant = together([self._plant(x) for x in sets]) if len(sets) > 1 else self._plant(sets[0])
        found = integrate(plant, self._recording, spans, self._servo, longest_step_s=step_s)
        left = np.nan_to_num(found.errors(self._recording), nan=LOST, posinf=LOST, neginf=-LOST)
        order = np.argsort(found.rows, kind="stable")
        left = np.clip(left, -LOST, LOST)[..., order]
        return np.broadcast_to(left, (len(sets), len(order)))

    def minimised(self, x: Array, spans: Spans, tell: Callable[[int], None] | None) -> tuple[Array, float]:
        """The values that minimise the errors in some spans, from others, and the size of the loss [rad]."""
        count, size = 0, float(np.median(np.abs(self.errors([x], spans)))) or 1e-9

        def errors(x: Array) -> Array:
            nonlocal count
            count += 1
            if tell is not None:
                tell(count)
            return self.errors([x], spans)[0]

        found = least_squares(
            errors,
            np.clip(x, self.lower, self.upper),
            lambda x: self.slopes(x, spans),
            bounds=(self.lower, self.upper),
            x_scale=self.scale,
            loss="soft_l1",
            f_scale=size,
            xtol=CONVERGED,
            ftol=CONVERGED,
            gtol=None,
            max_nfev=MOST_EVALUATIONS,
        ).x
        near = AT_BOUND * self.scale
        found = np.where(found <= self.lower + near, self.lower, found)
        return np.where(found >= self.upper - near, self.upper, found), size

    def mean(self, x: Array, spans: Spans) -> float:
        """The mean absolute error of one set [rad]."""
        return float(np.mean(np.abs(self.errors([x], spans))))

    def slopes(self, x: Array, spans: Spans) -> Array:
        """Slopes (m, k) of the errors in some spans, by differences inside the bounds."""
        step = STEP_PART * self.scale
        step = np.where(x + step > self.upper, -step, step)
        moved = [x + step * unit for unit in np.eye(len(x))]
        here, *there = self.errors([x, *moved], spans)
        return np.column_stack([(one - here) / h for one, h in zip(there, step, strict=True)])

    def solution(self, x: Array, size: float) -> tuple[Solution, Spread]:
        """The values as a solution of the problem, and their spread by the slopes of the simulated motion.

        The spread is that of the weighted squares which the loss is at its minimum, and of the steps in time.
        """
        train = self.stages[-1]
        errors = self.errors([x], train)[0]
        count = len(self._problem.coefficients)
        at = self._at(x)
        active = np.where(x <= self.lower, -1, np.where(x >= self.upper, 1, 0)).astype(np.int64)
        root = np.sqrt(1.0 / np.sqrt(1.0 + (errors / size) ** 2))
        design = self._problem.with_scale_of(x[:count]).design(at)
        slopes = self.slopes(x, train) * root[:, None]
        own = spread(slopes, -errors * root, x, active, self.lower, self.upper)
        # What steps of half the length change is half of what their length adds: an error of unknown sign.
        finer = (self.errors([x], train, 0.5 * LONGEST_STEP_S)[0] - errors) * root
        moved, size_of = np.zeros(len(x)), np.linalg.norm(slopes, axis=0)
        free = (active == 0) & (size_of > 0.0)
        moved[free] = np.linalg.lstsq(slopes[:, free] / size_of[free], finer, rcond=None)[0] / size_of[free]
        own = dataclasses.replace(own, matrix=own.matrix + np.outer(2.0 * moved, 2.0 * moved))
        rows = design.train
        left = (design.target - design.columns @ x[:count])[rows] * np.sqrt(design.weights[rows])
        found = dataclasses.replace(
            self._start, design=design, values=x[:count], active=active[:count], at=at, weighted=left
        )
        return found, self._with_delay(own)

    def _with_delay(self, error: Spread) -> Spread:
        """The spread with a value for a delay, which has not moved."""
        names = [s.name for s in self._problem.nonlinear]
        if "input_delay_s" not in names:
            return error
        place = len(self._problem.coefficients) + names.index("input_delay_s")
        matrix = np.insert(np.insert(error.matrix, place, 0.0, 0), place, 0.0, 1)
        return Spread(matrix, np.insert(error.alone, place, 0.0), np.insert(error.moves, place, 0.0, 1))

    def _at(self, x: Array) -> dict[str, float]:
        own = x[len(self._problem.coefficients) :]
        return {**self._start.at, **{s.name: float(v) for s, v in zip(self._named, own, strict=True)}}

    def _plant(self, x: Array) -> DrivePlant:
        problem = self._problem
        values = x[: len(problem.coefficients)]
        return plant_of_problem(problem, self._law, values, self._at(x), self._start.at)


def plant_of_problem(
    problem: Problem, law: Law, values: Array, at: Mapping[str, float], aligned: Mapping[str, float]
) -> DrivePlant:
    """The plant of coefficients and nonlinear values of a problem, on the log as `aligned` has it."""
    drive, known = problem.drive, problem.values_at(at)
    of = dict(zip(problem.coefficients, map(float, values), strict=True))
    by_role = {c.role: x for c, x in of.items()}
    scale = by_role.get("scale", 1.0)
    parameters = complete(problem.model, known)
    for columns, x in zip(problem.friction, values, strict=False):
        parameters |= {column.parameter.name: float(x) / scale for column in columns}
    machine = drive.machine
    if "inertia" in by_role:
        rest = machine.inertia({**known, machine.rotor: 0.0})
        parameters[machine.rotor] = by_role["inertia"] / scale - rest
    gain, damping = driven(drive, known)
    load = problem.rig.known.get(LOAD, 0.0) + by_role.get("load", 0.0) / scale
    # A load acts whatever makes the drive signal, so it is a torque of its own, not a term of the model.
    parameters |= {LOAD: 0.0} if LOAD in parameters else {}
    moved = at.get("theta_zero_rad", 0.0) - aligned.get("theta_zero_rad", 0.0)
    zero = moved / problem.rig.value("mu") if moved else 0.0
    return DrivePlant(
        law,
        parameters,
        gain / scale,
        damping / scale,
        zero,
        offset=by_role.get("offset", 0.0),
        load=load * load_gain(problem.rig),
    )


def _spans(
    recording: Recording, servo: Servo | None, rig: str
) -> tuple[float | None, tuple[Spans, ...], Spans]:
    """The horizon, the training spans by stage, and the held-out spans."""
    rows = ~recording.held_out & recording.wanted, recording.held_out & recording.wanted
    short = windows(recording, REFINED_S, rows[0])
    if not len(short):
        raise InputError(rig, f"a part of {REFINED_S:g} s without gap to fit on", "none")
    if servo is None:
        return REFINED_S, (short,), windows(recording, REFINED_S, rows[1])
    train, held = (whole_runs(recording).inside(chosen) for chosen in rows)
    if not len(train):
        raise InputError(rig, "a whole run to fit on, for its [controller] to be simulated", "none")
    return None, (short, train), held
