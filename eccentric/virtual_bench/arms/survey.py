"""What an arm goes through along its reference: loads and torques, as if its drives followed it perfectly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eccentric.virtual_bench.arms.course import ArmCourse
from eccentric.virtual_bench.arms.engine import RigidArm
from eccentric.virtual_bench.arms.plant import BenchArm

SURVEY_S = 0.02
"""Between two rows of a survey."""
_AT_ONCE = 64
"""Places of the arm that are computed together."""


@dataclass(frozen=True)
class Survey:
    """Rows along the reference of all runs, one after the other; torques of the joints [N m].

    Attributes:
        q, w, alpha: angles, velocities, accelerations, shape (rows, joints).
        bearing: F_N, F_T [N], M_B [N m], shape (rows, 3, joints).
        transmitted: torque that each gear passes on, (rows, joints).
        gravity: its part that holds the arm at rest.
        torque: what the drives give without friction, rotors included.
        inertia: diagonal of the mass matrix [kg m^2], rotors included.
    """

    q: np.ndarray
    w: np.ndarray
    alpha: np.ndarray
    bearing: np.ndarray
    transmitted: np.ndarray
    gravity: np.ndarray
    torque: np.ndarray
    inertia: np.ndarray


def survey(arm: BenchArm, course: ArmCourse) -> Survey:
    """Take the arm along its reference by inverse dynamics."""
    time, motions = np.arange(0.0, course.seconds, SURVEY_S), []
    for run in range(course.runs):
        q, w = course.reference(run, time)
        motions.append((q, w, np.gradient(w, SURVEY_S, axis=0)))
    q, w, alpha = (np.concatenate(part) for part in zip(*motions, strict=True))
    rigid, parts = RigidArm(arm, _AT_ONCE), []
    for first in range(0, len(q), _AT_ONCE):
        rows = np.minimum(np.arange(first, first + _AT_ONCE), len(q) - 1)  # the last one fills up
        rigid.place(q[rows], w[rows])
        mass, loads = rigid.mass(), rigid.loads(alpha[rows])
        torque = np.einsum("kji,ki->kj", mass, alpha[rows]) + rigid.bias()
        inertia = np.einsum("kjj->kj", mass)
        parts.append((loads.bearing, loads.transmitted, rigid.gravity_torque(), torque, inertia))
    return Survey(q, w, alpha, *(np.concatenate(part)[: len(q)] for part in zip(*parts, strict=True)))


def rms(values: np.ndarray) -> np.ndarray:
    """Return the root of the mean square over the rows."""
    return np.sqrt(np.mean(np.square(values), axis=0))
