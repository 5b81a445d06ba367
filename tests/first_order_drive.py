"""The exact motion of a first-order drive, u = a dw/dt + b w + c sgn w, row by row: no ODE solver, no model.

Between rows the voltage is u_0 + r s; with a constant sign of w the solution is a line and an exponential,
and a standstill lasts as long as the voltage is within +-c.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

A, B, C = 0.6, 2.0, 0.5
"""[V s^2/rad], [V s/rad], [V]: the time constant is 0.3 s."""
RIG = {"drive": "voltage", "known": {"case": "C1", "mu": 1, "M": "0 kg", "L": "0 m"}}
_TAU = A / B


def advanced(theta: float, w: float, u: float, rate: float, seconds: float) -> tuple[float, float]:
    """Angle [rad] and velocity [rad/s] after a time in which the voltage goes from u [V] at a rate [V/s]."""
    s = 0.0
    while seconds - s > 1e-15:
        now = u + rate * s
        if w == 0.0 and abs(now) <= C:
            if abs(u + rate * seconds) <= C:
                return theta, 0.0
            s = (math.copysign(C, rate) - u) / rate + 1e-12
            continue
        sign = math.copysign(1.0, w or now)
        slope = rate / B
        start = (now - C * sign) / B - slope * _TAU

        def speed(q: float, w: float = w, slope: float = slope, start: float = start) -> float:
            return start + slope * q + (w - start) * math.exp(-q / _TAU)

        end = seconds - s
        # A line and an exponential have one extremum at most: the sign at the end is enough without one.
        ends = (slope - (w - start) / _TAU, slope - (w - start) / _TAU * math.exp(-end / _TAU))
        grid = np.linspace(0.0, end, 9)[1:] if ends[0] * ends[1] < 0.0 or speed(end) * sign <= 0.0 else ()
        turned = [k for k, q in enumerate(grid) if speed(q) * sign < -1e-13]
        if turned:
            first = max(grid[turned[0] - 1] if turned[0] else 0.0, 1e-9)
            last = grid[turned[0]]
            end = brentq(speed, first, last) if speed(first) * speed(last) < 0.0 else first
        theta += start * end + slope * end * end / 2.0 + (w - start) * _TAU * (1.0 - math.exp(-end / _TAU))
        w = 0.0 if turned or speed(end) * sign <= 0.0 else speed(end)
        s += end
    return theta, w


def log(
    rate_hz: float,
    held: bool,
    seed: int,
    noise_rad: float = 2e-4,
    seconds: float = 60.0,
    late: float | None = None,
) -> dict[str, NDArray[Any]]:
    """A log: a new level each 0.7 s, held from row to row, or ramps between them; noise on the angle.

    With `late`, also the current u = R i + k_e w of a winding of 1 ohm and 1 V s/rad, so many parts of a row
    after its time.
    """
    rng, dt = np.random.default_rng(seed), 1.0 / rate_hz
    n, every = int(seconds * rate_hz) + 1, max(1, round(0.7 * rate_hz))
    levels = rng.uniform(-6.0, 6.0, n // every + 3)
    u = (
        np.repeat(levels, every)[: n + 1]
        if held
        else np.interp(np.arange(n + 1) / every, np.arange(len(levels)), levels)
    )
    theta, w, angles, current = 0.0, 0.0, np.empty(n), np.empty(n)
    for k in range(n):
        angles[k] = theta
        ramp = 0.0 if held else (u[k + 1] - u[k]) / dt
        if late is not None:
            current[k] = u[k] + ramp * late * dt - advanced(theta, w, u[k], ramp, late * dt)[1]
        theta, w = advanced(theta, w, u[k], ramp, dt)
    logged = {
        "time_s": np.arange(n) * dt,
        "theta_m_rad": angles + noise_rad * rng.standard_normal(n),
        "voltage_V": u[:n] + 0.02 * rng.standard_normal(n),
    }
    return logged if late is None else {**logged, "current_A": current + 0.01 * rng.standard_normal(n)}
