"""Arms read from URDFs beside Pinocchio, which reads the same files: torques and every joint wrench."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from _pytest.mark import ParameterSet

from eccentric.core import InputError
from eccentric.model import recursion
from eccentric.rigs import read_arm
from tests.test_chain_pinocchio import AGREE, ours

pin = pytest.importorskip("pinocchio", reason="Pinocchio (`pip install pin`) is not installed")
etree = pytest.importorskip(
    "lxml.etree", reason="yourdfpy (`pip install 'eccentric[arms]'`) is not installed"
)
ROBOTS = Path(pin.__file__).parents[4] / "share" / "example-robot-data" / "robots"
if not ROBOTS.is_dir():
    pytest.skip("`pip install example-robot-data` has not been run", allow_module_level=True)

SERIAL = (
    "asr_twodof_description/urdf/TwoDofs.urdf",
    "borinot_description/urdf/borinot_flying_arm_2.urdf",
    "double_pendulum_description/urdf/double_pendulum.urdf",
    "double_pendulum_description/urdf/double_pendulum_continuous.urdf",
    "double_pendulum_description/urdf/double_pendulum_simple.urdf",
    "finger_edu_description/robots/finger_edu.urdf",
    "hextilt_description/urdf/hextilt_flying_arm_5.urdf",
    "kinova_description/robots/kinova.urdf",
    "so_arm_description/urdf/so100.urdf",
    "so_arm_description/urdf/so101.urdf",
    "talos_data/robots/talos_left_arm.urdf",
    "ur_description/urdf/ur10_joint_limited_robot.urdf",
    "ur_description/urdf/ur10_robot.urdf",
    "ur_description/urdf/ur3_gripper.urdf",
    "ur_description/urdf/ur3_joint_limited_robot.urdf",
    "ur_description/urdf/ur3_robot.urdf",
    "ur_description/urdf/ur5_gripper.urdf",
    "ur_description/urdf/ur5_joint_limited_robot.urdf",
    "ur_description/urdf/ur5_robot.urdf",
    "xarm_description/urdf/xarm7.urdf",
    "z1_description/urdf/z1.urdf",
)
"""Files of which all moving joints are one chain."""
BRANCHED = (
    "alex_description/urdf/alex_nub_hands.urdf#leftNub",
    "anymal_b_simple_description/robots/anymal-kinova.urdf#j2s6s200_end_effector",
    "baxter_description/urdf/baxter.urdf#left_gripper",
    "centauro_description/urdf/centauro.urdf#ball1_tip",
    "g1_description/urdf/g1_29dof_rev_1_0.urdf#left_rubber_hand",
    "human_description/robots/human.urdf#left_hand",
    "icub_description/robots/icub.urdf#l_gripper",
    "panda_description/urdf/panda.urdf#panda_hand",
    "simple_humanoid_description/urdf/simple_humanoid.urdf#l_wrist",
    "solo_description/robots/solo12.urdf#FL_FOOT",
    "talos_data/robots/talos_reduced.urdf#gripper_left_motor_double_link",
    "tiago_description/robots/tiago.urdf#wrist_ft_tool_link",
    "tiago_description/robots/tiago_dual.urdf#arm_left_7_link",
    "tiago_pro_description/robots/tiago_pro.urdf#arm_left_7_link",
)
"""Arms of robots with more than that: with grippers, legs, wheels or a second arm."""
IMPOSSIBLE = {
    "allegro_hand_description/urdf/allegro_left_hand.urdf#link_3.0_tip": "link_3.0",
    "pr2_description/urdf/pr2.urdf#l_wrist_roll_link": "sensor_mount_link",
    "romeo_description/urdf/romeo_small.urdf#l_gripper": "RShoulderYawLink",
}
"""Arms with a link whose inertia no body has."""


FEW = (
    *("double_pendulum_continuous", "borinot_flying_arm_2", "so101", "ur5_robot", "xarm7"),
    *("panda#panda_hand", "solo12#FL_FOOT", "simple_humanoid#l_wrist"),
)
"""What `make test` has: joints that turn on, short and long arms, and one each with a gripper, legs, arms."""


def named(arm: str) -> str:
    """A short name of an arm."""
    return arm.rpartition("/")[2].replace(".urdf", "")


def some(arms: tuple[str, ...]) -> list[ParameterSet]:
    """Arms as parameters of a test, those of `FEW` quick."""
    return [pytest.param(arm, marks=() if named(arm) in FEW else pytest.mark.slow) for arm in arms]


def pinocchio_of(arm: str, joints: list[str]) -> tuple:
    """Pinocchio's model of these joints, all others locked at 0."""
    whole = pin.buildModelFromUrdf(str(ROBOTS / arm.partition("#")[0]))
    others = [k for k in range(1, whole.njoints) if whole.names[k] not in joints]
    model = pin.buildReducedModel(whole, others, pin.neutral(whole)) if others else whole
    assert joints == list(model.names)[1:]
    return model, model.createData()


