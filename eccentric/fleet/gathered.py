"""Logs -> sums on disk: what is there stays, the rest is done on the cluster and written as it comes."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from eccentric.core import (
    InputError,
    few,
    given_path,
    read_document,
    read_table,
    read_utf8,
    readable,
    refuse_unknown,
    workshop,
)
from eccentric.fleet.cluster import Failed, SchedulerLost, spread, threads_of
from eccentric.fleet.limits import PART_FILES
from eccentric.fleet.sources import NO_RIG, SCHEDULER, FleetProblem, LogFile, in_order, without_suffix
from eccentric.fleet.sums import require_rig
from eccentric.fleet.work import (
    Job,
    Key,
    Stored,
    joints_of,
    keys,
    problem_of,
    read,
    recipe_of,
    tasks_of,
    work,
    write,
)
from eccentric.model import AXES, TURNING, AxisKind
from eccentric.rigs import Rig, knowns_of, read_rig, rig_of

# RIGS -> the rig of each joint: one rig file for all, or a table that maps joints to files and own values.
#
# rigs.csv      joint,rig,M_kg,k_i_Nm_per_A     further columns are keys of [known], empty for the file's
# rigs.toml     [joints.J7]  rig = "arm.toml"  known = { M = "1.2 kg" }
#
# Paths of rig files are relative to the table.


class Assigned:
    """The rigs of a fleet, read when a joint asks for its own."""

    def __init__(self, rigs: str) -> None:
        """Read a table or a rig file; InputError if it is neither."""
        self._path = path = given_path(rigs, "rigs")
        self._files: dict[Path, Mapping[str, Any]] = {}
        self._table: dict[str, tuple[str, Mapping[str, Any]]] | None
        readable(path)
        if path.suffix.lower() == ".csv":
            self._table = _of_csv(path)
            return
        content = read_document(path, "a rig file, or a table of rigs")
        self._table = _of_toml(content["joints"], path) if "joints" in content else None
        if self._table is None:
            self.rig("")

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints of the table; none where one rig holds for all."""
        return tuple(self._table or ())

    def rig(self, joint: str) -> Rig:
        """The rig of a joint. InputError for one that the table lacks, or whose rig cannot be read."""
        content = self.content(joint)
        if content is None:
            return _of_one_mass(read_rig(self._path))
        where = f"{self._path} (joint {joint})"
        return _of_one_mass(rig_of(content, where))

    def content(self, joint: str) -> Mapping[str, Any] | None:
        """The rig file of a joint with its own values; None where one file holds for all. Raises as `rig`."""
        if self._table is None:
            return None
        if joint not in self._table:
            raise InputError(self._path, f"a rig of joint {joint}", "none")
        name, own = self._table[joint]
        path = self._path.parent / name
        if path not in self._files:
            self._files[path] = read_document(path, "a rig file")
        content = dict(self._files[path])
        axis = AXES.get(str(content.get("kind")), TURNING)
        content["known"] = _with_own(read_table(content.get("known", {}), f"{path}: known"), own, axis)
        content["name"] = joint
        return content


def _of_one_mass(rig: Rig) -> Rig:
    """The rig. InputError for one with masses that some runs carry: the sums of a fleet are of one link."""
    if rig.added:
        raise InputError(rig.path, problem="[added]: expected logs of one mass in a fleet")
    return rig


def _with_own(known: Mapping[str, Any], own: Mapping[str, Any], axis: AxisKind) -> dict[str, Any]:
    """The values of a rig file with those of a joint in their place, whichever of its keys either uses."""
    letters = {_letter(key, axis) for key in own}
    return {key: value for key, value in known.items() if _letter(key, axis) not in letters} | dict(own)


def _letter(key: str, axis: AxisKind) -> str:
    """The letter of a key such as M_kg; a key that is none is left to the reader of rigs."""
    names = ((known.name, {known.key, known.name, axis.named(known.name)}) for known in knowns_of(axis))
    return next((name for name, keys in names if key in keys), key)


def _of_csv(path: Path) -> dict[str, tuple[str, Mapping[str, Any]]]:
    reader = csv.DictReader(io.StringIO(read_utf8(path), newline=""))
    found: dict[str, tuple[str, Mapping[str, Any]]] = {}
    try:
        names = list(reader.fieldnames or [])
        if not {"joint", "rig"} <= set(names):
            raise InputError(path, "columns joint and rig", few(names) or "none")
        if again := next((name for name in names if names.count(name) > 1), None):
            raise InputError(path, "each column", f"{again!r} twice", why="only once")
        for line, row in enumerate(reader, start=2):
            where = f"{path}: line {line}"
            if None in row or None in row.values():
                raise InputError(where, f"{len(names)} entries", "more or fewer")
            joint, rig = row.pop("joint"), row.pop("rig")
            _require_new(joint, found, where)
            found[joint] = rig, {key: _value(text) for key, text in row.items() if text.strip()}
    except csv.Error as error:
        raise InputError(
            path, problem=f"after line {reader.line_num}: not a table with commas ({error})"
        ) from None
    return found


def _value(text: str) -> float | str:
    """A number, or a text with a unit."""
    try:
        return float(text)
    except ValueError:
        return text


def _of_toml(joints: object, path: Path) -> dict[str, tuple[str, Mapping[str, Any]]]:
    found: dict[str, tuple[str, Mapping[str, Any]]] = {}
    for joint, entry in read_table(joints, f"{path}: [joints]").items():
        where = f"{path}: [joints.{joint}]"
        table = read_table(entry, where)
        refuse_unknown(table, ("rig", "known"), where)
        if not isinstance(table.get("rig"), str):
            raise InputError(f"{where}: rig", "the path of a rig file", f"{table.get('rig')!r}")
        found[joint] = table["rig"], read_table(table.get("known", {}), f"{where}: known")
    return found


def _require_new(joint: str, found: Mapping[str, object], where: str) -> None:
    if joint in found:
        raise InputError(where, "each joint", f"{joint!r} twice", why="only once")


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
            text = f"expected a scheduler with workers to the end, {total - done} of {total} files to do"
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
    text = "expected the log, since its sums were made with other values of the rig, but it is gone"
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
