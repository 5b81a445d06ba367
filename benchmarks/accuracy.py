"""How exact the emitted code is: full sets of states against 50 digits, in C and NumPy, float and double.

Run: python benchmarks/accuracy.py [--size 60000]     (some ten minutes; it prints one table)
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from eccentric.emit.accuracy import FRICTION_TORQUE_ULP, NORMAL_FORCE_ULP
from tests import accuracy, oracle
from tests.compiled import Library
from tests.emitted import module

NAMES = ("c1_perpendicular", "c2_parallel")


def main() -> None:
    """Print the greatest errors of each set: C with the emitted constants, NumPy with prepared ones."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--size", type=int, default=60_000, help="states of each set")
    size = parser.parse_args().size
    decimals = accuracy.decimals()
    binary = oracle.exact({letter: float(value) for letter, value in vars(decimals).items()})
    print(f"Greatest error in units of the last place, {size} states a set; Table 1 with mu = 1/5")
    print(f"(asked: F_N {NORMAL_FORCE_ULP}; stated: friction torque {FRICTION_TORQUE_ULP}; NaN: none)\n")
    print("| model | precision | set | F_N, C, constants | F_N, NumPy, prepared | friction, NumPy | NaN |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name in NAMES:
            for dtype, precision in ((np.float32, "float"), (np.float64, "double")):
                library = Library(name, dtype, Path(folder))
                for at in accuracy.sets(decimals, dtype, size):
                    states = [getattr(at, one) for one in oracle.inputs(name, "normal_force")]
                    constant = library.many("normal_force", states, library.coefficients())
                    prepared = np.asarray(module(name).normal_force(*states))
                    friction = np.asarray(module(name).friction_torque(*states))
                    errors = (
                        accuracy.units(constant, accuracy.normal_force(name, at, decimals)),
                        accuracy.units(prepared, accuracy.normal_force(name, at, binary)),
                        accuracy.units(friction, accuracy.friction_torque(name, at, binary)),
                    )
                    worst = " | ".join(f"{np.nanmax(error):.2f}" for error in errors)
                    missing = sum(int(np.isnan(error).sum()) for error in errors)
                    print(f"| {name} | {precision} | {at.name} | {worst} | {missing} |", flush=True)


if __name__ == "__main__":
    main()
