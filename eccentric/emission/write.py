"""Write the emitted files of a model, and check whether written files are fresh."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Mapping
from pathlib import Path

from eccentric.core import whole_files
from eccentric.emission.backends import DEFAULT
from eccentric.emission.check import joints_of, render_check
from eccentric.emission.program import WHOLE, Choice
from eccentric.emission.render import render
from eccentric.model import Model
from eccentric.model import vocabulary as v


def complete(
    model: Model,
    command: str = "make derive",
    origin: str | None = None,
    backends: Collection[str] = DEFAULT,
    *,
    single_file: bool = False,
    choice: Choice = WHOLE,
) -> dict[str, str]:
    """The emitted files of a model and, in the folder `check`, those that check its C: name -> text.

    With fixed parameters there is nothing to compare bits with: the coefficients come from 50 digits, those
    that NumPy prepares from double precision. The self-test of the whole model calls the same functions.
    The checks know inputs with an entry for each joint: an arm with hidden states, or whose friction follows
    the time, has none.

    Raises:
        InputError: the model cannot be emitted.
    """
    files = render(model, command, origin, backends, single_file=single_file, choice=choice)
    of_one_number = bool(model.states) or v.t in model.inputs
    if "c99" not in backends or choice.fixed or (joints_of(model) and of_one_number):
        return files
    with_module = "numpy" in backends and not single_file
    whole = files if with_module else render(model, command, origin, choice=choice)
    return files | render_check(model, whole, arrays=choice.arrays != "none")


def write(files: Mapping[str, str], out: Path) -> list[Path]:
    """Write rendered files, name -> text, as one set; those that are already fresh are not touched.

    Returns:
        The paths, written or fresh.

    Raises:
        InputError: the folder cannot be written.
    """
    if any(_found(out / name) != text for name, text in files.items()):
        with whole_files(out) as new:
            for name, text in files.items():
                (new / name).parent.mkdir(parents=True, exist_ok=True)
                (new / name).write_text(text, encoding="utf-8", newline="\n")
    return [out / name for name in files]


def differences(files: Mapping[str, str], out: Path) -> str:
    """The unified diff from the files in the folder to the rendered ones; "" if they are the same."""
    diffs = []
    for name, text in files.items():
        diffs += difflib.unified_diff(
            _found(out / name).splitlines(keepends=True),
            text.splitlines(keepends=True),
            f"generated/{name}",
            f"derived/{name}",
        )
    return "".join(diffs)


def _found(path: Path) -> str:
    return path.read_text(encoding="utf-8") if path.is_file() else ""
