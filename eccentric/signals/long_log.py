"""Logs as they are fitted: whole, or the windows of a long one as one log with gaps between them."""

from __future__ import annotations

import dataclasses
import fnmatch
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from eccentric.core import few
from eccentric.logs import Excerpt, Log, LogSource, LogStream, log_stems, stream_log
from eccentric.model import AxisKind
from eccentric.rigs import ArmRig, Rig
from eccentric.signals import limits
from eccentric.signals.converted import named_apart, require_columns, run_column
from eccentric.signals.long_survey import LogSurvey, Window, state_name, survey

# Which windows of a long log are read: until more of them would add nothing.
#
# Four rules, on the sums and states of the survey:
#
# spread    evenly from the first window to the last, and one for each run where there are not too many
# states    every state that the drive was in for a second or more is in a window
# unlike    windows that the base of a friction model explains much worse than the others are among them
# enough    coefficients from the windows predict the whole log as well as those from the whole log do


Array = NDArray[np.float64]


@dataclass(frozen=True)
class ChosenWindows:
    """The places of the chosen windows, in order; what they cover, and what they do not.

    `worse` is how much worse coefficients from the windows predict the whole log than those from the whole
    log, as a fraction of the square of what both leave; `enough` whether no more windows were needed.
    `states` are how many the log was in, `unseen` those without a window: what they are of, and their cells;
    `missing` how many those are;
    `unlike` the windows that are unlike the others and were not chosen; `runs` how many runs have no window;
    `blind` the windows without cells, of which nothing is known: none of the rest holds for them.
    """

    places: tuple[int, ...]
    worse: float
    enough: bool
    states: int
    missing: int
    unseen: Counter[str]
    unlike: tuple[int, ...]
    runs: int
    blind: tuple[int, ...]


