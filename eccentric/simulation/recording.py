"""A log as what a simulation is driven by and compared with, and the spans of it that are simulated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from eccentric.rigs import AddedMass
from eccentric.signals import Channels
from eccentric.simulation.limits import EVERY

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Recording:
    """The signals of a log (n,), motor side, SI."""

    t: Array  # time [s]
    segment: Integers  # number of the stretch without gap
    run: Integers  # number of the run
    theta_m: Array  # the smoothed motion, which a simulation starts from
    omega_m: Array
    alpha_m: Array
    measured: Array  # the angle as logged, which it is compared with [rad]
    # signals that drive it or that its friction follows, by name: `signal` (the measured drive, in its
    # own unit), t, and temperature and u where there are any
    inputs: Mapping[str, Array]
    off: Mask  # rows with the motor switched off
    held_out: Mask  # rows of the held-out part
    wanted: Mask  # rows that the rig wants to be used
    carried: tuple[tuple[Mask, AddedMass], ...] = ()  # masses that some runs carry, each with its rows
    # hidden states of its model along the measured motion, by name
    states: Mapping[str, Array] = field(default_factory=dict)
    zero: float = 0.0  # the motor angle of the log that is 0 here [rad]
    by_voltage: bool = False  # whether the measured drive is the armature voltage, u of the model

    @cached_property
    def changes(self) -> dict[str, Array]:
        """The change of each input from its row to the next one (n,)."""
        return {name: np.diff(x, append=x[-1]) for name, x in self.inputs.items()}


def recording_of(channels: Channels) -> Recording:
    """The recording of a log."""
    time, motion, motor = channels.time, channels.motion, channels.motor
    signal = np.where(motor.off, 0.0, motor.measured)
    voltage = signal if motor.measured_by == "voltage" else motor.voltage
    inputs = {"signal": signal, "t": time.elapsed, "u": voltage, "temperature": channels.temperature}
    zero = channels.alignment.theta_zero_rad
    zero = zero / channels.rig.value("mu") if zero else 0.0
    return Recording(
        time.t,
        time.segment,
        time.run,
        motion.theta_m,
        motion.omega_m,
        motion.alpha_m,
        motion.theta_logged - zero,
        {name: x for name, x in inputs.items() if x is not None},
        motor.off,
        channels.selection.held_out,
        wanted=np.ones(len(time.t), bool) if channels.selection.wanted is None else channels.selection.wanted,
        carried=channels.carried,
        zero=zero,
        by_voltage=motor.measured_by == "voltage",
    )


@dataclass(frozen=True)
class Spans:
    """Parts of a log, each from a row on: first row and number of steps (spans,)."""

    start: Integers
    steps: Integers

    def __len__(self) -> int:
        return len(self.start)

    def __add__(self, other: Spans) -> Spans:
        return Spans(np.r_[self.start, other.start], np.r_[self.steps, other.steps])

    def chosen(self, kept: Mask | Integers) -> Spans:
        """Those of a mask (spans,), or in an order."""
        return Spans(self.start[kept], self.steps[kept])

    def inside(self, rows: Mask) -> Spans:
        """Those that lie within chosen rows (n,)."""
        each = zip(self.start.tolist(), self.steps.tolist(), strict=True)
        return self.chosen(np.array([np.all(rows[start : start + steps + 1]) for start, steps in each], bool))


def whole_runs(recording: Recording) -> Spans:
    """Each stretch without gap, from its first row to its last."""
    begins = np.flatnonzero(np.diff(recording.segment, prepend=recording.segment[0] - 1))
    ends = np.r_[begins[1:], len(recording.t)] - 1
    return Spans(begins, ends - begins).chosen(ends > begins)


def windows(recording: Recording, horizon: float, rows: Mask) -> Spans:
    """The windows of a horizon [s] that lie within stretches of chosen rows (n,), one every half of it."""
    label = np.where(rows, recording.segment, -1)
    begins = np.flatnonzero(np.diff(label, prepend=-2))
    ends = np.r_[begins[1:], len(label)] - 1
    start, steps = [], []
    for first, last in zip(begins, ends, strict=True):
        t = recording.t[first : last + 1]
        if label[first] < 0 or len(t) < 2:
            continue
        # A clock rounds: a window is as long as its horizon to half a row.
        late = 0.5 * (t[-1] - t[0]) / (len(t) - 1)
        at = np.arange(t[0], t[-1] - horizon + late, EVERY * horizon)
        one = np.minimum(np.searchsorted(t, at - late), len(t) - 1)
        end = np.searchsorted(t, t[one] + horizon - late)
        kept = (end < len(t)) & (end > one)
        start.append(first + one[kept])
        steps.append((end - one)[kept])
    none = np.zeros(0, np.int64)
    return Spans(np.concatenate([none, *start]), np.concatenate([none, *steps]))
