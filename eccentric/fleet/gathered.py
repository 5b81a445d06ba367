"""Logs -> sums on disk: existing sums are reused, missing ones computed on the cluster and written."""

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


# RIGS -> the rig of each joint: one rig file for all, or a table of joints with rig files and values.
#
# rigs.csv      joint,rig,M_kg,k_i_Nm_per_A     further columns are keys of [known]; empty: the file's value
# rigs.toml     [joints.J7]  rig = "arm.toml"  known = { M = "1.2 kg" }
#
# Paths of rig files are relative to the table.
class Assigned:
    """The rigs of a fleet, read on demand."""

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
        """The joints of the table; none where one rig serves all."""
        return tuple(self._table or ())

    def rig(self, joint: str) -> Rig:
        """The rig of a joint. InputError if it is not in the table, or its rig cannot be read."""
        content = self.content(joint)
        if content is None:
            return _of_one_mass(read_rig(self._path))
        where = f"{self._path} (joint {joint})"
        return _of_one_mass(rig_of(content, where))

    def content(self, joint: str) -> Mapping[str, Any] | None:
        """The rig file's content with the joint's values; None where one file serves all. Raises as `rig`."""
        if self._table is None:
            return None
        if joint not in self._table:
            raise InputError(self._path, f"a rig of joint {joint}", "none")
        name, overrides = self._table[joint]
        path = self._path.parent / name
        if path not in self._files:
            self._files[path] = read_document(path, "a rig file")
        content = dict(self._files[path])
        axis = AXES.get(str(content.get("kind")), TURNING)
        known = read_table(content.get("known", {}), f"{path}: known")
        content["known"] = _with_overrides(known, overrides, axis)
        content["name"] = joint
        return content


def _of_one_mass(rig: Rig) -> Rig:
    """The rig; InputError if it has [added] masses, since a fleet's sums are of one link."""
    if rig.added:
        raise InputError(rig.path, problem="[added]: expected logs of one mass in a fleet")
    return rig


def _with_overrides(known: Mapping[str, Any], overrides: Mapping[str, Any], axis: AxisKind) -> dict[str, Any]:
    """The values of a rig file, overridden by those of a joint even under another key of a quantity."""
    letters = {_letter(key, axis) for key in overrides}
    return {key: value for key, value in known.items() if _letter(key, axis) not in letters} | dict(overrides)


def _letter(key: str, axis: AxisKind) -> str:
    """The symbol of a key such as M_kg; an unknown key is returned as it is, for the rig reader to refuse."""
    names = ((known.name, {known.key, known.name, axis.named(known.name)}) for known in knowns_of(axis))
    return next((name for name, keys in names if key in keys), key)


def _of_csv(path: Path) -> dict[str, tuple[str, Mapping[str, Any]]]:
    reader = csv.DictReader(io.StringIO(read_utf8(path), newline=""))
    assigned: dict[str, tuple[str, Mapping[str, Any]]] = {}
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
            if joint in assigned:
                raise InputError(where, "each joint", f"{joint!r} twice", why="only once")
            assigned[joint] = rig, {key: _value(text) for key, text in row.items() if text.strip()}
    except csv.Error as error:
        raise InputError(
            path, problem=f"after line {reader.line_num}: not a table with commas ({error})"
        ) from None
    return assigned


