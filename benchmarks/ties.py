"""Logs that end in a tie, found cheaply: short, poor courses of the virtual bench, each with one effect.

A course of a few seconds at one speed, in one direction or over a small range leaves open what a full one would
decide. The rig is drawn as for any other log of the bench; the limits of its motions are those of the drive, not
those of the poor course.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from eccentric.core import InputError
from eccentric.diagnosis import Diagnosis, diagnose
from eccentric.planning import Bounds
from eccentric.virtual_bench import EFFECTS, BenchRun, Scenario, random_scenario, simulate
from eccentric.virtual_bench.plant import Plant
from eccentric.virtual_bench.trajectory import Course

STRENGTHS = (0.03, 0.06, 0.12)
RATIOS = (1 / 30, 1 / 5, 1 / 2, 1.0)
NOISES = (0.008, 0.015, 0.025)
COURSES = ("one speed", "one direction", "small range", "swing")


@dataclass(frozen=True)
class Tied:
    """A log whose diagnosis ends in a tie that holds the truth."""

    seed: int
    truth: str
    run: BenchRun
    found: Diagnosis
    bounds: Bounds


def tied_logs(first: int, time_s: float) -> Iterator[tuple[int, Tied | Exception | None]]:
    """From a seed on, each seed with its log if that is tied, or the failure of its diagnosis.

    Plans for them may take `time_s` [s].
    """
    families = [family for family in EFFECTS if "temperature" not in family]
    seed = first
    while True:
        rng = np.random.default_rng(seed)
        effect = str(rng.choice(families)), float(rng.choice(STRENGTHS))
        case, mu, noise = str(rng.choice(["C1", "C2"])), float(rng.choice(RATIOS)), float(rng.choice(NOISES))
        one: Tied | Exception | None = None
        # A case need not show every effect.
        with suppress(InputError):
            drawn = random_scenario(rng, case=case, mu=mu, log_type="runs", effects=[effect], noise=noise)
            poor = replace(drawn, course=poor_course(rng, max(drawn.course.speeds)))
            try:
                one = _tied(seed, poor, drawn, time_s)
            except np.linalg.LinAlgError as error:
                one = error
        yield seed, one
        seed += 1


def _tied(seed: int, scenario: Scenario, drawn: Scenario, time_s: float) -> Tied | None:
    run = simulate(scenario)
    found = diagnose([run.columns], run.rig)
    truth = run.scenario.effects[0].family
    if found.attribution.verdict != "not_identifiable" or truth not in found.attribution.tied:
        return None
    return Tied(
        seed, truth, run, found, limits_of(run.scenario.plant, max(map(abs, drawn.course.speeds)), time_s)
    )


def poor_course(rng: np.random.Generator, top_speed: float) -> Course:
    """Draw a course of 8 to 16 s that shows little: speeds up to `top_speed` [rad/s]."""
    seconds, kind = round(float(rng.uniform(8.0, 16.0)), 1), str(rng.choice(COURSES))
    blocks = [5 * fifth + int(rng.integers(1 if fifth == 0 else 0, 5)) for fifth in range(5)]
    holdout = tuple((round(b * seconds / 25, 3), round((b + 1) * seconds / 25, 3)) for b in blocks)
    speed = top_speed * float(rng.uniform(0.3, 1.0))
    if kind == "swing":
        cycles = float(rng.uniform(3.0, 8.0))
        return Course("traj", seconds, holdout, (speed,), frequencies=(cycles / seconds,), phases=(0.0,))
    parts = {
        "one speed": [1.0, -1.0] * 3,
        "one direction": [1.0, 0.5, 0.8, 0.3],
        "small range": [1.0, -1.0, 0.9, -0.9, 0.8, -0.8],
    }[kind]
    starts = np.linspace(0.0, seconds, len(parts), endpoint=False)
    return Course(
        "runs", seconds, holdout, tuple(speed * x for x in parts), tuple(np.round(starts, 3).tolist())
    )


def limits_of(plant: Plant, speed: float, time_s: float) -> Bounds:
    """Limits that suit a drive: its top speed [rad/s] within 0.3 s, and the current for that with 30 % to spare."""
    acceleration = speed / 0.3
    weight = plant.gravity_torque(0.5 * np.pi)
    friction = plant.friction_torque(0.0, plant.mu * speed)
    current = (plant.inertia * acceleration + friction + abs(weight)) / plant.k_i
    return Bounds(speed, acceleration, 1.3 * current, time_s)
