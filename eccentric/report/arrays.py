"""What the figures are drawn from: residuals of a balance on its rows, and channels beside them.

An array may hold NaN; where a log has no such signal, the field is None or the channel is not in the list.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

__all__ = ["BalanceResiduals", "Channel", "Rows"]

Array = np.ndarray


@dataclass(frozen=True)
class Channel:
    """A signal that residuals are drawn over.

    Attributes:
        key: as in `residual_depends_on`: velocity, link_angle, motor_angle, acceleration, gravity_load,
            current, voltage, temperature, time. "velocity" also says which way friction acts.
        label: for an axis, without unit: "motor velocity".
        unit: of the values.
        values: (n,), an angle unwrapped or not.
        period: what an angle is wrapped to (2 pi for one turn); None for anything else.
    """

    key: str
    label: str
    unit: str
    values: Array
    period: float | None = None


@dataclass(frozen=True)
class Rows:
    """What the n rows (or windows) of a balance have in common.

    Attributes:
        t: (n,) logged time [s]; starts anew with each run.
        run: (n,) number of the run, an index of `run_names`.
        run_names: names of the runs (or logs).
        train: (n,) bool, rows that were fitted.
        held_out: (n,) bool, rows that the held-out error is taken on. What is in neither is not drawn.
        channels: the signals that are there.
        description: what a row is: "rows of the log", "averages over 0.2 s", "whole runs".
    """

    t: Array
    run: Array
    run_names: tuple[str, ...]
    train: Array
    held_out: Array
    channels: tuple[Channel, ...]
    description: str = "rows of the log"

    def channel(self, key: str) -> Channel | None:
        """The channel of that key, None if it is not there."""
        return next((channel for channel in self.channels if channel.key == key), None)


@dataclass(frozen=True)
class BalanceResiduals:
    """A balance and how well each model holds it.

    Attributes:
        name: "mechanical" or "electrical".
        quantity: what `measured` is, for an axis, without unit: "friction".
        unit: of all arrays and errors here: "N m" or "V".
        rows: what the arrays are over.
        paper: (n,) residual of the paper's model.
        extended: (n,) residual of the extended model; None if nothing was adopted.
        linear: (n,) residual of Coulomb and viscous friction; None if there is no such comparison.
        measured: (n,) the measured friction, so that a model's prediction is `measured` - its residual; None
            where the balance has no friction in it.
        rmse: model ("linear", "paper", "extended") -> held-out RMSE, as in diagnosis.json.
        noise_floor: RMS of the sensors' own noise in it; None if unknown.
    """

    name: str
    quantity: str
    unit: str
    rows: Rows
    paper: Array
    extended: Array | None
    linear: Array | None
    measured: Array | None
    rmse: Mapping[str, float]
    noise_floor: float | None = None
