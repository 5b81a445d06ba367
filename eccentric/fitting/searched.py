"""The nonlinear values of a fit: their ranges, where their search starts, and typical steps."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from eccentric.estimation import Nonlinear
from eccentric.fitting.limits import (
    ANGLE_STEP,
    DELAYS,
    LONGEST_DELAY_S,
    LONGEST_DELAY_STEPS,
    STARTS,
    STEPS_OF_A_RANGE,
)
from eccentric.model import Model, regressor
from eccentric.rigs import KNOWNS

if TYPE_CHECKING:
    from eccentric.rigs import Rig
    from eccentric.signals import Channels

_UNITS = {known.name: known.unit for known in KNOWNS}


def nonlinear_of(channels: Channels, rig: Rig, model: Model, needed: set[str]) -> list[Nonlinear]:
    """Return the nonlinear values: delay and zero angle to estimate, `needed` letters with ranges."""
    step = channels.time.logged_step_s
    turning = any(
        "theta_m" in {x.name for x in model.expand(e).free_symbols}
        for e in (*(c.basis for c in regressor(model)), model.balance("mechanical").sum_of("gravity"))
    )
    found: list[Nonlinear] = []
    if "input_delay_s" in rig.estimate and channels.motor.measured_by == "voltage":
        starts, most = tuple(k * step for k in DELAYS), max(LONGEST_DELAY_S, LONGEST_DELAY_STEPS * step)
        found.append(Nonlinear("input_delay_s", "s", 0.0, most, starts, step))
    if "theta_zero_rad" in rig.estimate and turning:
        found.append(Nonlinear("theta_zero_rad", "rad", -math.pi, math.pi, (0.0,), ANGLE_STEP))
    for letter, (low, high) in rig.unknown.items():
        if letter in needed:
            starts, step = (
                tuple(low + part * (high - low) for part in STARTS),
                (high - low) / STEPS_OF_A_RANGE,
            )
            found.append(Nonlinear(letter, _UNITS[letter], low, high, starts, step))
    return found
