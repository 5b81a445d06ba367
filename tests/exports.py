"""Drives that are exported, and what the tests of all targets have in common."""

import importlib
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from eccentric.exports import ExportedDrive
from eccentric.model import load_model, with_values

J = {"J_m": 1e-4, "J_l": 0.04276066}
BENCH = {
    **J, "M": 0.489, "M_l": 0.181, "L": 0.279, "mu": 0.2, "R": 1.0, "k_i": 0.063, "k_e": 0.063,
    "B_lN": 0.006384, "C_lN": 0.07297, "B_m": 0.0009273, "C_m": 0.0443,
}  # fmt: skip
"""A fit of the bundled log, rounded."""
UNEQUAL = {"B_m_pos": 8e-4, "B_m_neg": 1.2e-3, "C_m_pos": 0.03, "C_m_neg": 0.05}
BENCH_UNEQUAL = {
    **{x: y for x, y in BENCH.items() if x[:2] not in {"B_", "C_"}},
    **{f"{x}_{sign}": BENCH[x] for x in ("B_lN", "C_lN") for sign in ("pos", "neg")},
    **UNEQUAL,
}
"""The same with unequal friction of the motor by direction."""
STEADY = 0.4
"""Angle [rad] at which friction of `BENCH` is larger than gravity."""


def drive(name: str, values: dict[str, float] | None = None, **more: float) -> ExportedDrive:
    """Return a bundled model with these values as its defaults."""
    return ExportedDrive(
        with_values(load_model(name), {**(J if values is None else values), **more}, name), name
    )


def swing_down(of: ExportedDrive, angle: float, seconds: float = 6.0, dt: float = 1e-4) -> float:
    """Return the link angle at which `friction_step` brings a link to rest that starts at rest."""
    theta_m, omega_m, p = angle / of.p.mu, 0.0, of.p
    for _ in range(round(seconds / dt)):
        torque = -of.module.gravity_torque(theta_m, p)
        omega_m = float(of.module.friction_step(theta_m, omega_m, torque, dt, p)[0])
        theta_m += dt * omega_m
        if omega_m == 0.0:
            break
    return theta_m * p.mu


def written(files: Mapping[str, str | bytes], folder: Path) -> Path:
    """Write the files of an export into a folder; return it."""
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    return folder


@contextmanager
def imported(folder: Path, name: str, model: str) -> Iterator[ModuleType]:
    """Import a written module of that name, as a user does, and forget it and the model's own afterwards."""
    names = {name, model, "eccentric_runtime"}
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(folder))
        for one in names & sys.modules.keys():
            patch.delitem(sys.modules, one)
        yield importlib.import_module(name)
        for one in names & sys.modules.keys():
            del sys.modules[one]


def link_states(count: int = 200, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Angles and velocities of a link, all moving."""
    random = np.random.default_rng(seed)
    return random.uniform(-9.0, 9.0, count), random.choice([-1.0, 1.0], count) * random.uniform(
        0.2, 12.0, count
    )
