"""Explanations of a quantity that differs by a factor between log and rig: mostly units."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from eccentric.signals.quality.limits import DIRECT, LEVEL_PLANE, NEAR, REDUCED

if TYPE_CHECKING:
    from collections.abc import Sequence

TURN = 2.0 * math.pi
UNITS = {
    "J": "kg m^2", "M g L": "N m at the motor", "k_e": "V s/rad", "R": "ohm",
}  # fmt: skip


@dataclass(frozen=True)
class Ratio:
    """A quantity from the log over that from the rig; `low` to `high` is its uncertainty."""

    name: str
    value: float
    low: float
    high: float
    text: str

    @classmethod
    def of(cls, name: str, found: float, error: float, given: float) -> Ratio:
        """Make one from the value in the log, its uncertainty, and the value in the rig, in SI."""
        text = f"{name} is {found:.3g} {UNITS[name]} by the log and {given:.3g} by the rig"
        return cls(name, found / given, (found - error) / given, (found + error) / given, text)

    def off(self, factor: float) -> bool:
        """Return whether log and rig differ by more than this factor, whatever the uncertainty."""
        return self.low > factor or self.high < 1.0 / factor

    def near(self, factor: float) -> bool:
        """Return whether the factor explains the ratio, or is within its uncertainty."""
        close = self.value > 0.0 and abs(math.log(self.value / factor)) <= NEAR
        return close or self.low <= factor <= self.high


@dataclass(frozen=True)
class Cause:
    """A wrong unit: kind and channel of its finding, its text, and the ratios that it causes (others: 1)."""

    kind: str
    channel: str
    text: str
    ratios: dict[str, float]


ANGLES = {"is in deg": 360.0 / TURN, "is in rev": 1.0 / TURN}
SPEEDS = {"is in rpm": 60.0 / TURN, "is in deg/s": 360.0 / TURN, "is in rev/s": 1.0 / TURN}
"""Possible units of the angle, or of the speed if no angle is logged, with their factors to SI."""


def common_cause(ratios: Sequence[Ratio], drive: str, mu: float | None, angle: bool) -> Cause | None:
    """Return the one wrong unit or scale that explains all ratios; None if there is none.

    One ratio alone has many causes: at least two must be off consistently. `angle`: whether one is logged.
    """
    for cause in _causes(drive, mu, angle):
        made = [ratio for ratio in ratios if ratio.name in cause.ratios]
        if len(made) > 1 and all(ratio.near(cause.ratios.get(ratio.name, 1.0)) for ratio in ratios):
            return cause
    moved = {ratio.name: ratio for ratio in ratios}
    if {"J", "M g L"} <= set(moved) and (scale := moved["J"].value) > 0.0 and moved["M g L"].near(scale):
        rest = [ratio for ratio in ratios if ratio.name not in ("J", "M g L")]
        if all(ratio.near(1.0) for ratio in rest) and not moved["J"].near(1.0):
            text = f"the scale of the {drive}, or k_i, is off by a factor of {scale:.3g}"
            return Cause("contradiction", "k_i", text, {})
    return None


def _causes(drive: str, mu: float | None, angle: bool) -> list[Cause]:
    channel, name, units = ("theta_m", "angle", ANGLES) if angle else ("omega_m", "speed", SPEEDS)
    if mu is not None and not DIRECT[0] < mu < DIRECT[1]:
        sides = {"is the link's, mapped as the motor's": mu, "is the motor's, mapped as the link's": 1.0 / mu}
        units = units | sides
    causes = [
        Cause("wrong_unit", channel, f"the {name} {words}", {"J": 1.0 / f, "k_e": 1.0 / f})
        for words, f in units.items()
    ]
    causes += [
        Cause("wrong_unit", "time", f"the time is in {unit}", {"J": f * f, "k_e": f})
        for unit, f in (("ms", 1e3), ("us", 1e6))
    ]
    for factor, prefix in ((1e3, "m"), (1e-3, "k")):
        causes += [
            Cause(
                "wrong_unit",
                "current",
                f"the current is in {prefix}A",
                {"R": 1.0 / factor} | ({"J": factor, "M g L": factor} if drive == "current" else {}),
            ),
            Cause(
                "wrong_unit",
                "voltage",
                f"the voltage is in {prefix}V",
                {"R": factor, "k_e": factor} | ({"J": factor, "M g L": factor} if drive == "voltage" else {}),
            ),
        ]
        if drive == "torque":
            both = {"J": factor, "M g L": factor}
            causes.append(Cause("wrong_unit", "torque", f"the torque is in {prefix}N m", both))
    return causes  # fmt: skip


_SINGLE = {
    "k_e": {
        1.0 / TURN: "the rig's is in V s/rev", 60.0 / TURN: "the rig's is in V/rpm",
        0.06 / TURN: "the rig's is in V/krpm", 1e-3: "the rig's is in mV s/rad",
        TURN: "the rig's is divided by 2 pi once too often",
    },
    "R": {1e-3: "the rig's is in mohm", 2.0: "the rig's is of one phase, the log's of two",
          0.5: "the rig's is of two phases, the log's of one"},
    "J": {1e-4: "the rig's is in kg cm^2", 1e-7: "the rig's is in g cm^2", 1e-3: "the rig's is in g m^2"},
    "M g L": {1e-3: "the rig's mass is in g or its length in mm", 1e-2: "the rig's length is in cm"},
}  # fmt: skip


def single_cause(ratio: Ratio, drive: str, mu: float | None) -> str:
    """Return the explanation of one ratio, in brackets, empty if there is none."""
    causes = dict(_SINGLE[ratio.name])
    if ratio.name == "J" and mu is not None and mu < REDUCED:
        causes |= {mu**2: "the rig's J_m is at the link", 1.0 / mu**2: "the rig's J_l is at the motor"}
    if ratio.name == "M g L" and ratio.high < LEVEL_PLANE:
        return " (is the plane of motion horizontal, case C1?)"
    near = {math.inf: ""}
    if ratio.value > 0.0:
        near |= {abs(math.log(ratio.value / factor)): words for factor, words in causes.items()}
    best = min(near)
    if best <= NEAR:
        return f" ({near[best]}?)"
    # Gravity is the larger part of a torque; an inertia off by the same factor may not show.
    return " (or is k_i off by this factor?)" if ratio.name == "M g L" and drive == "current" else ""
