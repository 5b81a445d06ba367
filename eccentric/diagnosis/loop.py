"""Close the loop: fit the paper's model, attribute the residual, extend the model, measure the error again.

The stages, each with its result:

    stage       drive, signals, balances as linear designs, effects on offer     (`stage.stage_of`)
    attribute   verdict and adopted effects                                      (`verdict.attribute`)
    again       the same at the zero angle that was found beside effects, where it is open, then with
                the friction that was found beside effects which use it
    extend      Model', its coefficients fitted on its own emitted module        (`models.fitted_models`)
    score       held-out RMSE before and after; the held-out part is opened there and nowhere else
                (the zero-phase low pass carries some 20 ms across its borders)
    closest     the best effect whose fit settles, where none is adopted         (`models.closest_effect`)
    sibling     a shipped model that predicts better as it stands                (`models.better_sibling`)
    orders      what is left inside runs and periodic in the angle               (`score.orders_of`)
    empirical   a term without a cause beside them, where it was asked for       (`empirical.fit_empirical`)
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.core import InputError
from eccentric.diagnosis.empirical import Empirical, fit_empirical
from eccentric.diagnosis.limits import LEAST_ZERO_RAD
from eccentric.diagnosis.models import (
    Closest,
    Models,
    RangeCheck,
    Sibling,
    better_sibling,
    closest_effect,
    fitted_models,
    range_checks,
)
from eccentric.diagnosis.score import Order, Score, orders_of
from eccentric.diagnosis.search import (
    AT_FLOOR,
    CONFIRMED,
    LEAST_DEVIANCE,
    Adopted,
    Attribution,
    attribute,
    variables_of,
)
from eccentric.diagnosis.stage import SearchRequest, Stage, stage_of, staged
from eccentric.effects import Effect, Setting
from eccentric.identification import (
    FitData,
    Refit,
    drive_noise,
    fit_data_of,
    no_friction,
    residual_samples,
)
from eccentric.logs import LogSource, log_names
from eccentric.model import Model, load_model
from eccentric.rigs import Rig, read_rig
from eccentric.signals import Band, Channels, Rows, read_channels, read_long

BASE = "base.py"
"""Name of the script beside model.py that has the base model, where it was given as an object."""


Added = tuple[Effect, dict[str, float]]
"""An effect of the extended model, with the values of its parameters."""


@dataclass(frozen=True)
class Asked:
    """The inputs of a diagnosis."""

    logs: tuple[str, ...]  # their names
    rig: str  # its name
    # the base model: its name, the path of its derivation, or the model itself if it was given as an
    # object or has effects from the start
    base: str | Model
    effects: Path | None  # file of the user's own effects
    request: SearchRequest  # effects that the model has from the start, and what the search may offer

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
        ranges: figures of the effects of the extended model beside what is known of them from elsewhere.
        empirical: a term without a cause beside what was found, where it was asked for and the training part
            has one; the verdict knows nothing of it.
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
    ranges: tuple[RangeCheck, ...]
    empirical: Empirical | None = None

    @property
    def result(self) -> Refit:
        """The model that is emitted: the extended one, with the term without a cause if it is confirmed."""
        own = self.empirical
        return own.fitted if own is not None and own.confirmed else self.models.extended

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
        paper = self.models.paper
        friction = {q.name for q in paper.model.friction_parameters} & set(paper.estimates)
        if friction and all(paper.estimates[name].bound_active == "lower" for name in friction):
            said = tuple(dict.fromkeys((*said, *no_friction(self.channels, self.rig.axis))))
        if self.band is not None and self.band.filtered:
            said = (*said, self.band.warning)
        names = self.models.unsettled
        if not names:
            return said
        models = f"model{'s' * (len(names) > 1)} {', '.join(names)}"
        return (*said, f"the fit of the {models} has not converged: its values and errors are not final")


def diagnose(
    logs: Sequence[LogSource],
    rig: str | os.PathLike[str] | Mapping[str, Any] | Rig,
    model: str | Model | None = None,
    effects: Path | None = None,
    request: SearchRequest | None = None,
    tell: Callable[[str], None] | None = None,
) -> Diagnosis:
    """Diagnose one rig's logs.

    Args:
        logs: those of one rig, as `read_log` accepts them.
        rig: the rig, as `read_rig` accepts it.
        model: the base model, its name or the path of its derivation; by the rig's case if None.
        effects: a file with the user's own effects.
        request: which effects the model has from the start, and which the search may offer.
        tell: called with one line per stage.

    Raises:
        InputError: bad input; a model with a tilt in a level plane, with hidden states or with what is found
            from the current, or such an effect to begin with; or fewer than two rows to hold out.
    """
    tell, request = tell or (lambda _: None), request or SearchRequest()
    channels, given, plain, names = _read(logs, rig, model)
    tell(f"{channels.counts['used']} rows used of {channels.intake.read}")
    stage = stage_of(channels, plain, effects, ", ".join(names))
    if request.including:
        given = stage.plain
        for effect, shapes, coefficients in stage.chosen("including", request.including):
            # What enters linearly is fitted with the rest, if it is friction.
            given = effect.extend(given, shapes | coefficients)
        tell(f"with {', '.join(request.including)} from the start")
        try:
            stage = stage_of(channels, given, effects, ", ".join(names))
        except InputError as error:
            raise error.within(f"including {', '.join(request.including)}") from None
    return diagnosed(stage, Asked(names, Path(channels.rig.path).name, given, effects, request), tell)


def staged_log(
    logs: Sequence[LogSource],
    rig: str | os.PathLike[str] | Mapping[str, Any] | Rig,
    model: str | Model | None = None,
) -> tuple[Stage, tuple[str, ...]]:
    """The stage of one rig's logs, before any search, and their names; arguments and errors as `diagnose`."""
    channels, _, plain, names = _read(logs, rig, model)
    return stage_of(channels, plain, None, ", ".join(names)), names


