"""What the log says of R, k_e, k_i, inertia and gravity, over what the rig says: each a ratio.

The armature obeys u = R i + k_e w, the rotor k_i i = J dw/dt + M g L sin(theta) + friction, and k_i = k_e in
SI. A wrong scale of the current shows in R and in the torque balance, but not in k_e; a wrong k_i in the
torque balance alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.model import AxisKind, Model, load_model
from eccentric.model import vocabulary as v
from eccentric.signals.quality import limits

if TYPE_CHECKING:
    from eccentric.rigs import Rig
    from eccentric.signals.measured import Channels


# What the drive signal of a log says about its rig: a rigid body with Coulomb and viscous friction.
#
# On block means, this is not a model of the friction: it gives signs, and sizes to some per cent, whatever
# the delay and the noise.


Array = NDArray[np.float64]


@dataclass(frozen=True)
class Means:
    """Means of blocks, each (m,): motion at the motor, drives as logged.

    `link` is the angle of the link [rad] in the rows of each block (m, k), None if mu is unknown: a fast link
    turns far in a block, of which the mean of the sine is not the sine of the mean.
    """

    alpha: Array
    omega: Array
    link: Array | None
    drives: dict[str, Array]
    rows: int


@dataclass(frozen=True)
class RigidBody:
    """What a drive says about the rig, in its own unit: value and standard error.

    `explained` is the explained part of the drive's variance.
    `alpha` and `drive` are their rms about the mean.
    `inertia` multiplies alpha; `gravity` is the amplitude of gravity, `turned` the angle [rad] of its
    direction from down; `loss` is the mean power of friction [unit rad/s].
    """

    inertia: tuple[float, float]
    gravity: tuple[float, float]
    turned: float
    loss: tuple[float, float]
    explained: float
    alpha: float
    drive: float


def means_of(c: Channels, rig: Rig, *, moving: bool = True) -> Means | None:
    """Return the means of blocks of consecutive rows; None if there are too few.

    Args:
        c: as logged.
        rig: of the log.
        moving: whether only the moving rows of the fit count; the circuit holds at standstill as well.
    """
    motion, motor = c.motion, c.motor
    known = np.isfinite(motion.alpha_m) & np.isfinite(motion.omega_m)
    for carrying, _ in c.carried:  # J and M g L of the rig are those without it
        known = known & ~carrying
    rows = np.flatnonzero((c.selection.fit_rows if moving else True) & ~motor.off & known)
    steps = np.diff(c.time.t)[np.diff(c.time.segment) == 0]
    if not len(rows) or not len(steps):
        return None
    size = max(limits.MEAN_ROWS, math.ceil(limits.MEAN_S / float(np.median(steps))))
    pieces = np.split(rows, np.flatnonzero((np.diff(rows) != 1) | (np.diff(c.time.segment[rows]) != 0)) + 1)
    blocks = [piece[k : k + size] for piece in pieces for k in range(0, len(piece) - size + 1, size)]
    if len(blocks) < limits.LEAST_MEANS:
        return None
    index = np.array(blocks)
    found = {"current": motor.current, "torque": motor.torque, "voltage": motor.voltage}
    found = {} if motor.coasting else found
    mu = rig.known.get("mu")
    return Means(
        np.mean(motion.alpha_m[index], axis=1),
        np.mean(motion.omega_m[index], axis=1),
        None if mu is None else mu * motion.theta_m[index],
        {name: np.mean(x[index], axis=1) for name, x in found.items() if x is not None},
        index.size,
    )


def regressed(columns: list[Array], x: Array) -> tuple[Array, Array, float]:
    """Return coefficients, their covariance, and the explained part of the variance of x."""
    design = np.stack(columns, axis=1)
    scale = np.linalg.norm(design, axis=0)
    scale[scale == 0.0] = 1.0
    inverse = np.linalg.pinv(design / scale, rcond=limits.ROUNDING)
    solution = inverse @ x
    rest = x - design / scale @ solution
    variance = float(rest @ rest) / max(len(x) - design.shape[1], 1)
    # A column in the span of the others has no coefficient, whatever the pseudoinverse returns.
    lost = np.linalg.matrix_rank(design / scale, tol=limits.DEPENDENT) < design.shape[1]
    covariance = variance * (inverse @ inverse.T) + (np.inf if lost else 0.0)
    total = float(np.sum((x - np.mean(x)) ** 2))
    return (
        solution / scale,
        covariance / np.outer(scale, scale),
        1.0 - float(rest @ rest) / max(total, 1e-300),
    )


def friction_of(m: Means) -> list[Array]:
    """Return w, sgn(w), and a constant if both directions separate it from sgn(w); each (m,)."""
    sign = np.sign(m.omega)
    both = bool(np.any(sign > 0.0) and np.any(sign < 0.0))
    return [m.omega, sign, *([np.ones_like(sign)] if both else [])]


def body_of(m: Means, x: Array, link: Array | None) -> RigidBody:
    """Return what a drive x (m,) says about the rig, with the link angle (m, k) [rad] if it is known."""
    gravity = [] if link is None else [np.mean(f(link), axis=1) for f in (np.sin, np.cos)]
    columns = [m.alpha, *friction_of(m), *gravity]
    a, covariance, explained = regressed(columns, x)
    power = np.array([np.mean(m.omega**2), np.mean(np.abs(m.omega))])
    loss = float(power @ a[1:3]), math.sqrt(float(power @ covariance[1:3, 1:3] @ power))
    amplitude, turned, error = 0.0, 0.0, math.inf
    if link is not None:
        amplitude, turned = math.hypot(a[-2], a[-1]), math.atan2(a[-1], a[-2])
        error = math.sqrt(max(covariance[-2, -2], covariance[-1, -1]))
    inertia = float(a[0]), math.sqrt(covariance[0, 0])
    sizes = float(np.std(m.alpha)), float(np.std(x))
    return RigidBody(inertia, (amplitude, error), turned, loss, explained, *sizes)


def is_clear(value: float, error: float) -> bool:
    """Return whether a coefficient is significantly different from zero."""
    return abs(value) > limits.SIGMAS * error


# What a rig declares of its body and its motor, evaluated by the definitions of the general derivation.


# It holds every case: the tilt says which.
MODEL = "rotating_link"


def inertia_of(rig: Rig) -> float | None:
    """Return all of the inertia at the motor [kg m^2], None where the rig does not declare it."""
    model = load_model(rig.model)
    return _value(model, model.inertia, rig.known)


def gravity_of(rig: Rig) -> float | None:
    """Return the amplitude of gravity at the motor [N m], None where the rig does not declare it."""
    upright = upright_gravity_of(rig)
    if upright is None or "phi" not in rig.known:
        return None
    found = _gravity(rig.known)
    return 0.0 if found is None or found <= limits.LEVEL * upright else found


def upright_gravity_of(rig: Rig) -> float | None:
    """Return what it would be in an upright plane."""
    return _gravity({**rig.known, "phi": 0.0})


def torque_per_unit(drive: str, rig: Rig) -> float | None:
    """Return newton metres per unit of the drive, None where the rig does not declare it."""
    if drive == "torque":
        return 1.0
    model, unit = load_model(rig.model), {"i": 1.0, "u": 1.0, "omega_m": 0.0, "k_e": 0.0}
    torque = model.balance("mechanical").sum_of("drive")
    if drive == "voltage":
        torque = torque.xreplace({v.i.symbol: model.balance("electrical").solved_for(v.i.symbol)})
    return _value(model, torque, {**rig.known, **unit})


def _gravity(known: Mapping[str, float]) -> float | None:
    """With the link a quarter of a turn from where it hangs down."""
    if "mu" not in known:
        return None
    quarter = math.pi / 2.0 / known["mu"]
    model = load_model(MODEL)
    return _value(model, model.balance("mechanical").sum_of("gravity"), {**known, "theta_m": quarter})


def _value(model: Model, expression: sp.Expr, known: Mapping[str, float]) -> float | None:
    try:
        return model.value(expression, known)
    except KeyError:
        return None


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
    agrees: float = limits.AGREES

    @classmethod
    def of(cls, name: str, found: float, error: float, given: float, axis: AxisKind, text: str = "") -> Ratio:
        """Make one from the value in the log, its uncertainty, and the value in the rig, in SI."""
        unit = axis.unit(_UNITS[name.removesuffix(" by gravity")])
        called = axis.named(_CALLED.get(name, name))
        said = text or f"{called} is {found:.3g} {unit} in the log and {given:.3g} in the rig file"
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
        close = self.value > 0.0 and abs(math.log(self.value / factor)) <= limits.NEAR
        return close or self.low <= factor <= self.high


def electrical(m: Means, rig: Rig) -> Iterator[Ratio]:
    """Yield k_e and R by the armature's u = R i + k_e w, over those of the rig."""
    found = _armature(m)
    if found is None:
        return
    (r, r_error), (e, e_error) = found
    if "R" in rig.known:
        yield replace(Ratio.of("R", r, r_error, rig.known["R"], rig.axis), agrees=limits.WARM)
    elif 0.0 < r + r_error < limits.LEAST_OHM:
        # Against nothing but what windings have: the next larger unit of a current is the only reading.
        text = f"R is {r:.3g} ohm in the log, less than the windings of such drives have"
        yield Ratio.of("R", r, r_error, 1e3 * r, rig.axis, text)
    if "k_e" not in rig.known:
        return
    if "R" in rig.known and abs(r - rig.known["R"]) <= r_error:
        # With an R that the log allows, k_e is also known where current and speed are correlated.
        rest = m.drives["voltage"] - rig.known["R"] * m.drives["current"]
        a, covariance, _ = regressed(friction_of(m), rest)
        e, e_error = a[0], math.sqrt(covariance[0, 0]) * limits.SIGMAS
    yield replace(Ratio.of("k_e", e, e_error, rig.known["k_e"], rig.axis), agrees=limits.WARM)


