"""The virtual test bench: realistic logs of a drive that swings an unbalanced mass, with planted effects.

    random_scenario -> Scenario (plant, controller, course, effects) -> simulate -> BenchRun -> write -> files

Likewise for arms, in `arms`: `random_arm_scenario`, `simulate_arm`, `write_arm`; and for a fleet of drives
over months, in closed form: `fleet_plan`, `write_fleet`.

In: the arguments of `random_scenario`. Out: a log, its rig and the sealed truth, in memory (`BenchRun`) or
as files. It imports nothing from the toolkit except errors and file output, so that it can serve as an
oracle: two independent implementations of the same physics must agree.
"""

from eccentric.virtual_bench.arms import (
    ARM_EFFECTS,
    ARM_VARIANTS,
    ArmRun,
    ArmScenario,
    free_arm_paths,
    known_joint_effect,
    random_arm_scenario,
    simulate_arm,
    write_arm,
)
from eccentric.virtual_bench.effects import EFFECTS, VARIANTS, Law, PlantedEffect, simply
from eccentric.virtual_bench.files import free_paths, write
from eccentric.virtual_bench.fleet import FleetJoint, FleetPlan, fleet_plan, write_fleet
from eccentric.virtual_bench.scenario import Scenario, known_effect, on_reference, random_scenario
from eccentric.virtual_bench.simulation import BenchRun, simulate
