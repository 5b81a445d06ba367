"""The fit and the diagnosis of an arm for a terminal."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence

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
from eccentric.model import Load
from eccentric.presentation.diagnosis_text import diagnosis_lines
from eccentric.presentation.fit_text import estimate_table

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
        *_excerpt(found.log),
        *_table(rows),
        *estimate_table(_estimates(found)),
        *_drives(found),
        *_bodies(found.bodies),
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
        verdict = _plain(joint.verdict) if joint.fits_the_rig else "does not fit the rig"
        leading = candidates[0].id if candidates and joint.verdict != "nothing_missing" else "-"
        errors = (f"{rmse[name]:.4g} {unit}" for name in ("linear", "paper", "extended"))
        rows.append(
            (_called(joint.number, joint.name), verdict, leading, *errors, f"{0.5 * joint.deviance:.1f}")
        )
    joints = counted(len(found.joints), "joint")
    lines = [
        f"{few(found.names)}: {found.log.rig.chain.name}; verdict: {_plain(found.verdict)}",
        *_excerpt(found.log),
        *_table(rows),
        f"with {joints}, an effect must gain {0.5 * found.required:.1f} in log-likelihood",
    ]
    for joint in found.by_gain:
        if joint.verdict != "nothing_missing":
            lines += [f"joint {_called(joint.number, joint.name)}:", *(f"  {x}" for x in _of_joint(joint))]
    return [*lines, *_bodies(found.bodies), *_emitted(found), arm_diagnosis_sentence(found)]


def _excerpt(log: ArmLog) -> list[str]:
    """Which windows of a long log were read; nothing of a log that was read whole."""
    said = log.channels[0].excerpt
    return [said] if said else []


def _emitted(found: ArmDiagnosis) -> list[str]:
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


def _plain(verdict: str) -> str:
    """A verdict as the report has it."""
    return verdict.replace("_", " ")


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


def _table(rows: Sequence[Sequence[str]]) -> list[str]:
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return ["  ".join(x.ljust(w) for x, w in zip(row, widths, strict=True)).rstrip() for row in rows]


def _drives(found: ArmFit) -> list[str]:
    kinds = dict.fromkeys(gain_of(joint.data.drive) for joint in found.joints)
    return [_GAINS[kind] for kind in kinds if kind in _GAINS]


def _bodies(found: IdentifiedBodies | None) -> list[str]:
    if found is None:
        return []
    possible = "there are bodies with these values"
    if not found.bodies.explain:
        possible = (
            "no real bodies have these values"
            f" (the nearest miss one by {found.bodies.misfit:.1f} standard errors)"
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
            what = f"{effect.words.headline} ({effect.id})" if effect.words.headline else effect.id
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
