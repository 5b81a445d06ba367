"""What `rotating_link` is held against at 50 digits: exact values, and the sizes that its bounds are eps of.

With an acceleration F_N vanishes along a curve; what F_N is made of does not.
"""

from collections.abc import Callable, Iterable, Sequence

import mpmath
import numpy as np
from mpmath import mpf

from tests import accuracy, oracle
from tests.accuracy import Real, Set
from tests.emitted import labels
from tests.oracle import Point
from tests.paper import Parameters

NAME = "rotating_link"
Columns = Iterable[Sequence[tuple[mpf, mpf]]]  # (value, size) at each state, for each component of a result


def near_no_load(p: Parameters, dtype: Real, size: int) -> tuple[Set, np.ndarray]:
    """Return states beside the curve on which F_N vanishes, and their alpha_m.

    There the inertial forces M L w^2 and M L alpha cancel the weight along the link and across it.
    """
    random = np.random.default_rng(4)
    ratio = (p.M + p.M_l) * oracle.CASES[NAME].in_plane_gravity(p) / (p.M * p.L)

    def beside(exact: list[mpf]) -> np.ndarray:
        away = random.choice((-1, 1), size) * 10 ** random.uniform(-9, -1, size)
        return np.array([float(x * (1 + mpf(d)) / p.mu) for x, d in zip(exact, away, strict=True)], dtype)

    theta = [mpf(x) for x in random.uniform(np.pi / 2, 3 * np.pi / 2, size)]
    omega_m = beside([mpmath.sqrt(-ratio * mpmath.cos(x)) for x in theta])
    alpha_m = beside([-ratio * mpmath.sin(x) for x in theta])
    theta_m = np.array([float(x / p.mu) for x in theta], dtype)
    return Set("beside no load", theta_m, omega_m * random.choice((-1, 1), size).astype(dtype)), alpha_m


def at_any_scale(p: Parameters, dtype: Real, size: int) -> tuple[Set, np.ndarray]:
    """Return states, and their alpha_m, whose inertial forces are from far below the weight to far above."""
    random = np.random.default_rng(5)
    ratio = float((p.M + p.M_l) * oracle.CASES[NAME].in_plane_gravity(p) / (p.M * p.L))

    def powers(least: float, most: float) -> np.ndarray:
        return random.choice((-1, 1), size) * 10 ** random.uniform(least, most, size) / float(p.mu)

    theta_m = random.uniform(-2, 2, size) * 2 * np.pi / float(p.mu)
    omega_m, alpha_m = np.sqrt(ratio) * powers(-3, 1), ratio * powers(-3, 2)
    return Set("at any scale", theta_m.astype(dtype), omega_m.astype(dtype)), alpha_m.astype(dtype)


def alphas(p: Parameters, dtype: Real, size: int) -> np.ndarray:
    """Return accelerations whose inertial forces are of any size beside the weight."""
    return at_any_scale(p, dtype, size)[1]


def exact(at: Set, alpha_m: np.ndarray, p: Parameters) -> dict[str, Columns]:
    """Return what each function gives; but for slopes, the size is the same under the load F_N is made of."""
    states = accuracy.accelerated(at, alpha_m, p)
    laws: dict[str, Callable[[Point, mpf], Sequence[mpf]]] = {
        "normal_force": lambda _, N: [N],
        "friction_torque": lambda x, N: [oracle.friction_under_load(NAME, N, x.omega_m, p)],
        "mechanical_friction_torque": lambda x, N: [
            oracle.friction_under_load(NAME, N, x.omega_m, p, back_emf=False)
        ],
        "friction_torque_jacobian": lambda x, N: accuracy.columns(
            NAME, N, x, p, labels(NAME, "friction_torque_jacobian")
        ),
    }
    force = oracle.CASES[NAME].normal_force
    loads = [(x, force(x, p), most) for x, most in states]
    pairs = {function: [[law(x, N), law(x, most)] for x, N, most in loads] for function, law in laws.items()}
    found = {key: [list(zip(*pair, strict=True)) for pair in of] for key, of in pairs.items()}
    slopes = {"friction_torque_gradient": [_slopes(x, most, p) for x, most in states]}
    return {key: list(zip(*rows, strict=True)) for key, rows in (found | slopes).items()}


def _slopes(x: Point, most: mpf, p: Parameters) -> list[tuple[mpf, mpf]]:
    """Return (slope, size) of friction by theta_m, omega_m and alpha_m where F_N is not 0.

    F_N is as long as N = M L (w^2 + i alpha) + b exp(i theta_l), and F_N' what of N' points along N. The
    size is what the slope is at most, N pointing along N', times how often F_N goes into `most`.
    """
    inertia, b = p.M * p.L, (p.M + p.M_l) * oracle.CASES[NAME].in_plane_gravity(p)
    weight = b * mpmath.expj(p.mu * x.theta_m)
    N = inertia * mpmath.mpc((p.mu * x.omega_m) ** 2, p.mu * x.alpha_m) + weight
    F_N = abs(N)
    per_load, own = accuracy.under_load(NAME, F_N, x, p)
    moves = ((1j * p.mu * weight, 0), (2 * inertia * p.mu**2 * x.omega_m, own), (1j * inertia * p.mu, 0))
    return [
        (own + per_load * (mpmath.conj(move) * N).real / F_N, (own + abs(per_load * move)) * most / F_N)
        for move, own in moves
    ]
