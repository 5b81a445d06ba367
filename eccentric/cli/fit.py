"""`eccentric fit`: identify a model on logs, with uncertainty and the error on what was held out."""

import argparse
import json
import sys
from pathlib import Path

from eccentric.cli.arguments import add_folder, add_logs, distinct
from eccentric.errors import InputError
from eccentric.fitting import draw_fit, fit, fit_document, fit_lines
from eccentric.model import load_model
from eccentric.output import own_folder, whole_folder
from eccentric.rigs import read_rig
from eccentric.signals import read_channels

NAME = "fit"
HELP = "identify the friction of a rig from its logs, with uncertainty, and compare it with Coulomb + viscous"
EXAMPLE = """eccentric fit examples/bench/bench.csv.gz --rig examples/bench/bench.toml --out build/bench
eccentric fit monday.csv tuesday.csv --rig my_rig.toml --out build/mine"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `fit` to `parser`."""
    add_logs(parser)
    add_folder(parser, "fit.json, fit.png and fit.svg")


def run(args: argparse.Namespace) -> int:
    """Fit, write the folder, print the table; return 0. Raises InputError on bad input."""
    distinct(args.logs)
    own_folder(args.out)
    rig = read_rig(args.rig)
    names = [Path(log).name for log in args.logs]
    channels = read_channels(args.logs, rig)
    rig = channels.rig
    found = fit(channels, rig, load_model(args.model or rig.model), ", ".join(names))
    figure = "fit.png, fit.svg"
    with whole_folder(args.out, NAME) as folder:
        text = json.dumps(fit_document(found, names), indent=1, ensure_ascii=False, allow_nan=False)
        (folder / "fit.json").write_text(text + "\n", encoding="utf-8")
        try:
            draw_fit(found, folder / "fit")
        except InputError as error:
            figure = f"no figure: {error}"
    for warning in found.warnings:
        print(f"eccentric: warning: {warning}", file=sys.stderr)
    print("\n".join(fit_lines(found, names)))
    print(f"{args.out}: fit.json, {figure}")
    return 0
