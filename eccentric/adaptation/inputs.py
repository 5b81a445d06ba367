"""The signals of a log that the estimator takes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from eccentric.errors import InputError
from eccentric.model import AxisKind, spoken_quantity
from eccentric.model import vocabulary as v
from eccentric.signals import Channels

Array = NDArray[np.float64]

CURRENT = "i"
_CHANNELS = {CURRENT: "current", "u": "voltage", "temperature": "temperature"}
"""What a log may lack, by the letter of the input."""


def inputs_of(channels: Channels, axis: AxisKind, names: Sequence[str], log: str) -> list[Array]:
    """The inputs of these names; unusable rows are NaN: the estimator leaves them out.

    Raises:
        InputError: as `require_logged`.
    """
    motion, motor = channels.motion, channels.motor
    require_logged(channels, names, log)
    moved = {v.theta_m: motion.theta_m, v.omega_m: motion.omega_m, v.alpha_m: motion.alpha_m}
    known = {
        **{spoken_quantity(axis, q).name: x for q, x in moved.items()},
        "t": channels.time.t,
        **_logged(channels),
    }
    if unknown := [name for name in names if name not in known]:
        raise InputError(
            f"{log}: a model without hidden states is required to follow friction along a log, received"
            f" {unknown[0]}"
        )
    given = [np.array(known[name], float) for name in names]
    unusable = ~channels.selection.usable | motor.off
    return [np.where(unusable, np.nan, x) for x in given]


def require_logged(channels: Channels, names: Iterable[str], log: str) -> None:
    """Raise InputError, with the channel and the log that lacks it, unless it has all inputs.

    A torque serves for the current.

    Args:
        channels: of the log.
        names: letters of the inputs.
        log: its name.
    """
    found = _logged(channels)
    by_torque = channels.motor.measured_by == "torque"
    served = {CURRENT} if by_torque else set()
    lacking = [name for name in names if name in found and found[name] is None and name not in served]
    if lacking:
        there = [_CHANNELS[name] for name, x in found.items() if x is not None]
        there += ["torque"] if by_torque else []
        wanted = "current or torque" if lacking[0] == CURRENT else _CHANNELS[lacking[0]]
        raise InputError(
            f"{log}: a column for {wanted} is required to follow friction; map it in [columns] of"
            f" {channels.rig.path}, received {' and '.join(there)} only"
        )


def _logged(channels: Channels) -> dict[str, Array | None]:
    """What a log may lack: letter of the input -> signal, None where it does."""
    motor = channels.motor
    return {CURRENT: motor.current, "u": motor.voltage, "temperature": channels.temperature}
