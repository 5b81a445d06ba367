"""The history of the friction coefficients along a log, by the emitted estimator."""

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

# Inputs of the estimator from a log.


Array = NDArray[np.float64]

CURRENT = "i"
_CHANNELS = {CURRENT: "current", "u": "voltage", "temperature": "temperature"}
"""Optional signals of a log: input -> channel."""


def inputs_of(channels: Channels, axis: AxisKind, names: Sequence[str], log: str) -> list[Array]:
    """The inputs of these names; unusable rows are NaN, which the estimator skips.

    Raises:
        InputError: as `require_logged`.
    """
    motion, motor = channels.motion, channels.motor
    require_logged(channels, names, log)
    motion_signals = {v.theta_m: motion.theta_m, v.omega_m: motion.omega_m, v.alpha_m: motion.alpha_m}
    known = {
        **{spoken_quantity(axis, q).name: x for q, x in motion_signals.items()},
        "t": channels.time.t,
        **_logged(channels),
    }
    if unknown := [name for name in names if name not in known]:
        raise InputError(
            log, "a model without hidden states", unknown[0], why="to follow friction along a log"
        )
    inputs = [np.array(known[name], float) for name in names]
    unusable = ~channels.selection.usable | motor.off
    return [np.where(unusable, np.nan, x) for x in inputs]


def require_logged(channels: Channels, names: Iterable[str], log: str) -> None:
    """Raise InputError, naming channel and log, unless the log has all inputs.

    A torque replaces the current.

    Args:
        channels: of the log.
        names: of the inputs.
        log: its name.
    """
    logged = _logged(channels)
    by_torque = channels.motor.measured_by == "torque"
    served = {CURRENT} if by_torque else set()
    missing = [name for name in names if name in logged and logged[name] is None and name not in served]
    if missing:
        present = [_CHANNELS[name] for name, x in logged.items() if x is not None]
        present += [channels.rig.axis.named("torque")] if by_torque else []
        wanted = _CHANNELS[missing[0]]
        if missing[0] == CURRENT:
            wanted = f"current or {channels.rig.axis.named('torque')}"
        raise InputError(
            log,
            f"a column for {wanted}",
            f"{' and '.join(present)} only",
            why=f"to follow friction; map it in [columns] of {channels.rig.path}",
        )


def _logged(channels: Channels) -> dict[str, Array | None]:
    """Optional inputs -> signal, None where the log lacks it."""
    motor = channels.motor
    return {CURRENT: motor.current, "u": motor.voltage, "temperature": channels.temperature}


_ENTRIES = 2000
"""Most entries of a history: more than a figure shows."""


@dataclass(frozen=True)
class Replay:
    """The estimator's history along a log of m samples, at k instants.

    Attributes:
        names, units: of the n coefficients.
        t: time [s] (k,), with the runs of the log in sequence.
        values, deviations: of the coefficients (k, n).
        unseen: time since each coefficient's deviation was last below half its prior [s] (k, n).
        start, prior: initial values and standard deviations (n,).
        lowest, highest: bounds of the coefficients (n,).
        alarms: time [s], as in t, and kind, "more" or "less" friction.
        used, still, out_of_range, unusable: numbers of samples; unusable are those that no fit would use.
        step: sampling interval [s].
        noise: standard deviation of the innovations in motion over the assumed one.
        correlation: of successive innovations.
        assumed: standard deviation that the estimator assumes [N m, or N].
        asked: forgetting and false alarms.
        alarm: properties of the alarm, in rows.
        axis: the kind of axis.
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
        """Whether a coefficient's deviation is below half its prior (k, n)."""
        return self.deviations < 0.5 * self.prior


def replayed(
    channels: Channels,
    model: Model,
    fit: Mapping[str, Any],
    asked: Adaptation | None = None,
    log: str = "log",
) -> Replay:
    """Replay a log.

    Args:
        channels: of the log, with delay, zero angle and offset as identified.
        model: with the defaults that the estimator starts from.
        fit: content of the corresponding fit.json, for the prior.
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
    history = estimator.replay(*inputs, state, every=every)
    flags = history["flags"]
    at = np.flatnonzero(flags & (estimator.MORE | estimator.LESS))
    return Replay(
        names=estimator.COEFFICIENTS,
        units=estimator.UNITS,
        t=t[every - 1 :: every],
        values=history["coefficients"],
        deviations=history["deviations"],
        unseen=history["unseen"] * step,
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
    """Increasing time [s] (m,): runs whose time starts again are put in sequence."""
    steps = np.diff(t, prepend=t[0] - step)
    return t + np.cumsum(np.where(steps > 0.0, 0.0, step - steps))
