"""The emitted compensation as the tests call it: its C, its Python, and random inputs for both."""

import re
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import cffi
import numpy as np

from eccentric.emission import executed, executed_beside
from tests.compiled import FLAGS, REAL, emitted_once, run

INERTIA = {"J_m": 2e-4, "J_l": 0.04}
VELOCITIES, PUSHES = ("none", "reference", "measured"), ("none", "error", "demand")


def emitted(folder: Path, model: Any = "c2_parallel", given: Mapping[str, Any] | None = None) -> Path:
    """Emit a model with its compensation into a folder of its own, and return the folder."""
    values = INERTIA if given is None else given
    return emitted_once(folder / "emitted", model, parameters=values, compensation=True)


def module(folder: Path, name: str) -> ModuleType:
    """The emitted Python of the compensation, executed with the model beside it."""
    files = {path.name: path.read_text(encoding="utf-8") for path in folder.glob("*.py")}
    return executed_beside(executed(files, name), name, files[f"{name}_compensation.py"])


class Compensation:
    """The C of a compensation, compiled in one precision."""

    def __init__(self, folder: Path, name: str, dtype: Any, compiler: str = "gcc") -> None:
        self.name, self.dtype, self.real = name, dtype, REAL[dtype]
        library = folder.parent / f"{name}_{self.real}_{compiler}.so"
        sources = [folder / f"{name}.c", folder / f"{name}_compensation.c"]
        define = f"-DECCENTRIC_REAL={self.real}"
        run(compiler, *FLAGS, "-shared", "-fPIC", define, "-o", library, *sources, "-lm")
        text = "\n".join((folder / f"{name}{end}.h").read_text() for end in ("", "_compensation"))
        plain = re.sub(r"^#\s*include.*$", "", text, flags=re.MULTILINE)
        self.ffi = cffi.FFI()
        declared = run("gcc", "-E", "-P", define, "-", source=plain).replace("extern const", "extern")
        self.ffi.cdef(declared)
        self.lib: Any = self.ffi.dlopen(str(library))
        self.coefficients = self.ffi.new(f"{name}_coefficients *")
        self.parameters: Any = self.ffi.new(f"{name}_parameters *", self["default_parameters"])
        if hasattr(self.parameters, "F_T"):  # Python multiplies its default; C has it from 50 digits
            self.parameters.F_T = self.parameters.M_l * self.parameters.g
        assert 0 == self["prepare"](self.parameters, self.coefficients)

    def __getitem__(self, function: str) -> Any:
        """What C calls so, without its prefix and precision."""
        return getattr(self.lib, f"{self.name}_{function}_{self.real}")

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
