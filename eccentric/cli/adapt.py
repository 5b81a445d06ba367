"""`eccentric adapt`: a log through the estimator that `eccentric emit --adapt` writes."""

import argparse
from pathlib import Path

import eccentric
from eccentric.cli.arguments import add_folder, add_model, add_rig, log_suffixes, options, write_and_print
from eccentric.core import own_folder

NAME = "adapt"
HELP = "replay a log through the emitted friction estimator, and report coefficients over time and alarms"
EXAMPLE = """eccentric adapt examples/bench/bench.csv.gz --rig examples/bench/bench.toml --out build/adapted
eccentric adapt tuesday.csv --rig my_rig.toml --parameters build/monday/fit.json --out build/tuesday"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `adapt` to `parser`."""
    add = parser.add_argument
    add("logs", metavar="LOG", nargs="+", help=f"logs of one rig: {log_suffixes()}")
    add_rig(parser)
    add_model(parser)
    add("--parameters", type=Path, metavar="FIT.json", help="fit to start from (default: a fit of this log)")
    add("--forgetting", type=float, metavar="L", help="forgetting factor per sample (default: 0.999)")
    add("--false-alarms", type=float, metavar="N", help="mean samples between false alarms (default: 1e7)")
    add("--settle", type=int, metavar="N", help="samples to skip after a reversal (default: 20)")
    add_folder(parser, "adapt.json, adapt.png and adapt.svg")


def run(args: argparse.Namespace) -> int:
    """Replay, write the folder, print what was learned; return 0."""
    own_folder(args.out)
    with options("forgetting", "false_alarms", "settle"):
        found = eccentric.adapt(
            args.logs,
            args.rig,
            args.model,
            parameters=args.parameters,
            forgetting=args.forgetting,
            false_alarms=args.false_alarms,
            settle=args.settle,
        )
    write_and_print(found, args.out)
    return 0
