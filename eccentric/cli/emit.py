"""`eccentric emit`: the files of any model for the chosen targets, optionally with fitted parameters."""

import argparse
from pathlib import Path

import eccentric
from eccentric.cli.arguments import add_folder, options, warnings_printed
from eccentric.core import TARGETS

NAME = "emit"
HELP = "write a model as a NumPy module, a C header and a C source, with files that check the C"
EXAMPLE = """eccentric emit c2_parallel --out build/firmware
eccentric emit my_derivation.py --out build/mine
eccentric emit examples/arms/planar_2r.toml --out build/arm
eccentric emit c2_parallel --backend numpy --single-file --out build/python
eccentric emit c2_parallel --functions mechanical_friction_torque --fixed --out build/small
eccentric emit c2_parallel --parameters build/fit/fit.json --prefix arm --out build/firmware
eccentric emit c2_parallel --parameters build/fit/fit.json --adapt --out build/firmware
eccentric emit c2_parallel --parameters build/fit/fit.json --compensation --out build/firmware"""

_NAMED = (
    "prefix", "backend", "functions", "accept_misfit",
    "adapt", "compensation", "forgetting", "false_alarms", "settle",
)  # fmt: skip
"""Arguments that errors call by their option."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    *others, last = TARGETS
    default = " and ".join(name for name, target in TARGETS.items() if target.default)
    parser.add_argument(
        "model",
        metavar="MODEL",
        help="model name, or path of a derivation, an arm file or a URDF",
    )
    add_folder(parser, "the files of the model")
    parser.add_argument(
        "--parameters",
        type=Path,
        metavar="FIT.json",
        help='default values: a fit.json, or your own as {"parameters": {"M": 0.42}}, in SI',
    )
    parser.add_argument(
        "--accept-misfit",
        action="store_true",
        help="emit the values of a fit or a diagnosis even if its log does not fit the rig",
    )
    parser.add_argument(
        "--prefix", metavar="NAME", help="name of the files and prefix in C (default: the model's name)"
    )
    parser.add_argument(
        "--backend",
        action="append",
        metavar="NAME",
        help=f"{', '.join(others)} or {last}; may be repeated (default: {default})",
    )
    parser.add_argument(
        "--functions",
        type=lambda text: [name.strip() for name in text.split(",")],
        default=[],
        metavar="NAME,...",
        help="functions to emit, with the coefficients they need (default: all)",
    )
    parser.add_argument(
        "--arrays",
        action="store_true",
        default=None,
        help="with --functions: also write the array functions in C, in a header of their own",
    )
    parser.add_argument(
        "--fixed",
        action="store_true",
        help="write C for the default parameters only, without parameter structure, prepare and self-test",
    )
    parser.add_argument(
        "--single-file",
        action="store_true",
        help="with --backend numpy: put the runtime into the module instead of eccentric_runtime.py",
    )
    parser.add_argument(
        "--adapt", action="store_true", help="add an estimator that tracks the friction in the field"
    )
    parser.add_argument(
        "--compensation",
        action="store_true",
        help="add a friction compensation for a control loop, without a torque jump at standstill",
    )
    parser.add_argument(
        "--forgetting",
        type=float,
        metavar="L",
        help="with --adapt: forgetting factor per sample (default: 0.999)",
    )
    parser.add_argument(
        "--false-alarms",
        type=float,
        metavar="N",
        help="with --adapt: mean samples between false alarms (default: 1e7)",
    )
    parser.add_argument(
        "--settle", type=int, metavar="N", help="with --adapt: samples to skip after a reversal (default: 20)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the files and print their names."""
    given = {name: value for name, value in vars(arguments).items() if name != "run"}
    with options(*_NAMED), warnings_printed():
        written = eccentric.emit(**given)
    names = ", ".join(path.relative_to(arguments.out).as_posix() for path in written)
    print(f"{arguments.out}: {names}")
    if arguments.parameters is None:
        fit = f"eccentric fit LOG --rig RIG --model {arguments.model} --out FIT"
        fit = f"{fit}, then --parameters FIT/fit.json"
        if arguments.adapt:
            print(f"the estimator assumes errors of 30 % of each coefficient; to use those of a fit: {fit}")
        if arguments.compensation:
            print(f"the gain of the compensation is 0.9; to compute it from the errors of a fit: {fit}")
    return 0
