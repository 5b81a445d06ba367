"""Many spans of a log and many parameter sets integrated at once.

    theta_h = theta + dt/2 w      w' = Moreau's step, torques at theta_h      theta' = theta_h + dt/2 w'

The torques are those of the velocity that the acceleration before the step gives for its middle, so that
where nothing sticks this is of second order in dt; a drive at rest stays exactly where it is.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from eccentric.simulation.law import SCALAR, LawAt, step
from eccentric.simulation.limits import FEW_SPANS, LONGEST_STEP_S
from eccentric.simulation.plant import DrivePlant
from eccentric.simulation.recording import Recording, Spans

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


class Feedback(Protocol):
    """What makes the drive signal in a simulation, in place of the logged one."""

    def signal(self, rows: Integers, part: float, theta_m: Array, omega_m: Array) -> Array:
        """The drive signal (..., spans) at a part of the way from rows (spans,) of the log to the next."""
        ...


@dataclass(frozen=True)
class SimulatedMotion:
    """Simulated angles, span after span.

    Attributes:
        rows: rows of the log (m,).
        span: number of the span of each (m,).
        theta_m: angle of the motor as the log has it [rad] (..., m), of each parameter set.
    """

    rows: Integers
    span: Integers
    theta_m: Array

    def errors(self, recording: Recording) -> Array:
        """Simulated minus measured angle (..., m) [rad]."""
        return self.theta_m - recording.measured[self.rows]


def integrate(
    plant: DrivePlant,
    recording: Recording,
    spans: Spans,
    feedback: Feedback | None = None,
    tell: Callable[[float], None] | None = None,
    longest_step_s: float = LONGEST_STEP_S,
) -> SimulatedMotion:
    """Simulate spans of a log from their smoothed states.

    Args:
        plant: one parameter set, or several.
        recording: the log.
        spans: w parts of it.
        feedback: what makes the drive signal; None for the logged one.
        tell: called with the part that is done, 0 to 1.
        longest_step_s: the rows of the log are divided into steps that are usually no longer [s].
    """
    order = np.argsort(-spans.steps, kind="stable")
    spans = spans.chosen(order)
    offsets = np.r_[0, np.cumsum(spans.steps + 1)]
    rows = np.arange(offsets[-1]) - np.repeat(offsets[:-1] - spans.start, spans.steps + 1)
    parts = _steps_a_row(recording, longest_step_s)
    theta = None
    if feedback is None and 0 < len(spans) <= FEW_SPANS:
        theta = _one_by_one(plant, recording, spans, parts, tell)
    if theta is None:
        theta = _at_once(plant, recording, spans, feedback, parts, offsets, tell)
    return SimulatedMotion(rows, np.repeat(order, spans.steps + 1), theta + plant.zero)


def _one_by_one(
    plant: DrivePlant, recording: Recording, spans: Spans, parts: int, tell: Callable[[float], None] | None
) -> Array | None:
    """Angles (m,) [rad] in Python floats; None for several parameter sets, or where a value is not finite."""
    theta: list[float] = []
    for k in range(len(spans)):
        one = spans.chosen(np.array([k]))
        start, steps = int(one.start[0]), int(one.steps[0])
        arrays = _known(plant, recording, one)
        if any(np.size(x) > 1 for x in arrays.values()):
            return None
        known = {name: _number(x) for name, x in arrays.items()}
        motion = tuple(map(_number, _start(plant, recording, one.start)))
        states = {name: float(recording.states[name][start]) for name in plant.law.initial}
        try:
            law = plant.law.at(known, SCALAR)
            stepper = _Stepper(law, _listed(recording, start, steps), known, None, parts, SCALAR)
            theta.append(motion[0])
            with np.errstate(all="ignore"):
                for row in range(steps):
                    motion, states = stepper.across(row, motion, states)
                    theta.append(motion[0])
                    if tell is not None and row % 512 == 0:
                        tell((k + row / steps) / len(spans))
        except (ArithmeticError, ValueError, NotImplementedError):
            return None
        if not math.isfinite(theta[-1]):
            return None
    return np.array(theta)


def _number(x: Any) -> float:
    return float(np.ravel(x)[0])


def _at_once(
    plant: DrivePlant,
    recording: Recording,
    spans: Spans,
    feedback: Feedback | None,
    parts: int,
    offsets: Integers,
    tell: Callable[[float], None] | None,
) -> Array:
    """Angles (..., m) [rad] of all spans, the longest first, in arrays."""
    known = _known(plant, recording, spans)
    signals = _Signals(recording.t, recording.inputs, recording.changes, recording.off, recording.by_voltage)
    shape = np.broadcast_shapes((len(spans),), *(np.shape(x) for x in known.values()))
    motion = tuple(np.broadcast_to(x, shape) for x in _start(plant, recording, spans.start))
    states = {n: np.broadcast_to(recording.states[n][spans.start], shape) for n in plant.law.initial}
    theta = np.empty((*shape[:-1], offsets[-1]))
    theta[..., offsets[:-1]] = motion[0]
    longest, active, stepper = int(spans.steps[0]) if len(spans) else 0, -1, None
    # What diverges is infinite, and its error with it.
    with np.errstate(all="ignore"):
        for k in range(longest):
            left = int(np.searchsorted(-spans.steps, -k))
            if stepper is None or left != active:
                active = left
                motion = tuple(x[..., :active] for x in motion)
                states = {name: x[..., :active] for name, x in states.items()}
                own = {
                    n: x[..., :active] if np.shape(x)[-1:] == (len(spans),) else x for n, x in known.items()
                }
                stepper = _Stepper(plant.law.at(own), signals, own, feedback, parts, np)
            motion, states = stepper.across(spans.start[:active] + k, motion, states)
            theta[..., offsets[:active] + k + 1] = motion[0]
            if tell is not None and k % 64 == 0:
                tell(k / longest)
    return theta


def _steps_a_row(recording: Recording, longest_step_s: float) -> int:
    together = np.diff(recording.segment) == 0
    usual = float(np.median(np.diff(recording.t)[together]))
    return max(1, int(np.ceil(usual / longest_step_s * (1.0 - 1e-6))))


def _start(plant: DrivePlant, recording: Recording, rows: Integers) -> tuple[Array, Array, Array]:
    """Angle, velocity and acceleration of the motor at these rows, smoothed."""
    return recording.theta_m[rows] - plant.zero, recording.omega_m[rows], recording.alpha_m[rows]


def _known(plant: DrivePlant, recording: Recording, spans: Spans) -> dict[str, Any]:
    """The parameters by name and what follows from them, each a number, (sets, 1) or (..., spans)."""
    law = plant.law
    found = law.prepared(plant.parameters)
    for rows, added in recording.carried:
        own = law.prepared(plant.carrying(added).parameters)
        found = {name: _where(rows[spans.start], own[name], found[name]) for name in found}
    names = ("gain", "damping", "zero", "offset", "load", "ampere")
    return found | {name: getattr(plant, name) for name in names}


class _Signals(NamedTuple):
    """What drives a simulation, row by row: arrays, or lists where it goes on in numbers."""

    t: Any
    inputs: Mapping[str, Any]
    changes: Mapping[str, Any]
    off: Any
    by_voltage: bool


def _listed(recording: Recording, start: int, steps: int) -> _Signals:
    """The rows of one span as lists of numbers."""
    rows = slice(start, start + steps + 1)
    inputs, changes = (
        {name: x[rows].tolist() for name, x in each.items()} for each in (recording.inputs, recording.changes)
    )
    return _Signals(
        recording.t[rows].tolist(), inputs, changes, recording.off[rows].tolist(), recording.by_voltage
    )


class _Stepper:
    """Takes spans from one row to the next: of numbers for one span, of arrays for all at once."""

    def __init__(
        self,
        law: LawAt,
        signals: _Signals,
        known: Mapping[str, Any],
        feedback: Feedback | None,
        parts: int,
        arithmetic: Any,
    ) -> None:
        self._law, self._signals, self._known = law, signals, known
        self._feedback, self._parts, self._arithmetic = feedback, parts, arithmetic
        logged = [name for name in signals.inputs if name in law.names or name == "signal"]
        self._inputs = [(name, signals.inputs[name], signals.changes[name]) for name in logged]
        self._switches = bool(np.any(signals.off))

    def across(
        self, rows: Any, motion: tuple[Any, ...], states: dict[str, Any]
    ) -> tuple[tuple[Any, ...], dict[str, Any]]:
        """Angle, velocity and acceleration, and the hidden states, at the next rows."""
        known, law, signals, parts = self._known, self._law, self._signals, self._parts
        theta, omega, alpha = motion
        dt = (signals.t[rows + 1] - signals.t[rows]) / parts
        here = [(name, first[rows], change[rows]) for name, first, change in self._inputs]
        on = 1.0 - signals.off[rows] if self._switches else 1.0
        gain, damping, inertia = known["gain"] * on, known["damping"] * on, known["inertia"]
        for part in range(parts):
            at = (part + 0.5) / parts
            theta = theta + 0.5 * dt * omega
            # The velocity in the middle of the step, as far as the step before it says.
            middle = omega + 0.5 * dt * alpha
            now = {name: first + at * change for name, first, change in here}
            if self._feedback is None:
                signal = now["signal"] - known["offset"]
            else:
                signal = self._feedback.signal(rows, at, theta + known["zero"], middle)
            torque = gain * signal - damping * middle
            now |= {"theta_m": theta, "omega_m": middle, "alpha_m": alpha, "i": torque * known["ampere"]}
            now |= {"u": signal if signals.by_voltage else now.get("u", 0.0), "dt": dt, **states}
            found = law.torques(now)
            other = found.other + (found.armature * on if law.armature else 0.0) + damping * middle
            other = other - known["load"]
            after = step(found, inertia, omega, other, damping, dt, self._arithmetic)
            if states:
                states = law.advanced(now)
            alpha, omega = (after - omega) / dt, after
            theta = theta + 0.5 * dt * omega
        return (theta, omega, alpha), states


def _where(rows: NDArray[np.bool_], one: Any, other: Any) -> Any:
    return other if one is other or np.all(one == other) else np.where(rows, one, other)
