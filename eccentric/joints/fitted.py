"""Fit the friction of every joint of an arm: Coulomb and viscous alone, and with load-dependent friction.

The loads are selected on the training part; the held-out part is used once, for the errors.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from eccentric.core import counted
from eccentric.diagnosis import Candidate, OverRuns, balances_of, leave_runs_out, searched_loads
from eccentric.effects import Evidence
from eccentric.identification import (
    LEAST_R_SQUARED,
    Drive,
    Estimate,
    FitData,
    Refit,
    compiled,
    drive_noise,
    improvement,
    r_squared,
    refit,
    rms,
)
from eccentric.joints.arm_log import ArmLog, arm_log
from eccentric.joints.base_parameters import COUNT, names_of
from eccentric.joints.bodies import Block, IdentifiedBodies, identified_bodies, pooled
from eccentric.joints.joint_model import OF_BENDING, OF_FORCES
from eccentric.logs import LogSource
from eccentric.model import Load, Role
from eccentric.rigs import ArmRig, NamedHoldout
from eccentric.signals import LEAST_HELD_OUT, Rows, read_joints, require_rows

Array = NDArray[np.float64]


# Selection of the loads that a joint's friction depends on, on the training part.
#
# The loads compete as effects do in a diagnosis: blocked cross-validation, a required gain per addition,
# stability in resampled logs. Correlated loads may explain a log equally well.
@dataclass(frozen=True)
class LoadsOfAJoint:
    """Load dependence of a joint's friction, from the training part."""

    present: tuple[Load, ...]  # the loads whose friction the log can separate from load-independent friction
    # the selected loads, in order of adoption; none where Coulomb and viscous friction is enough
    followed: tuple[Load, ...]
    alike: tuple[Load, ...]  # loads that would explain the log as well as one of these
    deviance: float  # twice the cross-validated gain in log-likelihood by the best single load
    required: float  # the gain required for an addition


def loads_of(log: ArmLog, j: int) -> LoadsOfAJoint:
    """Select the loads that the friction of joint j depends on."""
    present = log.present(j)
    _, every = log.joint(j, present)
    model, without_loads = log.joint(j, ())
    balances, noise = balances_of(without_loads, log.channels[j].rig, model)
    candidates = [one for load in present for one in _candidates(load, every)]
    found = searched_loads(balances[0], candidates, noise["mechanical"], len(log))
    return LoadsOfAJoint(
        present,
        tuple(Load(name) for name in found.adopted),
        tuple(Load(name) for name in found.alike if name not in found.adopted),
        found.deviance,
        found.required,
    )


def _candidates(load: Load, data: FitData) -> list[Candidate]:
    """Friction by one load: Coulomb and viscous, or viscous alone."""
    model = data.signals.base
    if model is None:
        raise AssertionError("the log of a joint has a model")
    by_role = {
        column.role: compiled(model, column.basis, data.signals)({}, {})
        for column in data.signals.columns(model)
        if column.load is load
    }
    both = np.column_stack([by_role[Role.COULOMB], by_role[Role.VISCOUS]])
    return [
        Candidate(
            id=f"{load.value}{ending}",
            family=load.value,
            balance="mechanical",
            evidence=Evidence((load.value,)),
            columns=lambda _, columns=columns: columns,
            lower=(0.0,),
        )
        for ending, columns in (("", both), (", viscous", both[:, 1:]))
    ]


