"""What the library of effects depends on: a case, known parameters, and the ranges that a log covers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from eccentric.model import Model


@dataclass(frozen=True)
class Setting:
    """The rig and its log, as far as forms and ranges of effects depend on them.

    Attributes:
        base: the model that the effects extend.
        mu: gear ratio.
        known: value of every known parameter by name, SI units.
        w_min: lowest motor speed that counts as motion [rad/s], positive.
        w_max: highest speed seen [rad/s].
        current_max: largest current seen [A].
        duration_s: length of the log [s].
        mean_loss_W: mean of friction power and R i^2 [W], positive.
        temperature_mid: median of the logged temperature [degC]; None if it is not logged.
        channels: those logged, among "current", "voltage", "temperature".
        friction: coefficients of an earlier fit of that model, by column of its regressor; they determine how
            much of the load on a gear is friction of the link.
        by_voltage: whether voltage alone measures the torque: then resistance and back-EMF constant are not
            separately known, and no current sensor has an effect.
        scaled: whether a declared constant converts to torque: k_i from a current, or R/k_i from a voltage.
        mean_force: mean of F_N [N] where it is an input of the model, as of a joint of an arm; else 0.
        left_open: what the rig leaves to be identified: roles of columns, among others "inertia" and
            "gravity", and keys of the rig's alignment, such as "theta_zero_rad".
        mean_square_A2: mean square of the current [A^2]; 0 where nobody asks for it.
        turns: range of the motor angle over the log, in turns.
        orders: periods per turn of the motor that stand out in what a first fit leaves, the strongest first.
        masses: whether runs carry different known masses: their difference is in newton metres for certain.

    Raises:
        ValueError: a range is not positive.
    """

    base: Model = field(repr=False)
    mu: float
    known: Mapping[str, float]
    w_min: float
    w_max: float
    current_max: float
    duration_s: float
    mean_loss_W: float
    temperature_mid: float | None = None
    channels: frozenset[str] = frozenset({"current", "voltage"})
    friction: Mapping[str, float] = field(default_factory=dict)
    by_voltage: bool = False
    scaled: bool = True
    left_open: tuple[str, ...] = ()
    mean_force: float = 0.0
    mean_square_A2: float = 0.0
    turns: float = 0.0
    orders: tuple[float, ...] = ()
    masses: bool = False

    def __post_init__(self) -> None:
        for name in ("mu", "w_min", "w_max", "current_max", "duration_s", "mean_loss_W"):
            if not getattr(self, name) > 0.0:
                raise ValueError(
                    f"setting: {name}: a value above 0 is required, received {getattr(self, name)}"
                )

    @property
    def case(self) -> str:
        """The case of the base model: "C1" if gravity does not drive it, else "C2"."""
        return "C1" if self.base.balance("mechanical").sum_of("gravity") == 0 else "C2"

    @property
    def link_radian(self) -> str:
        """The unit of an angle of the link, or of the screw of a carriage, which is never one of length."""
        return "rad" if self.base.axis.wraps else "radian"

    @property
    def measured_twice(self) -> bool:
        """Whether the circuit is a balance of its own: a voltage beside the measured current."""
        return self.has("current", "voltage") and not self.by_voltage

    def has(self, *channels: str) -> bool:
        """Whether all of these channels are logged."""
        return set(channels) <= self.channels
