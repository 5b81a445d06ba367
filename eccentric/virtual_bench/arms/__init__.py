"""The virtual bench for arms: realistic logs of serial arms, with chosen effects in chosen joints.

    random_arm_scenario -> ArmScenario -> simulate_arm -> ArmRun -> write_arm -> files

In: the arguments of `random_arm_scenario`. Out: a log, its rig, the arm and the sealed truth. The rigid
bodies are MuJoCo's (`pip install 'eccentric[arms-bench]'`), the friction is of closed forms written here:
the toolkit and the bench share nothing.

    plant        joints, links, drives, friction; mass matrix, bias and joint loads, by MuJoCo
    trajectory   reference motion, encoders and loops
    effects      families; drawn, and sized along the reference; at work in their joints
    scenario     all of it drawn, arms that could have been built
    simulation   step by step, all runs side by side
    log          what is written, and the temperatures in it
"""

from eccentric.virtual_bench.arms.effects import ARM_EFFECTS, ARM_VARIANTS, known_joint_effect
from eccentric.virtual_bench.arms.log import ArmRun, free_arm_paths, simulate_arm, write_arm
from eccentric.virtual_bench.arms.scenario import ArmScenario, random_arm_scenario