@dataclass(frozen=True)
class JointFit:
    """The friction of one joint.

    Attributes:
        number: of the joint in the columns; name: in the arm file.
        loads: the loads its friction depends on, selected on the training part.
        linear, followed, every: fits of Coulomb and viscous friction, with the selected loads (`linear`
            itself without any), and with every identifiable load.
        rmse: of these three on the held-out rows, in `unit`.
        percent, interval: 100 (1 - followed/linear) and its 95 % interval.
        over_runs: every run predicted from the others; None with fewer than five runs.
        torque_rms, noise: RMS of the drive and of its white noise on these rows, in `unit`.
    """

    number: int
    name: str
    loads: LoadsOfAJoint
    linear: Refit
    followed: Refit
    every: Refit
    rmse: Mapping[str, float]
    percent: float
    interval: tuple[float, float]
    over_runs: OverRuns | None
    r_squared: float
    torque_rms: float
    noise: float

    @property
    def data(self) -> FitData:
        """The log of the joint."""
        return self.followed.data

    @property
    def unit(self) -> str:
        """Unit of torques: "N m", or "A" where the torque constant is unknown."""
        return self.data.drive.unit

    @property
    def fits_the_rig(self) -> bool:
        """Whether the log can be of this joint, in these units: otherwise nothing is concluded from it."""
        return self.r_squared >= LEAST_R_SQUARED

    @property
    def confirmed(self) -> bool:
        """Whether the held-out part confirms the selected loads."""
        return self.interval[0] > 0.0

    @property
    def friction(self) -> dict[str, Estimate]:
        """Friction coefficients of the fit `followed`, per `unit` of torque."""
        units = {q.name: q.unit for q in self.followed.model.friction_parameters}
        return {
            name: replace(e, unit=_unit_of(name, units[name], self.unit))
            for name, e in self.followed.estimates.items()
            if name in units
        }


