"""`eccentric.simulate`: the motion of fitted models under the log's own input, against the measured one."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from eccentric.api.inputs import LogSources, ModelSource, RigSource, by_name, given_path, sources_of
from eccentric.api.result import Printed, fitted_model
from eccentric.api.tables import ResultTable
from eccentric.core import InputError
from eccentric.diagnosis import contest
from eccentric.diagnosis import diagnose as diagnose_logs
from eccentric.logs import log_names
from eccentric.model import Model
from eccentric.presentation import loss_warnings, plot_simulation, simulation_document, simulation_lines
from eccentric.rigs import read_rig
from eccentric.signals import read_long
from eccentric.simulation import SimulatedErrors, simulated_errors


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

    The models are fitted on the training part, as `diagnose` and `compare` do it. The drive signal of the log
    (voltage, current or torque) moves them over windows of the held-out part, from the smoothed measured
    state, and over whole runs; over these also the controller of the rig, if it has one.

    Args:
        logs: one log or a list of them, as `fit` takes them.
        rig: what is known about the rig, as `fit` takes it.
        models: a model or several, as `compare` takes them; by default what `diagnose` finds: Coulomb +
            viscous friction ("linear"), the model of the rig's case ("paper"), and the extended one.
        effects: the path of a Python file with effects of your own.
        progress: called with one line for each stage of a diagnosis.
        reading: called with the part that is done, 0 to 1, while long logs are read, and while simulating
            with a second argument "simulating".

    Raises:
        InputError: what `diagnose` and `compare` refuse; a constant of the controller has no value for a run.
    """
    several = [models] if isinstance(models, str | os.PathLike | Model) else models
    named = [name for model in several if (name := by_name(model)) is not None]
    own = None if effects is None else given_path(effects, "effects")
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
        warnings=(*warnings, *loss_warnings({name: (f.model, f.values) for name, f in fits.items()})),
        document=simulation_document(errors, names, rig, models_of),
        fitted={name: fitted_model(fit, rig.axis) for name, fit in reversed([*fits.items()])},
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class SimulateResult(Printed):
    """Simulated against measured motion. It prints as `summary()` and shows as a table in a notebook.

    Attributes:
        errors: of each model, with a few parts of the motion for a figure.
        unit: of the errors: that of the motor angle.
        lines, warnings, document, fitted: as in Printed; the document is the content of simulation.json.
    """

    errors: SimulatedErrors
    unit: str

    def table(self) -> ResultTable:
        """A row for each model: its mean absolute error over each horizon and over whole runs.

        `runs` is that over all runs driven by the logged signal; `controlled` and `controlled_held_out` are
        with the controller of the rig, over all runs and over those held out. None where there is none.
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

    def _repr_html_(self) -> str:
        return self._html(self.table())
