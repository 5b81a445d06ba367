"""`eccentric simulate`: the motion of fitted models under the log's own input, against the measured one."""

import argparse
from pathlib import Path

import eccentric
from eccentric.cli.arguments import add_rig, bar, log_suffixes, progress, take_after_options, write_and_print
from eccentric.core import own_folder

NAME = "simulate"
HELP = "drive fitted models with the input of a log, and compare their motion with the measured one"
EXAMPLE = """eccentric simulate examples/bench/bench.csv.gz --rig examples/bench/bench.toml
eccentric simulate LOG --rig RIG c2_parallel 'c2_parallel+stribeck[d=1]' --out build/simulated"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `simulate` to `parser`."""
    add = parser.add_argument
    add("log", metavar="LOG", help=f"log of the rig: {log_suffixes()}")
    add(
        "models",
        metavar="MODEL[+EFFECT...]",
        nargs="*",
        help="model name, or path of a derivation, with the effects to add (default: Coulomb + viscous"
        " friction, the model for the rig's case, and that model with the effects that diagnose adds)",
    )
    add_rig(parser)
    add("--effects", metavar="FILE", type=Path, help="Python file with your own effects")
    add("--json", action="store_true", help="print the result as JSON")
    add(
        "--out",
        metavar="DIR",
        type=Path,
        help="folder for simulation.json, .png and .svg",
    )
    take_after_options(parser)


def run(args: argparse.Namespace) -> int:
    """Simulate, print the table or JSON, write the folder if there is one; return 0."""
    if args.out is not None:
        own_folder(args.out)
    found = eccentric.simulate(args.log, args.rig, args.models, args.effects, progress(), reading=bar())
    write_and_print(found, args.out, as_json=args.json)
    return 0
