"""The plan: a motion, the rivals it separates, and the probability that it decides."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations, permutations, product

import numpy as np
from scipy.special import ndtr

from eccentric.core import InputError
from eccentric.diagnosis import IN_A_DRAW, Diagnosis, NextMeasurement
from eccentric.identification import with_own
from eccentric.model import TURNING, AxisKind, Model
from eccentric.model import vocabulary as v
from eccentric.planning.limits import (
    BEYOND,
    DECIDES,
    HEAVIER,
    KEPT,
    LEAST_PIECE_S,
    LEAST_SCALE,
    ODDS,
    OFF,
    PIECES,
    RATE_HZ,
    RESCALED,
    REST_S,
    SAME_TORQUE,
    SLOWER,
    SLOWEST_OF,
    STEPS,
    SURPLUS,
    UNDECIDED,
    VARIANTS_AGREE,
)
from eccentric.planning.motion import FORCE, Bounds, Reference, Segment, joined, pieces
from eccentric.planning.question import Question, Rival, question_of
from eccentric.planning.separation import Ground, Separation, extremes
from eccentric.rigs import AddedMass, Rig

Pairs = Mapping[tuple[str, str], float]
"""(true family, other family) -> D."""


# The probability that a diagnosis of log and motion together decides, from the distance D of the rivals.
#
# For a true rival the log-likelihood ratio over another is normal, with mean D/2 and variance D, where D is
# from `separation`. A verdict needs the odds `ODDS`, and the same result in nine of ten resampled logs, each
# a fraction f of the blocks: the ratio then has an additional spread of sqrt(1/f - 1) times its own.
def decided(apart: float) -> float:
    """The probability that the true rival is named over another at distance D."""
    spread = np.sqrt(max(apart, 1e-12))
    return float(ndtr((0.5 * apart - max(np.log(ODDS), VARIANTS_AGREE * spread)) / spread))


def expected(pairs: Pairs, chances: Mapping[str, float]) -> float:
    """The probability that the true rival is named over all others, whichever it is."""
    return sum(
        chance * min((decided(d) for (truth, _), d in pairs.items() if truth == family), default=1.0)
        for family, chance in chances.items()
    )


Offer = tuple[tuple[Segment, ...], Ground]


def chosen(
    separation: Separation, bounds: Bounds, seed: int, tell: Callable[[str], None]
) -> tuple[tuple[Segment, ...], Ground, dict[tuple[str, str], float]]:
    """The pieces of the motion, its ground, and the distances of the rivals on log and motion.

    Greedy: each piece is the one that adds most to those before it. Then the complete sequence is compared
    with each of its pieces repeated, which shows effects that drift with time.

    Raises InputError if no piece stays within the bounds for all drives within the uncertainty.
    """
    count = int(np.clip(bounds.time / LEAST_PIECE_S, 2, PIECES))
    # The last samples bring the reference to rest.
    seconds = (bounds.time - REST_S) / count
    offers = [
        offer
        for piece in pieces(bounds, seconds, np.random.default_rng(seed))
        if (offer := kept(separation, [piece], bounds, LEAST_SCALE)) is not None
    ]
    if not offers:
        raise _too_tight(separation, bounds)
    tell(f"{len(offers)} pieces of motion within the limits")
    selected: list[Offer] = []
    remaining = bounds.time - REST_S
    while fitting := [offer for offer in offers if _length(offer[0]) <= remaining + 1e-9]:
        grounds = [separation.log, *(ground for _, ground in selected)]
        best = max(fitting, key=lambda offer: _worth(separation, [*grounds, offer[1]]))
        selected.append(best)
        remaining -= _length(best[0])
    sequences = [[piece for (piece,), _ in selected]]
    different = {(piece.pattern, piece.sizes): piece for piece in sequences[0]}.values()
    sequences += [[piece] * max(int((bounds.time - REST_S) / _length([piece])), 1) for piece in different]
    feasible = [offer for parts in sequences if (offer := kept(separation, parts, bounds)) is not None]
    if not feasible:
        raise _too_tight(separation, bounds)
    parts, ground = max(feasible, key=lambda offer: _worth(separation, [separation.log, offer[1]]))
    tell("judging the motion")
    return parts, ground, judged(separation, ground)


def kept(
    separation: Separation, parts: Sequence[Segment], bounds: Bounds, least: float = 0.0
) -> Offer | None:
    """The motion, slowed down as needed for all drives within the uncertainty to stay within the limits.

    None if the speed would fall below the fraction `least`.
    """
    scale = 1.0
    for _ in range(RESCALED):
        slower = [part.scaled(scale) for part in parts]
        motion = joined(slower, bounds)
        ground = separation.ground(motion)
        if ground.met is None:
            return None
        used = extremes(motion, ground.met, bounds.loop_hz).beyond(bounds)
        if used <= KEPT:
            return tuple(slower), ground
        # Load and friction do not scale with speed: the current needs more than a proportional reduction.
        scale *= min(KEPT / used, SLOWER)
        if scale < least:
            return None
    return None


def _too_tight(separation: Separation, bounds: Bounds) -> InputError:
    """The error if no motion is feasible, quantified by the slowest motion."""
    top = SLOWEST_OF * bounds.speed
    rest = Segment("", np.concatenate([np.full(int(RATE_HZ), sign * top) for sign in (1.0, -1.0)]))
    met = separation.ground(joined([rest], bounds)).met
    needed = (
        0.0
        if met is None
        else float(np.max(np.abs(met.load) + np.abs(met.friction))) / abs(met.torque_constant)
    )
    noise = 0.0 if met is None else met.noise
    least = (1.0 + OFF) * needed + noise
    key, name, unit = (FORCE, "force", "N") if bounds.by_force else ("current_A", "current", "A")
    if least > KEPT * bounds.current:
        return InputError(
            f"limits: {key}",
            "enough for load and friction of the slowest motion",
            f"{bounds.current:g} {unit}",
            why=f", {least / KEPT:.3g} {unit} with mass and friction {100 * OFF:.0f} % higher",
        )
    axis = separation.question.data.drive.channels.rig.axis
    speed, acceleration, angle = (axis.unit(unit) for unit in ("rad/s", "rad/s^2", "rad"))
    return InputError(
        "limits",
        f"speed, acceleration, {name} and {axis.term('angle')} that leave room for one motion",
        f"{bounds.speed:g} {speed}, {bounds.acceleration:g} {acceleration}, {bounds.current:g} {unit}"
        + ("" if bounds.angle is None else f", {bounds.angle[0]:g} to {bounds.angle[1]:g} {angle}"),
    )


def _length(parts: Sequence[Segment]) -> float:
    return sum(len(part.omega) for part in parts) / RATE_HZ


def pairs(separation: Separation, grounds: Sequence[Ground], steps: int = 0) -> dict[tuple[str, str], float]:
    """(true family, other family) -> their distance on these grounds, refined in `steps`."""
    return {
        (truth.family, other.family): separation.apart(truth, other, grounds, steps)
        for truth, other in permutations(separation.rivals, 2)
    }


def judged(separation: Separation, ground: Ground) -> dict[tuple[str, str], float]:
    """The refined `pairs` of log and motion, with each declared value as an additional explanation.

    An effect is penalised for its parameter, a declared value within its tolerance is not.
    """
    grounds = [separation.log, ground]
    others = {
        (truth.family, other.family): max(
            separation.apart(truth, other, grounds, STEPS) - 2.0 * IN_A_DRAW, 0.0
        )
        for truth, other in product(separation.rivals, separation.besides)
    }
    return pairs(separation, grounds, STEPS) | others


def _worth(separation: Separation, grounds: Sequence[Ground]) -> float:
    """Objective for grounds: the expected probability of separating a pair of rivals.

    Every pair counts, since a pair that no motion separates must still be separated from the others.
    For a single rival: the log determinant of its information matrix (D-optimality).
    """
    if len(separation.rivals) == 1:
        return float(np.linalg.slogdet(separation.information(separation.rivals[0], grounds))[1])
    chances = {rival.family: rival.chance for rival in separation.rivals}
    return sum(
        chances[truth] * chances[other] * (decided(d / SURPLUS) + BEYOND * float(np.log1p(d)))
        for (truth, other), d in pairs(separation, grounds).items()
    )


# If no motion decides: the same motion with more mass on the link.
#
# The logs with both masses are judged together: `[added]` in a rig file has both diagnosed.
@dataclass(frozen=True)
class Heavier:
    """A mass added at the link's mass [kg], and the probability that it decides."""

    added_kg: float
    probability: float


