"""What a diagnosis found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from eccentric.diagnosis.orders import Order
from eccentric.diagnosis.score import Score
from eccentric.effects import Effect, Setting
from eccentric.fitting import FitData, Refit
from eccentric.model import Model
from eccentric.rigs import Rig
from eccentric.search import Attribution
from eccentric.signals import Channels, Finding, Rows

__all__ = ["Diagnosis"]


@dataclass(frozen=True)
class Diagnosis:
    """What a diagnosis found.

    Attributes:
        logs, rig_name: file names; model: name or path of the base model.
        base: the paper's model; its fit is `paper`.
        setting: what the library of effects was made for.
        own: effects of the user's own file, if any.
        data: drive, signals and rows that models were fitted on.
        attribution: verdict, candidates, dependence.
        effects: adopted effects with their parameters, in order of adoption; empty without a name.
        linear, paper, extended: fits on the training part; `extended` is `paper` if nothing was adopted.
        shipped: what is emitted: `extended`, or without an effect the paper's model within its bounds.
        score: held-out errors and the improvement.
        refused: those of effects that the held-out part did not confirm, if any were adopted before.
        noise_floor: RMS of the sensors' noise in the mechanical balance, in its unit.
        r_squared: of the drive torque, on the training part, under the paper's model.
        orders: what the residual of the shipped model is periodic in while the motor turns one way.
    """

    logs: tuple[str, ...]
    rig_name: str
    model: str
    channels: Channels
    rig: Rig
    base: Model
    setting: Setting
    own: Path | None
    data: FitData
    attribution: Attribution
    effects: tuple[tuple[Effect, dict[str, float]], ...]
    linear: Refit
    paper: Refit
    extended: Refit
    shipped: Refit
    score: Score
    refused: Score | None
    noise_floor: float
    r_squared: float
    orders: tuple[Order, ...]

    @property
    def rmse(self) -> Mapping[str, Mapping[str, float]]:
        """Balance -> model ("linear", "paper", "extended") -> held-out RMSE in `unit`."""
        return self.score.rmse

    @property
    def balance(self) -> str:
        """The balance that the improvement is one of."""
        return self.score.balance

    @property
    def percent(self) -> float:
        """Improvement of the held-out RMSE, 100 (1 - extended/paper)."""
        return self.score.percent

    @property
    def interval(self) -> tuple[float, float]:
        """Its 95 % interval."""
        return self.score.interval

    @property
    def quality(self) -> tuple[Finding, ...]:
        """What is odd about the record."""
        return self.channels.findings

    @property
    def unsettled(self) -> tuple[str, ...]:
        """Those of the models whose fit was stopped before it had settled."""
        fits = {
            "linear": self.linear,
            "paper": self.paper,
            "extended": self.extended,
            "shipped": self.shipped,
        }
        return tuple(name for name, fit in fits.items() if not fit.settled)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Of the reader, of the first fit, and of fits that have not settled."""
        said = (*self.channels.warnings, *self.data.drive.warnings)
        if not self.unsettled:
            return said
        models = f"model{'s' * (len(self.unsettled) > 1)} {', '.join(self.unsettled)}"
        return (*said, f"the fit of the {models} has not settled: its values and errors are not final")

    @property
    def rows(self) -> Rows:
        """The rows that errors are reported on."""
        return self.data.rows

    @property
    def unit(self) -> str:
        """Unit of torques: "N m", or that of the drive where nothing tells the scale."""
        return self.data.drive.unit
