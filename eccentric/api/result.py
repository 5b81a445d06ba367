"""What the results of a fit and of a diagnosis have in common: a fitted model, its estimates, and words."""

from __future__ import annotations

import dataclasses
import json
import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from html import escape
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from eccentric.api.files import require_fit, write_emitted
from eccentric.api.tables import Correlation
from eccentric.emission import checked_name, load_module
from eccentric.errors import InputError
from eccentric.estimation import Estimate
from eccentric.fitting import NEEDS_MATPLOTLIB
from eccentric.model import Model
from eccentric.output import whole_folder

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Printed", "Result", "new_axes", "paragraphs"]


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
        lines, warnings, document: as in Printed.
    """

    model: Model
    origin: str
    estimates: Mapping[str, Estimate]
    correlation: Correlation

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
            backend: a target, "numpy", "c99" or "jax", or several; by default the first two.
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
    """The texts as HTML paragraphs, escaped."""
    return "".join(f"<p>{escape(text)}</p>" for text in texts)
