"""The explanation of a joint's drift in words: what changed, since when, how urgent it is."""

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
"""Kinds of columns that are not friction: a sensor or a load causes their changes."""


@dataclass(frozen=True)
class Suspect:
    """A drifting joint before its diagnosis, with its significant changes, strongest first.

    `content` is that of its rig file, None where one file serves all joints. `past` and `recent` are the
    log samples that a diagnosis compares, None where no log is available.
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
    """Effects that a diagnosis finds in the recent log and not in the past one: families and words.

    `friction` is false if each is a wrong declared value or an effect of the electrical circuit. `before` and
    `after` are held-out errors of the recent log, without and with all effects found in it, in `unit`;
    `again` are families among these that the past had too: the errors then do not measure the new effects
    alone. `tied` are families that the recent log does not distinguish. `report` is the path of its page
    below the fleet's folder; `said` is the reason if there is no diagnosis.
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
        """Reduction of the error by the new effects; 0 where it cannot be separated from the past's."""
        return 0.0 if self.again or not self.families else 100.0 * (1.0 - self.after / self.before)


@dataclass(frozen=True)
class Drifting:
    """A drifting joint: what changed, in words and by name, since when, and the errors before and after.

    `names` are coefficients or families of effects, empty where nothing explains the change; `sensor` means
    that none of them is friction. `part` is the change as a fraction of the friction torque or, with
    `of_residual`, the change of the logarithm of the residual; of `part_of_friction` and `residual_factor`
    the other one is NaN. All refer to the change `shown`: that of the named quantity, else of friction, else
    the strongest.
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
        """Whether the residual changed."""
        return self.shown.series.name == RESIDUAL

    @property
    def part_of_friction(self) -> float:
        """The change as a fraction of the friction torque."""
        return math.nan if self.of_residual else self.part

    @property
    def residual_factor(self) -> float:
        """Residual after the change over that before."""
        return math.exp(self.part) if self.of_residual else math.nan

    @property
    def size(self) -> str:
        """The change in a word or two."""
        if self.of_residual:
            return f"residual × {self.residual_factor:.3g}"
        return f"{100.0 * self.part_of_friction:+.0f} % of the friction"

    @property
    def urgency(self) -> float:
        """Sort key: larger changes of the torque first, sensors last."""
        return (0.0 if self.sensor else 1e3) + abs(self.part)


@dataclass(frozen=True)
class FleetFound:
    """Results of a run: histories of all joints, tests, drifting joints (most urgent first), problems.

    The run read `files` logs; `problems` lists those without sums. The sums of `reused` others were cached,
    and those of the deleted logs `gone` still count. `without_log` are joints of the rig table with neither
    logs nor sums.
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
        """Number of joints with a log or sums; those with a rig have a history."""
        return len(self.histories) + sum(problem.kind == NO_RIG for problem in self.problems)

    @property
    def behind(self) -> dict[str, str]:
        """Joints without a result in the fleet's last period -> their own last period."""
        last = {history.joint: history.periods[-1].period for history in self.histories if history.periods}
        newest = in_order(last.values())[-1:]
        return {joint: period for joint, period in last.items() if period not in newest}

    @property
    def unchanged(self) -> list[str]:
        """Joints that were tested and have not changed."""
        return sorted(self.tested - {one.joint for one in self.drifting})

    @property
    def tested(self) -> frozenset[str]:
        """Joints that could be tested for a change."""
        return frozenset(change.series.joint for change in self.changes)


def drifting_of(suspect: Suspect, examined: Examined) -> Drifting:
    """Explain a joint's drift by coefficients, else by new effects, else by none."""
    changed, strongest = suspect.changed, suspect.changes[0]
    by_name = {change.series.name: change for change in suspect.changes}
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
    shown = next((by_name[name] for name in (*names, FRICTION) if name in by_name), strongest)
    return Drifting(
        *(suspect.joint, what, tuple(names), sensor, shown.since, shown.part, shown.p),
        *(before, after, unit, examined.report, shown, suspect.changes),
    )
