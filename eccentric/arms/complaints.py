"""Joints and chains name themselves in what they refuse; the file is added here."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from eccentric.errors import InputError


@contextmanager
def complaints_of(where: str) -> Iterator[None]:
    """Put the file before the message of an InputError."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
