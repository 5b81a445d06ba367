"""The arm simulated by the bench, with its rigid bodies in MuJoCo.

Joints with their links, drives and friction, in SI units. The bench is an oracle for the toolkit, so the two
share no code.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin
from types import ModuleType

import numpy as np

from eccentric.core import InputError
from eccentric.virtual_bench.arms.trajectory import ArmCourse

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class JointFriction:
    """Friction of one joint: of the motor, and of the bearing in proportion to its loads.

    f = (C_m + mu (C_lN F_N + C_lT F_T + C_lM M_B)) sgn w_m
        + (B_m + mu^2 (B_lN F_N + B_lT F_T + B_lM M_B)) w_m

    on the motor side [N m], with the instantaneous loads: F_N across the axis, F_T along it [N], M_B across
    it about the origin of the joint [N m].
    """

    C_m: float = 0.0
    B_m: float = 0.0
    C_lN: float = 0.0
    B_lN: float = 0.0
    C_lT: float = 0.0
    B_lT: float = 0.0
    C_lM: float = 0.0
    B_lM: float = 0.0

    @property
    def dry(self) -> Vector:
        """Coulomb friction of the joint per F_N [m], F_T [m] and M_B [1]."""
        return self.C_lN, self.C_lT, self.C_lM

    @property
    def viscous(self) -> Vector:
        """Viscous friction of the joint per F_N [m s/rad], F_T [m s/rad] and M_B [s/rad]."""
        return self.B_lN, self.B_lT, self.B_lM


@dataclass(frozen=True)
class BenchLink:
    """A revolute joint, the link it moves, and its drive, mounted on the previous link.

    Attributes:
        position, rpy: of the joint's frame in that of the previous link [m, rad]: roll about x, then pitch
            about y, then yaw about z of that link.
        axis: unit vector in the joint's frame.
        mass, centre, inertia: of the link [kg], in the joint's frame [m]; the tensor about the centre of
            mass, as xx, yy, zz, xy, xz, yz [kg m^2].
        mu: gear ratio, joint over motor.
        J_m: inertia of the rotor about its axis, which is parallel to that of the joint [kg m^2]. Locked, it
            is part of the link that carries it.
        k_i: torque constant of the motor [N m/A].
    """

    position: Vector
    rpy: Vector
    axis: Vector
    mass: float
    centre: Vector
    inertia: tuple[float, float, float, float, float, float]
    mu: float
    J_m: float
    k_i: float
    friction: JointFriction = JointFriction()


@dataclass(frozen=True)
class BenchArm:
    """Links in series on a fixed base; `gravity` is the free-fall acceleration in the base frame [m/s^2]."""

    name: str
    links: tuple[BenchLink, ...]
    gravity: Vector = (0.0, 0.0, -9.81)

    def __len__(self) -> int:
        return len(self.links)

    def column(self, letter: str) -> np.ndarray:
        """Return one number of each link, such as its mu, shape (joints,)."""
        return np.array([getattr(link, letter) for link in self.links])


class FrictionLaw:
    """The friction of `JointFriction` on the joint side: both parts over mu, with velocity over mu."""

    def __init__(self, arm: BenchArm) -> None:
        mu = arm.column("mu")
        all_of = [link.friction for link in arm.links]
        self.motor_dry = np.array([f.C_m for f in all_of]) / mu
        self.motor_viscous = np.array([f.B_m for f in all_of]) / mu**2
        self._dry = np.array([f.dry for f in all_of]).T
        self._viscous = np.array([f.viscous for f in all_of]).T

    def of(self, bearing: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the level [N m] and the viscous coefficient [N m s/rad], each of shape (..., joints).

        `bearing` are F_N, F_T [N] and M_B [N m], shape (..., 3, joints).
        """
        dry = self.motor_dry + (self._dry * bearing).sum(axis=-2)
        viscous = self.motor_viscous + (self._viscous * bearing).sum(axis=-2)
        return dry, viscous


# Mass matrix, gravity and gyroscopic torques, and joint loads.
#
# MuJoCo's `armature` adds J_m/mu^2 to the diagonal of the mass matrix and nothing else. A rotor also turns
# with its carrier link, which bears its angular momentum. Both are added here in closed form, with e_j the
# axis of joint j and w_p, alpha_p of the link that carries its rotor:
#
#     torque on the motor         J_m (alpha_m + e_j . alpha_p)
#     moment on the link before   -(J_m alpha_m e_j + w_p x J_m omega_m e_j)
#
# so that the mass matrix gains J_m/mu e_j . e_k for every joint k before j. The moment is passed to MuJoCo as
# an external one, and is then part of the loads of the joints nearer to the base. This is cheaper than rotors
# as separate bodies, whose constraints MuJoCo solves only to a tolerance.
@dataclass(frozen=True)
class JointLoads:
    """Joint loads in one or several configurations of the arm."""

    # (places, 3, joints): F_N [N] across the axis, F_T [N] along it, M_B [N m] across it about the
    # joint's origin
    bearing: np.ndarray
    transmitted: np.ndarray  # (places, joints): torque transmitted to the link, signed [N m]


