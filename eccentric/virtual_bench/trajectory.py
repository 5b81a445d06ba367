"""The drive's reference speed, the held-out part of the log, and the control loop."""

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, floor, pi, sqrt

import numpy as np
from scipy.signal import lfilter

from eccentric.virtual_bench.plant import Plant


@dataclass(frozen=True)
class Course:
    """The reference motor speed over a log of `seconds`, and the held-out intervals [s].

    `runs`: `starts` [s] and `speeds` [rad/s] of the constant speeds, joined by smooth ramps of `ramp_s`.
    `traj`: `frequencies` [Hz], `speeds` (amplitudes, rad/s) and `phases` [rad] of the sines.
    `reference`: `speeds` [rad/s] at the times `starts` [s], interpolated linearly.
    """

    log_type: str
    seconds: float
    holdout: tuple[tuple[float, float], ...]
    speeds: tuple[float, ...]
    starts: tuple[float, ...] = ()
    ramp_s: float = 0.4
    frequencies: tuple[float, ...] = ()
    phases: tuple[float, ...] = ()

    def reference(self, time: np.ndarray) -> np.ndarray:
        """Return the reference motor speed [rad/s] at `time` [s], shape (n,)."""
        if self.log_type == "traj":
            sines = np.zeros_like(time)
            for amplitude, frequency, phase in zip(self.speeds, self.frequencies, self.phases, strict=True):
                sines += amplitude * np.sin(2.0 * np.pi * frequency * time + phase)
            return sines * _smooth(time)  # faded in over the first second
        if self.log_type == "reference":
            return np.interp(time, self.starts, self.speeds)
        speed, before = np.zeros_like(time), 0.0
        for start, value in zip(self.starts, self.speeds, strict=True):
            speed += (value - before) * _smooth((time - start) / self.ramp_s)
            before = value
        return speed


