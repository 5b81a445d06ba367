"""Simulate the log of a carriage on a screw: a stiff linear axis under a digital position loop.

Independent of the toolkit. Run it to regenerate slide.csv.gz: python examples/slide/make_log.py

The plant is m dv/dt = gain u - B v - C sgn v - F_load, integrated by the trapezoidal rule in steps of an
eighth of a millisecond, with implicit dry friction, so that it sticks. The loop runs at 1 kHz: P for the
position, PI for the velocity, which is the difference of encoder positions. Rows are logged halfway between
two control instants, where position and voltage are simultaneous.
"""

from __future__ import annotations

import gzip
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

RATE_HZ, PARTS = 1000, 8


@dataclass(frozen=True)
class Carriage:
    """The plant: mass [kg], viscous [N s/m] and Coulomb friction [N], load [N], gain [N/V], encoder step [m].

    Further: noise of the logged voltage, Stribeck friction [N] with its velocity [m/s], and a force that
    varies once per turn of the screw, of an amplitude [N] and a pitch [m].
    """

    mass: float = 95.0
    B: float = 203.0
    C: float = 20.0
    F_load: float = -3.0
    gain: float = 35.0
    step: float = 1e-6
    noise_V: float = 0.03
    stribeck: float = 0.0
    stribeck_m_s: float = 0.02
    ripple: float = 0.0
    pitch: float = 0.01


def logged(
    seed: int, plant: Carriage = Carriage(), seconds: float = 24.0, runs: int = 2
) -> dict[str, np.ndarray]:
    """Time [s], position [m], voltage [V], number of the run: moves of 0.2 m, back and forth, with rests."""
    rng = np.random.default_rng(seed)
    found = [_run(rng, plant, seconds, run) for run in range(runs)]
    return dict(zip(("t_s", "q_m", "u_V", "run"), np.concatenate(found).T, strict=True))


def _run(rng: np.random.Generator, plant: Carriage, seconds: float, run: int) -> np.ndarray:
    n, h = round(seconds * RATE_HZ), 1.0 / (RATE_HZ * PARTS)
    wanted = _moves(rng, n)
    x = v = integral = u = last = 0.0
    damped = h * plant.B / (2.0 * plant.mass)
    rows = np.empty((n, 4))
    for k in range(n):
        read = round(x / plant.step) * plant.step
        aim, speed = wanted[k]
        error = speed + 40.0 * (aim - read) - (read - last) * RATE_HZ
        last = read
        integral += error / RATE_HZ
        u = min(max((3000.0 * error + 40000.0 * integral) / plant.gain, -10.0), 10.0)
        for part in range(PARTS):
            if part == PARTS // 2:
                rows[k] = ((k + 0.5) / RATE_HZ, round(x / plant.step) * plant.step, u, run)
            dry = plant.C + plant.stribeck * math.exp(-((v / plant.stribeck_m_s) ** 2))
            force = plant.gain * u - plant.F_load
            force -= plant.ripple * math.sin(2.0 * math.pi * x / plant.pitch)
            free = (1.0 - damped) * v + h * force / plant.mass
            moved = math.copysign(max(abs(free) - h * dry / plant.mass, 0.0), free) / (1.0 + damped)
            x, v = x + h * (v + moved) / 2.0, moved
    rows[:, 2] += plant.noise_V * rng.standard_normal(n)
    return rows


def _moves(rng: np.random.Generator, n: int) -> np.ndarray:
    """Reference position and velocity (n, 2): quintic moves of 0.8 to 2.2 s with rests between."""
    found, at = np.zeros((n, 2)), 300
    low, high = 0.0, 0.2
    while at < n:
        steps = round(rng.uniform(0.8, 2.2) * RATE_HZ)
        s = np.arange(1, steps + 1) / steps
        place = 10 * s**3 - 15 * s**4 + 6 * s**5
        slope = (30 * s**2 - 60 * s**3 + 30 * s**4) * RATE_HZ / steps
        rest = round(rng.uniform(0.1, 0.3) * RATE_HZ)
        part = np.concatenate([np.stack([place, slope], 1), np.tile([1.0, 0.0], (rest, 1))])
        part = part[: n - at]
        found[at : at + len(part), 0] = low + (high - low) * part[:, 0]
        found[at : at + len(part), 1] = (high - low) * part[:, 1]
        at += len(part)
        low, high = high, low
    found[:300, 0] = 0.0
    return found


if __name__ == "__main__":
    columns = logged(7, Carriage(stribeck=12.0, ripple=4.0), seconds=10.0)
    rows = zip(*(columns[name][::2].tolist() for name in ("t_s", "q_m", "u_V", "run")), strict=True)
    text = "".join(f"{t:.4f},{1e3 * q:.3f},{u:.4f},{run:.0f}\n" for t, q, u, run in rows)
    # No time stamp: the same rows give the same file.
    packed = gzip.compress(f"t_s,q_mm,u_V,run\n{text}".encode(), mtime=0)
    Path(__file__).with_name("slide.csv.gz").write_bytes(packed)
