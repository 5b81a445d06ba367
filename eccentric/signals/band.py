"""Over which band a held-out error is taken: below the low pass of the angle, or above it.

A model knows the motion below the cut-off only; the drive is compared as it was logged. What is left above is
the noise of the sensors, or a motion that the low pass has taken from one side of the balance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.signals.limits import FILTERED
from eccentric.signals.measured import Channels
from eccentric.signals.rows import Rows

__all__ = ["Band", "band_of"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Band:
    """A held-out RMSE below and above the cut-off [Hz], and the sensors' noise above it, in one unit."""

    cut_hz: float
    below: float
    above: float
    noise: float

    @property
    def filtered(self) -> bool:
        """Whether most of the error lies above the low pass, and is not noise."""
        return self.above > max(self.below, FILTERED * self.noise)

    def words(self, model: str) -> str:
        """What a model leaves of the motion that it knows."""
        return f"below the {self.cut_hz:g} Hz low pass of the angle, {model} leaves {self.below:.4g}"

    @property
    def warning(self) -> str:
        """What to do about it; "" where nothing is wrong."""
        if not self.filtered:
            return ""
        return (
            f"most of the held-out error lies above {self.cut_hz:g} Hz, which the model cannot see: motion"
            " that the low pass has removed (a higher low_pass_hz shows it), or ripple of the drive"
            " (average_over takes it from both sides)"
        )


def band_of(residual: Array, moving: Array, rows: Rows, channels: Channels, noise: float) -> Band | None:
    """The parts of a held-out residual; None where rows are averages.

    residual (n,) on all rows, moving (n,), what accelerates the drive; noise: RMS of the white noise of the
    drive in a row; all in the unit of the residual.
    """
    if rows.operator is not None or not np.any(rows.score):
        return None
    held_out = np.flatnonzero(rows.score)
    below = float(np.sqrt(np.mean(channels.smooth_residual(residual, moving)[held_out] ** 2)))
    whole = float(np.sqrt(np.mean(residual[held_out] ** 2)))
    impulse = np.zeros(len(residual))
    impulse[held_out[len(held_out) // 2]] = 1.0
    passed = min(float(np.linalg.norm(channels.smooth(impulse))), 1.0)
    cut = channels.rig.sampling.low_pass_hz
    return Band(
        cut, below, float(np.sqrt(max(whole**2 - below**2, 0.0))), noise * float(np.sqrt(1.0 - passed**2))
    )