def choose(windows: Sequence[Window], rig: Rig, most: int) -> ChosenWindows:
    """Choose at most `most` windows, or twelve where that is more."""
    candidates = [k for k, w in enumerate(windows) if _counts(w.run, rig)] or list(range(len(windows)))
    total = Counter[int]()
    for k in candidates:
        total.update(windows[k].seen)
    visited = {state for state, cells in total.items() if cells * limits.CELL_S >= limits.VISITED_S}
    whole = sum((windows[k].sums for k in candidates), np.zeros_like(windows[0].sums))
    best = solved(whole)
    must = _must(windows, candidates, rig, most)
    chosen, worse = set(must), np.inf
    for part in limits.ROUNDS:
        budget = min(len(candidates), max(limits.LEAST_LONG_WINDOWS, round(part * most)))
        odd_places = max(1, round(limits.ODD_PART * budget))
        chosen = must | _held(windows, candidates, rig, budget)
        chosen |= _even(candidates, budget - odd_places - len(chosen))
        chosen |= _for_states(windows, candidates, chosen, visited, budget - odd_places // 2)
        chosen |= set(_unlike(windows, candidates, chosen)[: max(0, min(odd_places, budget - len(chosen)))])
        # Rules agree on some windows, and what one needs no more is spread evenly too.
        chosen |= _even([k for k in candidates if k not in chosen], budget - len(chosen))
        worse = _worse(whole, best, solved(sum((windows[k].sums for k in chosen), np.zeros_like(whole))))
        seen = _seen(windows, chosen)
        if worse <= limits.AGREES and visited <= seen:
            break
    seen = _seen(windows, chosen)
    unseen = Counter[str]()
    for state in visited - seen:
        unseen[state_name(state)] += total[state]
    return ChosenWindows(
        tuple(sorted(chosen)),
        worse,
        worse <= limits.AGREES,
        len(visited),
        len(visited - seen),
        unseen,
        tuple(sorted(_unlike(windows, candidates, chosen))),
        len({windows[k].run for k in candidates} - {windows[k].run for k in chosen}),
        tuple(k for k in candidates if windows[k].wanted and not windows[k].assessed),
    )


def solved(sums: Array) -> Array:
    """The least-squares coefficients of sums X'X, X'y, y'y (k + 1, k + 1); directions without data are 0.

    Scaled, and by eigenvalues: the sums only rank windows, and coefficients that nearly depend on each other
    may share their effect in any way.
    """
    gram, right = sums[:-1, :-1], sums[:-1, -1]
    scale = np.sqrt(np.diag(gram))
    scale[scale == 0.0] = 1.0
    values, vectors = np.linalg.eigh(gram / np.outer(scale, scale))
    kept = values > limits.DEPENDENT * max(float(values[-1]), 1e-300)
    return vectors[:, kept] @ ((vectors[:, kept].T @ (right / scale)) / values[kept]) / scale


def _left(sums: Array, coefficients: Array) -> float:
    """The square of what coefficients leave of the drive."""
    x = np.append(-coefficients, 1.0)
    return max(0.0, float(x @ sums @ x))


def _worse(whole: Array, best: Array, own: Array) -> float:
    least = _left(whole, best)
    return (_left(whole, own) - least) / least if least > 0.0 else 0.0


def _counts(run: str, rig: Rig) -> bool:
    return not rig.log.runs or any(fnmatch.fnmatchcase(run, pattern) for pattern in rig.log.runs)


def _must(windows: Sequence[Window], candidates: Sequence[int], rig: Rig, most: int) -> set[int]:
    """The first and the last window, one of each run that the rig holds out, and of every run if few.

    And one that carries each added mass.
    """
    first_of: dict[str, int] = {}
    for k in candidates:
        first_of.setdefault(windows[k].run, k)
    held = {
        k for run, k in first_of.items() if any(fnmatch.fnmatchcase(run, name) for name in rig.holdout.runs)
    }
    # One for each mass: without a run that carries it, a name in [added] would be refused.
    carriers = {
        next((k for run, k in first_of.items() if fnmatch.fnmatchcase(run, name)), candidates[0])
        for name in rig.added
    }
    # A pattern may hold out hundreds of runs, all alike.
    held = (
        held
        if len(held) <= limits.RUNS_PART * most
        else set(_spread(sorted(held), round(limits.RUNS_PART * most)))
    )
    every = set(first_of.values()) if len(first_of) <= limits.RUNS_PART * most else set()
    return {candidates[0], candidates[-1]} | held | every | carriers


def _held(windows: Sequence[Window], candidates: Sequence[int], rig: Rig, budget: int) -> set[int]:
    """Windows in the held-out intervals of the rig; where these are shorter, those with most of them."""
    wanted = limits.HELD_OUT_PART * budget
    shared = {k: _shared(windows[k], rig) for k in candidates}
    inside = [k for k in candidates if shared[k] >= windows[k].finish - windows[k].begin > 0.0]
    if inside:
        return set(_spread(inside, round(wanted)))
    found: set[int] = set()
    seconds = 0.0
    for k in sorted(candidates, key=lambda k: -shared[k]):
        if (
            not shared[k]
            or seconds >= wanted * limits.WINDOW_S
            or (found and len(found) >= limits.MOST_HELD * budget)
        ):
            break
        found.add(k)
        seconds += shared[k]
    return found


def _shared(window: Window, rig: Rig) -> float:
    """How long a window is in held-out intervals of the rig [s]."""
    return sum(max(0.0, min(b, window.finish) - max(a, window.begin)) for a, b in rig.holdout.intervals_s)


def _spread(places: Sequence[int], count: int) -> list[int]:
    return [places[k] for k in np.unique(np.linspace(0, len(places) - 1, max(count, 1)).round().astype(int))]


def _even(candidates: Sequence[int], count: int) -> set[int]:
    return set(_spread(candidates, count)) if count > 0 else set()


def _seen(windows: Sequence[Window], chosen: Iterable[int]) -> set[int]:
    """The states that the windows are in for half a second or more."""
    total = Counter[int]()
    for k in chosen:
        total.update(windows[k].seen)
    return {state for state, cells in total.items() if cells * limits.CELL_S >= limits.VISITED_S / 2.0}


def _for_states(
    windows: Sequence[Window], candidates: Sequence[int], chosen: set[int], visited: set[int], budget: int
) -> set[int]:
    """Windows that add most of the states still missing, one after the other."""
    added: set[int] = set()
    missing = visited - _seen(windows, chosen)
    while missing and len(chosen) + len(added) < budget:
        gains = {
            k: sum(
                min(windows[k].seen.get(state, 0) * limits.CELL_S, limits.VISITED_S / 2.0)
                for state in missing
            )
            for k in candidates
            if k not in chosen and k not in added
        }
        best = max(gains, key=lambda k: gains[k], default=None)
        if best is None or not gains[best]:
            break
        added.add(best)
        missing = visited - _seen(windows, chosen | added)
    return added


def _unlike(windows: Sequence[Window], candidates: Sequence[int], chosen: set[int]) -> list[int]:
    """Windows not chosen whose residual, by the coefficients of the chosen ones, is unlike, worst first.

    Those beside a chosen window that is unlike as well are represented by it.
    """
    counted = [k for k in candidates if windows[k].cells >= limits.LEAST_CELLS]
    if not counted or not chosen:
        return []
    own = solved(sum((windows[k].sums for k in sorted(chosen)), np.zeros_like(windows[0].sums)))
    left = {k: _left(windows[k].sums, own) / windows[k].cells for k in counted}
    usual = float(np.median(list(left.values())))
    odd = {k for k in counted if left[k] > limits.ODD * usual}
    shown = {k + step for k in odd & chosen for step in (-1, 0, 1)}
    return sorted(odd - chosen - shown, key=lambda k: -left[k])


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
    left = f"{100 * max(0.0, *(one.choice.worse for one in chosen)):.1f} % of the squared residual"
    of = "" if len(chosen) == 1 else " of every joint"
    if all(one.choice.enough for one in chosen):
        why = (
            f"more would add nothing: the base model{of}, fitted to them, predicts the whole log as well as"
            f" if fitted to all of it, to {left}"
        )
    else:
        some = "" if len(chosen) == 1 else " of some joint"
        why = (
            f"no more are read: the base model{some}, fitted to the whole log, predicts it better, by {left}"
        )
    states = sum(one.choice.states for one in chosen)
    missing = sum(one.choice.missing for one in chosen)
    seen = f"they contain {states - missing} of the {states} states of the drive{'' if not of else 's'}"
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
    said = [f"not in these windows: {'; '.join(missed)}"] if missed else []
    if choice.blind:
        shown = _shown([windows[k] for k in choice.blind])
        said.append(
            f"{len(choice.blind)} windows could not be assessed ({shown}), since their rows are too few or"
            f" too uneven in time, or the {angle} jumps: the windows used may not represent them"
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
