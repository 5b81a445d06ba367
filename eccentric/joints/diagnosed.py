"""Diagnose every joint of an arm: the effects missing in its model, besides friction by bearing loads.

A joint's friction enters its own balance only, so each joint is diagnosed as the log of a single drive, with
torques and loads from the others as inputs. An arm has as many chances of a false verdict as it has joints:
an effect has to gain more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from eccentric.diagnosis import (
    Asked,
    Diagnosis,
    NextMeasurement,
    SearchRequest,
    diagnosed,
    required_over,
    staged,
)
from eccentric.effects import Effect
from eccentric.joints.arm_log import ArmLog
from eccentric.joints.bodies import IdentifiedBodies
from eccentric.joints.fitted import prepared, warnings_of
from eccentric.joints.joint_model import DECLARED
from eccentric.logs import LogSource
from eccentric.rigs import ArmRig

_ORDER = ("named", "not_identifiable", "unexplained", "nothing_missing")


@dataclass(frozen=True)
class JointDiagnosis:
    """One joint: its number in the columns, name in the arm file, and diagnosis as a single drive."""

    number: int
    name: str
    found: Diagnosis

    @property
    def verdict(self) -> str:
        """The verdict of the single drive."""
        return self.found.attribution.verdict

    @property
    def fits_the_rig(self) -> bool:
        """Whether the log can be of this joint, in these units."""
        return self.found.models.fits_the_rig

    @property
    def deviance(self) -> float:
        """Cross-validated gain of the best single effect on the training part."""
        gains = [gain for gain, _ in self.found.attribution.deviance.values()]
        return max(gains, default=0.0)


@dataclass(frozen=True)
class ArmDiagnosis:
    """The diagnosis of an arm.

    Attributes:
        log: the logs, with the bodies used.
        names: of the logs.
        bodies: the identified bodies; None if they are declared, or a torque is unknown.
        joints: from the base outwards.
        required: deviance that an effect had to gain.
    """

    log: ArmLog
    names: tuple[str, ...]
    bodies: IdentifiedBodies | None
    joints: tuple[JointDiagnosis, ...]
    required: float

    @property
    def by_gain(self) -> tuple[JointDiagnosis, ...]:
        """The joints, sorted by the gain of their best effect."""
        return tuple(sorted(self.joints, key=lambda joint: -joint.deviance))

    @property
    def verdict(self) -> str:
        """The first of named, not_identifiable, unexplained, nothing_missing that any joint has."""
        verdicts = {joint.verdict for joint in self.joints}
        return next(verdict for verdict in _ORDER if verdict in verdicts)

    @property
    def named(self) -> tuple[tuple[JointDiagnosis, Effect], ...]:
        """Named effects with their joints, by gain."""
        return tuple((joint, effect) for joint in self.by_gain for effect, _ in joint.found.effects)

    @property
    def first(self) -> dict[str, Any] | None:
        """The joint where an effect gains most, and its leading family; None if nothing is missing."""
        lacking = (
            joint for joint in self.by_gain if joint.fits_the_rig and joint.verdict != "nothing_missing"
        )
        leading = next(lacking, None)
        if leading is None:
            return None
        candidates = leading.found.attribution.candidates
        return {
            "joint": leading.number,
            "verdict": leading.verdict,
            "family": candidates[0].family if candidates else None,
        }

    @property
    def fits_the_rig(self) -> bool:
        """Whether the log can be of this arm, in these units."""
        return all(joint.fits_the_rig for joint in self.joints)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the logs, and runs of a joint that differ from the others."""
        differing = (
            f"joint {joint.number}: {text}" for joint in self.joints for text in joint.found.differing
        )
        return (*warnings_of(self.log, self.bodies), *differing)


def diagnose_arm(
    logs: Sequence[LogSource],
    rig: ArmRig,
    names: Sequence[str],
    effects: Path | None = None,
    request: SearchRequest | None = None,
    tell: Callable[[str], None] = lambda _: None,
) -> ArmDiagnosis:
    """Diagnose every joint.

    Args:
        logs: those of one arm, as `read_log` accepts them.
        rig: of the arm.
        names: of the logs.
        effects: a file with user-defined effects.
        request: restrictions of the search.
        tell: called with one line per stage.

    Raises:
        InputError: bad input; too few rows of a joint; an effect that is unknown.
    """
    log, bodies = prepared(logs, rig, tell)
    required = required_over(len(log))
    joints = []
    for j in range(len(log)):
        number = rig.number(j)
        diagnosis = _diagnosed(log, j, names, effects, request or SearchRequest(), required, tell)
        joints.append(JointDiagnosis(number, rig.chain.joints[j].name, diagnosis))
        tell(f"joint {number}: {joints[-1].verdict}")
    return ArmDiagnosis(log, tuple(names), bodies, tuple(joints), required)


def _diagnosed(
    log: ArmLog,
    j: int,
    names: Sequence[str],
    effects: Path | None,
    request: SearchRequest,
    required: float,
    tell: Callable[[str], None],
) -> Diagnosis:
    number = log.rig.number(j)
    loads = log.present(j, DECLARED)
    model, data = log.joint(j, loads, f"{log.rig.chain.name}_joint_{number}")
    stage = staged(model, model, data, effects, f"{', '.join(names)}: joint {number}")
    inputs = Asked(tuple(names), Path(log.rig.path).name, model, effects, request)
    diagnosis = diagnosed(stage, inputs, lambda line: tell(f"joint {number}: {line}"), required)
    return _in_an_arm(diagnosis)


def _in_an_arm(diagnosis: Diagnosis) -> Diagnosis:
    """The diagnosis without advice that only applies to a single drive."""
    attribution = diagnosis.attribution
    of_inertia = attribution.verdict == "unexplained" and attribution.depends_on[:1] == ("acceleration",)
    if diagnosis.models.misfit or not of_inertia:
        return diagnosis
    return replace(
        diagnosis, attribution=replace(attribution, next_measurement=NextMeasurement("hold_others"))
    )