def mechanical(body: RigidBody, drive: str, rig: Rig) -> Iterator[Ratio]:
    """Yield inertia and gravity of the drive over those of the rig."""
    scale = torque_per_unit(drive, rig)
    if scale is None:
        return
    if inertia := inertia_of(rig):
        value, error = body.inertia
        if max(abs(value), inertia / scale) * body.alpha >= limits.NOTICED * body.drive:
            yield Ratio.of("J", scale * value, scale * error * limits.SIGMAS, inertia, rig.axis)
    if gravity := gravity_of(rig):
        value, error = body.gravity
        yield Ratio.of("M g L", scale * value, scale * error * limits.SIGMAS, gravity, rig.axis)


def motor_constant(m: Means, body: RigidBody, drive: str, rig: Rig) -> Iterator[Ratio]:
    """Yield k_i where it differs from k_e by the voltage, or from a range, by more than motors do."""
    back_emf, k_i, unit = _armature(m), rig.axis.named("k_i"), rig.axis.unit("N m/A")
    if "k_i" in rig.known:
        if back_emf is None or any(r.near(1.0) for r in mechanical(body, drive, rig)):
            return
        e, error = back_emf[1]
        given = rig.known["k_i"]
        text = f"{k_i} is {e:.3g} {unit} from the voltage (in SI it equals k_e)"
        text += f" and {given:.3g} in the rig file"
        found = Ratio.of("k_i", e, error, given, rig.axis, text)
    elif "k_i" in rig.unknown and drive == "current" and (by_torque := _by_torque(body, rig)):
        k, error, source = by_torque
        if back_emf is not None and is_clear(back_emf[1][0], back_emf[1][1] / limits.SIGMAS):
            e = back_emf[1][0]
            text = f"{k_i} is {k:.3g} {unit} from {source} and {e:.3g} from the voltage (in SI it equals k_e)"
            found = Ratio.of("k_i by gravity", k, error, e, rig.axis, text)
        else:
            low, high = rig.unknown["k_i"]
            # A thousand times as much is in the range: the current is in mA, as far as a range can say it.
            end = 1e3 * k if k < low <= 1e3 * k <= high else low if k < low else high
            text = f"{k_i} is {k:.3g} {unit} from {source}, outside {low:g} to {high:g} of the rig file"
            found = Ratio.of("k_i by gravity", k, error, end, rig.axis, text)
            if low <= k <= high:
                return
    else:
        return
    if found.off(limits.IDEAL):
        yield found