def deviation(arm: str, states: int) -> float:
    """The largest difference to Pinocchio over some motions, relative to the largest entry."""
    rng = np.random.default_rng(5)
    chain = read_arm(ROBOTS / arm)
    model, data = pinocchio_of(arm, [joint.name for joint in chain.joints])
    found, worst = recursion(chain), 0.0
    for _ in range(states):
        q, v, a = (rng.normal(size=len(chain.joints)) * scale for scale in (2, 3, 5))
        # A continuous joint has cosine and sine there.
        torques = pin.rnea(model, data, pin.integrate(model, pin.neutral(model), q), v, a)
        wrenches = np.array([data.f[k + 1].vector for k in range(len(q))])
        for mine, theirs in zip(ours(found, q, v, a), (torques, wrenches), strict=True):
            worst = max(worst, float(np.max(np.abs(mine - theirs)) / np.max(np.abs(theirs))))
    return worst


@pytest.mark.parametrize("arm", some(SERIAL), ids=named)
def test_a_serial_arm_is_that_of_pinocchio(arm: str) -> None:
    """Torques and joint wrenches of every serial arm of example-robot-data, to 1e-12."""
    assert deviation(arm, 2) < AGREE


@pytest.mark.parametrize("arm", some(BRANCHED), ids=named)
def test_an_arm_up_to_its_tip_is_that_of_pinocchio(arm: str) -> None:
    """With the last link named, all joints off the way to it are locked at 0, as Pinocchio locks them."""
    assert deviation(arm, 1) < AGREE


@pytest.mark.parametrize(("arm", "link"), IMPOSSIBLE.items(), ids=map(named, IMPOSSIBLE))
def test_an_arm_with_an_impossible_link_is_refused(arm: str, link: str) -> None:
    """Where one principal moment exceeds the sum of the others, the link is named."""
    root = etree.parse(ROBOTS / arm.partition("#")[0]).getroot()
    (given,) = (x.attrib for x in root.findall(f"link[@name='{link}']/inertial/inertia"))
    rows = [[float(given["i" + "".join(sorted(i + k))]) for k in "xyz"] for i in "xyz"]
    first, second, third = np.linalg.eigvalsh(np.array(rows))
    assert third > first + second

    with pytest.raises(InputError, match=f"link '{link}': inertia: expected principal moments of which none"):
        read_arm(ROBOTS / arm)


def readable(path: Path) -> bool:
    """Whether a file is an arm without naming its tip; what is refused is so in one line."""
    try:
        read_arm(path)
    except InputError as error:
        return "\n" in str(error)
    return True


@pytest.mark.slow
def test_no_serial_arm_is_left_out() -> None:
    """Every file of the package that is read without naming a tip is in the list."""
    read = [str(path.relative_to(ROBOTS)) for path in sorted(ROBOTS.rglob("*.urdf")) if readable(path)]

    assert sorted(SERIAL) == sorted(read)
