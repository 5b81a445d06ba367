"""`eccentric.adapt`: a log through the estimator of friction that `emit` adds; what `emit` is asked of it."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from eccentric.adaptation import CURRENT, Replay, replayed, require_logged
from eccentric.api.inputs import LogSources, ModelSource, RigSource, model_of, read_logs, sources_of
from eccentric.api.result import Printed
from eccentric.api.tables import ResultTable
from eccentric.core import InputError, given_path
from eccentric.emission import Adaptation, document_of, read_parameters, with_fitted
from eccentric.identification import Drive
from eccentric.identification import fit as fit_channels
from eccentric.logs import log_names
from eccentric.presentation import course_document, course_lines, fit_document, plot_course
from eccentric.rigs import read_rig
from eccentric.signals import Channels, read_channels


def adapt(
    log: LogSources,
    rig: RigSource,
    model: ModelSource | None = None,
    *,
    parameters: str | os.PathLike[str] | None = None,
    forgetting: float | None = None,
    false_alarms: float | None = None,
    settle: int | None = None,
) -> AdaptResult:
    """Replay a log through the estimator that `emit(..., adapt=True)` writes.

    Args:
        log: one log or a list of them, as `fit` takes them.
        rig: what is known about the rig, as `fit` takes it.
        model: a Model, its name, or the path of a derivation; by default that of the rig.
        parameters: the path of a fit.json to start from; by default a fit of this log.
        forgetting, false_alarms, settle: as `emit` takes them.

    Raises:
        InputError: whatever `fit` refuses; a log without current, or one that does not fit its rig; a model
            that the estimator does not support.
    """
    asked = asked_adaptation(True, forgetting, false_alarms, settle)
    sources, rig = sources_of(log), read_rig(rig)
    if rig.added:
        raise InputError(rig.path, problem="[added]: expected a log of one mass to follow its parameters")
    read = read_logs(sources)
    channels = read_channels(read, rig)
    base = model_of(channels.rig.model if model is None else model)
    names = ", ".join(log_names(read))
    require_logged(channels, [CURRENT], names)
    fitted = fit_channels(channels, channels.rig, base, names)
    document: Any = fit_document(fitted, log_names(read))
    warnings = tuple(document["warnings"])
    if parameters is not None:
        document = document_of(given_path(parameters, "parameters"))
    given = read_parameters(document)
    if not given.fits_the_rig:
        raise InputError(given.source, problem="expected parameters of a log that fits its rig to start from")
    start = with_fitted(base, given, base.name)
    driven = _with_current(fitted.problem.drive, given.values)
    course = replayed(driven, start, document, asked, names)
    return AdaptResult(
        course=course,
        lines=tuple(course_lines(course, names)),
        warnings=warnings,
        document=course_document(course, names),
    )


def _with_current(drive: Drive, values: Mapping[str, float]) -> Channels:
    """The channels; where a torque measures the drive, with the current that these parameters have for it.

    Raises:
        InputError: the parameters have no torque constant.
    """
    channels, motor = drive.channels, drive.channels.motor
    if motor.measured_by != "torque":
        return channels
    if missing := sorted(drive.machine.torque_letters - set(values)):
        raise InputError(
            f"parameters.{missing[0]}",
            "a value",
            "none",
            why=f"to follow a {channels.rig.axis.term('torque')}",
        )
    current = drive.machine.current_of_torque(values, motor.measured)
    return replace(channels, motor=replace(motor, current=current))


@dataclass(frozen=True, eq=False, kw_only=True)
class AdaptResult(Printed):
    """Friction coefficients along a log. It prints as `summary()` and shows as a table in a notebook.

    Attributes:
        course: the coefficients over time, as arrays.
        lines, warnings, document: as in Printed; the document is the content of adapt.json.
    """

    course: Replay

    def table(self) -> ResultTable:
        """A row for each coefficient: first and last value, standard error, seconds unobserved."""
        found = self.course
        cells = zip(
            found.names, found.start, found.values[-1], found.deviations[-1], found.unseen[-1], found.units,
            strict=True,
        )  # fmt: skip
        rows = ((name, *map(float, numbers), unit) for name, *numbers, unit in cells)
        return ResultTable(("coefficient", "start", "end", "std_error", "unseen_s", "unit"), tuple(rows))

    @property
    def parameters(self) -> dict[str, float]:
        """The coefficients at the end of the log, by name, in SI."""
        return dict(zip(self.course.names, map(float, self.course.values[-1]), strict=True))

    def _layout(self) -> tuple[tuple[int, int], tuple[float, float]]:
        return (len(self.course.names), 1), (9.0, 0.8 + 1.5 * len(self.course.names))

    def _draw(self, axes: list[Any]) -> None:
        """The coefficients over time, one below the other."""
        plot_course(self.course, axes)

    def write(self, out: str | os.PathLike[str]) -> list[Path]:
        """Write adapt.json and, with matplotlib, adapt.png and adapt.svg into a folder of their own.

        Raises:
            InputError: the folder cannot be written.
        """
        return self._write(out, "adapt")

    def __repr__(self) -> str:
        return f"<AdaptResult: {len(self.course.names)} coefficients, {len(self.course.alarms)} alarms>"


def asked_adaptation(
    adapted: bool, forgetting: float | None, false_alarms: float | None, settle: int | None
) -> Adaptation | None:
    """What is asked of the estimator, None if none is.

    Raises:
        InputError: one of them is out of range, or given without the estimator.
    """
    given: dict[str, Any] = {
        name: value
        for name, value in (("forgetting", forgetting), ("false_alarms", false_alarms), ("settle", settle))
        if value is not None
    }
    if not adapted:
        if given:
            raise InputError(next(iter(given)), problem="expected adapt with it")
        return None
    return Adaptation(**given)
