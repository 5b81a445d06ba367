"""The rig simulated by the bench: its true parameters and the paper's friction, written out explicitly.

The bench is an oracle for the toolkit, so nothing here comes from the derivations. All torques are on the
motor side [N m]; link angles and speeds are mu times those of the motor.
"""

from dataclasses import InitVar, dataclass, field
from math import cos, hypot, sin
from typing import Any

import numpy as np
from numpy.typing import ArrayLike


def rms(values: ArrayLike) -> np.ndarray:
    """Return the root of the mean square over the rows."""
    return np.sqrt(np.mean(np.square(values), axis=0))


@dataclass(frozen=True)
class Plant:
    """True parameters of drive and link, in SI units with the paper's symbols.

    `case` is "C1" (gravity perpendicular to the plane of motion) or "C2" (parallel to it).
    `Rth` [K/W], `tau` [s] and `Tamb` [deg C] describe first-order heating by the losses; 0 K/W means none.
    """

    case: str
    M: float
    M_l: float
    L: float
    mu: float
    R: float
    k_i: float
    k_e: float
    J_m: float
    J_l: float
    g: float
    C_m: float
    B_m: float
    C_lN: float
    B_lN: float
    gamma_T: float
    beta_T: float
    Rth: float = 0.0
    tau: float = 70.0
    Tamb: float = 22.0

    @property
    def in_plane_gravity(self) -> float:
        """Gravity projected onto the plane of motion [m/s^2]: none in C1, all of it in C2."""
        return 0.0 if self.case == "C1" else self.g

    @property
    def inertia(self) -> float:
        """J_m + mu^2 J_l [kg m^2], eq. (4)."""
        return self.J_m + self.mu**2 * self.J_l

    def normal_force(self, link_angle: float, link_speed: float, gravity: float | None = None) -> float:
        """Return the norm of the bearing reaction [N] at constant speed, eqs (8) and (15).

        `gravity` [m/s^2] is the in-plane component, by default that of the case. The norm is computed from
        the vector (15): unlike the root (16), it has no cancellation at the top.
        """
        weight = (self.M + self.M_l) * (self.in_plane_gravity if gravity is None else gravity)
        centrifugal = self.M * self.L * link_speed**2
        return hypot(centrifugal * sin(link_angle), centrifugal * cos(link_angle) + weight)

    def gravity_torque(self, link_angle: float, gravity: float | None = None) -> float:
        """Return G of eq. (5) on the motor side [N m], at `gravity` [m/s^2] in the plane of motion."""
        in_plane = self.in_plane_gravity if gravity is None else gravity
        return self.mu * self.M * in_plane * self.L * sin(link_angle)

    def link_friction(self, normal: float) -> tuple[float, float]:
        """Return Coulomb level [N m] and viscous coefficient [N m s/rad] of mu f_l, eqs (9), (19), (20).

        `normal` [N] is the normal force. The transversal force acts in C1 only, as in the paper.
        """
        transversal = self.case == "C1"
        dry = self.mu * (self.C_lN * normal + (self.gamma_T if transversal else 0.0))
        viscous = self.mu**2 * (self.B_lN * normal + (self.beta_T if transversal else 0.0))
        return dry, viscous

    def friction_torque(self, link_angle: float, link_speed: float) -> float:
        """Return the mechanical friction f_m + mu f_l [N m], without the back-EMF damping of eq. (6)."""
        dry, viscous = self.link_friction(self.normal_force(link_angle, link_speed))
        direction = (link_speed > 0) - (link_speed < 0)
        return (self.C_m + dry) * direction + (self.B_m + viscous) * link_speed / self.mu

    def known(self) -> dict[str, Any]:
        """Return the values declared in a rig file; friction and heating remain sealed."""
        return {
            "case": self.case,
            "M_kg": self.M,
            "M_l_kg": self.M_l,
            "L_m": self.L,
            "mu": self.mu,
            "R_ohm": self.R,
            "k_i_Nm_per_A": self.k_i,
            "k_e_Vs_per_rad": self.k_e,
            "J_m_kgm2": self.J_m,
            "J_l_kgm2": self.J_l,
            "g_m_s2": self.g,
        }

    def hidden(self) -> dict[str, float]:
        """Return the friction coefficients, for the sealed truth."""
        return {name: getattr(self, name) for name in ("C_m", "B_m", "C_lN", "B_lN", "gamma_T", "beta_T")}


@dataclass(slots=True, eq=False)
class Motion:
    """The motion of the rig at this step, for the effects' laws; torques in N m on the motor side."""

    plant: Plant  # the moving rig, not necessarily the one for which an effect was drawn
    theta: float = 0.0  # motor angle at the end of the step
    w: float = 0.0  # motor speed at the end of the step [rad/s]
    effects: InitVar[int] = 0  # how many laws act
    t: float = 0.0  # time [s]
    w_before: float = 0.0  # motor speed at the start of the step
    w_mid: float = 0.0  # motor speed extrapolated to the middle of the step
    alpha: float = 0.0  # motor acceleration over the last step [rad/s^2]
    link: float = 0.0  # link angle in the middle of the step
    w_link: float = 0.0  # link speed [rad/s]
    i: float = 0.0  # armature current, mean over the step [A]
    v: float = 0.0  # voltage less the declared back EMF [V]
    temperature: float = 0.0  # of both lubricant and winding [deg C]
    travel: float = 0.0  # distance travelled by the motor [rad]
    normal: float = 0.0  # normal force in the link joint [N]
    gravity: float = 0.0  # gravity torque of eq. (5)
    link_dry: float = 0.0  # Coulomb level of the link joint
    link_viscous: float = 0.0  # viscous coefficient of the link joint [N m s/rad]
    dry: float = 0.0  # Coulomb level of the paper's friction, motor and link
    viscous: float = 0.0  # viscous coefficient of the paper's friction
    acting: list[float] = field(default_factory=list)  # value of each effect's law at this step

    def __post_init__(self, effects: int) -> None:
        self.w_before = self.w_mid = self.w
        self.link, self.w_link = self.plant.mu * self.theta, self.plant.mu * self.w
        self.temperature, self.acting = self.plant.Tamb, [0.0] * effects
