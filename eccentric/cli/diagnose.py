"""`eccentric diagnose`: what does the model lack on this log?"""

import argparse
import webbrowser
from pathlib import Path

import eccentric
from eccentric.cli.arguments import (
    MISFIT,
    add_folder,
    add_logs,
    arm_of,
    bar,
    coloured,
    names_in,
    options,
    print_warnings,
    progress,
)
from eccentric.core import own_folder

NAME = "diagnose"
HELP = (
    "find the effect that the model is missing, add it, emit the extended model, and report the error before"
    " and after"
)
EXAMPLE = """eccentric diagnose examples/bench/bench.csv.gz --rig examples/bench/bench.json --out build/bench
eccentric diagnose my.csv --rig my.toml --effects my_effects.py --out build/mine
eccentric diagnose my.csv --rig my.toml --with stribeck --without cogging,backlash --out build/mine"""
_OTHERS = {"effects and model": "--effects and --model", "including": "--with"}
"""Argument -> its option, where that is another name."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    add_logs(parser)
    add = parser.add_argument
    several = {"metavar": "EFFECT,...", "action": "append", "default": []}
    add("--with", dest="including", help="effects to include from the start", **several)
    add("--without", help="effects or families not to search for", **several)
    add("--only", help="effects or families to search for, and no others", **several)
    parser.add_argument("--effects", metavar="FILE", type=Path, help="Python file with your own effects")
    parser.add_argument(
        "--empirical",
        action="store_true",
        help="add an empirical term: a smooth function of the one or two variables that the remaining"
        " residual depends on",
    )
    add_folder(parser, "the report and the extended model")
    parser.add_argument("--open", action="store_true", help="open the report in the browser")


def run(args: argparse.Namespace) -> int:
    """Diagnose, write the folder, print the result; return 1 if the log does not fit the rig."""
    own_folder(args.out)
    if arm_of(args.rig, {"--model": args.model, "--with": args.including, "--open": args.open}):
        return _of_an_arm(args)
    with options("without", "only", **_OTHERS):
        found = eccentric.diagnose(
            args.logs,
            args.rig,
            args.model,
            args.effects,
            progress(),
            including=names_in(args.including),
            without=names_in(args.without),
            only=names_in(args.only),
            empirical=args.empirical,
            reading=bar(),
        )
    names = [path.relative_to(args.out).as_posix() for path in found.write(args.out)]
    print_warnings(found.warnings)
    verdict, *rest = found.lines
    print("\n".join([coloured(verdict, "answer"), *rest]))
    folders = ["check/"] if any("/" in name for name in names) else []
    print(f"{args.out}: {', '.join([*(name for name in names if '/' not in name), *folders])}")
    if args.open and not webbrowser.open((Path(args.out).resolve() / "report.html").as_uri()):
        print_warnings(["no browser could be opened (see eccentric doctor): open report.html yourself"])
    return 0 if found.fits_the_rig else MISFIT


def _of_an_arm(args: argparse.Namespace) -> int:
    """The same for every joint of an arm."""
    with options("without", "only", **_OTHERS):
        found = eccentric.diagnose_arm(
            args.logs,
            args.rig,
            args.effects,
            progress(),
            without=names_in(args.without),
            only=names_in(args.only),
            empirical=args.empirical,
            reading=bar(),
        )
    names = [path.relative_to(args.out).as_posix() for path in found.write(args.out)]
    folders = dict.fromkeys(f"{name.partition('/')[0]}/" for name in names if "/" in name)
    print_warnings(found.warnings)
    print(found.summary())
    print(f"{args.out}: {', '.join([*(name for name in names if '/' not in name), *folders])}")
    return 0 if found.fits_the_rig else MISFIT
