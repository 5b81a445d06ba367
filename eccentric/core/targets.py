"""The targets that models are emitted for: all that help, `doctor` and messages say of them.

A target is a line here and a folder of its name in `eccentric/emission/backends`. The line is not there,
since to import `eccentric.emission` is to import SymPy, for which no help page waits.
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
