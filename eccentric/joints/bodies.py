"""The bodies of an arm from its logs: base parameters of all joints at once, and consistent bodies.

Each joint's torque is linear in the inertial parameters and in its friction. The joints are weighted by the
residual of their separate fits, so that the strong base drives do not dominate the wrist.
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

Array = NDArray[np.float64]


# Physically consistent bodies with given base parameters: the nearest to those of the arm file.
#
# Mass is positive, and so is the pseudo-inertia matrix [[Sigma, h], [h, m]] of any mass distribution. Base
# parameters leave combinations open that no torque shows, but bearing loads depend on them. So the bodies
# start at those of the arm file and are moved no further than base parameters and consistency require, by
# alternating projections onto both convex sets, which converge to a common point if there is one.
#
# Reference: P. M. Wensing, S. Kim and J.-J. E. Slotine, "Linear matrix inequalities for physically consistent
# inertial parameter identification", IEEE Robotics and Automation Letters 3(1), 2018.
@dataclass(frozen=True)
class PossibleBodies:
    """Physically consistent bodies."""

    values: Array  # inertial parameters (joints, 10)
    # the largest deviation of their base parameters from the identified ones, in standard errors
    misfit: float

    @property
    def explain(self) -> bool:
        """Whether they match the identified base parameters within their errors."""
        return self.misfit <= IN_ERRORS


def possible_bodies(
    nominal: Array, base: BaseParameters, found: Array, errors: Array, fixed: Collection[str] = ()
) -> PossibleBodies:
    """The consistent bodies nearest to the nominal ones that have these base parameters.

    Args:
        nominal: inertial parameters of the arm file (joints, 10).
        base: the combinations determined by the log.
        found, errors: the identified base parameters and their standard errors (r,).
        fixed: "mass", "centre" or both, where the arm file is correct.
    """
    joints, length = len(nominal), _length(nominal)
    mass = float(np.mean(np.abs(nominal[:, 0]))) or 1.0
    units = np.r_[1.0, [length] * 3, [length**2] * 6] * mass
    # Off-diagonal entries occur twice in the matrix: both projections then use the same metric.
    units[[1, 2, 3, 5, 6, 8]] /= np.sqrt(2.0)
    scale = np.tile(units, joints)
    is_fixed = np.zeros(COUNT, dtype=bool)
    is_fixed[0] = "mass" in fixed
    is_fixed[1:4] = {"mass", "centre"} <= set(fixed)
    constraints = np.eye(joints * COUNT)[np.tile(is_fixed, joints)]
    # A combination without a standard error is no constraint and does not count in the misfit.
    finite = np.isfinite(errors)
    least = np.max(errors[finite], initial=np.finfo(float).tiny) * TIGHTEST
    weight = np.where(finite, 1.0 / np.maximum(np.where(finite, errors, 1.0), least), 0.0)
    rows = np.vstack([base.sums * weight[:, None], constraints * 1e3]) * scale
    right = np.r_[found * weight, 1e3 * constraints @ nominal.ravel()]
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
    """The nearest consistent bodies (joints, 10)."""
    units = np.array([length, length, length, 1.0]) * np.sqrt(mass)
    eigenvalues, vectors = np.linalg.eigh(matrix_of(values) / np.outer(units, units))
    eigenvalues = np.maximum(eigenvalues, LEAST_EIGENVALUE)
    matrix = np.einsum("jab,jb,jcb->jac", vectors, eigenvalues, vectors)
    return parameters_of(matrix * np.outer(units, units))


def _length(nominal: Array) -> float:
    """A characteristic length of the bodies [m]."""
    masses = np.maximum(nominal[:, 0], 1e-12)
    spread = np.sqrt(np.abs(nominal[:, [4, 7, 9]].sum(axis=1)) / masses)
    return float(np.max(spread)) or 0.1


@dataclass(frozen=True)
class IdentifiedBodies:
    """Bodies identified from the logs."""

    base: BaseParameters  # the base parameters
    estimates: Mapping[str, Estimate]  # of each, by the name of its first parameter
    sums: tuple[str, ...]  # each base parameter as a linear combination, in text
    bodies: PossibleBodies  # the consistent bodies nearest to the declared ones


def identified_bodies(log: ArmLog) -> IdentifiedBodies | None:
    """Identify the bodies on the training part; None if they are known, or a drive's torque is unknown.

    Friction is Coulomb and viscous, plus friction by the loads of the declared bodies where identifiable.
    """
    if not log.rig.open or any(log.drive(j).unit != "N m" for j in range(len(log))):
        return None
    base, solution = pooled([_block(log, j) for j in range(len(log))], names_of(len(log)))
    estimates = dict([*solution.estimates().items()][: len(base.chosen)])
    values = solution.values[: len(base.chosen)]
    errors = np.array([e.std_error for e in estimates.values()])
    possible = possible_bodies(log.values, base, values, errors, log.rig.known)
    return IdentifiedBodies(base, estimates, tuple(base.words(names_of(len(log)))), possible)


@dataclass(frozen=True)
class Block:
    """Rows of a joint: torque without the rotors' part, columns of inertial parameters and of friction."""

    target: Array
    bodies: Array
    weight: float  # the inverse RMS residual of the joint's separate fit, in the unit of its torque
    friction: Array
    coefficients: tuple[Coefficient, ...] = ()


def pooled(
    blocks: Sequence[Block], names: Sequence[str], lower: float = -np.inf
) -> tuple[BaseParameters, Solution]:
    """Fit all joints at once: base parameters of the bodies, then the friction of each joint.

    `names` are those of the inertial parameters, `lower` is the lower bound of a mass.
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
    rows, drive = log.rows(j), log.drive(j)
    train = rows.train
    loads = log.present(j)
    model, data = log.joint(j, loads)
    every = base_coefficients(model, data.signals)
    places = [k for k, c in enumerate(every) if c.role == "friction"]
    friction = rows.mean(base_columns(model, data.signals)[:, places])[train]
    regressor = rows.plain_mean(log.regressor(j))[train]
    rotors = log.module.torques(log.motion(), np.zeros(log.module.count))[:, j]
    target = rows.mean(drive.torque())[train] - rows.plain_mean(rotors)[train]
    named = tuple(replace(every[k], name=f"{every[k].name}_{log.rig.number(j)}") for k in places)
    base = base_of(regressor)
    design = np.column_stack([regressor[:, base.chosen], friction])
    residual = target - design @ np.linalg.lstsq(design, target, rcond=None)[0]
    return Block(target, regressor, 1.0 / rms(residual), friction, named)
