"""Whether two results are the same: diagnosis.json or fit.json files, number by number.

    python benchmarks/compare_results.py BEFORE AFTER [--tolerance 1e-9]

BEFORE and AFTER are files, or folders whose JSON files are paired by their relative path, such as
benchmarks/reference_results.py writes.  Texts, lists and keys have to be equal; numbers agree where they differ by
at most the tolerance times the larger magnitude, NaN with NaN.  Prints each difference, and exits 1 if there is one.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any


def differences(before: Any, after: Any, tolerance: float, at: str = "") -> Iterator[str]:
    """Yield one line for each place where two JSON documents differ."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key in sorted({*before, *after}):
            if key not in before or key not in after:
                yield f"{at}/{key}: only in the {'second' if key in after else 'first'}"
            else:
                yield from differences(before[key], after[key], tolerance, f"{at}/{key}")
    elif isinstance(before, list) and isinstance(after, list):
        if len(before) != len(after):
            yield f"{at}: {len(before)} entries, then {len(after)}"
        else:
            for number, (one, two) in enumerate(zip(before, after, strict=True)):
                yield from differences(one, two, tolerance, f"{at}/{number}")
    elif not _agree(before, after, tolerance):
        yield f"{at}: {before!r}, then {after!r}"


def _agree(before: Any, after: Any, tolerance: float) -> bool:
    """Whether two numbers agree, or two other values are equal; true is not 1."""
    if not all(isinstance(value, int | float) and not isinstance(value, bool) for value in (before, after)):
        return type(before) is type(after) and before == after
    if math.isnan(before) or math.isnan(after):
        return math.isnan(before) and math.isnan(after)
    return math.isclose(before, after, rel_tol=tolerance, abs_tol=0.0)


def pairs(before: Path, after: Path) -> list[tuple[Path, Path]]:
    """The files to compare; a file of one folder that the other one lacks is in the list too."""
    if before.is_file():
        return [(before, after)]
    names = sorted({p.relative_to(folder) for folder in (before, after) for p in folder.rglob("*.json")})
    return [(before / name, after / name) for name in names]


def main() -> int:
    """Compare, print, and return 1 if anything differs."""
    parser = argparse.ArgumentParser(description="Compares two results number by number.")
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--tolerance", type=float, default=1e-9, help="relative, default 1e-9")
    args = parser.parse_args()
    compared = pairs(args.before, args.after)
    if not compared:
        parser.error(f"{args.before}: no JSON file found")
    found = 0
    for one, two in compared:
        if missing := [str(p) for p in (one, two) if not p.is_file()]:
            print(f"{missing[0]}: required to compare, not there")
            found += 1
            continue
        first, second = (json.loads(p.read_text(encoding="utf-8")) for p in (one, two))
        for line in differences(first, second, args.tolerance):
            print(f"{two}: {line}")
            found += 1
    print(f"{len(compared)} pairs compared, {found} differences")
    return int(found > 0)


if __name__ == "__main__":
    sys.exit(main())
