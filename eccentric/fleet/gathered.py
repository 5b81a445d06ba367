"""Logs -> sums on disk: what is there stays, the rest is done on the cluster and written as it comes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from eccentric.errors import InputError
from eccentric.fleet.assigned import Assigned
from eccentric.fleet.cluster import Failed, SchedulerLost, spread
from eccentric.fleet.problems import FleetProblem
from eccentric.fleet.sources import LogFile, in_order
from eccentric.fleet.store import Key, Stored, keys, place_of, read, recipe_of, write
from eccentric.fleet.work import Job, problem_of, tasks_of, work
from eccentric.output import workshop
from eccentric.rigs import Rig

__all__ = ["Plan", "gather", "plan_of", "stored_of"]

Told = Callable[[float, str], None]
Place = tuple[str, str]


@dataclass
class Plan:
    """What has to be done: jobs by joint and period, the rigs and digests of the joints, problems so far.

    `reused` counts the files whose sums are there.
    """

    jobs: dict[Place, list[Job]] = field(default_factory=dict)
    rigs: dict[str, Rig] = field(default_factory=dict)
    recipes: dict[str, str] = field(default_factory=dict)
    problems: list[FleetProblem] = field(default_factory=list)
    reused: int = 0

    @property
    def files(self) -> int:
        """How many files have to be read."""
        return sum(map(len, self.jobs.values()))


def plan_of(logs: Iterable[LogFile], rigs: Assigned, out: Path) -> Plan:
    """What is left to be done for the logs of a fleet; joints without a rig are problems."""
    plan = Plan()
    refused: dict[str, str] = {}
    there: dict[Place, dict[str, Key]] = {}
    for log in logs:
        joint, place = log.joint, (log.joint, log.period)
        if joint not in plan.rigs and joint not in refused:
            try:
                plan.rigs[joint] = rigs.rig(joint)
                plan.recipes[joint] = recipe_of(plan.rigs[joint])
            except InputError as error:
                refused[joint] = str(error)
                plan.problems.append(FleetProblem(joint, "", "", "no rig", str(error)))
        if joint in refused:
            continue
        if place not in there:
            there[place] = {key.name: key for key in keys(place_of(out, *place))}
        key = there[place].get(log.name)
        if key is not None and key == Key(log.name, log.size, log.changed, plan.recipes[joint]):
            plan.reused += 1
        else:
            plan.jobs.setdefault(place, []).append(Job(log, plan.rigs[joint], plan.recipes[joint]))
    return plan


def gather(plan: Plan, client: Any, out: Path, told: Told) -> tuple[list[FleetProblem], int]:
    """Do the jobs of a plan; each joint and period is written when its last file is done.

    Returns the problems, and the number of files that were read. A scheduler that goes away ends it: what was
    done is kept, and that is one problem.
    """
    problems: list[FleetProblem] = []
    left = {place: len(jobs) for place, jobs in plan.jobs.items()}
    made: dict[Place, list[Stored]] = {}
    total, done = plan.files, 0

    def put(place: Place) -> None:
        if rows := made.pop(place, []):
            _write(out, place, rows, plan.recipes[place[0]], new_files)

    with workshop(out) as new_files:
        try:
            every = (job for place in plan.jobs for job in plan.jobs[place])
            for job, result in spread(client, work, tasks_of(every)):
                place = (job.log.joint, job.log.period)
                if isinstance(result, Failed):
                    problems.append(problem_of(job, "worker", str(result)))
                elif isinstance(result, FleetProblem):
                    problems.append(result)
                else:
                    made.setdefault(place, []).append(result)
                left[place] -= 1
                done += 1
                if not left[place]:
                    put(place)
                told(done / total, "sums")
        except SchedulerLost as error:
            text = f"a scheduler with workers is required to the end, {total - done} of {total} files to do"
            problems.append(FleetProblem("", "", "", "scheduler", f"{text} ({error}): start again to go on"))
        finally:
            for place in list(made):
                put(place)
    return problems, done


def stored_of(out: Path, joint: str, recipe: str) -> dict[str, list[Stored]]:
    """The sums of a joint by period, of logs that are there and of logs that are no longer; in order of time.

    Sums of another rig than it has now do not count.
    """
    places = sorted(place_of(out, joint, "").parent.glob("period=*.parquet"))
    found = {unquote(p.name.removeprefix("period=").removesuffix(".parquet")): read(p) for p in places}
    sound = {period: [row for row in rows if row.recipe == recipe] for period, rows in found.items()}
    return {period: sound[period] for period in in_order(sound) if sound[period]}


def _write(out: Path, place: Place, rows: Sequence[Stored], recipe: str, new_files: Path) -> None:
    """Write new sums beside those of the place's other files; the ones of another rig are dropped."""
    path = place_of(out, *place)
    new = {row.name: row for row in rows}
    kept = {row.name: row for row in read(path) if row.recipe == recipe and row.name not in new}
    write(path, sorted({**kept, **new}.values(), key=lambda row: row.name), new_files)
