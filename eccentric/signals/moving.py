"""Which rows move, and which are unaffected by filters at the ends of a stretch or at a switched motor."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eccentric.signals import filters
from eccentric.signals.limits import HALF_SPAN_S, QUANTA, SLOW, SWITCHING_S
from eccentric.signals.stretches import joined

if TYPE_CHECKING:
    from eccentric.rigs import Rig

__all__ = ["clear_of_ends", "moving_rows", "near_switching"]

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]


def moving_rows(
    t: Array, theta: Array, segment: Integers, rig: Rig, quantum: float, fitted: Mask
) -> tuple[Mask, float]:
    """Return the moving rows (n,), and the threshold [rad/s]: from the rig or from the rows `fitted`."""
    velocity = joined(segment, lambda rows: filters.span_velocity(t[rows], theta[rows]))
    threshold = rig.sampling.moving_threshold_rad_s
    if threshold is None:
        threshold = _default_threshold(velocity[fitted], quantum)
    moves = joined(segment, lambda rows: filters.moves(t[rows], velocity[rows], threshold))
    return moves.astype(bool), threshold


def _default_threshold(velocity: Array, quantum: float) -> float:
    speeds = np.abs(velocity[np.isfinite(velocity)])
    slow = SLOW * float(np.percentile(speeds, 95.0)) if len(speeds) else 0.0
    return max(QUANTA * quantum / (2.0 * HALF_SPAN_S), slow)


def clear_of_ends(t: Array, segment: Integers) -> Mask:
    """Rows (n,) at least half a second from the ends of every stretch, where filters have transients."""
    return joined(segment, lambda rows: filters.away_from_ends(t[rows]))


def near_switching(t: Array, segment: Integers, off: Mask) -> Mask:
    """Rows (n,) near switching the motor, where filters mix driven and free motion."""
    near = np.zeros(len(t), dtype=bool)
    for row in np.flatnonzero(np.diff(off.astype(int)) & (np.diff(segment) == 0)):
        near |= (np.abs(t - t[row]) < SWITCHING_S) & (segment == segment[row])
    return near
