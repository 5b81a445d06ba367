"""What results have in common: members, a fitted model with its estimates, and words."""

from __future__ import annotations

import dataclasses
import json
import os
import warnings
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eccentric.api.inputs import LogSources, RigSource, read_logs
from eccentric.api.tables import Correlation, LabelledMatrix, ResultTable
from eccentric.core import InputError, whole_folder
from eccentric.emission import (
    BACKENDS,
    DEFAULT,
    WHOLE,
    Adaptation,
    Choice,
    LevelCut,
    checked_name,
    complete,
    cut_levels,
    gain_of,
    gravity_apart,
    load_module,
    prior_of,
    render_adapt,
    render_compensation,
    require_solvable,
    write,
)
from eccentric.identification import Estimate, Fit, Refit
from eccentric.model import AxisKind, Model
from eccentric.presentation import NEEDS_MATPLOTLIB, emitted_parameters
from eccentric.rigs import read_rig
from eccentric.signals import Channels, read_channels
from eccentric.simulation import Draws, FittedDrive, Predicted, fitted_drive

if TYPE_CHECKING:
    from matplotlib.axes import Axes


# The emitted files of a model, written atomically.


def write_emitted(
    model: Model,
    origin: str,
    out: str | os.PathLike[str],
    backend: str | Sequence[str] | None = None,
    *,
    single_file: bool = False,
    choice: Choice = WHOLE,
    adapt: Adaptation | None = None,
    compensation: bool = False,
    fit: Mapping[str, Any] | None = None,
) -> list[Path]:
    """Write the files of a model for its targets, and those that check the C, into a folder of their own.

    Files that the same model wrote there before are replaced, all others stay. `origin` is the source of the
    physics, for the banner; `backend` is a target or several, NumPy and C99 by default. With `single_file`
    the NumPy module contains its runtime; `choice` is what of the model is emitted. With `adapt` an
    estimator of the friction is added, whose prior is that of the fit with this content; with `compensation`
    its compensation in a loop, whose gain follows from the fit. Returns the paths.
    A caution of the model is a UserWarning, and so is cogging or a spring beside a compensation.
    Raises InputError if there is no such target, or the folder cannot be written.
    """
    names = _backends(backend)
    files = complete(model, "eccentric emit", origin, names, single_file=single_file, choice=choice)
    own = dict(files)
    for key, wanted in (("adapt", adapt is not None), ("compensation", compensation)):
        if wanted and (missing := [name for name in DEFAULT if name not in names]):
            raise InputError(key, problem=f"expected backend {' and '.join(missing)} as well")
    if adapt is not None:
        files |= render_adapt(model, own, prior_of(model, fit), adapt)
    if compensation:
        files |= render_compensation(model, own, gain_of(model, fit))
    with whole_folder(out, f"emit {model.name}") as folder:
        write(files, folder)
    for text in (*model.cautions, *(_left_out(model) if compensation else ())):
        warnings.warn(f"{model.name}: {text}", stacklevel=3)
    return [Path(out) / name for name in files]


def _left_out(model: Model) -> tuple[str, ...]:
    """What a compensation of the friction does not contain; nothing if it is the pendulum's gravity alone."""
    from eccentric.presentation import left_out_sentence  # with it all of `diagnosis` is imported

    whole, other = gravity_apart(model)
    return () if other <= 1e-9 * whole else (left_out_sentence(model, whole, other),)


def _backends(backend: str | Sequence[str] | None) -> dict[str, None]:
    several = isinstance(backend, Sequence) and not isinstance(backend, str | bytes)
    given = DEFAULT if backend is None else list(backend if several else [backend])
    names: dict[str, None] = {}
    for name in given or ["none"]:
        if not isinstance(name, str) or name not in BACKENDS:
            raise InputError("backend", f"one of {', '.join(BACKENDS)}", f"{name!r}")
        names[name] = None
    return names


def require_fit(fits_the_rig: bool, source: str, accept_misfit: bool) -> None:
    """Raise InputError for parameters of a log that does not fit its rig, unless they are accepted."""
    if not fits_the_rig and not accept_misfit:
        raise InputError(
            "accept_misfit", problem=f"needed to use {source}, since its log does not fit the rig"
        )


def speeds_of(fit: Mapping[str, Any] | None) -> tuple[float, ...]:
    """The lowest and highest motor speed [rad/s] of the content of a result; nothing without them."""
    ranges = (fit or {}).get("ranges")
    given = ranges if isinstance(ranges, Mapping) else {}
    speeds = given.get("speed_m_rad_s", given.get("speed_m_s"))  # of a turning or a sliding axis
    return tuple(map(float, speeds)) if isinstance(speeds, list | tuple) and len(speeds) == 2 else ()


