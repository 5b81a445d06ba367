"""Paths from the user, and the folders of the derivations and templates.

Derivations and templates are inside an installed package, or next to it in a clone.
"""

import os
from pathlib import Path

from eccentric.core.errors import InputError

_OF_ARMS = {".toml", ".json", ".urdf"}
_NO_ARMS = {".xacro", ".xml"}


def given_path(value: object, what: str) -> Path:
    """Return a path from the user; InputError if it cannot be one. `what` names it in the message."""
    if not isinstance(value, str | os.PathLike) or isinstance(os.fspath(value), bytes):
        raise InputError(what, "a path", type(value).__name__)
    if "\0" in os.fspath(value):
        raise InputError(what, "a path without null characters", f"{str(value)!r}")
    return Path(value)


def is_arm_file(path: str | os.PathLike[str]) -> bool:
    """Return whether a path has the suffix of an arm file; the part after # is the tip link of a URDF."""
    return Path(os.fspath(path).partition("#")[0]).suffix.lower() in _OF_ARMS


def refuse_other_files(path: str | os.PathLike[str]) -> None:
    """Raise InputError for a folder, XML or xacro where a model or an arm is required."""
    given = Path(path)
    if given.is_dir() or given.suffix.lower() in _NO_ARMS:
        what = "a model's name, a derivation .py, or an arm .toml, .json or .urdf"
        received = "a folder" if given.is_dir() else f"{given.suffix!r}"
        hint = _instead_of(given) if given.is_dir() else ": expand a xacro and name the result .urdf"
        raise InputError(shown(given), what, f"{received}{hint}")


def _instead_of(folder: Path) -> str:
    """The path to use instead of a result folder."""
    if (folder / "model.py").is_file():
        return f": give its model, {shown(folder / 'model.py')}"
    if (folder / "fit.json").is_file():
        return f": give the model that was fitted, with --parameters {shown(folder / 'fit.json')}"
    return ""


def shown(path: Path) -> str:
    """Return a path for messages and results, with bytes that are not UTF-8 replaced."""
    return os.fsencode(path).decode("utf-8", "replace")


def readable(path: Path) -> Path:
    """Return the path of a regular file to read; InputError for anything else: a pipe would block."""
    if not path.exists():
        raise InputError(shown(path), problem="no such file")
    if not path.is_file():
        received = "a directory" if path.is_dir() else "a pipe or a device"
        raise InputError(shown(path), "a regular file", received)
    return path


def folder(name: str) -> Path:
    """Return the folder `derivations` or `templates` of this copy of the package.

    It is in the package (an installed wheel), else next to it (a clone).

    Raises:
        InputError: neither exists, the installation is incomplete.
    """
    package = Path(__file__).resolve().parents[1]
    inside, beside = package / name, package.parent / name
    if inside.is_dir():
        return inside
    # An installed package is in site-packages, where a `templates` folder would belong to another project.
    if beside.is_dir() and (package.parent / "pyproject.toml").is_file():
        return beside
    raise InputError(name, f"a folder {inside} or, in a clone, {beside}", "neither")


def derivation(name_or_path: str | os.PathLike[str]) -> Path:
    """Return the path of a derivation, from a path ending in `.py` or a bundled name; it need not exist."""
    path = given_path(name_or_path, "model")
    return (path if path.suffix == ".py" else folder("derivations") / f"{name_or_path}.py").resolve()
