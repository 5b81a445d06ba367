"""Temperatures of the drives: of one with an effect as it was simulated, of the others from their losses."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

from .effects import COLD_C, RISE_K, TAU_S
from .scenario import ArmScenario
from .simulation import ArmTrace


def logs_temperature(scenario: ArmScenario) -> bool:
    """Whether the log has a temperature of every drive: if an effect needs it."""
    return any(one.effect.needs_temperature for one in scenario.effects)


def temperatures(scenario: ArmScenario, found: ArmTrace) -> np.ndarray:
    """Temperature of each drive [deg C], shape (rows, joints): half by friction, half by the winding."""
    speed = np.abs(found.w) / scenario.arm.column("mu")
    lost = sum(x / x.mean(axis=0) for x in (np.abs(found.friction) * speed, found.current**2))
    step = 1.0 / (scenario.sample_rate_hz * TAU_S)
    rise = lfilter([0.5 * RISE_K * step], [1.0, step - 1.0], lost, axis=0)
    warm = COLD_C + np.asarray(rise)
    for k, one in enumerate(scenario.effects):
        warm[:, one.joint] = found.temperature[:, k]
    return warm
