"""The targets that models are emitted for and exported to: all that help, `doctor` and messages say of them.

A target of `emit` is a line here and a folder of its name in `eccentric/emission/backends`, one of `export` a
line and a file of its name in `eccentric/exports`. The lines are not there, since to import those rooms is to
import SymPy, for which no help page waits.
"""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Target:
    """One target.

    Attributes:
        meaning: what is written, for a list of targets.
        default: whether it is written if none is asked for.
        extra, packages: extra of the toolkit that brings what runs the files, and its packages; emission
            itself needs none of them.
        others: names that people look for it by.
    """

    meaning: str
    default: bool = False
    extra: str = ""
    packages: tuple[str, ...] = ()
    others: tuple[str, ...] = ()


TARGETS: Mapping[str, Target] = {
    "numpy": Target("NumPy module", default=True),
    "c99": Target("C99 header and source", default=True),
    "jax": Target("JAX module", extra="jax", packages=("jax",)),
}
"""Name, as in `--backend` and the name of its folder -> target."""

EXPORTS: Mapping[str, Target] = {
    "mjcf": Target("MuJoCo model: a pendulum whose joint has the friction", others=("mujoco", "xml")),
    "budget": Target(
        "Python module that writes the friction into MuJoCo before each step",
        others=("mujoco", "mujoco-warp", "mujoco_warp", "mjwarp"),
    ),
    "urdf": Target("URDF: damping and friction of a joint", others=("ros", "gazebo")),
    "usd": Target(
        "USD with the attributes of Newton: friction, damping, armature",
        others=("usda", "isaac", "isaaclab", "isaacsim"),
    ),
    "bam": Target("parameters for BAM's model M1", others=("m1",)),
    "newton": Target("drive component for Newton, in Warp", others=("warp",)),
    "fmu": Target("source-code FMU, FMI 3.0 co-simulation", others=("fmi", "modelica", "simulink")),
}
"""Name, as in `--to` and the name of its file -> target."""
