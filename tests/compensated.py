"""The emitted compensation as the tests call it: its C, its Python, and random inputs for both."""

import warnings
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from tests.compiled import EmittedBeside, emitted_once, python_beside

INERTIA = {"J_m": 2e-4, "J_l": 0.04}
VELOCITIES, PUSHES = ("none", "reference", "measured"), ("none", "error", "demand")


def emitted(folder: Path, model: Any = "c2_parallel", given: Mapping[str, Any] | None = None) -> Path:
    """Emit a model with its compensation into a folder of its own, and return the folder."""
    values = INERTIA if given is None else given
    # A constant load is left out, with a warning, as it should be.
    with warnings.catch_warnings(action="ignore", category=UserWarning):
        return emitted_once(folder / "emitted", model, parameters=values, compensation=True)


def module(folder: Path, name: str) -> ModuleType:
    """The emitted Python of the compensation, executed with the model beside it."""
    return python_beside(folder, name, "compensation")


class Compensation(EmittedBeside):
    """The C of a compensation, compiled in one precision."""

    def settings(self, **chosen: Any) -> tuple[int, Any]:
        """Prepared settings, and what `prepare` returns."""
        s: Any = self.ffi.new(f"{self.name}_compensation_settings *", self["compensation_default"])
        for key, value in chosen.items():
            kinds = {"velocity": VELOCITIES, "push": PUSHES}.get(key, ())
            setattr(s, key, kinds.index(value) if value in kinds else value)
        return self["compensation_prepare"](self.parameters, s), s

    def __call__(self, rows: Mapping[str, np.ndarray], s: Any) -> np.ndarray:
        """The compensation of every row."""
        columns = [x.tolist() for x in rows.values()]
        found = [self["compensation"](*row, s, self.coefficients) for row in zip(*columns, strict=True)]
        return np.array(found, self.dtype)


def drawn(inputs: tuple[str, ...], count: int, seed: int, dtype: Any = np.float64) -> dict[str, np.ndarray]:
    """Random inputs of every size: a third of them near 0, where everything happens."""
    generator = np.random.default_rng(seed)
    wide = {"theta_m": 40.0, "error": 1.0, "torque": 0.5, "alpha_m": 300.0}
    found = {}
    for name in inputs:
        x = wide.get(name, 150.0) * generator.uniform(-1.0, 1.0, count)
        small = generator.integers(0, 3, count) == 0
        x[small] *= 10.0 ** generator.uniform(-9.0, 0.0, int(small.sum()))
        found[name] = x.astype(dtype)
    return found
