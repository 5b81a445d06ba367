"""`eccentric bench`: the virtual test bench writes a log, its rig and the sealed truth."""

import argparse

import numpy as np

from eccentric.errors import InputError
from eccentric.virtual_bench import (
    EFFECTS,
    VARIANTS,
    Scenario,
    free_paths,
    known_effect,
    random_scenario,
    simulate,
    write,
)

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
    "unknown effect": "--effect",
    "effect": "--effect",
}
"""What a message of the bench begins with: the option that says it."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `bench` to `parser`."""
    add = parser.add_argument
    add(
        "--out",
        metavar="LOG.csv.gz",
        help="the log, with the rig LOG.json and the sealed LOG.truth.json beside it; none of them may exist",
    )
    add(
        "--effect",
        metavar="FAMILY[=STRENGTH]",
        action="append",
        default=[],
        help="an effect, with its rms as a fraction of the friction's, above 0 and at most 1 (0.15); FAMILY "
        "may name a variant, as in cogging[n=4], which is drawn otherwise; may be repeated",
    )
    add("--list-effects", action="store_true", help="list the families of effects, with variants")
    add("--case", default="C2", metavar="C1|C2", help="gravity perpendicular or parallel to the plane (C2)")
    add("--mu", type=float, default=0.2, help="gear ratio, link speed over motor speed, 0.001 to 2 (0.2)")
    add("--log-type", default="runs", metavar="runs|traj", help="constant speeds, or a sum of sines (runs)")
    add("--seconds", type=float, default=60.0, help="length of the log, 15 to 3600 (60)")
    add("--noise", type=float, default=0.01, help="noise of the current over its largest size, to 0.5 (0.01)")
    add("--temperature", action="store_true", help="log a temperature")
    add("--seed", type=int, default=1, help="seed of rig, course, shapes and noise (1)")


def run(args: argparse.Namespace) -> int:
    """Write the three files, or list the effects; return 0. Raises InputError on bad values."""
    if args.list_effects:
        width = max(map(len, EFFECTS))
        for family, builder in EFFECTS.items():
            variants = f" Variants: {', '.join(VARIANTS[family])}." if family in VARIANTS else ""
            print(f"{family:{width}}  {(builder.__doc__ or '').splitlines()[0]}{variants}")
        return 0
    if args.out is None:
        raise InputError("--out: required the path of a log, LOG.csv.gz; got none")
    if not args.out.endswith(".csv.gz"):
        raise InputError(f"--out: required a log name that ends in .csv.gz; got {args.out}")
    if args.seed < 0:
        raise InputError(f"--seed: required 0 or more; got {args.seed}")
    scenario = _scenario(args)
    free_paths(args.out)
    result = simulate(scenario)
    log, rig, truth = write(result, args.out)
    inside = [
        f"{e['id']} at {e['rms_fraction_of_friction']:.1%} of friction" for e in result.truth["effects"]
    ]
    print(f"{log}: {len(result.columns['time_s'])} rows, case {args.case}, mu {args.mu:g}; rig {rig.name}")
    print(f"sealed in {truth.name}: {', '.join(inside) or 'no effect'}")
    return 0


def _scenario(args: argparse.Namespace) -> Scenario:
    """Return the scenario that the options ask for; InputError that names the option."""
    try:
        return random_scenario(
            np.random.default_rng(args.seed),
            case=args.case,
            mu=args.mu,
            log_type=args.log_type,
            effects=[_effect(text) for text in args.effect],
            noise=args.noise,
            temperature=args.temperature,
            seconds=args.seconds,
        )
    except InputError as error:
        said = str(error)
        start = next((start for start in _OPTIONS if said.startswith(start)), None)
        raise InputError(said if start is None else _OPTIONS[start] + said.removeprefix(start)) from None


def _effect(text: str) -> str | tuple[str, float]:
    """Read FAMILY, FAMILY[VARIANT] or either with =STRENGTH; the variant may hold an equals sign itself."""
    closed = text.rfind("]") + 1
    place = text.find("=", closed)
    if place < 0:
        return text
    name, size = text[:place], text[place + 1 :]
    known_effect(name)
    try:
        return name, float(size)
    except ValueError:
        raise InputError(f"--effect {text}: required a number as the strength; got {size}") from None
