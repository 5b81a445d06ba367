"""The logs of an arm: the channels of every joint, on the same rows and below one low pass.

The motion of all joints loads each of them, so that their angles have to be filtered alike.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError
from eccentric.logs import Log, LogSource, read_log
from eccentric.signals import limits
from eccentric.signals.channels import read_channels
from eccentric.signals.converted import numbers_of, require_columns
from eccentric.signals.measured import Channels
from eccentric.signals.table import of_runs

if TYPE_CHECKING:
    from eccentric.rigs import ArmRig, Rig


def read_joints(logs: Sequence[LogSource], rig: ArmRig) -> tuple[Channels, ...]:
    """Return the channels of every joint, from the base outwards.

    Rows without a number in a column of any joint are left out for all of them. Without a low pass in the
    rig, it is the lowest of those that suit the joints one by one.

    Raises:
        InputError: what `read_channels` refuses, the joint named; columns of fewer or more joints than
            the arm has.
    """
    read, _ = of_runs([read_log(log) for log in logs], rig.joints[0])
    read = [_complete(log, rig) for log in read]
    found = [_of_joint(read, rig, j, one) for j, one in enumerate(rig.joints)]
    common = _common(found)
    if not all(channels.rig.sampling == common for channels in found):
        found = [
            _of_joint(read, rig, j, dataclasses.replace(one, sampling=_own(common, channels)))
            for j, (one, channels) in enumerate(zip(rig.joints, found, strict=True))
        ]
    return tuple(map(_by_one_clock, found))


def _by_one_clock(channels: Channels) -> Channels:
    """What drifts with time or warms goes on from run to run, if the time of the log does."""
    time = channels.time
    if len(time.run_names) < 2 or np.any(np.diff(time.t) <= 0.0):
        return channels
    return dataclasses.replace(channels, time=dataclasses.replace(time, one_clock=True))


def _common(found: Sequence[Channels]):  # noqa: ANN202 - Sampling, which no door names
    """One filter for all joints: the lowest cut-off, the longest average."""
    each = [channels.rig.sampling for channels in found]
    cut = min(sampling.low_pass_hz for sampling in each)
    if any(channels.time.points_per_row > 1 for channels in found):
        cut = min(cut, limits.BELOW_COARSE * limits.COARSE / found[0].time.logged_step_s)
    over = max(sampling.average_over for sampling in each)
    return dataclasses.replace(each[0], low_pass_hz=cut, low_pass_given=True, average_over=over)


def _own(common, channels: Channels):  # noqa: ANN001, ANN202
    threshold = channels.rig.sampling.moving_threshold_rad_s
    return dataclasses.replace(common, moving_threshold_rad_s=threshold)


def _of_joint(logs: Sequence[Log], rig: ArmRig, j: int, one: Rig) -> Channels:
    try:
        return read_channels(logs, one)
    except InputError as error:
        raise error.within(f"joint {rig.number(j)}") from None


def _complete(log: Log, rig: ArmRig) -> Log:
    """The log without the rows in which any joint lacks a number."""
    require_columns(log, rig)
    good = np.ones(log.rows, dtype=bool)
    for one in rig.joints:
        for channel, source in (one.log.columns or {}).items():
            if channel != "run":
                good &= _finite(log, source.text, f"{one.path}: [columns] {channel}")
    lost = int(np.count_nonzero(~good))
    if not lost:
        return log
    of = "rows" if log.excerpt is None else "rows of the windows that are used"
    what = f"no number for some joint in {lost} of {log.rows} {of}"
    if lost > limits.MOST_REJECTED * log.rows:
        raise InputError(
            log.path, problem=f"{what}; at most {100 * limits.MOST_REJECTED:.0f} % may be missing"
        )
    found = log.rows_of(good)
    return dataclasses.replace(found, notes=(*log.notes, f"{what}: such rows are dropped"))


def _finite(log: Log, text: str, where: str) -> NDArray[np.bool_]:
    sizes = np.abs(np.asarray(numbers_of(log, text, where), float)) * np.ones(log.rows)
    good = np.isfinite(sizes)
    damaged = good & (sizes > limits.LARGEST)
    # Many of them are a wrong unit, which the joint that they are of is told.
    return good & ~damaged if np.count_nonzero(damaged) <= limits.MOST_TOO_LARGE * log.rows else good
