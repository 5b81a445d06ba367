"""Printed output. It may be read in part: a reader that closes the pipe is not an error."""

import io
import os
import sys

UNREAD = 141
"""Exit status of a program whose reader has closed the pipe, as if ended by SIGPIPE: 128 + 13."""


def escape_unprintable() -> None:
    """Let stdout print characters that its encoding lacks as escapes, as stderr does: an ASCII terminal."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


def show(what: object) -> None:
    """Print; if the reader of a pipe has closed it, exit quietly with status 141."""
    escape_unprintable()
    try:
        print(what, flush=True)
    except BrokenPipeError:
        nobody_reads()
        sys.exit(UNREAD)


def nobody_reads() -> None:
    """Discard stdout: the interpreter flushes it again at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
