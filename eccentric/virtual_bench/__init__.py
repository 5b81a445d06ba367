"""The virtual test bench: realistic logs of a drive that swings an unbalanced mass, with chosen effects.

    random_scenario -> Scenario (plant, controller, course, effects) -> simulate -> BenchRun -> write -> files

In: the arguments of `random_scenario`. Out: a log, its rig and the sealed truth, in memory (`BenchRun`) or
as files. It imports nothing from the toolkit but its error, so that it can serve as an oracle: the same
physics, written twice by different means, must agree.
"""

from .effects import EFFECTS, VARIANTS, Law, PlantedEffect, simply
from .files import free_paths, write
from .scenario import Scenario, known_effect, random_scenario
from .simulation import BenchRun, simulate

__all__ = [
    "EFFECTS",
    "VARIANTS",
    "BenchRun",
    "Law",
    "PlantedEffect",
    "Scenario",
    "free_paths",
    "known_effect",
    "random_scenario",
    "simply",
    "simulate",
    "write",
]
