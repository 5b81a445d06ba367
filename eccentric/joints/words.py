"""The fit and the diagnosis of an arm for a terminal."""

from __future__ import annotations

from collections.abc import Sequence

from eccentric.diagnosis import diagnosis_lines
from eccentric.errors import few
from eccentric.joints.bodies import IdentifiedBodies
from eccentric.joints.diagnosed import ArmDiagnosis
from eccentric.joints.fitted import ArmFit, JointFit, gain_of
from eccentric.model import Load

__all__ = ["LOADS", "arm_diagnosis_lines", "arm_fit_lines"]

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
    head = ("joint", "friction follows", "C + viscous", "with loads", "gain", "drive RMS", "noise", "")
    rows = [head, *(_row(joint) for joint in found.joints)]
    held, arm = found.log.channels[0].selection.holdout.brief, found.log.rig.chain.name
    return [
        f"{few(found.names)}: {arm}, {len(found.joints)} joints; errors held out ({held})",
        *_table(rows),
        *_drives(found),
        *_bodies(found.bodies),
        _sentence(found),
    ]


def arm_diagnosis_lines(found: ArmDiagnosis) -> list[str]:
    """The verdict of each joint, the lines of those where something is missing, and one sentence."""
    head = ("joint", "verdict", "leading", "linear", "model", "extended", "gain of an effect")
    rows: list[Sequence[str]] = [head]
    for joint in found.joints:
        rmse, unit = joint.found.score.rmse["mechanical"], joint.found.unit
        candidates = joint.found.attribution.candidates
        leading = candidates[0].id if candidates and joint.verdict != "nothing_missing" else "-"
        errors = (f"{rmse[name]:.4g} {unit}" for name in ("linear", "paper", "extended"))
        rows.append(
            (_called(joint.number, joint.name), joint.verdict, leading, *errors, f"{joint.deviance:.0f}")
        )
    lines = [
        f"{few(found.names)}: {found.log.rig.chain.name}, verdict {found.verdict}",
        *_table(rows),
        f"over {len(found.joints)} joints, an effect must gain {0.5 * found.required:.1f} in log-likelihood",
    ]
    for joint in found.by_gain:
        if joint.verdict != "nothing_missing":
            lines += [
                f"joint {_called(joint.number, joint.name)}:",
                *(f"  {x}" for x in diagnosis_lines(joint.found)[1:]),
            ]
    return [*lines, *_bodies(found.bodies), found.sentence]


def _called(number: int, name: str) -> str:
    return f"{number} {name}" if name and name != "joint" else f"{number}"


def _followed(joint: JointFit) -> str:
    return " + ".join(LOADS[load] for load in joint.loads.followed)


def _row(joint: JointFit) -> tuple[str, ...]:
    loads = joint.loads
    follows = _followed(joint) or "no load: Coulomb + viscous is enough"
    if loads.alike:
        follows += f" (or {', '.join(LOADS[load] for load in loads.alike)})"
    low, high = joint.interval
    gain = f"{joint.percent:.0f} % ({low:.0f} to {high:.0f})" if loads.followed else "-"
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
    possible = "bodies that could exist have them"
    if not found.bodies.explain:
        possible = (
            f"no bodies that could exist have them (the nearest miss by {found.bodies.misfit:.1f} std errors)"
        )
    return [f"bodies: {len(found.estimates)} base parameters identified; {possible}"]


def _change(percent: float) -> str:
    """How the held-out error changes, which the training runs had no part in."""
    return f"{percent:.0f} % less error" if percent > 0 else f"held-out error {-percent:.0f} % larger"


def _sentence(found: ArmFit) -> str:
    following = [joint for joint in found.joints if joint.loads.followed]
    rest = [f"{joint.number}" for joint in found.joints if not joint.loads.followed]
    if not following:
        return "Coulomb and viscous friction is enough in every joint, as far as this log shows."
    parts = ", ".join(f"{joint.number} ({_followed(joint)}, {_change(joint.percent)})" for joint in following)
    many = len(following) > 1
    enough = f"; Coulomb and viscous friction is enough in {few(rest)}" if rest else ""
    return f"Friction follows the load in joint{'s' * many} {parts}{enough}."
