"""The fit and the diagnosis of an arm: lines for a terminal, and documents.

Formats eccentric-arm-fit/1 and eccentric-arm-diagnosis/1; keys of both, an estimate is as in fit.json of one
drive:

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
import shlex
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from eccentric.core import counted, few
from eccentric.identification import Estimate
from eccentric.joints import (
    ArmDiagnosis,
    ArmFit,
    ArmLog,
    IdentifiedBodies,
    JointDiagnosis,
    JointFit,
    arm_name,
    gain_of,
    why_not_emitted,
)
from eccentric.model import TURNING, Load, identity_of, letters_of
from eccentric.presentation.diagnosis_json import diagnosis_document, holdout_entry
from eccentric.presentation.diagnosis_text import diagnosis_lines
from eccentric.presentation.fit_json import estimate_entry, gain_entry
from eccentric.presentation.fit_text import aligned, estimate_table
from eccentric.presentation.ranges_text import effect_name

LOADS = {
    Load.NORMAL: "F_N",
    Load.TRANSVERSAL: "F_T",
    Load.BENDING: "M_B",
    Load.TRANSMITTED: "transmitted torque",
}
_GAINS = {
    "not identifiable": (
        "k_i is not identifiable with open bodies: results are in amperes, and the bodies of the arm file"
        " scale the loads"
    ),
    "identified": "k_i is identified through the declared bodies",
}


def arm_fit_lines(found: ArmFit) -> list[str]:
    """The table of the joints, what was found of the bodies, and one sentence."""
    head = (
        "joint",
        "friction follows",
        "Coulomb + viscous",
        "with loads",
        "gain",
        "drive RMS",
        "noise",
        "unit",
    )
    rows = [head, *(_row(joint) for joint in found.joints)]
    held = found.log.channels[0].selection.holdout.brief
    arm = f"{found.log.rig.chain.name}, {counted(len(found.joints), 'joint')}"
    return [
        f"{few(found.names)}: {arm}; on the motor side, errors held out ({held})",
        *filter(None, [found.log.channels[0].excerpt]),
        *aligned(rows, left=range(len(head))),
        *estimate_table(_estimates(found)),
        *_drives(found),
        *_bodies_line(found.bodies),
        _sentence(found),
    ]


def arm_diagnosis_lines(found: ArmDiagnosis) -> list[str]:
    """The verdict of each joint, the lines of those where something is missing, and one sentence."""
    head = (
        "joint",
        "verdict",
        "leading",
        "Coulomb + viscous",
        "with loads",
        "extended",
        "log-likelihood gain",
    )
    rows: list[Sequence[str]] = [head]
    for joint in found.joints:
        rmse, unit = joint.found.score.rmse["mechanical"], joint.found.unit
        candidates = joint.found.attribution.candidates
        verdict = joint.verdict.replace("_", " ") if joint.fits_the_rig else "does not fit the rig"
        leading = candidates[0].id if candidates and joint.verdict != "nothing_missing" else "-"
        errors = (f"{rmse[name]:.4g} {unit}" for name in ("linear", "paper", "extended"))
        rows.append(
            (_called(joint.number, joint.name), verdict, leading, *errors, f"{0.5 * joint.deviance:.1f}")
        )
    joints = counted(len(found.joints), "joint")
    lines = [
        f"{few(found.names)}: {found.log.rig.chain.name}; verdict: {found.verdict.replace('_', ' ')}",
        *filter(None, [found.log.channels[0].excerpt]),
        *aligned(rows, left=range(len(head))),
        f"with {joints}, an effect must gain {0.5 * found.required:.1f} in log-likelihood",
    ]
    for joint in found.by_gain:
        if joint.verdict != "nothing_missing":
            lines += [f"joint {_called(joint.number, joint.name)}:", *(f"  {x}" for x in _of_joint(joint))]
    return [*lines, *_bodies_line(found.bodies), *_emitted_line(found), arm_diagnosis_sentence(found)]


def _emitted_line(found: ArmDiagnosis) -> list[str]:
    """What is emitted of the arm as a whole, or why nothing is."""
    if why := why_not_emitted(found):
        return [f"the arm as a whole is not emitted: {why}"]
    name = arm_name(found)
    said = f"the arm with the friction of all joints as fitted is emitted as {name}"
    return [f"{said}; to call: {name}_motor_torque"]


def _of_joint(joint: JointDiagnosis) -> list[str]:
    """The lines of a joint as for one drive; under its call, where the arm has its inputs."""
    lines = []
    for line in diagnosis_lines(joint.found)[1:]:
        called = line.partition("(")[2].rpartition(")")[0].split(", ") if "&" in line else []
        given = [q for q in joint.found.models.base.inputs if q.name in called and ": " in q.meaning]
        lines += [line, *(f"  {q.name} is {q.meaning.partition(': ')[2]}" for q in given)]
    return lines


def _estimates(found: ArmFit) -> dict[str, Estimate]:
    """Coefficients of friction and identified gains, by joint and letter."""
    estimates: dict[str, Estimate] = {}
    for joint, gain in zip(found.joints, found.log.gains or [None] * len(found.joints), strict=True):
        own = joint.friction if gain is None else {**joint.friction, "k_i": gain}
        estimates |= {f"{_called(joint.number, joint.name)}  {letter}": e for letter, e in own.items()}
    return estimates


def arm_command(found: ArmDiagnosis) -> str:
    """The shell command that repeats the diagnosis of the arm."""
    asked = found.joints[0].found.asked
    words = ["eccentric", "diagnose", *found.names, "--rig", asked.rig]
    words += [] if asked.effects is None else ["--effects", asked.effects.name]
    for option, names in (("--without", asked.request.without), ("--only", asked.request.only)):
        words += [word for name in names for word in (option, name)]
    return shlex.join([*words, "--out", "DIR"])


def _called(number: int, name: str) -> str:
    return f"{number} {name}" if name and name != "joint" else f"{number}"


def _followed(joint: JointFit) -> str:
    return " + ".join(LOADS[load] for load in joint.loads.followed)


def _row(joint: JointFit) -> tuple[str, ...]:
    loads = joint.loads
    follows, gain = _followed(joint) or "no load: Coulomb + viscous is enough", "-"
    if loads.alike:
        follows += f" (or {', '.join(LOADS[load] for load in loads.alike)})"
    if loads.followed:
        low, high = joint.interval
        gain = f"{joint.percent:.0f} % ({low:.0f} to {high:.0f})"
        follows += "" if joint.confirmed else ", not confirmed"
    if not joint.fits_the_rig:
        follows, gain = f"does not fit the rig (R^2 {joint.r_squared:.2f})", "-"
    errors = (f"{joint.rmse[name]:.4g}" for name in ("linear", "followed"))
    return (
        _called(joint.number, joint.name), follows, *errors, gain,
        f"{joint.torque_rms:.3g}", f"{joint.noise:.2g}", joint.unit,
    )  # fmt: skip


def _drives(found: ArmFit) -> list[str]:
    kinds = dict.fromkeys(gain_of(joint.data.drive) for joint in found.joints)
    return [_GAINS[kind] for kind in kinds if kind in _GAINS]


def _bodies_line(found: IdentifiedBodies | None) -> list[str]:
    if found is None:
        return []
    possible = "these values are physically realizable"
    if not found.bodies.explain:
        possible = (
            "these values are not physically realizable"
            f" (the nearest realizable ones are up to {found.bodies.misfit:.1f} standard errors away)"
        )
    return [f"bodies: {len(found.estimates)} base parameters identified; {possible}"]


def _sentence(found: ArmFit) -> str:
    """What the friction of the joints follows whose log fits the rig, after those whose log does not."""
    misfit = _misfit({j.number: j.r_squared for j in found.joints if not j.fits_the_rig})
    return " ".join(filter(None, [misfit, _verdict([j for j in found.joints if j.fits_the_rig], not misfit)]))


def _verdict(joints: Sequence[JointFit], every: bool) -> str:
    following = [j for j in joints if j.loads.followed and j.confirmed]
    unconfirmed = [j for j in joints if j.loads.followed and not j.confirmed]
    rest = [f"{j.number}" for j in joints if not j.loads.followed]
    parts = []
    if following:
        those = ", ".join(f"{j.number} ({_followed(j)}, {j.percent:.0f} % less error)" for j in following)
        parts.append(f"friction follows the load in joint{'s' * (len(following) > 1)} {those}")
    if unconfirmed:
        those = ", ".join(f"{_followed(j)} in joint {j.number}" for j in unconfirmed)
        parts.append(f"chosen on the training runs, but not confirmed by the held-out part: {those}")
    if rest:
        where = f"joint{'s' * (len(rest) > 1)} {few(rest)}" if parts or not every else "every joint"
        parts.append(f"Coulomb and viscous friction is enough in {where}, as far as this log shows")
    said = "; ".join(parts)
    return f"{said[0].upper()}{said[1:]}." if said else ""


def arm_diagnosis_sentence(found: ArmDiagnosis) -> str:
    """The result in one sentence, after another one if joints do not fit the rig."""
    misfit = _misfit({j.number: j.found.models.r_squared for j in found.joints if not j.fits_the_rig})
    return " ".join(filter(None, [misfit, _lacking(found)]))


def _lacking(found: ArmDiagnosis) -> str:
    """What the joints lack whose log fits the rig; "" without such a joint."""
    if found.named:
        parts = []
        for joint, effect in found.named:
            what = effect_name(effect.words.headline, effect.id)
            score = joint.found.score
            before, after = (score.rmse[score.balance][model] for model in ("paper", "extended"))
            change = f"held-out error {before:.4g} to {after:.4g} {joint.found.unit}"
            parts.append(f"{what} in joint {joint.number} ({change})")
        return f"Missing in the arm's model: {'; '.join(parts)}."
    open_ = [
        f"joint {joint.number}: {joint.verdict.replace('_', ' ')}"
        for joint in found.joints
        if joint.fits_the_rig and joint.verdict != "nothing_missing"
    ]
    if open_:
        return f"No effect is named: {', '.join(open_)}."
    return "Nothing is missing in any joint, as far as this log can show." if found.fits_the_rig else ""


def _misfit(r_squared: Mapping[int, float]) -> str:
    """What to check where the log of some joints is not of this arm, R^2 by their numbers; "" for none."""
    if not r_squared:
        return ""
    joints = ", ".join(f"{number} (R^2 {value:.2f})" for number, value in r_squared.items())
    return (
        f"This log does not fit the rig in joint{'s' * (len(r_squared) > 1)} {joints}: check units and signs"
        " of the columns, k_i, and in the arm file mu, gravity, positions and bodies."
    )


# The documents.


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
    return {
        "rig": log.rig.name,
        "arm": log.rig.chain.name,
        "logs": list(names),
        "rows": {"read": channels.intake.read, "rejected": channels.intake.rejected},
        **({"excerpt": channels.excerpt} if channels.excerpt else {}),
        "low_pass_hz": log.cut_hz,
        "holdout": holdout_entry(channels),
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
        "improvement": gain_entry(joint.percent, joint.interval),
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
        "improvement": gain_entry(percent, interval) | {"better_runs": better},
    }
