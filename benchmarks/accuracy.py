"""Accuracy of the emitted code: full sets of states against 50 digits, in C and NumPy, float and double.

The peers are other forms of the same quantities (`benchmarks/forms.py`), on the same inputs.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from benchmarks import forms
from benchmarks.record import Measured, Part, progress
from tests import accelerated, accuracy, oracle, random_drives
from tests.compiled import REAL, Library
from tests.emitted import module
from tests.promised import DERIVATIVES, at_50_digits
from tests.random_drives import FUNCTIONS

CASES = {
    "c1_perpendicular": ("c1_perpendicular", "c1_asymmetric"),
    "c2_parallel": ("c2_parallel", "c2_asymmetric"),
}
PRECISIONS = {real: dtype for dtype, real in REAL.items()}
OWN = ("C", "NumPy")
MEASURED = {
    "force": (*OWN, "paper", "paper in double", "hypot", "half angle"),
    "friction": ("NumPy", "paper", "paper in double", "SymPy"),
    "gradient": ("NumPy", "paper", "paper in double", "SymPy"),
    "accelerated": ("NumPy", "paper", "paper in double"),
}
"""Asked-for figure -> who is measured: the emitted code, and in case C2 its peers."""
_HEADS = {"force": "F_N", "friction": "friction", "gradient": "gradient", "accelerated": "rotating_link"}
_TILT = 0.6
Errors = dict[tuple[str, str], np.ndarray]


def measured(quick: bool) -> Part:
    """Measure all sets on all processors: 60,000 states each for F_N of C2, 6,000 for the rest; 300 if quick."""
    many, few, drives = (300, 300, 10) if quick else (60_000, 6_000, 1_000)
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
            progress(f"accuracy: {len(found)} of {len(jobs)} sets")
    figures = {}
    for real in PRECISIONS:
        figures |= _figures(real, [errors for (_, one, _), errors in found.items() if one == real])
        figures |= _of_any_drive(real, drives)
    sizes = f"{many:,} states a set for F_N of C2 and its peers, {few:,} for all else"
    text = f"Worst errors. Table 1: mu = 1/5, {sizes}. Any parameters: {drives:,} random drives."
    return Part(figures, [text, *_details(found)])


def _figures(real: str, sets: list[Errors]) -> dict[str, Measured]:
    """The required figures of a precision: the worst of all sets, and how many NaN, beside those of the peers."""
    figures = {}
    for figure in MEASURED:
        worst = _over(sets, [figure], _worst, max)
        own = max(worst.pop(who) for who in OWN if who in worst)
        figures[f"{figure} {real}"] = Measured(own, "", _text(worst))
    missing = _over(sets, MEASURED, _missing, sum)
    own = int(sum(missing.pop(who) for who in OWN))
    return figures | {f"nan {real}": Measured(own, str(own), _text(missing))}


def _set(case: str, real: str, index: int, size: int, few: int) -> tuple[str, Errors]:
    """The errors on one set of states: its name, and (figure, who) -> errors, of F_N at all, else at few."""
    dtype, decimals = PRECISIONS[real], accuracy.decimals()
    values = {letter: float(value) for letter, value in vars(decimals).items()}
    binary, p = oracle.exact(values), SimpleNamespace(**values)
    at = accuracy.sets(decimals, dtype, size)[index]
    states = [getattr(at, one) for one in oracle.inputs(case, "normal_force")]
    printed, prepared = (accuracy.normal_force(case, at, q) for q in (decimals, binary))
    errors: Errors = {("force", who): np.zeros(size) for who in OWN}
    with tempfile.TemporaryDirectory() as folder:
        for name in CASES[case]:
            library = Library(name, dtype, Path(folder))
            constant = library.many("normal_force", states, library.coefficients())
            numpy = np.asarray(module(name).normal_force(*states))
            for who, value, exact in zip(OWN, (constant, numpy), (printed, prepared), strict=True):
                errors["force", who] = np.maximum(errors["force", who], accuracy.units(value, exact))
    if case == "c2_parallel":
        for form, value in forms.normal_forces(at.theta_m, at.omega_m, p).items():
            errors["force", form] = accuracy.units(value, prepared)
    at = replace(at, theta_m=at.theta_m[:few], omega_m=at.omega_m[:few])
    states = [one[:few] for one in states]
    torques = {"NumPy": np.asarray(module(case).friction_torque(*states))}
    if case == "c2_parallel":
        torques |= forms.friction_torques(at.theta_m, at.omega_m, p)
        errors |= _slopes(at, p) | _tilted(at, p)
    exact = accuracy.friction_torque(case, at, binary)
    return at.name, errors | {("friction", who): accuracy.units(F, exact) for who, F in torques.items()}


def _slopes(at: accuracy.Set, p: SimpleNamespace) -> Errors:
    """The greater error of both derivatives of the friction torque of case C2."""
    emitted = module("c2_parallel")
    found = {"NumPy": emitted.friction_torque_gradient(at.theta_m, at.omega_m)}
    found |= forms.gradients(at.theta_m, at.omega_m, p)
    exact = accuracy.gradient("c2_parallel", at, oracle.exact(vars(p)))
    return {
        ("gradient", who): np.max(
            [accuracy.relative(slopes[:, k], exact[label]) for k, label in enumerate(emitted.GRADIENT)],
            axis=0,
        )
        for who, slopes in found.items()
    }


def _tilted(at: accuracy.Set, p: SimpleNamespace) -> Errors:
    """The errors of F_N of a link that is accelerated in a tilted plane."""
    link, law = module("rotating_link"), oracle.CASES["rotating_link"].normal_force
    p = SimpleNamespace(**vars(p) | {"phi": _TILT})
    binary = oracle.exact(vars(p))
    alpha = accelerated.alphas(binary, at.theta_m.dtype.type, at.theta_m.size)
    states = (at.theta_m, at.omega_m, alpha)
    found = {"NumPy": link.normal_force(*states, link.Parameters(phi=_TILT))} | forms.accelerated(*states, p)
    exact = [(law(x, binary), most) for x, most in accuracy.accelerated(at, alpha, binary)]
    return {("accelerated", who): accuracy.relative(F_N, exact) for who, F_N in found.items()}


def _worst(errors: np.ndarray) -> float:
    return float(np.nanmax(errors))


def _missing(errors: np.ndarray) -> float:
    return float(np.isnan(errors).sum())


def _over(
    sets: Iterable[Errors],
    figures: Iterable[str],
    one: Callable[[np.ndarray], float],
    all_of: Callable[[list[float]], float],
) -> dict[str, float]:
    """Who -> their available errors, over all sets and these figures."""
    there = [(who, one(e)) for errors in sets for (figure, who), e in errors.items() if figure in figures]
    return {who: all_of([x for other, x in there if other == who]) for who, _ in there}


def _text(peers: Mapping[str, float]) -> str:
    return "; ".join(f"{forms.WORDS[who]} {value:.3g}" for who, value in peers.items())


def _details(found: dict[tuple[str, str, str], Errors]) -> list[str]:
    """A table for F_N, and one for all else."""
    force, *others = MEASURED
    return [
        *_table(found, [force]),
        *_table(found, others),
        "",
        "The closed forms are the paper's (16) and (18), the latter differentiated by hand, and for rotating_link the one"
        " with an acceleration."
        " F_N and friction in units of the last place, gradient and rotating_link in eps of the sizes that the headers"
        " name; C with the emitted constants, whose parameters are decimals, NumPy and peers with binary ones."
        " NaN is counted for the emitted code.",
    ]


def _table(found: dict[tuple[str, str, str], Errors], figures: Iterable[str]) -> list[str]:
    columns = [(figure, who) for figure in figures for who in MEASURED[figure]]
    heads = [f"{_HEADS[figure]}, {who if who in OWN else forms.WORDS[who]}" for figure, who in columns]
    lines = ["", f"| case | precision | set | {' | '.join(heads)} | NaN |", "|---" * (len(columns) + 4) + "|"]
    for (case, real, at), errors in found.items():
        cells = [f"{_worst(errors[column]):.3g}" if column in errors else "" for column in columns]
        missing = sum(_missing(errors[one]) for one in columns if one in errors and one[1] in OWN)
        lines.append(f"| {case[:2].upper()} | {real} | {at} | {' | '.join(cells)} | {missing:.0f} |")
    return lines


# With any parameters: random drives and states, not only those of Table 1. Single precision is compared with the
# emitted double, double precision with 50 digits at fewer states.


ANY_MODELS = {"c2_parallel": "", "c2_asymmetric": "", "rotating_link": "accelerated "}
"""Model -> what its figures begin with."""
_ANY_FUNCTIONS = dict.fromkeys(FUNCTIONS, "friction") | {"normal_force": "force", DERIVATIVES[1]: "gradient"}
_ANY_STATES = {"float": 200, "double": 5}  # of each drive, in each of the ways to draw them


def _of_any_drive(real: str, drives: int) -> dict[str, Measured]:
    """Return the worst errors over that many drives, by required figure."""
    random = np.random.default_rng(30)
    worst: dict[str, float] = {}
    for _ in range(drives):
        values = random_drives.drawn(random)
        for name, prefix in ANY_MODELS.items():
            states = random_drives.states(name, values, random, _ANY_STATES[real])
            for function, error in _any_errors(real, name, values, states).items():
                key = f"any {prefix}{_ANY_FUNCTIONS[function]} {real}"
                worst[key] = float(np.maximum(worst.get(key, 0.0), error))  # NaN stays
    return {key: Measured(error) for key, error in worst.items()}


def _any_errors(
    real: str, name: str, values: random_drives.Values, states: list[np.ndarray]
) -> dict[str, float]:
    if real == "double":
        return at_50_digits(name, values, states)
    return {key: float(np.max(e)) for key, e in random_drives.errors(name, values, states).items()}
