"""A simulated screw drive at constant speeds: constant load, dry and viscous friction, ripple over the turn.

Only speed and torque are logged, at the input shaft; nothing of the package is used.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SPEEDS = tuple(side * w for w in (0.5, 1.0, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0) for side in (1.0, -1.0))
"""One run each, rad/s."""
TURNS = 12.0
LOAD, COULOMB, VISCOUS = -0.35e-3, 2.4e-3, 5e-5
STRIBECK, VELOCITY = 0.75e-3, 4.0
NOISE = 0.05e-3
RIG = """average_over = "run"
low_pass_hz = 1
moving_threshold_rad_s = 0.05

[columns]
run = "run"
time = "t"
omega_m = "w"
torque = "T"

[known]
case = "C1"
mu = 1
M = "0 kg"
L = "0 m"
J_m = "2e-6 kg m^2"
J_l = "0 kg m^2"

[unknown]
T_load = ["-0.1 N m", "0.1 N m"]
"""


def mean_torque(omega: float) -> float:
    """Torque that a constant speed requires [N m]."""
    friction = COULOMB + STRIBECK * np.exp(-((omega / VELOCITY) ** 2))
    return float(LOAD + friction * np.sign(omega) + VISCOUS * omega)


def write_log(path: Path, ripple: dict[int, float], rows: int = 1000) -> Path:
    """Write a log with ripples of these orders and amplitudes [N m], each at a phase of its own in a run.

    `rows` a run, over twelve turns.
    """
    rng = np.random.default_rng(11)
    lines = ["run,t,w,T"]
    for k, omega in enumerate(SPEEDS):
        t = np.linspace(0.0, TURNS * 2.0 * np.pi / abs(omega), rows)
        torque = mean_torque(omega) + NOISE * rng.standard_normal(rows)
        for order, amplitude in ripple.items():
            torque = torque + amplitude * np.cos(order * omega * t + rng.uniform(0.0, 2.0 * np.pi))
        lines += [f"speed_{k},{a:.9g},{omega:.9g},{b:.9g}" for a, b in zip(t, torque, strict=True)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path
