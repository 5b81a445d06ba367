"""The servo drive: encoder, filtered velocity, PI speed controller, bus."""

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, floor, pi, sqrt

import numpy as np
from scipy.signal import lfilter

from eccentric.virtual_bench.plant import Plant


@dataclass(frozen=True)
class MotorController:
    """How the servo drive measures and controls the motor.

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

    The velocity is the filtered difference of encoder counts, so it is delayed and quantised, and it is what
    the controller acts on. The integrator stops while the bus saturates.
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
    """Return `applied(u, n)`: the voltage at the motor in step n, as the bus, and so the pulses, vary."""
    if not controller.ripple and not controller.wander:
        return lambda u, _: u
    gain = 1.0 + controller.ripple * np.sin(2.0 * pi * controller.ripple_hz * dt * np.arange(steps))
    if controller.wander:
        keeps = exp(-dt / controller.wander_s)
        noise = rng.standard_normal(steps) * controller.wander * sqrt(1.0 - keeps**2)
        gain += lfilter([1.0], [1.0, -keeps], noise)
    gains = gain.tolist()
    return lambda u, n: u * gains[n]
