"""Simulated motion: a table for a terminal, the document simulation.json, and the figure.

Keys of the document, format eccentric-simulation/1; errors are mean absolute errors of the motor angle:

    logs, rig, unit
    horizons          horizon_s, windows: number of them, errors: model -> error, null where it diverges
    models            name, model, runs and controlled: null or {mean, mean_held_out, by_run, held_out};
                      `runs` are driven by the logged signal, `controlled` by the controller of the rig
    ratios            over each horizon, the error of the last model over that of the one before it
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.core import few
from eccentric.diagnosis import BASELINE, Contest, Entry
from eccentric.emission import InertialLoss, inertial_loss
from eccentric.identification import Refit
from eccentric.model import TURNING, AxisKind, with_values
from eccentric.presentation.fit_json import finite, gain_entry, ranges
from eccentric.presentation.fit_text import aligned
from eccentric.rigs import Rig
from eccentric.simulation import ModelErrors, Refined, SimulatedErrors, WholeRunErrors

FORMAT = "eccentric-simulation/1"
_COLOURS = ("#8a8a8a", "#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00")
_MEASURED = "black"


def simulation_document(
    found: SimulatedErrors, logs: Sequence[str], rig: Rig, models: Mapping[str, str]
) -> dict[str, Any]:
    """The simulated errors as strict JSON; `models` are the names of the models by the names of the fits."""
    return {
        "format": FORMAT,
        "logs": list(logs),
        "rig": Path(rig.path).name,
        "unit": rig.axis.unit("rad"),
        "horizons": horizons_document(found),
        "models": [
            {
                "name": m.name,
                "model": models[m.name],
                "runs": _runs_document(m.runs),
                "controlled": _runs_document(m.controlled),
            }
            for m in found.models
        ],
        "ratios": [finite(x) for x in _ratios(found)],
    }


def horizons_document(found: SimulatedErrors) -> list[dict[str, Any]]:
    """The errors over each horizon, as diagnosis.json and compare.json have them too."""
    return [
        {
            "horizon_s": horizon,
            "windows": found.windows[k],
            "errors": {m.name: finite(m.horizons[k]) for m in found.models},
        }
        for k, horizon in enumerate(found.horizons_s)
    ]


def simulation_lines(found: SimulatedErrors, logs: Sequence[str], axis: AxisKind) -> list[str]:
    """The table for a terminal."""
    unit = axis.unit("rad")
    counts = ", ".join(
        f"{count} of {horizon:g} s" for horizon, count in zip(found.horizons_s, found.windows, strict=True)
    ).replace(" of", " windows of", 1)
    head = f"{few(logs)}: simulated from measured states in the held-out part: {counts}"
    columns = [f"{horizon:g} s" for horizon in found.horizons_s]
    rows = [["model", *columns, *(name for name, _ in _of_runs(found.models[0]))]]
    for m in found.models:
        errors = [*m.horizons, *(value for _, value in _of_runs(m))]
        rows.append([m.name, *map(_shown, errors)])
    if len(found.models) > 1 and any(x is not None for x in _ratios(found)):
        one, other = found.models[-1].name, found.models[-2].name
        rows.append([f"{one} / {other}", *map(_shown, _ratios(found)), *([""] * (len(rows[0]) - 4))])
    what = f"mean absolute error of the {axis.term('motor angle')} [{unit}]"
    return [head, what, *aligned(rows)]


def refined_document(found: Refined) -> dict[str, Any]:
    """What a refinement did, for fit.json: mean absolute errors of the motor angle, before and after."""
    held = None if found.held_out is None else dict(zip(("before", "after"), found.held_out, strict=True))
    return {
        "horizon_s": found.horizon_s,
        "spans": found.spans,
        "training": {"before": found.before, "after": found.after},
        "held_out": held,
    }


def refined_lines(found: Refined, axis: AxisKind) -> list[str]:
    """The same in a line for a terminal."""
    over = (
        "whole runs with the controller" if found.horizon_s is None else f"windows of {found.horizon_s:g} s"
    )
    held = ""
    if found.held_out is not None:
        held = "; held out: {} before, {} after".format(*map(_shown, found.held_out))
    what = f"mean absolute error of the simulated {axis.term('motor angle')} [{axis.unit('rad')}]"
    change = f"{_shown(found.before)} before, {_shown(found.after)} after{held}"
    return [f"refined on {found.spans} {over}; {what}: {change}"]


def refined_warnings(found: Refined | None, axis: AxisKind) -> list[str]:
    """A refinement that predicts the held-out part worse than the fit it started from."""
    if found is None or found.held_out is None or found.held_out[1] <= found.held_out[0]:
        return []
    before, after = map(_shown, found.held_out)
    change = f"from {before} to {after} {axis.unit('rad')}"
    text = f"the refinement raises the held-out error of the simulated {axis.term('motor angle')} {change}"
    return [f"{text}: the fit without it predicts the motion better"]


def loss_warnings(fits: Mapping[str, Refit]) -> list[str]:
    """Models whose friction takes more of an acceleration than their inertia, at the speeds of their log."""
    found = []
    for name, fit in fits.items():
        model = fit.model
        own = {q.name: fit.values[q.name] for q in model.parameters if q.name in fit.values}
        _, fastest = ranges(fit.data.drive.channels)["speed_m_rad_s"] or (0.0, 1.0)
        loss = inertial_loss(with_values(model, own, model.name), fastest)
        if loss is not None and not loss.solvable:
            found.append(f"{name}: {loss_sentence(loss, model.axis)}")
    return found


def loss_sentence(loss: InertialLoss, axis: AxisKind) -> str:
    """What is wrong with friction that takes more of an acceleration than the inertia."""
    unit = axis.unit("kg m^2")
    return (
        f"friction that depends on the acceleration amounts to up to {loss.loss:.3g} {unit}, more than the"
        f" {axis.term('inertia')} of {loss.inertia:.3g} {unit}: a time step has no unique solution"
    )


def not_emitted(loss: InertialLoss | None, axis: AxisKind) -> tuple[str, ...]:
    """The warning that a diagnosis writes no code of its model, if friction takes as much as the inertia."""
    if loss is None or loss.solvable:
        return ()
    return (f"{loss_sentence(loss, axis)}: the extended model is not emitted; model.py has its physics",)


def no_inertia_sentence(name: str, axis: AxisKind) -> str:
    """What is wrong with an inertia that a log puts at 0."""
    inertia = f"{axis.named(name)}, the {axis.term('inertia')} of the drive,"
    return f"{inertia} is 0 in the log, which diagnose refuses: declare it"


def plot_simulation(found: SimulatedErrors, axes: Sequence[Any], unit: str) -> None:
    """Draw measured and simulated angle over time, each of the traces on axes of its own."""
    for ax, trace in zip(axes, found.traces, strict=False):
        shift, t = trace.measured[0], trace.t - trace.t[0]
        for (name, angle), colour in zip(trace.simulated.items(), _COLOURS, strict=False):
            ax.plot(t, angle - shift, color=colour, label=name, linewidth=1.2)
        ax.plot(t, trace.measured - shift, color=_MEASURED, label="measured", linewidth=0.9)
        # What diverges is not drawn to its end.
        low, high = np.min(trace.measured - shift), np.max(trace.measured - shift)
        room = 0.5 * (high - low) + 1e-9
        title = f"{trace.run}, from {trace.t[0]:.4g} s"
        ax.set(ylabel=f"angle [{unit}]", title=title, ylim=(low - room, high + room))
        ax.grid(linewidth=0.3)
    if len(axes):
        axes[-1].set_xlabel("time in the window [s]")
        axes[0].legend(loc="best", frameon=False, ncols=2)


def _of_runs(m: ModelErrors) -> list[tuple[str, float | None]]:
    """Heading and error of the columns of whole runs."""
    found: list[tuple[str, float | None]] = []
    if m.runs is not None:
        found.append(("whole runs", m.runs.mean))
    if m.controlled is not None:
        found.append(("with controller", m.controlled.mean))
        if m.controlled.mean_held_out is not None:
            found.append(("held out", m.controlled.mean_held_out))
    return found


def _ratios(found: SimulatedErrors) -> list[float | None]:
    if len(found.models) < 2:
        return [None] * len(found.horizons_s)
    return found.ratios(found.models[-1].name, found.models[-2].name)


def _runs_document(runs: WholeRunErrors | None) -> dict[str, Any] | None:
    if runs is None:
        return None
    return {
        "mean": finite(runs.mean),
        "mean_held_out": finite(runs.mean_held_out),
        "by_run": {name: finite(error) for name, error in runs.by_run.items()},
        "held_out": list(runs.held_out),
    }


def _shown(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}" if math.isfinite(value) else "diverges"


# Models on the same rows: a table for a terminal, and the document compare.json.


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
        errors = (_error(column[k]) for column in shown.values())
        rows.append([f"{k + 1}", _error(e.rmse), *errors, f"{e.r_squared:.4f}", f"{e.parameters}", _gain(e)])
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
    rows += [[f"{k + 1}", *map(_error, motion[e.name])] for k, e in enumerate(found.entries)]
    angle, unit = axis.term("motor angle"), axis.unit("rad")
    return [f"mean absolute error of the simulated {angle} [{unit}], over windows of", *aligned(rows)]


def _error(error: float | None) -> str:
    return "-" if error is None else f"{error:.4g}"


def _first_below(found: Contest) -> str:
    """What to make of another order below the low pass."""
    first = found.entries[0]
    best = min(found.entries, key=lambda e: np.inf if e.below is None else e.below)
    if first.below is None or best.below == first.below:
        return ""
    return (
        f"below {found.low_pass_hz:g} Hz {best.name} is the best; if it has a faster ripple, that adds error"
        " row by row, since the low-pass filter removes the acceleration that it causes"
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
