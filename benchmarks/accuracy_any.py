"""Accuracy of the emitted code with any parameters: random drives and states, not only those of Table 1.

Single precision is compared with the emitted double, double precision with 50 digits at fewer states.
"""

from __future__ import annotations

import numpy as np

from benchmarks.record import Measured
from tests import random_drives
from tests.promised import DERIVATIVES, at_50_digits
from tests.random_drives import FUNCTIONS

MODELS = {"c2_parallel": "", "c2_asymmetric": "", "rotating_link": "accelerated "}
"""Model -> what its figures begin with."""
_FUNCTIONS = dict.fromkeys(FUNCTIONS, "friction") | {"normal_force": "force", DERIVATIVES[1]: "gradient"}
_STATES = {"float": 200, "double": 5}  # of each drive, in each of the ways to draw them


def figures(real: str, drives: int) -> dict[str, Measured]:
    """Return the worst errors over that many drives, by required figure."""
    random = np.random.default_rng(30)
    worst: dict[str, float] = {}
    for _ in range(drives):
        values = random_drives.drawn(random)
        for name, prefix in MODELS.items():
            states = random_drives.states(name, values, random, _STATES[real])
            for function, error in _errors(real, name, values, states).items():
                key = f"any {prefix}{_FUNCTIONS[function]} {real}"
                worst[key] = float(np.maximum(worst.get(key, 0.0), error))  # NaN stays
    return {key: Measured(error) for key, error in worst.items()}


def _errors(real: str, name: str, values: random_drives.Values, states: list[np.ndarray]) -> dict[str, float]:
    if real == "double":
        return at_50_digits(name, values, states)
    return {key: float(np.max(e)) for key, e in random_drives.errors(name, values, states).items()}
