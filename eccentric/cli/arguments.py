"""Arguments shared by several commands."""

import argparse
import os
import re
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO
from warnings import catch_warnings, simplefilter

from eccentric.core import InputError

# Colour, where a terminal has it: https://no-color.org is respected, and a file or pipe gets none.


_CODES = {"error": "31", "warning": "33", "good": "32", "answer": "1"}


def coloured(text: str, kind: str, stream: TextIO | None = None) -> str:
    """The text as an "error", "warning", "good" news or the "answer" on this stream, by default stdout."""
    if not _has_colour(sys.stdout if stream is None else stream):
        return text
    return f"\x1b[{_CODES[kind]}m{text}\x1b[0m"


def _has_colour(stream: TextIO | None) -> bool:
    """Whether a stream is a terminal that shows colour, and nobody asked for none."""
    if stream is None or os.environ.get("NO_COLOR") or os.environ.get("TERM", "dumb") == "dumb":
        return False
    return stream.isatty()


EVERY_S = 10.0
"""Progress is told so often where it is kept in a file: a run of an hour leaves a page."""
MISFIT = 1
"""Exit status of a fit or diagnosis that has written its result, and whose log does not fit the rig."""
_STATUS = (
    f"exit status: 0 on success; {MISFIT} if the result is written but the log does not fit the rig;"
    " 2 on bad input"
)


def log_suffixes() -> str:
    """The suffixes of all formats of logs, for help pages."""
    from eccentric.logs import FORMATS

    return ", ".join(f"{s}{'[.gz]' if one.gzipped else ''}" for one in FORMATS for s in one.suffixes)


LONG = "beyond 100,000 rows in all, only windows are used (see docs/long-logs.md)"
"""Of the logs, on help pages."""


def add_logs(parser: argparse.ArgumentParser, nargs: str = "+") -> None:
    """Add the inputs of a fit: logs, their rig, and the model."""
    parser.add_argument("logs", metavar="LOG", nargs=nargs, help=f"logs of one rig: {log_suffixes()}; {LONG}")
    add_rig(parser)
    parser.description = f"{parser.description}\n\n{_STATUS}"
    add_model(parser)


def add_rig(parser: argparse.ArgumentParser) -> None:
    """Add the rig file."""
    add = parser.add_argument
    add("--rig", metavar="RIG", required=True, help="rig file, .toml or .json (see docs/rig.md)")


def add_model(parser: argparse.ArgumentParser) -> None:
    """Add the model to fit."""
    parser.add_argument(
        "--model",
        metavar="MODEL",
        help="model name, or path of a derivation (default: the model for the rig's case)",
    )


def add_folder(parser: argparse.ArgumentParser, files: str) -> None:
    """Add the output folder for these files."""
    parser.add_argument(
        "--out",
        metavar="DIR",
        type=Path,
        required=True,
        help=f"folder for {files}; must be new, empty, or written by eccentric, and not the current"
        " directory. Files from an earlier run of this command are replaced, all others are kept; those of"
        " another command are never overwritten",
    )


def arm_of(rig: str, given: Mapping[str, object]) -> bool:
    """Whether a rig names an arm. InputError for an option that only one drive has: its name and value."""
    from eccentric.rigs import names_arm

    try:
        if not names_arm(rig):
            return False
    except InputError:
        return False  # what reads it in its turn says why
    if asked := [name for name, value in given.items() if value]:
        raise InputError(asked[0], problem=f"expected the rig of a single drive with it, {rig} names an arm")
    return True


def progress() -> Callable[[str], None] | None:
    """Progress by stage: each on a terminal, elsewhere the latest one, at most every ten seconds."""
    if sys.stderr is not None and sys.stderr.isatty():
        return lambda line: print(f"  {line}", file=sys.stderr)
    return None if _silent() else _now_and_then()


def _silent() -> bool:
    """Whether nobody reads lines in a file, or somebody compares it."""
    return sys.stderr is None or os.environ.get("ECCENTRIC_PROGRESS", "").lower() == "off"


def _now_and_then() -> Callable[[str], None]:
    """Print a line with the seconds gone, if the last one is ten seconds old: for a log of a scheduler."""
    begun = told = time.monotonic()

    def show(line: str) -> None:
        nonlocal told
        if (now := time.monotonic()) - told >= EVERY_S:
            told = now
            print(f"eccentric: {now - begun:.0f} s: {line}", file=sys.stderr, flush=True)

    return show