def _read(
    logs: Sequence[LogSource],
    rig: str | os.PathLike[str] | Mapping[str, Any] | Rig,
    model: str | Model | None,
) -> tuple[Channels, str | Model, Model, tuple[str, ...]]:
    """The signals, the model as it was given or by the rig, the same loaded, and the names of the logs."""
    rig = read_rig(rig)
    read = read_long(logs, rig)
    channels = read_channels(read, rig)
    given = channels.rig.model if model is None else model
    plain = given if isinstance(given, Model) else load_model(given)
    return channels, given, plain, log_names(read)


def diagnosed(
    stage: Stage, asked: Asked, tell: Callable[[str], None], required: float = LEAST_DEVIANCE
) -> Diagnosis:
    """Search what a base model lacks on a log, extend it, and score it.

    Args:
        stage: the log with the base model.
        asked: the inputs, by name.
        tell: called with one line per stage.
        required: deviance that an effect must gain.

    Raises:
        InputError: an effect that was asked for is unknown.
    """
    found = _searched(stage, asked, tell, required)
    for what, improved in (("zero angle", _with_zero_angle_of), ("friction", _with_friction_of)):
        again = improved(found, stage, asked)
        if again is None:
            continue
        tell(f"the same with the {what} that was found")
        for search in found.searches.values():
            search.release()
        second = _searched(again, asked, tell, required)
        before, after = (one.searches["mechanical"] for one in (found, second))
        # With the better one, unless that fits clearly worse.
        if before.deviance(after.best, before.best) < CONFIRMED:
            stage, found = again, second
    base, data = stage.base, stage.data
    chosen = asked.request.restricted(stage.offered)
    found, models, score, refused = fitted_models(found, chosen, base, data, tell)
    empirical = None
    if asked.request.empirical and models.fits_the_rig:
        tell("a term without a cause")
        empirical = fit_empirical(models.extended, data, stage.setting)
    return Diagnosis(
        asked=asked,
        data=data,
        setting=stage.setting,
        offered=chosen,
        attribution=found,
        models=models,
        score=score,
        refused=refused,
        closest=closest_effect(found, chosen, models),
        differing=stage.differing,
        sibling=better_sibling(stage.plain, models),
        noise_floor=drive_noise(data),
        band=models.extended.band,
        orders=orders_of(data, residual_samples(models.extended)),
        ranges=range_checks(models.extended, data.drive.channels.rig.parts, data.drive.unit),
        empirical=empirical,
    )


def _searched(stage: Stage, asked: Asked, tell: Callable[[str], None], required: float) -> Attribution:
    channels = stage.data.drive.channels
    return attribute(
        stage.balances,
        stage.candidates(asked.request.restricted(stage.offered)),
        variables_of(stage.data, stage.instruments),
        stage.noise,
        len(np.unique(channels.time.run[channels.selection.fit_rows])),
        tell,
        required,
    )


def _with_zero_angle_of(found: Attribution, stage: Stage, asked: Asked) -> Stage | None:
    """The stage at the zero angle that was found beside effects, where the rig leaves it open.

    The first fit had to take for gravity what an effect is. A search moves the zero to first order, in the
    gravity torque alone: the friction under F_N stays where it was, and looks like friction over the link's
    angle. None where nothing was found, or where it hardly moves.
    """
    search, drive = found.searches["mechanical"], stage.data.drive
    roles = [c.role for c in search.screen.balance.coefficients]
    if "zero_angle" not in roles or not any(own.best.variants for own in found.searches.values()):
        return None
    moved = float(search.best.coefficients[roles.index("zero_angle")])
    if abs(moved) < LEAST_ZERO_RAD:
        return None
    rig = drive.channels.rig
    aligned = drive.aligned(rig, {"theta_zero_rad": drive.channels.alignment.theta_zero_rad + moved})
    data = fit_data_of(aligned, rig, stage.base)
    return staged(stage.plain, stage.base, data, asked.effects, ", ".join(asked.logs))


def _with_friction_of(found: Attribution, stage: Stage, asked: Asked) -> Stage | None:
    """The stage with the friction that was found beside effects which use that of the first fit.

    Without the effects the first fit has it wrong, and what they leave then looks like a further one. None
    where they leave no more than noise, or use none.
    """
    search = found.searches["mechanical"]
    best, screen = search.best, search.screen
    if not best.variants or best.score < AT_FLOOR * screen.floor:
        return None
    again = stage.with_friction(best.coefficients, asked.effects)
    before, after = ({effect.id: effect for effect in one.offered} for one in (stage, again))
    adopted = {variant.candidate.id for variant in best.variants}
    return None if all(before.get(name) == after.get(name) for name in adopted) else again
