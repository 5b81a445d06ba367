"""Which windows of a long log are read: until more of them would add nothing.

Four rules, on the sums and states of the survey:

    spread    evenly from the first window to the last, and one for each run where there are not too many
    states    every state that the drive was in for a second or more is in a window
    unlike    windows that the base of a friction model explains much worse than the others are among them
    enough    coefficients from the windows predict the whole log as well as those from the whole log do
"""

from __future__ import annotations

import fnmatch
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.rigs import Rig
from eccentric.signals import limits
from eccentric.signals.long_survey import Window, state_name

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
