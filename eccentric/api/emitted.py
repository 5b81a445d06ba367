"""`eccentric.emit`: any model as a NumPy module and C99."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from eccentric.api.adapted import asked_adaptation
from eccentric.api.fitted import FitResult
from eccentric.api.inputs import ModelSource, arm_of, fit_path, is_arm, model_of, origin_of
from eccentric.api.result import fastest, require_fit, write_emitted
from eccentric.core import InputError, refuse_other_files
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
    """Write a model as a NumPy module and C99, and what checks the C, into a folder; return the paths.

    Args:
        model: a Model, its name, or the path of a derivation, an arm file or a URDF.
        out: a folder of its own, new or written by eccentric before.
        parameters: defaults of the emitted code: a FitResult, a fit.json, its folder or its content, or
            values in SI by the paper's letters; by default those of the model.
        prefix: name of the files and prefix of the C functions; by default the model's name.
        backend: a target or several, by the names that `eccentric emit --help` lists.
        single_file: whether the NumPy module contains its runtime, which is otherwise a file beside it.
        functions: names of the functions that are emitted, with the coefficients that they need; by default
            all. Hidden states keep their step.
        arrays: whether C has array functions, in a header of their own where functions are chosen; by default
            only where none are chosen.
        fixed: whether C has the default parameters only: no `prepare`, and no files that check it.
        accept_misfit: emit the values of a fit or a diagnosis although its log does not fit the rig.
        adapt: add an estimator of the friction coefficients, NAME_adapt.h, .c and .py; its prior is that of
            the fit, where the parameters are one.
        compensation: add a compensation of the friction for a loop, NAME_compensation.h, .c and .py; its gain
            follows from the fit, where the parameters are one.
        forgetting, false_alarms, settle: of this estimator: forgetting per row, the mean number of samples
            between two false alarms, and the samples left out after a reversal; by default 0.999, 1e7, 20.

    What the model carries as a caution, such as a choice that its log did not decide, is a UserWarning.

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
    require_fit(loaded.fits_the_rig, origin_of(model), accept_misfit)
    beside = [key for key, wanted in (("adapt", asked is not None), ("compensation", compensation)) if wanted]
    if beside and joints_of(loaded):
        raise InputError(beside[0], "a model of one joint", "an arm")
    name = checked_name(
        *((loaded.name, f"model {loaded.name}: its name") if prefix is None else (prefix, "prefix"))
    )
    chosen = replace(loaded, name=name) if fitted is None else with_fitted(loaded, fitted, name)
    if not joints_of(chosen) and (not functions or STEPPED & set(functions)):
        require_solvable(chosen, *fastest(given))
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


def _content(
    parameters: str | os.PathLike[str] | FitResult | Mapping[str, Any],
) -> Path | Mapping[str, Any]:
    if isinstance(parameters, FitResult):
        return parameters.document
    if isinstance(parameters, Mapping):
        return parameters if "parameters" in parameters else {"parameters": parameters}
    return fit_path(parameters)
