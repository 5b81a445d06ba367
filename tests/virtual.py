"""Scenarios of the virtual bench, and their logs."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from eccentric.virtual_bench import PlantedEffect, Scenario, random_scenario, simulate, write
from eccentric.virtual_bench.plant import Motion, Plant
from eccentric.virtual_bench.simulation import laws, mover


def drawn_scenario(seed: int = 3, /, **options: object) -> Scenario:
    """Return a scenario of this seed: speed runs of 15 s in C2, unless the options say otherwise."""
    chosen = {"case": "C2", "mu": 0.2, "log_type": "runs", "seconds": 15.0, **options}
    return random_scenario(np.random.default_rng(seed), **chosen)  # pyright: ignore[reportArgumentType]


def log_of(tmp_path: Path, seed: int, *effects: tuple[str, float], **given: object) -> tuple[Path, Path]:
    """Write a log of 40 s of a scenario with these effects, and its rig; the sealed truth is deleted."""
    scenario = drawn_scenario(seed, **{"effects": effects, "noise": 0.006, "seconds": 40.0, **given})
    log, rig, truth = write(simulate(scenario), tmp_path / f"log{seed}.csv.gz")
    truth.unlink()
    return log, rig


def moving(
    plant: Plant, dt: float, effects: Sequence[PlantedEffect] = (), **start: float
) -> tuple[Motion, Callable[[float], None]]:
    """A rig with these effects, and what advances it by `dt` seconds under a voltage."""
    bound = laws(effects)
    motion = Motion(plant, effects=len(bound), **start)  # pyright: ignore[reportArgumentType]
    return motion, mover(plant, motion, dt, bound)
