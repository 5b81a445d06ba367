"""Arguments that several commands take."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from eccentric.errors import InputError

__all__ = ["add_folder", "add_logs", "distinct"]


def add_logs(parser: argparse.ArgumentParser) -> None:
    """Add what a fit is made from: logs, their rig, and the model."""
    add = parser.add_argument
    add("logs", metavar="LOG", nargs="+", help="logs of one rig: .csv[.gz], .parquet, .mat, .json[.gz]")
    add(
        "--rig",
        metavar="RIG",
        required=True,
        help="what is known of the rig: .toml or .json, as docs/rig.md explains",
    )
    add("--model", metavar="MODEL", help="a model or the path of a derivation (by the rig's case)")


def add_folder(parser: argparse.ArgumentParser, files: str) -> None:
    """Add the folder that is written, for these files."""
    parser.add_argument(
        "--out",
        metavar="DIR",
        type=Path,
        required=True,
        help=f"folder for {files}; those of an earlier run are replaced, all else in it stays",
    )


def distinct(logs: Sequence[str]) -> None:
    """Ask for every log once: rows that count twice make errors look smaller than they are.

    Raises:
        InputError: two names are one file.
    """
    places = [Path(log).resolve() for log in logs]
    for k, log in enumerate(logs):
        if places[k] in places[:k]:
            raise InputError(f"{log}: required every log once, received it twice")
