"""Run by run: the error before and after, and whether the friction of the runs is one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eccentric.report.arrays import BalanceResiduals
from eccentric.report.bins import shown_rows
from eccentric.report.limits import BLOCK_S, LEAST_BLOCKS, LEAST_DIFFERENCE, SIGMAS

__all__ = ["RunErrors", "runs_apart", "runs_of"]

Array = np.ndarray


@dataclass(frozen=True)
class PartErrors:
    """Rows of a run: how many, and the RMS of the residual before and after; `after` is None without one."""

    rows: int
    before: float
    after: float | None


@dataclass(frozen=True)
class RunErrors:
    """A run of a balance.

    Attributes:
        name: of the run.
        fitted, held_out: its rows in motion, None without any. Fitted ones may have passed a low pass that
            held-out ones have not: their errors are not to be compared with each other.
        level: friction of the run over that of the model fitted to all, and its standard error; None where
            the balance contains no friction, or the run is too short for an error.
    """

    name: str
    fitted: PartErrors | None
    held_out: PartErrors | None
    level: tuple[float, float] | None


def runs_of(balance: BalanceResiduals) -> list[RunErrors]:
    """Every run with rows in motion, in the order of the logs."""
    rows, finite = balance.rows, np.isfinite(balance.paper)
    if balance.extended is not None:
        finite = finite & np.isfinite(balance.extended)
    found = []
    for run, name in enumerate(rows.run_names):
        own = finite & (rows.run == run)
        if (own & shown_rows(rows)).any():
            fitted, held_out = (_part(balance, own & mask) for mask in (rows.train, rows.held_out))
            found.append(RunErrors(name, fitted, held_out, _level(balance, own & shown_rows(rows))))
    return found


def _part(balance: BalanceResiduals, own: Array) -> PartErrors | None:
    if not own.any():
        return None
    after = None if balance.extended is None else _rms(balance.extended[own])
    return PartErrors(int(np.count_nonzero(own)), _rms(balance.paper[own]), after)


def runs_apart(runs: list[RunErrors]) -> tuple[RunErrors, RunErrors] | None:
    """The runs of least and most friction, if they differ clearly; None if one model suits them all."""
    told = sorted((run for run in runs if run.level is not None), key=lambda run: run.level or (0.0, 0.0))
    if len(told) < 2:
        return None
    least, most = told[0], told[-1]
    (low, low_error), (high, high_error) = least.level or (0.0, 0.0), most.level or (0.0, 0.0)
    clear = high - low > SIGMAS * float(np.hypot(low_error, high_error))
    return (least, most) if clear and high - low > LEAST_DIFFERENCE else None


def _level(balance: BalanceResiduals, own: Array) -> tuple[float, float] | None:
    """The factor on the model's friction that suits the run best; its standard error is by blocks of time."""
    if balance.measured is None:
        return None
    residual = (balance.paper if balance.extended is None else balance.extended)[own]
    model = balance.measured[own] - residual
    total = float(model @ model)
    block = np.floor(balance.rows.t[own] / BLOCK_S).astype(int)
    block = np.unique(block, return_inverse=True)[1]
    if total == 0.0 or block.max() + 1 < LEAST_BLOCKS:
        return None
    more = float(residual @ model) / total
    sums = np.bincount(block, (residual - more * model) * model)
    return 1.0 + more, float(np.sqrt(sums @ sums)) / total


def _rms(x: Array) -> float:
    return float(np.sqrt(np.mean(x**2)))
