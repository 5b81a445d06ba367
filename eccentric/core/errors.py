"""The one error a user sees: one line that says where, what was expected and what came."""

import difflib
from collections.abc import Iterable, Sequence
from typing import Any


class InputError(ValueError):
    """Bad input from outside: a log, a rig, a parameter, a command line.

    The message is one line. The command line prints it after `eccentric: error:` and exits with status 2;
    nothing is written.

    Attributes:
        place: where the error is, from the outside in: file, table and key, row and column, as in "rig.toml:
            [known] k_i"; "" if `problem` says it.
        expected, got: what was expected there, and what came.
        why: why it was expected, or an example: "to draft a rig", ", as in 1 kg".
        problem: what is wrong, if no single value is; "" otherwise.
        hint: a fix or a likely cause.
        keys: the keys concerned, if the place does not end with one.
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
        """One without `expected` and `problem` has its whole line for a place: it is the problem."""
        if not expected and not problem:
            place, problem = "", str(place)
        self.place, self.expected, self.got = str(place), expected, str(got)
        self.why, self.problem, self.hint, self.keys = why, problem, hint, tuple(keys)
        super().__init__(": ".join(filter(None, (self.place, self.statement))))

    @property
    def statement(self) -> str:
        """The message without the place: "expected a number, got 'x'"."""
        hint = f"; {self.hint}" if self.hint else ""
        if self.problem:
            return self.problem + hint
        why = f"{'' if self.why[:1] in ('', ',') else ' '}{self.why}"
        return f"expected {self.expected}{why}, got {self.got}{hint}"

    @property
    def fields(self) -> dict[str, Any]:
        """Field name -> value."""
        return {name: getattr(self, name) for name in _FIELDS}

    def but(self, **fields: Any) -> "InputError":
        """The same error with these fields changed."""
        return InputError(**self.fields | fields)

    def within(self, place: object) -> "InputError":
        """The same error, its place preceded by the one that contains it."""
        return self.but(place=f"{place}: {self.place}" if self.place else place)

    def inside(self, place: object) -> "InputError":
        """The same error without this part of its place."""
        return self.but(place=self.place.removeprefix(str(place)).removeprefix(": "))

    def hinted(self, hint: str) -> "InputError":
        """The same error with a further hint."""
        return self.but(hint="; ".join(filter(None, (self.hint, hint))))


_FIELDS = ("place", "expected", "got", "why", "problem", "hint", "keys")


class MissingValueError(InputError):
    """A value that the rig does not give and that is required; `letter` is the paper's."""

    def __init__(self, *args: Any, letter: str = "", **fields: Any) -> None:
        super().__init__(*args, **fields)
        self.letter = letter


def together(place: object, errors: Iterable[InputError]) -> InputError:
    """Return all errors of a place as one."""
    return InputError(place, problem="; ".join(map(str, errors)))


def meant(name: object, known: Iterable[str]) -> str:
    """Return a hint at the known name closest to an unknown one; empty if none is close."""
    spelled = {_plain(one): one for one in reversed(list(known))}
    close = difflib.get_close_matches(_plain(name), spelled, 1)
    return f"; did you mean {spelled[close[0]]!r}?" if close else ""


def _plain(name: object) -> str:
    """A name without what is most often got wrong: case, hyphens, spaces and underscores."""
    return str(name).lower().translate(_APART)


_APART = str.maketrans("", "", "-_ ")


def counted(number: int, what: str) -> str:
    """Return a number of things for a message: "1 joint", "2 joints"."""
    return f"{number} {what}{'' if number == 1 else 's'}"


def so_more(number: int) -> str:
    """What follows a message that holds for so many others as well: ", and so 2 more", or nothing."""
    return f", and so {number} more" if number else ""


def few(names: Iterable[object], most: int = 12) -> str:
    """Join the names for a message: the first few, and how many more there are."""
    shown = [str(name) for name in names]
    rest = f" and {len(shown) - most} more" if len(shown) > most else ""
    return ", ".join(shown[:most]) + rest
