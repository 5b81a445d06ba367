"""The door for arms: a file by its suffix."""

from __future__ import annotations

import os

from eccentric.arms.arm_file import arm_of
from eccentric.arms.complaints import complaints_of
from eccentric.arms.masses import require_mass
from eccentric.arms.urdf import joints_of_urdf, without_tip
from eccentric.entries import read_document
from eccentric.errors import InputError
from eccentric.model import Chain
from eccentric.places import given_path, shown


def read_arm(source: str | os.PathLike[str], tip: str | None = None) -> Chain:
    """Read an arm.

    Args:
        source: path of an arm file, `.toml` or `.json`, or of a URDF, `.urdf`. The last link of the arm in a
            URDF can follow behind `#`, as in "panda.urdf#panda_hand".
        tip: this last link; the joints on the way to it move, all others are locked at 0.

    Returns:
        The chain, in SI. Its joints have the names of the file; its parameters are what the file keeps
        symbolic, with the numbers of the file as defaults.

    Raises:
        InputError: one line with file, joint and quantity, what is required and what was received.
    """
    path = given_path(source, "arm")
    if tip is None:
        path, tip = without_tip(path)
    where = shown(path)
    if path.suffix.lower() == ".urdf":
        name, read = joints_of_urdf(path, where, tip)
        with complaints_of(where):
            chain = Chain(name, [one.joint for one in read], [one.body for one in read])
            require_mass(chain)
        return chain
    if tip is not None:
        raise InputError(f"{where}: a .urdf is required for a tip, received {tip!r}")
    content = read_document(path, "an arm file, .urdf,")
    if str(content.get("format", "")).startswith("eccentric-"):
        raise InputError(
            f"{where}: an arm file is required, received a result ({content['format']}): emit the model.py"
            " beside a diagnosis.json, or a model with --parameters FIT.json"
        )
    return arm_of(content, path, where)
