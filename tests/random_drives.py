"""What float loses with any parameters: the emitted double is the exact value, so that states are cheap.

The double's own errors, which are held to 50 digits elsewhere, are 2^-29 of those of a float. Sizes of errors
are those that headers word.
"""

import dataclasses
from collections.abc import Sequence
from types import SimpleNamespace

import numpy as np

from tests import oracle
from tests.emitted import labels, module

LARGEST = {"theta_m": 1e4, "omega_m": 2.0**29, "alpha_m": 1e15}  # what headers speak of, and no overflow
EPS = float(np.finfo(np.float32).eps)
FUNCTIONS = (
    "normal_force", "friction_torque", "mechanical_friction_torque", "friction_torque_jacobian",
    "friction_torque_gradient",
)  # fmt: skip
Values = dict[str, float]


def drawn(random: np.random.Generator) -> Values:
    """Return a drive with letters over some decades, gear ratios up to 5, some letters 0."""

    def between(least: float, most: float) -> float:
        return float(10 ** random.uniform(np.log10(least), np.log10(most)))

    ranges = {
        "M": (1e-2, 1e2), "M_l": (1e-2, 1e2), "L": (0.03, 3), "mu": (0.01, 5), "g": (0.1, 30),
        "R": (0.01, 10), "k_i": (1e-3, 1), "k_e": (1e-3, 1), "B_m": (1e-6, 1), "C_m": (1e-5, 1),
        "B_lN": (1e-6, 1), "C_lN": (1e-4, 1), "B_lT": (1e-6, 1), "C_lT": (1e-4, 1),
    }  # fmt: skip
    values = {letter: between(*ends) for letter, ends in ranges.items()}
    for letter in ("M_l", "k_e", "B_m", "C_m", "B_lN", "C_lN"):
        values[letter] *= random.random() > 0.15
    # Level planes, where next to no weight is left, are drawn as often as vertical ones.
    tilts = (0.0, random.uniform(0, np.pi / 2), np.pi / 2 - between(1e-8, 0.1))
    return directed(values | {"phi": float(tilts[random.integers(3)])}, between(0.1, 10))


def directed(values: Values, ratio: float) -> Values:
    """Return the letters with those of either direction, the negative one's so many times the others."""
    for letter in ("B_lN", "C_lN", "B_lT", "C_lT", "B_m", "C_m"):
        values |= {f"{letter}_pos": values[letter], f"{letter}_neg": ratio * values[letter]}
    return values | {"F_T": values["M_l"] * values["g"]}


def states(name: str, values: Values, random: np.random.Generator, size: int) -> list[np.ndarray]:
    """Return the inputs of a model's friction: anywhere, by orders of magnitude, and near zero load."""
    v, gravity = SimpleNamespace(**values), _gravity(name, values)
    # Case C1 has no weight to compare with: any speeds will do.
    ratio = (v.M + v.M_l) * (gravity or v.g) / (v.M * v.L)
    star, turn = np.sqrt(ratio) / v.mu, 2 * np.pi / v.mu

    def either(least: float, most: float, count: int = size) -> np.ndarray:
        return random.choice((-1, 1), count) * 10 ** random.uniform(least, most, count)

    def angles(most: float) -> np.ndarray:
        return random.uniform(-1, 1, size) * min(most, LARGEST["theta_m"])

    tops = (random.integers(-2, 2, size) + 0.5) * turn + either(-7, 0) / v.mu
    speeds = [star * either(-4, 4), star * either(-0.7, 0.7), star * (1 + either(-7, 0)) * either(0, 0)]
    found = {
        "theta_m": np.concatenate([angles(1e4), angles(3 * turn), tops]),
        "omega_m": random.permutation(np.concatenate(speeds)),
    }
    if oracle.CASES[name].accelerated:
        # Far below the weight, too: what gravity alone holds has the greatest errors.
        found["alpha_m"] = ratio / v.mu * np.concatenate([either(-3, 2, 2 * size), either(-1, 1)])
        link = random.uniform(np.pi / 2, 3 * np.pi / 2, size)
        none = (link, np.sqrt(-ratio * np.cos(link)), -ratio * np.sin(link))
        beside = [none[0], none[1] * either(0, 0) * (1 + either(-7, -0.5)), none[2] * (1 + either(-7, -0.5))]
        found = {key: np.append(x, y / v.mu) for (key, x), y in zip(found.items(), beside, strict=True)}
    asked = oracle.inputs(name, "friction_torque")
    return [np.clip(found[one], -LARGEST[one], LARGEST[one]) for one in asked]


