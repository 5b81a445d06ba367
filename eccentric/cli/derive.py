"""`eccentric derive`: print the derivations and write what follows from them."""

import argparse
from pathlib import Path

import eccentric
from eccentric.emit import complete, differences, write
from eccentric.emit.names import checked_name
from eccentric.errors import InputError
from eccentric.model import load_model, model_names
from eccentric.output import folder_to_write

NAME = "derive"
HELP = "print the derivations and write generated/ (NumPy and C99)"
EXAMPLE = """eccentric derive
eccentric derive c2_parallel --latex
eccentric derive --check"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "models", nargs="*", metavar="MODEL", help="names of models, or paths of derivations; default: all"
    )
    parser.add_argument("--latex", action="store_true", help="print LaTeX instead of text")
    parser.add_argument("--out", type=Path, help="folder to write into; default: generated/ of the clone")
    parser.add_argument(
        "--check", action="store_true", help="write nothing; show what is stale, exit 1 if anything is"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the trios of the derivations, then print these; with --check compare instead."""
    models = [load_model(name) for name in arguments.models or model_names()]
    for model in models:
        checked_name(model.name, f"model {model.name}: its name")
    out = arguments.out or _generated()
    if arguments.check:
        diffs = [differences(complete(model), out) for model in models]
        print("".join(diffs), end="")
        if any(diffs):
            print("generated files are stale: write them again with `make derive`")
            return 1
        print(f"generated files are fresh: {len(models)} models")
        return 0
    folder_to_write(out)
    # All are rendered before the first is written: one that cannot be leaves the folder as it was.
    files = {name: text for model in models for name, text in complete(model).items()}
    write(files, out)
    for model in models:
        print(model.latex() if arguments.latex else model, end="\n\n")
    return 0


def _generated() -> Path:
    clone = Path(eccentric.__file__).resolve().parent.parent
    if not (clone / "pyproject.toml").is_file():
        raise InputError(
            "derive: required --out DIR, since this is an installed copy without a generated/ folder"
        )
    return clone / "generated"