def cut_levels_of(model: Model, fit: Mapping[str, Any], channels: Channels) -> tuple[LevelCut, ...]:
    """Where levels of dry friction of a fitted model are cut at 0, at the speeds of its log."""
    warm, theta_m = fit["ranges"]["temperature_C"], channels.motion.theta_m
    travel = (0.0, 0.0) if theta_m is None else (float(np.nanmin(theta_m)), float(np.nanmax(theta_m)))
    return cut_levels(model, speeds_of(fit), travel, warm and sum(warm) / 2.0)


# What every result offers.


@dataclass(frozen=True, eq=False)
class FittedModel:
    """A fitted model inside a result: values, the covariance of its estimates, and the drive that predicts.

    Attributes:
        parameters: by the paper's letters, in SI; those that are neither known nor identified are left out.
        covariance: of the errors of the estimates, by name, in products of their units.
        drive: predicts a log; None for one joint of an arm, which the others load.
    """

    parameters: Mapping[str, float]
    covariance: LabelledMatrix
    drive: FittedDrive | None


def fitted_model(
    found: Fit | Refit, axis: AxisKind, parameters: Mapping[str, float] | None = None
) -> FittedModel:
    """The fitted model of a fit; `parameters` are those that a `Fit` is emitted with."""
    if isinstance(found, Refit):
        values, names, covariance = found.values, found.estimates, found.covariance
    else:
        values, covariance = parameters or {}, found.spread.matrix
        names = (*found.coefficients, *found.searched)
    placeholders = placeholders_of(found)
    return FittedModel(
        {axis.named(name): float(x) for name, x in values.items() if name not in placeholders},
        LabelledMatrix([axis.named(name) for name in names], covariance),
        fitted_drive(found, parameters),
    )


def placeholders_of(found: Fit | Refit) -> set[str]:
    """Letters neither known nor identified: the emitted code has values for them that mean nothing."""
    if isinstance(found, Refit):
        return found.data.drive.placeholders - set(found.estimates)
    return emitted_parameters(found)[2]


class ResultBase:
    """The members of every result, whether of a fit, a draft or a fleet.

    `summary()` and `str` are the text of a terminal, `table()` a small table, `plot(ax)` a figure. A result
    with fitted models also has their `parameters`, `covariance`, `correlation`, `predict` and `residual`;
    where nothing is fitted, these are empty, and `predict` and `residual` raise InputError.
    """

    def summary(self) -> str:
        """The result as lines of text."""
        raise NotImplementedError

    def table(self) -> ResultTable:
        """The result as a table; NaN where there is no number."""
        raise NotImplementedError

    def _models(self) -> Mapping[str, FittedModel]:
        """The fitted models by name, the result's own first."""
        return {}

    def _model(self, name: str | None) -> FittedModel:
        models = self._models()
        if not models:
            raise InputError(type(self).__name__, "the result of a fit or a diagnosis", "one without a model")
        if name is not None and name not in models:
            raise InputError("model", f"one of {', '.join(models)}", f"{name!r}")
        return models[next(iter(models)) if name is None else name]

    @property
    def parameters(self) -> dict[str, Any]:
        """The parameters of the fitted model by the paper's letters, in SI; empty without one.

        A letter that is neither known nor identified is not among them; the emitted code has a placeholder
        for it, such as R = 1 ohm after a fit by the current: `module.Parameters()` has those too.
        """
        return dict(self._model(None).parameters) if self._models() else {}

    @property
    def covariance(self) -> LabelledMatrix:
        """Covariance (n, n) of the errors of the n estimates, by name; 0 for one that is at a bound.

        In products of the units of `table()`.
        """
        return self._model(None).covariance if self._models() else LabelledMatrix((), np.empty((0, 0)))

    @property
    def correlation(self) -> Correlation:
        """Correlation (n, n) of the errors of the n estimates, by name; NaN for one that is at a bound."""
        return Correlation.of(self.covariance.names, self.covariance.matrix)

    def prediction(
        self, logs: LogSources, rig: RigSource | None = None, model: str | None = None
    ) -> ResultTable:
        """The drive of logs as the fitted model predicts it, by row of the log or average of rows.

        Args:
            logs: one log or a list of them, as `fit` takes them: of the fit, or others of the same rig.
            rig: of these logs, as `fit` takes it; by default that of the fit.
            model: name of a model of the result, where it has several; by default its own, the first of
                `fitted`.

        Returns:
            Columns (m,): `time` [s]; `measured`, `predicted` and `residual`, their difference, in the unit of
            the result's errors: the drive torque, of a coast-down that which decelerates it; `held_out`,
            whether the row is in the held-out part; `used`, whether it is fitted or held out. Other rows,
            at standstill or next to a reversal, a gap or an end of the log, are in no error of the result.

        Raises:
            InputError: nothing was fitted; a log cannot be read, or lacks a signal that the model takes.
        """
        found = self._predicted(logs, rig, model)
        columns = {
            "time": found.t,
            "measured": found.measured,
            "predicted": found.predicted,
            "residual": found.residual,
            "held_out": found.held_out,
            "used": found.used,
        }
        rows = zip(*(column.tolist() for column in columns.values()), strict=True)
        return ResultTable(tuple(columns), tuple(rows))

    def predict(self, logs: LogSources, rig: Any = None, model: str | None = None) -> Any:
        """The predicted drive (m,) of logs: the column of `prediction`, with its arguments and errors."""
        return self._predicted(logs, rig, model).predicted

    def residual(self, logs: LogSources, rig: Any = None, model: str | None = None) -> Any:
        """Measured minus predicted drive (m,): the column of `prediction`, with its arguments and errors."""
        return self._predicted(logs, rig, model).residual

    def _predicted(self, logs: LogSources, rig: RigSource | None, model: str | None) -> Predicted:
        drive = self._model(model).drive
        if drive is None:
            raise InputError("model", "a drive by itself", "a joint of an arm", why="to predict a log")
        return drive.along(read_channels(read_logs(logs), drive.rig if rig is None else read_rig(rig)))

    def plot(self, ax: Axes | Sequence[Axes] | None = None) -> Any:
        """Draw the result; return the axes, one or an array of them.

        Args:
            ax: where to draw: one Axes, for the first panel, or several, one for each; by default those of a
                new figure.

        Raises:
            InputError: matplotlib is not installed, or the result has no figure.
        """
        grid, size = self._layout()
        if not all(grid):
            raise InputError(type(self).__name__, "a result with a figure", "one without: see table()")
        axes = new_axes(*grid, size) if ax is None else list(np.atleast_1d(np.array(ax, dtype=object)).flat)
        self._draw(axes)
        return axes[0] if len(axes) == 1 else np.array(axes, dtype=object)

    def _layout(self) -> tuple[tuple[int, int], tuple[float, float]]:
        """Rows and columns of the axes of the whole figure, 0 without one, and its size [inch]."""
        return (0, 0), (0.0, 0.0)

    def _draw(self, axes: list[Any]) -> None:
        """Draw as many panels as there are axes."""
        raise NotImplementedError

    def __str__(self) -> str:
        return self.summary()

    def _repr_html_(self) -> str:
        return f"<div>{paragraphs(self.summary())}{self.table()._repr_html_()}</div>"


