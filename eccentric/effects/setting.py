"""What the library of effects is made for: a case, known parameters, and the ranges that a log covers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Setting:
    """The rig and its log, as far as forms and ranges of effects depend on them.

    Attributes:
        case: "C1" (gravity perpendicular to the motion plane) or "C2" (parallel).
        mu: gear ratio.
        known: value of every known parameter by name, SI units.
        w_min: least speed of the motor worth telling from rest [rad/s], positive.
        w_max: highest speed seen [rad/s].
        current_max: largest current seen [A].
        duration_s: length of the log [s].
        mean_loss_W: mean of friction power and R i^2 [W], positive.
        temperature_mid: median of the logged temperature [degC]; None if it is not logged.
        channels: names of those logged: "current", "voltage", "temperature".
        friction: coefficients of a first fit of the paper's model, by column of its regressor: how much of
            the load on a gear is friction of the link is told from it.
        by_voltage: whether voltage alone measures the torque: resistance and back-EMF constant are open then,
            and no current sensor shows.
        scaled: whether a declared constant makes the torque, k_i from a current or R/k_i from a voltage.
        left_open: what the rig leaves to the log, among others "J_m", "gravity", "theta_zero_rad".

    Raises:
        ValueError: the case is unknown, or a range is not positive.
    """

    case: str
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

    def __post_init__(self) -> None:
        if self.case not in {"C1", "C2"}:
            raise ValueError(f"setting: case must be C1 or C2, not {self.case!r}")
        for name in ("mu", "w_min", "w_max", "current_max", "duration_s", "mean_loss_W"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"setting: {name} must be positive, not {getattr(self, name)}")

    def has(self, *channels: str) -> bool:
        """Whether all of these channels are logged."""
        return set(channels) <= self.channels
