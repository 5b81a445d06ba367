"""The course of the friction coefficients along a log, by the emitted estimator."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError
from eccentric.emission import Adaptation, executed_beside, load_module, prior_of, render, render_adapt
from eccentric.model import TURNING, AxisKind, Model, spoken_quantity
from eccentric.model import vocabulary as v
from eccentric.signals import Channels

# The signals of a log that the estimator takes.


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
            log, "a model without hidden states", unknown[0], why="to follow friction along a log"
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
        there += [channels.rig.axis.named("torque")] if by_torque else []
        wanted = (
            f"current or {channels.rig.axis.named('torque')}"
            if lacking[0] == CURRENT
            else _CHANNELS[lacking[0]]
        )
        raise InputError(
            log,
            f"a column for {wanted}",
            f"{' and '.join(there)} only",
            why=f"to follow friction; map it in [columns] of {channels.rig.path}",
        )


def _logged(channels: Channels) -> dict[str, Array | None]:
    """What a log may lack: letter of the input -> signal, None where it does."""
    motor = channels.motor
    return {CURRENT: motor.current, "u": motor.voltage, "temperature": channels.temperature}


_ENTRIES = 2000
"""Entries of a course at most: more than a figure shows."""


@dataclass(frozen=True)
class Replay:
    """What the estimator learned along a log of m samples, at k instants.

    Attributes:
        names, units: of the n coefficients.
        t: time [s] (k,); where that of the log begins anew, its runs follow one another.
        values, deviations: of the coefficients (k, n).
        unseen: seconds since each coefficient was last known to half of its prior (k, n).
        start, prior: values and standard deviations that the estimator began with (n,).
        lowest, highest: bounds that it keeps the coefficients within (n,).
        alarms: time [s], as in t, and kind, "more" or "less" friction.
        used, still, out_of_range, unusable: numbers of samples; unusable are those that no fit would use.
        step: seconds between two samples.
        noise: standard deviation of the innovations in motion over the assumed one.
        correlation: of two innovations in a row.
        assumed: standard deviation that the estimator assumes [N m, or N].
        asked: forgetting and false alarms.
        alarm: what is known of the alarm, in rows.
        axis: what moves.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    t: Array
    values: Array
    deviations: Array
    unseen: Array
    start: Array
    prior: Array
    lowest: Array
    highest: Array
    alarms: tuple[tuple[float, str], ...]
    used: int
    still: int
    out_of_range: int
    unusable: int
    step: float
    noise: float
    correlation: float
    assumed: float
    asked: Adaptation
    alarm: Mapping[str, float]
    axis: AxisKind = TURNING

    @property
    def seen(self) -> NDArray[np.bool_]:
        """Whether a coefficient is known to half of its prior by what was learned (k, n)."""
        return self.deviations < 0.5 * self.prior


def replayed(
    channels: Channels,
    model: Model,
    fit: Mapping[str, Any],
    asked: Adaptation | None = None,
    log: str = "log",
) -> Replay:
    """The course along a log.

    Args:
        channels: of the log, with delay, zero angle and offset as identified.
        model: with the defaults that the estimator starts from.
        fit: content of the fit.json of these, for the prior.
        asked: forgetting and false alarms.
        log: its name, for messages.

    Raises:
        InputError: the model depends on a signal that the log lacks.
    """
    asked = asked or Adaptation()
    prior = prior_of(model, fit)
    files = render(model)
    source = render_adapt(model, files, prior, asked)[f"{model.name}_adapt.py"]
    estimator = executed_beside(load_module(model), model.name, source)
    inputs = inputs_of(channels, model.axis, estimator.INPUTS, log)
    state = estimator.init()
    unusable = np.any(np.isnan(inputs), axis=0)
    step = float(np.median(np.diff(channels.time.t)))
    t = _elapsed(channels.time.t, step)
    every = max(1, -(-len(t) // _ENTRIES))
    found = estimator.replay(*inputs, state, every=every)
    flags = found["flags"]
    at = np.flatnonzero(flags & (estimator.MORE | estimator.LESS))
    return Replay(
        names=estimator.COEFFICIENTS,
        units=estimator.UNITS,
        t=t[every - 1 :: every],
        values=found["coefficients"],
        deviations=found["deviations"],
        unseen=found["unseen"] * step,
        start=prior.values,
        prior=prior.deviations,
        lowest=prior.lowest,
        highest=prior.highest,
        alarms=tuple((float(t[k]), "more" if flags[k] & estimator.MORE else "less") for k in at),
        used=int(np.count_nonzero(flags & estimator.UPDATED)),
        still=int(np.count_nonzero(flags & estimator.STILL)),
        out_of_range=int(np.count_nonzero((flags & estimator.RANGE > 0) & ~unusable)),
        unusable=int(np.count_nonzero(unusable)),
        step=step,
        noise=float(state.square) ** 0.5,
        correlation=float(state.rho),
        assumed=prior.noise,
        asked=asked,
        alarm=estimator.ALARM,
        axis=model.axis,
    )


def _elapsed(t: Array, step: float) -> Array:
    """The time [s] (m,), with runs one after another whose own begins anew: within a run it increases."""
    passed = np.diff(t, prepend=t[0] - step)
    return t + np.cumsum(np.where(passed > 0.0, 0.0, step - passed))
