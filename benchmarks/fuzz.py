"""Fuzz everything that reads a user's files: a table of what came out, status 1 on anything but a refusal.

Run as `python benchmarks/fuzz.py [--inputs 12000] [--seed 1]`.
"""

from __future__ import annotations

import argparse
import collections
import sys
import time
import traceback
import warnings
from pathlib import Path

from hypothesis import HealthCheck, Phase, given, seed, settings

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.fuzzing import TARGETS

SLOW_S = 5.0
"""An input that takes longer is a finding: a hang, or on its way to one."""


def main() -> int:
    """Run all targets, print the table, return the exit status."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--inputs", type=int, default=12_000, help="inputs in all, spread evenly (12000)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=TARGETS)
    args = parser.parse_args()
    # What Python's parser has to say about odd text is nobody's traceback.
    warnings.simplefilter("ignore")
    chosen = [args.only] if args.only else list(TARGETS)
    each = -(-args.inputs // len(chosen))
    failed = 0
    print("| input | tried | accepted | refused | other | slowest |")
    print("| --- | --- | --- | --- | --- | --- |")
    for name in chosen:
        counts, slowest = _fuzz(name, each, args.seed)
        other = sum(n for what, n in counts.items() if what not in {"accepted", "refused"})
        failed += other + (slowest > SLOW_S)
        print(
            f"| {name} | {counts.total()} | {counts['accepted']} | {counts['refused']} | {other} | {1e3 * slowest:.0f} ms |"
        )
        for what in counts.keys() - {"accepted", "refused"}:
            print(f"  {name}: {counts[what]} x {what}", file=sys.stderr)
    return int(failed > 0)


def _fuzz(name: str, inputs: int, number: int) -> tuple[collections.Counter[str], float]:
    target = TARGETS[name]
    counts: collections.Counter[str] = collections.Counter()
    slowest = 0.0

    @seed(number)
    @settings(
        max_examples=inputs,
        deadline=None,
        database=None,
        derandomize=False,
        phases=(Phase.generate,),
        suppress_health_check=list(HealthCheck),
    )
    @given(target.inputs)
    def one(content: object) -> None:
        nonlocal slowest
        start = time.perf_counter()
        try:
            said = target.take(content)
        except Exception as error:  # noqa: BLE001 - this is what is looked for
            frame = traceback.extract_tb(error.__traceback__)[-1]
            said = f"{type(error).__name__}: {str(error)[:80]} ({Path(frame.filename).name}:{frame.lineno})"
        slowest = max(slowest, time.perf_counter() - start)
        counts[said] += 1

    one()
    return counts, slowest


if __name__ == "__main__":
    sys.exit(main())