@dataclass(frozen=True, eq=False, kw_only=True)
class Printed(ResultBase):
    """A result of logs: it prints as its summary and is a JSON document.

    Attributes:
        lines: the summary, line by line.
        warnings: what is unusual about logs, rig or fit.
        document: the content of the JSON file that the command of this result writes.
        fitted: the fitted models by name, the result's own first; empty where nothing is fitted.
    """

    lines: tuple[str, ...]
    warnings: tuple[str, ...]
    document: Mapping[str, Any]
    fitted: Mapping[str, FittedModel] = field(default_factory=dict)

    def summary(self) -> str:
        """What the command prints."""
        return "\n".join(self.lines)

    def to_json(self) -> str:
        """The text of the JSON file, strict: no NaN, no infinity."""
        return json.dumps(self.document, indent=1, ensure_ascii=False, allow_nan=False) + "\n"

    def to_dict(self) -> dict[str, Any]:
        """The content of the JSON file as a reader receives it: numbers, strings, lists and dictionaries."""
        return json.loads(self.to_json())

    def _models(self) -> Mapping[str, FittedModel]:
        return self.fitted

    def _repr_html_(self) -> str:
        return self._html(self.table())

    def _html(self, table: ResultTable, *, before: str = "", after: str = "") -> str:
        """The table between two paragraphs, and the warnings, for a notebook."""
        texts = (after, *(f"Warning: {text}" for text in self.warnings))
        return f"<div>{paragraphs(before)}{table._repr_html_()}{paragraphs(*texts)}</div>"

    def _write(
        self, out: str | os.PathLike[str], command: str, further: Mapping[str, str] | None = None
    ) -> list[Path]:
        """Write COMMAND.json and, with matplotlib, COMMAND.png and COMMAND.svg into a folder of their own.

        further: texts of other files, by name.
        """
        texts = {f"{command}.json": self.to_json(), **(further or {})}
        with whole_folder(out, command) as folder:
            for name, text in texts.items():
                (folder / name).write_text(text, encoding="utf-8")
            names = list(texts)
            # Without matplotlib, the figures are left out.
            with suppress(ImportError):
                from matplotlib import rc_context
                from matplotlib.backends.backend_agg import FigureCanvasAgg
                from matplotlib.backends.backend_svg import FigureCanvasSVG
                from matplotlib.figure import Figure

                # A fixed salt and no date: the same result gives the same file.
                with rc_context({"svg.hashsalt": "eccentric", "font.size": 9.0}):
                    (rows, columns), size = self._layout()
                    figure = Figure(figsize=size, dpi=150, layout="constrained")
                    self._draw(list(figure.subplots(rows, columns, sharex=rows > 1, squeeze=False).flat))
                    # `savefig` would draw each file twice, the first time for the layout alone.
                    FigureCanvasAgg(figure).print_png(folder / f"{command}.png")
                    figure.set_layout_engine("none")  # the layout is that of the first file
                    FigureCanvasSVG(figure).print_svg(folder / f"{command}.svg", metadata={"Date": None})
                names += [f"{command}.png", f"{command}.svg"]
        return [Path(out) / name for name in names]


