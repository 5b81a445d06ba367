"""The windows of a long log at the rate that its low pass needs: means of a few rows each.

A log at 1 kHz says no more below 25 Hz than one at 250 Hz, and takes four times the work. A mean over four
rows is a low pass of its own, the same for angle, drive and temperature: at 25 Hz it takes 1.6 % from all of
them alike, and lets less noise through than every fourth row would.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from eccentric.rigs import Rig
from eccentric.signals.limits import LEAST_RATE_HZ, RATE_PER_CUT
from eccentric.signals.stretches import rows_of_each, stretches
from eccentric.signals.table import Table

__all__ = ["rows_a_point", "thinned"]


def rows_a_point(step_s: float, rig: Rig) -> int:
    """How many rows, `step_s` apart, make a point; 1 where the log is no finer than its low pass needs."""
    if step_s <= 0.0:
        return 1
    rate = max(RATE_PER_CUT * rig.sampling.low_pass_hz, LEAST_RATE_HZ)
    return max(1, int(1.0 / (step_s * rate) + 1e-6))


def thinned(table: Table, count: int) -> Table:
    """The table, angle unwrapped on the motor side, as means of `count` rows each within every stretch.

    A point is wanted, and has the motor off, if all of its rows are; the rows left at the end of a stretch
    are dropped.
    """
    firsts = [
        rows[: len(rows) // count * count : count]
        for rows in rows_of_each(stretches(table.channels["time"], table.run))
    ]
    first = np.concatenate(firsts)
    members = first[:, None] + np.arange(count)

    def all_of(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
        return np.asarray(mask[members].all(axis=1), bool)

    # What was skipped or dropped before the rows that are left out here is so before the next point.
    skipped = np.diff(np.cumsum(table.after_skipped)[first], prepend=0) != 0
    dropped = table.after_dropped[members].any(axis=1)
    return dataclasses.replace(
        table,
        channels={name: x[members].mean(axis=1) for name, x in table.channels.items()},
        run=table.run[first],
        use=all_of(table.use) & (all_of(table.motor_off) | all_of(~table.motor_off)),
        motor_off=all_of(table.motor_off),
        after_dropped=dropped,
        after_skipped=skipped,
    )
