"""`eccentric.compare`, `eccentric.simulate`: models on the same rows and the same split; their motion."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from eccentric.api.inputs import LogSources, ModelSource, RigSource, by_name, given_path, sources_of
from eccentric.api.result import Printed, fitted_model
from eccentric.api.tables import ResultTable
from eccentric.core import InputError
from eccentric.diagnosis import BASELINE, Contest, contest
from eccentric.diagnosis import diagnose as diagnose_logs
from eccentric.logs import log_names
from eccentric.model import Model
from eccentric.presentation import (
    contest_document,
    contest_lines,
    loss_warnings,
    plot_simulation,
    simulation_document,
    simulation_lines,
)
from eccentric.rigs import read_rig
from eccentric.signals import read_long
from eccentric.simulation import SimulatedErrors, simulated_errors

_BAR, _BASELINE_BAR = "#0072b2", "#8a8a8a"


def compare(
    logs: LogSources,
    rig: RigSource,
    models: ModelSource | Sequence[ModelSource],
    effects: str | os.PathLike[str] | None = None,
    *,
    reading: Callable[[float], None] | None = None,
) -> CompareResult:
    """Fit models to logs of a rig, on the same rows, and compare their errors on the held-out rows.

    Args:
        logs: one log or a list of them, as `fit` takes them.
        rig: what is known about the rig, as `fit` takes it.
        models: one model or several: a Model, its name, or the path of a derivation. A name or path may be
            extended by effects, each a family or an id: "c2_parallel+stribeck[d=1]+cogging". A family means
            the member that fits the training part best.
        effects: the path of a Python file with your own effects.
        reading: called with the part of the rows read, 0 to 1, while logs of more than 100,000 rows are read.

    Raises:
        InputError: bad input; a model twice; one with a tilt in a level plane, hidden states of its own, or
            an effect of the current from the start; an effect that is unknown or that the log does not show.
    """
    named, own = _models(models), None if effects is None else given_path(effects, "effects")
    sources, rig = sources_of(logs), read_rig(rig)
    found = contest(read_long(sources, rig, tell=reading), rig, named, own)
    simulated = simulated_errors(found.fits)
    best = [entry.name for entry in found.entries]
    fitted = {name: fitted_model(found.fits[name], rig.axis) for name in best}
    found = replace(found, unit=rig.axis.unit(found.unit), fits={})
    return CompareResult(
        contest=found,
        simulated=simulated,
        lines=tuple(contest_lines(found, simulated, rig.axis)),
        warnings=found.warnings,
        document=contest_document(found, simulated),
        fitted=fitted,
    )


def _models(models: ModelSource | Sequence[ModelSource]) -> list[str | Model]:
    """One model or several, by name where they have one."""
    several = [models] if isinstance(models, str | os.PathLike | Model) else models
    return [name for model in several if (name := by_name(model)) is not None]


@dataclass(frozen=True, eq=False, kw_only=True)
class CompareResult(Printed):
    """Models compared on the same rows. It prints as `summary()` and shows as a table in a notebook.

    Attributes:
        contest: entries, best first, with the row of Coulomb + viscous friction.
        simulated: errors of the simulated motion of each model, over windows of the held-out part.
        lines, warnings, document, fitted: as in Printed; the document is the content of compare.json.
    """

    contest: Contest
    simulated: SimulatedErrors | None = None

    @property
    def rmse(self) -> dict[str, dict[str, float]]:
        """Balance -> model -> held-out RMSE in `unit`, best first.

        The electrical balance contains only the models that describe it.
        """
        entries = self.contest.entries
        circuit = {entry.name: entry.circuit for entry in entries if entry.circuit is not None}
        errors = {"mechanical": {entry.name: entry.rmse for entry in entries}}
        return errors | ({"electrical": circuit} if circuit else {})

    @property
    def unit(self) -> str:
        """Unit of the errors: "N m", or that of the drive signal if the models identify its scale."""
        return self.contest.unit

    def table(self) -> ResultTable:
        """A row for each model: errors, R^2, number of parameters, gain and its 95 % interval in percent.

        The second error is that below the low pass of the angle, None where rows are averages; the third that
        of the electrical balance, None where the log has none. The gain is that of the first.
        """
        errors = ("rmse", "rmse_below", "rmse_circuit")
        names = ("model", *errors, "r_squared", "parameters", "percent", "lower", "upper")
        rows = (
            (e.name, e.rmse, e.below, e.circuit, e.r_squared, e.parameters, e.percent, *e.interval)
            for e in self.contest.entries
        )
        return ResultTable(names, tuple(rows))

    def _layout(self) -> tuple[tuple[int, int], tuple[float, float]]:
        return (1, 1), (8.0, 1.2 + 0.45 * len(self.contest.entries))

    def _draw(self, axes: list[Any]) -> None:
        """The held-out errors as bars, each with the 95 % interval that its gain gives."""
        found, (ax, *_) = self.contest, axes
        base = self.rmse["mechanical"][BASELINE]
        for place, e in enumerate(found.entries):
            color = _BASELINE_BAR if e.name == BASELINE else _BAR
            low, high = (base * (1.0 - percent / 100.0) for percent in reversed(e.interval))
            whisker = None if e.name == BASELINE else [[max(e.rmse - low, 0.0)], [max(high - e.rmse, 0.0)]]
            ax.barh(place, e.rmse, xerr=whisker, color=color, height=0.6, capsize=3.0)
        ax.axvline(found.noise_floor, color="black", linestyle=":", label="sensor noise")
        ax.set_yticks(range(len(found.entries)), [e.name for e in found.entries])
        ax.invert_yaxis()
        ax.set_xlim(left=0.0)
        ax.set_xlabel(f"held-out RMSE [{found.unit}], with the 95 % interval of the gain over {BASELINE}")
        ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False)

    def write(self, out: str | os.PathLike[str]) -> list[Path]:
        """Write compare.json and, with matplotlib, compare.png and compare.svg into a folder of their own.

        Raises:
            InputError: the folder cannot be written.
        """
        return self._write(out, "compare")

    def __repr__(self) -> str:
        best = self.contest.entries[0]
        return (
            f"<CompareResult: {best.name} first of {len(self.contest.entries)}, {best.rmse:.4g} {self.unit}>"
        )


# The motion of fitted models under the log's own input, against the measured one.


def simulate(
    logs: LogSources,
    rig: RigSource,
    models: ModelSource | Sequence[ModelSource] = (),
    effects: str | os.PathLike[str] | None = None,
    progress: Callable[[str], None] | None = None,
    *,
    reading: Callable[..., None] | None = None,
) -> SimulateResult:
    """Simulate fitted models with the input of a log, and compare their motion with the measured one.

    The models are fitted on the training part, as in `diagnose` and `compare`. The drive signal of the log
    (voltage, current or torque) moves them over windows of the held-out part, from the smoothed measured
    state, and over whole runs; whole runs are also simulated with the rig's controller, if it has one.

    Args:
        logs: one log or a list of them, as `fit` takes them.
        rig: what is known about the rig, as `fit` takes it.
        models: a model or several, as `compare` takes them; by default what `diagnose` finds: Coulomb +
            viscous friction ("linear"), the model of the rig's case ("paper"), and the extended one.
        effects: the path of a Python file with your own effects.
        progress: called with one line for each stage of a diagnosis.
        reading: called with the part that is done, 0 to 1, while long logs are read, and while simulating
            with a second argument "simulating".

    Raises:
        InputError: what `diagnose` and `compare` refuse; a constant of the controller has no value for a run.
    """
    named, own = _models(models), None if effects is None else given_path(effects, "effects")
    sources, rig = sources_of(logs), read_rig(rig)
    read = read_long(sources, rig, tell=reading)
    if named:
        compared = contest(read, rig, named, own)
        fits, warnings = compared.fits, compared.warnings
    else:
        found = diagnose_logs(read, rig, None, own, None, progress)
        every = found.models
        fits = {"linear": every.linear, "paper": every.paper, "extended": every.extended}
        warnings = found.warnings
    tell = None if reading is None else lambda part: reading(part, "simulating")
    errors = simulated_errors(fits, runs=True, tell=tell)
    if errors is None:
        raise InputError("rig", "the rig of a single drive", "a joint that others load")
    names, models_of = log_names(read), {name: fit.model.name for name, fit in fits.items()}
    return SimulateResult(
        errors=errors,
        unit=rig.axis.unit("rad"),
        lines=tuple(simulation_lines(errors, names, rig.axis)),
        warnings=(*warnings, *loss_warnings(fits)),
        document=simulation_document(errors, names, rig, models_of),
        fitted={name: fitted_model(fit, rig.axis) for name, fit in reversed([*fits.items()])},
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class SimulateResult(Printed):
    """Simulated and measured motion. It prints as `summary()` and shows as a table in a notebook.

    Attributes:
        errors: errors of each model, with a few parts of the motion for the figure.
        unit: of the errors: that of the motor angle.
        lines, warnings, document, fitted: as in Printed; the document is the content of simulation.json.
    """

    errors: SimulatedErrors
    unit: str

    def table(self) -> ResultTable:
        """A row for each model: its mean absolute error over each horizon and over whole runs.

        `runs` is the error over all runs driven by the logged signal; `controlled` and `controlled_held_out`
        are errors with the rig's controller, over all runs and over the held-out runs. None if there is no
        such error.
        """
        horizons = tuple(f"{horizon:g} s" for horizon in self.errors.horizons_s)
        names = ("model", *horizons, "runs", "controlled", "controlled_held_out")
        rows = (
            (
                m.name,
                *m.horizons,
                None if m.runs is None else m.runs.mean,
                None if m.controlled is None else m.controlled.mean,
                None if m.controlled is None else m.controlled.mean_held_out,
            )
            for m in self.errors.models
        )
        return ResultTable(names, tuple(rows))

    def _layout(self) -> tuple[tuple[int, int], tuple[float, float]]:
        return (max(len(self.errors.traces), 1), 1), (8.0, 1.0 + 1.9 * max(len(self.errors.traces), 1))

    def _draw(self, axes: list[Any]) -> None:
        """Measured and simulated angle over time, a few held-out parts of the log."""
        plot_simulation(self.errors, axes, self.unit)

    def write(self, out: str | os.PathLike[str]) -> list[Path]:
        """Write simulation.json and, with matplotlib, simulation.png and simulation.svg into a folder.

        Raises:
            InputError: the folder cannot be written.
        """
        return self._write(out, "simulation")

    def __repr__(self) -> str:
        return f"<SimulateResult: {', '.join(m.name for m in self.errors.models)}>"
