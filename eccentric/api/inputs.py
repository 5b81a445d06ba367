"""Logs, rigs and models as a user has them, converted to what the rooms accept."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

from eccentric.core import InputError, given_path, is_arm_file
from eccentric.emission import FittedValues
from eccentric.logs import Log, LogSource, read_log
from eccentric.model import Model, arm, load_model, model_names, unlike, with_bodies
from eccentric.rigs import Rig, read_arm

LogSources: TypeAlias = LogSource | Sequence[LogSource]
RigSource: TypeAlias = str | os.PathLike[str] | Mapping[str, Any] | Rig
ModelSource: TypeAlias = str | os.PathLike[str] | Model


def read_logs(logs: LogSources) -> list[Log]:
    """Return one log or several, each as `read_log` accepts it; tables in memory are "table 1", "table 2".

    Raises:
        InputError: one cannot be read; or two are the same: duplicate rows make errors look smaller than they
            are.
    """
    sources = sources_of(logs)
    names = [f"table {k}" for k in range(1, len(sources) + 1)] if len(sources) > 1 else ["table"]
    return [read_log(source, name) for source, name in zip(sources, names, strict=True)]


def sources_of(logs: LogSources) -> list[Any]:
    """Return one log or several, as they were given, not read yet.

    Raises:
        InputError: there is none; or two are the same: duplicate rows make errors look smaller than they are.
    """
    sources: list[Any] = list(logs) if isinstance(logs, list | tuple) else [logs]
    if not sources:
        raise InputError("", "a log", "none")
    places = [given_path(x, "log").resolve() if isinstance(x, str | os.PathLike) else id(x) for x in sources]
    for k, source in enumerate(sources):
        if places[k] in places[:k]:
            what = source if isinstance(source, str | os.PathLike) else f"table {k + 1}"
            raise InputError(what, "each log", "it twice", why="only once")
    return sources


def model_of(model: ModelSource) -> Model:
    """A model by its name or by the path of its derivation; a Model is returned unchanged."""
    return model if isinstance(model, Model) else load_model(model)


def fit_path(parameters: str | os.PathLike[str]) -> Path:
    """The path of a fit.json, also from that of the folder that a fit wrote."""
    path = given_path(parameters, "parameters")
    return path / "fit.json" if (path / "fit.json").is_file() else path


def names_given(names: str | Sequence[str]) -> tuple[str, ...]:
    """One name or several, each as often as it is given."""
    return (names,) if isinstance(names, str) else tuple(names)


def by_name(model: ModelSource | None) -> str | Model | None:
    """A model by name or path wherever one leads to it: a Model that ships is as well known by its name."""
    if model is None:
        return None
    if not isinstance(model, Model):
        return str(given_path(model, "model"))
    return model.name if model.name in model_names() and load_model(model.name) is model else model


def is_arm(model: object) -> bool:
    """Whether a model is given by the file of an arm: by its suffix, which a derivation does not have."""
    return isinstance(model, str | os.PathLike) and is_arm_file(model)


def arm_of(source: ModelSource, fitted: FittedValues | None = None) -> Model:
    """The model of an arm; bodies that a fit identified replace the file's.

    Raises:
        InputError: it cannot be read, or the fit is of another arm.
    """
    chain = read_arm(given_path(source, "arm"))
    if fitted is not None and fitted.chain and (difference := unlike(chain, fitted.chain)):
        of = f"expected a fit of the arm in {origin_of(source)}"
        raise InputError(fitted.source, problem=f"{of}, got one of another arm: {difference}")
    if fitted is not None and fitted.bodies and fitted.model in (None, chain.name):
        chain = with_bodies(chain, fitted.bodies)
    size = "one joint" if len(chain.joints) == 1 else f"{len(chain.joints)} joints"
    title = f"Arm of {size}: motion, loads of the bearings, and friction that follows them"
    return arm(chain, title)


def origin_of(model: ModelSource) -> str:
    """The source of a model's physics, for the banner of emitted files."""
    if isinstance(model, Model):
        return f"model {model.name}"
    own = Path(model).suffix == ".py" or is_arm(model)
    return Path(model).name if own else f"derivations/{model}.py"
