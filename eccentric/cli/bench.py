"""`eccentric bench`: the virtual test bench writes a log, its rig and the sealed truth."""

import argparse

import numpy as np

from eccentric.bench import EFFECTS, known_effect, random_scenario, simulate, write
from eccentric.errors import InputError

NAME = "bench"
HELP = "simulate a realistic log of a test bench, with effects that its rig file does not declare"
EXAMPLE = "eccentric bench --out LOG.csv.gz --case C2 --effect stribeck=0.12 --effect cogging --seed 7"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `bench` to `parser`."""
    add = parser.add_argument
    add(
        "--out",
        metavar="LOG.csv.gz",
        help="the log; the rig LOG.json and the sealed LOG.truth.json go beside it",
    )
    add(
        "--effect",
        metavar="FAMILY[=STRENGTH]",
        action="append",
        default=[],
        help="an effect, as a fraction of the friction rms (0.15 unless given); may be repeated",
    )
    add("--list-effects", action="store_true", help="list the families of effects and leave")
    add("--case", default="C2", metavar="C1|C2", help="gravity perpendicular or parallel to the plane (C2)")
    add("--mu", type=float, default=0.2, help="gear ratio, link speed over motor speed (0.2)")
    add("--log-type", default="runs", metavar="runs|traj", help="constant speeds, or a sum of sines (runs)")
    add("--seconds", type=float, default=60.0, help="length of the log (60)")
    add("--noise", type=float, default=0.01, help="noise of the current over its largest size (0.01)")
    add("--temperature", action="store_true", help="log a temperature")
    add("--seed", type=int, default=1, help="seed of rig, course, shapes and noise (1)")


def run(args: argparse.Namespace) -> int:
    """Write the three files, or list the effects; return 0. Raises InputError on bad values."""
    if args.list_effects:
        width = max(map(len, EFFECTS))
        for family, builder in EFFECTS.items():
            print(f"{family:{width}}  {(builder.__doc__ or '').splitlines()[0]}")
        return 0
    if args.out is None:
        raise InputError("--out: required the path of a log, LOG.csv.gz; got none")
    if args.seed < 0:
        raise InputError(f"--seed: required 0 or more; got {args.seed}")
    scenario = random_scenario(
        np.random.default_rng(args.seed),
        case=args.case,
        mu=args.mu,
        log_type=args.log_type,
        effects=[_effect(text) for text in args.effect],
        noise=args.noise,
        temperature=args.temperature,
        seconds=args.seconds,
    )
    result = simulate(scenario)
    log, rig, truth = write(result, args.out)
    inside = [
        f"{e['id']} at {e['rms_fraction_of_friction']:.1%} of friction" for e in result.truth["effects"]
    ]
    print(f"{log}: {len(result.columns['time_s'])} rows, case {args.case}, mu {args.mu:g}; rig {rig.name}")
    print(f"sealed in {truth.name}: {', '.join(inside) or 'no effect'}")
    return 0


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
