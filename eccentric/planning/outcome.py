"""The plan: a motion, the rivals it separates, and the probability that it decides."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from eccentric.core import InputError
from eccentric.diagnosis import Diagnosis, NextMeasurement
from eccentric.identification import with_own
from eccentric.model import TURNING, AxisKind
from eccentric.planning.choice import Heavier, Pairs, chosen, expected, require_link, with_more_mass
from eccentric.planning.limits import DECIDES, SAME_TORQUE, UNDECIDED
from eccentric.planning.motion import FORCE, Bounds, Reference, joined
from eccentric.planning.question import Question, Rival, question_of
from eccentric.planning.separation import Separation
from eccentric.rigs import AddedMass

SEED = 1
"""Seed of the sums of sines: the same question gets the same plan."""


_FRICTION = "the friction of the paper's model"


@dataclass(frozen=True)
class MeasurementPlan:
    """What to measure next.

    Attributes:
        rivals: the remaining candidates, most probable first; a single one if only its coefficients have to
            be known better.
        motion: the reference; current: that it requires [A] (n,), the largest of all rivals.
        parts: description of the motion.
        bounds: its limits.
        apart: (true family, other family) -> twice the expected log-likelihood ratio, log included.
        same: pairs of families that predict the same torque on log and motion, whichever is true.
        probability: that the new log decides between the rivals; None for a single one.
        heavier: the motion with more mass on the link, if the motion alone is not enough.
        added: mass [kg] added to the rig's for this motion.
        narrower: for a single rival: coefficient -> expected standard error over that on the log.
        otherwise: a measurement that needs more than a motion, None where nothing is open.
        follows: variables of an unexplained structure in the residual.
        elsewhere: ids of the named effects of the other balance.
        axis: the kind of axis.
    """

    rivals: tuple[Rival, ...]
    motion: Reference
    current: np.ndarray
    parts: tuple[str, ...]
    bounds: Bounds
    apart: Pairs
    same: tuple[tuple[str, str], ...]
    probability: float | None
    heavier: Heavier | None
    narrower: dict[str, float]
    otherwise: NextMeasurement | None
    follows: tuple[str, ...]
    axis: AxisKind = TURNING
    added: float = 0.0
    elsewhere: tuple[str, ...] = ()

    @property
    def strength(self) -> tuple[str, str]:
        """The drive quantity that the motion requires, and its unit: current, or force of a carriage."""
        return ("force", "N") if self.bounds.by_force else ("current", "A")


def planned(
    found: Diagnosis | Question,
    bounds: Bounds,
    tell: Callable[[str], None] = lambda _: None,
    added: float = 0.0,
) -> MeasurementPlan:
    """Plan the motion that separates the rivals of a diagnosis, or best determines its model.

    added: mass [kg] added to the rig's.

    Raises:
        InputError: the log does not fit the rig; it has no current, and the rig lacks the constants to
            compute one from voltage or torque; no motion stays within the bounds; a mass is to be added to
            a link of unknown mass.
    """
    question = found if isinstance(found, Question) else question_of(found)
    channels, axis = question.data.drive.channels, question.data.drive.channels.rig.axis
    by_force = channels.motor.measured_by == "torque"
    if not axis.wraps and by_force != bounds.by_force:
        needed, got = (FORCE, "current_A") if by_force else ("current_A", FORCE)
        has = "a force" if by_force else "no force"
        raise InputError("limits", needed, got, why=f", since the log has {has}")
    _require_amperes(question, bounds)
    if added:
        require_link(question.data.drive.channels.rig, question.model)
    rivals, separation = question.rivals, Separation(question, AddedMass(added) if added else None)
    tell(f"open: {', '.join(rival.headline or _FRICTION for rival in rivals)}")
    segments, ground, apart = chosen(separation, bounds, SEED, tell)
    motion = joined(segments, bounds)
    alone = len(rivals) == 1
    narrower: dict[str, float] = {}
    if alone:
        before, after = (
            _errors(separation.information(rivals[0], grounds))
            for grounds in ([separation.log], [separation.log, ground])
        )
        # Followed by the declared values that are free within their tolerance.
        names = _names(question, rivals[0])
        narrower = {name: float(x) for name, x in zip(names, after / before, strict=False)}
    chances = {rival.family: rival.chance for rival in rivals}
    same = tuple(
        (one, other)
        for (one, other) in combinations([rival.family for rival in rivals], 2)
        if max(apart[one, other], apart[other, one]) < SAME_TORQUE
    )
    worth = {pair: 1.0 / max(1.0, separation.by_names(*pair, [separation.log]) / UNDECIDED) for pair in apart}
    apart = {pair: d * worth[pair] for pair, d in apart.items()}
    probability = None if alone else expected(apart, chances)
    heavier = None
    if probability is not None and probability < DECIDES and not added:
        tell("judging the same motion with more mass")
        heavier = with_more_mass(separation, segments, bounds, worth)
    return MeasurementPlan(
        rivals=rivals,
        motion=motion,
        current=ground.current,
        parts=tuple(segment.words(axis) for segment in segments),
        bounds=bounds,
        apart=apart,
        same=same,
        probability=probability,
        heavier=heavier,
        narrower=narrower,
        otherwise=question.otherwise,
        follows=question.follows,
        axis=axis,
        added=added,
        elsewhere=question.elsewhere,
    )


def _require_amperes(question: Question, bounds: Bounds) -> None:
    """InputError if the current limit cannot be checked because the current cannot be computed."""
    drive = question.data.drive
    rig, by = drive.channels.rig, drive.channels.motor.measured_by
    letters = drive.machine.torque_letters
    if drive.unit != "N m":
        letters |= drive.machine.resistance_letters
    missing = sorted(letters - set(with_own(rig, question.model).known))
    if missing and by != "current" and not bounds.by_force:
        raise InputError(
            rig.path,
            problem=f"expected [known] {' and '.join(map(rig.axis.named, missing))}, got none:"
            f" a {rig.axis.named(by)} alone gives no current to compare with the limit current_A",
        )


def _errors(information: np.ndarray) -> np.ndarray:
    """Standard errors (k,) from an information matrix, inverted after scaling since units differ."""
    scale = np.sqrt(np.maximum(np.diag(information), np.finfo(float).tiny))
    return np.sqrt(np.diag(np.linalg.pinv(information / np.outer(scale, scale)))) / scale


def _names(question: Question, rival: Rival) -> list[str]:
    names = [c.name for c in question.screen.balance.coefficients]
    for variant in rival.variants:
        width = question.screen.columns(variant).shape[1]
        names += [f"{variant.candidate.id}" + (f" ({k + 1})" if width > 1 else "") for k in range(width)]
    return names
