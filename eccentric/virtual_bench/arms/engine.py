"""The rigid bodies, by MuJoCo: mass matrix, gravity and gyroscopic torques, and what each joint carries.

MuJoCo's own `armature` adds J_m/mu^2 to the diagonal of the mass matrix and nothing else. A rotor also turns
with the link that carries it, and that link bears its angular momentum. Both are added here in closed form,
with e_j the axis of joint j and w_p, alpha_p of the link that carries its rotor:

    torque on the motor         J_m (alpha_m + e_j . alpha_p)
    moment on the link before   -(J_m alpha_m e_j + w_p x J_m omega_m e_j)

so that the mass matrix gains J_m/mu e_j . e_k for every joint k before j. The moment is handed to MuJoCo as
one from outside, and is then part of what the joints nearer to the base carry.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin
from types import ModuleType

import numpy as np

from eccentric.errors import InputError

from .plant import BenchArm, BenchLink, Vector


@dataclass(frozen=True)
class JointLoads:
    """What the joints carry, each of shape (joints,), and their axes.

    Attributes:
        bearing: (3, joints): F_N [N] across the axis, F_T [N] along it, M_B [N m] across it about the joint's
            origin.
        transmitted: torque about the axis that the gear passes on to the link, with its sign [N m].
    """

    bearing: np.ndarray
    transmitted: np.ndarray


def require_mujoco() -> ModuleType:
    """Return the engine. Raises InputError, which names the command that installs it, if it is not there."""
    try:
        import mujoco
    except ImportError:
        raise InputError(
            "the bench for arms: MuJoCo is required; install it with: pip install 'eccentric[arms-bench]'"
        ) from None
    return mujoco


class RigidArm:
    """An arm in MuJoCo: `place` it, then ask for `mass`, `bias`, `gravity_torque` and `loads`.

    Torques are those of the joints; the rotors are included. It agrees with Pinocchio to 1e-9 of the largest
    torque: MuJoCo turns every inertia tensor into its principal axes.
    """

    def __init__(self, arm: BenchArm) -> None:
        self._mujoco = require_mujoco()
        self._model = self._mujoco.MjModel.from_xml_string(_document(arm))
        self._data = self._mujoco.MjData(self._model)
        self._n = len(arm)
        self._mu = arm.column("mu")
        self._J_m = arm.column("J_m")
        self._reflected = np.diag(self._J_m / self._mu**2)
        # What a joint's rotor has in common with every joint before it, by the cosine of their axes.
        self._shared = np.tril(np.repeat((self._J_m / self._mu)[:, None], self._n, axis=1), -1)
        self._dense = np.zeros((self._n, self._n))
        self._before = np.triu(np.ones((self._n, self._n)), 1)
        self._gyroscopic = self._carried = np.zeros((self._n, 3))
        self._weights = np.asarray(self._model.body_subtreemass[1:, None] * np.array(arm.gravity))

    def place(self, q: np.ndarray, w: np.ndarray) -> None:
        """Set angles [rad] and velocities [rad/s] of the joints."""
        data = self._data
        data.qpos[:] = q
        data.qvel[:] = w
        self._mujoco.mj_fwdPosition(self._model, data)
        self._mujoco.mj_fwdVelocity(self._model, data)
        # By joint: w_p x w_j e_j. Body j is the one before joint j, 0 the base.
        turning = _cross(data.cvel[: self._n, :3], data.xaxis * w[:, None])
        self._gyroscopic = (self._J_m / self._mu)[:, None] * turning
        # Angular acceleration of the link before each joint, without that of the joints.
        self._carried = np.cumsum(turning, axis=0) - turning

    def mass(self) -> np.ndarray:
        """Mass matrix [kg m^2], shape (joints, joints)."""
        self._mujoco.mj_fullM(self._model, self._data, self._dense)
        axes = self._data.xaxis
        coupled = self._shared * (axes @ axes.T)
        return self._dense + self._reflected + coupled + coupled.T

    def bias(self) -> np.ndarray:
        """Torque [N m] of gravity and velocities without acceleration, shape (joints,)."""
        axes = self._data.xaxis
        # Each rotor turns with its carrier, and its gyroscopic moment acts on the joints before its own.
        own = self._J_m / self._mu * np.einsum("jk,jk->j", axes, self._carried)
        before = (axes @ self._gyroscopic.T * self._before).sum(axis=1)
        return self._data.qfrc_bias + own + before

    def gravity_torque(self) -> np.ndarray:
        """Torque [N m] that holds the arm at rest, shape (joints,)."""
        arms = self._data.subtree_com[1:] - self._data.xanchor
        return -np.einsum("jk,jk->j", self._data.xaxis, _cross(arms, self._weights))

    def loads(self, acceleration: np.ndarray) -> JointLoads:
        """What the joints carry under an acceleration [rad/s^2], shape (joints,)."""
        data, n = self._data, self._n
        data.qacc[:] = acceleration
        axes = data.xaxis
        data.xfrc_applied[:n, 3:] = -(
            axes * (self._J_m * acceleration / self._mu)[:, None] + self._gyroscopic
        )
        data.xfrc_applied[0] = 0.0
        self._mujoco.mj_rnePostConstraint(self._model, data)
        wrench = data.cfrc_int[1:]  # moment about the arm's centre of mass, then force; on the link
        force = wrench[:, 3:]
        moment = wrench[:, :3] + _cross(data.subtree_com[1] - data.xanchor, force)
        along, transmitted = (np.einsum("jk,jk->j", axes, vector) for vector in (force, moment))
        radial = force - along[:, None] * axes
        bending = moment - transmitted[:, None] * axes
        across = [np.sqrt(np.einsum("jk,jk->j", vector, vector)) for vector in (radial, bending)]
        return JointLoads(np.stack([across[0], np.abs(along), across[1]]), transmitted)

    def energy(self, w: np.ndarray) -> float:
        """Kinetic and potential energy [J] where it was placed, at velocities w."""
        data, model = self._data, self._model
        potential = -float(np.sum(model.body_mass[1:, None] * data.xipos[1:] * model.opt.gravity))
        return 0.5 * float(w @ self.mass() @ w) + potential


_NEXT, _AFTER = [1, 2, 0], [2, 0, 1]


def _cross(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return the vector products of rows: a tenth of the time of np.cross."""
    return left[:, _NEXT] * right[:, _AFTER] - left[:, _AFTER] * right[:, _NEXT]


def _document(arm: BenchArm) -> str:
    """Return the arm in MuJoCo's own format, without shapes: nothing can touch."""
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
