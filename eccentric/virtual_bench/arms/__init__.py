"""The virtual bench for arms: realistic logs of serial arms, with chosen effects in chosen joints.

    random_arm_scenario -> ArmScenario -> simulate_arm -> ArmRun -> write_arm -> files

In: the arguments of `random_arm_scenario`. Out: a log, its rig, the arm and the sealed truth. The rigid
bodies are MuJoCo's (`pip install 'eccentric[arms-bench]'`), the friction is of closed forms written here:
the toolkit and the bench share nothing.

    plant        joints, links, drives, friction
    engine       mass matrix, bias and joint loads, by MuJoCo
    random_arms  arms that could have been built
    course       reference motion
    survey       loads and torques along the reference
    friction     of all joints at once
    families     of effects; motion, what their laws see
    acting       an effect at work in its joint
    effects      drawn, and sized along the reference
    servo        encoders and loops
    scenario     all of it drawn
    simulation   step by step, all runs side by side
    log, files   what is written; warmth, the temperatures in it
"""

from eccentric.virtual_bench.arms.families import ARM_EFFECTS, ARM_VARIANTS
from eccentric.virtual_bench.arms.files import free_arm_paths, write_arm
from eccentric.virtual_bench.arms.log import ArmRun, simulate_arm
from eccentric.virtual_bench.arms.request import known_joint_effect
from eccentric.virtual_bench.arms.scenario import ArmScenario, random_arm_scenario

__all__ = [
    "ARM_EFFECTS",
    "ARM_VARIANTS",
    "ArmRun",
    "ArmScenario",
    "free_arm_paths",
    "known_joint_effect",
    "random_arm_scenario",
    "simulate_arm",
    "write_arm",
]
