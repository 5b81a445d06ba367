"""A coarse log between its rows: the integrands of a window of twelve steps, on a finer grid.

At 40 rows per second a reversal falls between two rows, and the sign of the velocity, summed over rows, is
off by a fraction of a step; so is a load that follows the angle.  The angle between the rows is that of a
quintic spline, as in `filters.motion`; a commanded voltage is held from row to row; other signals are
interpolated linearly.  Nothing is added to the log: windows cover the same time as before, and rows are
counted as logged.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

from eccentric.rigs import Rig
from eccentric.signals.limits import COARSE, POINTS_PER_ROW
from eccentric.signals.stretches import rows_of_each, stretches
from eccentric.signals.table import Table

__all__ = ["is_coarse", "logged_step", "refined"]

Array = NDArray[np.float64]


def logged_step(table: Table) -> float:
    """The usual time between rows [s]."""
    t = table.channels["time"]
    together = np.diff(stretches(t, table.run)) == 0
    return float(np.median(np.diff(t)[together])) if np.any(together) else 0.0


def is_coarse(table: Table, rig: Rig) -> bool:
    """Whether most of the log is too coarse for the rig's low pass, and the rig does not average."""
    return rig.sampling.low_pass_hz * logged_step(table) > COARSE and not rig.sampling.average_over


def refined(table: Table) -> Table:
    """The table, angle unwrapped on the motor side, with more points a row; a stretch ends as it did."""
    t = table.channels["time"]
    parts: list[dict[str, Array]] = []
    source: list[NDArray[np.int64]] = []
    for rows in rows_of_each(stretches(t, table.run)):
        where = np.arange((len(rows) - 1) * POINTS_PER_ROW + 1) / POINTS_PER_ROW
        fine = np.interp(where, np.arange(len(rows)), t[rows])
        before = rows[np.minimum(where.astype(int), len(rows) - 1)]
        source.append(before)
        part = {"time": fine}
        for name, x in table.channels.items():
            if name == "theta_m" and len(rows) > 5:
                part[name] = np.asarray(make_interp_spline(t[rows], x[rows], k=5)(fine))
            elif name == "voltage":
                part[name] = x[before]
            elif name != "time":
                part[name] = np.interp(fine, t[rows], x[rows])
        parts.append(part)
    rows = np.concatenate(source)
    return dataclasses.replace(
        table,
        channels={name: np.concatenate([part[name] for part in parts]) for name in table.channels},
        run=table.run[rows],
        use=table.use[rows],
        motor_off=table.motor_off[rows],
        after_dropped=table.after_dropped[rows],
        after_skipped=table.after_skipped[rows],
    )
