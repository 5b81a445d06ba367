"""Logs as they are fitted: whole, or the windows of a long one as one log with gaps between them."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from eccentric.errors import few
from eccentric.logs import Excerpt, Log, LogSource, LogStream, stream_log
from eccentric.rigs import Rig
from eccentric.signals.converted import named_apart, run_column
from eccentric.signals.long.choice import ChosenWindows, choose
from eccentric.signals.long.limits import CELL_S, LONG_ROWS, POINT_RATE_HZ, SEARCH_POINTS, WINDOW_S
from eccentric.signals.long.survey import LogSurvey, Window, survey

__all__ = ["read_long"]


def read_long(
    sources: Sequence[LogSource],
    rig: Rig,
    points: int = SEARCH_POINTS,
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
    if all(isinstance(source, Log) and source.excerpt is not None for source in sources):
        return [source for source in sources if isinstance(source, Log)]
    names = [f"table {k}" for k in range(1, len(sources) + 1)] if len(sources) > 1 else ["table"]
    streams = [stream_log(source, name) for source, name in zip(sources, names, strict=True)]
    total = sum(stream.rows for stream in streams)
    if total <= LONG_ROWS:
        return [stream.whole() for stream in streams]
    gone = 0

    def went(rows: int) -> None:
        nonlocal gone
        gone += rows
        if tell is not None:
            tell(min(1.0, gone / total))

    alone = len(streams) == 1 or named_apart((_of_runs(stream, rig) for stream in streams), rig)
    surveys = [survey(stream, rig, alone, went) for stream in streams]
    if tell is not None:
        tell(1.0)
    every = [window for found in surveys for window in found.windows]
    step = float(np.median([found.step_s for found in surveys if found.step_s] or [1.0 / POINT_RATE_HZ]))
    seconds = points * max(step, 1.0 / POINT_RATE_HZ)
    choice = choose(every, rig, max(1, int(seconds / WINDOW_S)))
    note, missed = _said(choice, surveys)
    logs: list[Log] = []
    first = 0
    for found in surveys:
        own = [k - first for k in choice.places if first <= k < first + len(found.windows)]
        first += len(found.windows)
        if own:
            logs.append(_read(found, own, note, missed))
            note = missed = ""
    return logs


def _read(found: LogSurvey, places: Sequence[int], note: str, missed: str) -> Log:
    """The windows of one log."""
    spans: list[tuple[int, int]] = []
    for k in places:
        window = found.windows[k]
        if spans and spans[-1][1] == window.first:
            spans[-1] = spans[-1][0], window.end
        else:
            spans.append((window.first, window.end))
    log = found.stream.read(found.columns, spans)
    lengths = [end - first for first, end in spans]
    begins = np.cumsum(lengths[:-1], dtype=np.int64)
    return dataclasses.replace(log, excerpt=Excerpt(found.rows, found.rejected, begins, note, missed))


def _said(choice: ChosenWindows, surveys: Sequence[LogSurvey]) -> tuple[str, str]:
    """How much of the logs was chosen and why, and what is not in it."""
    windows = [window for found in surveys for window in found.windows]
    used = sum(windows[k].finish - windows[k].begin for k in choice.places)
    whole = sum(window.finish - window.begin for window in windows)
    size = f"{len(choice.places)} of {len(windows)} windows of {WINDOW_S:g} s are used,"
    size += f" {used:.4g} of {whole:.5g} s"
    left = f"{max(choice.worse, 0.0):.1%} in the square of what is left"
    if choice.enough:
        why = (
            "more of them say nothing new: coefficients of the base model from these windows predict the"
            f" whole log as well as those from all of it, to {left}"
        )
    else:
        why = (
            "these are the most that are read: coefficients of the base model from all of the log predict it"
            f" better, by {left}"
        )
    missed = []
    if choice.unseen:
        kinds = ", ".join(f"{cells * CELL_S:.3g} s of {kind}" for kind, cells in choice.unseen.most_common())
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
            " too uneven in time, or the angle jumps: whether the windows that are used speak for them is"
            " not known"
        )
    states = (
        f"{choice.states - choice.missing} of the {choice.states} states that the drive was in are in them"
    )
    return f"{size}: {why}; {states}", "; ".join(said)


def _shown(windows: Sequence[Window]) -> str:
    """Begin and end of the first few."""
    return few([f"{w.begin:.5g} to {w.finish:.5g} s" for w in windows], 3)


def _of_runs(stream: LogStream, rig: Rig) -> Iterator[Log]:
    """The batches of the column that names the runs; none without one."""
    empty = Log(stream.path, dict.fromkeys(stream.names, np.empty(0)), 0)
    columns = run_column(empty, rig)
    # A channel needs its own column as well; it has no rows here.
    for batch in stream.batches(columns) if columns else ():
        yield dataclasses.replace(batch, columns={**empty.columns, **batch.columns})
