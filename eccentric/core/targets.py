"""Emission and export targets, as described by help, `doctor` and messages.

An `emit` target is an entry here and a folder of its name in `eccentric/emission/backends`, an `export`
target an entry and a file of its name in `eccentric/exports`. The entries are here because importing those
rooms imports SymPy, which is too slow for a help page.
"""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Target:
    """One target.

    Attributes:
        meaning: description for a list of targets.
        default: whether it is written when no target is requested.
        extra, packages: the toolkit's extra that installs the packages needed to run the files; emission
            itself needs none.
        others: other names people search for.
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
