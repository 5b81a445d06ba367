"""The complete run: logs and rigs -> sums on disk -> drifting joints -> causes; problems do not stop it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Self

from eccentric.fleet.cluster import Failed, SchedulerLost, connected, spread
from eccentric.fleet.drift import (
    FRICTION,
    RESIDUAL,
    Changed,
    FleetChange,
    against_the_past,
    changes,
    doubts_of,
    recent_of,
    series_of,
)
from eccentric.fleet.gathered import (
    Assigned,
    Plan,
    Progress,
    gather,
    gone_of,
    outdated_of,
    plan_of,
    stored_of,
)
from eccentric.fleet.limits import EFFECT_PERCENT
from eccentric.fleet.periods import History, history_of, temperatures_of
from eccentric.fleet.sources import NO_RIG, OTHER_RIG, SCHEDULER, FleetProblem, LogFile, find, in_order
from eccentric.fleet.work import Sample, arrow_of, sample_of
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


Examine = Callable[[Sequence[Suspect]], Sequence[Any]]
"""Diagnoses suspects in a worker; the results can be pickled."""
Keep = Callable[[Suspect, Any], Examined]
"""Turns such a result into report files and a summary, in the caller."""
Known = Callable[[Suspect], Examined | None]
"""The summary of a suspect from an earlier run, None without one."""


@dataclass(frozen=True)
class FleetRequest:
    """A request: paths of logs and rigs, file-name pattern, scheduler or workers, false discovery rate."""

    logs: str
    rigs: str
    pattern: str | None
    scheduler: str | None
    workers: int
    rate: float


def run_fleet(
    request: FleetRequest, out: Path, examine: Examine, keep: Keep, known: Known, progress: Progress
) -> FleetFound:
    """Run a fleet; `out` is an absolute path, where sums are stored.

    `known` is called first: a suspect known from an earlier run is not examined again. `examine` is called
    in the workers, `keep` here with its results.

    Raises InputError if logs, rigs or scheduler are missing altogether.
    """
    arrow_of()
    rigs = Assigned(request.rigs)
    logs, problems = find(request.logs, request.pattern)
    plan = plan_of(logs, rigs, out)
    problems += plan.problems
    by_joint: dict[str, list[LogFile]] = {}
    for log in logs:
        by_joint.setdefault(log.joint, []).append(log)
    with _Cluster(request) as cluster:
        files = 0
        if plan.files:
            failed, files = gather(plan, cluster.client, out, progress)
            problems += failed
        histories: list[History] = []
        judged: list[History] = []
        gone: list[str] = []
        for done, joint in enumerate(sorted(plan.rigs)):
            joint_logs = by_joint.get(joint, [])
            stored = stored_of(out, joint, plan.recipes[joint], joint_logs)
            gone += gone_of(stored, joint_logs)
            problems += outdated_of(out, joint, plan.recipes[joint], joint_logs)
            history, unsolved = history_of(joint, stored, plan.rigs[joint].axis)
            histories.append(history)
            problems += unsolved
            doubts = doubts_of(history)
            problems += doubts
            # With the wrong rig neither its changes nor its scatter mean anything.
            if not any(doubt.kind == OTHER_RIG for doubt in doubts):
                judged.append(history)
            progress((done + 1) / len(plan.rigs), "coefficients")
        heat, stuck = temperatures_of(histories)
        problems += stuck
        tested = changes([one for h in judged for one in series_of(h, heat[h.joint])], request.rate)
        called: dict[str, list[FleetChange]] = {}
        for change in tested:
            if change.counts:
                called.setdefault(change.series.joint, []).append(change)
        by_name = {history.joint: history for history in histories}
        suspects = [
            suspect
            for joint, discoveries in called.items()
            for suspect in [
                _suspect(by_name[joint], discoveries, heat[joint], plan, out, by_joint.get(joint, []))
            ]
            if suspect.changed.matters
        ]
        examined = {s.joint: word for s in suspects if (word := known(s)) is not None}
        unexamined = [suspect for suspect in suspects if suspect.joint not in examined]
        lost = any(problem.kind == SCHEDULER for problem in problems)
        if unexamined and not lost:
            problems += _examined(unexamined, cluster.client, examine, keep, examined, progress)
    ended = Examined(said="the run ended before it")
    drifting = [drifting_of(suspect, examined.get(suspect.joint, ended)) for suspect in suspects]
    return FleetFound(
        tuple(histories),
        tuple(tested),
        tuple(sorted(drifting, key=lambda joint: -joint.urgency)),
        tuple(sorted(set(problems))),
        files,
        plan.reused,
        tuple(gone),
        tuple(joint for joint in rigs.joints if joint not in plan.joints),
        request.rate,
    )


class _Cluster:
    """A cluster started on first use: a run may have nothing to do."""

    def __init__(self, request: FleetRequest) -> None:
        self._request, self._stack = request, ExitStack()

    @cached_property
    def client(self) -> Any:
        return self._stack.enter_context(connected(self._request.scheduler, self._request.workers))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *of: object) -> None:
        self._stack.close()


def _examined(
    suspects: Sequence[Suspect],
    client: Any,
    examine: Examine,
    keep: Keep,
    into: dict[str, Examined],
    progress: Progress,
) -> list[FleetProblem]:
    """Diagnose suspects on the cluster, one per task; returns the problems."""
    problems: list[FleetProblem] = []
    try:
        for done, (suspect, result) in enumerate(spread(client, examine, ([s] for s in suspects)), start=1):
            if isinstance(result, Failed):
                into[suspect.joint] = Examined(said=str(result))
            else:
                into[suspect.joint] = keep(suspect, result)
            if reason := into[suspect.joint].said:
                problems.append(FleetProblem(suspect.joint, "", "", "no diagnosis", reason))
            progress(done / len(suspects), "diagnoses")
    except SchedulerLost as error:
        text = f"expected a scheduler with workers until the diagnoses are done ({error})"
        problems.append(FleetProblem("", "", "", SCHEDULER, f"{text}: start again to go on"))
    return problems


def _suspect(
    history: History,
    called: Sequence[FleetChange],
    heat: Mapping[str, float],
    plan: Plan,
    out: Path,
    logs: Sequence[LogFile],
) -> Suspect:
    """A drifting joint with its rig and samples of the last logs of its past, and of the recent ones."""
    joint, ranked = history.joint, sorted(called, key=lambda change: (change.p, -abs(change.part)))
    stored = stored_of(out, joint, plan.recipes[joint], logs)
    samples = (
        next(filter(None, (sample_of(stored[p.period], logs) for p in reversed(periods))), None)
        for periods in recent_of(history, ranked[0])
    )
    changed = against_the_past(history, ranked[0], heat)
    return Suspect(joint, plan.rigs[joint], plan.contents[joint], tuple(ranked), changed, *samples)
