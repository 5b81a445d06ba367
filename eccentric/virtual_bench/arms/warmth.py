"""Temperatures of the drives: of one with an effect as it was simulated, of the others from their losses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.signal import lfilter

from eccentric.virtual_bench.arms.acting import JointEffect
from eccentric.virtual_bench.arms.effects import COLD_C, RISE_K, TAU_S


def logs_temperature(effects: Sequence[JointEffect]) -> bool:
    """Whether the log has a temperature of every drive: if an effect needs it."""
    return any(one.effect.needs_temperature for one in effects)


def warmed(rubbed: np.ndarray, current: np.ndarray, dt: float) -> np.ndarray:
    """Temperature of each drive [deg C], shape (rows, joints): half by friction, half by the winding.

    Args:
        rubbed: power of friction [W], (rows, joints); only its course matters.
        current: [A], likewise.
        dt: from row to row [s].
    """
    lost = rubbed / rubbed.mean(axis=0) + current**2 / np.mean(current**2, axis=0)
    step = dt / TAU_S
    return COLD_C + np.asarray(lfilter([0.5 * RISE_K * step], [1.0, step - 1.0], lost, axis=0))
