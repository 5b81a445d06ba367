"""What the log says of R, k_e, k_i, inertia and gravity, over what the rig says: each a ratio.

The armature obeys u = R i + k_e w, the rotor k_i i = J dw/dt + M g L sin(theta) + friction, and k_i = k_e in
SI. A wrong scale of the current shows in R and in the torque balance, but not in k_e; a wrong k_i in the
torque balance alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from eccentric.signals.quality.body import Means, RigidBody, friction_of, is_clear, regressed
from eccentric.signals.quality.declared import gravity_of, inertia_of, torque_per_unit
from eccentric.signals.quality.limits import (
    AGREES,
    EXPLAINED,
    FACTOR_MOTOR,
    IDEAL,
    LEAST_OHM,
    NEAR,
    NOTICED,
    SIGMAS,
)

if TYPE_CHECKING:
    from eccentric.rigs import Rig

__all__ = ["Ratio", "constant_by_torque", "electrical", "mechanical", "motor_constant"]

_UNITS = {
    "J": "kg m^2", "M g L": "N m", "k_e": "V s/rad", "R": "ohm", "k_i": "N m/A",
}  # fmt: skip
_CALLED = {"M g L": "mu M g L"}
"""The torque that is compared: gravity at the motor."""


@dataclass(frozen=True)
class Ratio:
    """A quantity from the log over that from the rig; `low` to `high` is its uncertainty.

    `found` is that of the log in SI, `unit` its unit; `letter` is what it belongs to in a rig file; `agrees`
    is the factor beyond the uncertainty up to which the rig's value is not doubted.
    """

    name: str
    value: float
    low: float
    high: float
    text: str
    found: float
    unit: str
    agrees: float = AGREES

    @classmethod
    def of(cls, name: str, found: float, error: float, given: float, text: str = "") -> Ratio:
        """Make one from the value in the log, its uncertainty, and the value in the rig, in SI."""
        unit = _UNITS[name.removesuffix(" by gravity")]
        called = _CALLED.get(name, name)
        said = text or f"{called} is {found:.3g} {unit} by the log and {given:.3g} by the rig"
        return cls(name, found / given, (found - error) / given, (found + error) / given, said, found, unit)

    @property
    def letter(self) -> str:
        """The letter, or the product of letters, that is in question."""
        return self.name.removesuffix(" by gravity")

    def off(self, factor: float) -> bool:
        """Return whether log and rig differ by more than this factor, whatever the uncertainty."""
        return self.low > factor or self.high < 1.0 / factor

    @property
    def doubts_the_rig(self) -> bool:
        """Whether the log determines the quantity, and the rig's value is clearly another one."""
        return self.low > 0.0 and self.off(self.agrees)

    def near(self, factor: float) -> bool:
        """Return whether the factor explains the ratio, or is within its uncertainty."""
        close = self.value > 0.0 and abs(math.log(self.value / factor)) <= NEAR
        return close or self.low <= factor <= self.high


def electrical(m: Means, rig: Rig) -> Iterator[Ratio]:
    """Yield k_e and R by the armature's u = R i + k_e w, over those of the rig."""
    found = _armature(m)
    if found is None:
        return
    (r, r_error), (e, e_error) = found
    if "R" in rig.known:
        yield replace(Ratio.of("R", r, r_error, rig.known["R"]), agrees=FACTOR_MOTOR)
    elif 0.0 < r + r_error < LEAST_OHM:
        # Against nothing but what windings have: the next larger unit of a current is the only reading.
        text = f"R is {r:.3g} ohm by the log, less than the windings of such drives have"
        yield Ratio.of("R", r, r_error, 1e3 * r, text)
    if "k_e" not in rig.known:
        return
    if "R" in rig.known and abs(r - rig.known["R"]) <= r_error:
        # With an R that the log allows, k_e is also known where current and speed are correlated.
        rest = m.drives["voltage"] - rig.known["R"] * m.drives["current"]
        a, covariance, _ = regressed(friction_of(m), rest)
        e, e_error = a[0], math.sqrt(covariance[0, 0]) * SIGMAS
    yield replace(Ratio.of("k_e", e, e_error, rig.known["k_e"]), agrees=FACTOR_MOTOR)


