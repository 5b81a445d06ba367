"""TOML and JSON files and their entries: numbers, tables, allowed keys.

`where` (file and key) begins the message of every InputError.
"""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from eccentric.core.errors import InputError, meant, readable


def read_document(path: Path, what: str) -> Mapping[str, Any]:
    """Return the content of a TOML or JSON file; `what` names it in messages, such as "a rig file".

    Raises InputError for any other suffix, a missing or invalid file, and a repeated key.
    """
    parsers: dict[str, Callable[[str], Any]] = {
        ".toml": tomllib.loads,
        ".json": lambda text: json.loads(text, object_pairs_hook=lambda pairs: _no_repeats(pairs, path)),
    }
    if path.suffix.lower() not in parsers:
        raise InputError(path, f"{what} .toml or .json", f"{path.suffix or 'no suffix'!r}")
    text = read_utf8(path)
    try:
        content = parsers[path.suffix.lower()](text)
    except InputError:
        raise
    except (ValueError, RecursionError) as error:
        line, place = _stopped_at(text, str(error))
        if re.search("overwrite|twice|[Dd]uplicate", str(error)):
            raise InputError(path, "each key and table only once", f"{line!r} again in {place}") from None
        if re.search(r"[=:]\s*[-+]?\d+,\d+\s*(?:#.*)?$", line):
            raise InputError(path, "a decimal point", f"{line!r} in {place}") from None
        if unquoted := re.match(r"(\S+)\s*=\s*([-+.\deE]+\s*(?:[^\W\d_]|/)[^#]*?)\s*(?:#.*)?$", line):
            key, value = unquoted.groups()
            what = "a ratio" if re.fullmatch(r"[\d./\s]+", value) else "a value with its unit"
            wanted = f'expected {what} in quotes, {key} = "{value}"'
            raise InputError(path, problem=f"{wanted}, got {line!r} in {place}") from None
        if word := re.match(r"(\S+)\s*=\s*([^\W\d]\w*)\s*(?:#.*)?$", line):
            truth = word[2].lower() in ("true", "false")
            what = "true or false in small letters" if truth else "a text in quotes"
            wanted = f"expected {what}, {word[1]} = " + (word[2].lower() if truth else f'"{word[2]}"')
            raise InputError(path, problem=f"{wanted}, got {line!r} in {place}") from None
        # ValueError: for example a number with thousands of digits
        raise InputError(path, problem=f"not valid {path.suffix[1:].upper()}: {error}") from None
    return read_table(content, str(path))


def _stopped_at(text: str, error: str) -> tuple[str, str]:
    """The line where a parser stopped, and its place, "line 3"; both empty if the message names none."""
    lines = text.splitlines()
    place = re.search(r"\bline (\d+)", error.replace("(at end of document)", f"line {len(lines)}"))
    if place is None or not 0 < int(place[1]) <= len(lines):
        return "", ""
    return lines[int(place[1]) - 1].strip(), place[0]


def read_utf8(path: Path) -> str:
    """Return the text of a file; InputError if it is missing, unreadable or not UTF-8."""
    try:
        return readable(path).read_text(encoding="utf-8-sig")
    except OSError as error:
        raise InputError(path, problem=f"cannot be read ({error.strerror or error})") from None
    except UnicodeDecodeError as error:
        raise InputError(path, problem=f"expected UTF-8 text, but byte {error.start} is not") from None


def _no_repeats(pairs: list[tuple[str, Any]], path: Path) -> dict[str, Any]:
    keys = [key for key, _ in pairs]
    twice = next((key for key in keys if keys.count(key) > 1), None)
    if twice is not None:
        raise InputError(path, "each key", f"{twice!r} twice", why="only once")
    return dict(pairs)


def read_number(value: object, where: str, lower: float = -math.inf, open_below: bool = False) -> float:
    """Return a finite number, at least (or above) `lower`; InputError for anything else, including true."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(where, "a number", f"{value!r}")
    number = float(value) if abs(value) < 1e300 else math.inf
    if not math.isfinite(number) or number < lower or (open_below and number == lower):
        bound = "" if math.isinf(lower) else f" {'above' if open_below else 'of at least'} {lower:g}"
        raise InputError(where, f"a finite number{bound}", f"{value!r}")
    return number


def read_table(value: object, where: str) -> Mapping[str, Any]:
    """Return a value that must be a table; InputError for anything else."""
    if not isinstance(value, dict):
        raise InputError(where, "a table", f"{value!r}")
    return value


def refuse_unknown(keys: Iterable[str], allowed: Iterable[str], where: str) -> None:
    """Raise InputError for the first key that is not allowed, suggesting the closest allowed one."""
    allowed = list(allowed)
    for key in keys:
        if key not in allowed:
            hint = meant(key, allowed) or f"; known are {', '.join(allowed)}"
            raise InputError(where, problem=f"unknown key {key!r}{hint}", keys=(key,))
