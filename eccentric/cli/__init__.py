"""The command line: `eccentric COMMAND`, one module of this package per command.

A command's module has NAME, HELP (one line), EXAMPLE (command lines to copy), `configure(parser)`, which
adds its arguments, and `run(arguments)`, which returns the exit status. It is imported only when its command
is given, so help and version do not import SymPy.

Exit status: 0, or what `run` returns: 1 if `fit` or `diagnose` has written its result and the log does not
fit the rig, if `fleet` has done what it could and names the rest, or if a check failed; 2 with one line on
stderr for bad input; 130 after an interrupt, 143 after SIGTERM, 129 after SIGHUP, none of which leaves
anything half written; 141 if the reader of a pipe has closed it.
"""

import argparse
import ast
import gc
import os
import sys
import textwrap
import warnings
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import NoReturn

from eccentric.cli.arguments import coloured
from eccentric.core import (
    UNREAD,
    Ended,
    InputError,
    ended_by_signals,
    escape_unprintable,
    meant,
    nobody_reads,
)
from eccentric.version import __version__

_OBJECTS = 2_000_000
"""New objects between two searches for reference cycles."""
_DESCRIPTION = "Derive, emit, fit and diagnose friction models for drives that swing an unbalanced mass."

COMMANDS = (
    "derive",
    "audit",
    "figures",
    "emit",
    "export",
    "rig",
    "fit",
    "diagnose",
    "compare",
    "simulate",
    "plan",
    "adapt",
    "fleet",
    "bench",
    "doctor",
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command line and return its exit status.

    Args:
        argv: the arguments after the program's name; by default those of the process.

    Raises:
        SystemExit: with status 0, after `--help` and `--version`.
    """
    arguments = list(sys.argv[1:] if argv is None else argv)
    if argv is None:
        # A command makes 1.5 million objects, most of them while importing, and hardly any reference cycles:
        # a search after every 700 new objects, the default, takes a twentieth of its time.
        gc.set_threshold(_OBJECTS)
    escape_unprintable()
    formatwarning, warnings.formatwarning = warnings.formatwarning, _one_line_warning
    try:
        with ended_by_signals(to_the_end=argv is None):
            if argv is None and "_ARGCOMPLETE" in os.environ:  # set by the shell while it completes
                _complete()
            parsed = _parser(arguments).parse_args(arguments)
            status = parsed.run(parsed)
            if sys.stdout is not None:  # as in a service without one
                sys.stdout.flush()
    except InputError as error:
        return _complain(str(error), 2)
    except Ended as ended:
        return _complain(f"ended by {ended}", 128 + ended.number)
    except KeyboardInterrupt as interrupt:
        return _complain(": ".join(["interrupted", *map(str, interrupt.args)]), 130)
    except BrokenPipeError:
        nobody_reads()
        return UNREAD
    except MemoryError:
        return _complain("not enough memory: use a shorter log, or raise the limit", 2)
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        return _complain(f"{place}{error.strerror or error}", 2)
    finally:
        warnings.formatwarning = formatwarning
    return status


def _complete() -> None:
    """Answer the shell, which asks how its line goes on, and exit; without argcomplete do nothing."""
    with suppress(ImportError):
        argcomplete = import_module("argcomplete")
        # The words before the one that is completed; an unfinished quotation has no command to look up.
        words = os.environ.get("COMP_LINE", "").split()[1:]
        argcomplete.autocomplete(_parser(words if words and words[0] in COMMANDS else []))


class _Parser(argparse.ArgumentParser):
    """An argument parser whose errors are one line."""

    def error(self, message: str) -> NoReturn:
        """Raise instead of printing the usage and exiting."""
        raise InputError(f"{message} (see {self.prog} --help)")


def _parser(arguments: Sequence[str]) -> _Parser:
    """Return the parser: for the command that `arguments` name, else with one line per command."""
    layout = argparse.RawDescriptionHelpFormatter
    parser = _Parser(prog="eccentric", description=_DESCRIPTION, allow_abbrev=False, formatter_class=layout)
    parser.add_argument("--version", action="version", version=f"eccentric {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    given = next((argument for argument in arguments if not argument.startswith("-")), None)
    if given not in COMMANDS:
        for name in COMMANDS:
            commands.add_parser(name, help=_help(name))
        if given is not None and (hint := meant(given, COMMANDS)):
            parser.error(f"unknown command {given!r}{hint}")
        return parser
    module = import_module(f"eccentric.cli.{given}")
    epilog = "example:\n" + textwrap.indent(module.EXAMPLE.strip(), "  ")
    command = commands.add_parser(
        module.NAME, description=module.HELP, epilog=epilog, allow_abbrev=False, formatter_class=layout
    )
    module.configure(command)
    command.set_defaults(run=module.run)
    return parser


def _help(command: str) -> str:
    """Return the HELP of a command's module, read from the source to avoid its imports."""
    source = Path(__file__).with_name(f"{command}.py").read_text(encoding="utf-8")
    assignments = (node for node in ast.parse(source).body if isinstance(node, ast.Assign))
    (value,) = (node.value for node in assignments if ast.unparse(node.targets[0]) == "HELP")
    return ast.literal_eval(value).replace("%", "%%")


def _one_line_warning(message: Warning | str, *_: object, **__: object) -> str:
    return f"eccentric: warning: {_line(message)}\n"


def _complain(message: str, status: int) -> int:
    """Print one line on stderr and return `status`."""
    with suppress(OSError):  # after SIGHUP there may be no terminal any more
        prefix = f"eccentric:{' error:' if status == 2 else ''}"
        print(f"{coloured(prefix, 'error', sys.stderr)} {_line(message)}", file=sys.stderr)
    return status


def _line(message: object) -> str:
    return " ".join(str(message).split())
