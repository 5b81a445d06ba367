"""Messages of ROS 2 as objects: by the types that rosbags knows, and by definitions that a file brings along.

A definition is text that is parsed by a grammar of names and types; nothing in it is run.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from eccentric.logs.foreign import library

__all__ = ["Types"]


class Types:
    """The message types of one file."""

    def __init__(self, path: Path, extra: str) -> None:
        self._sys = library("rosbags.typesys", extra, path)
        self._store = self._sys.get_typestore(self._sys.Stores.ROS2_HUMBLE)

    def define(self, name: str, text: str) -> None:
        """Add a type by its definition, with those that it names in the same text."""
        if name not in self._store.types:
            found = self._sys.get_types_from_msg(text, name)
            self._store.register({key: value for key, value in found.items() if key not in self._store.types})

    def read(self, data: bytes, name: str) -> Any:
        """A message in CDR as an object with its fields as attributes; None for an unknown type."""
        if name not in self._store.types:
            return None
        return self._store.deserialize_cdr(data, name)
