"""Logs as they are fitted: whole, or the windows of a long one as one log with gaps between them."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from eccentric.core import few
from eccentric.logs import Excerpt, Log, LogSource, LogStream, log_stems, stream_log
from eccentric.model import AxisKind
from eccentric.rigs import ArmRig, Rig
from eccentric.signals import limits
from eccentric.signals.converted import named_apart, require_columns, run_column
from eccentric.signals.long_choice import ChosenWindows, choose
from eccentric.signals.long_survey import LogSurvey, Window, survey


def read_long(
    sources: Sequence[LogSource],
    rig: Rig,
    points: int = limits.SEARCH_POINTS,
    tell: Callable[[float], None] | None = None,
) -> list[Log]:
    """Return logs whole if they have 100,000 rows or fewer together, else windows of each.

    Args:
        sources: the logs, as `read_log` takes them; one that was read by this function is left as it is.
        rig: what is known about them.
        points: how many points of 250 Hz the windows may have together.
        tell: called with the part of the rows gone over, 0 to 1, while a long log is read.

    Raises:
        InputError: a log cannot be read, or does not fit the rig; one line with file and row.
    """
    return _read_long(sources, [rig], points, tell)


def read_long_joints(
    sources: Sequence[LogSource],
    rig: ArmRig,
    points: int = limits.SEARCH_POINTS,
    tell: Callable[[float], None] | None = None,
) -> list[Log]:
    """Return the logs of an arm whole, or the windows of each that are chosen for any joint.

    Each joint gets an equal share of the points, twelve windows at least, and a pass of its own; windows
    that any joint chooses are read for all. Arguments as those of `read_long`.

    Raises:
        InputError: as `read_long` does; columns of fewer or more joints than the arm has.
    """
    return _read_long(sources, rig.joints, points, tell, lambda log: require_columns(log, rig))


def _read_long(
    sources: Sequence[LogSource],
    rigs: Sequence[Rig],
    points: int,
    tell: Callable[[float], None] | None,
    require: Callable[[Log], None] = lambda _: None,
) -> list[Log]:
    """The logs of one drive, or of several that move together."""
    if all(isinstance(source, Log) and source.excerpt is not None for source in sources):
        return [source for source in sources if isinstance(source, Log)]
    names = [f"table {k}" for k in range(1, len(sources) + 1)] if len(sources) > 1 else ["table"]
    streams = [stream_log(source, name) for source, name in zip(sources, names, strict=True)]
    total = sum(stream.rows for stream in streams)
    if total <= limits.LONG_ROWS or any(rig.log.events for rig in rigs):
        return [stream.whole() for stream in streams]
    for stream in streams:
        require(_without_rows(stream))
    gone = 0

    def went(rows: int) -> None:
        nonlocal gone
        gone += rows
        if tell is not None:
            tell(min(1.0, gone / (total * len(rigs))))

    alone = len(streams) == 1 or named_apart((_of_runs(stream, rigs[0]) for stream in streams), rigs[0])
    chosen = [_chosen(streams, rig, points // len(rigs), alone, went) for rig in rigs]
    if tell is not None:
        tell(1.0)
    spans = [_together(span for one in chosen for span in one.spans(k)) for k in range(len(streams))]
    unread = [Path(stream.path).name for stream, own in zip(streams, spans, strict=True) if not own]
    note, missed = _said(chosen, rigs[0].axis)
    if unread:
        note += f"; no window of {few(unread)} is among them"
    logs: list[Log] = []
    for k, own in enumerate(spans):
        if own:
            logs.append(_read([one.surveys[k] for one in chosen], own, note, missed))
            note = missed = ""
    return logs


@dataclasses.dataclass(frozen=True)
class _Chosen:
    """The surveys of all logs for one drive, and its windows, counted over all of them."""

    surveys: Sequence[LogSurvey]
    choice: ChosenWindows

    @property
    def windows(self) -> list[Window]:
        """Those of all logs, in order."""
        return [window for found in self.surveys for window in found.windows]

    def at(self, places: Iterable[int]) -> dict[tuple[int, str, int], float]:
        """The lengths [s] of the windows at these places, by log, run and number, which all drives share."""
        of = [k for k, found in enumerate(self.surveys) for _ in found.windows]
        windows = self.windows
        return {
            (of[p], windows[p].run, windows[p].number): windows[p].finish - windows[p].begin for p in places
        }

    def spans(self, k: int) -> list[tuple[int, int]]:
        """Rows [first, end) of the chosen windows of a log."""
        before = sum(len(found.windows) for found in self.surveys[:k])
        own = range(before, before + len(self.surveys[k].windows))
        windows = self.windows
        return [(windows[p].first, windows[p].end) for p in self.choice.places if p in own]


def _chosen(
    streams: Sequence[LogStream], rig: Rig, points: int, alone: bool, went: Callable[[int], None]
) -> _Chosen:
    surveys = [
        survey(stream, rig, name, alone, went)
        for stream, name in zip(streams, log_stems(streams), strict=True)
    ]
    every = [window for found in surveys for window in found.windows]
    step = float(
        np.median([found.step_s for found in surveys if found.step_s] or [1.0 / limits.POINT_RATE_HZ])
    )
    seconds = points * max(step, 1.0 / limits.POINT_RATE_HZ)
    return _Chosen(surveys, choose(every, rig, max(1, int(seconds / limits.WINDOW_S))))


def _together(spans: Iterable[tuple[int, int]]) -> list[tuple[int, int]]:
    """The spans in order, those that touch or overlap as one."""
    found: list[tuple[int, int]] = []
    for first, end in sorted(spans):
        if found and first <= found[-1][1]:
            found[-1] = found[-1][0], max(found[-1][1], end)
        else:
            found.append((first, end))
    return found


def _read(surveys: Sequence[LogSurvey], spans: Sequence[tuple[int, int]], note: str, missed: str) -> Log:
    """Rows of one log, with the columns of all drives."""
    columns = list(dict.fromkeys(name for found in surveys for name in found.columns))
    log = surveys[0].stream.read(columns, spans)
    lengths = [end - first for first, end in spans]
    begins = np.cumsum(lengths[:-1], dtype=np.int64)
    rows, rejected = surveys[0].rows, max(found.rejected for found in surveys)
    return dataclasses.replace(log, excerpt=Excerpt(rows, rejected, begins, note, missed))


def _said(chosen: Sequence[_Chosen], axis: AxisKind) -> tuple[str, str]:
    """How much of the logs was chosen and why, and what is not in it; for several drives, of each."""
    every, windows = dict[tuple[int, str, int], float](), dict[tuple[int, str, int], float]()
    for one in chosen:
        every |= one.at(range(len(one.windows)))
        windows |= one.at(one.choice.places)
    used, whole = sum(windows.values()), sum(every.values())
    size = f"{len(windows)} of {len(every)} windows of {limits.WINDOW_S:g} s are used"
    size += f" ({used:.4g} of {whole:.5g} s)"
    left = f"{max(0.0, *(one.choice.worse for one in chosen)):.1%} in the square of what is left"
    of = "" if len(chosen) == 1 else " of every joint"
    if all(one.choice.enough for one in chosen):
        why = (
            f"more of them would add nothing: coefficients of the base model{of} from these windows predict"
            f" the whole log as well as those from all of it, to {left}"
        )
    else:
        some = "" if len(chosen) == 1 else " of some joint"
        why = (
            f"these are the most that are read: coefficients of the base model{some} from all of the log"
            f" predict it better, by {left}"
        )
    states = sum(one.choice.states for one in chosen)
    missing = sum(one.choice.missing for one in chosen)
    seen = f"{states - missing} of the {states} states that the drive{'' if not of else 's'}"
    seen += f" {'was' if not of else 'were'} in are in them"
    told = [_missed(one, axis.term("angle")) for one in chosen]
    if of:
        told = [f"joint {j}: {text}" for j, text in enumerate(told, start=1) if text]
    return f"{size}: {why}; {seen}", "; ".join(filter(None, told))


def _missed(chosen: _Chosen, angle: str) -> str:
    """What is not in the windows of a drive; "" for nothing."""
    choice, windows = chosen.choice, chosen.windows
    missed = []
    if choice.unseen:
        kinds = ", ".join(
            f"{cells * limits.CELL_S:.3g} s of {kind}" for kind, cells in choice.unseen.most_common()
        )
        missed.append(f"states of the drive that no window contains ({kinds})")
    if choice.unlike:
        missed.append(f"windows unlike the others ({_shown([windows[k] for k in choice.unlike])})")
    if choice.runs:
        missed.append(f"{choice.runs} runs")
    said = [f"not in the windows that are used: {'; '.join(missed)}"] if missed else []
    if choice.blind:
        shown = _shown([windows[k] for k in choice.blind])
        said.append(
            f"{len(choice.blind)} windows could not be assessed ({shown}), since their rows are too few or"
            f" too uneven in time, or the {angle} jumps: whether the windows that are used speak for them is"
            " not known"
        )
    return "; ".join(said)


def _shown(windows: Sequence[Window]) -> str:
    """Begin and end of the first few."""
    return few([f"{w.begin:.5g} to {w.finish:.5g} s" for w in windows], 3)


def _without_rows(stream: LogStream) -> Log:
    """The names of a log's columns."""
    return Log(stream.path, dict.fromkeys(stream.names, np.empty(0)), 0)


def _of_runs(stream: LogStream, rig: Rig) -> Iterator[Log]:
    """The batches of the column that names the runs; none without one."""
    empty = _without_rows(stream)
    columns = run_column(empty, rig)
    # A channel needs its own column as well; it has no rows here.
    for batch in stream.batches(columns) if columns else ():
        yield dataclasses.replace(batch, columns={**empty.columns, **batch.columns})