def bar() -> Callable[..., None] | None:
    """A bar with the time left on a terminal, gone when all is done; elsewhere a line every ten seconds.

    It takes the part that is done, and of what: a stage has a time of its own.
    """
    if sys.stderr is None or not sys.stderr.isatty():
        return None if _silent() else _in_lines()
    left_of, widest = _time_left(), 0

    def show(part: float, what: str = "") -> None:
        nonlocal widest
        filled, left = round(30 * part), left_of(part, what)
        name = what and f"{what:12} "
        shown = f"  {name}[{'#' * filled}{'.' * (30 - filled)}] {part:.0%}, {left:.0f} s left"
        widest = max(widest, len(shown))
        shown = shown.ljust(widest) if part < 1.0 else " " * widest + "\r"
        print(f"\r{shown}", end="", file=sys.stderr, flush=True)

    return show


def _in_lines() -> Callable[..., None]:
    """The bar's numbers in words."""
    say, left_of = _now_and_then(), _time_left()

    def show(part: float, what: str = "") -> None:
        left = left_of(part, what)
        if part < 1.0:
            say(f"{what + ' ' if what else ''}{part:.0%}, {left:.0f} s left")

    return show


def _time_left() -> Callable[[float, str], float]:
    """Takes the part of a stage that is done to the seconds left.

    A stage begins where it tells that nothing is done, else where the one before has ended.
    """
    begun: dict[str, float] = {}
    last = time.monotonic()

    def left(part: float, what: str) -> float:
        nonlocal last
        before, last = last, time.monotonic()
        start = begun.setdefault(what, before if part > 0.0 else last)
        return (last - start) * max(1.0 / max(part, 1e-9) - 1.0, 0.0)

    return left


def take_after_options(parser: argparse.ArgumentParser) -> None:
    """Let the last arguments, of which there may be none, stand after options: `LOG --rig RIG MODEL`.

    argparse counts them as given, none, with the first arguments before an option.
    """
    plain = parser.parse_known_args

    def parse(*given: Any, **named: Any) -> Any:
        parser.parse_known_args = plain
        try:
            return parser.parse_known_intermixed_args(*given, **named)
        finally:
            parser.parse_known_args = parse

    parser.parse_known_args = parse


def names_in(given: Iterable[str]) -> list[str]:
    """The names in options that take several, separated by commas; those inside brackets do not separate."""
    parts = (re.split(r",(?![^\[]*\])", text) for text in given)
    return [name.strip() for names in parts for name in names if name.strip()]


@contextmanager
def options(*arguments: str, **others: str) -> Iterator[None]:
    """Let errors about an argument name its option: `--` and its name, for `others` another one."""
    named = {name: f"--{re.sub('[_ ]', '-', name)}" for name in arguments} | others
    try:
        yield
    except InputError as error:
        place = error.place
        name = next((n for n in named if place == n or place.startswith((f"{n}:", f"{n} "))), None)
        raise error if name is None else error.but(place=named[name] + place[len(name) :]) from None


def write_and_print(found: Any, out: Path | None, *, as_json: bool = False) -> None:
    """Write a result into its folder, if there is one, and print it: warnings, summary or JSON, files."""
    names = [] if out is None else [path.name for path in found.write(out)]
    print_warnings(found.warnings)
    print(found.to_json() if as_json else found.summary(), end="" if as_json else "\n")
    if names and not as_json:
        print(f"{out}: {', '.join(names)}")


@contextmanager
def warnings_printed() -> Iterator[None]:
    """Print what is a UserWarning in Python, each as one line on stderr."""
    with catch_warnings(record=True) as caught:
        simplefilter("always", UserWarning)
        try:
            yield
        finally:
            print_warnings(str(one.message) for one in caught if one.category is UserWarning)


def print_warnings(warnings: Iterable[str]) -> None:
    """Print each as one line on stderr."""
    for warning in warnings:
        prefix = coloured("eccentric: warning:", "warning", sys.stderr)
        print(f"{prefix} {warning}", file=sys.stderr)