def mechanical(body: RigidBody, drive: str, rig: Rig) -> Iterator[Ratio]:
    """Yield inertia and gravity of the drive over those of the rig."""
    scale = torque_per_unit(drive, rig)
    if scale is None:
        return
    if inertia := inertia_of(rig):
        value, error = body.inertia
        if max(abs(value), inertia / scale) * body.alpha >= NOTICED * body.drive:
            yield Ratio.of("J", scale * value, scale * error * SIGMAS, inertia)
    if gravity := gravity_of(rig):
        value, error = body.gravity
        yield Ratio.of("M g L", scale * value, scale * error * SIGMAS, gravity)


def motor_constant(m: Means, body: RigidBody, drive: str, rig: Rig) -> Iterator[Ratio]:
    """Yield k_i where it differs from k_e by the voltage, or from a range, by more than motors do."""
    back_emf = _armature(m)
    if "k_i" in rig.known:
        if back_emf is None or any(r.near(1.0) for r in mechanical(body, drive, rig)):
            return
        e, error = back_emf[1]
        given = rig.known["k_i"]
        text = f"k_i is {e:.3g} N m/A by the voltage (in SI it equals k_e) and {given:.3g} by the rig"
        found = Ratio.of("k_i", e, error, given, text)
    elif "k_i" in rig.unknown and drive == "current" and (by_torque := _by_torque(body, rig)):
        k, error, source = by_torque
        if back_emf is not None and is_clear(back_emf[1][0], back_emf[1][1] / SIGMAS):
            e = back_emf[1][0]
            text = f"k_i is {k:.3g} N m/A by {source} and {e:.3g} by the voltage (in SI it equals k_e)"
            found = Ratio.of("k_i by gravity", k, error, e, text)
        else:
            low, high = rig.unknown["k_i"]
            # A thousand times as much is in the range: the current is in mA, as far as a range can say it.
            end = 1e3 * k if k < low <= 1e3 * k <= high else low if k < low else high
            text = f"k_i is {k:.3g} N m/A by {source}, outside {low:g} to {high:g} by the rig"
            found = Ratio.of("k_i by gravity", k, error, end, text)
            if low <= k <= high:
                return
    else:
        return
    if found.off(IDEAL):
        yield found


def constant_by_torque(body: RigidBody, drive: str, rig: Rig) -> Iterator[Ratio]:
    """Yield the k_i that makes gravity, else inertia, the rig's, over that of the rig."""
    if drive == "current" and "k_i" in rig.known and (by_torque := _by_torque(body, rig)):
        k, error, source = by_torque
        given = rig.known["k_i"]
        yield Ratio.of("k_i", k, error, given, f"k_i is {k:.3g} N m/A by {source} and {given:.3g} by the rig")


def _armature(m: Means) -> tuple[tuple[float, float], tuple[float, float]] | None:
    """Return R and k_e by u = R i + k_e w, each with its uncertainty; None if that does not hold."""
    if not {"voltage", "current"} <= set(m.drives):
        return None
    a, covariance, explained = regressed([m.drives["current"], *friction_of(m)], m.drives["voltage"])
    if explained < EXPLAINED:
        return None
    r, e = ((float(a[k]), math.sqrt(covariance[k, k]) * SIGMAS) for k in range(2))
    return r, e


def _by_torque(body: RigidBody, rig: Rig) -> tuple[float, float, str] | None:
    """Return k_i for which gravity, else inertia, is the rig's: value, uncertainty, and which of them."""
    for given, (value, error), source in (
        (gravity_of(rig), body.gravity, "gravity"),
        (inertia_of(rig), body.inertia, "inertia"),
    ):
        if given and is_clear(value, error) and value > 0.0:
            return given / value, given / value**2 * error * SIGMAS, source
    return None
