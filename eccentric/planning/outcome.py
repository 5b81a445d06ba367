"""The plan: a motion, what it tells apart, and with what probability."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations, groupby
from typing import Any

import numpy as np

from eccentric.core import InputError
from eccentric.diagnosis import Diagnosis
from eccentric.identification import with_own
from eccentric.model import TURNING, AxisKind
from eccentric.planning.choice import Heavier, Pairs, chosen, expected, require_link, with_more_mass
from eccentric.planning.limits import DECIDES, HARDLY, RATE_HZ, SAME_TORQUE, UNDECIDED, WORTH_A_RUN
from eccentric.planning.motion import FORCE, Bounds, Reference, joined
from eccentric.planning.question import Question, Rival, question_of
from eccentric.planning.separation import Separation
from eccentric.rigs import AddedMass

SEED = 1
"""Of the sums of sines: the same question gets the same plan."""


@dataclass(frozen=True)
class MeasurementPlan:
    """What to measure next.

    Attributes:
        rivals: what the log left open, most probable first; one alone where it only has to be known better.
        motion: the reference; current: that it needs [A] (n,), by the most probable rival.
        parts: what the motion does, in words.
        bounds: its limits.
        apart: (true family, other family) -> twice the expected log-likelihood ratio, log included.
        same: pairs of families that predict the same torque on log and motion, whichever is true.
        probability: that the new log decides between the rivals; None for one alone.
        heavier: the same with another mass on the link, where the motion is not enough and there is a mass.
        added: mass on the link [kg] that the motion is for, besides the rig's own.
        narrower: of one alone: coefficient -> expected standard error over that on the log.
        otherwise: a measurement that needs more than a motion, "" where none is known.
        follows: variables of the structure that no effect explains, for a log with some.
        elsewhere: ids of the named effects that the other balance shows.
        axis: what moves.
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
    otherwise: str
    follows: tuple[str, ...]
    axis: AxisKind = TURNING
    added: float = 0.0
    elsewhere: tuple[str, ...] = ()

    @property
    def strength(self) -> tuple[str, str]:
        """What the motion needs of the drive, and its unit: a current, of a carriage also a force."""
        return ("force", "N") if self.bounds.by_force else ("current", "A")


def planned(
    found: Diagnosis | Question,
    bounds: Bounds,
    tell: Callable[[str], None] = lambda _: None,
    added: float = 0.0,
) -> MeasurementPlan:
    """Plan the motion that tells the rivals of a diagnosis apart, or that determines its model best.

    added: mass [kg] that the link is to carry beside the rig's own.

    Raises:
        InputError: the log does not fit the rig; it has no current, and the rig lacks the constants that
            give one of a voltage or torque; no motion stays within the bounds; a mass is to be added to a
            link whose own is not known.
    """
    question = found if isinstance(found, Question) else question_of(found)
    channels, axis = question.data.drive.channels, question.data.drive.channels.rig.axis
    by_force = channels.motor.measured_by == "torque"
    if not axis.wraps and by_force != bounds.by_force:
        needed, given = (FORCE, "current_A") if by_force else ("current_A", FORCE)
        has = "a force" if by_force else "no force"
        raise InputError(f"limits: {needed} is required, since the log has {has}, received {given}")
    _require_amperes(question, bounds)
    if added:
        require_link(question.data.drive.channels.rig, question.model)
    rivals, separation = question.rivals, Separation(question, AddedMass(added) if added else None)
    tell(f"open: {', '.join(rival.headline for rival in rivals)}")
    segments, ground, apart = chosen(separation, bounds, SEED, tell)
    motion = joined(segments, bounds)
    alone = len(rivals) == 1
    narrower: dict[str, float] = {}
    if alone:
        before, after = (
            _errors(separation.information(rivals[0], grounds))
            for grounds in ([separation.log], [separation.log, ground])
        )
        # Declared values, free within their tolerance, come after these.
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
        parts=tuple(segment.words for segment in segments),
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
    """InputError if a limit of the current cannot be kept, since nothing tells how large the current is."""
    drive = question.data.drive
    rig, by = drive.channels.rig, drive.channels.motor.measured_by
    letters = drive.machine.torque_letters
    if drive.unit != "N m":
        letters |= drive.machine.resistance_letters
    missing = sorted(letters - set(with_own(rig, question.model).known))
    if missing and by != "current" and not bounds.by_force:
        verb = "are" if len(missing) > 1 else "is"
        raise InputError(
            f"{rig.path}: [known] {' and '.join(map(rig.axis.said, missing))} {verb} required, received none:"
            f" a {rig.axis.said(by)} alone gives no current to compare with the limit current_A"
        )


def _errors(information: np.ndarray) -> np.ndarray:
    """Standard errors (k,) of coefficients with this information; a scaled inverse, since units differ."""
    scale = np.sqrt(np.maximum(np.diag(information), np.finfo(float).tiny))
    return np.sqrt(np.diag(np.linalg.pinv(information / np.outer(scale, scale)))) / scale


def _names(question: Question, rival: Rival) -> list[str]:
    names = [c.name for c in question.screen.balance.coefficients]
    for variant in rival.variants:
        width = question.screen.columns(variant).shape[1]
        names += [f"{variant.candidate.id}" + (f" ({k + 1})" if width > 1 else "") for k in range(width)]
    return names


