"""Effects outside any library, for the benchmark alone: the toolkit holds none of them.

Each is a law on the virtual bench's own ports, with the variable that an honest `unexplained` must name.
"""

from __future__ import annotations

from collections.abc import Callable
from math import exp, pi, sin
from typing import Any

Law = Callable[[Any, float], float]
# name -> (variable, port, (top speed, seconds) -> law(state, amplitude))
OUTSIDE: dict[str, tuple[str, str, Callable[[float, float], Law]]] = {
    "resonance_band": (
        "velocity", "dry",
        lambda top, _: lambda s, a: a * exp(-(((abs(s.w_mid) - 0.6 * top) / (0.06 * top)) ** 2)),
    ),
    "two_speed_levels": (
        "velocity", "dry", lambda top, _: lambda s, a: a * (1.0 if 0.3 * top < abs(s.w_mid) < 0.65 * top else 0.0)
    ),
    "speed_comb": ("velocity", "dry", lambda top, _: lambda s, a: a * sin(2 * pi * abs(s.w_mid) / (0.22 * top))),
    "speed_tooth": (
        "velocity", "dry", lambda top, _: lambda s, a: a * ((abs(s.w_mid) / (0.35 * top)) % 1.0 - 0.5)
    ),
    "angle_sector": (
        "link_angle", "dry", lambda *_: lambda s, a: a * (1.0 if 2.0 < s.link % (2 * pi) < 4.2 else 0.0)
    ),
    "angle_ramp": ("link_angle", "torque", lambda *_: lambda s, a: a * ((s.link % (2 * pi)) / pi - 1.0)),
    "angle_square": ("link_angle", "torque", lambda *_: lambda s, a: a * (1.0 if sin(s.link + 0.7) > 0 else -1.0)),
    "angle_triangle": (
        "link_angle", "dry", lambda *_: lambda s, a: a * (abs((s.link / pi + 0.4) % 2.0 - 1.0) - 0.5)
    ),
    "step_in_time": ("time", "dry", lambda _, T: lambda s, a: a * (1.0 if s.t > 0.4 * T else 0.0)),
    "wave_in_time": ("time", "dry", lambda _, T: lambda s, a: a * sin(2 * pi * s.t / (0.37 * T) + 0.5)),
    "breathing_torque": ("time", "torque", lambda _, T: lambda s, a: a * sin(2 * pi * s.t / (0.27 * T))),
    "burst_in_time": (
        "time", "dry", lambda _, T: lambda s, a: a * (1.0 if 0.55 * T < s.t < 0.7 * T else 0.0)
    ),
}  # fmt: skip
