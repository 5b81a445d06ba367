"""`eccentric compare`: models on the same rows of a log."""

import argparse
from pathlib import Path

import eccentric
from eccentric.cli.arguments import LONG, add_rig, bar, log_suffixes, write_and_print
from eccentric.core import own_folder

NAME = "compare"
HELP = (
    "fit models, with or without added effects, to the same rows of a log, and compare their held-out errors"
)
EXAMPLE = """eccentric compare LOG --rig RIG c2_parallel c2_asymmetric 'c2_parallel+stribeck[d=1]+cogging'
eccentric compare LOG --rig RIG c2_parallel my_derivation.py --out build/compared"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `compare` to `parser`."""
    add = parser.add_argument
    add("log", metavar="LOG", help=f"log of the rig: {log_suffixes()}; {LONG}")
    add(
        "models",
        metavar="MODEL[+EFFECT...]",
        nargs="+",
        help="model name, or path of a derivation, with the effects to add",
    )
    add_rig(parser)
    add("--effects", metavar="FILE", type=Path, help="Python file with your own effects")
    add("--json", action="store_true", help="print the result as JSON")
    add("--out", metavar="DIR", type=Path, help="folder for compare.json, compare.png and compare.svg")


def run(args: argparse.Namespace) -> int:
    """Compare, print the table or JSON, write the folder if there is one; return 0."""
    if args.out is not None:
        own_folder(args.out)
    found = eccentric.compare(args.log, args.rig, args.models, args.effects, reading=bar())
    write_and_print(found, args.out, as_json=args.json)
    return 0