def require_mujoco() -> ModuleType:
    """Return the engine; InputError with the installation command if it is missing."""
    try:
        import mujoco
    except ImportError:
        raise InputError(
            "arm", problem="MuJoCo is required for the bench of arms: pip install 'eccentric[arms-bench]'"
        ) from None
    return mujoco


class RigidArm:
    """An arm in MuJoCo, in several configurations at once: `place` it, then call `mass`, `bias` and `loads`.

    Torques are on the joint side, rotors included. It agrees with Pinocchio to 1e-12 of the largest load.
    MuJoCo takes a few microseconds per configuration, NumPy a hundred for all of them: so runs are simulated
    in parallel.
    """

    def __init__(self, arm: BenchArm, places: int = 1) -> None:
        self._mujoco = require_mujoco()
        n = len(arm)
        self._model = self._mujoco.MjModel.from_xml_string(_document(arm))
        self._data = [self._mujoco.MjData(self._model) for _ in range(places)]
        self._mu, self._J_m = arm.column("mu"), arm.column("J_m")
        self._ratio = self._J_m / self._mu
        self._reflected = np.diag(self._J_m / self._mu**2)
        # Coupling of a joint's rotor with every joint before it, times the cosine of their axes.
        self._shared = np.tril(np.repeat(self._ratio[:, None], n, axis=1), -1)
        self._before = np.triu(np.ones((n, n)), 1)
        self._weights = np.asarray(self._model.body_subtreemass[1:, None] * np.array(arm.gravity))
        self._dense = np.zeros((places, n, n))
        self._pull = np.zeros((places, n))
        self._axes, self._turning, self._gyroscopic, self._arms, self._spin = np.zeros((5, places, n, 3))
        self._to_centre, self._wrench = np.zeros((places, n, 3)), np.zeros((places, n, 6))

    def place(self, q: np.ndarray, w: np.ndarray) -> None:
        """Set angles [rad] and velocities [rad/s] of the joints, each of shape (places, joints)."""
        mujoco, model, n = self._mujoco, self._model, q.shape[1]
        for k, data in enumerate(self._data):
            data.qpos[:] = q[k]
            data.qvel[:] = w[k]
            mujoco.mj_fwdPosition(model, data)
            mujoco.mj_fwdVelocity(model, data)
            mujoco.mj_fullM(model, data, self._dense[k])
            self._pull[k] = data.qfrc_bias
            self._axes[k] = data.xaxis
            self._spin[k] = data.cvel[:n, :3]
            self._arms[k] = data.subtree_com[1:] - data.xanchor
            self._to_centre[k] = data.subtree_com[1] - data.xanchor
        # By joint: w_p x w_j e_j. Body j is the one before joint j, 0 the base.
        self._turning = _cross(self._spin, self._axes * w[:, :, None])
        self._gyroscopic = self._ratio[:, None] * self._turning

    def mass(self) -> np.ndarray:
        """Mass matrices [kg m^2], shape (places, joints, joints)."""
        coupled = self._shared * self._cosines
        return self._dense + self._reflected + coupled + coupled.swapaxes(1, 2)

    @property
    def _cosines(self) -> np.ndarray:
        return self._axes @ self._axes.swapaxes(1, 2)

    def bias(self) -> np.ndarray:
        """Torques [N m] of gravity and velocities without acceleration, shape (places, joints)."""
        # Each rotor turns with its carrier, and its gyroscopic moment acts on the joints before it.
        carried = np.cumsum(self._turning, axis=1) - self._turning
        rotor = self._ratio * (self._axes * carried).sum(axis=2)
        before = (self._axes @ self._gyroscopic.swapaxes(1, 2) * self._before).sum(axis=2)
        return self._pull + rotor + before

    def gravity_torque(self) -> np.ndarray:
        """Torques [N m] that hold the arm at rest, shape (places, joints)."""
        return -(self._axes * _cross(self._arms, self._weights)).sum(axis=2)

    def loads(self, acceleration: np.ndarray) -> JointLoads:
        """Joint loads at accelerations [rad/s^2], shape (places, joints)."""
        n = acceleration.shape[1]
        rotors = -(self._axes * (self._ratio * acceleration)[:, :, None] + self._gyroscopic)
        for k, data in enumerate(self._data):
            data.qacc[:] = acceleration[k]
            data.xfrc_applied[1:n, 3:] = rotors[k, 1:]  # that of the first joint is on the base
            self._mujoco.mj_rnePostConstraint(self._model, data)
            self._wrench[k] = data.cfrc_int[1:]
        force = self._wrench[:, :, 3:]  # on the link; before it the moment about the arm's centre of mass
        both = np.stack([force, self._wrench[:, :, :3] + _cross(self._to_centre, force)])
        along = (both * self._axes).sum(axis=3)
        across = both - along[..., None] * self._axes
        bearing = np.empty((len(force), 3, n))
        bearing[:, ::2] = np.sqrt((across * across).sum(axis=3)).swapaxes(0, 1)
        bearing[:, 1] = np.abs(along[0])
        return JointLoads(bearing, along[1])

    def energy(self, w: np.ndarray) -> np.ndarray:
        """Kinetic plus potential energy [J] at velocities w in the placed configurations, shape (places,)."""
        model = self._model
        weights = -model.body_mass[1:, None] * model.opt.gravity
        potential = np.array([np.sum(weights * data.xipos[1:]) for data in self._data])
        return 0.5 * np.einsum("kj,kji,ki->k", w, self.mass(), w) + potential


