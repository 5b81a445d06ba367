"""The door for arms: a file by its suffix."""

from __future__ import annotations

import os
from pathlib import Path

from eccentric.arms.arm_file import arm_of
from eccentric.entries import read_document
from eccentric.model import Chain
from eccentric.places import given_path, shown


def read_arm(source: str | os.PathLike[str]) -> Chain:
    """Read an arm.

    Args:
        source: path of an arm file, `.toml` or `.json`.

    Returns:
        The chain, in SI. Its joints have the names of the file; its parameters are what the file keeps
        symbolic, with the numbers of the file as defaults.

    Raises:
        InputError: one line with file, joint and quantity, what is required and what was received.
    """
    path = given_path(source, "arm")
    where = shown(path)
    return arm_of(read_document(path, "an arm file"), where, Path(where).stem)
