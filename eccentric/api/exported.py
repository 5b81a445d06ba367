"""`eccentric.export`: a drive as a model of a simulator."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from eccentric.api.fitted import FitResult
from eccentric.api.inputs import ModelSource, fit_path, is_arm, model_of, origin_of
from eccentric.api.result import ResultBase, require_fit
from eccentric.api.tables import ResultTable
from eccentric.core import InputError, counted, given_path, refuse_other_files, whole_folder
from eccentric.emission import checked_name, document_of, read_parameters, require_solvable, with_fitted
from eccentric.exports import DEFAULT_SPEEDS, ExportedDrive
from eccentric.exports import export as exported
from eccentric.model import model_names
from eccentric.presentation import export_lines


@dataclass(frozen=True, repr=False)
class ExportResult(ResultBase):
    """What an export wrote, and how close it is.

    Attributes:
        paths: of the files.
        lines: the summary, line by line: error of the friction, what is left out.
        cautions: what to know of the model before it is used.
    """

    paths: tuple[Path, ...]
    lines: tuple[str, ...]
    cautions: tuple[str, ...] = ()

    def summary(self) -> str:
        """What the command prints."""
        return "\n".join(self.lines)

    def table(self) -> ResultTable:
        """A row for each file: its path and size in bytes."""
        return ResultTable(("file", "bytes"), tuple((p.as_posix(), p.stat().st_size) for p in self.paths))

    def __repr__(self) -> str:
        return f"<ExportResult: {counted(len(self.paths), 'file')}>"


def export(
    source: ModelSource | FitResult,
    to: str,
    out: str | os.PathLike[str],
    *,
    parameters: str | os.PathLike[str] | FitResult | Mapping[str, Any] | None = None,
    speeds: Sequence[float] | None = None,
    prefix: str | None = None,
    accept_misfit: bool = False,
) -> ExportResult:
    """Write a drive, with its friction at rest and in motion, as a model of a simulator.

    Args:
        source: a Model, its name, or the path of a derivation; a FitResult, or the path of a fit.json; or the
            folder of a fit or of a diagnosis.
        to: the target, by the names that `eccentric export --help` lists.
        out: a folder of its own, new or written by eccentric before.
        parameters: values for a model, as `emit` takes them.
        speeds: lowest and highest motor speed [rad/s] over which friction with constant coefficients is
            fitted; by default those of the log, and 1 to 60 without one.
        prefix: name of the files; by default the model's name.
        accept_misfit: export the values of a fit or a diagnosis although its log does not fit the rig.

    Raises:
        InputError: there is no such model or target; the target cannot take the drive, an arm or a carriage;
            an inertia is not known, or friction follows the acceleration by more than it; the parameters are
            those of another model or of a log that does not fit its rig; the folder cannot be written.
    """
    model, given = _model_and_values(source, parameters)
    if isinstance(model, str | os.PathLike):
        refuse_other_files(model)
        if is_arm(model):
            raise InputError("model", "a model of one drive", f"an arm, {Path(model).name}", why="to export")
    chosen = model_of(model)
    require_fit(chosen.fits_the_rig, origin_of(model), accept_misfit)
    name = checked_name(
        *((chosen.name, f"model {chosen.name}: its name") if prefix is None else (prefix, "prefix"))
    )
    identified = None
    if given is None:
        chosen = replace(chosen, name=name)
    else:
        fitted = read_parameters(given)
        require_fit(fitted.fits_the_rig, fitted.source, accept_misfit)
        chosen, identified = with_fitted(chosen, fitted, name), _speeds_in(given)
    chosen_speeds = tuple(map(float, speeds if speeds is not None else identified or DEFAULT_SPEEDS))
    drive = ExportedDrive(chosen, origin_of(model), chosen_speeds, speeds is None and identified is not None)
    require_solvable(chosen, chosen_speeds[1])
    found = exported(drive, to)
    with whole_folder(out, f"export {name} {to}") as folder:
        for file, content in found.files.items():
            (folder / file).parent.mkdir(parents=True, exist_ok=True)
            (folder / file).write_bytes(content if isinstance(content, bytes) else content.encode())
    cautions = tuple(f"{name}: {text}" for text in chosen.cautions)
    paths = tuple(Path(out) / file for file in found.files)
    return ExportResult(paths, tuple(export_lines(drive, found)), cautions)


def _model_and_values(
    source: ModelSource | FitResult, parameters: object
) -> tuple[ModelSource, Path | Mapping[str, Any] | None]:
    """The model of a source, and the content of a fit, if there is one."""
    given: Any = parameters
    if isinstance(source, FitResult):
        return source.base, source.document
    if isinstance(source, str | os.PathLike):
        path = given_path(source, "model")
        if path.is_dir() and str(path) not in model_names():
            path = next((path / x for x in ("model.py", "fit.json") if (path / x).is_file()), path)
            if path.is_dir():
                raise InputError(
                    path, "the folder of a fit or a diagnosis, with fit.json or model.py", "neither"
                )
        if path.suffix == ".json":
            document = document_of(path)
            named = document.get("model")
            if parameters is not None:
                raise InputError("parameters", "none beside a fit.json", str(parameters))
            if not isinstance(named, str):
                raise InputError(path, "a fit.json that names its model", repr(named))
            return named, path
        source = str(path)
    if isinstance(given, FitResult):
        return source, given.document
    if isinstance(given, Mapping):
        return source, given if "parameters" in given else {"parameters": given}
    return source, None if given is None else fit_path(given)


def _speeds_in(given: Path | Mapping[str, Any]) -> tuple[float, float] | None:
    """The motor speeds that a fit was identified on."""
    ranges = document_of(given).get("ranges")
    speeds = ranges.get("speed_m_rad_s") if isinstance(ranges, Mapping) else None
    return (float(speeds[0]), float(speeds[1])) if isinstance(speeds, list) and len(speeds) == 2 else None
