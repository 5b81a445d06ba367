"""Base parameters: the combinations of inertial parameters that the torques of a log depend on.

Many inertial parameters of a serial arm act only in linear combinations, and some not at all. A pivoted QR
decomposition of the regressor over the log selects independent columns, each time the one with the largest
remaining norm; the others are linear combinations of these.

Reference: M. Gautier, "Numerical calculation of the base inertial parameters of robots", J. Robotic Systems
8(4), 1991.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr, solve_triangular

from eccentric.emission import Choice, executed, render_code
from eccentric.joints.limits import LEAST_SHARE_IN_SUM, RANK
from eccentric.model import Chain, arm, letters_of, with_letters

Array = NDArray[np.float64]


@dataclass(frozen=True)
class BaseParameters:
    """Columns that form a basis of a regressor."""

    chosen: tuple[int, ...]  # indices of the columns, in the order of the regressor (r,)
    # (r, p): base parameters = sums @ inertial parameters; the columns of `chosen` are unit vectors
    sums: Array

    def words(self, names: Sequence[str]) -> list[str]:
        """Each base parameter as a linear combination, in text."""
        return [
            names[place] + "".join(_part(float(row[k]), name) for k, name in enumerate(names) if k != place)
            for place, row in zip(self.chosen, self.sums, strict=True)
        ]


def base_of(regressor: Array) -> BaseParameters:
    """The base parameters of a regressor (rows, p); rows may be weighted.

    Columns are normalised, since their units differ.
    """
    size = np.linalg.norm(regressor, axis=0)
    nonzero = np.flatnonzero(size > RANK * size.max(initial=0.0) * np.finfo(float).eps ** 0.5)
    if not len(nonzero):
        return BaseParameters((), np.zeros((0, regressor.shape[1])))
    triangle = np.linalg.qr(regressor[:, nonzero] / size[nonzero], mode="r")
    r, order = qr(triangle, mode="r", pivoting=True)
    diagonal = np.abs(np.diag(r))
    rank = int(np.count_nonzero(diagonal > RANK * diagonal[0]))
    selected, dependent = nonzero[order[:rank]], nonzero[order[rank:]]
    # Dependent columns in terms of the selected ones, in the original units.
    sums = np.zeros((rank, regressor.shape[1]))
    sums[np.arange(rank), selected] = 1.0
    if len(dependent):
        others = solve_triangular(r[:rank, :rank], r[:rank, rank:])
        sums[:, dependent] = others * (size[dependent][None, :] / size[selected][:, None])
    ascending = np.argsort(selected)
    return BaseParameters(tuple(int(k) for k in selected[ascending]), sums[ascending])


def names_of(joints: int) -> list[str]:
    """Names of all inertial parameters, in the order of the regressor."""
    return [q.name for j in range(joints) for q in letters_of(j)]


def _part(x: float, name: str) -> str:
    if abs(x) <= LEAST_SHARE_IN_SUM:
        return ""
    size = "" if abs(abs(x) - 1.0) < LEAST_SHARE_IN_SUM else f"{abs(x):.4g} "
    return f" {'-' if x < 0.0 else '+'} {size}{name}"


_UPPER = [(a, b) for a in range(3) for b in range(a, 3)]
COUNT = 10
"""Inertial parameters of a body: mass, three first moments, six second moments."""


def moments_of(chain: Chain) -> Array:
    """The inertial parameters of a numeric chain, payload included, shape (joints, 10)."""
    rows = []
    for place, body in enumerate(chain.bodies):
        moments = body.moments
        if chain.payload is not None and place == len(chain.bodies) - 1:
            moments = moments + chain.payload.moments
        second = moments.second
        entries = [second[a, b] for a, b in _UPPER]
        rows.append([float(x) for x in (moments.mass, *moments.first, *entries)])
    return np.array(rows)


def matrix_of(parameters: Array) -> Array:
    """The pseudo-inertia matrix of a body (4, 4): [[Sigma, h], [h, m]], positive for any mass distribution.

    Args:
        parameters: (..., 10).
    """
    p = np.asarray(parameters, float)
    full = np.empty((*p.shape[:-1], 4, 4))
    full[..., 3, 3] = p[..., 0]
    full[..., :3, 3] = full[..., 3, :3] = p[..., 1:4]
    for k, (row, column) in enumerate(_UPPER):
        full[..., row, column] = full[..., column, row] = p[..., 4 + k]
    return full


def parameters_of(matrix: Array) -> Array:
    """The inverse of `matrix_of`: (..., 4, 4) to (..., 10)."""
    first = (matrix[..., a, 3] for a in range(3))
    return np.stack([matrix[..., 3, 3], *first, *(matrix[..., a, b] for a, b in _UPPER)], axis=-1)


@dataclass(frozen=True)
class JointMotions:
    """The motion of all motors: angle [rad], velocity [rad/s], acceleration [rad/s^2], each (n, joints)."""

    theta_m: Array
    omega_m: Array
    alpha_m: Array

    @property
    def still(self) -> JointMotions:
        """The same angles at rest, where only gravity acts."""
        zero = np.zeros_like(self.theta_m)
        return JointMotions(self.theta_m, zero, zero)


@dataclass(frozen=True)
class Bodies:
    """Torques [N m, motor side] and bearing loads of one joint, each (n,)."""

    gravity: Array  # holding torque against gravity
    moving: Array  # inertial, centrifugal and Coriolis torque of the bodies
    rotor: Array  # torque to accelerate the motor's rotor
    F_N: Array  # loads of the bearing [N, N, N m], 0 where a guide has none
    F_T: Array
    M_B: Array

    @property
    def whole(self) -> Array:
        """Drive torque without friction."""
        return self.gravity + self.moving + self.rotor

    def scaled(self, factor: float) -> Bodies:
        """A copy with the torques in another unit; the loads are unchanged."""
        if factor == 1.0:
            return self
        return replace(
            self, gravity=factor * self.gravity, moving=factor * self.moving, rotor=factor * self.rotor
        )


class BodyModule:
    """The emitted NumPy module of a chain with symbolic bodies, called with the current values."""

    def __init__(self, chain: Chain) -> None:
        self.chain = chain
        lettered = with_letters(chain, f"{chain.name}_letters")
        choice = Choice(("inverse_dynamics", "bearing_loads"), "none")
        files = render_code(arm(lettered, lettered.name), "numpy", choice)
        self._module = executed(files, lettered.name)
        self._names = names_of(len(chain.joints))
        self._mu = np.array([float(joint.mu) for joint in chain.joints])
        self._J_m = np.array([float(joint.J_m) for joint in chain.joints])

    @property
    def loads(self) -> tuple[str, ...]:
        """Labels of the values of `bearing_loads`."""
        return self._module.BEARING_LOADS

    @property
    def count(self) -> int:
        """Number of inertial parameters."""
        return len(self._names)

    def torques(self, motion: JointMotions, values: Array) -> Array:
        """Torque of bodies and rotors, motor side [N m], shape (n, joints).

        Args:
            motion: of the motors.
            values: inertial parameters (joints, 10).
        """
        return self._module.inverse_dynamics(*self._inputs(motion), self._parameters(values))

    def regressor(self, motion: JointMotions, places: Sequence[int] | None = None) -> Array:
        """The torques per unit of each inertial parameter, without rotors, shape (n, joints, parameters).

        Args:
            motion: of the motors.
            places: indices of the parameters, in 10 per joint; by default all.
        """
        chosen = range(self.count) if places is None else places
        rotors, unit = self.torques(motion, np.zeros(self.count)), np.eye(self.count)
        columns = np.empty((*motion.theta_m.shape, len(chosen)))
        for k, place in enumerate(chosen):
            columns[:, :, k] = self.torques(motion, unit[place]) - rotors
        return columns

    def met(self, motion: JointMotions, values: Array) -> tuple[Bodies, ...]:
        """Torques and loads of every joint, for the inertial parameters (joints, 10)."""
        parameters = self._parameters(values)
        every = self._module.bearing_loads(*self._inputs(motion), parameters)
        loads = dict(zip(self._module.BEARING_LOADS, np.moveaxis(every, -1, 0), strict=True))
        total, gravity = self.torques(motion, values), self.torques(motion.still, values)
        zero = np.zeros(len(total))
        joints = []
        for j in range(len(self._mu)):
            # Its magnitude is an output of the module; its sign is that of the torque without the rotor.
            size, rest = self._mu[j] * loads[f"T_{j}"], total[:, j] - self._J_m[j] * motion.alpha_m[:, j]
            passed = np.where(rest < 0.0, -size, size) if self._J_m[j] else total[:, j]
            joints.append(
                Bodies(
                    gravity[:, j],
                    passed - gravity[:, j],
                    total[:, j] - passed,
                    *(loads.get(f"{name}_{j}", zero) for name in ("F_N", "F_T", "M_B")),
                )
            )
        return tuple(joints)

    def _inputs(self, motion: JointMotions) -> Sequence[Array]:
        return motion.theta_m, motion.omega_m, motion.alpha_m

    def _parameters(self, values: Array):  # noqa: ANN202 - a class of the emitted module
        return self._module.Parameters(**dict(zip(self._names, map(float, np.ravel(values)), strict=True)))
