"""`eccentric.compare`: models on the same rows and the same split."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from eccentric.api.inputs import (
    LogSources,
    ModelSource,
    RigSource,
    by_name,
    given_path,
    sources_of,
)
from eccentric.api.result import Printed, fitted_model
from eccentric.api.tables import ResultTable
from eccentric.diagnosis import BASELINE, Contest, contest
from eccentric.model import Model
from eccentric.presentation import contest_document, contest_lines
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
            extended by effects, each a family or an id: "c2_parallel+stribeck[d=1]+cogging". A family stands
            for its member that suits the training part best.
        effects: the path of a Python file with effects of your own.
        reading: called with the part of the rows read, 0 to 1, while logs of more than 100,000 rows are read.

    Raises:
        InputError: bad input; a model twice; one with a tilt in a level plane, hidden states of its own, or
            an effect of the current from the start; an effect that is unknown or that the log does not show.
    """
    several = [models] if isinstance(models, str | os.PathLike | Model) else models
    own = None if effects is None else given_path(effects, "effects")
    named = [name for model in several if (name := by_name(model)) is not None]
    sources, rig = sources_of(logs), read_rig(rig)
    found = contest(read_long(sources, rig, tell=reading), rig, named, own)
    simulated = simulated_errors(found.fits)
    best = [entry.name for entry in found.entries]
    fitted = {name: fitted_model(found.fits[name], rig.axis) for name in best}
    found = replace(found, unit=rig.axis.unit(found.unit), fits={})
    return CompareResult(
        contest=found,
        simulated=simulated,
        lines=tuple(contest_lines(found, simulated, rig.axis.unit("rad"))),
        warnings=found.warnings,
        document=contest_document(found, simulated),
        fitted=fitted,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class CompareResult(Printed):
    """Models on the same rows. It prints as `summary()` and shows as a table in a notebook.

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

        The electrical balance has the models that say something about it.
        """
        entries = self.contest.entries
        circuit = {entry.name: entry.circuit for entry in entries if entry.circuit is not None}
        errors = {"mechanical": {entry.name: entry.rmse for entry in entries}}
        return errors | ({"electrical": circuit} if circuit else {})

    @property
    def unit(self) -> str:
        """Unit of the errors: "N m", or that of the drive where the models find its scale."""
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

    def _repr_html_(self) -> str:
        return self._html(self.table())
