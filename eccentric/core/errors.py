"""The one error a user sees: one line with the place, what was expected and what came."""

import difflib
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any


class InputError(ValueError):
    """Bad input from outside: a log, a rig, a parameter, a command line.

    The command line prints it as one line after `eccentric: error:` and exits with status 2; nothing is
    written.

    Attributes:
        place: location from the outside in, such as file, table and key, row and column:
            "rig.toml: [known] k_i"; "" if not given separately.
        expected, got: the expected and the received value.
        why: follows `expected`: a reason or a format, "to draft a rig", ", as in 1 kg".
        problem: the statement of an error that is not about an expected value; else "".
        hint: a fix or a likely cause.
        keys: the entries concerned, where the place does not end with one.
    """

    def __init__(
        self,
        place: object,
        expected: str = "",
        got: object = "",
        *,
        why: str = "",
        problem: str = "",
        hint: str = "",
        keys: Sequence[str] = (),
    ) -> None:
        """Without `expected` and `problem`, `place` is the whole line."""
        if not expected and not problem:
            place, problem = "", str(place)
        self.place, self.expected, self.got = str(place), expected, str(got)
        self.why, self.problem, self.hint, self.keys = why, problem, hint, tuple(keys)
        super().__init__(": ".join(filter(None, (self.place, self.statement))))

    @property
    def statement(self) -> str:
        """The line without the place: "expected a number, got 'x'"."""
        hint = f"; {self.hint}" if self.hint else ""
        if self.problem:
            return self.problem + hint
        why = f"{'' if self.why[:1] in ('', ',') else ' '}{self.why}"
        return f"expected {self.expected}{why}, got {self.got}{hint}"

    @property
    def fields(self) -> dict[str, Any]:
        """The constructor's arguments, name -> value."""
        return {name: getattr(self, name) for name in _FIELDS}

    def but(self, **fields: Any) -> "InputError":
        """A copy with other values of these fields."""
        return InputError(**self.fields | fields)

    def within(self, place: object) -> "InputError":
        """A copy with an enclosing place prepended."""
        return self.but(place=f"{place}: {self.place}" if self.place else place)

    def inside(self, place: object) -> "InputError":
        """A copy with the enclosing place removed."""
        return self.but(place=self.place.removeprefix(str(place)).removeprefix(": "))

    def hinted(self, hint: str) -> "InputError":
        """A copy with a hint appended."""
        return self.but(hint="; ".join(filter(None, (self.hint, hint))))


_FIELDS = ("place", "expected", "got", "why", "problem", "hint", "keys")


class MissingValueError(InputError):
    """A required value is missing from the rig; `letter` is its symbol in the paper."""

    def __init__(self, *args: Any, letter: str = "", **fields: Any) -> None:
        super().__init__(*args, **fields)
        self.letter = letter


def together(place: object, errors: Iterable[InputError]) -> InputError:
    """Combine the errors of a place into one."""
    return InputError(place, problem="; ".join(map(str, errors)))


def meant(name: object, known: Iterable[str]) -> str:
    """Return a hint naming the closest known name; empty if none is close."""
    spelled = {_plain(one): one for one in reversed(list(known))}
    close = difflib.get_close_matches(_plain(name), spelled, 1)
    return f"; did you mean {spelled[close[0]]!r}?" if close else ""


def _plain(name: object) -> str:
    """A name without case, hyphens, spaces and underscores, which are mistyped most often."""
    return str(name).lower().translate(_APART)


_APART = str.maketrans("", "", "-_ ")


def counted(number: int, what: str) -> str:
    """Return a count with its noun: "1 joint", "2 joints"."""
    return f"{number} {what}{'' if number == 1 else 's'}"


def so_more(number: int) -> str:
    """Return the suffix of a message that applies to others as well: ", and so 2 more"; "" for none."""
    return f", and so {number} more" if number else ""


def few(names: Iterable[object], most: int = 12) -> str:
    """Join names for a message: the first few, and the number omitted."""
    shown = [str(name) for name in names]
    rest = f" and {len(shown) - most} more" if len(shown) > most else ""
    return ", ".join(shown[:most]) + rest


# Paths from the user, and the folders of the derivations and templates.
#
# Derivations and templates are inside an installed package, or next to it in a clone.


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