def plan_lines(plan: MeasurementPlan) -> list[str]:
    """What a person reads."""
    first, *others = plan.rivals
    if others:
        said = ["Open after the log, with probabilities:"]
        said += [f"  {r.family}: {r.headline} ({100 * r.chance:.0f} %)" for r in plan.rivals]
    else:
        said = [f"Nothing is left to decide; this motion narrows the intervals of {first.headline}"]
    if plan.elsewhere:
        balance = "mechanical" if first.balance == "electrical" else "electrical"
        said.append(f"Not part of this: {', '.join(plan.elsewhere)}, which the {balance} balance shows.")
    if plan.follows:
        said.append(f"Something depends on {', '.join(plan.follows)} that no effect explains.")
        said += [f"What would show it: {plan.otherwise}"] if plan.otherwise else []
    if plan.probability is not None:
        closest = min(plan.apart, key=lambda pair: plan.apart[pair])
        said.append(
            f"This motion decides with a probability of {100 * plan.probability:.0f} %;"
            f" hardest to tell apart: {closest[0]} from {closest[1]} (deviance {plan.apart[closest]:.3g})."
        )
        if plan.probability < WORTH_A_RUN:
            said.append("No motion within the limits is likely to decide; this is the best of them.")
        said += [
            f"{one} and {other} predict the same torque on log and motion, whichever is true:"
            " for a drive within these limits, a model with either will do."
            for one, other in plan.same
        ]
        if (more := plan.heavier) is not None:
            kg = f"{more.added_kg:.2g} kg more on the link"
            said.append(
                f"With {kg}, this motion would decide with a probability of {100 * more.probability:.0f} %:"
                f' plan it with --added "{more.added_kg:.2g} kg".'
                if more.probability > plan.probability
                else f"{kg} would not decide either."
            )
        if plan.probability < DECIDES and plan.otherwise:
            said.append(f"What would decide: {plan.otherwise}")
    else:
        said += [
            f"  {name}: standard error falls to {100 * part:.0f} % of what the log gives"
            if part < HARDLY
            else f"  {name}: standard error hardly changes"
            for name, part in plan.narrower.items()
        ]
        if min(plan.narrower.values(), default=0.0) > HARDLY:
            said.append("Within these limits hardly any motion adds to what the log shows: widen them.")
    moved, bounds = plan.motion, plan.bounds
    if plan.added:
        said.append(
            f"All of this is with {plan.added:g} kg more on the link: name the run under [added] in the rig"
            f' file (RUN = "{plan.added:g} kg"), and diagnose both logs.'
        )
    said.append(f"Motion of {moved.seconds:.1f} s at {RATE_HZ:g} Hz, from rest at {moved.theta[0]:.4g} rad:")
    said += [f"  {len(tuple(same))} x {words}" for words, same in groupby(plan.parts)]
    said.append("Largest values, beside the limits (motor side):")
    for word, values, limit, unit in (
        ("speed", moved.omega, bounds.speed, "rad/s"),
        ("acceleration", moved.alpha, bounds.acceleration, "rad/s^2"),
        ("force" if bounds.by_force else "current", plan.current, bounds.current, plan.strength[1]),
    ):
        said.append(f"  {word} {np.max(np.abs(values)):.4g} of {limit:.4g} {unit}")
    if bounds.angle is not None:
        low, high = np.min(moved.theta), np.max(moved.theta)
        said.append(f"  angle {low:.4g} to {high:.4g} of {bounds.angle[0]:.4g} to {bounds.angle[1]:.4g} rad")
    return [plan.axis.said(line) for line in said]


def plan_document(plan: MeasurementPlan) -> dict[str, Any]:
    """The content of plan.json, format eccentric-plan/1."""
    moved, bounds, current = plan.motion, plan.bounds, "_".join(plan.strength)
    document = {
        "format": "eccentric-plan/1",
        "rivals": [
            {
                "family": r.family,
                "id": r.variants[-1].candidate.id if r.variants else "",
                "balance": r.balance,
                "probability": r.chance,
            }
            for r in plan.rivals
        ],
        "probability": plan.probability,
        "deviance": [
            {"true": truth, "other": other, "expected": value} for (truth, other), value in plan.apart.items()
        ],
        "same_torque": [list(pair) for pair in plan.same],
        "relative_std_error": plan.narrower,
        "added_kg": plan.added,
        "heavier": None if plan.heavier is None else vars(plan.heavier),
        "otherwise": plan.otherwise,
        "residual_depends_on": list(plan.follows),
        "elsewhere": list(plan.elsewhere),
        "parts": list(plan.parts),
        "seconds": moved.seconds,
        "rate_Hz": RATE_HZ,
        "limits": {
            "speed_rad_s": bounds.speed,
            "acceleration_rad_s2": bounds.acceleration,
            current: bounds.current,
            "time_s": bounds.time,
            "angle_rad": None if bounds.angle is None else list(bounds.angle),
            "speed_loop_Hz": bounds.loop_hz,
        },
        "largest": {
            "speed_rad_s": float(np.max(np.abs(moved.omega))),
            "acceleration_rad_s2": float(np.max(np.abs(moved.alpha))),
            current: float(np.max(np.abs(plan.current))),
            "angle_rad": [float(np.min(moved.theta)), float(np.max(moved.theta))],
        },
    }
    return plan.axis.told(document)
