"""The one error a user sees: a single line that names what was wrong, what was required and what came."""


class InputError(ValueError):
    """Bad input from outside: a log, a rig, a parameter, a command line.

    The message is one line and names the file, row, column or quantity, what was required and what came.
    The command line prints it after `eccentric: error:` and exits with status 2; nothing is written.
    """
