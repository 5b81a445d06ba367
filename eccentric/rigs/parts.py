"""The parts of a rig: what the log holds, how it becomes rows, what is held out, how it is aligned."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields

from eccentric.rigs.sources import ColumnSource

__all__ = ["ALIGNMENT", "Alignment", "LogMap", "NamedHoldout", "Sampling"]


@dataclass(frozen=True)
class LogMap:
    """What the log holds.

    Attributes:
        columns: the source of each channel; None where the standard column names hold.
        drive: what measures the drive torque, "current", "voltage" or "torque"; None: what the log has.
        counts_per_rev: of the encoder of the angle; None where it is not declared.
        sample_rate_hz: as declared; None where it is not.
        runs: names or patterns of the runs that count, empty for all.
    """

    columns: Mapping[str, ColumnSource] | None
    drive: str | None
    counts_per_rev: float | None
    sample_rate_hz: float | None
    runs: tuple[str, ...]


@dataclass(frozen=True)
class Sampling:
    """How samples become rows of a fit.

    Attributes:
        low_pass_hz: cut-off of the low pass of the angle.
        low_pass_given: whether the rig names it.
        moving_threshold_rad_s: speed of the motor from which a row moves; None: as the log suggests.
        average_over: time [s] that both sides of the balance are averaged over before they are compared, 0
            for the rows of the log, infinite for whole runs.
    """

    low_pass_hz: float
    low_pass_given: bool
    moving_threshold_rad_s: float | None
    average_over: float

    @property
    def drive_low_pass_hz(self) -> float | None:
        """Cut-off for the measured drive if rows are averages over a time: both pass the same filter."""
        return self.low_pass_hz if self.average_over and math.isfinite(self.average_over) else None


@dataclass(frozen=True)
class NamedHoldout:
    """The held-out part that the rig names: intervals [s] and names or patterns of runs, empty for none."""

    intervals_s: tuple[tuple[float, float], ...]
    runs: tuple[str, ...]


@dataclass(frozen=True)
class Alignment:
    """What is taken out of voltage and angle.

    Attributes:
        input_delay_s: from the logged voltage to the one that acts.
        theta_zero_rad: the logged link angle at which the mass hangs straight down.
        voltage_offset_V: the logged voltage where none acts.
    """

    input_delay_s: float = 0.0
    theta_zero_rad: float = 0.0
    voltage_offset_V: float = 0.0


ALIGNMENT = tuple(field.name for field in fields(Alignment))
"""The keys of an alignment in a rig file."""
