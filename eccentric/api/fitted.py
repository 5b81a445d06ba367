"""`eccentric.fit`: a model fitted to logs, the result, and the same as an estimator of scikit-learn."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eccentric.api.inputs import LogSources, ModelSource, RigSource, model_of, origin_of, sources_of
from eccentric.api.result import Result, cut_levels_of, fitted_model, placeholders_of
from eccentric.api.tables import ResultTable, estimate_table
from eccentric.core import InputError
from eccentric.emission import read_parameters, with_fitted
from eccentric.identification import Estimate, r_squared
from eccentric.identification import fit as fit_channels
from eccentric.logs import log_names, read_log
from eccentric.model import Model
from eccentric.presentation import (
    Comparison,
    compare,
    cut_sentences,
    cuts_document,
    fit_document,
    fit_lines,
    plot_fit,
)
from eccentric.rigs import read_rig
from eccentric.signals import FIT_POINTS, read_channels, read_long
from eccentric.simulation import draws_of_fit, refine


def fit(
    logs: LogSources,
    rig: RigSource,
    model: ModelSource | None = None,
    *,
    simulated: bool = False,
    reading: Callable[..., None] | None = None,
) -> FitResult:
    """Fit a friction model to logs of a rig, and compare it with Coulomb and viscous friction.

    Args:
        logs: one log or a list of them: paths, tables in memory (a dict of arrays, or a table of pandas,
            polars or pyarrow) or what `read_log` returned.
        rig: what is known about the rig: the path of a rig file, its content as a mapping, or what `read_rig`
            returned.
        model: a Model, its name, or the path of a derivation; by default that of the rig's case or tilt.
        simulated: whether to refine the parameters on the simulated motion of the training part: over whole
            runs with the controller of the rig, where it has one, else over windows of half a second.
            Friction may then depend on the current, which a regression on the drive signal cannot separate
            from the signal itself.
        reading: called with the part of the rows read, 0 to 1, while logs of more than 100,000 rows are read,
            and with a second argument "refining" while parameters are refined.

    Raises:
        InputError: a log or the rig cannot be read, they do not match, or the log has too few rows or too
            little motion for the model.
    """
    sources, rig = sources_of(logs), read_rig(rig)
    read = read_long(sources, rig, FIT_POINTS, reading)
    channels = read_channels(read, rig)
    chosen = channels.rig.model if model is None else model
    base = model_of(chosen)
    names, axis = log_names(read), rig.axis
    found = fit_channels(channels, channels.rig, base, ", ".join(names), by_current=simulated)
    refined = None
    if simulated:
        tell = None if reading is None else lambda part: reading(part, "refining")
        refined = refine(found, base, tell)
        found = refined.fit
    estimates = axis.estimates({**found.coefficients, **found.searched})
    document = fit_document(found, names)
    values, lines = read_parameters(document).values, fit_lines(found, names)
    if refined is not None:
        # With them all of `diagnosis` is imported.
        from eccentric.presentation import refined_document, refined_lines, refined_warnings

        lines = refined_lines(refined, axis) + lines
        warnings = [*document["warnings"], *refined_warnings(refined, axis)]
        document |= {"simulated": refined_document(refined), "warnings": warnings}
    model = with_fitted(base, read_parameters(document), base.name)
    cut = cut_levels_of(model, document, found.problem.drive.channels)
    document |= {"warnings": [*document["warnings"], *cut_sentences(cut, axis)], **cuts_document(cut, axis)}
    return FitResult(
        base=base,
        model=model,
        origin=origin_of(chosen),
        estimates=estimates,
        combinations=axis.estimates(found.combinations),
        fitted={"paper": fitted_model(found, axis, values)},
        draws=draws_of_fit(found, values).without(placeholders_of(found)),
        rmse={"mechanical": dict(found.rmse)},
        r_squared=found.r_squared,
        unit=axis.unit(found.problem.unit),
        improvement=found.percent,
        improvement_interval=found.percent_interval,
        warnings=tuple(document["warnings"]),
        lines=tuple(lines),
        comparison=compare(found),
        document=document,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class FitResult(Result):
    """The result of a fit. It prints as `summary()`, shows as a table in a notebook, and can be pickled.

    Attributes:
        base: the model that was fitted, with its own defaults; `model` is the fitted one.
        combinations: name -> Estimate, of parameters that the log determines only in combination.
        rmse: balance ("mechanical") -> model -> error on the held-out rows in `unit`; models are "paper" (the
            fitted one), "linear" (Coulomb and viscous friction) and "paper_unbounded".
        r_squared: of the drive signal on the held-out rows, by model.
        unit: "N m"; "V" or "A" if the log does not determine a torque.
        improvement: reduction of the held-out error from that of Coulomb and viscous friction, in percent,
            with its 95 % interval `improvement_interval`.
        comparison: measured and predicted friction on the held-out rows.
        model, origin, estimates, lines, warnings, document, fitted: as in Result; the comment of each
            parameter of the model gives its interval; the document is the content of fit.json, which
            `eccentric emit --parameters` takes.
    """

    base: Model
    combinations: Mapping[str, Estimate]
    rmse: Mapping[str, Mapping[str, float]]
    r_squared: Mapping[str, float]
    unit: str
    improvement: float
    improvement_interval: tuple[float, float]
    comparison: Comparison

    def _layout(self) -> tuple[tuple[int, int], tuple[float, float]]:
        return (1, 2), (9.0, 4.2)

    @property
    def sentence(self) -> str:
        """The result in one sentence."""
        return self.lines[-1]

    def table(self) -> ResultTable:
        """The estimates: value, standard error, 95 % interval, unit, and the active bound, "" without one.

        Standard errors assume that estimates at a bound stay there; intervals do not.
        """
        return estimate_table(self.estimates)

    def _draw(self, axes: list[Any]) -> None:
        """Measured against predicted friction, and both over the speed, on the held-out rows."""
        plot_fit(self.comparison, *axes)

    def write(self, out: str | os.PathLike[str]) -> list[Path]:
        """Write the files of `eccentric fit`: fit.json and, with matplotlib, fit.png and fit.svg.

        Raises:
            InputError: the folder cannot be written.
        """
        return self._write(out, "fit")

    def __repr__(self) -> str:
        errors = ", ".join(f"{name} {x:.4g}" for name, x in sorted(self.comparison.rmse.items()))
        return f"<FitResult: {self.base.name}, held-out RMSE [{self.unit}] {errors}>"

    def _repr_html_(self) -> str:
        return self._html(self.table(), before=self.lines[0], after=self.sentence)


# A fit as an estimator of scikit-learn.


class FrictionRegressor:
    """`eccentric.fit` with the interface of scikit-learn, for its cross-validation, grids and pipelines.

    X contains the rows of one log in time order: a data frame or a dict of arrays with the column names of
    the rig, or an array (n, k) whose names are `columns`. y (n,) is the drive signal. scikit-learn itself is
    not required.

    Args:
        rig: what is known about the rig, as `eccentric.fit` takes it; if it maps several drive signals,
            `drive` must name one.
        model: the friction model, as `eccentric.fit` takes it.
        columns: names of the columns of X if it is an array.

    Attributes:
        result_: after `fit`, the FitResult.
    """

    result_: FitResult

    def __init__(
        self, rig: RigSource, model: ModelSource | None = None, columns: Sequence[str] | None = None
    ) -> None:
        self.rig, self.model, self.columns = rig, model, columns

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """The arguments of the constructor by name; `deep` changes nothing."""
        return {"rig": self.rig, "model": self.model, "columns": self.columns}

    def set_params(self, **parameters: Any) -> Self:
        """Set arguments of the constructor; InputError for any other name."""
        for name, value in parameters.items():
            if name not in self.get_params():
                raise InputError("parameter", f"one of {', '.join(self.get_params())}", f"{name!r}")
            setattr(self, name, value)
        return self

    def fit(self, X: Any, y: ArrayLike) -> Self:
        """Fit the model to the rows of X with the drive signal y (n,); InputError as `eccentric.fit`."""
        self.result_ = fit(self._log(X, np.asarray(y, float)), self.rig, self.model)
        return self

    def predict(self, X: Any) -> NDArray[np.float64]:
        """Predicted drive signal (n,) for the motion in X, in the unit of y.

        Raises:
            InputError: `fit` was not called; X has no such column; a value is not a number; or the rig
                averages rows.
        """
        if not hasattr(self, "result_"):
            raise InputError("predict", "a fit before it", "none")
        rows = len(read_log(self._log(X, None)).columns[self._names(X)[0]])
        # The residual is linear in the drive signal: where it is 0 is the prediction.
        # Rows that repeat in every column would be dropped, hence the last digits.
        dither = 1e-9 * np.resize([1.0, -1.0], rows)
        one, two = (self.result_.residual(self._log(X, x + dither)) for x in (1.0, 2.0))
        if len(one) != rows:
            raise InputError("X", f"{rows} rows to predict", f"{len(one)} of them")
        return 1.0 - one / (two - one)

    def score(self, X: Any, y: ArrayLike) -> float:
        """R^2 of the predicted drive signal, about its mean; arguments as `fit`, errors as `predict`."""
        measured = np.asarray(y, float)
        return r_squared(measured - self.predict(X), measured - measured.mean())

    def _names(self, X: Any) -> list[str]:
        if isinstance(X, np.ndarray):
            if self.columns is None or len(self.columns) != X.shape[1]:
                raise InputError("columns", f"{X.shape[1]} names of the columns of X", repr(self.columns))
            return list(self.columns)
        return list(X)

    def _log(self, X: Any, drive: NDArray[np.float64] | None) -> dict[str, Any]:
        names = self._names(X)
        values: Mapping[str, Any] = dict(zip(names, X.T, strict=True)) if isinstance(X, np.ndarray) else X
        log = {name: np.asarray(values[name]) for name in names}
        return log if drive is None else {**log, self._drive_column: drive}

    @property
    def _drive_column(self) -> str:
        """The name of the column that the rig has the drive signal in."""
        mapped = read_rig(self.rig).log
        measures = ("torque", "current", "voltage") if mapped.drive is None else (mapped.drive,)
        found = [source.text for name, source in (mapped.columns or {}).items() if name in measures]
        if len(found) != 1:
            raise InputError("rig", "[columns] with one drive signal, or drive", ", ".join(found) or "none")
        return found[0].removeprefix("-")

    def __sklearn_tags__(self) -> Any:
        from sklearn.base import BaseEstimator, RegressorMixin

        return type("Tagged", (RegressorMixin, BaseEstimator), {})().__sklearn_tags__()

    def __repr__(self) -> str:
        return f"FrictionRegressor(model={self.model!r})"
