"""Hypothesis strategies: physical parameters, states of the drive including the zero of F_N, any numbers."""

import mpmath
import numpy as np
from hypothesis import strategies as st
from mpmath import mpf

from tests import oracle, paper
from tests.oracle import Point

# From a watch to an excavator, in SI units.
DRIVE = {
    "M": (0.01, 10.0), "M_l": (0.01, 10.0), "L": (0.01, 2.0), "g": (1.0, 25.0), "mu": (1 / 200, 1.0),
    "R": (0.1, 10.0), "k_i": (1e-3, 1.0), "k_e": (1e-3, 1.0), "J_m": (1e-6, 1.0), "J_l": (1e-4, 50.0),
    "F_T": (0.1, 250.0),
}  # fmt: skip
FRICTION = ("B_lN", "C_lN", "B_lT", "C_lT", "B_m", "C_m")
HALF_TURN = mpmath.pi


def coefficient() -> st.SearchStrategy[float]:
    """Draw a friction coefficient, none at all included."""
    return st.just(0.0) | st.floats(1e-5, 1.0)


@st.composite
def parameters(draw: st.DrawFn, name: str) -> dict[str, float]:
    """Draw random physical parameters of the model `name`, by letter."""
    p = {letter: draw(st.floats(low, high)) for letter, (low, high) in DRIVE.items()}
    endings = ("_pos", "_neg") if oracle.CASES[name].asymmetric else ("",)
    p |= {letter + ending: draw(coefficient()) for letter in FRICTION for ending in endings}
    return p | {"phi": draw(st.just(0.0) | st.floats(1e-6, np.pi / 2)) if name == "rotating_link" else 0.0}


def signed(low: float, high: float) -> st.SearchStrategy[float]:
    """Draw a number of size low to high with either sign."""
    return st.builds(lambda sign, size: sign * size, st.sampled_from((-1.0, 1.0)), st.floats(low, high))


@st.composite
def zeros_of_the_force(draw: st.DrawFn, p: dict[str, float]) -> tuple[float, ...]:
    """Draw a state near the zero of F_N: link upright at the critical velocity, within 1e-3."""
    off = st.just(0.0) | st.sampled_from([s * 10.0**-k for k in range(3, 8) for s in (-1, 1)])
    turns, sign = draw(st.integers(-2, 1)), draw(st.sampled_from((-1, 1)))
    exact = oracle.exact(p)
    exact.g *= mpmath.cos(exact.phi)
    theta_l = (2 * turns + 1) * HALF_TURN + mpf(draw(off))
    omega_l = sign * paper.critical_velocity(exact) * (1 + mpf(draw(off)))
    return float(theta_l / exact.mu), float(omega_l / exact.mu), 0.0, 1.0, -2.0, 0.1, 1e-3


@st.composite
def quarter_turns(draw: st.DrawFn, p: dict[str, float]) -> float:
    """Draw a motor angle of up to 1e4 rad, rounded, at which the link hangs, is upright or is horizontal."""
    quarter = HALF_TURN / 2 / mpf(p["mu"])
    limit = int(mpf(10000) / quarter)
    return float(draw(st.integers(-limit, limit)) * quarter)


def states(
    p: dict[str, float], dtype: type[np.floating], moving: bool = False, size: int = 6
) -> st.SearchStrategy[list[Point]]:
    """Draw up to `size` states, some near the zero of F_N, as mpmath numbers that `dtype` holds exactly.

    Velocities are zero or at least 1e-3 rad/s: below, w^4 underflows in single precision, which
    is a matter of `finite` and not of accuracy.
    """
    omega = signed(1e-3, 1e3) if moving else st.just(0.0) | signed(1e-3, 1e3)
    theta = st.just(0.0) | quarter_turns(p) | signed(1e-3, 1e4)
    electric = (signed(1e-3, 1e2), signed(1e-3, 1e3))
    stepped = (st.just(0.0) | signed(1e-3, 1e2), st.just(0.0) | signed(1e-6, 1e-1))
    wide = st.tuples(theta, omega, st.just(0.0) | signed(1e-3, 1e4), *electric, *stepped)
    one = st.one_of(wide, wide, zeros_of_the_force(p))
    return st.lists(one.map(lambda x: Point(*(mpf(float(dtype(v))) for v in x))), min_size=1, max_size=size)


def arrays(points: list[Point], dtype: type[np.floating]) -> dict[str, np.ndarray]:
    """Return the states as arrays, by the names of the inputs."""
    return {name: np.array([float(getattr(x, name)) for x in points], dtype) for name in Point._fields}


def finite(dtype: type[np.floating], most: float = np.inf) -> st.SearchStrategy[np.floating]:
    """Draw any finite number of the precision: subnormals, both zeros and the largest included."""
    width = 64 if dtype is np.float64 else 32
    largest = min(most, float(np.finfo(dtype).max))
    edges = [0.0, -0.0, largest, -largest, float(np.finfo(dtype).smallest_subnormal)]
    return (st.sampled_from(edges) | st.floats(-largest, largest, width=width)).map(dtype)
