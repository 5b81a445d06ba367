"""The record of a planted effect (where it acts, its law), and the inputs of its builder."""

from collections.abc import Callable
from dataclasses import dataclass
from math import hypot, inf, pi

import numpy as np

from eccentric.core import InputError
from eccentric.virtual_bench.plant import Motion, Plant

Law = Callable[[Motion, float], float]
"""(motion, amplitude) -> value at the port."""

PORTS = {
    "dry": "level added to the Coulomb friction, which remains set-valued [N m]",
    "viscous": "coefficient added to the viscous friction [N m s/rad]",
    "rise": "level added to the Coulomb friction near rest, where no film carries [N m]",
    "drag": "coefficient of a drag without contact: air, churned oil, eddy currents [N m s/rad]",
    "warm dry": "relative change of all Coulomb friction, that of other effects included",
    "warm viscous": "relative change of all viscous friction, that of other effects included",
    "warm rise": "relative change of all that is added near rest",
    "torque": "torque against the motor [N m]",
    "flux": "relative change of the torque constant, and of the back-EMF constant: power is conserved",
    "inertia": "inertia beyond the declared one, constant over a log [kg m^2]",
    "drop": "voltage lost in the armature circuit beyond R i + k_e w [V]",
    "current": "added to the logged current only [A]",
    "delay": "delay of the logged current [s]",
    "angle": "added to the motor angle that the drive reads [rad]",
    "link angle": "added to mu theta_m, the angle of the link [rad]",
    "link ratio": "its slope over the motor angle, added to mu",
    "link bend": "the slope of that over the motor angle [1/rad]",
}


@dataclass(frozen=True)
class PlantSetting:
    """Scales for a builder: the plant and approximate magnitudes of the log's signals (motor side)."""

    plant: Plant
    friction: float  # rms friction torque [N m]
    speed: float  # rms speed [rad/s]
    top_speed: float  # [rad/s]
    current: float  # rms current [A]
    warming: float  # expected rise of the temperature [K], at least 1
    seconds: float  # length of the log
    loss: float  # mean heat dissipated in the drive [W]


@dataclass(frozen=True)
class Request:
    """One effect to build: its strength (rms over the friction's), and `rng` to draw its shape from."""

    strength: float
    variant: str  # "" where the family has none
    chosen: bool  # was the variant given, or drawn?
    setting: PlantSetting
    rng: np.random.Generator

    @property
    def plant(self) -> Plant:
        """The rig that the effect acts on."""
        return self.setting.plant

    def torque(self, factor: float = 1.0) -> float:
        """Return `factor` times the strength times the rms friction torque [N m]."""
        return factor * self.strength * self.setting.friction

    @property
    def motor_torque(self) -> float:
        """Rms of k_i i and of the back-EMF's k_i k_e w/R, added in squares [N m]."""
        plant = self.plant
        return plant.k_i * hypot(self.setting.current, plant.k_e * self.setting.speed / plant.R)

    def draw(self, low: float, high: float) -> float:
        """Return a random number between `low` and `high` to three significant digits."""
        return float(f"{self.rng.uniform(low, high):.3g}")

    def phase(self) -> float:
        """Return a random angle in (-pi, pi] [rad], to two decimals."""
        return round(float(self.rng.uniform(-pi, pi)), 2)

    def require_case(self, case: str, effect: str, why: str) -> None:
        """Raise InputError unless the plant is of that case."""
        if self.plant.case != case:
            raise InputError(f"effect {effect}", f"case {case}", self.plant.case, why=f", since {why}")


@dataclass(frozen=True)
class PlantedEffect:
    """One effect beyond the paper's model.

    `start()` returns {port: law} with fresh memory; a law takes the motion and the amplitude and returns the
    value at its port (`PORTS`). `bound` limits the amplitude to what is physical. `form` is the law in
    symbols, `shape` holds its constants, `depends_on` the quantities that its residual follows.
    """

    family: str
    form: str
    amplitude: float
    start: Callable[[], dict[str, Law]]
    depends_on: tuple[str, ...]
    shape: tuple[float, ...] = ()
    strength: float = 0.0
    bound: float = inf
    variant: str = ""
    channel: str = "mechanical"
    needs_temperature: bool = False
    hides_temperature: bool = False

    @property
    def id(self) -> str:
        """Family with its variant, such as `link_harmonic_friction[n=3]`."""
        return f"{self.family}[{self.variant}]" if self.variant else self.family


Builder = Callable[[Request], PlantedEffect]


def simply(**ports: Law) -> Callable[[], dict[str, Law]]:
    """`start` of an effect without memory."""
    return lambda: dict(ports)


def sign(value: float) -> float:
    """Return -1, 0 or 1."""
    return float((value > 0.0) - (value < 0.0))
