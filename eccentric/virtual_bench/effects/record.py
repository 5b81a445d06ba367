"""The record of one effect: where it acts, what it depends on, and its law."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, pi
from typing import TYPE_CHECKING

import numpy as np

from eccentric.errors import InputError

if TYPE_CHECKING:
    from eccentric.virtual_bench.motion import Motion
    from eccentric.virtual_bench.plant import Plant

Law = Callable[["Motion", float], float]  # (motion, amplitude) -> what the port says

PORTS = {
    "dry": "level added to the Coulomb friction, which stays set-valued [N m]",
    "viscous": "coefficient added to the viscous friction [N m s/rad]",
    "torque": "torque against the motor [N m]",
    "inertia": "inertia beyond the declared one, constant over a log [kg m^2]",
    "drop": "voltage lost in the armature circuit beyond R i + k_e w [V]",
    "current": "added to the logged current only [A]",
    "delay": "time by which the logged current is late [s]",
}


@dataclass(frozen=True)
class Setting:
    """What a builder may scale by: the plant and rough sizes of what the log will contain (motor side)."""

    plant: Plant
    friction: float  # rms friction torque [N m]
    speed: float  # rms speed [rad/s]
    top_speed: float  # [rad/s]
    current: float  # rms current [A]
    warming: float  # expected rise of the temperature [K]
    seconds: float
    loss: float = 0.0  # mean of what the drive turns into heat [W]

    def need(self, case: str, family: str, why: str) -> None:
        """Raise InputError unless the plant is of that case."""
        if self.plant.case != case:
            raise InputError(f"effect {family}: needs case {case}, since {why}; got case {self.plant.case}")


@dataclass
class Effect:
    """One effect beyond the paper's model.

    `start()` returns {port: law} with fresh memory; a law takes the motion and the amplitude and gives what
    the port asks for (`PORTS`). `bound` limits the amplitude to what is physical. `form` says it in symbols,
    `shape` holds its constants, `depends_on` the quantities that its residual follows.
    """

    family: str
    form: str
    amplitude: float
    start: Callable[[], dict[str, Law]]
    depends_on: tuple[str, ...]
    shape: tuple[float, ...] = ()
    strength: float = 0.0
    bound: float = inf
    variant: str | None = None
    channel: str = "mechanical"
    needs_temperature: bool = False
    hides_temperature: bool = False

    @property
    def id(self) -> str:
        """Family with its variant, such as `link_harmonic_friction[n=3]`."""
        return f"{self.family}[{self.variant}]" if self.variant else self.family


Builder = Callable[[float, np.random.Generator, Setting, str | None], Effect]


def simply(**ports: Law) -> Callable[[], dict[str, Law]]:
    """`start` of an effect without memory."""
    return lambda: dict(ports)


def choose(family: str, variant: str | None, variants: tuple[str, ...], rng: np.random.Generator) -> str:
    """Return the variant asked for, or one drawn from `variants`; InputError if it is none of them."""
    drawn = str(rng.choice(variants))
    if variant is not None and variant not in variants:
        raise InputError(f"effect {family}: required a variant of {', '.join(variants)}; got {variant}")
    return variant or drawn


def phase(rng: np.random.Generator) -> float:
    """Return a random angle in (-pi, pi] [rad], to two decimals."""
    return round(float(rng.uniform(-pi, pi)), 2)


def draw(rng: np.random.Generator, low: float, high: float) -> float:
    """Return a number between `low` and `high` to three significant digits."""
    return float(f"{rng.uniform(low, high):.3g}")


def sign(value: float) -> float:
    """Return -1, 0 or 1."""
    return float((value > 0.0) - (value < 0.0))
