"""The free cubic of a coast-down: c_0 + c_1 |w| + c_2 w^2 + c_3 |w|^3 against the motion, without bounds.

Spin-down tests publish these four, and a coast-down on a level axis shows no more: the speed is its only
variable, so that air drag with w^2 has the same column as friction under a load that grows with w^2.
"""

from __future__ import annotations

import numpy as np

from eccentric.identification.drive import in_drive_unit
from eccentric.identification.problem import Problem
from eccentric.identification.regression import Solution
from eccentric.identification.uncertainty import Estimate, Spread, covariance

_UNITS = ("N m", "N m s/rad", "N m s^2/rad^2", "N m s^3/rad^3")


def free_cubic(problem: Problem, paper: Solution) -> dict[str, Estimate]:
    """The coefficients c_0 to c_3, in the unit of the fit; none but of a coast-down in case C1.

    Args:
        problem: of the fit.
        paper: its solution.
    """
    drive, rows = problem.drive, problem.rows
    if not drive.channels.motor.coasting or problem.rig.case != "C1":
        return {}
    omega = drive.channels.motion.omega_m
    powers = np.stack([np.sign(omega) * np.abs(omega) ** n for n in range(len(_UNITS))], axis=1)
    root = np.sqrt(rows.weights)[rows.train]
    design = root[:, None] * rows.mean(powers)[rows.train]
    target = root * problem.design(paper.at).target[rows.train]
    size = np.linalg.norm(design, axis=0)
    values = np.linalg.lstsq(design / size, target, rcond=None)[0] / size
    matrix = covariance(design, target - design @ values)
    spread = Spread(matrix, np.zeros(len(values)), np.zeros((0, len(values))))
    return {
        f"c_{n}": spread.estimate(value, np.eye(len(values))[n], in_drive_unit(unit, problem.unit))
        for n, (value, unit) in enumerate(zip(values, _UNITS, strict=True))
    }
