"""Recordings that differ: level of friction and gain of the drive, run by run, before they are pooled."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from eccentric.diagnosis.search.limits import LEAST_DIFFERENCE, LEAST_OTHERS, LEAST_SHARE_OF_LOAD
from eccentric.identification import BalanceDesign

Array = np.ndarray


def runs_that_differ(
    balance: BalanceDesign, torque: Array, friction: Array, names: Sequence[str]
) -> tuple[str, ...]:
    """A warning for each run of the training part whose friction or gain is unlike that of all the others.

    In each run the drive torque is a factor on the known load (inertia and gravity) plus a factor on the
    friction of the fit of all runs. A factor outside the range of the others by more than this range, and by
    a tenth, is another one.

    Args:
        balance: the mechanical one, its target being torque minus load.
        torque: drive torque on the samples (n,) [N m].
        friction: coefficients of its base, fitted on all runs.
        names: of the runs, by their numbers.
    """
    rows = balance.rows
    own, pooled = rows.mean(torque), balance.columns @ friction
    load = own - balance.target
    loaded = np.std(load) > LEAST_SHARE_OF_LOAD * np.std(own)
    columns = np.column_stack([pooled, load] if loaded else [pooled])
    target = own if loaded else balance.target
    runs = np.unique(rows.run)
    if len(runs) <= LEAST_OTHERS:
        return ()
    factors = np.array(
        [np.linalg.lstsq(columns[rows.run == run], target[rows.run == run], rcond=None)[0] for run in runs]
    )
    what = (("friction", "friction"), ("gain of the drive", "drive torque for the same load"))
    return tuple(
        f"run {names[int(runs[k])]}: its {name} differs from that of the other runs: {meaning} {value:.3g}"
        f" times that of all runs together, {low:.3g} to {high:.3g} times in the others; leave it out,"
        " or diagnose it alone"
        for (name, meaning), column in zip(what, factors.T, strict=False)
        for k, value, low, high in _outside(column)
    )


def _outside(factors: Array) -> Iterator[tuple[int, float, float, float]]:
    """(place, factor, range of the others) of each that is far outside."""
    for k, value in enumerate(factors):
        others = np.delete(factors, k)
        low, high = float(others.min()), float(others.max())
        if max(value - high, low - value) > max(high - low, LEAST_DIFFERENCE * abs(float(np.median(others)))):
            yield k, float(value), low, high
