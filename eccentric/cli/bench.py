"""`eccentric bench`: the virtual test bench writes a log, its rig and the sealed truth."""

import argparse
from collections.abc import Callable, Mapping
from typing import Any

import eccentric
from eccentric.cli.arguments import bar, options
from eccentric.core import InputError, counted

NAME = "bench"
HELP = "simulate a realistic log of a test bench, with effects that its rig file does not declare"
EXAMPLE = """eccentric bench --out LOG.csv.gz --case C2 --effect stribeck=0.12 --effect cogging --seed 7
eccentric bench --out LOG.csv.gz --effect 'link_harmonic_friction[n=2]=0.2'
eccentric bench --out LOG.csv.gz --arm 6 --effect gear_efficiency@3=0.2 --seed 4
eccentric bench --fleet --out DIR"""

_NAMES = (
    "case", "log type", "noise", "seconds", "drive", "seed", "effect", "arm",
    "joints", "months", "degrading", "bad_sensors", "runs", "measured",
)  # fmt: skip
_OTHERS = {"gear ratio mu": "--mu", "periods": "--months", "sample rate [Hz]": "--rate"}
"""Beginning of a message of the bench -> the option concerned, where that is another name."""
_OF_A_DRIVE = {"case": "C2", "mu": 0.2, "log_type": "runs", "drive": "fine", "temperature": False}
_OF_AN_ARM = {"log_type": "traj", "runs": 5, "measured": "current", "rate": 250}
"""Arguments of one kind of bench, with their values where none is given."""
_OF_A_FLEET = ("joints", "months", "degrading", "bad_sensors")


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `bench` to `parser`."""
    add = parser.add_argument
    add(
        "--out",
        metavar="LOG.csv.gz",
        help="log to write, with its rig file LOG.json (of an arm, LOG.toml and LOG.arm.toml) and the sealed"
        " LOG.truth.json next to it; overwrites no file",
    )
    add(
        "--effect",
        metavar="FAMILY[@JOINT][=STRENGTH]",
        action="append",
        default=[],
        help="effect to add, with its RMS as a fraction of the friction's, above 0 and at most 1 (default:"
        " 0.15); a variant, as in cogging[n=4], or the joint of an arm is chosen at random if you name none;"
        " may be repeated",
    )
    add("--list-effects", action="store_true", help="list the families of effects and their variants")
    add(
        "--log-type",
        metavar="runs|traj",
        help="constant speeds, or sums of sines (default: runs; of an arm, traj)",
    )
    add(
        "--seconds",
        metavar="S",
        type=float,
        default=60.0,
        help="length of the log, 15 to 3600 (default: %(default)g)",
    )
    add(
        "--noise",
        metavar="PART",
        type=float,
        default=0.01,
        help="current noise as a fraction of the maximum current, up to 0.5 (default: %(default)g)",
    )
    add(
        "--seed",
        metavar="N",
        type=int,
        default=1,
        help="seed of the random numbers (default: %(default)d)",
    )
    add = parser.add_argument_group("one drive").add_argument
    add(
        "--case",
        metavar="C1|C2",
        help="gravity perpendicular (C1) or parallel (C2) to the plane of motion"
        f" (default: {_OF_A_DRIVE['case']})",
    )
    add(
        "--mu",
        metavar="MU",
        type=float,
        help=f"gear ratio, link speed over motor speed, 0.001 to 2 (default: {_OF_A_DRIVE['mu']})",
    )
    add(
        "--drive",
        metavar="fine|ordinary",
        help="quality of the drive: ordinary has a loop that may ring, a bus that varies by up to 2 %% and a"
        f" coarse encoder (default: {_OF_A_DRIVE['drive']})",
    )
    add("--temperature", action="store_true", default=None, help="log a temperature")
    add = parser.add_argument_group("an arm, simulated in MuJoCo").add_argument
    add(
        "--arm",
        metavar="2r|3|6",
        help="two links in a vertical plane with a weight at the tip, or 3 or 6 joints in space",
    )
    add(
        "--runs",
        metavar="N",
        type=int,
        help=f"runs, each from rest, 3 to 20 (default: {_OF_AN_ARM['runs']})",
    )
    add(
        "--measured",
        metavar="current|torque",
        help=f"drive signal (default: {_OF_AN_ARM['measured']})",
    )
    add("--rate", type=int, metavar="250|500", help=f"rows per second (default: {_OF_AN_ARM['rate']})")
    add = parser.add_argument_group("a fleet, computed in closed form").add_argument
    add("--fleet", action="store_true", help="write a folder with logs of several joints over several months")
    add("--joints", metavar="N", type=int, help="number of joints (default: 12)")
    add(
        "--months",
        metavar="N",
        type=int,
        help="number of months, one log per joint in each (default: 6)",
    )
    add("--degrading", metavar="N", type=int, help="joints whose friction changes (default: 2)")
    add("--bad-sensors", metavar="N", type=int, help="joints with a sensor that fails (default: 1)")


def run(args: argparse.Namespace) -> int:
    """Write the files, or list the effects; return 0. Raises InputError on bad values."""
    if args.fleet:
        return _of_a_fleet(args)
    if args.list_effects:
        _list_effects(of_arms=args.arm is not None)
        return 0
    if args.out is None:
        raise InputError("--out", "the path of a log (LOG.csv.gz)", "none")
    if not args.out.endswith(".csv.gz"):
        raise InputError("--out", "a log name that ends in .csv.gz", args.out)
    bench = _of_a_drive if args.arm is None else _of_an_arm
    common = {"seconds": args.seconds, "noise": args.noise, "seed": args.seed, "out": args.out}
    with options(*_NAMES, **_OTHERS):
        effects, said = bench(args, common)
    name = args.out.removesuffix(".csv.gz")
    print(f"{args.out}: {said}")
    print(f"sealed in {name}.truth.json: {counted(len(effects), 'effect') if effects else 'no effect'}")
    return 0


def _of_a_drive(args: argparse.Namespace, common: Mapping[str, Any]) -> tuple[tuple[str, ...], str]:
    """Simulate one drive; return its effects, and what was written."""
    from eccentric.virtual_bench import known_effect

    own = _chosen(args, _OF_A_DRIVE, _OF_AN_ARM, "--arm", "none")
    effects = [_effect(text, known_effect) for text in args.effect]
    result = eccentric.bench(effects, **own, **common)
    name = args.out.removesuffix(".csv.gz")
    return result.effects, (f"{result.log.rows} rows, case {own['case']}, mu {own['mu']:g}; rig {name}.json")


def _of_a_fleet(args: argparse.Namespace) -> int:
    """Write a small fleet, some of whose joints degrade."""
    _chosen(args, {}, {**_OF_A_DRIVE, **_OF_AN_ARM, "arm": None}, "no --fleet", "it")
    if args.effect or args.out is None:
        what = "no --effect" if args.effect else "the path of a folder as --out"
        raise InputError("--fleet", what, "one" if args.effect else "none", why="with it")
    own = {name: value for name in _OF_A_FLEET if (value := getattr(args, name)) is not None}
    with options(*_NAMES, **_OTHERS):
        changed = eccentric.bench_fleet(args.out, seed=args.seed, **own, progress=bar())
    print(f"{args.out}: logs/, rigs.csv with its rig files")
    print(f"sealed in truth.json: {counted(len(changed), 'joint')} that change")
    return 0


def _of_an_arm(args: argparse.Namespace, common: Mapping[str, Any]) -> tuple[tuple[str, ...], str]:
    """Simulate an arm; return its effects, and what was written."""
    from eccentric.virtual_bench import known_joint_effect

    own = _chosen(args, _OF_AN_ARM, _OF_A_DRIVE, "no --arm", args.arm)
    own["sample_rate_hz"] = own.pop("rate")
    effects = [_effect(text, known_joint_effect) for text in args.effect]
    result = eccentric.bench_arm(args.arm, effects, **own, **common, progress=bar())
    name = args.out.removesuffix(".csv.gz")
    gears = ", ".join(joint["mu"] for joint in result.arm["joint"])
    return result.effects, (
        f"{result.log.rows} rows in {own['runs']} runs, {len(result.arm['joint'])} joints, mu {gears}; "
        f"rig {name}.toml, arm {name}.arm.toml"
    )


def _chosen(
    args: argparse.Namespace, own: Mapping[str, Any], others: Mapping[str, Any], required: str, received: str
) -> dict[str, Any]:
    """The arguments of one kind of bench; InputError if one of the other kind is given."""
    for name in others.keys() - own.keys():
        if getattr(args, name) is not None:
            raise InputError(f"--{name}", required, received, why="with it")
    return {
        name: value if getattr(args, name) is None else getattr(args, name) for name, value in own.items()
    }


def _list_effects(*, of_arms: bool) -> None:
    from eccentric.virtual_bench import ARM_EFFECTS, ARM_VARIANTS, EFFECTS, VARIANTS

    families, of_families = (ARM_EFFECTS, ARM_VARIANTS) if of_arms else (EFFECTS, VARIANTS)
    width = max(map(len, families))
    for family, builder in families.items():
        variants = f" Variants: {', '.join(of_families[family])}." if family in of_families else ""
        print(f"{family:{width}}  {(builder.__doc__ or '').splitlines()[0]}{variants}")


def _effect(text: str, known: Callable[[str], object]) -> str | tuple[str, float]:
    """Read FAMILY with [VARIANT], @JOINT and =STRENGTH where given; the variant may hold an equals sign."""
    closed = text.rfind("]") + 1
    place = text.find("=", closed)
    if place < 0:
        return text
    name, size = text[:place], text[place + 1 :]
    known(name)
    try:
        return name, float(size)
    except ValueError:
        raise InputError(f"--effect {text}", "a number for the strength", size) from None
