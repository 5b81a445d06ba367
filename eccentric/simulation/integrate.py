"""Many spans of a log and many parameter sets integrated at once.

    theta_h = theta + dt/2 w      w' = Moreau's step, torques at theta_h      theta' = theta_h + dt/2 w'

The torques are those of the velocity that the acceleration before the step gives for its middle, so that
where nothing sticks this is of second order in dt; a drive at rest stays exactly where it is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from eccentric.simulation.law import step
from eccentric.simulation.limits import LONGEST_STEP_S
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
    run = _Run(plant, recording, spans, feedback, _steps_a_row(recording, longest_step_s))
    found = np.empty((*run.theta.shape[:-1], offsets[-1]))
    found[..., offsets[:-1]] = run.theta
    longest = int(spans.steps[0]) if len(spans) else 0
    # What diverges is infinite, and its error with it.
    with np.errstate(all="ignore"):
        for k in range(longest):
            run.advance(k)
            found[..., offsets[: run.active] + k + 1] = run.theta[..., : run.active]
            if tell is not None and k % 64 == 0:
                tell(k / longest)
    return SimulatedMotion(rows, np.repeat(order, spans.steps + 1), found + plant.zero)


def _steps_a_row(recording: Recording, longest_step_s: float) -> int:
    together = np.diff(recording.segment) == 0
    usual = float(np.median(np.diff(recording.t)[together]))
    return max(1, int(np.ceil(usual / longest_step_s * (1.0 - 1e-6))))


class _Run:
    """An integration: the state of all spans, the longest first."""

    def __init__(
        self, plant: DrivePlant, recording: Recording, spans: Spans, feedback: Feedback | None, parts: int
    ) -> None:
        self._plant, self._recording, self._spans = plant, recording, spans
        self._feedback, self._parts, self.active = feedback, parts, -1
        every = {"gain": plant.gain, "damping": plant.damping, "zero": plant.zero, "offset": plant.offset}
        every |= {"load": plant.load, "ampere": plant.ampere}
        self._known = {**_prepared(plant, recording, spans), **every}
        shape = np.broadcast_shapes((len(spans),), *(np.shape(x) for x in self._known.values()))
        motion = (recording.theta_m[spans.start] - plant.zero, recording.omega_m[spans.start])
        motion = (*motion, recording.alpha_m[spans.start])
        self.theta, self._omega, self._alpha = (np.array(np.broadcast_to(x, shape)) for x in motion)
        self._states = {
            name: np.array(np.broadcast_to(recording.states[name][spans.start], shape))
            for name in plant.law.initial
        }
        self._given = tuple(name for name in recording.inputs if name != "signal")
        self._switches = bool(np.any(recording.off))

    def advance(self, k: int) -> None:
        """Go from row k of each span that is so long to the next row."""
        self._keep(int(np.searchsorted(-self._spans.steps, -k)))
        rec, known, parts = self._recording, self._now, self._parts
        rows = self._spans.start[: self.active] + k
        dt = (rec.t[rows + 1] - rec.t[rows]) / parts
        first = {name: rec.inputs[name][rows] for name in (*self._given, "signal")}
        change = {name: rec.changes[name][rows] for name in (*self._given, "signal")}
        on = 1.0 - rec.off[rows] if self._switches else 1.0
        theta, omega, alpha = self._theta_now, self._omega_now, self._alpha_now
        law, gain, damping = self._plant.law, known["gain"] * on, known["damping"] * on
        inertia = known["inertia"]
        for part in range(parts):
            at = (part + 0.5) / parts
            theta = theta + 0.5 * dt * omega
            # The velocity in the middle of the step, as far as the step before it says.
            middle = omega + 0.5 * dt * alpha
            if self._feedback is None:
                signal = first["signal"] + at * change["signal"] - known["offset"]
            else:
                signal = self._feedback.signal(rows, at, theta + known["zero"], middle)
            torque = gain * signal - damping * middle
            here = {name: first[name] + at * change[name] for name in self._given}
            here |= {"theta_m": theta, "omega_m": middle, "alpha_m": alpha, "i": torque * known["ampere"]}
            voltage = signal if rec.by_voltage else here.get("u", 0.0)
            here |= {**known, **self._states_now, "u": voltage, "dt": dt}
            found = law.torques(here)
            other = found.other + (found.armature * on if law.armature else 0.0) + damping * middle
            other = other - known["load"]
            after = step(found, inertia, omega, other, damping, dt)
            if self._states:
                self._states_now = law.advanced(here)
            alpha, omega = (after - omega) / dt, after
            theta = theta + 0.5 * dt * omega
        self._theta_now, self._omega_now, self._alpha_now = theta, omega, alpha
        self.theta[..., : self.active] = theta

    def _keep(self, active: int) -> None:
        """Go on with the first spans only."""
        if active == self.active:
            return
        if self.active < 0:
            self._theta_now, self._omega_now, self._alpha_now = self.theta, self._omega, self._alpha
            self._states_now: Mapping[str, Any] = self._states
        own = (self._theta_now, self._omega_now, self._alpha_now)
        self._theta_now, self._omega_now, self._alpha_now = (x[..., :active] for x in own)
        self._states_now = {name: x[..., :active] for name, x in self._states_now.items()}
        count = len(self._spans)
        self._now = {
            n: x[..., :active] if np.shape(x)[-1:] == (count,) else x for n, x in self._known.items()
        }
        self.active = active


def _prepared(plant: DrivePlant, recording: Recording, spans: Spans) -> dict[str, Any]:
    """The parameters by name and what follows from them, each a number, (sets, 1) or (..., spans)."""
    law = plant.law
    found = law.prepared(plant.parameters)
    for rows, added in recording.carried:
        own = law.prepared(plant.carrying(added).parameters)
        found = {name: _where(rows[spans.start], own[name], found[name]) for name in found}
    return found


def _where(rows: NDArray[np.bool_], one: Any, other: Any) -> Any:
    return other if one is other or np.all(one == other) else np.where(rows, one, other)