def require_link(rig: Rig, model: Model) -> None:
    """InputError unless there is a link with known mass and distance to add a mass to."""
    if rig.axis is not TURNING:
        raise InputError(f"{rig.path}: --added", "a drive that turns", "a carriage")
    letters = [q.symbol.name for q in (v.M, v.L)]
    if missing := [name for name in letters if name not in rig.known]:
        received = "a range" if set(missing) & set(rig.unknown) else "none"
        raise InputError(
            rig.path, problem=f"expected [known] {' and '.join(missing)} to add a mass, got {received}"
        )
    if not set(letters) <= {q.name for q in model.parameters}:
        raise InputError("--added", "a model with an unbalanced mass", model.name)


def with_more_mass(
    separation: Separation, parts: Sequence[Segment], bounds: Bounds, worth: Mapping[tuple[str, str], float]
) -> Heavier | None:
    """Judge the motion with more mass, slower where the limits require it; None where that is impossible.

    That is without a known mass and distance, without a feasible motion, or if gravity does not load the
    drive: with two masses the torque constant may be wrong, an explanation that the log alone does not have.

    Args:
        separation: the rivals.
        parts: the motion.
        bounds: its limits.
        worth: (true family, other family) -> factor on the computed distance.
    """
    known, link = separation.question.data.signals.known, separation.question.data.drive.machine.link
    mass, length = (known.get(q.symbol.name, 0.0) for q in (v.M, v.L))
    gravity = separation.question.model.balance("mechanical").sum_of("gravity")
    if not mass or not length or link not in known or gravity == 0:
        return None
    added = HEAVIER * mass
    heavy = Separation(separation.question, AddedMass(added))
    offer = kept(heavy, parts, bounds)
    if offer is None:
        return None
    distances = judged(heavy, offer[1])
    chances = {rival.family: rival.chance for rival in separation.rivals}
    return Heavier(added, expected({pair: d * worth[pair] for pair, d in distances.items()}, chances))


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
        meanings: what the coefficients of effects are, by name.
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
    meanings: Mapping[str, str] = field(default_factory=dict)

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
        meanings={q.name: q.meaning for e in question.effects for q in e.coefficients if q.name in narrower},
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
    """The coefficients of the base model and of the effects, as a fit has them."""
    names = [c.name for c in question.screen.balance.coefficients]
    for variant in rival.variants:
        width = question.screen.columns(variant).shape[1]
        (effect,) = (e for e in question.effects if e.id == variant.candidate.id)
        names += [q.name for q in effect.coefficients[:width]]
    return names
