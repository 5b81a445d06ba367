"""`eccentric rig`: draft a rig file from a log, or list all that is wrong with one."""

import argparse
from pathlib import Path

import eccentric
from eccentric.cli.arguments import bar, coloured, log_suffixes, print_warnings
from eccentric.core import InputError

NAME = "rig"
HELP = "draft a rig file for an undocumented log, or list everything wrong with a rig file"
EXAMPLE = """eccentric rig examples/bench/bench.csv.gz --out my_rig.toml
eccentric rig examples/bench/bench.csv.gz --check examples/bench/bench.toml
eccentric rig my_log.csv --arm my_arm.urdf --out my_rig.toml"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `rig` to `parser`."""
    add = parser.add_argument
    add("logs", metavar="LOG", nargs="+", help=f"logs of one rig: {log_suffixes()}")
    add("--out", metavar="RIG.toml", help="new rig file (default: print the draft)")
    add(
        "--check",
        metavar="RIG",
        help="check this rig file against the logs instead; exit status 1 if there are problems",
    )
    add(
        "--arm",
        metavar="ARM",
        help="arm whose joints were logged, .toml or .urdf; the draft then has column patterns",
    )
    add("--rate", metavar="HZ", type=float, help="rows per second of a log without a time column")
    add("--name", metavar="NAME", help="name of the rig (default: the name of the log)")


def run(args: argparse.Namespace) -> int:
    """Print or write the draft, or the complaints; return 1 if a checked rig has any."""
    if args.check is not None:
        for option, given in (("--out", args.out), ("--arm", args.arm), ("--rate", args.rate)):
            if given is not None:
                raise InputError("--check", f"no {option}", "one", why="with it")
        found = eccentric.check_rig(args.logs, args.check)
        print_warnings((*found.doubts, *found.warnings))
        if found.complaints:
            print("\n".join(coloured(line, "error") for line in found.complaints))
            return 1
        first, *rest = found.summary().splitlines()
        print("\n".join([coloured(first, "good"), *rest]))
        return 0
    beside = Path(args.out or "rig.toml").parent
    draft = eccentric.draft_rig(
        args.logs, args.name, args.arm, rate_hz=args.rate, beside=beside, reading=bar()
    )
    if args.out is None:
        print(draft.text, end="")
        return 0
    draft.write(args.out)
    print(f"{args.out}:\n{draft.summary()}")
    return 0
