"""`eccentric fit`: identify a model on logs, with uncertainty and the held-out error."""

import argparse

import eccentric
from eccentric.cli.arguments import MISFIT, add_folder, add_logs, arm_of, bar, print_warnings, progress
from eccentric.core import own_folder

NAME = "fit"
HELP = (
    "fit a friction model to the logs of a rig, with uncertainty; compare it with Coulomb + viscous friction"
)
EXAMPLE = """eccentric fit examples/bench/bench.csv.gz --rig examples/bench/bench.toml --out build/bench
eccentric fit monday.csv tuesday.csv --rig my_rig.toml --out build/mine
eccentric fit my.csv --rig my_rig.toml --simulated --out build/mine"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `fit` to `parser`."""
    add_logs(parser)
    parser.add_argument(
        "--simulated",
        action="store_true",
        help="refine the parameters so that the simulated motion follows the training part; friction may"
        " then depend on the current",
    )
    add_folder(parser, "fit.json, fit.png and fit.svg")


def run(args: argparse.Namespace) -> int:
    """Fit, write the folder, print the table; return 1 if the log does not fit the rig."""
    from eccentric.presentation import NEEDS_MATPLOTLIB

    own_folder(args.out)
    if arm_of(args.rig, {"--model": args.model, "--simulated": args.simulated}):
        found = eccentric.fit_arm(args.logs, args.rig, progress(), reading=bar())
    else:
        found = eccentric.fit(args.logs, args.rig, args.model, simulated=args.simulated, reading=bar())
    first, *figures = (path.name for path in found.write(args.out))
    print_warnings(found.warnings)
    print(found.summary())
    print(f"{args.out}: {first}, {', '.join(figures) or f'no figure: {NEEDS_MATPLOTLIB}'}")
    return 0 if found.fits_the_rig else MISFIT
