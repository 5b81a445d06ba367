"""Models on the same rows: a table for a terminal, and the document compare.json."""

from __future__ import annotations

from typing import Any

import numpy as np

from eccentric.core import few
from eccentric.diagnosis import BASELINE, Contest, Entry
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


def contest_lines(found: Contest, simulated: SimulatedErrors | None = None, unit: str = "rad") -> list[str]:
    """The table for a terminal; `unit` is that of the simulated motor angle."""
    optional = {
        f"below {found.low_pass_hz:g} Hz [{found.unit}]": [e.below for e in found.entries],
        f"of the circuit [{found.unit}]": [e.circuit for e in found.entries],
    }
    if simulated is not None:
        motion = {m.name: m.horizons for m in simulated.models}
        for k, horizon in enumerate(simulated.horizons_s):
            optional[f"simulated {horizon:g} s [{unit}]"] = [motion[e.name][k] for e in found.entries]
    shown = {head: column for head, column in optional.items() if any(x is not None for x in column)}
    rows = [["model", f"held-out RMSE [{found.unit}]", *shown, "R^2", "parameters", f"gain over {BASELINE}"]]
    for k, e in enumerate(found.entries):
        cells = ["-" if column[k] is None else f"{column[k]:.4g}" for column in shown.values()]
        rows.append([_called(e), f"{e.rmse:.4g}", *cells, f"{e.r_squared:.4f}", f"{e.parameters}", _gain(e)])
    head = f"{few(found.logs)}: {found.rows} held-out rows ({found.holdout})"
    above = [head, *([found.excerpt] if found.excerpt else [])]
    noise = f"sensor noise: {found.noise_floor:.3g} {found.unit}"
    return [*above, *aligned(rows), noise, *filter(None, [_first_below(found)])]


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
    return f"{entry.percent:.1f} % ({low:.1f} to {high:.1f} %)"
