"""`eccentric figures`: the paper's figures from the emitted modules."""

import argparse

from eccentric.cli.arguments import add_folder
from eccentric.core import whole_folder

NAME = "figures"
HELP = "draw the paper's figures 2, 4 and 5 from the emitted modules"
EXAMPLE = "eccentric figures --out build/figures"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments."""
    add_folder(parser, "the figures")


def run(arguments: argparse.Namespace) -> int:
    """Draw the figures and print the names of the files."""
    from eccentric.paper import draw

    with whole_folder(arguments.out, NAME) as folder:
        names = [path.name for path in draw(folder)]
    print(f"{arguments.out}: {', '.join(names)}")
    return 0
