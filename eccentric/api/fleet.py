"""`eccentric.diagnose_fleet`: the logs of many joints over many periods, what drifts, and what changed."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any
from urllib.parse import quote

from eccentric.api.diagnosed import DiagnosisResult, diagnose
from eccentric.api.result import Printed
from eccentric.api.tables import ResultTable
from eccentric.core import (
    InputError,
    counted,
    few,
    own_folder,
    remove_folder,
    so_more,
    whole_file,
    whole_folder,
)
from eccentric.fleet import (
    NOT_GROUPED,
    NOT_TESTED,
    RATE,
    SCHEDULER,
    UNREAD,
    Drifting,
    Examined,
    FleetFound,
    FleetProblem,
    FleetRequest,
    Sample,
    Suspect,
    as_csv,
    give_back,
    run_fleet,
)
from eccentric.presentation import (
    changes_csv,
    fleet_document,
    fleet_page,
    fleet_sentence,
    joints_without_logs,
    write_coefficients,
)
from eccentric.version import __version__

_COMMAND = "fleet"
_TOGETHER = (NOT_GROUPED, NOT_TESTED)
"""Kinds of problems that are said once for all that have them."""
_LABELS = frozenset({"path", "name", "warnings"})
"""What a rig is called and what is said of it: no diagnosis depends on them."""


def diagnose_fleet(
    logs: str | os.PathLike[str],
    rigs: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    pattern: str | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    rate: float = RATE,
    progress: Callable[[float, str], None] | None = None,
) -> FleetResult:
    """Find which joints of a fleet changed, and how, from friction coefficients by joint and period.

    Results of an earlier run in `out` are reused: only new and changed logs are read. Logs are never
    modified. Joints that changed are diagnosed against their own past. Workers are processes that import the
    calling script: call this below `if __name__ == "__main__":`.

    Args:
        logs: a folder or a glob of logs, preferably Parquet, in folders such as joint=J7/month=2025-03.
        rigs: a rig file for all joints, or a table (.csv, .toml) of joints, their rig files and individual
            values.
        out: a folder of its own for sums, coefficients, the page and the joints' reports.
        pattern: pattern of the file names if folders do not give joint and period: "{joint}_{period}".
        scheduler: the address of a Dask scheduler, whose workers see the logs under the same paths; by
            default a cluster on this machine.
        workers: processes of that cluster, by default one for each processor.
        rate: false discovery rate of the tests, above 0 and below 1.
        progress: called with the part that is done, 0 to 1, and the name of the stage.

    Raises:
        InputError: there are no logs, rigs, scheduler or workers, dask or pyarrow is not installed, or the
            folder cannot be written. Problems of single joints or files are in the result.
    """
    if not 0.0 < rate < 1.0:
        raise InputError("rate", "a number above 0 and below 1", f"{rate:g}")
    count = os.cpu_count() or 1 if workers is None else workers
    if count < 1:
        raise InputError("workers", "at least 1", count)
    target = own_folder(out)
    if not target.exists() or not any(target.iterdir()):
        with whole_folder(out, _COMMAND):
            pass  # marks the folder as one of ours, so that sums can be kept in it from the first on
    request = FleetRequest(os.fspath(logs), os.fspath(rigs), pattern, scheduler, count, rate)
    found = run_fleet(
        request,
        target,
        _examined,
        lambda suspect, result: _kept(target, suspect, result),
        lambda suspect: _known(target, suspect),
        progress or (lambda part, what: None),
    )
    document = fleet_document(found)
    with whole_folder(out, _COMMAND) as folder:
        write_coefficients(found, folder)
        (folder / "changes.csv").write_text(
            changes_csv(found.changes, {one.joint for one in found.drifting}), encoding="utf-8"
        )
        (folder / "problems.csv").write_text(as_csv(found.problems), encoding="utf-8")
        text = json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
        (folder / "fleet.json").write_text(text, encoding="utf-8")
        (folder / "report.html").write_text(fleet_page(found), encoding="utf-8")
    if not any(problem.kind == SCHEDULER for problem in found.problems):
        _forget(target, found.unchanged)
    return FleetResult(
        lines=tuple(_lines(found)),
        warnings=tuple(_warnings(found.problems)),
        document=document,
        drifting=found.drifting,
        problems=found.problems,
        files=found.files,
        reused=found.reused,
        gone=found.gone,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class FleetResult(Printed):
    """The result of a fleet run. It prints as `summary()`.

    Attributes:
        drifting: joints that changed, the most urgent first: what changed, since when, errors before and
            after.
        problems: what could not be done, as in problems.csv; everything else was.
        files: logs of this run, read or listed in problems; `reused`: logs whose sums existed already;
            `gone`: names of logs that no longer exist, but whose sums still count.
        lines, warnings, document: as in Printed; the document is the content of fleet.json.
    """

    drifting: tuple[Drifting, ...]
    problems: tuple[FleetProblem, ...]
    files: int
    reused: int
    gone: tuple[str, ...]

    def table(self) -> ResultTable:
        """The joints that changed."""
        sizes = ("part_of_friction", "residual_factor")
        names = ("joint", "what", "since", *sizes, "p", "rmse_before", "rmse_after", "unit")
        rows = (
            (d.joint, d.what, d.since, *(getattr(d, s) for s in sizes), d.p, d.before, d.after, d.unit)
            for d in self.drifting
        )
        return ResultTable(names, tuple(rows))

    def _layout(self) -> tuple[tuple[int, int], tuple[float, float]]:
        return (1, 1), (8.0, 1.5 + 0.4 * len(self.drifting))

    def _draw(self, axes: list[Any]) -> None:
        """The joints that changed, each by its error after the change over that before."""
        ax, shown = axes[0], [d for d in self.drifting if d.before]
        ax.barh([d.joint for d in shown], [(d.after or 0.0) / d.before for d in shown], color="#0072b2")
        ax.axvline(1.0, color="black", linestyle=":")
        ax.invert_yaxis()
        ax.set_xlabel("error after / before")


def _lines(found: FleetFound) -> list[str]:
    failed = sum(problem.kind in UNREAD for problem in found.problems)
    read = f"{counted(found.files - failed, 'log')} read, {found.reused} unchanged"
    if failed:
        read += f"; {failed} could not be used"
    if found.gone:
        gone = f"{counted(len(found.gone), 'log')} no longer there still count ({few(found.gone, 3)})"
        read += f"; the sums of {gone}: to drop them, delete the joint's folder in sums/"
    read = "; ".join([read, *joints_without_logs(found)])
    lines = [
        f"{d.joint}: {d.what}, since {d.since}; {d.size}; error {d.before:.3g} -> {d.after:.3g} {d.unit}"
        for d in found.drifting
    ]
    return [f"{counted(found.joints, 'joint')}; {read}", *lines, fleet_sentence(found)]


def _warnings(problems: Sequence[FleetProblem]) -> Iterator[str]:
    """A line for each problem, and one for all that are alike: logs of no joint, joints of few periods."""
    yield from (_said(problem) for problem in problems if problem.kind not in _TOGETHER)
    for kind in _TOGETHER:
        if alike := [problem for problem in problems if problem.kind == kind]:
            yield f"{_said(alike[0])}{so_more(len(alike) - 1)}"


def _said(problem: FleetProblem) -> str:
    where = " ".join(filter(None, (problem.joint, problem.period)))
    return f"{where}: {problem.text}" if where else problem.text


def _examined(suspects: Sequence[Suspect]) -> list[tuple[DiagnosisResult | None, tuple[str, ...], str]]:
    """On a worker: the diagnosis of each suspect's recent log, and the families that its past lacked as well.

    The past is asked only where no coefficient explains the change; its effects are then in the model from
    the start, where they can be, so that errors before and after are about new ones. In place of a diagnosis:
    why not.
    """
    found: list[tuple[DiagnosisResult | None, tuple[str, ...], str]] = []
    for suspect in suspects:
        give_back()
        try:
            past: tuple[str, ...] = ()
            if not suspect.changed.names:
                past = _families(_diagnosed(suspect, suspect.past, "past"))
            found.append((_beyond(suspect, past), past, ""))
        except InputError as error:
            found.append((None, (), str(error)))
        except Exception as error:  # noqa: BLE001 - one joint must not end the run
            found.append((None, (), f"{type(error).__name__}: {error}"))
    return found


def _beyond(suspect: Suspect, past: Sequence[str]) -> DiagnosisResult:
    """The diagnosis of the recent log beyond effects of the past, where the model can have these."""
    if past:
        try:
            return _diagnosed(suspect, suspect.recent, "recent", past)
        except InputError:
            pass  # one of them has hidden states, or the log is wrong, which is said below
    return _diagnosed(suspect, suspect.recent, "recent")


def _diagnosed(
    suspect: Suspect, sample: Sample | None, when: str, including: Sequence[str] = ()
) -> DiagnosisResult:
    if sample is None:
        raise InputError(f"expected a log of the {when} periods to diagnose, but none is there any longer")
    rig = suspect.rig
    if suspect.content is not None:  # as the report names it, for its command to be one that can be run
        rig = dataclasses.replace(rig, path=_rig_file(suspect))
    found = diagnose(sample.log(rig), rig, including=including)
    names = suspect.changed.names
    occasion = (
        f"Joint {suspect.joint} changed, since {suspect.changes[0].since}"
        + (f", in its {' and '.join(names)}" if names else ", in a way that no coefficient explains")
        + ". This is its latest log with motion, and what that shows by itself: friction that has grown is no"
        " effect that a model lacks. The page of the fleet, ../../report.html, compares it with the past."
    )
    source = dataclasses.replace(found.data.source, occasion=occasion)
    return dataclasses.replace(found, data=dataclasses.replace(found.data, source=source))


def _rig_file(suspect: Suspect) -> str:
    return f"{quote(suspect.joint, safe=' ')}.rig.json"


def _families(found: DiagnosisResult) -> tuple[str, ...]:
    return tuple(dict.fromkeys(effect["family"] for effect in found.document["effects"]))


def _kept(
    out: Path, suspect: Suspect, result: tuple[DiagnosisResult | None, tuple[str, ...], str]
) -> Examined:
    """Write the report of a joint, and the word of its diagnosis beside it for the next run."""
    found, past, said = result
    if found is None:
        return Examined(said=said)
    place = _place(out, suspect)
    found.write(place)
    if suspect.content is not None:
        with whole_file(place.with_name(_rig_file(suspect))) as new:
            new.write_text(json.dumps(suspect.content, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    balance = found.document["improvement"]["balance"]
    rmse = found.rmse[balance]
    every = found.document["effects"]
    effects = [e for e in every if e["family"] not in past]
    word = Examined(
        tuple(dict.fromkeys(e["family"] for e in effects)),
        tuple(f"{e['headline']} ({e['id']})" if e["headline"] else e["id"] for e in effects),
        rmse["paper"],
        rmse["extended"],
        found.unit,
        f"joints/{quote(place.name)}/report.html",
        again=tuple(dict.fromkeys(e["family"] for e in every if e["family"] in past)),
        tied=tuple(found.document["tied"]),
        friction=not effects or any(e["balance"] == "mechanical" and not e["corrects"] for e in effects),
    )
    with whole_file(place.with_name(f"{place.name}.json")) as new:
        new.write_text(json.dumps({"of": _digest(suspect), **asdict(word)}), encoding="utf-8")
    return word


def _forget(out: Path, unchanged: Iterable[str]) -> None:
    """Remove the reports of joints that an earlier run called changed and this one has found unchanged.

    The word of the diagnosis goes last, so that a run that is ended meanwhile leaves the rest to the next.
    A folder that cannot be removed stays: nothing else depends on it.
    """
    for joint in unchanged:
        place = out / "joints" / quote(joint, safe=" ")
        if (word := place.with_name(f"{place.name}.json")).is_file():
            with suppress(InputError, OSError):
                if place.is_dir():
                    remove_folder(place, "diagnose")
                place.with_name(f"{place.name}.rig.json").unlink(missing_ok=True)
                word.unlink()


def _known(out: Path, suspect: Suspect) -> Examined | None:
    """The word of an earlier run on the same logs and rig, None without one."""
    place = _place(out, suspect)
    try:
        content = json.loads(place.with_name(f"{place.name}.json").read_text(encoding="utf-8"))
        if content.pop("of") != _digest(suspect) or not (place / "report.html").is_file():
            return None
        lists = {name: tuple(content.pop(name)) for name in ("families", "effects", "again", "tied")}
        return Examined(**lists, **content)
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _place(out: Path, suspect: Suspect) -> Path:
    return out / "joints" / quote(suspect.joint, safe=" ")


def _digest(suspect: Suspect) -> str:
    """What a diagnosis depends on: version, rig but for its labels, logs, whether the past is asked."""
    values = {f.name: getattr(suspect.rig, f.name) for f in fields(suspect.rig) if f.name not in _LABELS}
    rig = sorted((name, _plain(value)) for name, value in values.items())
    made = __version__, rig, suspect.past, suspect.recent, bool(suspect.changed.names)
    return hashlib.sha256(repr(made).encode()).hexdigest()


def _plain(value: object) -> str:
    """A text of a part of a rig, the same in each run whatever the order of its entries."""
    if isinstance(value, Mapping):
        return repr(sorted(value.items()))
    return repr(sorted(value)) if isinstance(value, frozenset) else repr(value)
