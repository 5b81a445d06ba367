"""Logs -> sums on disk: what is there stays, the rest is done on the cluster and written as it comes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from eccentric.errors import InputError
from eccentric.fleet.assigned import Assigned
from eccentric.fleet.cluster import Failed, SchedulerLost, spread, threads_of
from eccentric.fleet.limits import PART_FILES
from eccentric.fleet.problems import NO_RIG, SCHEDULER, FleetProblem
from eccentric.fleet.sources import LogFile, in_order, without_suffix
from eccentric.fleet.store import Key, Stored, joints_of, keys, read, recipe_of, write
from eccentric.fleet.sums import require_rig
from eccentric.fleet.work import Job, problem_of, tasks_of, work
from eccentric.output import workshop
from eccentric.rigs import Rig

__all__ = ["Plan", "gather", "gone_of", "outdated_of", "plan_of", "stored_of"]

Told = Callable[[float, str], None]


@dataclass
class Plan:
    """What has to be done: jobs by joint, the joints' rigs with their content and digests, problems so far.

    `joints` are those with logs or sums; `reused` counts the files whose sums are there.
    """

    joints: frozenset[str] = frozenset()
    jobs: dict[str, list[Job]] = field(default_factory=dict)
    rigs: dict[str, Rig] = field(default_factory=dict)
    contents: dict[str, Mapping[str, Any] | None] = field(default_factory=dict)
    recipes: dict[str, str] = field(default_factory=dict)
    problems: list[FleetProblem] = field(default_factory=list)
    reused: int = 0

    @property
    def files(self) -> int:
        """How many files have to be read."""
        return sum(map(len, self.jobs.values()))


def plan_of(logs: Iterable[LogFile], rigs: Assigned, out: Path) -> Plan:
    """What is left to be done for the logs of a fleet; joints without a rig are problems.

    Joints that have sums and no log any longer are joints of the fleet as well.
    """
    plan = Plan()
    logs = list(logs)
    there: dict[str, set[Key]] = {}
    plan.joints = frozenset({*(log.joint for log in logs), *joints_of(out)})
    for joint in sorted(plan.joints):
        try:
            rig, content = rigs.rig(joint), rigs.content(joint)
            require_rig(rig)
        except InputError as error:
            plan.problems.append(FleetProblem(joint, "", "", NO_RIG, str(error)))
            continue
        plan.rigs[joint], plan.contents[joint] = rig, content
        plan.recipes[joint] = recipe_of(rig)
        there[joint] = set(keys(out, joint))
    for log in logs:
        joint = log.joint
        if joint not in there:
            continue
        if Key(log.period, log.name, log.size, log.changed, plan.recipes[joint]) in there[joint]:
            plan.reused += 1
        else:
            plan.jobs.setdefault(joint, []).append(Job(log, plan.rigs[joint], plan.recipes[joint]))
    return plan


def gather(plan: Plan, client: Any, out: Path, told: Told) -> tuple[list[FleetProblem], int]:
    """Do the jobs of a plan; the sums of a joint are written when its last file is done, many in parts.

    Returns the problems, and the number of files that were read. A scheduler that goes away ends it: what was
    done is kept, and that is one problem.
    """
    problems: list[FleetProblem] = []
    left = {joint: len(jobs) for joint, jobs in plan.jobs.items()}
    made: dict[str, list[Stored]] = {}
    total, done = plan.files, 0

    def put(joint: str) -> None:
        if rows := made.pop(joint, []):
            write(out, joint, rows, new_files)

    with workshop(out) as new_files:
        try:
            every = [job for jobs in plan.jobs.values() for job in jobs]
            for job, result in spread(client, work, tasks_of(every, threads_of(client))):
                joint = job.log.joint
                if isinstance(result, Failed):
                    problems.append(problem_of(job, "worker", str(result)))
                elif isinstance(result, FleetProblem):
                    problems.append(result)
                else:
                    made.setdefault(joint, []).append(result)
                left[joint] -= 1
                done += 1
                if not left[joint] or len(made.get(joint, [])) == PART_FILES:
                    put(joint)
                told(done / total, "sums")
        except SchedulerLost as error:
            text = f"a scheduler with workers is required to the end, {total - done} of {total} files to do"
            problems.append(FleetProblem("", "", "", SCHEDULER, f"{text} ({error}): start again to go on"))
        finally:
            for joint in list(made):
                put(joint)
    return problems, done


def stored_of(out: Path, joint: str, recipe: str, logs: Iterable[LogFile]) -> dict[str, list[Stored]]:
    """The sums of a joint by period, of logs that are there and of logs that are no longer; in order of time.

    Sums of another rig than it has now do not count, nor those of a log that has changed since, or that is
    there under another name.
    """
    there = _There(logs)
    found: dict[str, list[Stored]] = {}
    for row in read(out, joint):
        if row.recipe == recipe and (there.unchanged(row) or there.gone(row)):
            found.setdefault(row.period, []).append(row)
    return {period: found[period] for period in in_order(found)}


def gone_of(stored: Mapping[str, Sequence[Stored]], logs: Iterable[LogFile]) -> list[str]:
    """The names of the logs whose sums count and which are no longer there."""
    there = _There(logs)
    return [row.name for rows in stored.values() for row in rows if there.gone(row)]


def outdated_of(out: Path, joint: str, recipe: str, logs: Iterable[LogFile]) -> list[FleetProblem]:
    """Sums that cannot be made anew: the rig has changed, and the log is gone."""
    there = _There(logs)
    text = "a log is required, since its sums were made with other values of the rig, and it is gone"
    return [
        FleetProblem(joint, row.period, row.name, "no log", text)
        for row in keys(out, joint)
        if row.recipe != recipe and there.gone(row)
    ]


class _There:
    """The logs of a joint that are there, by what tells them again."""

    def __init__(self, logs: Iterable[LogFile]) -> None:
        self._as_it_is: dict[tuple[str, str], tuple[int, int]] = {}
        self._moved: set[tuple[str, int, int]] = set()
        self._converted: set[tuple[str, str]] = set()
        for log in logs:
            self._as_it_is[log.period, log.name] = log.size, log.changed
            self._moved.add((log.period, log.size, log.changed))
            self._converted.add((log.period, without_suffix(log.name)))

    def unchanged(self, row: Key) -> bool:
        """Whether the log of some sums is as it was."""
        return self._as_it_is.get((row.period, row.name)) == (row.size, row.changed)

    def gone(self, row: Key) -> bool:
        """Whether it is gone: not changed, nor at another place, nor in another format."""
        return (
            (row.period, row.name) not in self._as_it_is
            and (row.period, row.size, row.changed) not in self._moved
            and (row.period, without_suffix(row.name)) not in self._converted
        )
