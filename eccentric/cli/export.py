"""`eccentric export`: a drive as a model of a simulator, with its friction at rest and in motion."""

import argparse
from pathlib import Path

import eccentric
from eccentric.cli.arguments import add_folder, options, warnings_printed
from eccentric.core import EXPORTS

NAME = "export"
HELP = "write a drive and its friction as a simulator model"
EXAMPLE = """eccentric export build/fit/fit.json --to mjcf --out build/mujoco
eccentric export build/bench --to budget --out build/pendulum
eccentric export build/fit --to fmu --out build/fmu
eccentric export my_arm.toml --parameters build/arm_fit --to budget --out build/my_arm
eccentric export my_derivation.py --parameters build/fit/fit.json --to mjcf --out build/mujoco"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "source",
        metavar="MODEL|RESULT",
        help="fit.json, folder of a fit or a diagnosis, model name, or path of a derivation, an arm file or a"
        " URDF",
    )
    targets = "; ".join(f"{name} ({target.meaning})" for name, target in EXPORTS.items())
    parser.add_argument("--to", metavar="TARGET", required=True, help=f"target: {targets}")
    add_folder(parser, "the simulator files")
    parser.add_argument(
        "--parameters",
        type=Path,
        metavar="FIT.json",
        help='values for a model: a fit.json, or your own as {"parameters": {"J_m": 1e-4}}, in SI',
    )
    parser.add_argument(
        "--speeds",
        nargs=2,
        type=float,
        metavar=("LOW", "HIGH"),
        help="motor speeds [rad/s] over which to fit the friction if the target has only constant"
        " coefficients (default: those of the log; without a log, 1 to 60)",
    )
    parser.add_argument("--prefix", metavar="NAME", help="name of the files (default: the model's name)")
    parser.add_argument(
        "--accept-misfit",
        action="store_true",
        help="export the values of a fit or a diagnosis even if its log does not fit the rig",
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the files, print how close the friction in them is, and their names."""
    with options("to", "speeds", "prefix", "accept_misfit"), warnings_printed():
        written = eccentric.export(
            arguments.source,
            arguments.to,
            arguments.out,
            parameters=arguments.parameters,
            speeds=arguments.speeds,
            prefix=arguments.prefix,
            accept_misfit=arguments.accept_misfit,
        )
    print(written)
    names = ", ".join(path.relative_to(arguments.out).as_posix() for path in written.paths)
    print(f"{arguments.out}: {names}")
    return 0
