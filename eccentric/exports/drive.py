"""The drive that is exported: a pendulum with its friction, seen from the link side of the gear.

A joint of a simulator is the link: its angle is mu theta_m, its velocity mu omega_m. A torque there is one of
the motor over mu, damping and inertia are those of the motor over mu^2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError
from eccentric.emission import inputs_of, joints_of, load_module
from eccentric.model import TURNING, Model

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
                f"one in {model.torque_unit}: declare k_i in the rig",
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
        """Inertia of both about their centre of mass [kg m^2].

        Raises:
            InputError: J_l is no inertia of a body with M at L.
        """
        self.require("J_l")
        about_centre = self.p.J_l - self.mass * self.centre**2
        if about_centre <= 0.0:
            raise InputError(
                f"model {self.name}: J_l",
                f"more than {self.mass * self.centre**2:.4g} kg m^2, about the axis with M at L",
                f"{self.p.J_l:.4g}",
            )
        return about_centre

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
