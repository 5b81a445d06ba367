"""The record of a planted effect (ports and laws), its builder's inputs, and checks of requests."""

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from math import hypot, inf, pi
from typing import Any

import numpy as np

from eccentric.core import InputError, meant
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

    family: str
    strength: float
    variant: str  # "" where the family has none
    chosen: bool  # whether the variant was requested, not drawn
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
        """Root sum of squares of the rms of k_i i and of the back-EMF's k_i k_e w/R [N m]."""
        plant = self.plant
        return plant.k_i * hypot(self.setting.current, plant.k_e * self.setting.speed / plant.R)

    def draw(self, low: float, high: float) -> float:
        """Return a random number between `low` and `high` to three significant digits."""
        return float(f"{self.rng.uniform(low, high):.3g}")

    def phase(self) -> float:
        """Return a random angle in (-pi, pi] [rad], to two decimals."""
        return round(float(self.rng.uniform(-pi, pi)), 2)

    def effect(
        self,
        form: str,
        amplitude: float,
        start: Callable[[], dict[str, Law]],
        depends_on: tuple[str, ...],
        shape: tuple[float, ...] = (),
        **others: Any,
    ) -> "PlantedEffect":
        """Return the requested effect with this law; `others` are further fields of `PlantedEffect`."""
        fields = {"strength": self.strength, "variant": self.variant, **others}
        return PlantedEffect(self.family, form, amplitude, start, depends_on, shape, **fields)

    def require_case(self, case: str, effect: str, why: str) -> None:
        """Raise InputError unless the plant is of that case."""
        if self.plant.case != case:
            raise InputError(f"effect {effect}", f"case {case}", self.plant.case, why=f", since {why}")


@dataclass(frozen=True)
class PlantedEffect:
    """One effect beyond the paper's model.

    `start()` returns {port: law} with fresh memory; a law takes the motion and the amplitude and returns the
    value at its port (`PORTS`). `bound` is the physical limit of the amplitude. `form` is the law in symbols,
    `shape` its constants, `depends_on` the quantities that its residual depends on.
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


Requested = Sequence[str | tuple[str, float]] | Mapping[str, float]
"""Effects by name, each with or without its strength."""


def with_strengths(effects: Requested, strength: float) -> list[tuple[str, Any]]:
    """Return the names with their strengths; InputError for anything else."""
    if isinstance(effects, str) or not isinstance(effects, Sequence | Mapping):
        raise InputError("effects", "a list of names or of (name, strength)", f"{effects!r}")
    every = effects.items() if isinstance(effects, Mapping) else effects
    pairs = [(one, strength) if isinstance(one, str) else one for one in every]
    for pair in pairs:
        if not isinstance(pair, tuple | list) or len(pair) != 2:
            raise InputError("effects", "names or (name, strength)", f"{pair!r}")
    return [(str(name), size) for name, size in pairs]


def check_values(
    choices: Mapping[str, tuple[object, Collection[object]]],
    ranges: Mapping[str, tuple[object, float, float]],
) -> None:
    """Raise InputError unless every value is one of its choices, or a number in its range."""
    for quantity, (value, allowed) in choices.items():
        if value not in allowed:
            raise InputError(quantity, " or ".join(map(str, allowed)), value)
    for quantity, (value, low, high) in ranges.items():
        if not _within(value, low, high):
            raise InputError(quantity, f"{low:g} to {high:g}", f"{value!r}")


def check_strength(name: str, size: object) -> None:
    """Raise InputError unless it is a number above 0 and at most 1."""
    if not _within(size, 0.0, 1.0) or size == 0.0:
        raise InputError(f"effect {name}", "a strength above 0 and at most 1", f"{size!r}")


def _within(value: object, low: float, high: float) -> bool:
    """Whether it is a number in the range; False for NaN and booleans."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        return False
    return bool(low <= value <= high)


def known_family(
    name: str, match: re.Match[str] | None, families: Collection[str], variants: Mapping[str, Sequence[str]]
) -> tuple[str, str | None]:
    """Return family and variant of a name, the first two groups of its match.

    Raises InputError, listing the known effects, if the bench has no such effect.
    """
    if match is None or match[1] not in families:
        hint = meant(name.partition("@")[0], families)
        raise InputError(f"effect {name}", problem=f"expected one of {', '.join(families)}{hint}")
    family, variant = match[1], match[2]
    known = variants.get(family, ())
    if variant is not None and variant not in known:
        raise InputError(
            f"effect {family}", f"a variant of {', '.join(known)}" if known else "no variant", variant
        )
    return family, variant


def bearing_law(request: Request, weight: float) -> tuple[str, float, Callable[[float], float]]:
    """Return a law of F_N in symbols, its constant, and the law: with a preload across it, else a power."""
    if request.variant == "preload":
        force = request.draw(0.5, 1.5) * weight
        return "sqrt(F_N^2 + F_p^2)", force, lambda normal: hypot(normal, force)
    power = 2.0 / 3.0 if request.variant == "Hertz" else 1.55
    return f"F_0 (F_N/F_0)^{power:.3g}", power, lambda normal: weight * (normal / weight) ** power


def back_driven(request: Request) -> float:
    """Draw the loss of a gear when back-driven, over that when driving."""
    return request.draw(0.25, 0.5) if request.variant == "easy" else request.draw(1.8, 3.0)


def gear_loss(load: Callable[[Motion], float], back: float) -> Law:
    """Return the loss proportional to a load, times `back` when back-driven."""

    def dry(s: Motion, a: float) -> float:
        torque = load(s)
        return a * abs(torque) * (1.0 if torque * s.w_mid > 0.0 else back)

    return dry


def simply(**ports: Law) -> Callable[[], dict[str, Law]]:
    """`start` of an effect without memory."""
    return lambda: dict(ports)


def sign(value: float) -> float:
    """Return -1, 0 or 1."""
    return float((value > 0.0) - (value < 0.0))
