"""A rig with friction planted by the paper's closed forms, written as a log and fitted."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from eccentric.identify.channels import Channels, read_channels
from eccentric.identify.fit import Fit, fit
from eccentric.identify.rig import Rig, read_rig
from eccentric.model import load_model

Array = NDArray[np.float64]

RATE = 250.0
T = np.arange(0.0, 30.0, 1.0 / RATE)
M, M_L, L, MU, G = 0.5, 0.2, 0.25, 0.2, 9.81
R, K_I, K_E, INERTIA = 1.2, 0.05, 0.06, 2e-3
FRICTION = {"B_lN": 0.004, "C_lN": 0.08, "B_m": 0.0006, "C_m": 0.02}
KNOWN = f"M_kg = {M}\nM_l_kg = {M_L}\nL_m = {L}\nmu = {MU}\ng_m_s2 = {G}\n"
MOTOR = f"R_ohm = {R}\nk_i_Nm_per_A = {K_I}\nk_e_Vs_per_rad = {K_E}\n"
TORQUE = f"k_i_Nm_per_A = {K_I}\n"
MASS = f"J_m_kgm2 = {INERTIA}\nJ_l_kgm2 = 0.0\n"


def motion() -> tuple[Array, Array, Array]:
    """Return angle, velocity, acceleration at the motor: a sum of slow sines, both directions."""
    parts = [(60.0, 0.6, 0.3), (25.0, 1.7, 1.0), (6.0, 2.9, 2.0)]
    theta = sum(a * np.sin(w * T + p) for a, w, p in parts)
    omega = sum(a * w * np.cos(w * T + p) for a, w, p in parts)
    alpha = sum(-a * w * w * np.sin(w * T + p) for a, w, p in parts)
    return np.asarray(theta), np.asarray(omega), np.asarray(alpha)


def torque(case: str, friction: Mapping[str, float]) -> Array:
    """Return the drive torque of the planted rig by the paper's closed forms (4), (5), (9), (17)."""
    theta, omega, alpha = motion()
    link, turn = MU * omega, MU * theta
    force, gravity = M * L * link**2, np.zeros_like(theta)
    if case == "C2":
        weight = (M + M_L) * G
        force = np.sqrt(force**2 + 2.0 * weight * force * np.cos(turn) + weight**2)
        gravity = MU * M * G * L * np.sin(turn)
    side = np.where(omega > 0.0, "_pos", "_neg") if "C_m_pos" in friction else np.full(len(T), "")
    b_n, c_n, b_m, c_m = (np.array([friction[k + s] for s in side]) for k in ("B_lN", "C_lN", "B_m", "C_m"))
    by_link = (b_n * link + c_n * np.sign(omega)) * force
    return INERTIA * alpha + gravity + MU * by_link + b_m * omega + c_m * np.sign(omega)


def voltage(case: str) -> Array:
    """Return the armature voltage, eq (2), inductance neglected."""
    return R / K_I * torque(case, FRICTION) + K_E * motion()[1]


def written(
    tmp_path: Path, known: str, columns: Mapping[str, Array], above: str = ""
) -> tuple[Channels, Rig]:
    """Write a log of the motion with these columns and a rig, and read them."""
    table = {"time_s": T, "theta_m_rad": motion()[0], **columns}
    path = tmp_path / "log.csv"
    np.savetxt(path, np.column_stack(list(table.values())), "%.12g", ",", header=",".join(table), comments="")
    (tmp_path / "rig.toml").write_text(f"moving_threshold_rad_s = 1.0\n{above}\n[known]\n{known}")
    rig = read_rig(tmp_path / "rig.toml")
    return read_channels([path], rig), rig


def fitted(
    tmp_path: Path, known: str, columns: Mapping[str, Array], above: str = "", model: str | None = None
) -> Fit:
    """Fit the rig's model, or the named one, to what `written` gives."""
    channels, rig = written(tmp_path, known, columns, above)
    return fit(channels, rig, load_model(model or rig.model))


def coloured(rng: np.random.Generator, size: float, memory: float, count: int = len(T)) -> Array:
    """Return AR(1) noise of this standard deviation and correlation from row to row."""
    white = rng.standard_normal(count + 500) * size * math.sqrt(1.0 - memory**2)
    return np.asarray(lfilter([1.0], [1.0, -memory], white))[500:]
