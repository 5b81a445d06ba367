"""The data of the figures: residuals of a balance on its rows, and the channels they are drawn over.

An array may hold NaN; if a log has no such signal, the field is None or the channel is not in the list.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

__all__ = ["BalanceResiduals", "Channel", "DriveSignal", "ResidualRows"]

Array = np.ndarray


@dataclass(frozen=True)
class Channel:
    """A signal on the horizontal axis of a residual plot.

    Attributes:
        key: as in `residual_depends_on`: velocity, link_angle, motor_angle, acceleration, gravity_load,
            current, voltage, temperature, time. "velocity" also says which way friction acts.
        label: for an axis, without unit: "motor velocity".
        unit: of the values.
        values: (n,), an angle unwrapped or not.
        period: of an angle that is wrapped (2 pi for one turn); None for anything else.
    """

    key: str
    label: str
    unit: str
    values: Array
    period: float | None = None


@dataclass(frozen=True)
class ResidualRows:
    """The n rows (or windows) that all arrays of a balance share.

    Attributes:
        t: (n,) logged time [s]; restarts with each run.
        run: (n,) number of the run, an index of `run_names`.
        run_names: names of the runs (or logs).
        train: (n,) bool, rows that were fitted.
        held_out: (n,) bool, rows of the held-out error. Rows that are in neither are not drawn.
        channels: the available signals.
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
        """The channel with this key, None if there is none."""
        return next((channel for channel in self.channels if channel.key == key), None)


@dataclass(frozen=True)
class DriveSignal:
    """What drives the motor, on the rows of a balance.

    Attributes:
        label: "current", "voltage", "torque", without unit.
        unit: of the values.
        values: (n,) as measured; a model gives `values` - `gain` * its residual.
        gain: units of the drive for one of the balance.
    """

    label: str
    unit: str
    values: Array
    gain: float


@dataclass(frozen=True)
class BalanceResiduals:
    """A balance and how well each model satisfies it.

    Attributes:
        name: "mechanical" or "electrical".
        quantity: name of `measured` for an axis, without unit: "friction".
        unit: of all arrays and errors here: "N m" or "V".
        rows: those of the arrays.
        paper: (n,) residual of the paper's model.
        extended: (n,) residual of the extended model; None if nothing was adopted.
        linear: (n,) residual of Coulomb and viscous friction; None if there is no such comparison.
        measured: (n,) the measured friction, so that a model's prediction is `measured` - its residual; None
            if the balance contains no friction.
        rmse: model ("linear", "paper", "extended") -> held-out RMSE, as in diagnosis.json.
        noise_floor: RMS of the sensors' noise in this balance; None if unknown.
        drive: what the balance is about as the log has it; None for another balance than the mechanical.
    """

    name: str
    quantity: str
    unit: str
    rows: ResidualRows
    paper: Array
    extended: Array | None
    linear: Array | None
    measured: Array | None
    rmse: Mapping[str, float]
    noise_floor: float | None = None
    drive: DriveSignal | None = None
