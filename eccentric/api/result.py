"""What the results of a fit and of a diagnosis have in common: a fitted model, its estimates, and words."""

from __future__ import annotations

import dataclasses
import json
import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from html import escape
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError, whole_folder
from eccentric.emission import (
    BACKENDS,
    DEFAULT,
    WHOLE,
    Adaptation,
    Choice,
    checked_name,
    complete,
    gain_of,
    load_module,
    prior_of,
    render_adapt,
    render_compensation,
    write,
)
from eccentric.identification import Estimate, correlation
from eccentric.logs import Log
from eccentric.model import Model
from eccentric.presentation import NEEDS_MATPLOTLIB
from eccentric.simulation import Draws

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


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
    Raises InputError if there is no such target, or the folder cannot be written.
    """
    names = _backends(backend)
    files = complete(model, "eccentric emit", origin, names, single_file=single_file, choice=choice)
    own = dict(files)
    for key, wanted in (("adapt", adapt is not None), ("compensation", compensation)):
        if wanted and (missing := [name for name in DEFAULT if name not in names]):
            raise InputError(key, problem=f"backend {' and '.join(missing)} is required as well")
    if adapt is not None:
        files |= render_adapt(model, own, prior_of(model, fit), adapt)
    if compensation:
        files |= render_compensation(model, own, gain_of(model, fit))
    with whole_folder(out, f"emit {model.name}") as folder:
        write(files, folder)
    return [Path(out) / name for name in files]


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
            "accept_misfit", problem=f"this is required to emit {source}, since its log does not fit the rig"
        )


# Tables of results: for a terminal, a notebook, and any other library.


@dataclass(frozen=True)
class ResultTable:
    """A small table of results.

    `table["value"]` is a column, `table[0]` a row, `table[:3]` a table of the first three; iterating gives
    the rows as dictionaries, so that `list(table)` is plain data, and `pandas.DataFrame(list(table))` a data
    frame. None means unknown.

    Attributes:
        names: of the columns.
        rows: their values, one tuple for each row.
    """

    names: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return (dict(zip(self.names, row, strict=True)) for row in self.rows)

    @overload
    def __getitem__(self, name: str) -> list[Any]: ...
    @overload
    def __getitem__(self, name: int) -> dict[str, Any]: ...
    @overload
    def __getitem__(self, name: slice) -> ResultTable: ...
    def __getitem__(self, name: str | int | slice) -> list[Any] | dict[str, Any] | ResultTable:
        if isinstance(name, slice):
            return ResultTable(self.names, self.rows[name])
        if isinstance(name, int):
            return dict(zip(self.names, self.rows[name], strict=True))
        if name not in self.names:
            raise KeyError(f"{name!r}; the columns are {', '.join(self.names)}")
        place = self.names.index(name)
        return [row[place] for row in self.rows]

    def __str__(self) -> str:
        return _text(self.names, self._cells(), [self._is_number(k) for k in range(len(self.names))])

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return _html(self.names, self._cells())

    def _cells(self) -> list[tuple[str, ...]]:
        return [tuple(map(_cell, row)) for row in self.rows]

    def _is_number(self, column: int) -> bool:
        return all(row[column] is None or isinstance(row[column], int | float) for row in self.rows)


@dataclass(frozen=True, eq=False)
class Correlation:
    """Correlation of the errors of estimates: `correlation["B_m", "C_m"]`, from -1 to 1.

    NaN if an estimate has no standard error: it is at a bound, or the log says nothing about it.

    Attributes:
        names: of the estimates, in the order of both axes.
        matrix: (n, n).
    """

    names: tuple[str, ...]
    matrix: NDArray[np.float64]

    @classmethod
    def of(cls, names: Sequence[str], covariance: NDArray[np.float64]) -> Correlation:
        """The correlation of estimates with this covariance (n, n)."""
        return cls(tuple(names), correlation(covariance))

    def __getitem__(self, pair: tuple[str, str]) -> float:
        for name in pair:
            if name not in self.names:
                raise KeyError(f"{name!r}; the estimates are {', '.join(self.names)}")
        row, column = (self.names.index(name) for name in pair)
        return float(self.matrix[row, column])

    def table(self) -> ResultTable:
        """The matrix, a row and a column for each estimate."""
        rows = (
            (name, *(None if math.isnan(x) else float(x) for x in row))
            for name, row in zip(self.names, self.matrix, strict=True)
        )
        return ResultTable(("", *self.names), tuple(rows))

    def __str__(self) -> str:
        return _text(("", *self.names), self._cells(), [False, *(True for _ in self.names)])

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return _html(("", *self.names), self._cells())

    def _cells(self) -> list[tuple[str, ...]]:
        rows = zip(self.names, self.matrix, strict=True)
        return [(name, *("-" if math.isnan(x) else f"{x:.2f}" for x in row)) for name, row in rows]


def ranges_of(log: Log) -> ResultTable:
    """The columns of a log, each with its lowest and highest value."""
    columns = ((name, log.numbers(name)) for name in log.columns)
    return ResultTable(
        ("column", "lowest", "highest"),
        tuple((name, float(values.min()), float(values.max())) for name, values in columns),
    )


def _text(names: Sequence[str], rows: Sequence[Sequence[str]], right: Sequence[bool]) -> str:
    """The table for a terminal with aligned columns; those in `right` are right-aligned."""
    widths = [max(map(len, column)) for column in zip(names, *rows, strict=True)]
    lines = (
        "  ".join(x.rjust(w) if r else x.ljust(w) for x, w, r in zip(row, widths, right, strict=True))
        for row in (names, *rows)
    )
    return "\n".join(line.rstrip() for line in lines)


def _html(names: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """The table in HTML; names and cells are escaped here."""
    head = "".join(f"<th>{escape(name)}</th>" for name in names)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cell(value: object) -> str:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "-"
    if isinstance(value, float):
        return f"{value:.4g}"
    return str(value)


# What results have in common.


@dataclass(frozen=True, eq=False, kw_only=True)
class Printed:
    """What is said of a fit, a comparison or a diagnosis: it prints as its summary and is a JSON document.

    Attributes:
        lines: the summary, line by line.
        warnings: what is unusual about logs, rig or fit.
        document: the content of the JSON file that the command of this result writes.
    """

    lines: tuple[str, ...]
    warnings: tuple[str, ...]
    document: Mapping[str, Any]

    def summary(self) -> str:
        """What the command prints."""
        return "\n".join(self.lines)

    def to_json(self) -> str:
        """The text of the JSON file, strict: no NaN, no infinity."""
        return json.dumps(self.document, indent=1, ensure_ascii=False, allow_nan=False) + "\n"

    def to_dict(self) -> dict[str, Any]:
        """The content of the JSON file as a reader receives it: numbers, strings, lists and dictionaries."""
        return json.loads(self.to_json())

    def __str__(self) -> str:
        return self.summary()

    def _html(self, table: ResultTable, *, before: str = "", after: str = "") -> str:
        """The table between two paragraphs, and the warnings, for a notebook."""
        texts = (after, *(f"Warning: {text}" for text in self.warnings))
        return f"<div>{paragraphs(before)}{table._repr_html_()}{paragraphs(*texts)}</div>"

    def _write(
        self,
        out: str | os.PathLike[str],
        command: str,
        size: tuple[float, float],
        draw: Callable[[Figure], object],
        further: Mapping[str, str] | None = None,
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
                from matplotlib.figure import Figure

                # A fixed salt and no date: the same result gives the same file.
                with rc_context({"svg.hashsalt": "eccentric", "font.size": 9.0}):
                    draw(figure := Figure(figsize=size, layout="constrained"))
                    figure.savefig(folder / f"{command}.png", dpi=150)
                    figure.set_layout_engine("none")  # the layout is that of the first file
                    figure.savefig(folder / f"{command}.svg", dpi=150, metadata={"Date": None})
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
        correlation: of the errors of the estimates, by name.
        draws: the joint uncertainty of the parameters, which `samples` draws from.
        lines, warnings, document: as in Printed.
    """

    model: Model
    origin: str
    estimates: Mapping[str, Estimate]
    correlation: Correlation
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
            Every parameter of the model by name: (n,) in SI units, as the emitted Parameters take them.

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
    ) -> list[Path]:
        """Write the model for its targets into a folder; return the paths.

        Args:
            out: a folder of its own, new or written by eccentric before.
            prefix: name of the files and prefix of the C functions; by default the model's name.
            backend: a target or several, by the names that `eccentric emit --help` lists.
            accept_misfit: emit although the log does not fit the rig.

        Raises:
            InputError: the log does not fit the rig, the prefix is no name that C and Python leave free,
                there is no such target, or the folder cannot be written.
        """
        require_fit(self.fits_the_rig, "this result", accept_misfit)
        name = self.model.name if prefix is None else checked_name(prefix, "prefix")
        return write_emitted(dataclasses.replace(self.model, name=name), self.origin, out, backend)


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
