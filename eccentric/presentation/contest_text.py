"""Models on the same rows: a table for a terminal, and the document compare.json."""

from __future__ import annotations

from typing import Any

import numpy as np

from eccentric.core import few
from eccentric.diagnosis import BASELINE, Contest, Entry
from eccentric.model import TURNING, AxisKind
from eccentric.presentation.fit_json import gain_entry
from eccentric.presentation.fit_text import aligned
from eccentric.presentation.simulation_text import horizons_document
from eccentric.simulation import SimulatedErrors


def contest_document(found: Contest, simulated: SimulatedErrors | None = None) -> dict[str, Any]:
    """The contest as JSON, format eccentric-compare/1; the keys of an entry are those of `Entry`.

    `simulated` has for each horizon the mean absolute error of the simulated motor angle by model.
    """
    unit = found.unit.replace(" ", "")
    return {
        "format": "eccentric-compare/1",
        "logs": list(found.logs),
        "rig": found.rig,
        "baseline": BASELINE,
        **({"excerpt": found.excerpt} if found.excerpt else {}),
        "holdout": {"rule": found.holdout, "rows": found.rows},
        f"noise_floor_{unit}": found.noise_floor,
        "low_pass_hz": found.low_pass_hz,
        "models": [
            {
                "name": e.name,
                "effects": list(e.effects),
                f"rmse_holdout_{unit}": e.rmse,
                f"rmse_below_low_pass_{unit}": e.below,
                f"rmse_holdout_electrical_{unit}": e.circuit,
                "r_squared_holdout": e.r_squared,
                "parameters": e.parameters,
                "improvement": gain_entry(e.percent, e.interval),
            }
            for e in found.entries
        ],
        **({} if simulated is None else {"simulated": horizons_document(simulated)}),
        "warnings": list(found.warnings),
    }


def contest_lines(
    found: Contest, simulated: SimulatedErrors | None = None, axis: AxisKind = TURNING
) -> list[str]:
    """The models by number, and tables of their errors, for a terminal of 80 columns."""
    entries = found.entries
    columns = {
        f"below {found.low_pass_hz:g} Hz": [e.below for e in entries],
        "electrical": [e.circuit for e in entries],
    }
    shown = {head: column for head, column in columns.items() if any(x is not None for x in column)}
    rows = [["", "RMSE", *shown, "R^2", "parameters", "gain [%]"]]
    for k, e in enumerate(entries):
        errors = (_shown(column[k]) for column in shown.values())
        rows.append([f"{k + 1}", _shown(e.rmse), *errors, f"{e.r_squared:.4f}", f"{e.parameters}", _gain(e)])
    head = f"{few(found.logs)}: {found.rows} held-out rows ({found.holdout})"
    what = f"held-out RMSE [{found.unit}]; gain over {BASELINE}, with its 95 % interval"
    return [
        head,
        *([found.excerpt] if found.excerpt else []),
        *(f"{k + 1}  {_called(e)}" for k, e in enumerate(entries)),
        what,
        *aligned(rows),
        *_simulated(found, simulated, axis),
        f"sensor noise: {found.noise_floor:.3g} {found.unit}",
        *filter(None, [_first_below(found)]),
    ]


def _simulated(found: Contest, simulated: SimulatedErrors | None, axis: AxisKind) -> list[str]:
    """The table of the simulated motion; none without one."""
    if simulated is None:
        return []
    motion = {m.name: m.horizons for m in simulated.models}
    rows = [["", *(f"{horizon:g} s" for horizon in simulated.horizons_s)]]
    rows += [[f"{k + 1}", *map(_shown, motion[e.name])] for k, e in enumerate(found.entries)]
    angle, unit = axis.term("motor angle"), axis.unit("rad")
    return [f"mean absolute error of the simulated {angle} [{unit}], over windows of", *aligned(rows)]


def _shown(error: float | None) -> str:
    return "-" if error is None else f"{error:.4g}"


def _first_below(found: Contest) -> str:
    """What to make of another order below the low pass."""
    first = found.entries[0]
    best = min(found.entries, key=lambda e: np.inf if e.below is None else e.below)
    if first.below is None or best.below == first.below:
        return ""
    return (
        f"below {found.low_pass_hz:g} Hz {best.name} is the best; if it has a faster ripple, that adds error"
        " row by row, since the low pass removes the acceleration that it causes"
    )


def _called(entry: Entry) -> str:
    """The name, with the members that the families in it stand for."""
    chosen = [effect for effect in entry.effects if f"+{effect}" not in entry.name]
    return f"{entry.name} ({', '.join(chosen)})" if chosen else entry.name


def _gain(entry: Entry) -> str:
    if entry.name == BASELINE:
        return "-"
    low, high = entry.interval
    return f"{entry.percent:.1f} ({low:.1f} to {high:.1f})"
