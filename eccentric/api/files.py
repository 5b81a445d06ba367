"""The emitted files of a model, written atomically."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from eccentric.emission import (
    BACKENDS,
    DEFAULT,
    WHOLE,
    Adaptation,
    Choice,
    complete,
    complete_arm,
    prior_of,
    render_adapt,
    write,
)
from eccentric.errors import InputError
from eccentric.model import Model, Recursion
from eccentric.output import whole_folder

__all__ = ["require_fit", "write_arm", "write_emitted"]


def write_emitted(
    model: Model,
    origin: str,
    out: str | os.PathLike[str],
    backend: str | Sequence[str] | None = None,
    *,
    single_file: bool = False,
    choice: Choice = WHOLE,
    adapt: Adaptation | None = None,
    fit: Mapping[str, Any] | None = None,
) -> list[Path]:
    """Write the files of a model for its targets, and those that check the C, into a folder of their own.

    Files that the same model wrote there before are replaced, all others stay. `origin` is the source of the
    physics, for the banner; `backend` is a target or several, NumPy and C99 by default. With `single_file`
    the NumPy module contains its runtime; `choice` is what of the model is emitted. With `adapt` an
    estimator of the friction is added, whose prior is that of the fit with this content. Returns the paths.
    Raises InputError if there is no such target, or the folder cannot be written.
    """
    names = _backends(backend)
    files = complete(model, "eccentric emit", origin, names, single_file=single_file, choice=choice)
    if adapt is not None:
        if missing := [name for name in DEFAULT if name not in names]:
            raise InputError(f"adapt: backend {' and '.join(missing)} is required as well")
        files |= render_adapt(model, files, prior_of(model, fit), adapt)
    with whole_folder(out, f"emit {model.name}") as folder:
        write(files, folder)
    return [Path(out) / name for name in files]


def write_arm(
    found: Recursion,
    model: Model,
    origin: str,
    out: str | os.PathLike[str],
    backend: str | Sequence[str] | None = None,
    *,
    single_file: bool = False,
    choice: Choice = WHOLE,
) -> list[Path]:
    """Write the files of an arm as `write_emitted` writes those of a model; `found` is its recursion."""
    names = _backends(backend)
    files = complete_arm(
        found, model, "eccentric emit", origin, names, single_file=single_file, choice=choice
    )
    with whole_folder(out, f"emit {model.name}") as folder:
        write(files, folder)
    return [Path(out) / name for name in files]


def _backends(backend: str | Sequence[str] | None) -> dict[str, None]:
    several = isinstance(backend, Sequence) and not isinstance(backend, str | bytes)
    given = DEFAULT if backend is None else list(backend if several else [backend])
    names: dict[str, None] = {}
    for name in given or ["none"]:
        if not isinstance(name, str) or name not in BACKENDS:
            raise InputError(f"backend: one of {', '.join(BACKENDS)} is required, received {name!r}")
        names[name] = None
    return names


def require_fit(fits_the_rig: bool, source: str, accept_misfit: bool) -> None:
    """Raise InputError for parameters of a log that does not fit its rig, unless they are accepted."""
    if not fits_the_rig and not accept_misfit:
        raise InputError(
            f"accept_misfit: this is required to emit {source}, since its log does not fit the rig"
        )