_NEXT, _AFTER = [1, 2, 0], [2, 0, 1]


def _cross(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return the vector products along the last axis: a tenth of the time of np.cross."""
    return left[..., _NEXT] * right[..., _AFTER] - left[..., _AFTER] * right[..., _NEXT]


def _document(arm: BenchArm) -> str:
    """Return the arm in MuJoCo's XML format, without shapes, hence without contacts."""
    bodies = ""
    for link in reversed(arm.links):
        bodies = _body(link, bodies)
    return f"""<mujoco>
  <compiler angle="radian" autolimits="false"/>
  <option gravity="{_text(arm.gravity)}"><flag contact="disable" constraint="disable"/></option>
  <worldbody>{bodies}</worldbody>
</mujoco>"""


def _body(link: BenchLink, inside: str) -> str:
    return (
        f'<body pos="{_text(link.position)}" quat="{_text(_quaternion(link.rpy))}">'
        f'<joint type="hinge" axis="{_text(link.axis)}"/>'
        f'<inertial mass="{link.mass!r}" pos="{_text(link.centre)}" fullinertia="{_text(link.inertia)}"/>'
        f"{inside}</body>"
    )


def _quaternion(rpy: Vector) -> tuple[float, float, float, float]:
    """Return w, x, y, z of the rotation by roll about x, then pitch about y, then yaw about z."""
    (cr, sr), (cp, sp), (cy, sy) = ((cos(x / 2.0), sin(x / 2.0)) for x in rpy)
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


def _text(numbers: tuple[float, ...]) -> str:
    return " ".join(repr(float(x)) for x in numbers)


SURVEY_S = 0.02
"""Time between rows of a survey."""
_AT_ONCE = 64
"""Configurations of the arm computed together."""


@dataclass(frozen=True)
class Survey:
    """Rows along the reference of all runs in sequence; joint torques [N m]."""

    q: np.ndarray  # angles (rows, joints)
    w: np.ndarray  # velocities (rows, joints)
    alpha: np.ndarray  # accelerations (rows, joints)
    bearing: np.ndarray  # F_N, F_T [N], M_B [N m], shape (rows, 3, joints)
    transmitted: np.ndarray  # torque transmitted by each gear, (rows, joints)
    gravity: np.ndarray  # its part at rest
    torque: np.ndarray  # drive torques without friction, rotors included
    inertia: np.ndarray  # diagonal of the mass matrix [kg m^2], rotors included


def survey(arm: BenchArm, course: ArmCourse) -> Survey:
    """Take the arm along its reference by inverse dynamics."""
    time, motions = np.arange(0.0, course.seconds, SURVEY_S), []
    for run in range(course.runs):
        q, w = course.reference(run, time)
        motions.append((q, w, np.gradient(w, SURVEY_S, axis=0)))
    q, w, alpha = (np.concatenate(part) for part in zip(*motions, strict=True))
    rigid, parts = RigidArm(arm, _AT_ONCE), []
    for first in range(0, len(q), _AT_ONCE):
        rows = np.minimum(np.arange(first, first + _AT_ONCE), len(q) - 1)  # padded with the last one
        rigid.place(q[rows], w[rows])
        mass, loads = rigid.mass(), rigid.loads(alpha[rows])
        torque = np.einsum("kji,ki->kj", mass, alpha[rows]) + rigid.bias()
        inertia = np.einsum("kjj->kj", mass)
        parts.append((loads.bearing, loads.transmitted, rigid.gravity_torque(), torque, inertia))
    return Survey(q, w, alpha, *(np.concatenate(part)[: len(q)] for part in zip(*parts, strict=True)))
