"""The emitted estimator of friction as the tests call it: its C, its Python, and motions for both."""

import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from tests.compiled import EmittedBeside, emitted_once, python_beside

# An arm on a strong drive: what Table 1 leaves out is its inertia.
DRIVE = {"J_m": 2e-4, "J_l": 0.04}
STATE = (
    "coefficient", "d", "u", "before", "square", "product", "rho", "sharpness", "limit", "rate", "up", "down",
    "seen",
)  # fmt: skip
COUNTS = ("calls", "settled", "forward", "paired", "turn")


def emitted(
    folder: Path, model: Any = "c2_parallel", given: Mapping[str, Any] | None = None, **asked: Any
) -> Path:
    """Emit a model with its estimator into a folder of its own, and return the folder."""
    values = DRIVE if given is None else given
    return emitted_once(folder / "emitted", model, parameters=values, adapt=True, **asked)


def module(folder: Path, name: str) -> ModuleType:
    """The emitted Python of the estimator, executed with the model beside it."""
    return python_beside(folder, name, "adapt")


class Estimator(EmittedBeside):
    """The C of an estimator, compiled in one precision."""

    def __init__(self, folder: Path, name: str, dtype: Any, compiler: str = "gcc") -> None:
        super().__init__(folder, name, dtype, compiler)
        self.state: Any = self.ffi.new(f"{name}_adapt_state *")
        self["adapt_init"](self.state)

    def learn(self, inputs: Sequence[np.ndarray]) -> list[int]:
        """Learn from every sample; return the flags."""
        adapt, rows = self["adapt"], zip(*(x.tolist() for x in inputs), strict=True)
        return [adapt(*row, self.state, self.coefficients) for row in rows]

    def bits(self) -> list[Any]:
        """Every number of the state, exactly."""
        return flattened({name: getattr(self.state, name) for name in (*STATE, *COUNTS)})


def flattened(fields: Mapping[str, Any]) -> list[Any]:
    """The numbers of a state in order; numbers of single precision as the double of the same value."""
    found: list[Any] = []
    for value in fields.values():
        found += list(map(float, value)) if hasattr(value, "__len__") else [float(value)]
    return found


def python_bits(state: Any) -> list[Any]:
    """Every number of a state in Python, exactly."""
    return flattened({name: getattr(state, name) for name in (*STATE, *COUNTS)})


def motion(count: int, seed: int, still: float = 0.25, step: float = 1e-3) -> tuple[np.ndarray, ...]:
    """Angle, speed and acceleration of the motor: swings of changing size, with rests in between."""
    generator = np.random.default_rng(seed)
    time = np.arange(count) * step
    period, peak = 0.8, 45.0
    swing = np.floor(time / period).astype(int)
    sizes = generator.uniform(0.2, 1.0, swing[-1] + 1) * (generator.uniform(size=swing[-1] + 1) > still)
    phase = 2 * np.pi * time / period
    omega = peak * sizes[swing] * np.sin(phase)
    alpha = peak * sizes[swing] * 2 * np.pi / period * np.cos(phase)
    return np.cumsum(omega) * step, omega, alpha


def current(model: ModuleType, motion: Sequence[np.ndarray], friction: np.ndarray, noise: np.ndarray) -> Any:
    """The current of a drive with this friction torque and noise of it, by (4) written out."""
    theta, omega, alpha = motion
    p = model.Parameters()
    M, L, mu, g = p.M, p.L, p.mu, p.g
    gravity = mu * M * g * L * np.sin(mu * theta)
    inertia = p.J_m + mu**2 * p.J_l
    return (inertia * alpha + gravity + friction * np.sign(omega) + noise) / p.k_i


def columns(model: ModuleType, motion: Sequence[np.ndarray]) -> np.ndarray:
    """The regressor of case C2 written out from the paper: F_N of the link's motion (m, 4)."""
    theta, omega, _ = motion
    p = model.Parameters()
    along = p.M * p.L * (p.mu * omega) ** 2 + (p.M + p.M_l) * p.g * np.cos(p.mu * theta)
    across = (p.M + p.M_l) * p.g * np.sin(p.mu * theta)
    force = np.hypot(along, across)
    sign = np.sign(omega)
    return np.stack([force * p.mu**2 * omega, force * p.mu * sign, omega, sign], axis=1)


def say(command: Sequence[str | Path]) -> str:
    """What a tool prints, on either stream."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stdout + done.stderr
