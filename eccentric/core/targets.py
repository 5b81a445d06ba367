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
    """

    meaning: str
    default: bool = False
    extra: str = ""
    packages: tuple[str, ...] = ()


TARGETS: Mapping[str, Target] = {
    "numpy": Target("NumPy module", default=True),
    "c99": Target("C99 header and source", default=True),
    "jax": Target("JAX module", extra="jax", packages=("jax",)),
}
"""Name, as in `--backend` and the name of its folder -> target."""

EXPORTS: Mapping[str, Target] = {
    "mjcf": Target("MuJoCo model: a pendulum whose joint has the friction"),
    "budget": Target("Python module that writes the friction into MuJoCo before each step"),
    "urdf": Target("URDF: damping and friction of a joint"),
    "usd": Target("USD with the attributes of Newton: friction, damping, armature"),
    "bam": Target("parameters for BAM, its model M1"),
    "newton": Target("drive component for Newton, in Warp"),
    "fmu": Target("FMU in source: FMI 3.0, co-simulation"),
}
"""Name, as in `--to` and the name of its file -> target."""
