"""The fit and the diagnosis of an arm as documents: formats eccentric-arm-fit/1, eccentric-arm-diagnosis/1.

Keys of both; an estimate is as in fit.json of one drive:

    format, rig, arm, logs, rows, low_pass_hz, holdout {rule, intervals_s}, fits_the_rig, warnings
    bodies   known: what the rig declares; base_parameters: estimates, each under its sum in words; possible:
             whether real bodies can have them, misfit_in_std_errors, and their inertial parameters
    joints   one entry each: number, name, drive, gain, unit, and

    fit      model, chain {gravity, joints}, parameters, parameter_notes, identified_range: for
             `eccentric emit ARM --parameters`, the chain to tell the arm from another;
             loads {present, followed, alike, deviance, required}, friction: estimates, rmse_holdout {linear,
             followed, every}, improvement {percent, interval_95}, leave_one_run_out, r_squared_holdout,
             torque_rms, noise_floor
    diagnosis  diagnosis: the document of this joint, eccentric-diagnosis/1; of the arm: verdict, sentence,
             effects [{joint, id, family, percent}], first {joint, family}, joints_by_gain, required_deviance
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from eccentric.identification import Estimate
from eccentric.joints import ArmDiagnosis, ArmFit, ArmLog, IdentifiedBodies, JointFit, gain_of
from eccentric.model import TURNING, identity_of, letters_of
from eccentric.presentation.arm_text import arm_diagnosis_sentence
from eccentric.presentation.diagnosis_json import diagnosis_document
from eccentric.presentation.fit_json import estimate_entry


def arm_fit_document(found: ArmFit) -> dict[str, Any]:
    """The content of fit.json of an arm: strict JSON."""
    return {
        "format": "eccentric-arm-fit/1",
        **_record(found.log, found.names, found.bodies),
        "fits_the_rig": found.fits_the_rig,
        "joints": [_joint(found.log, joint) for joint in found.joints],
        **_emitted(found),
        "warnings": list(found.warnings),
    }


def arm_diagnosis_document(found: ArmDiagnosis) -> dict[str, Any]:
    """The content of diagnosis.json of an arm: strict JSON."""
    return {
        "format": "eccentric-arm-diagnosis/1",
        **_record(found.log, found.names, found.bodies),
        "fits_the_rig": found.fits_the_rig,
        "verdict": found.verdict,
        "sentence": arm_diagnosis_sentence(found),
        "effects": [
            {
                "joint": joint.number,
                "id": effect.id,
                "family": effect.family,
                "percent": joint.found.score.percent,
            }
            for joint, effect in found.named
        ],
        "first": found.first,
        "joints_by_gain": [joint.number for joint in found.by_gain],
        "required_deviance": found.required,
        "joints": [
            {
                "number": joint.number,
                "name": joint.name,
                "gain": gain_of(joint.found.data.drive),
                "deviance": joint.deviance,
                "diagnosis": diagnosis_document(joint.found),
            }
            for joint in found.joints
        ],
        "warnings": list(found.warnings),
    }


def _emitted(found: ArmFit) -> dict[str, Any]:
    """What `emit` takes of a fit: the friction by the names of the emitted arm, in N m on the motor side.

    A joint without a scale for its torque has none: its friction is in the unit of its drive, and `emit`
    refuses the fit.
    """
    estimates = {
        f"{name}_{place}": e
        for place, joint in enumerate(found.joints)
        for name, e in joint.friction.items()
        if joint.unit == "N m"
    }
    what = "friction" if found.bodies is None else "friction and bodies"
    without = [joint.name for joint in found.joints if joint.unit != "N m"]
    return {
        **({"joints_without_scale": without} if without else {}),
        "model": found.log.rig.chain.name,
        "chain": identity_of(found.log.rig.chain),
        "parameters": {name: e.value for name, e in estimates.items()},
        "parameter_notes": {name: _note(e) for name, e in estimates.items()},
        "identified_range": f"{what} fitted to {', '.join(found.names)}",
    }


def _note(e: Estimate) -> str:
    low, high = (f"{x:.4g}" if math.isfinite(x) else "no bound" for x in e.interval)
    return f"fitted, 95 % interval {low} to {high}"


def _record(log: ArmLog, names: tuple[str, ...], bodies: IdentifiedBodies | None) -> dict[str, Any]:
    channels = log.channels[0]
    holdout = channels.selection.holdout
    return {
        "rig": log.rig.name,
        "arm": log.rig.chain.name,
        "logs": list(names),
        "rows": {"read": channels.intake.read, "rejected": channels.intake.rejected},
        **({"excerpt": channels.excerpt} if channels.excerpt else {}),
        "low_pass_hz": log.cut_hz,
        "holdout": {
            "rule": holdout.rule,
            "intervals_s": [list(map(float, pair)) for pair in holdout.intervals_s],
        },
        "bodies": _bodies(log, bodies),
    }


def _bodies(log: ArmLog, found: IdentifiedBodies | None) -> dict[str, Any]:
    if found is None:
        return {"known": sorted(log.rig.known), "base_parameters": None}
    names = [q.name for j in range(len(log)) for q in letters_of(j)]
    values = np.ravel(found.bodies.values)
    return {
        "known": sorted(log.rig.known),
        "base_parameters": {
            words: estimate_entry(e, TURNING)
            for e, words in zip(found.estimates.values(), found.sums, strict=True)
        },
        "possible": found.bodies.explain,
        "misfit_in_std_errors": found.bodies.misfit,
        "values": dict(zip(names, map(float, values), strict=True)),
    }


def _joint(log: ArmLog, joint: JointFit) -> dict[str, Any]:
    loads, drive = joint.loads, joint.data.drive
    k_i = log.gains[joint.number - log.rig.first] if log.gains else None
    return {
        "number": joint.number,
        "name": joint.name,
        "drive": drive.channels.motor.measured_by,
        "gain": gain_of(drive),
        "k_i": None if k_i is None else estimate_entry(k_i, TURNING),
        "unit": joint.unit,
        "loads": {
            "present": [str(load) for load in loads.present],
            "followed": [str(load) for load in loads.followed],
            "alike": [str(load) for load in loads.alike],
            "deviance": loads.deviance,
            "required": loads.required,
        },
        "friction": {name: estimate_entry(e, TURNING) for name, e in joint.friction.items()},
        "rmse_holdout": dict(joint.rmse),
        "improvement": {"percent": joint.percent, "interval_95": list(joint.interval)},
        "leave_one_run_out": _over_runs(joint),
        "r_squared_holdout": joint.r_squared,
        "torque_rms": joint.torque_rms,
        "noise_floor": joint.noise,
        "rows": drive.channels.counts,
    }


def _over_runs(joint: JointFit) -> dict[str, Any] | None:
    over = joint.over_runs
    if over is None:
        return None
    percent, interval, better = over.gains["paper"]
    return {
        "runs": over.runs,
        "rmse": {"linear": over.rmse["linear"], "followed": over.rmse["paper"]},
        "improvement": {"percent": percent, "interval_95": list(interval), "better_runs": better},
    }
