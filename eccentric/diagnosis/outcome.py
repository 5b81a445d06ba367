"""What a diagnosis found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from eccentric.diagnosis.base_script import BASE
from eccentric.diagnosis.models import Closest, Models, Sibling
from eccentric.diagnosis.score import Order, Score
from eccentric.diagnosis.search import Adopted, Attribution
from eccentric.diagnosis.stage import SearchRequest
from eccentric.effects import Effect, Setting
from eccentric.identification import FitData
from eccentric.model import Model
from eccentric.rigs import Rig
from eccentric.signals import Band, Channels, Rows

Added = tuple[Effect, dict[str, float]]
"""An effect of the extended model, with the values of its parameters."""


@dataclass(frozen=True)
class Asked:
    """The inputs of a diagnosis.

    Attributes:
        logs, rig: their names.
        base: the base model: its name, the path of its derivation, or the model itself if it was given as an
            object or has effects from the start.
        effects: file of the user's own effects.
        request: effects that the model has from the start, and what the search may offer.
    """

    logs: tuple[str, ...]
    rig: str
    base: str | Model
    effects: Path | None
    request: SearchRequest

    @property
    def model(self) -> str:
        """Name or script of the base model."""
        return self.base if isinstance(self.base, str) else BASE


@dataclass(frozen=True)
class Diagnosis:
    """What a diagnosis found.

    Attributes:
        asked: logs, rig, model and effects, by name.
        data: drive, signals and rows that the models were fitted on.
        setting: what the library of effects was built for.
        offered: the effects that the search chose from.
        attribution: verdict, candidates, dependence.
        models: what was fitted.
        score: held-out errors and the improvement.
        differing: warnings of runs unlike the others.
        refused: score of the effects that the held-out part did not confirm, if any had been adopted.
        closest: the best effect and its gain, where none is adopted.
        sibling: a shipped model of the same case that predicts better as it stands.
        noise_floor: RMS of the sensors' noise in the mechanical balance, in its unit.
        band: where the held-out error of the shipped model lies; None where rows are averages.
        orders: periods of the residual of the shipped model while the motor turns one way.
    """

    asked: Asked
    data: FitData
    setting: Setting
    offered: tuple[Effect, ...]
    attribution: Attribution
    models: Models
    score: Score
    refused: Score | None
    closest: Closest | None
    sibling: Sibling | None
    differing: tuple[str, ...]
    noise_floor: float
    band: Band | None
    orders: tuple[Order, ...]

    @property
    def effects(self) -> tuple[Added, ...]:
        """Named effects with the values of their parameters, in order of adoption; empty if none is named."""
        return self._adopted("named", lambda own: not own.undecided)

    @property
    def undecided(self) -> tuple[Added, ...]:
        """Beside named effects: wrong declared values that an effect may explain as well."""
        return self._adopted("named", lambda own: own.undecided)

    @property
    def clear(self) -> tuple[Added, ...]:
        """Beside a tie, the effects that nothing else explains; empty for any other verdict."""
        return self._adopted("not_identifiable", lambda own: not own.alike)

    def _adopted(self, verdict: str, holds: Callable[[Adopted], bool]) -> tuple[Added, ...]:
        """The effects of the extended model that this holds for; empty for another verdict."""
        a = self.attribution
        if a.verdict != verdict:
            return ()
        found = ((pair, a.adopted_as(pair[0].id)) for pair in self.models.extended.effects)
        return tuple(pair for pair, own in found if own is not None and holds(own))

    @property
    def channels(self) -> Channels:
        """The signals, with what the first fit has found of their alignment."""
        return self.data.drive.channels

    @property
    def rig(self) -> Rig:
        """The rig, completed with what suits the log where the file is silent."""
        return self.channels.rig

    @property
    def rows(self) -> Rows:
        """The rows that errors are reported on."""
        return self.data.rows

    @property
    def unit(self) -> str:
        """Unit of torques: "N m", or that of the drive where the scale is not identifiable."""
        return self.data.drive.unit

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of the reader, of the first fit, and of fits that have not converged."""
        said = (*self.channels.intake.warnings, *self.data.drive.warnings, *self.differing)
        if self.band is not None and self.band.filtered:
            said = (*said, self.band.warning)
        names = self.models.unsettled
        if not names:
            return said
        models = f"model{'s' * (len(names) > 1)} {', '.join(names)}"
        return (*said, f"the fit of the {models} has not converged: its values and errors are not final")
