"""A rig as a file: TOML or JSON, read as one table."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from eccentric.entries import read_document

__all__ = ["read_file"]


def read_file(path: Path) -> Mapping[str, Any]:
    """Return the content of a TOML or JSON file.

    Raises InputError for any other suffix, a file that is missing or damaged, and a repeated key.
    """
    return read_document(path, "a rig file")
