"""How exact the emitted code is: full sets of states against 50 digits, in C and NumPy, float and double.

The peers are other forms of the normal force, on the same inputs.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.record import Measured, Part, tell
from tests import accuracy, oracle
from tests.compiled import REAL, Library
from tests.emitted import module

CASES = {
    "c1_perpendicular": ("c1_perpendicular", "c1_asymmetric"),
    "c2_parallel": ("c2_parallel", "c2_asymmetric"),
}
PRECISIONS = {real: dtype for dtype, real in REAL.items()}
_FIGURES = {
    "force": ("F_N, C", "F_N, NumPy"),
    "friction": ("friction",),
    "gradient": ("gradient",),
    "accelerated": ("rotating_link",),
}
EMITTED = tuple(name for names in _FIGURES.values() for name in names)
_TILT = 0.6
Errors = dict[str, np.ndarray]


def measured(quick: bool) -> Part:
    """Measure all sets on all processors: 60,000 states each for F_N of C2, 6,000 for the rest; 300 if quick."""
    many, few = (300, 300) if quick else (60_000, 6_000)
    jobs = [
        (case, real, k, many if case == "c2_parallel" else few, few)
        for case in CASES
        for real in PRECISIONS
        for k in range(4 + len(accuracy.FAR))
    ]
    found: dict[tuple[str, str, str], Errors] = {}
    with ProcessPoolExecutor() as pool:
        for job, (at, errors) in zip(jobs, pool.map(_set, *zip(*jobs, strict=True)), strict=True):
            found[*job[:2], at] = errors
            tell(f"accuracy: {len(found)} of {len(jobs)} sets")
    figures = {}
    for real in PRECISIONS:
        sets = [errors for (_, one, _), errors in found.items() if one == real]
        others = [errors for errors in sets if "paper" in errors]
        missing = sum(_missing(errors, *EMITTED) for errors in sets)
        figures[f"nan {real}"] = Measured(missing, str(missing), _joined(others, _missing, sum))
        for key, names in _FIGURES.items():
            worst = max(_worst(errors, name) for errors in sets for name in names if name in errors)
            peers = _joined(others, _worst, max) if key == "force" else ""
            figures[f"{key} {real}"] = Measured(worst, "", peers)
    sizes = f"{many:,} states a set for F_N of C2 and its peers, {few:,} for all else"
    return Part(figures, [f"Worst errors, {sizes}; Table 1 with mu = 1/5.", "", *_details(found)])


def _set(case: str, real: str, index: int, size: int, few: int) -> tuple[str, Errors]:
    """The errors on one set of states: its name, and (what -> errors), of F_N at all, else at the first few."""
    dtype, decimals = PRECISIONS[real], accuracy.decimals()
    values = {letter: float(value) for letter, value in vars(decimals).items()}
    binary = oracle.exact(values)
    at = accuracy.sets(decimals, dtype, size)[index]
    states = [getattr(at, one) for one in oracle.inputs(case, "normal_force")]
    printed, prepared = (accuracy.normal_force(case, at, p) for p in (decimals, binary))
    errors: Errors = {"F_N, C": np.zeros(size), "F_N, NumPy": np.zeros(size)}
    with tempfile.TemporaryDirectory() as folder:
        for name in CASES[case]:
            library = Library(name, dtype, Path(folder))
            constant = library.many("normal_force", states, library.coefficients())
            numpy = np.asarray(module(name).normal_force(*states))
            for what, value, exact in (("F_N, C", constant, printed), ("F_N, NumPy", numpy, prepared)):
                errors[what] = np.maximum(errors[what], accuracy.units(value, exact))
    if case == "c2_parallel":
        for form, value in forms(at.theta_m, at.omega_m, values):
            errors[form] = accuracy.units(value, printed)
    at = at._replace(theta_m=at.theta_m[:few], omega_m=at.omega_m[:few])
    states = [one[:few] for one in states]
    friction = np.asarray(module(case).friction_torque(*states))
    errors["friction"] = accuracy.units(friction, accuracy.friction_torque(case, at, binary))
    if case == "c2_parallel":
        slopes = module(case).friction_torque_gradient(*states)
        exact = accuracy.gradient(case, at, binary)
        errors["gradient"] = np.max(
            [accuracy.relative(slopes[:, k], exact[label]) for k, label in enumerate(module(case).GRADIENT)],
            axis=0,
        )
        link, law = module("rotating_link"), oracle.CASES["rotating_link"].normal_force
        alpha = np.random.default_rng(2).uniform(-500, 500, few).astype(dtype)
        tilted = link.normal_force(*states, alpha, link.Parameters(phi=_TILT))
        p = oracle.exact(values | {"phi": _TILT})
        forces = [(law(x, p), most) for x, most in accuracy.accelerated(at, alpha, p)]
        errors["rotating_link"] = accuracy.relative(tilted, forces)
    return at.name, errors


def forms(theta_m: np.ndarray, omega_m: np.ndarray, p: dict[str, Any]) -> Iterator[tuple[str, np.ndarray]]:
    """Other forms of F_N in the precision of the states, and the paper's in double for states in float."""
    real = theta_m.dtype.type

    def papers(kind: type[np.floating]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        a = kind(p["M"] * p["L"] * p["mu"] ** 2) * omega_m.astype(kind) ** 2
        b = np.full_like(a, (p["M"] + p["M_l"]) * p["g"])
        return a, b, kind(p["mu"]) * theta_m.astype(kind)

    with np.errstate(invalid="ignore"):
        a, b, theta = papers(real)
        yield "paper", np.sqrt(a * a + b * b + 2 * a * b * np.cos(theta))
        yield "hypot", np.hypot(a + b * np.cos(theta), b * np.sin(theta))
        yield "half angle", np.sqrt((a - b) ** 2 + 4 * a * b * np.cos(theta / 2) ** 2)
        if real is np.float32:
            a, b, theta = papers(np.float64)
            yield "paper in double", np.sqrt(a * a + b * b + 2 * a * b * np.cos(theta)).astype(real)


_FORMS = {
    "paper": "the paper's (16)",
    "hypot": "hypot(a + b cos, b sin)",
    "half angle": "sqrt((a-b)^2 + 4ab cos^2(th/2))",
    "paper in double": "the paper's in double",
}


def _worst(errors: Errors, name: str) -> float:
    return float(np.nanmax(errors[name]))


def _missing(errors: Errors, *names: str) -> int:
    return sum(int(np.isnan(errors[name]).sum()) for name in names if name in errors)


def _joined(sets: list[Errors], one: Callable[[Errors, str], float], all_of: Callable[..., float]) -> str:
    told = {words: all_of(one(e, form) for e in sets) for form, words in _FORMS.items() if form in sets[0]}
    return "; ".join(f"{words} {value:.3g}" for words, value in told.items())


def _details(found: dict[tuple[str, str, str], Errors]) -> list[str]:
    columns = [*EMITTED, *_FORMS]
    heads = [*EMITTED, *_FORMS.values()]
    lines = [f"| case | precision | set | {' | '.join(heads)} | NaN |", "|---" * (len(columns) + 4) + "|"]
    for (case, real, at), errors in found.items():
        cells = [f"{_worst(errors, name):.3g}" if name in errors else "" for name in columns]
        lines.append(
            f"| {case[:2].upper()} | {real} | {at} | {' | '.join(cells)} | {_missing(errors, *EMITTED)} |"
        )
    return [
        *lines,
        "",
        "F_N and friction in units of the last place, gradient and rotating_link in eps of the sizes that the headers"
        " name; C with the emitted constants, whose parameters are decimals, NumPy with prepared ones."
        " NaN is counted for the emitted code.",
    ]
