"""The one error a user sees: one line that names what was wrong, what was required, what was received."""

from collections.abc import Iterable


class InputError(ValueError):
    """Bad input from outside: a log, a rig, a parameter, a command line.

    The message is one line: the file, row, column or quantity, what was required and what was received.
    The command line prints it after `eccentric: error:` and exits with status 2; nothing is written.
    """


def few(names: Iterable[object], most: int = 12) -> str:
    """Join the names for a message: the first few, and how many more there are."""
    shown = [str(name) for name in names]
    rest = f" and {len(shown) - most} more" if len(shown) > most else ""
    return ", ".join(shown[:most]) + rest