def _value(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def _of_toml(joints: object, path: Path) -> dict[str, tuple[str, Mapping[str, Any]]]:
    assigned: dict[str, tuple[str, Mapping[str, Any]]] = {}
    for joint, entry in read_table(joints, f"{path}: [joints]").items():
        where = f"{path}: [joints.{joint}]"
        table = read_table(entry, where)
        refuse_unknown(table, ("rig", "known"), where)
        if not isinstance(table.get("rig"), str):
            raise InputError(f"{where}: rig", "the path of a rig file", f"{table.get('rig')!r}")
        assigned[joint] = table["rig"], read_table(table.get("known", {}), f"{where}: known")
    return assigned


Progress = Callable[[float, str], None]


@dataclass
class Plan:
    """The jobs by joint, the joints' rigs with content and digests, and the problems so far."""

    joints: frozenset[str] = frozenset()  # those with logs or sums
    jobs: dict[str, list[Job]] = field(default_factory=dict)
    rigs: dict[str, Rig] = field(default_factory=dict)
    contents: dict[str, Mapping[str, Any] | None] = field(default_factory=dict)
    recipes: dict[str, str] = field(default_factory=dict)
    problems: list[FleetProblem] = field(default_factory=list)
    reused: int = 0  # files with cached sums

    @property
    def files(self) -> int:
        """Number of files to read."""
        return sum(map(len, self.jobs.values()))


def plan_of(logs: Iterable[LogFile], rigs: Assigned, out: Path) -> Plan:
    """Plan the jobs that remain for the logs of a fleet; joints without a rig are problems.

    Joints that have sums but no longer any log still belong to the fleet.
    """
    plan = Plan()
    logs = list(logs)
    cached: dict[str, set[Key]] = {}
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
        cached[joint] = set(keys(out, joint))
    for log in logs:
        joint = log.joint
        if joint not in cached:
            continue
        if Key(log.period, log.name, log.size, log.changed, plan.recipes[joint]) in cached[joint]:
            plan.reused += 1
        else:
            plan.jobs.setdefault(joint, []).append(Job(log, plan.rigs[joint], plan.recipes[joint]))
    return plan


def gather(plan: Plan, client: Any, out: Path, progress: Progress) -> tuple[list[FleetProblem], int]:
    """Do the jobs of a plan; a joint's sums are written after its last file, or in parts if it has many.

    Returns the problems and the number of files read. If the scheduler is lost, the completed results are
    written and the loss is one problem.
    """
    problems: list[FleetProblem] = []
    remaining = {joint: len(jobs) for joint, jobs in plan.jobs.items()}
    pending: dict[str, list[Stored]] = {}
    total, done = plan.files, 0

    def put(joint: str) -> None:
        if rows := pending.pop(joint, []):
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
                    pending.setdefault(joint, []).append(result)
                remaining[joint] -= 1
                done += 1
                if not remaining[joint] or len(pending.get(joint, [])) == PART_FILES:
                    put(joint)
                progress(done / total, "sums")
        except SchedulerLost as error:
            text = f"expected a scheduler with workers to the end, {total - done} of {total} files to do"
            problems.append(FleetProblem("", "", "", SCHEDULER, f"{text} ({error}): start again to go on"))
        finally:
            for joint in list(pending):
                put(joint)
    return problems, done


def stored_of(out: Path, joint: str, recipe: str, logs: Iterable[LogFile]) -> dict[str, list[Stored]]:
    """The valid sums of a joint by period, of present and of deleted logs, in order of time.

    Invalid are sums made with another rig than the joint has now, of a log that has changed since, or of one
    that was renamed.
    """
    present = _PresentLogs(logs)
    by_period: dict[str, list[Stored]] = {}
    for row in read(out, joint):
        if row.recipe == recipe and (present.unchanged(row) or present.gone(row)):
            by_period.setdefault(row.period, []).append(row)
    return {period: by_period[period] for period in in_order(by_period)}


def gone_of(stored: Mapping[str, Sequence[Stored]], logs: Iterable[LogFile]) -> list[str]:
    """The names of deleted logs whose sums still count."""
    present = _PresentLogs(logs)
    return [row.name for rows in stored.values() for row in rows if present.gone(row)]


def outdated_of(out: Path, joint: str, recipe: str, logs: Iterable[LogFile]) -> list[FleetProblem]:
    """Sums that cannot be recomputed: the rig has changed, and the log is gone."""
    present = _PresentLogs(logs)
    text = "expected the log, since its sums were made with other values of the rig, but it is gone"
    return [
        FleetProblem(joint, row.period, row.name, "no log", text)
        for row in keys(out, joint)
        if row.recipe != recipe and present.gone(row)
    ]


class _PresentLogs:
    """The present logs of a joint, indexed to recognise them when changed, renamed or converted."""

    def __init__(self, logs: Iterable[LogFile]) -> None:
        self._by_name: dict[tuple[str, str], tuple[int, int]] = {}
        self._by_stamp: set[tuple[str, int, int]] = set()
        self._by_stem: set[tuple[str, str]] = set()
        for log in logs:
            self._by_name[log.period, log.name] = log.size, log.changed
            self._by_stamp.add((log.period, log.size, log.changed))
            self._by_stem.add((log.period, without_suffix(log.name)))

    def unchanged(self, row: Key) -> bool:
        return self._by_name.get((row.period, row.name)) == (row.size, row.changed)

    def gone(self, row: Key) -> bool:
        """Whether it is gone: not changed, renamed or converted to another format."""
        return (
            (row.period, row.name) not in self._by_name
            and (row.period, row.size, row.changed) not in self._by_stamp
            and (row.period, without_suffix(row.name)) not in self._by_stem
        )
