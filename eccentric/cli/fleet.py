"""`eccentric fleet`: the logs of many joints over many periods: what drifts, and what changed."""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import eccentric
from eccentric.cli.arguments import bar, options, print_warnings
from eccentric.core import Ended, own_folder

NAME = "fleet"
HELP = "find what changed in a fleet, from the friction coefficients of its joints over time"
EXAMPLE = """eccentric fleet build/fleet/logs --rigs build/fleet/rigs.csv --out build/fleet_report
eccentric fleet '/data/2025/*.parquet' --pattern '{joint}_{period}' --rigs rigs.csv --out report
eccentric fleet /data/fleet --rigs rigs.csv --out report --scheduler tcp://10.0.0.5:8786"""

PROBLEMS = 1
"""Exit status of a run that has done all that could be done, and names the rest in problems.csv."""
_STATUS = (
    f"exit status: 0 on success; {PROBLEMS} if some logs failed (listed in problems.csv); 2 on bad input"
)
_WRITTEN = ["report.html", "fleet.json", "coefficients/", "changes.csv", "problems.csv", "joints/", "sums/"]
_SHOWN = 8
"""Problems printed; all are in problems.csv."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `fleet` to `parser`."""
    add = parser.add_argument
    add(
        "logs",
        metavar="LOGS",
        help="folder or glob of logs (.parquet, .csv[.gz], .mat), in folders such as joint=J7/month=2025-03",
    )
    add(
        "--rigs",
        metavar="RIGS",
        required=True,
        help="one rig file for all joints, or a table (.csv, .toml) of the joints, their rig files and"
        " individual values",
    )
    add(
        "--out",
        metavar="DIR",
        type=Path,
        required=True,
        help="folder for the page, the reports, coefficients and sums; the results of an earlier run"
        " are reused, and only new and changed logs are read",
    )
    add(
        "--pattern",
        metavar="NAME",
        help="pattern of the file names, such as '{joint}_{period}'",
    )
    add("--scheduler", metavar="ADDRESS", help="Dask scheduler (default: a cluster on this machine)")
    add("--workers", metavar="N", type=int, help="processes on this machine (default: one per processor)")
    add(
        "--rate",
        metavar="Q",
        type=float,
        default=0.01,
        help="false discovery rate of the tests (default: %(default)g)",
    )
    parser.description = f"{parser.description}\n\n{_STATUS}"


@contextmanager
def _interrupted() -> Iterator[None]:
    """Add to Ctrl-C how to go on."""
    try:
        yield
    except Ended:
        raise
    except KeyboardInterrupt:
        raise KeyboardInterrupt("what is done is kept, and the same command goes on from there") from None


def run(args: argparse.Namespace) -> int:
    """Run the fleet, print what changed; return 1 if there are problems."""
    own_folder(args.out)
    with options("pattern", "rate", "workers"), _interrupted():
        found = eccentric.diagnose_fleet(
            args.logs,
            args.rigs,
            args.out,
            pattern=args.pattern,
            scheduler=args.scheduler,
            workers=args.workers,
            rate=args.rate,
            progress=bar(),
        )
    print_warnings(found.warnings[:_SHOWN])
    if (more := len(found.warnings) - _SHOWN) > 0:
        print_warnings([f"and {more} more, in problems.csv"])
    print(found.summary())
    written = [name for name in _WRITTEN if (args.out / name).exists()]
    print(f"{args.out}: {', '.join(written)}")
    return PROBLEMS if found.problems else 0
