"""The complete run: logs and rigs -> sums on disk -> drifting joints -> causes; problems do not stop it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Self

from eccentric.fleet.cluster import Failed, SchedulerLost, connected, spread
from eccentric.fleet.drift import FleetChange, against_the_past, changes, doubts_of, recent_of, series_of
from eccentric.fleet.found import Examined, FleetFound, Suspect, drifting_of
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
from eccentric.fleet.periods import History, history_of, temperatures_of
from eccentric.fleet.sources import OTHER_RIG, SCHEDULER, FleetProblem, LogFile, find
from eccentric.fleet.work import Sample, arrow_of, sample_of

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
            for samples in [_samples(out, joint, plan.recipes[joint], by_joint.get(joint, []))]
            for suspect in [_suspect(by_name[joint], discoveries, heat[joint], plan, samples)]
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
        """The client of the cluster."""
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
    history: History, called: Sequence[FleetChange], heat: Mapping[str, float], plan: Plan, samples: _Samples
) -> Suspect:
    """A drifting joint with its rig and the samples of its past and recent logs."""
    ranked = sorted(called, key=lambda change: (change.p, -abs(change.part)))
    past, recent = recent_of(history, ranked[0])
    return Suspect(
        history.joint,
        plan.rigs[history.joint],
        plan.contents[history.joint],
        tuple(ranked),
        against_the_past(history, ranked[0], heat),
        samples([p.period for p in reversed(past)]),
        samples([p.period for p in reversed(recent)]),
    )


_Samples = Callable[[Sequence[str]], Sample | None]


def _samples(out: Path, joint: str, recipe: str, logs: Sequence[LogFile]) -> _Samples:
    """A function from periods to a sample of the first period with logs."""
    stored = stored_of(out, joint, recipe, logs)

    def first(periods: Sequence[str]) -> Sample | None:
        samples = (sample_of(stored[period], logs) for period in periods)
        return next((sample for sample in samples if sample is not None), None)

    return first
