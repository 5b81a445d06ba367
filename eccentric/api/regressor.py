"""A fit as an estimator of scikit-learn: `fit`, `predict`, `score`, `get_params`, `set_params`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eccentric.api.fitted import FitResult, fit
from eccentric.api.inputs import ModelSource, RigSource
from eccentric.core import InputError
from eccentric.identification import r_squared
from eccentric.logs import read_log
from eccentric.rigs import read_rig


class FrictionRegressor:
    """`eccentric.fit` with the interface of scikit-learn, for its cross-validation, grids and pipelines.

    X holds the rows of one log in the order of time: a data frame or a dict of arrays, by the names that the
    rig maps, or an array (n, k) with `columns` as names. y (n,) is the column of the drive signal.
    scikit-learn itself is not needed.

    Args:
        rig: what is known about the rig, as `eccentric.fit` takes it; `drive` is its key where it maps
            several drive signals.
        model: the friction model, as `eccentric.fit` takes it.
        columns: names of the columns of X, where that is an array.

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
        """The drive signal (n,) that the motion in X requires, in the unit of y.

        Raises:
            InputError: nothing was fitted; X lacks a column; a row is not a number, or the rig averages rows.
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
