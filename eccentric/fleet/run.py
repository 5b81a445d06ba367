"""The whole run: logs and rigs in, sums on disk, what drifts, what changed; all that can be done is done."""

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
from eccentric.fleet.gathered import Assigned, Plan, Told, gather, gone_of, outdated_of, plan_of, stored_of
from eccentric.fleet.periods import History, history_of, temperatures_of
from eccentric.fleet.sources import OTHER_RIG, SCHEDULER, FleetProblem, LogFile, find
from eccentric.fleet.work import Sample, arrow_of, sample_of

Examine = Callable[[Sequence[Suspect]], Sequence[Any]]
"""What a worker does to suspects: a diagnosis of each, as something that can be pickled."""
Keep = Callable[[Suspect, Any], Examined]
"""What the caller makes of such a result: the files of a report, and the word of the diagnosis."""
Known = Callable[[Suspect], Examined | None]
"""What is known of a suspect from an earlier run, None for nothing."""


@dataclass(frozen=True)
class FleetRequest:
    """What is asked: logs and rigs as given, a pattern of names, a scheduler or workers, a discovery rate."""

    logs: str
    rigs: str
    pattern: str | None
    scheduler: str | None
    workers: int
    rate: float


def run_fleet(
    request: FleetRequest, out: Path, examine: Examine, keep: Keep, known: Known, told: Told
) -> FleetFound:
    """Run a fleet; `out` is an absolute path, where sums are kept.

    `examine` is called by workers; `keep` here, with its results; `known` first, and a suspect that it knows
    from an earlier run is not examined again.

    Raises InputError for logs, rigs or a scheduler that are not there at all.
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
            said, files = gather(plan, cluster.client, out, told)
            problems += said
        histories: list[History] = []
        judged: list[History] = []
        gone: list[str] = []
        for done, joint in enumerate(sorted(plan.rigs)):
            own = by_joint.get(joint, [])
            stored = stored_of(out, joint, plan.recipes[joint], own)
            gone += gone_of(stored, own)
            problems += outdated_of(out, joint, plan.recipes[joint], own)
            history, said = history_of(joint, stored, plan.rigs[joint].axis)
            histories.append(history)
            problems += said
            doubts = doubts_of(history)
            problems += doubts
            # Neither its changes mean anything, nor how it scatters.
            if not any(doubt.kind == OTHER_RIG for doubt in doubts):
                judged.append(history)
            told((done + 1) / len(plan.rigs), "coefficients")
        heat, said = temperatures_of(histories)
        problems += said
        tested = changes([one for h in judged for one in series_of(h, heat[h.joint])], request.rate)
        called: dict[str, list[FleetChange]] = {}
        for change in tested:
            if change.counts:
                called.setdefault(change.series.joint, []).append(change)
        by_name = {history.joint: history for history in histories}
        suspects = [
            suspect
            for joint, own in called.items()
            for samples in [_samples(out, joint, plan.recipes[joint], by_joint.get(joint, []))]
            for suspect in [_suspect(by_name[joint], own, heat[joint], plan, samples)]
            if suspect.changed.matters
        ]
        examined = {s.joint: word for s in suspects if (word := known(s)) is not None}
        left = [suspect for suspect in suspects if suspect.joint not in examined]
        lost = any(problem.kind == SCHEDULER for problem in problems)
        if left and not lost:
            said = _examined(left, cluster.client, examine, keep, examined, told)
            problems += said
    ended = Examined(said="the run ended before it")
    drifting = [drifting_of(suspect, examined.get(suspect.joint, ended)) for suspect in suspects]
    return FleetFound(
        tuple(histories),
        tuple(tested),
        tuple(sorted(drifting, key=lambda found: -found.urgency)),
        tuple(sorted(set(problems))),
        files,
        plan.reused,
        tuple(gone),
        tuple(joint for joint in rigs.joints if joint not in plan.joints),
        request.rate,
    )


class _Cluster:
    """A cluster that is started when its client is first asked for: a run may have nothing to do."""

    def __init__(self, request: FleetRequest) -> None:
        self._request, self._stack = request, ExitStack()

    @cached_property
    def client(self) -> Any:
        """The client."""
        return self._stack.enter_context(connected(self._request.scheduler, self._request.workers))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *of: object) -> None:
        self._stack.close()


def _examined(
    left: Sequence[Suspect], client: Any, examine: Examine, keep: Keep, into: dict[str, Examined], told: Told
) -> list[FleetProblem]:
    """Diagnose suspects on the cluster, one a task; what could not be done is returned."""
    problems: list[FleetProblem] = []
    try:
        for done, (suspect, result) in enumerate(spread(client, examine, ([s] for s in left)), start=1):
            if isinstance(result, Failed):
                into[suspect.joint] = Examined(said=str(result))
            else:
                into[suspect.joint] = keep(suspect, result)
            if said := into[suspect.joint].said:
                problems.append(FleetProblem(suspect.joint, "", "", "no diagnosis", said))
            told(done / len(left), "diagnoses")
    except SchedulerLost as error:
        text = f"expected a scheduler with workers until the diagnoses are done ({error})"
        problems.append(FleetProblem("", "", "", SCHEDULER, f"{text}: start again to go on"))
    return problems


def _suspect(
    history: History, called: Sequence[FleetChange], heat: Mapping[str, float], plan: Plan, samples: _Samples
) -> Suspect:
    """What is known of a joint that drifts, its rig with its content, and the logs of its past and of now."""
    own = sorted(called, key=lambda change: (change.p, -abs(change.part)))
    past, recent = recent_of(history, own[0])
    return Suspect(
        history.joint,
        plan.rigs[history.joint],
        plan.contents[history.joint],
        tuple(own),
        against_the_past(history, own[0], heat),
        samples([p.period for p in reversed(past)]),
        samples([p.period for p in reversed(recent)]),
    )


_Samples = Callable[[Sequence[str]], Sample | None]


def _samples(out: Path, joint: str, recipe: str, logs: Sequence[LogFile]) -> _Samples:
    """A function that takes periods to a sample of the first of them that has logs."""
    stored = stored_of(out, joint, recipe, logs)

    def first(periods: Sequence[str]) -> Sample | None:
        found = (sample_of(stored[period], logs) for period in periods)
        return next((sample for sample in found if sample is not None), None)

    return first
