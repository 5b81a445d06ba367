"""The virtual test bench: realistic logs of a drive that swings an unbalanced mass, effects of your choice.

    random_scenario -> Scenario (plant, drive, course, effects) -> simulate -> BenchRun -> write -> files

It imports nothing of the toolkit but its error, so that it can serve as an oracle: physics written twice, by
different means, must agree.
"""

from .effects import EFFECTS
from .scenario import Scenario, known_effect, random_scenario
from .simulate import BenchRun, simulate
from .write import free_paths, write

__all__ = [
    "EFFECTS",
    "BenchRun",
    "Scenario",
    "free_paths",
    "known_effect",
    "random_scenario",
    "simulate",
    "write",
]
