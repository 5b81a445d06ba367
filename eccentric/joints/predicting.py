"""Predict other runs of an arm with a fit, and identify their payload.

Friction and bodies are fixed at the fitted values. A payload is a body in the frame of the last joint; its
torques are linear in its ten inertial parameters, only some of which are identifiable from the runs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from eccentric.identification import Estimate, improvement, rms
from eccentric.joints.arm_log import ArmLog, arm_log
from eccentric.joints.base_parameters import COUNT, names_of
from eccentric.joints.bodies import Block, pooled
from eccentric.joints.fitted import ArmFit
from eccentric.logs import LogSource
from eccentric.rigs import ArmRig, NamedHoldout
from eccentric.signals import Rows, read_joints

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ForeignRuns:
    """Runs that were not used in a fit, predicted by it.

    Attributes:
        log: the runs.
        residuals, drives: of each joint on its moving rows (m,), in the unit of its fit.
        rows: of each joint, with the mask of the moving ones.
    """

    log: ArmLog
    residuals: tuple[Array, ...]
    drives: tuple[Array, ...]
    rows: tuple[tuple[Rows, NDArray[np.bool_]], ...]

    @property
    def rmse(self) -> tuple[float, ...]:
        """Error of each joint."""
        return tuple(rms(x) for x in self.residuals)


@dataclass(frozen=True)
class Payload:
    """A payload of runs that the fit did not have.

    Attributes:
        estimates: its identifiable inertial parameters in the frame of the last joint.
        rmse: error of each joint with it.
        gains: reduction of each joint's error in percent, with the 95 % interval.
    """

    estimates: Mapping[str, Estimate]
    rmse: tuple[float, ...]
    gains: tuple[tuple[float, tuple[float, float]], ...]


def predicted(found: ArmFit, logs: Sequence[LogSource], runs: Sequence[str]) -> ForeignRuns:
    """Predict runs of the same arm, by names or patterns, with the friction and bodies of a fit.

    Raises:
        InputError: no run has such a name, or a joint does not move in them.
    """
    rig = _of_runs(found, runs)
    log = replace(
        arm_log(rig, read_joints(logs, rig)),
        values=found.log.values,
        scales=found.log.scales,
        gains=found.log.gains,
        _bases=found.log.bases,
    )
    residuals, drives, rows = [], [], []
    for j, joint in enumerate(found.joints):
        model, data = log.joint(j, joint.loads.followed)
        fit = joint.followed
        residual = data.residuals(model, {}, fit.values, fit.scale).rows("mechanical", fit.values)
        for c, column in data.signals.open.items():
            residual = residual - data.rows.plain_mean(column) * fit.estimates[c.name].value
        used = data.rows.train | data.rows.score
        residuals.append(residual[used])
        drives.append(data.rows.mean(data.drive.torque())[used])
        rows.append((data.rows, used))
    return ForeignRuns(log, tuple(residuals), tuple(drives), tuple(rows))


def payload_of(found: ForeignRuns) -> Payload:
    """Identify the payload from the prediction residuals, in a weighted fit of all joints at once."""
    last = len(found.log) - 1
    places = range(last * COUNT, (last + 1) * COUNT)
    regressor = found.log.module.regressor(found.log.motion(), places)
    blocks = []
    for target, (rows, used), scale, columns in zip(
        found.residuals, found.rows, found.log.scales, np.moveaxis(regressor, 1, 0), strict=True
    ):
        bodies = scale * rows.plain_mean(columns)[used]
        residual = target - bodies @ np.linalg.lstsq(bodies, target, rcond=None)[0]
        blocks.append(Block(target, bodies, 1.0 / max(rms(residual), 1e-300), np.empty((len(target), 0))))
    names = [name.replace(f"_{last}", "_payload") for name in names_of(last + 1)[last * COUNT :]]
    _, solution = pooled(blocks, names, lower=0.0)  # a payload has no negative mass
    after = np.split(solution.residual, np.cumsum([len(block.target) for block in blocks])[:-1])
    gains = tuple(improvement(*pair) for pair in zip(found.residuals, after, strict=True))
    return Payload(solution.estimates(), tuple(rms(x) for x in after), gains)


def _of_runs(found: ArmFit, runs: Sequence[str]) -> ArmRig:
    """The rig of the fit for other runs, with the same low pass."""
    joints = tuple(
        replace(
            one,
            log=replace(one.log, runs=tuple(runs)),
            holdout=NamedHoldout((), ()),
            sampling=channels.rig.sampling,
        )
        for one, channels in zip(found.log.rig.joints, found.log.channels, strict=True)
    )
    return replace(found.log.rig, joints=joints)
