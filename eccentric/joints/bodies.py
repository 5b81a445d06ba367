"""The bodies of an arm from its logs: base parameters of all joints at once, and bodies that have them.

Each joint's torque is linear in the inertial parameters and in its own friction. The joints are weighted by
what a fit of each alone leaves, so that a strong drive does not drown the wrist.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from eccentric.identification import (
    Coefficient,
    Design,
    Estimate,
    Solution,
    base_coefficients,
    base_columns,
    rms,
)
from eccentric.joints.arm_log import ArmLog
from eccentric.joints.base_parameters import (
    COUNT,
    BaseParameters,
    base_of,
    matrix_of,
    names_of,
    parameters_of,
)
from eccentric.joints.limits import IN_ERRORS, LEAST_EIGENVALUE, PROJECTIONS, TIGHTEST
from eccentric.model import letters_of

# Bodies that could exist and have given base parameters: the nearest to those of the arm file.
#
# A mass is positive, and so is the matrix [[Sigma, h], [h, m]] of the moments of any distribution of it. Base
# parameters leave the bodies open along what no torque shows; the loads of the bearings depend on it too. So
# the bodies start as the arm file has them and are moved no further than the base parameters and those
# conditions require: projections onto both in turn, each convex, so that they converge to a common point if
# there is one.
#
# Reference: P. M. Wensing, S. Kim and J.-J. E. Slotine, "Linear matrix inequalities for physically consistent
# inertial parameter identification", IEEE Robotics and Automation Letters 3(1), 2018.


Array = NDArray[np.float64]


@dataclass(frozen=True)
class PossibleBodies:
    """Bodies that could exist.

    Attributes:
        values: their inertial parameters (joints, 10).
        misfit: the largest difference of their base parameters from the identified ones, in standard errors.
    """

    values: Array
    misfit: float

    @property
    def explain(self) -> bool:
        """Whether they have the identified base parameters, within their errors."""
        return self.misfit <= IN_ERRORS


def possible_bodies(
    nominal: Array, base: BaseParameters, found: Array, errors: Array, fixed: Collection[str] = ()
) -> PossibleBodies:
    """The bodies next to the nominal ones that have these base parameters.

    Args:
        nominal: inertial parameters of the arm file (joints, 10).
        base: which sums of them the log determines.
        found, errors: the identified sums and their standard errors (r,).
        fixed: "mass", "centre" or both, where the arm file is right.
    """
    joints, length = len(nominal), _length(nominal)
    mass = float(np.mean(np.abs(nominal[:, 0]))) or 1.0
    one = np.r_[1.0, [length] * 3, [length**2] * 6] * mass
    # Off the diagonal an entry stands twice in the matrix: both projections then measure alike.
    one[[1, 2, 3, 5, 6, 8]] /= np.sqrt(2.0)
    scale = np.tile(one, joints)
    held = np.zeros(COUNT, dtype=bool)
    held[0] = "mass" in fixed
    held[1:4] = {"mass", "centre"} <= set(fixed)
    kept = np.eye(joints * COUNT)[np.tile(held, joints)]
    # A sum without a standard error restricts nothing, and says nothing of whether bodies explain it.
    finite = np.isfinite(errors)
    least = np.max(errors[finite], initial=np.finfo(float).tiny) * TIGHTEST
    weight = np.where(finite, 1.0 / np.maximum(np.where(finite, errors, 1.0), least), 0.0)
    rows = np.vstack([base.sums * weight[:, None], kept * 1e3]) * scale
    right = np.r_[found * weight, 1e3 * kept @ nominal.ravel()]
    back = np.linalg.pinv(rows)
    x = nominal.ravel() / scale
    for _ in range(PROJECTIONS):
        on_sums = x + back @ (right - rows @ x)
        x = _positive((on_sums * scale).reshape(joints, COUNT), length, mass).ravel() / scale
        if np.max(np.abs(x - on_sums)) < LEAST_EIGENVALUE:
            break
    values = (x * scale).reshape(joints, COUNT)
    misfit = np.abs(base.sums @ values.ravel() - found) * weight
    return PossibleBodies(values, float(np.max(misfit, initial=0.0)) if finite.any() else np.inf)


def _positive(values: Array, length: float, mass: float) -> Array:
    """The nearest bodies that could exist (joints, 10)."""
    units = np.array([length, length, length, 1.0]) * np.sqrt(mass)
    own, vectors = np.linalg.eigh(matrix_of(values) / np.outer(units, units))
    own = np.maximum(own, LEAST_EIGENVALUE)
    matrix = np.einsum("jab,jb,jcb->jac", vectors, own, vectors)
    return parameters_of(matrix * np.outer(units, units))


def _length(nominal: Array) -> float:
    """A length of the size of the bodies [m]."""
    masses = np.maximum(nominal[:, 0], 1e-12)
    spread = np.sqrt(np.abs(nominal[:, [4, 7, 9]].sum(axis=1)) / masses)
    return float(np.max(spread)) or 0.1


@dataclass(frozen=True)
class IdentifiedBodies:
    """What the logs say of the bodies.

    Attributes:
        base: the sums of inertial parameters that they determine.
        estimates: of each, by the name of its first parameter, with the sum in words in `sums`.
        sums: in words.
        bodies: bodies that could exist, next to the declared ones.
    """

    base: BaseParameters
    estimates: Mapping[str, Estimate]
    sums: tuple[str, ...]
    bodies: PossibleBodies


def identified_bodies(log: ArmLog) -> IdentifiedBodies | None:
    """The bodies by the training part; None where they are known, or a drive has no torque.

    Friction is Coulomb and viscous, and by the loads of the declared bodies where a joint can show it.
    """
    if not log.rig.open or any(log.drive(j).unit != "N m" for j in range(len(log))):
        return None
    base, solution = pooled([_block(log, j) for j in range(len(log))], names_of(len(log)))
    estimates = dict([*solution.estimates().items()][: len(base.chosen)])
    found = solution.values[: len(base.chosen)]
    errors = np.array([e.std_error for e in estimates.values()])
    possible = possible_bodies(log.values, base, found, errors, log.rig.known)
    return IdentifiedBodies(base, estimates, tuple(base.words(names_of(len(log)))), possible)


@dataclass(frozen=True)
class Block:
    """Rows of a joint: torque without the rotors' share, columns of inertial parameters and of friction.

    `weight` is one over what a fit of the joint alone leaves, in the unit of its torque.
    """

    target: Array
    bodies: Array
    weight: float
    friction: Array
    coefficients: tuple[Coefficient, ...] = ()


def pooled(
    blocks: Sequence[Block], names: Sequence[str], lower: float = -np.inf
) -> tuple[BaseParameters, Solution]:
    """All joints at once: base parameters of the bodies, then the friction of each joint.

    `names` are those of the inertial parameters, `lower` is the bound of a mass.
    """
    base = base_of(np.vstack([block.bodies * block.weight for block in blocks]))
    bodies = [
        Coefficient(names[k], "bodies", letters_of(0)[k % COUNT].unit, -np.inf if k % COUNT else lower)
        for k in base.chosen
    ]
    shared = np.vstack([block.bodies[:, base.chosen] for block in blocks])
    columns = np.hstack([shared, block_diag(*(block.friction for block in blocks))])
    target = np.concatenate([block.target for block in blocks])
    weights = np.concatenate([np.full(len(block.target), block.weight**2) for block in blocks])
    every = (*bodies, *(c for block in blocks for c in block.coefficients))
    return base, Design(every, target, columns, np.ones(len(target), dtype=bool), weights).solve()


def _block(log: ArmLog, j: int) -> Block:
    """The training rows of a joint."""
    rows, drive = log.rows(j), log.drive(j)
    train = rows.train
    loads = log.present(j)
    model, data = log.joint(j, loads)
    every = base_coefficients(model, data.signals)
    own = [k for k, c in enumerate(every) if c.role == "friction"]
    friction = rows.mean(base_columns(model, data.signals)[:, own])[train]
    regressor = rows.plain_mean(log.regressor(j))[train]
    rotors = log.module.torques(log.motion(), np.zeros(log.module.count))[:, j]
    target = rows.mean(drive.torque())[train] - rows.plain_mean(rotors)[train]
    named = tuple(replace(every[k], name=f"{every[k].name}_{log.rig.number(j)}") for k in own)
    base = base_of(regressor)
    whole = np.column_stack([regressor[:, base.chosen], friction])
    left = target - whole @ np.linalg.lstsq(whole, target, rcond=None)[0]
    return Block(target, regressor, 1.0 / rms(left), friction, named)
