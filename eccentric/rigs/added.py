"""A known mass that some runs carry besides the rig's own: what it does to a drive calibrates it.

Reference: M. Gautier, S. Briot, "Global identification of joint drive gains and dynamic parameters of
robots", ASME J. Dynamic Systems, Measurement, and Control 136(5), 2014.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from eccentric.errors import InputError
from eccentric.rigs.entries import read_table
from eccentric.rigs.known import KNOWNS, read_value

__all__ = ["AddedMass", "read_added", "read_mass"]

_MASS = next(known for known in KNOWNS if known.name == "M")


@dataclass(frozen=True)
class AddedMass:
    """A point mass [kg] at the place of the one on the link."""

    mass: float

    def on(self, values: Mapping[str, float]) -> dict[str, float]:
        """M and J_l of the link with it, from those without; KeyError without M or L."""
        inertia = values.get("J_l", 0.0) + self.mass * values["L"] ** 2
        return {"M": values["M"] + self.mass, "J_l": inertia}


def read_added(content: Mapping[str, Any], where: str, known: Mapping[str, float]) -> dict[str, AddedMass]:
    """The masses by the run, or pattern of runs, that carries them.

    Raises InputError for anything but a mass, and for one without M and L in [known].
    """
    table = read_table(content.get("added", {}), f"{where}: [added]")
    if table and (missing := sorted({"M", "L"} - set(known))):
        raise InputError(
            f"{where}: [known] {' and '.join(missing)} {'are' if len(missing) > 1 else 'is'} required with"
            " [added], received none"
        )
    return {run: AddedMass(read_mass(value, f"{where}: [added] {run}")) for run, value in table.items()}


def read_mass(value: object, where: str) -> float:
    """A mass [kg] from a text with a unit. InputError for anything else, and for none."""
    mass = read_value(value, _MASS, "mass", where)
    if mass == 0.0:
        raise InputError(f"{where}: a mass above 0 kg is required, received {value!r}")
    return mass