def errors(name: str, values: Values, states: Sequence[np.ndarray]) -> dict[str, np.ndarray]:
    """Return the errors of float at these states, (n, components) by function, in units that headers word."""
    cls = module(name).Parameters
    given = cls(**{f.name: values[f.name] for f in dataclasses.fields(cls) if f.name in values})
    narrow = [x.astype(np.float32) for x in states]
    there = dict(zip(oracle.inputs(name, "friction_torque"), narrow, strict=True))
    found = {}

    def called(function: str, real: type[np.floating]) -> np.ndarray:
        by = oracle.inputs(name, "normal_force" if function == "normal_force" else "friction_torque")
        result = getattr(module(name), function)(*(there[one].astype(real) for one in by), given)
        return np.asarray(result, float).reshape(narrow[0].size, -1)

    exact = {function: called(function, np.float64) for function in FUNCTIONS}
    for function, size in _sizes(name, values, there, exact).items():
        off = np.abs(called(function, np.float32) - exact[function])
        found[function] = np.divide(off, size, out=np.zeros_like(off), where=off != 0)  # NaN is one
    return found


def _sizes(
    name: str, values: Values, there: dict[str, np.ndarray], exact: dict[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Return what the errors of each function are counted in, (n, components)."""
    v, case = SimpleNamespace(**values), oracle.CASES[name]
    w = np.abs(there["omega_m"].astype(float))[:, None]
    if case.asymmetric:
        forward = there["omega_m"][:, None] > 0
        for letter in ("B_lN", "C_lN", "B_lT", "C_lT", "B_m", "C_m"):
            setattr(v, letter, np.where(forward, values[f"{letter}_pos"], values[f"{letter}_neg"]))
    b, F_T = (v.M + v.M_l) * _gravity(name, values), float(case.transversal(v)) * v.F_T
    a_w = 2 * v.M * v.L * v.mu**2 * w  # of a = M L (mu w)^2
    a, per_load = a_w * w / 2, v.B_lN * v.mu**2 * w + v.C_lN * v.mu
    damping = v.B_lT * v.mu**2 * F_T + v.B_m + v.k_i * v.k_e / v.R

    if not case.accelerated:
        last = {key: np.spacing(np.abs(x).astype(np.float32)).astype(float) for key, x in exact.items()}
        by_omega = v.B_lN * v.mu**2 * (a + b) + damping + per_load * a_w
        by_state = [per_load * v.mu * np.minimum(a, b), by_omega] if b else [by_omega]
        return last | {"friction_torque_gradient": EPS * np.concatenate(by_state, axis=1)}

    F_N, alpha = exact["normal_force"], np.abs(there["alpha_m"].astype(float))[:, None]
    most = a + v.M * v.L * v.mu * alpha + b
    friction = per_load * most + damping * w + v.mu * v.C_lT * F_T + v.C_m
    with_load = ["lN" in label for label in labels(name, "friction_torque_jacobian")]
    moves = [v.mu * b, a_w, v.M * v.L * v.mu]
    own = [0, v.B_lN * v.mu**2 * F_N + damping, 0]
    sizes = {
        "normal_force": most,
        "friction_torque": friction,
        "mechanical_friction_torque": friction - v.k_i * v.k_e / v.R * w,
        "friction_torque_jacobian": np.abs(exact["friction_torque_jacobian"])
        * np.where(with_load, most / F_N, 1),
        "friction_torque_gradient": np.concatenate(
            [(one + per_load * move) * most / F_N for one, move in zip(own, moves, strict=True)], axis=1
        ),
    }
    return {function: EPS * size for function, size in sizes.items()}


def _gravity(name: str, values: Values) -> float:
    return float(oracle.CASES[name].in_plane_gravity(SimpleNamespace(**values)))
