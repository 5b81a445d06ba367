"""`eccentric plan`: what to measure next."""

import argparse

import eccentric
from eccentric.cli.arguments import add_folder, add_logs, arm_of, bar, progress, write_and_print
from eccentric.core import InputError, own_folder

NAME = "plan"
HELP = "plan a motion, within the limits of the drive, to decide between the remaining candidates"
EXAMPLE = """eccentric plan my.csv --rig my.toml --limits limits.toml --out build/plan
eccentric diagnose my.csv my_new.csv --rig my.toml --out build/settled
eccentric plan --for B_lN,C_lN --rig my.toml --limits limits.toml --out build/detection"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    add_logs(parser, nargs="*")
    parser.add_argument(
        "--limits",
        metavar="LIMITS",
        required=True,
        help="limits of the drive, .toml or .json: speed_rad_s, acceleration_rad_s2, current_A, time_s (of a"
        " carriage: speed_m_s, acceleration_m_s2, force_N or current_A, time_s); optional: angle_rad"
        " (position_m), speed_loop_Hz",
    )
    parser.add_argument(
        "--diagnosis",
        metavar="JSON",
        help="diagnosis.json of these logs, to take the remaining candidates from",
    )
    parser.add_argument(
        "--added",
        metavar="MASS",
        help='mass to add to the link for the motion, such as "0.2 kg"',
    )
    parser.add_argument(
        "--for",
        dest="sought",
        metavar="NAMES",
        help="without logs: find the speed, mass and time that reveal these coefficients of F_N friction,"
        " with the values of Table 1 or your own, as in B_lN,C_lN=0.01",
    )
    parser.add_argument(
        "--noise",
        metavar="TORQUE",
        help='with --for: torque noise per independent sample, such as "2 mN m"',
    )
    add_folder(parser, "the reference, as CSV and C, and its plot")


def run(args: argparse.Namespace) -> int:
    """Diagnose, plan, write the folder, print the plan."""
    own_folder(args.out)
    if arm_of(args.rig, {"--model": args.model}):
        raise InputError(args.rig, problem="plan requires the rig of a single drive, got that of an arm")
    if args.sought is not None:
        return _for(args)
    if not args.logs:
        raise InputError("plan", problem="expected a log, or --for, got neither")
    found = eccentric.plan(
        args.logs, args.rig, args.limits, args.model, progress(), bar(), args.diagnosis, args.added
    )
    write_and_print(found, args.out)
    return 0


def _for(args: argparse.Namespace) -> int:
    """Plan without a log."""
    if args.logs:
        raise InputError("--for", "no log", args.logs[0], why="with it")
    sought = args.sought.split(",")
    found = eccentric.plan_detection(args.rig, args.limits, sought, args.model, args.noise)
    write_and_print(found, args.out)
    return 0
