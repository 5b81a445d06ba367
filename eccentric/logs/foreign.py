"""Readers of other projects' formats by their libraries: whatever those raise or print becomes one line.

A damaged file can lead a library anywhere. None of the readers that use this runs what a file contains:
pickles, attachments and formulas in it are left out, with a note.
"""

from __future__ import annotations

import contextlib
import gc
import importlib
import io
import logging
import sys
import traceback
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from eccentric.errors import InputError

__all__ = ["library", "reading"]


def library(name: str, extra: str, path: Path) -> Any:
    """Import the library of a format; InputError, which names the extra, if it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        raise InputError(
            f"{path}: {name.partition('.')[0]} is required for {path.suffix}:"
            f' pip install "eccentric[{extra}]"'
        ) from None


def _cleared(error: BaseException) -> None:
    """Let go of what a library had half built: some of it complains when it is cleared away later."""
    before, sys.unraisablehook = sys.unraisablehook, lambda _: None
    try:
        traceback.clear_frames(error.__traceback__)
        gc.collect()
    finally:
        sys.unraisablehook = before


@contextlib.contextmanager
def reading(path: Path, what: str) -> Iterator[None]:
    """Silence a library, and make one line of whatever it raises: "not a valid `what`"."""
    before = logging.root.manager.disable
    # What was there before is not looked at when the remains of a failure are collected.
    frozen = gc.get_freeze_count() == 0
    if frozen:
        gc.freeze()
    try:
        logging.disable(logging.CRITICAL)
        with (
            warnings.catch_warnings(),
            contextlib.redirect_stdout(io.StringIO()),
            contextlib.redirect_stderr(io.StringIO()),
        ):
            warnings.simplefilter("ignore")
            yield
    except (InputError, PermissionError):
        raise
    except MemoryError:
        raise InputError(f"{path}: not a valid {what} (it claims more values than fit in memory)") from None
    except Exception as error:  # noqa: BLE001 - libraries raise whatever a damaged file leads them into
        said = " ".join(str(error).split())[:200] or type(error).__name__
        _cleared(error)
        raise InputError(f"{path}: not a valid {what} ({said})") from None
    finally:
        logging.disable(before)
        if frozen:
            gc.unfreeze()
