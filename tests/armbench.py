"""Arms and scenarios of the bench for arms, for its tests."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from eccentric.virtual_bench import ArmScenario, random_arm_scenario
from eccentric.virtual_bench.arms.plant import BenchArm, BenchLink, JointFriction
from tests.arms import random_inertia

NO_MUJOCO = "MuJoCo (`pip install 'eccentric[arms-bench]'`) is not installed"


def require_mujoco() -> None:
    """Skip the tests of a file where the engine is not there."""
    pytest.importorskip("mujoco", reason=NO_MUJOCO)


def drawn_arm_scenario(seed: int = 3, /, **options: object) -> ArmScenario:
    """Return a scenario of this seed: the 2R arm for 15 s in three runs, unless the options say otherwise."""
    chosen = {"arm": "2r", "seconds": 15.0, "runs": 3, **options}
    return random_arm_scenario(np.random.default_rng(seed), **chosen)  # pyright: ignore[reportArgumentType]


def random_links(rng: np.random.Generator, n: int) -> BenchArm:
    """An arm with any axes, places and bodies, and large rotors."""
    links = []
    for _ in range(n):
        tensor, axis = random_inertia(rng), rng.normal(size=3)
        xx, yy, zz, xy, xz, yz = (
            float(tensor[i, k]) for i, k in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
        )
        links.append(
            BenchLink(
                position=vector(rng.normal(size=3) * 0.3),
                rpy=vector(rng.uniform(-3.0, 3.0, 3)),
                axis=vector(axis / np.linalg.norm(axis)),
                mass=float(rng.uniform(0.5, 5.0)),
                centre=vector(rng.normal(size=3) * 0.1),
                inertia=(xx, yy, zz, xy, xz, yz),
                mu=float(rng.uniform(0.05, 1.0)),
                J_m=float(rng.uniform(0.001, 0.05)),
                k_i=0.1,
            )
        )
    return BenchArm("any", tuple(links), vector(rng.normal(size=3) * 6.0))


def vector(values: np.ndarray) -> tuple[float, float, float]:
    """Three numbers as a tuple."""
    x, y, z = (float(value) for value in values)
    return x, y, z


def without_friction(scenario: ArmScenario) -> ArmScenario:
    """The same arm with bearings and motors that turn freely."""
    links = tuple(replace(link, friction=JointFriction()) for link in scenario.arm.links)
    return replace(scenario, arm=replace(scenario.arm, links=links))
