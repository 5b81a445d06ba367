"""How far emitted code is from the paper's closed forms at 50 digits, in units of the last place.

Inputs count as the exact binary numbers they are, parameters as exact decimals. `python -m tests.accuracy`
is not the way to run it: `benchmarks/accuracy.py` measures full sets, `test_accuracy.py` small ones.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import mpmath
import numpy as np
from mpmath import mpf

from tests import oracle, paper
from tests.oracle import Point
from tests.paper import Parameters

Real = type[np.floating]
FAR = (1e3, 1e4)  # rad, the largest motor angles


class Set(NamedTuple):
    """One set of states: its name, and motor angles [rad] and velocities [rad/s] in the precision."""

    name: str
    theta_m: np.ndarray
    omega_m: np.ndarray


def decimals(**changes: str) -> Parameters:
    """Return Table 1 with decimals changed, at 50 digits."""
    return paper.table_1(oracle.number, **{k: oracle.number(paper.Fraction(v)) for k, v in changes.items()})


def sets(p: Parameters, dtype: Real, size: int, seed: int = 1) -> tuple[Set, ...]:
    """Return the states to measure at: the whole plane, the hollow from afar and near, large angles.

    The hollow is where the link stands upright at the critical velocity; distances from it are in rad of the
    link and relative to that velocity.
    """
    random = np.random.default_rng(seed)
    star = paper.critical_velocity(p) / p.mu
    turn = 2 * mpmath.pi / p.mu

    def near(offsets: Callable[[], np.ndarray], turns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        sides = random.choice((-1, 1), size)
        theta = [(int(k) + mpf(0.5)) * turn + mpf(x) / p.mu for k, x in zip(turns, offsets(), strict=True)]
        omega = [int(s) * star * (1 + mpf(x)) for s, x in zip(sides, offsets(), strict=True)]
        return np.array([float(x) for x in theta]), np.array([float(x) for x in omega])

    def even() -> np.ndarray:
        return random.uniform(-1e-3, 1e-3, size)

    def logarithmic() -> np.ndarray:
        return random.choice((-1, 1), size) * 10 ** random.uniform(-7, -3, size)

    def velocities() -> np.ndarray:
        return random.uniform(-3, 3, size) * float(star)

    few = random.integers(-2, 2, size)
    last = int(FAR[1] / float(turn)) - 1
    many = random.integers(-last, last + 1, size)
    chosen = {
        "plane": (random.uniform(-3, 3, size) * float(turn), velocities()),
        "within 1e-3 of the hollow": near(even, few),
        "1e-7 to 1e-3 from it": near(logarithmic, few),
        "the same, up to 1e4 rad": near(logarithmic, many),
    }
    for far in FAR:
        angles = random.choice((-1, 1), size) * random.uniform(0.9, 1.0, size) * far
        chosen[f"|theta_m| to {far:.0e} rad"] = (angles, velocities())
    return tuple(
        Set(name, theta.astype(dtype), omega.astype(dtype)) for name, (theta, omega) in chosen.items()
    )


def units(actual: np.ndarray, exact: list[mpf]) -> np.ndarray:
    """Return the errors in units of the last place of the exact value; NaN where `actual` is NaN."""
    spacing = np.spacing(np.array([float(abs(x)) for x in exact], actual.dtype)).astype(float)
    errors = [
        float(mpf(float(a)) - x) if np.isfinite(a) else np.nan for a, x in zip(actual, exact, strict=True)
    ]
    return np.abs(errors) / spacing


def normal_force(name: str, at: Set, p: Parameters) -> list[mpf]:
    """Return the exact normal forces of a steady model [N]."""
    law = oracle.CASES[name].normal_force
    return [
        law(Point(mpf(float(t)), mpf(float(w)), mpf(0)), p)
        for t, w in zip(at.theta_m, at.omega_m, strict=True)
    ]
