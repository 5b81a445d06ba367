"""Models on the same rows and the same split, each fitted on the training part: their held-out errors.

A model is a derivation, extended or not by effects of the library: "c2_parallel+stribeck[d=1]".
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from eccentric.core import InputError
from eccentric.diagnosis.stage import Stage, stage_of
from eccentric.identification import DRIVE_UNITS, Refit, drive_noise, improvement, r_squared, refit, rms
from eccentric.logs import Log, log_names
from eccentric.model import Model, load_model
from eccentric.rigs import Rig
from eccentric.signals import read_channels

BASELINE = "Coulomb + viscous"


@dataclass(frozen=True)
class Entry:
    """A model on the held-out rows.

    Attributes:
        name: as it was given.
        effects: ids of the effects that extend it.
        rmse: held-out RMSE in the unit of the contest.
        below: the same below the low pass of the angle, None where rows are averages.
        circuit: held-out RMSE of the electrical balance in that unit, None where the log has none and for
            Coulomb + viscous friction, which says nothing about it.
        r_squared: of the drive on the held-out rows.
        parameters: number of values that were estimated from the log.
        percent, interval: gain over Coulomb + viscous friction, with its 95 % interval.
    """

    name: str
    effects: tuple[str, ...]
    rmse: float
    below: float | None
    circuit: float | None
    r_squared: float
    parameters: int
    percent: float
    interval: tuple[float, float]


@dataclass(frozen=True)
class Contest:
    """Entries, best first; `rows` held-out rows; `noise_floor` of the sensors; errors are in `unit`.

    `low_pass_hz` is the cut-off of the low pass of the angle.
    `excerpt` says which windows of a long log these are, "" for one that was read whole. `fits` are the
    fitted models by name, Coulomb + viscous friction first.
    """

    logs: tuple[str, ...]
    rig: str
    unit: str
    rows: int
    holdout: str
    noise_floor: float
    low_pass_hz: float
    entries: tuple[Entry, ...]
    warnings: tuple[str, ...]
    excerpt: str = ""
    fits: Mapping[str, Refit] = field(default_factory=dict, repr=False)


def contest(
    logs: Sequence[Log], rig: Rig, models: Sequence[str | Model], effects: Path | None = None
) -> Contest:
    """Fit models on the training rows of logs and compare them on the held-out rows.

    Raises:
        InputError: bad input; no model, or one twice; a model that `diagnose` does not take; an effect that
            this log does not show.
    """
    names = [model if isinstance(model, str) else model.name for model in models]
    if not names:
        raise InputError("models", "at least one model", "none")
    if twice := [name for k, name in enumerate(names) if name in names[:k]]:
        raise InputError("models", "each model", f"{twice[0]} twice", why="only once")
    channels = read_channels(logs, rig)

    stages: dict[int, Stage] = {}

    def stage(model: Model) -> Stage:
        """The log as a base model sees it; every base model is prepared once."""
        if id(model) not in stages:
            stages[id(model)] = stage_of(read_channels(logs, rig), model, effects, ", ".join(log_names(logs)))
        return stages[id(model)]

    own = stage(load_model(channels.rig.model))
    linear = refit(own.base, (), own.data, linear=True)
    fits = {BASELINE: linear, **{name: _fitted(stage, one) for name, one in zip(names, models, strict=True)}}
    # In volts or amperes, only rows with the motor on.
    rows = own.data.rows.score
    scored = rows if linear.scale is None else rows & ~own.data.off
    target = _in_drive_unit(linear, own.data.rows.mean(own.data.drive.driven_by(linear.values)))[scored]
    before = _residual(linear)[scored]
    entries = [_entry(name, fit, scored, target, before) for name, fit in fits.items()]
    drive = own.data.drive
    return Contest(
        log_names(logs),
        Path(rig.path).name,
        DRIVE_UNITS[channels.motor.measured_by] if linear.scale else drive.unit,
        int(np.count_nonzero(scored)),
        channels.selection.holdout.rule,
        float(_in_drive_unit(linear, np.array([drive_noise(own.data)]))[0]),
        channels.rig.sampling.low_pass_hz,
        tuple(sorted(entries, key=lambda entry: (entry.rmse, entry.circuit or 0.0))),
        (*channels.intake.warnings, *drive.warnings),
        channels.excerpt,
        fits,
    )


def _entry(name: str, fit: Refit, scored: np.ndarray, target: np.ndarray, before: np.ndarray) -> Entry:
    """A fit on the scored rows; target and Coulomb + viscous friction's residual `before` are of these."""
    after = _residual(fit)[scored]
    averaged = fit.data.rows.operator is not None
    return Entry(
        name,
        tuple(effect.id for effect, _ in fit.effects),
        rms(after),
        None if averaged else rms(_in_drive_unit(fit, fit.smooth_residual())[scored]),
        fit.held_out("electrical") if "electrical" in fit.residuals and name != BASELINE else None,
        r_squared(after, target),
        len(fit.estimates),
        *improvement(before, after),
    )


def _fitted(stage_with: Callable[[Model], Stage], model: str | Model) -> Refit:
    """A model, extended by the effects that its name has after a plus sign."""
    name, effects = _parts(model) if isinstance(model, str) else (model, [])
    stage = stage_with(load_model(name) if isinstance(name, str) else name)
    chosen = stage.chosen(f"model {model}", effects) if effects else []
    stage.data.require_rank(stage.base, f"model {model}")
    return refit(stage.base, tuple((effect, shapes) for effect, shapes, _ in chosen), stage.data)


def _parts(name: str) -> tuple[str, list[str]]:
    """The model and the effects of a name; a plus sign in brackets or in a script's path separates none."""
    script, dot, rest = name.partition(".py")
    head, *effects = re.split(r"\+(?![^\[]*\])", rest if dot else name)
    return f"{script}{dot}{head}" if dot else head, effects


def _residual(fit: Refit) -> np.ndarray:
    return _in_drive_unit(fit, fit.residuals["mechanical"])


def _in_drive_unit(fit: Refit, torque: np.ndarray) -> np.ndarray:
    """Models that identify different scales are compared in the unit of the drive."""
    return torque * (fit.scale or 1.0)
