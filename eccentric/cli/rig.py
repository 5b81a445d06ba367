"""`eccentric rig`: draft a rig file from a log, or list all that is wrong with one."""

import argparse

import eccentric
from eccentric.cli.arguments import LOGS, print_warnings
from eccentric.errors import InputError

NAME = "rig"
HELP = "draft the rig file of a log that nobody has described, or list all that is wrong with a rig file"
EXAMPLE = """eccentric rig examples/bench/bench.csv.gz --out my_rig.toml
eccentric rig examples/bench/bench.csv.gz --check examples/bench/bench.toml"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `rig` to `parser`."""
    add = parser.add_argument
    add("logs", metavar="LOG", nargs="+", help=f"logs of one rig: {LOGS}")
    add("--out", metavar="RIG.toml", help="the rig file to write, a new one; without it the draft is printed")
    add(
        "--check",
        metavar="RIG",
        help="check this rig file against the logs instead; status 1 if something is wrong",
    )
    add("--name", help="name of the rig (that of the log)")


def run(args: argparse.Namespace) -> int:
    """Print or write the draft, or the complaints; return 1 if a checked rig has any."""
    if args.check is not None:
        if args.out is not None:
            raise InputError("--check: no --out is required with it, received one")
        found = eccentric.check_rig(args.logs, args.check)
        print_warnings(found.warnings)
        print(found.summary())
        return 1 if found.complaints else 0
    draft = eccentric.draft_rig(args.logs, args.name)
    if args.out is None:
        print(draft.text, end="")
        return 0
    draft.write(args.out)
    print(f"{args.out}:\n{draft.summary()}")
    return 0
