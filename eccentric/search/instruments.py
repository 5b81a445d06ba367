"""Signals whose noise is not that of the target: slow motion, and what the model makes of it.

The measured current stands on one side of a balance and inside candidates on the other; noise of the angle
passes through the speed loop into voltage and current. What such a candidate gains in a search may be the
noise of its own signals. Its instrument is the same candidate without that noise: on the speed below the
frequency where the motion ends, and the current and voltage that the fitted model needs for it. An effect
that is there shows in both; noise that comes back through the loop in one.

The angle is that of the fit. Its noise is a small part of a turn, and changes a column over the angle with a
sign that alternates within its period, so that it averages out against the target's; a slower angle would
lose the phase of ripples.

Reference: A. Janot, P.-O. Vandanjon, M. Gautier, "A generic instrumental variable approach for industrial
robot identification", IEEE Trans. Control Systems Technology 22(1), 2014.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from eccentric.estimation import ColumnRole
from eccentric.fitting import FitData, Signals, base_columns, load_torque
from eccentric.model import Model
from eccentric.search.limits import LEAST_MOTION, LOWEST_BAND_HZ
from eccentric.signals import motion_of

__all__ = ["instruments_of"]

Array = np.ndarray


def instruments_of(data: FitData, model: Model, friction: Array) -> Signals | None:
    """The signals of a log from its motion alone; None where its rows average all noise away.

    friction: (columns,) coefficients of a first fit of the base model, in SI units.
    """
    channels, signals = data.drive.channels, data.signals
    motion = None if data.rows.independent else _slow_motion(data)
    if motion is None:
        return None
    cut, motion = motion
    along = None if data.drive.along is None else data.drive.along.narrowed(cut)
    values = {**signals.values, **motion, **({} if along is None else along.signals)}
    # What the rig leaves open follows the same motion: an open inertia would bring the noise back.
    slowly: dict[ColumnRole, Array] = {
        "inertia": motion["alpha_m"],
        "back_emf": np.where(data.drive.off, 0.0, motion["omega_m"]),
    }
    free = {c: slowly.get(c.role, column) for c, column in signals.open.items()}
    free |= {} if along is None else dict(along.open)
    slow = replace(signals, values=values, open=free)
    torque = channels.smooth(load_torque(model, slow) + base_columns(model, slow) @ friction)
    values["i"] = data.drive.machine.current_of_torque(signals.known, torque)
    if "u" in values:
        values["u"] = data.drive.machine.voltage(signals.known, values["i"], values["omega_m"])
    return replace(signals, values=values, open=free)


def _slow_motion(data: FitData) -> tuple[float, dict[str, Array]] | None:
    """The least frequency [Hz] that holds the motion; speed and acceleration (samples,) below it."""
    channels = data.drive.channels
    rows, speed = channels.selection.fit_rows, channels.motion.omega_m
    cut = LOWEST_BAND_HZ
    while cut < channels.rig.sampling.low_pass_hz:
        found, _ = motion_of(channels.time.t, channels.motion.theta_m, channels.time.segment, cut)
        missed = np.sum((found[1] - speed)[rows] ** 2) / np.sum(speed[rows] ** 2)
        if missed < 1.0 - LEAST_MOTION:
            return cut, {"omega_m": found[1], "alpha_m": found[2]}
        cut *= 2.0
    return None
