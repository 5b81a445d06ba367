"""A rig as a file: TOML or JSON, read as one table."""

from __future__ import annotations

import json
import tomllib
from typing import TYPE_CHECKING, Any

from eccentric.errors import InputError
from eccentric.places import readable
from eccentric.rigs.entries import read_table

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

__all__ = ["read_file"]


def read_file(path: Path) -> Mapping[str, Any]:
    """Return the content of a TOML or JSON file.

    Raises InputError for any other suffix, a file that is missing or damaged, and a repeated key.
    """
    parsers: dict[str, Callable[[str], Any]] = {
        ".toml": tomllib.loads,
        ".json": lambda text: json.loads(text, object_pairs_hook=lambda pairs: _no_repeats(pairs, path)),
    }
    if path.suffix.lower() not in parsers:
        raise InputError(
            f"{path}: a rig file .toml or .json is required, received {path.suffix or 'no suffix'!r}"
        )
    try:
        content = parsers[path.suffix.lower()](readable(path).read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: UTF-8 text is required, byte {error.start} is not") from None
    except InputError:
        raise
    except (ValueError, RecursionError) as error:  # ValueError: for example a number with thousands of digits
        raise InputError(f"{path}: not valid {path.suffix[1:].upper()}: {error}") from None
    return read_table(content, str(path))


def _no_repeats(pairs: list[tuple[str, Any]], path: Path) -> dict[str, Any]:
    keys = [key for key, _ in pairs]
    twice = next((key for key in keys if keys.count(key) > 1), None)
    if twice is not None:
        raise InputError(f"{path}: each key is required only once, received {twice!r} twice")
    return dict(pairs)
