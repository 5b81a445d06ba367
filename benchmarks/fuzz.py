"""Fuzz everything that reads a user's files: anything but a value or a refusal is a finding, and so is a hang."""

from __future__ import annotations

import collections
import time
import traceback
import warnings
from pathlib import Path

from hypothesis import HealthCheck, Phase, given, seed, settings

from benchmarks.record import Measured, Part, progress
from tests.fuzzing import TARGETS

SLOW_S = 5.0
"""An input that takes longer is a finding: a hang, or on its way to one."""
SEED = 1


def measured(quick: bool) -> Part:
    """Fuzz all targets: 12,000 inputs in all, or 600 if quick."""
    each = -(-(600 if quick else 12_000) // len(TARGETS))
    lines = ["| input | tried | accepted | refused | other | slowest |", "|---" * 6 + "|"]
    findings, tried, odd = 0, 0, []
    with warnings.catch_warnings():
        # Warnings of Python's parser about odd text are irrelevant here.
        warnings.simplefilter("ignore")
        for name in TARGETS:
            progress(f"fuzzed readers: {name}")
            counts, slowest = _fuzz(name, each)
            taken = counts.pop("accepted", 0), counts.pop("refused", 0)
            tried += sum(taken) + counts.total()
            findings += counts.total() + (slowest > SLOW_S)
            odd += [f"{name}: {count} x {what}" for what, count in counts.items()]
            cells = [sum(taken) + counts.total(), *taken, counts.total(), f"{1e3 * slowest:.0f} ms"]
            lines.append(f"| {name} | {' | '.join(map(str, cells))} |")
    counted = Measured(findings, f"{findings} of {tried:,}")
    return Part({"readers": counted}, [*lines, *(f"\n{line}" for line in odd)])


def _fuzz(name: str, inputs: int) -> tuple[collections.Counter[str], float]:
    target = TARGETS[name]
    counts: collections.Counter[str] = collections.Counter()
    slowest = 0.0

    @seed(SEED)
    @settings(
        max_examples=inputs,
        deadline=None,
        database=None,
        derandomize=False,
        phases=(Phase.generate,),
        suppress_health_check=[
            HealthCheck.data_too_large,
            HealthCheck.filter_too_much,
            HealthCheck.too_slow,
            HealthCheck.large_base_example,
        ],
    )
    @given(target.inputs)
    def one(content: object) -> None:
        nonlocal slowest
        start = time.perf_counter()
        try:
            said = target.take(content)
        except Exception as error:  # noqa: BLE001 - this is what fuzzing looks for
            frame = traceback.extract_tb(error.__traceback__)[-1]
            said = f"{type(error).__name__}: {str(error)[:80]} ({Path(frame.filename).name}:{frame.lineno})"
        slowest = max(slowest, time.perf_counter() - start)
        counts[said] += 1

    one()
    return counts, slowest
