"""A rig with friction planted by the paper's closed forms, written as a log and fitted."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from eccentric.identification import Fit, fit
from eccentric.model import load_model
from eccentric.rigs import Rig, read_rig
from eccentric.signals import Channels, read_channels
from tests import paper

Array = NDArray[np.float64]
NUMPY: Any = np

RATE = 250.0
T = np.arange(0.0, 30.0, 1.0 / RATE)
M, M_L, L, MU, G = 0.5, 0.2, 0.25, 0.2, 9.81
R, K_I, K_E, J_M, J_L = 1.2, 0.05, 0.06, 6e-4, 0.035
INERTIA = J_M + MU**2 * J_L
FRICTION = {"B_lN": 0.004, "C_lN": 0.08, "B_m": 0.0006, "C_m": 0.02}
KNOWN = f"M_kg = {M}\nM_l_kg = {M_L}\nL_m = {L}\nmu = {MU}\ng_m_s2 = {G}\n"
MOTOR = f"R_ohm = {R}\nk_i_Nm_per_A = {K_I}\nk_e_Vs_per_rad = {K_E}\n"
TORQUE = f"k_i_Nm_per_A = {K_I}\n"
MASS = f"J_m_kgm2 = {J_M}\nJ_l_kgm2 = {J_L}\n"


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
    side = np.where(omega > 0.0, "_pos", "_neg") if "C_m_pos" in friction else np.full(len(T), "")
    own = {k: np.array([friction[k + s] for s in side]) for k in ("B_lN", "C_lN", "B_m", "C_m")}
    # Without transversal force: F_T = 0 in case C1, and none in C2.
    p = SimpleNamespace(
        M=M, M_l=M_L, L=L, mu=MU, g=G, R=R, k_i=K_I, k_e=K_E, B_lT=0.0, C_lT=0.0, F_T=0.0, **own
    )
    if case == "C2":
        gravity = paper.gravity_torque(theta, p, NUMPY)
        F = paper.friction_torque_c2(theta, omega, p, NUMPY)
    else:
        gravity, F = 0.0, paper.friction_torque_c1(omega, p, NUMPY)
    return INERTIA * alpha + gravity + F - paper.back_emf_damping(p) * omega


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
