"""`eccentric.emit`, `eccentric.export`: a model as a NumPy module and C99, a drive as one of a simulator."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from eccentric.api.adapted import asked_adaptation
from eccentric.api.fitted import FitResult
from eccentric.api.inputs import ModelSource, arm_of, fit_path, is_arm, model_of, origin_of
from eccentric.api.result import ResultBase, require_fit, speeds_of, write_emitted
from eccentric.api.tables import ResultTable
from eccentric.core import (
    InputError,
    counted,
    derivation,
    given_path,
    meant,
    refuse_other_files,
    whole_folder,
)
from eccentric.emission import (
    WHOLE,
    Arrays,
    Choice,
    checked_name,
    document_of,
    joints_of,
    read_parameters,
    require_solvable,
    with_fitted,
)
from eccentric.exports import DEFAULT_SPEEDS, ExportedArm, ExportedDrive
from eccentric.exports import export as exported
from eccentric.model import Model, model_names
from eccentric.presentation import export_lines

STEPPED = frozenset({"friction_step", "acceleration"})
"""Functions that have no single result where friction takes more of an acceleration than the inertia."""


def emit(
    model: ModelSource,
    out: str | os.PathLike[str],
    *,
    parameters: str | os.PathLike[str] | FitResult | Mapping[str, Any] | None = None,
    prefix: str | None = None,
    backend: str | Sequence[str] | None = None,
    single_file: bool = False,
    functions: Sequence[str] = (),
    arrays: bool | None = None,
    fixed: bool = False,
    accept_misfit: bool = False,
    adapt: bool = False,
    compensation: bool = False,
    forgetting: float | None = None,
    false_alarms: float | None = None,
    settle: int | None = None,
) -> list[Path]:
    """Write a model as a NumPy module and C99, with files that check the C, into a folder; return the paths.

    Args:
        model: a Model, its name, or the path of a derivation, an arm file or a URDF.
        out: the output folder: new, empty, or written by eccentric.
        parameters: defaults of the emitted code: a FitResult, a fit.json, its folder or its content, or
            values in SI by the paper's letters; by default those of the model.
        prefix: name of the files and prefix of the C functions; by default the model's name.
        backend: one target or several: "numpy", "c99", "jax"; by default NumPy and C99.
        single_file: whether the NumPy module contains its runtime, which is otherwise a file next to it.
        functions: names of the functions to emit, with the coefficients they need; by default all. The `step`
            of hidden states is always emitted.
        arrays: whether to write array functions in C, in a header of their own if `functions` are given; by
            default only if none are given.
        fixed: whether the C is for the default parameters only, without `prepare` and the files that check
            it.
        accept_misfit: emit the values of a fit or a diagnosis even if its log does not fit the rig.
        adapt: add an estimator of the friction coefficients, NAME_adapt.h, .c and .py; its prior is that of
            the fit, if the parameters are a fit.
        compensation: add a friction compensation for a control loop, NAME_compensation.h, .c and .py; its
            gain follows from the fit, if the parameters are a fit.
        forgetting, false_alarms, settle: of this estimator: forgetting factor per sample, mean number of
            samples between false alarms, samples to skip after a reversal; by default 0.999, 1e7, 20.

    Cautions of the model, such as a choice that its log did not decide, are issued as UserWarning.

    Raises:
        InputError: there is no such model, target or function, or it cannot be emitted; the parameters are
            those of another model or of a log that does not fit its rig, or have an invalid sign; the prefix
            is not a free name in C and Python; the folder cannot be written; friction follows the
            acceleration by more than the inertia, so that `friction_step` would have no single solution.
    """
    if isinstance(functions, str):
        raise InputError("functions", "a list of names", f"{functions!r}")
    with_arrays = not functions if arrays is None else arrays
    where: Arrays = "none" if not with_arrays else "beside" if functions else "with"
    choice = Choice(tuple(functions), where, fixed)
    asked = asked_adaptation(adapt, forgetting, false_alarms, settle)
    given = None if parameters is None else document_of(_content(parameters))
    fitted = None if parameters is None else read_parameters(_content(parameters))
    if fitted is not None:
        require_fit(fitted.fits_the_rig, fitted.source, accept_misfit)
    if isinstance(model, str | os.PathLike):
        refuse_other_files(model)
    loaded = arm_of(model, fitted) if is_arm(model) else model_of(model)
    beside = [key for key, wanted in (("adapt", asked is not None), ("compensation", compensation)) if wanted]
    if beside and joints_of(loaded):
        raise InputError(beside[0], "a model of one joint", "an arm")
    name = checked_name(
        *((loaded.name, f"model {loaded.name}: its name") if prefix is None else (prefix, "prefix"))
    )
    chosen = replace(loaded, name=name) if fitted is None else with_fitted(loaded, fitted, name)
    require_fit(chosen.fits_the_rig, origin_of(model), accept_misfit)
    if not joints_of(chosen) and (not functions or STEPPED & set(functions)):
        require_solvable(chosen, *speeds_of(given)[1:])
    if beside and choice != WHOLE:
        raise InputError(
            beside[0],
            problem="cannot be combined with fixed, functions or arrays: it needs the whole model",
        )
    return write_emitted(
        chosen,
        origin_of(model),
        out,
        backend,
        single_file=single_file,
        choice=choice,
        adapt=asked,
        compensation=compensation,
        fit=given,
    )


def _content(parameters: str | os.PathLike[str] | FitResult | Mapping[str, Any]) -> Path | Mapping[str, Any]:
    if isinstance(parameters, FitResult):
        return parameters.document
    if isinstance(parameters, Mapping):
        return parameters if "parameters" in parameters else {"parameters": parameters}
    return fit_path(parameters)


# A drive as a model of a simulator.


@dataclass(frozen=True, repr=False)
class ExportResult(ResultBase):
    """The files of an export, and how accurate its friction is.

    Attributes:
        paths: of the files.
        lines: the summary, line by line: error of the friction, what is left out.
    """

    paths: tuple[Path, ...]
    lines: tuple[str, ...]

    def summary(self) -> str:
        """The text that the command prints."""
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
    """Write a drive or an arm, with its friction at rest and in motion, for a simulator.

    Args:
        source: a Model, its name, or the path of a derivation; a FitResult, or the path of a fit.json; the
            folder of a fit or of a diagnosis; or the path of an arm file or a URDF, for the target "budget".
        to: the target: "mjcf", "budget", "urdf", "usd", "bam", "newton" or "fmu".
        out: the output folder: new, empty, or written by eccentric.
        parameters: values for a model, as `emit` takes them.
        speeds: lowest and highest motor speed [rad/s] over which to fit the friction if the target has only
            constant coefficients; by default those of the log, or 1 to 60 without a log. None for an arm.
        prefix: name of the files; by default the model's name.
        accept_misfit: export the values of a fit or a diagnosis even if its log does not fit the rig.

    Raises:
        InputError: there is no such model or target; the target cannot take the drive, arm or carriage;
            an inertia is not known, or friction follows the acceleration by more than it; the parameters are
            those of another model or of a log that does not fit its rig; the folder cannot be written.
    """
    model, given = _model_and_values(source, parameters)
    if isinstance(model, str | os.PathLike):
        refuse_other_files(model)
    fitted = None if given is None else read_parameters(given)
    chosen = arm_of(model, fitted) if is_arm(model) else model_of(model)
    name = checked_name(
        *((chosen.name, f"model {chosen.name}: its name") if prefix is None else (prefix, "prefix"))
    )
    if fitted is None:
        chosen = replace(chosen, name=name)
    else:
        require_fit(fitted.fits_the_rig, fitted.source, accept_misfit)
        chosen = with_fitted(chosen, fitted, name)
    require_fit(chosen.fits_the_rig, origin_of(model), accept_misfit)
    drive = _exported_as(chosen, origin_of(model), given, speeds)
    found = exported(drive, to)
    with whole_folder(out, f"export {name} {to}") as folder:
        for file, content in found.files.items():
            (folder / file).parent.mkdir(parents=True, exist_ok=True)
            (folder / file).write_bytes(content if isinstance(content, bytes) else content.encode())
    for text in chosen.cautions:
        warnings.warn(f"{name}: {text}", stacklevel=2)
    paths = tuple(Path(out) / file for file in found.files)
    return ExportResult(paths, tuple(export_lines(drive, found)))


def _exported_as(
    model: Model, origin: str, given: Path | Mapping[str, Any] | None, speeds: Sequence[float] | None
) -> ExportedDrive | ExportedArm:
    """What is exported, with the speeds over which its friction is approximated."""
    if joints_of(model):
        if speeds is not None:
            raise InputError("speeds", "none for an arm", " ".join(map(str, speeds)))
        return ExportedArm(model, origin)
    identified = None if given is None else speeds_of(document_of(given))
    chosen = tuple(map(float, speeds if speeds is not None else identified or DEFAULT_SPEEDS))
    drive = ExportedDrive(model, origin, chosen, speeds is None and bool(identified))
    require_solvable(model, chosen[1])
    return drive


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
        if not (path.suffix or path.exists() or derivation(source).is_file()):
            raise InputError(
                path,
                "a model, its derivation, a fit.json, or the folder of a fit or a diagnosis",
                "none with this name",
                hint=meant(source, model_names()).removeprefix("; "),
            )
        if path.suffix == ".json":
            document = document_of(path)
            named = document.get("model")
            if parameters is not None:
                raise InputError("parameters", "none with a fit.json", str(parameters))
            if not isinstance(named, str):
                raise InputError(path, "a fit.json that names its model", repr(named))
            return named, path
        source = str(path)
    return source, None if given is None else _content(given)
