"""What is exported: a pendulum with its friction, seen from the link side of the gear, or an arm.

A joint of a simulator is the link: its angle is mu theta_m, its velocity mu omega_m. A torque there is one of
the motor over mu, damping and inertia are those of the motor over mu^2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from types import ModuleType
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from eccentric.core import InputError
from eccentric.emission import inputs_of, joints_of, load_module
from eccentric.model import TURNING, ArmOutputs, Joint, Model

Floats = NDArray[np.float64]

DEFAULT_SPEEDS = (1.0, 60.0)
"""Motor speeds [rad/s] over which friction is compared where no log says more."""


@dataclass(frozen=True, eq=False)
class ExportedDrive:
    """One drive that swings a mass.

    Attributes:
        model: with the values that are exported as its defaults.
        origin: source of its physics, for the head of files.
        speeds: motor speeds [rad/s], lowest and highest, over which its friction is known.
        identified: whether a log showed it at these speeds.
    """

    model: Model
    origin: str
    speeds: tuple[float, ...] = DEFAULT_SPEEDS
    identified: bool = False

    def __post_init__(self) -> None:
        """Raise InputError for what is no single turning drive with friction in N m, or has hidden states."""
        model, place = self.model, f"model {self.model.name}"
        if joints_of(model):
            raise InputError(place, "a model of one drive", "an arm", why="to export")
        if model.axis is not TURNING:
            raise InputError(place, "a turning drive", f"a {model.axis.name} axis", why="to export")
        if model.torque_unit != "N m":
            raise InputError(
                place,
                "friction in N m",
                f"one in {model.torque_unit}: declare k_i in the rig file",
                why="to export",
            )
        if model.states:
            names = ", ".join(state.quantity.name for state in model.states)
            raise InputError(place, "friction without hidden states", names, why="to export")
        if len(self.speeds) != 2 or not 0.0 < self.speeds[0] < self.speeds[1] < math.inf:
            given = " ".join(f"{x:g}" for x in self.speeds)
            raise InputError("speeds", "motor speeds 0 < LOW < HIGH in rad/s", given)

    @property
    def name(self) -> str:
        """Of the model and its files."""
        return self.model.name

    @cached_property
    def module(self) -> ModuleType:
        """The emitted NumPy module."""
        return load_module(self.model)

    @cached_property
    def p(self) -> Any:
        """Its default parameters."""
        return self.module.Parameters()

    def require(self, *names: str) -> None:
        """Raise InputError unless these parameters have a value; it names every inertia without one."""
        missing = [name for name in ("J_m", "J_l") if getattr(self.p, name) is None]
        if not set(names).isdisjoint(missing):
            place = f"model {self.name}: {', '.join(missing)}"
            raise InputError(place, "values from --parameters FIT.json, or in the derivation", "none")

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """The inputs of friction, in the order of `friction_budget`."""
        return inputs_of(self.module.friction_budget)

    def other_inputs(self) -> tuple[str, ...]:
        """Those that no motion has: a temperature, a current."""
        return tuple(x for x in self.inputs if x not in {"theta_m", "omega_m", "alpha_m"})

    def takes(self, name: str) -> bool:
        """Whether friction depends on this input."""
        return name in self.inputs

    def require_motion_alone(self) -> None:
        """Raise InputError if friction depends on more than angle, velocity and acceleration."""
        if others := self.other_inputs():
            raise InputError(
                f"model {self.name}", "friction of angle and velocity", f"one of {', '.join(others)} too"
            )

    @property
    def link_speeds(self) -> tuple[float, float]:
        """`speeds` of the link [rad/s]."""
        low, high = self.speeds
        return self.p.mu * low, self.p.mu * high

    def budget(self, angle: Floats, velocity: Floats) -> tuple[Floats, Floats, Floats]:
        """Levels of dry friction [N m], lower and upper, and damping [N m s/rad], at the joint.

        Args:
            angle, velocity: of the link [rad, rad/s]; they broadcast. The acceleration is taken as 0.
        """
        mu = self.p.mu
        motion = {"theta_m": angle / mu, "omega_m": velocity / mu, "alpha_m": np.zeros(())}
        found = np.asarray(self.module.friction_budget(*(motion[x] for x in self.inputs), self.p))
        shape = np.broadcast_shapes(np.shape(angle), np.shape(velocity))
        lower, upper, viscous = (np.broadcast_to(found[..., k], shape) for k in range(3))
        return lower / mu, upper / mu, viscous / mu**2

    def friction(self, angle: Floats, velocity: Floats) -> Floats:
        """The friction torque at the joint in motion [N m]."""
        lower, upper, damping = self.budget(angle, velocity)
        return np.where(velocity > 0.0, upper, lower) + damping * velocity

    # The pendulum that it swings.

    @property
    def armature(self) -> float:
        """Inertia of the motor at the joint [kg m^2]."""
        self.require("J_m")
        return self.p.J_m / self.p.mu**2

    @property
    def mass(self) -> float:
        """Of the link with the unbalanced mass [kg]."""
        return self.p.M + self.p.M_l

    @property
    def centre(self) -> float:
        """Distance of their common centre of mass from the axis [m]: the link itself is balanced."""
        return self.p.M * self.p.L / self.mass if self.mass else 0.0

    @property
    def inertia(self) -> float:
        """Inertia of both about their centre of mass [kg m^2]; 1e-9 M L^2 for a point, as engines need some.

        Raises:
            InputError: J_l is no inertia of a body with M at L.
        """
        self.require("J_l")
        least = self.mass * self.centre**2
        about_centre, rounding = self.p.J_l - least, 1e-9 * least
        if about_centre < -rounding or not self.p.J_l:
            raise InputError(
                f"model {self.name}: J_l",
                f"{'at least' if least else 'more than'} {least:.6g} kg m^2, about the axis with M at L",
                f"{self.p.J_l:.6g}",
            )
        return max(about_centre, rounding)

    @cached_property
    def gravity(self) -> tuple[float, float]:
        """Cosine of the tilt of the motion plane, and the largest torque beyond the pendulum's own [N m].

        The second, at the joint, is that of cogging, springs and constant loads, which a pendulum lacks.
        """
        p, function = self.p, getattr(self.module, "gravity_torque", None)
        if function is None:
            return 0.0, 0.0
        angle = np.linspace(-np.pi, np.pi, 720, endpoint=False)
        still = {"theta_m": angle / p.mu}
        values = [still.get(x, np.zeros_like(angle)) for x in inputs_of(function)]
        torque = np.broadcast_to(function(*values, p), angle.shape) / p.mu
        whole = p.M * p.g * p.L
        cosine = float(2.0 * np.mean(torque * np.sin(angle)) / whole) if whole else 0.0
        cosine = min(max(cosine, -1.0), 1.0)
        return cosine, float(np.abs(torque - cosine * whole * np.sin(angle)).max())

    @property
    def tilt(self) -> float:
        """Of the motion plane against gravity [rad]: 0 in a vertical plane, a quarter turn in a level one."""
        cosine, _ = self.gravity
        nearest = round(cosine)  # an arc cosine near 1 has half the digits
        return math.acos(nearest if math.isclose(cosine, nearest, abs_tol=1e-12) else cosine)


@dataclass(frozen=True, eq=False)
class ExportedArm:
    """An arm, with the values that are exported as its defaults; `origin` is the source of its physics."""

    model: Model
    origin: str

    @property
    def name(self) -> str:
        """Of the model and its files."""
        return self.model.name

    @property
    def joints(self) -> tuple[Joint, ...]:
        """From the base outwards."""
        return cast("ArmOutputs", self.model.declares).found.chain.joints

    @property
    def without_friction(self) -> bool:
        """Whether every coefficient of friction is 0."""
        terms = [t for balance in self.model.balances for t in balance.terms if t.kind == "friction"]
        used = {t.coefficient for t in terms}
        return not any(q.default for q in self.model.parameters if q.symbol in used)


# The nearest friction with constant coefficients, for simulators whose joints take no other.
#
# Of a joint moving at v: level + a v + b v|v| + c v^3 against the motion, a level for each direction. It is
# fitted to the friction of a drive over a turn of the link and its range of speeds, by least squares with
# coefficients that are not negative (C. L. Lawson and R. J. Hanson, Solving Least Squares Problems, 1974).


_ANGLES, _SPEEDS = 720, 64
"""Points of a turn of the link and of the speeds of each direction."""
_ROUNDING = 1e-12
"""Share of the largest friction below which a part of it, or an error, is rounding."""


@dataclass(frozen=True)
class ConstantLaw:
    """Friction of a joint with constant coefficients, and its error over the range that it was fitted on.

    Attributes:
        upper, lower: sizes of the levels forwards and backwards [N m].
        damping: coefficients of v, v|v| and v^3 [N m s/rad, N m s^2/rad^2, N m s^3/rad^3].
        error_rms, error_max: of the friction torque [N m].
        friction_rms: of the friction torque itself [N m].
        breakaway: smallest and largest level of the drive at rest, over the angle and both directions [N m].
    """

    upper: float
    lower: float
    damping: tuple[float, float, float]
    error_rms: float
    error_max: float
    friction_rms: float
    breakaway: tuple[float, float]

    @property
    def level(self) -> float:
        """Half the sum of both levels [N m]: what a simulator has one number for."""
        return (self.upper + self.lower) / 2.0

    @property
    def offset(self) -> float:
        """Half their difference [N m]: with it as a constant torque against the joint, `level` is exact."""
        return (self.upper - self.lower) / 2.0

    @property
    def exact(self) -> bool:
        """Whether the drive has this friction."""
        return self.error_max == 0.0

    def torque(self, velocity: Floats) -> Floats:
        """The friction torque in motion [N m]."""
        a, b, c = self.damping
        dry = np.where(velocity > 0.0, self.upper, -self.lower)
        return dry + a * velocity + b * velocity * np.abs(velocity) + c * velocity**3


def nearest(
    drive: ExportedDrive, powers: tuple[int, ...] = (1, 2, 3), *, symmetric: bool = False
) -> ConstantLaw:
    """The nearest law of a drive.

    Args:
        drive: its friction depends on angle and velocity alone.
        powers: of the speed in the damping.
        symmetric: whether both levels are one.

    Raises:
        InputError: its friction depends on a temperature, a current or the like.
    """
    drive.require_motion_alone()
    speed = np.linspace(*drive.link_speeds, _SPEEDS)
    angle = np.linspace(0.0, 2.0 * np.pi, _ANGLES, endpoint=False)
    velocity = np.concatenate([speed, -speed])
    torque = drive.friction(angle[:, None], velocity[None, :])
    sign = np.where(velocity >= 0.0, 1.0, -1.0)
    forward, backward = (sign > 0.0).astype(float), -(sign < 0.0).astype(float)
    levels = [sign] if symmetric else [forward, backward]
    columns = np.column_stack([*levels, *(sign * np.abs(velocity) ** k for k in powers)])
    # The columns are the same at each angle: the mean over it has the same solution.
    scale = np.linalg.norm(columns, axis=0)
    found = nnls(columns / scale, torque.mean(axis=0))[0] / scale
    largest = float(np.abs(torque).max())
    found[found * np.abs(columns).max(axis=0) <= _ROUNDING * largest] = 0.0
    error = torque - columns @ found
    error = np.zeros(1) if np.abs(error).max() <= _ROUNDING * largest else error
    upper, lower = found[0], found[0 if symmetric else 1]
    if abs(upper - lower) <= _ROUNDING * largest:
        upper = lower
    damping = dict(zip(powers, map(float, found[len(levels) :]), strict=True))
    low, high, _ = drive.budget(angle, np.zeros_like(angle))
    at_rest = np.concatenate([-low, high])
    return ConstantLaw(
        float(upper),
        float(lower),
        (damping.get(1, 0.0), damping.get(2, 0.0), damping.get(3, 0.0)),
        float(np.sqrt(np.mean(error**2))),
        float(np.abs(error).max()),
        float(np.sqrt(np.mean(torque**2))),
        (float(at_rest.min()), float(at_rest.max())),
    )
