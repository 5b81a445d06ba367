"""Held-out errors of the three models, before and after, and the confidence in the difference."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from eccentric.diagnosis.limits import FEWEST_RUNS
from eccentric.effects import Effect
from eccentric.identification import FitData, Refit, improvement, improvement_over_runs, refit, rms
from eccentric.model import Model

Array = np.ndarray


@dataclass(frozen=True)
class OverRuns:
    """Every run left out of the fit once and predicted; effects and their shapes stay fixed.

    rmse: model -> RMSE over all runs, as in `Score.rmse`; gains: "paper" over linear, "extended" over paper
    -> percent, 95 % interval by drawing whole runs, and how many of the `runs` improve; below: percent and
    interval of "extended" below the low pass, None as in `Score.below`.
    """

    rmse: Mapping[str, float]
    gains: Mapping[str, tuple[float, tuple[float, float], int]]
    runs: int
    below: tuple[float, tuple[float, float]] | None = None


@dataclass(frozen=True)
class BelowLowPass:
    """The held-out error below the low pass of the angle: RMSE of the paper's and the extended model.

    `percent` and `interval` are the gain. Row by row, a model of a ripple above the cut-off only adds error:
    the acceleration that it causes is not in the motion any more.
    """

    cut_hz: float
    before: float
    after: float
    percent: float
    interval: tuple[float, float]


@dataclass(frozen=True)
class Score:
    """What the held-out part says.

    rmse: balance -> model -> held-out RMSE [N m, or the unit of the drive]; per_drive: the same of the
    mechanical balance in the unit of the drive while the motor is on, if the torque is not measured;
    free: held-out RMSE [N m] while the motor is off; `percent` and `interval` are those of `balance`;
    below: the same below the low pass, None where rows are averages or nothing was adopted.
    """

    rmse: Mapping[str, Mapping[str, float]]
    per_drive: Mapping[str, float]
    free: Mapping[str, float]
    balance: str
    percent: float
    interval: tuple[float, float]
    over_runs: OverRuns | None
    below: BelowLowPass | None = None

    @property
    def confirms(self) -> bool:
        """Whether the extended model predicts better held out, and run by run.

        It may do so clearly below the low pass instead, since row by row a model of faster ripple adds error,
        and must not be clearly worse there.
        """
        over = self.over_runs
        if over is not None:
            best = max(over.gains["extended"][1][0], -math.inf if over.below is None else over.below[1][0])
            if best <= 0.0:
                return False
        if self.below is not None and self.below.interval[1] < 0.0:
            return False
        return self.percent > 0.0 or self.only_below

    @property
    def only_below(self) -> bool:
        """Whether the gain is clear below the low pass, and not row by row."""
        return only_below(self.interval, self.below)


def only_below(interval: tuple[float, float], below: BelowLowPass | None) -> bool:
    """Whether a gain is clear below the low pass, and row by row, with this `interval`, it is not."""
    return below is not None and interval[0] <= 0.0 < below.interval[0]


def score(linear: Refit, paper: Refit, extended: Refit, balance: str, over_runs: OverRuns | None) -> Score:
    """Open the held-out part.

    Models that identify different scales are compared at the scale of the extended one: their errors are
    first in volts (or amperes).
    """
    models = {"linear": linear, "paper": paper, "extended": extended}
    rows, off = paper.data.rows, paper.data.off
    rmse: dict[str, dict[str, float]] = {
        "mechanical": {n: rms(m.residual_like(extended)[rows.score]) for n, m in models.items()}
    }
    if "electrical" in paper.residuals:
        rmse["electrical"] = {n: m.held_out("electrical") for n, m in models.items() if n != "linear"}
    free: dict[str, float] = {}
    if np.any(off & rows.score):
        free = {n: rms(m.residuals["mechanical"][off & rows.score]) for n, m in models.items()}
    before, after = (m.residual_like(extended, balance)[rows.score] for m in (paper, extended))
    percent, interval = improvement(before, after) if extended is not paper else (0.0, (0.0, 0.0))
    scaled = paper.scale is not None
    # A motor that is off has no voltage or current to be predicted: these rows are in `free`.
    on = rows.score & ~off
    per_drive = {n: rms(m.residuals["mechanical"][on]) * (m.scale or 1.0) for n, m in models.items()}
    per_drive = per_drive if scaled and np.any(on) else {}
    return Score(
        rmse, per_drive, free, balance, percent, interval, over_runs, below_low_pass(paper, extended, balance)
    )


def below_low_pass(paper: Refit, extended: Refit, balance: str) -> BelowLowPass | None:
    """The gain below the low pass; None where rows are averages or nothing was adopted."""
    rows, rig = paper.data.rows, paper.data.drive.channels.rig
    if rows.operator is not None or extended is paper:
        return None
    before, after = (m.residual_like(extended, balance, smooth=True)[rows.score] for m in (paper, extended))
    return BelowLowPass(rig.sampling.low_pass_hz, rms(before), rms(after), *improvement(before, after))


def leave_runs_out(base: Model, extended: Refit, data: FitData, bounds: bool = True) -> OverRuns | None:
    """Predict each run from all others; None with fewer than five runs, or if two balances are fitted.

    `bounds` are those of the models without effects.
    """
    rows = data.rows
    used = rows.train | rows.score
    runs = np.unique(rows.run[used])
    if len(runs) < FEWEST_RUNS or data.drive.measured_twice:
        return None
    shapes = tuple(
        (e, {s.quantity.name: own[s.quantity.name] for s in e.shapes}) for e, own in extended.effects
    )
    models: dict[str, tuple[tuple[tuple[Effect, dict[str, float]], ...], dict[str, bool]]]
    models = {"linear": ((), {"bounds": bounds, "linear": True}), "paper": ((), {"bounds": bounds})}
    if shapes:
        models["extended"] = (shapes, {})
    squares, smooth = ({name: np.zeros(len(runs)) for name in models} for _ in range(2))
    for k, run in enumerate(runs):
        own = used & (rows.run == run)
        for name, (effects, options) in models.items():
            found = refit(base, effects, data, without=int(run), **options)
            squares[name][k] = float(np.sum(found.residual_like(extended)[own] ** 2))
            smooth[name][k] = float(np.sum(found.residual_like(extended, smooth=True)[own] ** 2))
    gains = {
        after: (
            *improvement_over_runs(squares[before], squares[after]),
            int(np.count_nonzero(squares[after] < squares[before])),
        )
        for before, after in (("linear", "paper"), ("paper", "extended"))
        if after in squares
    }
    count = int(np.count_nonzero(used))
    rmse = {n: float(np.sqrt(s.sum() / count)) for n, s in squares.items()}
    below = None
    if shapes and rows.operator is None:
        below = improvement_over_runs(smooth["paper"], smooth["extended"])
    return OverRuns(rmse, gains, len(runs), below)