def _smooth(x: np.ndarray) -> np.ndarray:
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def speed_runs(rng: np.random.Generator, seconds: float, top_speed: float) -> Course:
    """Draw constant speeds in both directions, each for 2 to 3.5 s, with one held out in each fifth.

    Magnitudes are spread evenly over 8 to 100 % of `top_speed` [rad/s], in random order; the fastest run in
    either direction is never held out, so that held-out speeds lie within the training range.
    """
    count = max(10, round(seconds / 2.75))
    lengths = rng.uniform(2.0, 3.5, count)
    edges = np.round(np.concatenate([[0.0], np.cumsum(lengths) * seconds / lengths.sum()]), 3)
    pairs = (count + 1) // 2
    sizes = np.linspace(0.08, 1.0, pairs) * top_speed * rng.uniform(0.94, 1.0, pairs)
    speeds = rng.permutation(np.concatenate([sizes, -sizes * rng.uniform(0.92, 1.0, pairs)])[:count])
    extremes = {int(np.argmax(speeds)), int(np.argmin(speeds))}
    holdout = []
    for fifth in range(5):
        inside = [
            k for k in range(fifth * count // 5, (fifth + 1) * count // 5) if k > 0 and k not in extremes
        ]
        run = int(rng.choice(inside or [(fifth + 1) * count // 5 - 1]))
        holdout.append((float(edges[run]), float(edges[run + 1])))
    ramp = round(float(rng.uniform(0.25, 0.45)), 2)
    return Course(
        "runs", seconds, tuple(holdout), tuple(np.round(speeds, 3).tolist()), tuple(edges[:-1].tolist()), ramp
    )


def followed(time: np.ndarray, speed: np.ndarray) -> Course:
    """Return the course of a reference: motor speed [rad/s] (n,) at `time` [s] (n,), from 0 on.

    Five blocks of 4 % of it are held out, evenly spread.
    """
    seconds = round(float(time[-1]), 3)
    holdout = tuple(
        (round(k * seconds / 25, 3), round((k + 1) * seconds / 25, 3)) for k in (3, 8, 13, 18, 23)
    )
    return Course("reference", seconds, holdout, tuple(speed.tolist()), tuple(time.tolist()))


def sum_of_sines(rng: np.random.Generator, seconds: float, top_speed: float) -> Course:
    """Draw six sines, 0.05 to 1.2 Hz, below about `top_speed` [rad/s], with five blocks of 4 % held out."""
    frequencies = np.exp(np.linspace(np.log(0.06), np.log(1.1), 6)) * rng.uniform(0.9, 1.1, 6)
    amplitudes = rng.uniform(0.6, 1.0, 6)
    amplitudes *= top_speed / (0.85 * amplitudes.sum())
    phases = rng.uniform(-np.pi, np.pi, 6)
    blocks = [5 * fifth + int(rng.integers(1 if fifth == 0 else 0, 5)) for fifth in range(5)]
    holdout = tuple((round(b * seconds / 25, 3), round((b + 1) * seconds / 25, 3)) for b in blocks)
    return Course(
        "traj",
        seconds,
        holdout,
        tuple(np.round(amplitudes, 3).tolist()),
        frequencies=tuple(np.round(frequencies, 4).tolist()),
        phases=tuple(np.round(phases, 4).tolist()),
    )


# The servo drive: encoder, filtered velocity, PI speed controller, bus.


@dataclass(frozen=True)
class MotorController:
    """Measurement and control of the servo drive.

    Gains in V s/rad and V/rad. The voltage at the motor is the commanded one times 1 plus a sine of amplitude
    `ripple` plus noise of RMS `wander`, correlated over `wander_s`.
    """

    counts: int  # encoder counts per motor turn
    filter_hz: float  # corner of the velocity filter
    filter_order: int  # 1 or 2 equal poles
    kp: float
    ki: float
    bus_V: float
    ripple: float = 0.0
    ripple_hz: float = 100.0
    wander: float = 0.0
    wander_s: float = 0.02


def servo(
    controller: MotorController, plant: Plant, theta: float, dt: float
) -> Callable[[float, float], tuple[float, float]]:
    """Return `control(theta, reference)` -> (commanded voltage [V], measured velocity [rad/s]), every `dt`.

    The controller uses the filtered difference of encoder counts as velocity, which is delayed and quantised.
    The integrator stops while the bus saturates.
    """
    per_rad, quantum = controller.counts / (2.0 * pi), 2.0 * pi / controller.counts
    pole = 1.0 - exp(-2.0 * pi * controller.filter_hz * dt)
    second = controller.filter_order == 2
    kp, ki, k_e, bus = controller.kp, controller.ki * dt, plant.k_e, controller.bus_V
    last, first, speed, integral = floor(theta * per_rad + 0.5), 0.0, 0.0, 0.0

    def control(theta: float, reference: float) -> tuple[float, float]:
        nonlocal last, first, speed, integral
        count = floor(theta * per_rad + 0.5)
        first += pole * ((count - last) * quantum / dt - first)
        speed = speed + pole * (first - speed) if second else first
        last = count
        error = reference - speed
        voltage = kp * error + integral + k_e * reference
        if voltage > bus:
            voltage = bus
            integral += min(0.0, ki * error)
        elif voltage < -bus:
            voltage = -bus
            integral += max(0.0, ki * error)
        else:
            integral += ki * error
        return voltage, speed

    return control


def supply(
    controller: MotorController, dt: float, steps: int, rng: np.random.Generator
) -> Callable[[float, int], float]:
    """Return `applied(u, n)`: the motor voltage in step n with bus ripple and wander."""
    if not controller.ripple and not controller.wander:
        return lambda u, _: u
    gain = 1.0 + controller.ripple * np.sin(2.0 * pi * controller.ripple_hz * dt * np.arange(steps))
    if controller.wander:
        pole = exp(-dt / controller.wander_s)
        noise = rng.standard_normal(steps) * controller.wander * sqrt(1.0 - pole**2)
        gain += lfilter([1.0], [1.0, -pole], noise)
    gains = gain.tolist()
    return lambda u, n: u * gains[n]
