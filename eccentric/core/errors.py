"""The one error a user sees: one line with the place, what was expected and what came."""

import difflib
from collections.abc import Iterable, Sequence
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
