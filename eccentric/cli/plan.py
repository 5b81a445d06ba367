"""`eccentric plan`: what to measure next."""

import argparse

import eccentric
from eccentric.cli.arguments import add_folder, add_logs, arm_of, bar, print_warnings, progress
from eccentric.core import InputError, own_folder

NAME = "plan"
HELP = "plan a motion to decide between the remaining candidates, within the limits of the drive"
EXAMPLE = """eccentric plan my.csv --rig my.toml --limits limits.toml --out build/plan
eccentric diagnose my.csv my_new.csv --rig my.toml --out build/settled"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    add_logs(parser)
    parser.add_argument(
        "--limits",
        metavar="LIMITS",
        required=True,
        help=".toml or .json with speed_rad_s, acceleration_rad_s2, current_A, time_s (of a carriage"
        " speed_m_s, acceleration_m_s2, force_N or current_A, time_s);"
        " optional: angle_rad (position_m), speed_loop_Hz",
    )
    parser.add_argument(
        "--diagnosis",
        metavar="JSON",
        help="the diagnosis.json of these logs: take the remaining candidates from it",
    )
    parser.add_argument(
        "--added",
        metavar="MASS",
        help='a mass to be added to the link, such as "0.2 kg": plan motions with it',
    )
    add_folder(parser, "the reference, as CSV and C, and its picture")


def run(args: argparse.Namespace) -> int:
    """Diagnose, plan, write the folder, print the plan."""
    own_folder(args.out)
    if arm_of(args.rig, {"--model": args.model}):
        raise InputError(args.rig, problem="plan requires the rig of a single drive, received that of an arm")
    found = eccentric.plan(
        args.logs,
        args.rig,
        args.limits,
        args.model,
        progress(),
        bar(),
        args.diagnosis,
        args.added,
    )
    names = [path.name for path in found.write(args.out)]
    print_warnings(found.warnings)
    print(found.summary())
    print(f"{args.out}: {', '.join(names)}")
    return 0
