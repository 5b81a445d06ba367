"""`eccentric emit`: the files of any model for chosen targets, with the parameters of a fit if wanted."""

import argparse
from dataclasses import replace
from pathlib import Path

from eccentric.cli.arguments import add_folder
from eccentric.emission import BACKENDS, DEFAULT, checked_name, complete, read_parameters, with_fitted, write
from eccentric.errors import InputError
from eccentric.model import load_model
from eccentric.output import whole_folder

NAME = "emit"
HELP = "write the NumPy module, C header and C source of a model, and the files that check the C"
EXAMPLE = """eccentric emit c2_parallel --out build/firmware
eccentric emit my_derivation.py --out build/mine
eccentric emit c2_parallel --backend numpy --out build/python
eccentric emit c2_parallel --parameters build/fit/fit.json --prefix arm --out build/firmware"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument("model", metavar="MODEL", help="a model's name, or the path of a derivation")
    add_folder(parser, "the files of the model")
    parser.add_argument(
        "--parameters", type=Path, metavar="FIT.json", help="fitted values, which become the defaults"
    )
    parser.add_argument(
        "--prefix", metavar="NAME", help="name of the files and prefix in C; default: the model's name"
    )
    parser.add_argument(
        "--backend",
        action="append",
        metavar="NAME",
        help="a target, numpy or c99; may be repeated; default: both",
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the files and name them."""
    model = load_model(arguments.model)
    own = Path(arguments.model).suffix == ".py"
    origin = Path(arguments.model).name if own else f"derivations/{model.name}.py"
    where = f"model {arguments.model}: its name" if arguments.prefix is None else "--prefix"
    name = checked_name(model.name if arguments.prefix is None else arguments.prefix, where)
    if arguments.parameters is None:
        model = replace(model, name=name)
    else:
        model = with_fitted(model, read_parameters(arguments.parameters), name)
    files = complete(model, "eccentric emit", origin, _backends(arguments.backend))
    with whole_folder(arguments.out, f"{NAME} {name}") as folder:
        written = write(files, folder)
        names = [path.relative_to(folder).as_posix() for path in written]
    print(f"{arguments.out}: {', '.join(names)}")
    return 0


def _backends(given: list[str] | None) -> tuple[str, ...]:
    """The names of the back ends, each once."""
    for name in given or ():
        if name not in BACKENDS:
            raise InputError(f"--backend: required one of {', '.join(BACKENDS)}, received {name!r}")
    return tuple(dict.fromkeys(given or DEFAULT))
