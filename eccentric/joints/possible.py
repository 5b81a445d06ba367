"""Bodies that could exist and have given base parameters: the nearest to those of the arm file.

A mass is positive, and so is the matrix [[Sigma, h], [h, m]] of the moments of any distribution of it. Base
parameters leave the bodies open along what no torque shows; the loads of the bearings depend on it too. So
the bodies start as the arm file has them and are moved no further than the base parameters and those
conditions require: projections onto both in turn, each convex, so that they converge to a common point if
there is one.

Reference: P. M. Wensing, S. Kim and J.-J. E. Slotine, "Linear matrix inequalities for physically consistent
inertial parameter identification", IEEE Robotics and Automation Letters 3(1), 2018.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.joints.base_parameters import BaseParameters
from eccentric.joints.inertial import COUNT, matrix_of, parameters_of
from eccentric.joints.limits import IN_ERRORS, LEAST_EIGENVALUE, PROJECTIONS, TIGHTEST

__all__ = ["PossibleBodies", "possible_bodies"]

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