def constant_by_torque(body: RigidBody, drive: str, rig: Rig) -> Iterator[Ratio]:
    """Yield the k_i that makes gravity, else inertia, the rig's, over that of the rig."""
    if drive == "current" and "k_i" in rig.known and (by_torque := _by_torque(body, rig)):
        k, error, source = by_torque
        given = rig.known["k_i"]
        k_i, unit = rig.axis.named("k_i"), rig.axis.unit("N m/A")
        text = f"{k_i} is {k:.3g} {unit} from {source} and {given:.3g} in the rig file"
        yield Ratio.of("k_i", k, error, given, rig.axis, text)


def constant_beside_torque(m: Means, rig: Rig) -> Iterator[Ratio]:
    """Yield the k_i by a torque that is logged beside the current, over that of the rig.

    A sensor has no part of the friction before it, which costs it some of the current.
    """
    if "k_i" not in rig.known or not {"torque", "current"} <= set(m.drives):
        return
    current = m.drives["current"]
    a, covariance, explained = regressed([current, np.ones_like(current)], m.drives["torque"])
    if explained >= limits.EXPLAINED and a[0] > 0.0:
        error = math.sqrt(covariance[0, 0]) * limits.SIGMAS
        yield replace(
            Ratio.of("k_i", float(a[0]), error, rig.known["k_i"], rig.axis), agrees=limits.FACTOR_MOTOR
        )


def _armature(m: Means) -> tuple[tuple[float, float], tuple[float, float]] | None:
    """Return R and k_e by u = R i + k_e w, each with its uncertainty; None if that does not hold."""
    if not {"voltage", "current"} <= set(m.drives):
        return None
    a, covariance, explained = regressed([m.drives["current"], *friction_of(m)], m.drives["voltage"])
    if explained < limits.EXPLAINED:
        return None
    r, e = ((float(a[k]), math.sqrt(covariance[k, k]) * limits.SIGMAS) for k in range(2))
    return r, e


def _by_torque(body: RigidBody, rig: Rig) -> tuple[float, float, str] | None:
    """Return k_i for which gravity, else inertia, is the rig's: value, uncertainty, and which of them."""
    for given, (value, error), source in (
        (gravity_of(rig), body.gravity, "gravity"),
        (inertia_of(rig), body.inertia, rig.axis.term("inertia")),
    ):
        if given and is_clear(value, error) and value > 0.0:
            return given / value, given / value**2 * error * limits.SIGMAS, source
    return None
