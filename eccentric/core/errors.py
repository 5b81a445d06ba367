"""The one error a user sees: one line that names what was wrong, what was required, what was received."""

import difflib
from collections.abc import Iterable


class InputError(ValueError):
    """Bad input from outside: a log, a rig, a parameter, a command line.

    It is one line, which the command line prints after `eccentric: error:`, to exit with status 2; nothing is
    written.

    Attributes:
        place: what is wrong, from the outside in, such as file, table and key, row and column:
            "rig.toml: [known] k_i"; "" if it is not said apart.
        expected, got: what is required there, and what was received.
    """

    def __init__(
        self, place: object, expected: str = "", got: object = "", *, why: str = "", plural: bool = False
    ) -> None:
        """One that is not about a value has its whole line for a place.

        why: after what is expected, why it is or how it is given: "to draft a rig", ", as in 1 kg"; plural:
            several things are expected.
        """
        self.place, self.expected, self.got = (str(place) if expected else ""), expected, str(got)
        self.why, self.plural = why, plural
        before = f"{self.place}: " if self.place else ""
        required = f"{'are' if plural else 'is'} required{'' if why[:1] in ('', ',') else ' '}{why}"
        super().__init__(f"{before}{expected} {required}, received {got}" if expected else str(place))

    def within(self, place: object) -> "InputError":
        """The same error, with the place that its own is in before it."""
        if not self.expected:
            return InputError(f"{place}: {self}")
        inner = f"{place}: {self.place}" if self.place else place
        return InputError(inner, self.expected, self.got, why=self.why, plural=self.plural)


class MissingValueError(InputError):
    """A value that the rig does not give and that is required; `letter` is the paper's."""

    def __init__(
        self,
        place: object,
        expected: str = "",
        got: object = "",
        *,
        why: str = "",
        plural: bool = False,
        letter: str = "",
    ) -> None:
        super().__init__(place, expected, got, why=why, plural=plural)
        self.letter = letter


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
