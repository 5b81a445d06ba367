"""`eccentric bench`: the virtual test bench writes a log, its rig and the sealed truth."""

import argparse
from pathlib import Path

import eccentric
from eccentric.cli.arguments import options
from eccentric.errors import InputError

NAME = "bench"
HELP = "simulate a realistic log of a test bench, with effects that its rig file does not declare"
EXAMPLE = """eccentric bench --out LOG.csv.gz --case C2 --effect stribeck=0.12 --effect cogging --seed 7
eccentric bench --out LOG.csv.gz --effect 'link_harmonic_friction[n=2]=0.2'"""

_OPTIONS = {
    "case": "--case",
    "log type": "--log-type",
    "gear ratio mu": "--mu",
    "noise": "--noise",
    "seconds": "--seconds",
    "drive": "--drive",
    "seed": "--seed",
    "effect": "--effect",
}
"""Beginning of a message of the bench -> the option concerned."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `bench` to `parser`."""
    add = parser.add_argument
    add(
        "--out",
        metavar="LOG.csv.gz",
        help="the log, with the rig LOG.json and the sealed LOG.truth.json beside it; no file is overwritten",
    )
    add(
        "--effect",
        metavar="FAMILY[=STRENGTH]",
        action="append",
        default=[],
        help="an effect, with its rms as a fraction of the friction's, above 0 and at most 1 (0.15); FAMILY "
        "may name a variant, as in cogging[n=4], otherwise drawn at random; may be repeated",
    )
    add("--list-effects", action="store_true", help="list the families of effects, with variants")
    add("--case", default="C2", metavar="C1|C2", help="gravity perpendicular or parallel to the plane (C2)")
    add("--mu", type=float, default=0.2, help="gear ratio, link speed over motor speed, 0.001 to 2 (0.2)")
    add("--log-type", default="runs", metavar="runs|traj", help="constant speeds, or a sum of sines (runs)")
    add("--seconds", type=float, default=60.0, help="length of the log, 15 to 3600 (60)")
    add("--noise", type=float, default=0.01, help="noise of the current over its maximum, up to 0.5 (0.01)")
    add(
        "--drive",
        default="fine",
        metavar="fine|ordinary",
        help="quality of the drive: ordinary has a loop that may ring, a bus that varies by up to 2 %% and a "
        "coarse encoder (fine)",
    )
    add("--temperature", action="store_true", help="log a temperature")
    add("--seed", type=int, default=1, help="seed of rig, course, shapes and noise (1)")


def run(args: argparse.Namespace) -> int:
    """Write the three files, or list the effects; return 0. Raises InputError on bad values."""
    if args.list_effects:
        _list_effects()
        return 0
    if args.out is None:
        raise InputError("--out: the path of a log (LOG.csv.gz) is required, received none")
    if not args.out.endswith(".csv.gz"):
        raise InputError(f"--out: a log name that ends in .csv.gz is required, received {args.out}")
    with options(_OPTIONS):
        result = eccentric.bench(
            [_effect(text) for text in args.effect],
            case=args.case,
            mu=args.mu,
            log_type=args.log_type,
            seconds=args.seconds,
            noise=args.noise,
            temperature=args.temperature,
            drive=args.drive,
            seed=args.seed,
            out=args.out,
        )
    name = Path(args.out).name.removesuffix(".csv.gz")
    print(f"{args.out}: {result.log.rows} rows, case {args.case}, mu {args.mu:g}; rig {name}.json")
    print(f"sealed in {name}.truth.json: {', '.join(result.effects) or 'no effect'}")
    return 0


def _list_effects() -> None:
    from eccentric.virtual_bench import EFFECTS, VARIANTS

    width = max(map(len, EFFECTS))
    for family, builder in EFFECTS.items():
        variants = f" Variants: {', '.join(VARIANTS[family])}." if family in VARIANTS else ""
        print(f"{family:{width}}  {(builder.__doc__ or '').splitlines()[0]}{variants}")


def _effect(text: str) -> str | tuple[str, float]:
    """Read FAMILY, FAMILY[VARIANT] or either with =STRENGTH; the variant may contain an equals sign."""
    from eccentric.virtual_bench import known_effect

    closed = text.rfind("]") + 1
    place = text.find("=", closed)
    if place < 0:
        return text
    name, size = text[:place], text[place + 1 :]
    known_effect(name)
    try:
        return name, float(size)
    except ValueError:
        raise InputError(f"--effect {text}: a number for the strength is required, received {size}") from None
