"""The command line reference: what `--help` of every command prints."""

from __future__ import annotations

import contextlib
import io
import os

from eccentric import cli


def sections() -> str:
    """A section for the program and one for each of its commands."""
    commands = "\n\n".join(f"## eccentric {name}\n\n{_help(name, '--help')}" for name in cli.COMMANDS)
    return f"{_help('--help')}\n\n{commands}\n"


def _help(*arguments: str) -> str:
    """What the command line prints, at the width of a page and without colours."""
    shown, before = io.StringIO(), dict(os.environ)
    os.environ |= {"COLUMNS": "92", "NO_COLOR": "1"}
    try:
        with contextlib.redirect_stdout(shown), contextlib.suppress(SystemExit):
            cli.main(arguments)
    finally:
        os.environ.clear()
        os.environ.update(before)
    return f"```text\n{shown.getvalue().rstrip()}\n```"