@dataclass(frozen=True, eq=False, kw_only=True)
class Result(Printed):
    """A fitted model and what is said of it.

    Attributes:
        model: the fitted model, its defaults being the fitted values: a Model to extend, to emit, or to
            `eccentric.compile`.
        origin: where its physics is from, for the banner of emitted files.
        estimates: name -> Estimate (value, std_error, interval, unit), of all that was fitted: coefficients,
            parameters that do not enter linearly, and what the rig left open, such as a zero angle.
        draws: the joint uncertainty of the parameters, which `samples` draws from.
        lines, warnings, document, fitted: as in Printed.
    """

    model: Model
    origin: str
    estimates: Mapping[str, Estimate]
    draws: Draws

    def samples(self, n: int, seed: int = 0) -> dict[str, NDArray[np.float64]]:
        """Parameter sets drawn from the joint uncertainty of the fit, for domain randomisation.

        Errors are normal and correlated as those of the estimates; 95 % of the draws of an estimate lie in
        its 95 % interval, more where bounds cut them off. One that is at a bound goes from it in one
        direction, by itself. What was not fitted has its value in every set.

        Args:
            n: number of sets, at least 1.
            seed: of the random numbers; the same seed gives the same sets.

        Returns:
            The parameters by name: (n,) in SI units, as the emitted Parameters take them. As in `parameters`,
            those that are neither known nor identified are left out.

        Raises:
            InputError: n is no whole number of at least 1.
        """
        if isinstance(n, bool) or not isinstance(n, int | np.integer) or n < 1:
            raise InputError("n", "a whole number of at least 1", f"{n!r}")
        return {self.model.axis.named(name): x for name, x in self.draws.samples(int(n), seed).items()}

    @property
    def module(self) -> ModuleType:
        """The model as a NumPy module, the one that `emit` writes."""
        return load_module(self.model)

    @property
    def fits_the_rig(self) -> bool:
        """Whether the log can be from this rig, in these units; if not, nothing follows from the result."""
        return self.document["fits_the_rig"]

    def emit(
        self,
        out: str | os.PathLike[str],
        prefix: str | None = None,
        backend: str | Sequence[str] | None = None,
        *,
        accept_misfit: bool = False,
        compensation: bool = False,
    ) -> list[Path]:
        """Write the model for its targets into a folder; return the paths.

        `eccentric.emit` has further options, and takes the result of a fit as its parameters.

        Args:
            out: the output folder: new, empty, or written by eccentric.
            prefix: name of the files and prefix of the C functions; by default the model's name.
            backend: a target or several, by the names that `eccentric emit --help` lists.
            accept_misfit: emit although the log does not fit the rig.
            compensation: add a compensation of the friction for a loop, NAME_compensation.h, .c and .py; its
                gain follows from a fit, and is 0.9 for a diagnosis.

        Raises:
            InputError: the log does not fit the rig, the prefix is no name that C and Python leave free,
                there is no such target, the folder cannot be written, or friction follows the acceleration by
                more than the inertia, so that `friction_step` would have no single solution.
        """
        require_fit(self.fits_the_rig, "this result", accept_misfit)
        name = self.model.name if prefix is None else checked_name(prefix, "prefix")
        of_a_fit = self.document if str(self.document["format"]).startswith("eccentric-fit/") else None
        model = dataclasses.replace(self.model, name=name)
        require_solvable(model, *speeds_of(self.document)[1:])
        return write_emitted(model, self.origin, out, backend, compensation=compensation, fit=of_a_fit)


def new_axes(rows: int, columns: int, size: tuple[float, float]) -> list[Axes]:
    """Axes of a new figure, row by row; InputError if matplotlib is not installed."""
    try:
        from matplotlib import pyplot as plt
    except ImportError:
        raise InputError(NEEDS_MATPLOTLIB) from None
    _, axes = plt.subplots(rows, columns, sharex=rows > 1, squeeze=False, figsize=size, layout="constrained")
    return list(axes.flat)


def paragraphs(*texts: str) -> str:
    """The texts as HTML paragraphs, escaped; an empty one is none."""
    return "".join(f"<p>{escape(text)}</p>" for text in texts if text)
