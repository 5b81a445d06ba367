"""What is found of a joint that drifts, in words: what changed, since when, how urgent it is."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from eccentric.fleet.drift import FRICTION, RESIDUAL, Changed, FleetChange
from eccentric.fleet.limits import EFFECT_PERCENT
from eccentric.fleet.periods import History
from eccentric.fleet.sources import NO_RIG, FleetProblem, in_order
from eccentric.fleet.work import Sample
from eccentric.rigs import Rig

_KINDS = {
    "viscous": "viscous friction",
    "coulomb": "Coulomb friction",
    "load": "friction that follows the load",
    "friction": "friction",
    "inertia": "inertia",
    "scale": "gain of the drive signal, or the load carried",
    "offset": "offset of the drive signal, or a constant load",
}
_NO_COEFFICIENT = "a change that no coefficient explains"
NOT_FRICTION = frozenset({"scale", "offset", "inertia"})
"""Kinds of columns that are not friction: of these a sensor or a load is the cause."""


@dataclass(frozen=True)
class Suspect:
    """A joint that drifts, before its diagnosis: its significant changes, strongest first; what sums say.

    `content` is that of its rig as a file, None where one file holds for all joints. `past` and `recent` are
    the logs that a diagnosis compares, None where no log of the time is there.
    """

    joint: str
    rig: Rig
    content: Mapping[str, Any] | None
    changes: tuple[FleetChange, ...]
    changed: Changed
    past: Sample | None
    recent: Sample | None


@dataclass(frozen=True)
class Examined:
    """What a diagnosis of recent logs says that one of the past does not: new effects, family and words.

    `friction` is false where each of them is a declared value that is wrong, or is found from the circuit.
    `before` and `after` are held-out errors of the recent log, without and with all effects found in it, in
    `unit`; `again` are families of the past among these: the errors are then theirs as well, and say nothing
    of the new ones alone. `tied` are families that the recent log does not distinguish, if so. `report` is
    the path of its page below the folder of the fleet. `said` tells why there is none.
    """

    families: tuple[str, ...] = ()
    effects: tuple[str, ...] = ()
    before: float = 0.0
    after: float = 0.0
    unit: str = "N m"
    report: str = ""
    said: str = ""
    again: tuple[str, ...] = ()
    tied: tuple[str, ...] = ()
    friction: bool = True

    @property
    def gain_percent(self) -> float:
        """By how much the new effects reduce the error; 0 where that cannot be told from the past's."""
        return 0.0 if self.again or not self.families else 100.0 * (1.0 - self.after / self.before)


@dataclass(frozen=True)
class Drifting:
    """A joint that drifts: what changed in words and by name, since when, the errors before and after.

    `names` are coefficients or families of effects, empty where nothing explains the change; `sensor` says
    that they are none of friction. `part` is the change as a part of the friction torque; with
    `of_residual`, that of the logarithm of what the model leaves: `part_of_friction` and `residual_factor`
    are the one that it is, and NaN. All of this is of the change that is `shown`: of the quantity that is
    named, else of friction, else of the strongest.
    """

    joint: str
    what: str
    names: tuple[str, ...]
    sensor: bool
    since: str
    part: float
    p: float
    before: float
    after: float
    unit: str
    report: str
    shown: FleetChange = field(repr=False)
    changes: tuple[FleetChange, ...] = field(repr=False, default=())

    @property
    def of_residual(self) -> bool:
        """Whether the change is one of what the model leaves."""
        return self.shown.series.name == RESIDUAL

    @property
    def part_of_friction(self) -> float:
        """The change as a part of the friction torque."""
        return math.nan if self.of_residual else self.part

    @property
    def residual_factor(self) -> float:
        """What the model leaves, over what it left before."""
        return math.exp(self.part) if self.of_residual else math.nan

    @property
    def size(self) -> str:
        """The change in a word or two."""
        if self.of_residual:
            return f"residual × {self.residual_factor:.3g}"
        return f"{100.0 * self.part_of_friction:+.0f} % of the friction"

    @property
    def urgency(self) -> float:
        """What to look at first: the larger the change of the torque, the higher; sensors come after."""
        return (0.0 if self.sensor else 1e3) + abs(self.part)


@dataclass(frozen=True)
class FleetFound:
    """What a run found: the histories of all joints, tests, joints that drift (most urgent first), problems.

    This run read `files` logs, of which `problems` names those without sums; the sums of `reused` others were
    there, and those of `gone` count though these logs are no longer there. `without_log` are joints of the
    table of rigs that have neither a log nor sums.
    """

    histories: tuple[History, ...]
    changes: tuple[FleetChange, ...]
    drifting: tuple[Drifting, ...]
    problems: tuple[FleetProblem, ...]
    files: int
    reused: int
    gone: tuple[str, ...]
    without_log: tuple[str, ...]
    rate: float

    @property
    def joints(self) -> int:
        """How many joints have a log, or sums of one: those with a rig have a history."""
        return len(self.histories) + sum(problem.kind == NO_RIG for problem in self.problems)

    @property
    def behind(self) -> dict[str, str]:
        """Joints that have no answer in the last period of the fleet, each with its own last one."""
        last = {history.joint: history.periods[-1].period for history in self.histories if history.periods}
        newest = in_order(last.values())[-1:]
        return {joint: period for joint, period in last.items() if period not in newest}

    @property
    def unchanged(self) -> list[str]:
        """Joints that were tested and are not among those that changed."""
        return sorted(self.tested - {one.joint for one in self.drifting})

    @property
    def tested(self) -> frozenset[str]:
        """Joints that could be tested for a change."""
        return frozenset(change.series.joint for change in self.changes)


def drifting_of(suspect: Suspect, examined: Examined) -> Drifting:
    """The word on a joint: the coefficients that explain the change, else the new effect, else none."""
    changed, strongest = suspect.changed, suspect.changes[0]
    own = {change.series.name: change for change in suspect.changes}
    names, sensor = changed.names, False
    before, after, unit = changed.before, changed.after, suspect.rig.axis.unit("N m")
    if names:
        sensor = all(kind in NOT_FRICTION for kind in changed.kinds)
        term = suspect.rig.axis.term
        parts = [f"{term(_KINDS[kind])} ({name})" for kind, name in zip(changed.kinds, names, strict=True)]
        what = " and ".join(parts)
    elif examined.gain_percent >= EFFECT_PERCENT:
        names, what = examined.families, "new: " + ", ".join(examined.effects)
        sensor = not examined.friction
        before, after, unit = examined.before, examined.after, examined.unit
    elif examined.families and examined.again:
        new, past = ", ".join(examined.effects), ", ".join(examined.again)
        what = f"{_NO_COEFFICIENT}; new beside {past}: {new}, whose own gain is not known"
    elif examined.tied:
        tied = " or ".join(examined.tied)
        what = f"{_NO_COEFFICIENT}: {tied}, which its log does not distinguish"
    elif examined.said:
        what = f"{_NO_COEFFICIENT}, and that was not diagnosed: {examined.said}"
    else:
        what = f"{_NO_COEFFICIENT}, nor any effect of the library"
    shown = next((own[name] for name in (*names, FRICTION) if name in own), strongest)
    return Drifting(
        *(suspect.joint, what, tuple(names), sensor, shown.since, shown.part, shown.p),
        *(before, after, unit, examined.report, shown, suspect.changes),
    )
