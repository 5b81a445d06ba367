"""The virtual bench for arms: realistic logs of serial arms, with chosen effects in chosen joints.

    random_arm_scenario -> ArmScenario -> simulate_arm -> ArmRun -> write_arm -> files

In: the arguments of `random_arm_scenario`. Out: a log, its rig, the arm and the sealed truth. The rigid
bodies are MuJoCo's (`pip install 'eccentric[arms-bench]'`), the friction closed-form and independent: the
toolkit and the bench share no code.

    plant        joints, links, drives, friction; mass matrix, bias and joint loads, by MuJoCo
    trajectory   reference motion, encoders and loops
    effects      families; drawing and sizing along the reference; effects acting in their joints
    scenario     random scenarios of plausible arms
    simulation   time stepping, all runs in parallel
    log          the files, and the temperatures in them
"""

from eccentric.virtual_bench.arms.effects import ARM_EFFECTS, ARM_VARIANTS, known_joint_effect
from eccentric.virtual_bench.arms.scenario import ArmScenario, random_arm_scenario
from eccentric.virtual_bench.arms.simulation import ArmRun, free_arm_paths, simulate_arm, write_arm
