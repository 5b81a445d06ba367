"""Other forms of the emitted quantities, on the same states: the closed forms as printed, and SymPy's output for them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import SimpleNamespace

import numpy as np

from benchmarks import peers
from tests import paper
from tests.paper import Parameters

Form = Callable[..., np.ndarray]
WORDS = {
    "paper": "the closed form",
    "paper in double": "the closed form in double",
    "hypot": "hypot(a + b cos, b sin)",
    "half angle": "sqrt((a-b)^2 + 4ab cos^2(th/2))",
    "SymPy": "SymPy cse",
}


def normal_forces(theta_m: np.ndarray, omega_m: np.ndarray, p: Parameters) -> dict[str, np.ndarray]:
    """F_N of case C2 [N], form -> values; (16) is the closed form."""

    def parts(theta_m: np.ndarray, omega_m: np.ndarray) -> tuple[np.ndarray, ...]:
        a = p.M * p.L * p.mu**2 * omega_m**2
        return a, np.full_like(a, (p.M + p.M_l) * p.g), p.mu * theta_m

    def closed(theta_m: np.ndarray, omega_m: np.ndarray) -> np.ndarray:
        a, b, theta = parts(theta_m, omega_m)
        return np.sqrt(a * a + b * b + 2 * a * b * np.cos(theta))

    with np.errstate(invalid="ignore"):
        a, b, theta = parts(theta_m, omega_m)
        return _in_both(closed, theta_m, omega_m) | {
            "hypot": np.hypot(a + b * np.cos(theta), b * np.sin(theta)),
            "half angle": np.sqrt((a - b) ** 2 + 4 * a * b * np.cos(theta / 2) ** 2),
        }


def friction_torques(theta_m: np.ndarray, omega_m: np.ndarray, p: Parameters) -> dict[str, np.ndarray]:
    """The resultant friction torque of case C2 [N m], form -> values; (18) is the closed form."""

    def closed(theta_m: np.ndarray, omega_m: np.ndarray) -> np.ndarray:
        return paper.friction_torque_c2(theta_m, omega_m, p, np)

    with np.errstate(invalid="ignore"):
        return _in_both(closed, theta_m, omega_m) | {"SymPy": _sympy()[0](theta_m, omega_m)}


def gradients(theta_m: np.ndarray, omega_m: np.ndarray, p: Parameters) -> dict[str, np.ndarray]:
    """Its derivatives by theta_m and omega_m, form -> values (n, 2); (18) is differentiated by hand."""

    def closed(theta_m: np.ndarray, omega_m: np.ndarray) -> np.ndarray:
        a_w, b = 2 * p.M * p.L * p.mu**2 * omega_m, (p.M + p.M_l) * p.g
        a, theta = a_w * omega_m / 2, p.mu * theta_m
        F_N = paper.normal_force_c2(theta_m, omega_m, p, np)
        per_load = p.mu**2 * p.B_lN * omega_m + p.mu * p.C_lN * np.sign(omega_m)
        by_theta = -per_load * a * b * p.mu * np.sin(theta) / F_N
        own = p.mu**2 * p.B_lN * F_N + p.B_m + paper.back_emf_damping(p)
        return np.stack([by_theta, own + per_load * a_w * (a + b * np.cos(theta)) / F_N], axis=-1)

    with np.errstate(invalid="ignore", divide="ignore"):
        slopes = np.stack(_sympy()[1](theta_m, omega_m), axis=-1)
        return _in_both(closed, theta_m, omega_m) | {"SymPy": slopes}


def accelerated(
    theta_m: np.ndarray, omega_m: np.ndarray, alpha_m: np.ndarray, p: Parameters
) -> dict[str, np.ndarray]:
    """F_N of rotating_link [N], form -> values."""

    def closed(theta_m: np.ndarray, omega_m: np.ndarray, alpha_m: np.ndarray) -> np.ndarray:
        tilted = SimpleNamespace(
            **vars(p) | {"phi": theta_m.dtype.type(p.phi)}
        )  # so that its cosine is no double
        return paper.normal_force_rotating_link(theta_m, omega_m, alpha_m, tilted, np)

    with np.errstate(invalid="ignore"):
        return _in_both(closed, theta_m, omega_m, alpha_m)


def _in_both(closed: Form, *states: np.ndarray) -> dict[str, np.ndarray]:
    """A closed form in the precision of the states and, for those in float, in double."""
    real = states[0].dtype
    found = {"paper": closed(*states)}
    if real == np.float32:
        found["paper in double"] = closed(*(x.astype(np.float64) for x in states)).astype(real)
    return found


@cache
def _sympy() -> tuple[Form, Callable[..., list[np.ndarray]]]:
    """The friction torque and its two slopes, as SymPy's cse and printer make them for NumPy."""
    import sympy as sp

    symbols, F, slopes = peers.differentiated()
    return tuple(sp.lambdify(symbols, one, "numpy", cse=True) for one in (F, slopes))
