"""Logs of any length with planted friction: a motor on sines, its torque known in closed form."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from eccentric.rigs import Rig, read_rig

Array = NDArray[np.float64]
Course = Callable[[Array, Array], Array]
"""Friction torque at the motor (n,) [N m], from time [s] and speed [rad/s] (n,)."""

COULOMB, VISCOUS, INERTIA = 0.05, 0.002, 0.002
MASS, LENGTH, GEAR, GRAVITY = 0.4, 0.2, 0.2, 9.81
NOISE = 0.01
RIG: dict[str, Any] = {
    "name": "planted",
    "encoder_counts_per_rev": 65536,
    "known": {
        "case": "C2", "M_kg": MASS, "M_l_kg": 0.0, "L_m": LENGTH, "mu": GEAR, "g_m_s2": GRAVITY,
        "J_m_kgm2": INERTIA - GEAR**2 * MASS * LENGTH**2, "J_l_kgm2": MASS * LENGTH**2,
    },
}  # fmt: skip
_SINES = ((9.0, 0.31, 0.3), (5.0, 0.83, 1.0), (2.0, 1.9, 2.0), (0.8, 3.7, 0.5), (25.0, 0.047, 1.5))


def rig_of(**more: Any) -> Rig:
    """The rig of the planted logs, with further keys."""
    return read_rig(RIG | more)


def plain(_: Array, omega: Array) -> Array:
    """Coulomb and viscous friction."""
    return COULOMB * np.sign(omega) + VISCOUS * omega


def stribeck(t: Array, omega: Array) -> Array:
    """More of it at low speed."""
    return plain(t, omega) + 0.03 * np.sign(omega) * np.exp(-((omega / 3.0) ** 2))


def columns(
    seconds: float, rate: float = 1000.0, friction: Course = plain, start: float = 0.0
) -> dict[str, Array]:
    """The columns of a log: time, motor angle with the steps of its encoder, torque with white noise."""
    t = start + np.arange(round(seconds * rate)) / rate
    theta = sum(a * np.sin(w * t + p) for a, w, p in _SINES)
    omega = sum(a * w * np.cos(w * t + p) for a, w, p in _SINES)
    alpha = sum(-a * w * w * np.sin(w * t + p) for a, w, p in _SINES)
    load = INERTIA * alpha + GEAR * MASS * GRAVITY * LENGTH * np.sin(GEAR * np.asarray(theta))
    step = 2.0 * np.pi / RIG["encoder_counts_per_rev"]
    noise = NOISE * np.random.default_rng(4).standard_normal(len(t))
    return {
        "time_s": np.round(t, 6),
        "theta_m_rad": np.round(np.asarray(theta) / step) * step,
        "torque_Nm": load + friction(t, np.asarray(omega)) + noise,
    }


def parquet(path: Path, log: Mapping[str, Any]) -> Path:
    """Write columns as Parquet, a column of words that no channel uses beside them."""
    words = pa.array(["unused"] * len(log["time_s"])).dictionary_encode()
    pq.write_table(pa.table({**log, "remark": words}), path, row_group_size=50_000)
    return path
