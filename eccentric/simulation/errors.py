"""The error of a simulated motion: fitted models driven by the input of a log, against the measured angle."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from eccentric.identification import LOAD, Drive, Fit, Machine, Refit, fit_data_of, loaded_model
from eccentric.model import Model
from eccentric.rigs import Alignment, Rig
from eccentric.signals import Channels
from eccentric.simulation.integrate import SimulatedMotion, integrate
from eccentric.simulation.limits import HORIZONS_S, TRACES
from eccentric.simulation.plant import DrivePlant, plants_of, servo_of
from eccentric.simulation.recording import Recording, whole_runs, windows

Array = NDArray[np.float64]
Tell = Callable[[float], None]


@dataclass(frozen=True)
class WholeRunErrors:
    """Mean absolute errors of whole runs [rad at the motor].

    Attributes:
        by_run: name of the run -> that of all its rows.
        held_out: names of the runs that are held out as a whole.
    """

    by_run: Mapping[str, float]
    held_out: tuple[str, ...]

    @property
    def mean(self) -> float:
        """The mean over all runs."""
        return float(np.mean([*self.by_run.values()]))

    @property
    def mean_held_out(self) -> float | None:
        """The mean over those held out; None without one."""
        found = [self.by_run[name] for name in self.held_out]
        return float(np.mean(found)) if found else None


@dataclass(frozen=True)
class ModelErrors:
    """The simulated errors of a model.

    Attributes:
        name: of the model.
        horizons: mean absolute error of the angle over the windows of each horizon, None without a window
            [rad at the motor].
        runs: over whole runs, driven by the logged signal; None where not asked for.
        controlled: over whole runs with the controller of the rig; None without one.
    """

    name: str
    horizons: tuple[float | None, ...]
    runs: WholeRunErrors | None = None
    controlled: WholeRunErrors | None = None


@dataclass(frozen=True)
class MotionTrace:
    """A part of the log with the motion of each model (n,): time from its start [s], angles [rad]."""

    run: str
    t: Array
    measured: Array
    simulated: Mapping[str, Array]


@dataclass(frozen=True)
class SimulatedErrors:
    """What simulations of models on a log give.

    Attributes:
        horizons_s: the horizons.
        windows: number of windows of each.
        models: in the order in which they were given.
        traces: of held-out windows, or of whole runs with the controller of the rig.
    """

    horizons_s: tuple[float, ...]
    windows: tuple[int, ...]
    models: tuple[ModelErrors, ...]
    traces: tuple[MotionTrace, ...]

    def ratios(self, one: str, other: str) -> list[float | None]:
        """The errors of a model over those of another, by horizon; None without a window."""
        of = {m.name: m.horizons for m in self.models}
        return [a / b if a is not None and b else None for a, b in zip(of[one], of[other], strict=True)]


def simulated_errors(
    fits: Mapping[str, Refit], *, runs: bool = False, tell: Tell | None = None
) -> SimulatedErrors | None:
    """Simulate fitted models on the held-out part of their log; None for a joint that others load.

    Args:
        fits: models by name, fitted on one log.
        runs: whether whole runs are simulated as well: with the logged signal, and with the controller of the
            rig if it has one.
        tell: called with the part that is done, 0 to 1.
    """
    if any(fit.data.drive.along is not None for fit in fits.values()):
        return None
    # An extended model without an effect is the paper's.
    first = {id(fit): name for name, fit in reversed(list(fits.items()))}
    once = {name: fits[name] for name in fits if first[id(fits[name])] == name}
    channels = next(iter(fits.values())).data.drive.channels
    found = errors_of(plants_of(once), channels, runs=runs, tell=tell)
    by_name = {m.name: m for m in found.models}
    models = tuple(replace(by_name[first[id(fit)]], name=name) for name, fit in fits.items())
    return replace(found, models=models)


def errors_of(
    plants: Mapping[str, tuple[DrivePlant, Recording]],
    channels: Channels,
    *,
    runs: bool = False,
    tell: Tell | None = None,
) -> SimulatedErrors:
    """The same for plants by name, each with its log."""
    models, traced = list[ModelErrors](), dict[str, tuple[Recording, SimulatedMotion]]()
    counts, controlled = tuple[int, ...](), False
    for k, (name, (plant, recording)) in enumerate(plants.items()):

        def of(part: float, k: int = k) -> None:
            if tell is not None:
                tell((k + part) / len(plants))

        rows = recording.held_out & recording.wanted
        each = [windows(recording, horizon, rows) for horizon in HORIZONS_S]
        counts = tuple(map(len, each))
        found = integrate(plant, recording, sum(each[1:], each[0]), None, None if runs else of)
        horizons = _by_group(found, recording, counts)
        traced[name] = recording, found
        whole = with_servo = None
        if runs:
            servo = servo_of(channels, recording.zero)
            spans = whole_runs(recording).inside(recording.wanted)
            found = integrate(plant, recording, spans, None, of)
            whole = _by_run(found, recording, channels)
            if servo is not None:
                found = integrate(plant, recording, spans, servo)
                with_servo, controlled = _by_run(found, recording, channels), True
                traced[name] = recording, found
        models.append(ModelErrors(name, horizons, whole, with_servo))
    if tell is not None:
        tell(1.0)
    traces = _traces(traced, channels, 0 if controlled else sum(counts[:-1]), controlled)
    return SimulatedErrors(HORIZONS_S, counts, tuple(models), traces)


def _by_group(
    found: SimulatedMotion, recording: Recording, counts: Sequence[int]
) -> tuple[float | None, ...]:
    """The mean absolute error of each group of spans, in this order."""
    sizes = np.abs(found.errors(recording))
    ends = np.cumsum([0, *counts])
    group = np.searchsorted(ends, found.span, side="right") - 1
    return tuple(float(np.mean(sizes[group == k])) if n else None for k, n in enumerate(counts))


def _by_run(found: SimulatedMotion, recording: Recording, channels: Channels) -> WholeRunErrors:
    sizes, run = np.abs(found.errors(recording)), recording.run[found.rows]
    names = channels.time.run_names
    present = [k for k in range(len(names)) if np.any(run == k)]
    by_run = {names[k]: float(np.mean(sizes[run == k])) for k in present}
    held = [names[k] for k in present if bool(np.all(recording.held_out[recording.run == k]))]
    return WholeRunErrors(by_run, tuple(held))


def _traces(
    traced: Mapping[str, tuple[Recording, SimulatedMotion]], channels: Channels, first: int, controlled: bool
) -> tuple[MotionTrace, ...]:
    """A few spans for a figure, from the first of those to choose from; of whole runs, the held-out ones."""
    recording, found = next(iter(traced.values()))
    numbers = np.unique(found.span[found.span >= first])
    starts = {int(n): int(found.rows[found.span == n][0]) for n in numbers}
    held = [n for n, row in starts.items() if recording.held_out[row]]
    choose = held if controlled and held else list(starts)
    chosen = [choose[round(x)] for x in np.linspace(0, len(choose) - 1, min(TRACES, len(choose)))]
    traces: list[MotionTrace] = []
    for n in dict.fromkeys(chosen):
        own = {name: x.theta_m[x.span == n] + r.zero for name, (r, x) in traced.items()}
        rows = found.rows[found.span == n]
        t, measured = recording.t[rows], recording.measured[rows] + recording.zero
        run = channels.time.run_names[int(recording.run[rows[0]])]
        traces.append(MotionTrace(run, t, measured, own))
    return tuple(traces)


def is_finite(value: float | None) -> bool:
    """Whether an error is a number: one that diverges is none."""
    return value is not None and math.isfinite(value)


@dataclass(frozen=True)
class Predicted:
    """Measured and predicted drive on the rows (m,) of a log, in the unit of the errors of the fit."""

    t: Array  # time [s] (m,)
    measured: Array  # of a coast-down, what its deceleration gives (m,)
    predicted: Array  # of a coast-down, what friction gives (m,)
    held_out: NDArray[np.bool_]  # rows (m,) that a fit of this log would not use, but be judged by
    used: NDArray[np.bool_]
    """Rows (m,) that are fitted or held out: not those at standstill, next to a reversal, a gap or an end
    of the log, where the low pass has not settled."""

    @property
    def residual(self) -> Array:
        """Measured minus predicted (m,)."""
        return self.measured - self.predicted


@dataclass(frozen=True)
class FittedDrive:
    """What predicts a log: a fitted model with the drive as it was identified."""

    base: Model  # the model that was fitted
    model: Model  # the same extended by effects; often the same one
    rig: Rig  # as the fit has completed it
    alignment: Alignment  # as the fit has found it
    known: Mapping[str, float]  # values of the drive, those that were identified included
    values: Mapping[str, float]  # every parameter of the model, and what the drive requires beside it
    scale: float | None  # of the drive [V/(N m) or A/(N m)]; None where the torque is measured
    factor: float  # what the error of the fit has of its unit for one newton metre
    drive_unit: str  # of torques in the fit, "N m", "V" or "A"
    powered: bool  # whether rows with the motor switched off are left out of the fit

    def along(self, channels: Channels) -> Predicted:
        """The prediction for the channels of a log.

        Raises:
            InputError: the log lacks a signal that the model takes, such as a temperature.
        """
        channels = channels.driven if self.powered else channels
        channels = channels.realigned(channels.rig, self.alignment)
        drive = Drive(Machine(self.base), channels, self.known, self.scale, self.drive_unit)
        data = fit_data_of(drive, channels.rig, self.base)
        values = dict(self.values)
        residuals = data.residuals(self.model, values, values, self.scale)
        measured = data.rows.mean(drive.driven_by(values, self.scale))
        left = residuals.rows("mechanical", values)
        rows = data.rows
        predicted, used = self.factor * (measured - left), rows.train | rows.score
        return Predicted(rows.t, self.factor * measured, predicted, rows.score, used)


def fitted_drive(found: Fit | Refit, parameters: Mapping[str, float] | None = None) -> FittedDrive:
    """What predicts other logs by a fit; `parameters` are those that a `Fit` is emitted with."""
    if isinstance(found, Refit):
        drive, estimates = found.data.drive, found.estimates
        moved = {n: estimates[n].value for n in vars(drive.channels.alignment) if n in estimates}
        return FittedDrive(
            found.data.signals.base or found.model,
            found.model,
            drive.channels.rig,
            replace(drive.channels.alignment, **moved),
            dict(drive.known),
            dict(found.values),
            found.scale,
            1.0,
            drive.unit,
            False,
        )
    problem = found.problem
    drive, rig = problem.drive, problem.rig
    every = {**found.coefficients, **found.searched}
    moved = {name: every[name].value for name in vars(drive.channels.alignment) if name in every}
    values_of = zip(problem.coefficients, found.solutions["paper"].values, strict=True)
    of = {c.role: float(value) for c, value in values_of}
    scale = of.get("scale", 1.0) if problem.scale is not None else 1.0
    searched = {name: e.value for name, e in found.searched.items() if name not in moved}
    values = {**drive.machine.absent, **drive.known, **searched, **(parameters or {})}
    if LOAD in rig.known or LOAD in rig.unknown:
        values[LOAD] = rig.known.get(LOAD, of.get("load", 0.0) / scale)
    # By its back-EMF, where that is known, a drive tells whether friction contains it.
    open_emf = drive.machine.back_emf_letters - set(drive.known) - set(searched)
    model = loaded_model(problem.model, rig)
    return FittedDrive(
        model,
        model,
        rig,
        replace(drive.channels.alignment, **moved),
        {name: value for name, value in values.items() if name not in open_emf},
        values,
        None if drive.scale is None else drive.scale * scale,
        scale,
        "N m" if problem.has("scale") else drive.unit,
        True,
    )
