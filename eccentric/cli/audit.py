"""`eccentric audit`: the paper's tables and claims against the derivation."""

import argparse

NAME = "audit"
HELP = "check the paper's Table 1 and claims against the derivation"
EXAMPLE = "eccentric audit"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add no arguments."""


def run(arguments: argparse.Namespace) -> int:
    """Print Table 1 side by side with the derivation, then the findings."""
    from eccentric.paper import findings, table_1

    del arguments
    print(table_1())
    for number, finding in enumerate(findings(), 1):
        print(f"\n{number}. {finding}")
    return 0