@dataclass(frozen=True)
class ArmFit:
    """The friction of every joint of an arm.

    Attributes:
        log: the logs, with the bodies used.
        names: of the logs.
        bodies: the identified bodies; None if they are declared, or a torque is unknown.
        joints: from the base outwards.
    """

    log: ArmLog
    names: tuple[str, ...]
    bodies: IdentifiedBodies | None
    joints: tuple[JointFit, ...]

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the logs, stated once if they concern all joints."""
        return warnings_of(self.log, self.bodies)

    @property
    def fits_the_rig(self) -> bool:
        """Whether the log can be of this arm, in these units."""
        return all(joint.fits_the_rig for joint in self.joints)


def fit_arm(
    logs: Sequence[LogSource], rig: ArmRig, names: Sequence[str], tell: Callable[[str], None] = lambda _: None
) -> ArmFit:
    """Fit the friction of every joint.

    Args:
        logs: those of one arm, as `read_log` accepts them.
        rig: of the arm.
        names: of the logs.
        tell: called with one line per stage.

    Raises:
        InputError: bad input; too few rows of a joint.
    """
    log, bodies = prepared(logs, rig, tell)
    joints = []
    for j in range(len(log)):
        joints.append(fit_joint(log, j, ", ".join(names)))
        tell(f"joint {joints[-1].number}: {_summary(joints[-1])}")
    return ArmFit(log, tuple(names), bodies, tuple(joints))


def prepared(
    logs: Sequence[LogSource], rig: ArmRig, tell: Callable[[str], None]
) -> tuple[ArmLog, IdentifiedBodies | None]:
    """The logs of an arm, with its bodies identified if they are open and the torques known."""
    log = arm_log(rig, read_joints(logs, rig))
    tell(f"{counted(len(log), 'joint')}, {log.channels[0].intake.read} rows")
    bodies = identified_bodies(log)
    if bodies is not None:
        tell(f"{len(bodies.estimates)} base parameters of the bodies")
        log = log.with_values(bodies.bodies.values)
    return log, bodies


def fit_joint(log: ArmLog, j: int, where: str) -> JointFit:
    """Fit one joint, counted from 0 at the base; `where` names the logs."""
    loads = loads_of(log, j)
    model, data = log.joint(j, loads.followed)
    number = log.rig.number(j)
    require_rows(data.rows, "score", LEAST_HELD_OUT, f"{where}: joint {number}")
    linear = refit(model, (), data, linear=True)
    followed = refit(model, (), data) if loads.followed else linear
    full, with_all = log.joint(j, loads.present)
    every = followed if set(loads.present) == set(loads.followed) else refit(full, (), with_all)
    rows = data.rows.score
    fits = {"linear": linear, "followed": followed, "every": every}
    residuals = {name: fit.residuals["mechanical"][rows] for name, fit in fits.items()}
    gain = (0.0, (0.0, 0.0))
    if loads.followed:
        gain = improvement(residuals["linear"], residuals["followed"])
    drive = data.rows.mean(data.drive.torque())[rows]
    return JointFit(
        number,
        log.rig.chain.joints[j].name,
        loads,
        linear,
        followed,
        every,
        {name: rms(x) for name, x in residuals.items()},
        *gain,
        leave_runs_out(model, followed, data),
        r_squared(residuals["followed"], drive),
        rms(drive),
        drive_noise(data),
    )


def warnings_of(log: ArmLog, bodies: IdentifiedBodies | None) -> tuple[str, ...]:
    """Warnings about the logs: those of one joint with its number, those of all joints once."""
    each = [dict.fromkeys(channels.intake.warnings) for channels in log.channels]
    common = [text for text in each[0] if all(text in texts for texts in each)]
    # The zero angle applies to a single link: gravity of an arm depends on all angles.
    zero_angle = {f.text for c in log.channels for f in c.intake.findings if f.kind == "zero_angle"}
    specific = [
        f"joint {log.rig.number(j)}: {text}"
        for j, texts in enumerate(each)
        for text in texts
        if text not in common and text not in zero_angle
    ]
    warnings = [*common, *specific]
    if bodies is not None and not bodies.bodies.explain:
        warnings.append(
            "no real bodies have the identified base parameters: the nearest differ in one by"
            f" {bodies.bodies.misfit:.1f} standard errors, and determine the loads"
        )
    return tuple(warnings)


def _summary(joint: JointFit) -> str:
    if not joint.fits_the_rig:
        return f"does not fit the rig (R^2 {joint.r_squared:.2f})"
    loads = ", ".join(joint.loads.followed) or "Coulomb and viscous friction is enough"
    return f"{loads}; {joint.rmse['linear']:.4g} to {joint.rmse['followed']:.4g} {joint.unit}"


def _unit_of(name: str, unit: str, drive: str) -> str:
    """The unit of a friction coefficient if the drive is in amperes.

    Bearing loads remain in N and N m; the transmitted torque is in the unit of the drive.
    """
    if drive == "N m":
        return unit
    # The gear ratio of a slide is in m/rad, which is part of the unit.
    per_force = {"m": "/N", "m s/rad": " s/(N rad)", "1": "/(N m)", "s/m": " s/(N m^2)"}
    per_moment = {"1": "/(N m)", "s/rad": " s/(N m rad)", "1/m": "/(N m^2)", "s/m^2": " s/(N m^3)"}
    for per, coefficients in ((per_force, OF_FORCES), (per_moment, OF_BENDING)):
        if name in {q.name for q in coefficients}:
            return f"{drive}{per[unit]}"
    return unit.replace("N m", drive)


def gain_of(drive: Drive) -> str:
    """Source of a drive's torque scale: "measured", "declared", "identified" or "not identifiable"."""
    if drive.channels.motor.measured_by == "torque":
        return "measured"
    if "k_i" in drive.channels.rig.known:
        return "declared"
    return "identified" if drive.unit == "N m" else "not identifiable"


# Predict other runs of an arm with a fit, and identify their payload.
#
# Friction and bodies are fixed at the fitted values. A payload is a body in the frame of the last joint; its
# torques are linear in its ten inertial parameters, only some of which are identifiable from the runs.
@dataclass(frozen=True)
class ForeignRuns:
    """Runs that were not used in a fit, predicted by it."""

    log: ArmLog  # the runs
    residuals: tuple[Array, ...]  # of each joint on its moving rows (m,), in the unit of its fit
    drives: tuple[Array, ...]  # of each joint, likewise
    rows: tuple[tuple[Rows, NDArray[np.bool_]], ...]  # of each joint, with the mask of the moving ones

    @property
    def rmse(self) -> tuple[float, ...]:
        """Error of each joint."""
        return tuple(rms(x) for x in self.residuals)


@dataclass(frozen=True)
class Payload:
    """A payload of runs that the fit did not have."""

    estimates: Mapping[str, Estimate]  # its identifiable inertial parameters in the frame of the last joint
    rmse: tuple[float, ...]  # error of each joint with it


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
    return Payload(solution.estimates(), tuple(rms(x) for x in after))


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
