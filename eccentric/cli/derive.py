"""`eccentric derive`: print the derivations and write the files generated from them."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path

import eccentric
from eccentric.core import InputError, folder_to_write

# The others depend on these, or contain them.
_FIRST = ("c1_perpendicular", "c2_parallel")

NAME = "derive"
HELP = "print the derivations and write generated/ (NumPy and C99)"
EXAMPLE = """eccentric derive
eccentric derive c2_parallel --latex
eccentric derive --check"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "models", nargs="*", metavar="MODEL", help="model names, or paths of derivations (default: all)"
    )
    parser.add_argument("--latex", action="store_true", help="print LaTeX instead of text")
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="output folder (default: generated/ of the clone)"
    )
    parser.add_argument(
        "--check", action="store_true", help="write nothing: show stale files, exit status 1 if there are any"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the files of the derivations, then print the derivations; with --check compare instead."""
    from eccentric.emission import checked_name, complete, differences, write
    from eccentric.model import load_model, model_names

    models = [load_model(name) for name in arguments.models or _in_reading_order(model_names())]
    for model in models:
        checked_name(model.name, f"model {model.name}: its name")
    out = arguments.out or _generated()
    if arguments.check:
        diffs = [differences(complete(model), out) for model in models]
        print("".join(diffs), end="")
        if any(diffs):
            print("generated files are stale: regenerate them with `make derive`")
            return 1
        print(f"generated files are fresh: {len(models)} models")
        return 0
    folder_to_write(out)
    # All are rendered before the first is written: if one fails, the folder is unchanged.
    files = {name: text for model in models for name, text in complete(model).items()}
    write(files, out)
    if not arguments.latex:
        print(_legend(models), end="")
    for model in models:
        print(model.latex() if arguments.latex else model, end="\n\n")
    written = (
        f"{arguments.out or out.name}/: {len(models)} model{'s' * (len(models) > 1)}, {len(files)} files"
    )
    print(f"% {written}" if arguments.latex else written)
    return 0


def _in_reading_order(names: Iterable[str]) -> list[str]:
    """The names of derivations, the paper's two cases first."""
    return sorted(names, key=lambda name: (name not in _FIRST, name))


def _legend(models: list[eccentric.Model]) -> str:
    """The numerically stable steps in the equations of the models, each with its formula."""
    import sympy as sp

    from eccentric.model import STEPS, meaning

    sides = [equation.right for model in models for equation in model.equations]
    used = {type(call): len(call.args) for side in sides for call in side.atoms(*STEPS)}
    letters = sp.symbols("x y z", real=True)
    calls = [step(*letters[: used[step]]) for step in STEPS if step in used]
    lines = [f"    {call} = {meaning(call)}" for call in calls]
    head = "Functions in these formulas; the code evaluates them in this order, so that no digits are lost:"
    return "\n".join([head, "", *lines, "", ""]) if lines else ""


def _generated() -> Path:
    clone = Path(eccentric.__file__).resolve().parent.parent
    if not (clone / "pyproject.toml").is_file():
        raise InputError(
            "derive",
            problem="expected --out DIR, since this is an installed copy without a generated/ folder",
        )
    return clone / "generated"
