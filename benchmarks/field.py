"""The emitted C in the field: whatever flags compile it, and following the friction of its drive."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.cortex_m4 import TOOLS, missing
from benchmarks.record import Measured, Part, progress
from tests import adapt_cost, targets
from tests.learning import errors, learned
from tests.test_flags import PLACES, combinations, kept_or_refused


def measured(quick: bool) -> Part:
    """Count combinations of flags that spoil results, instructions of an update, errors and alarms in the field."""
    figures, left_out = _flags(quick)
    if absent := missing(TOOLS):
        left_out.append(f"Cortex-M4F: not installed: {', '.join(absent)}.")
    else:
        for count in (4, 6):
            progress(f"field: update of {count} coefficients")
            with tempfile.TemporaryDirectory() as folder:
                alone, whole = adapt_cost.costs(adapt_cost.case(count, Path(folder)))
            figures[f"update {count}"] = Measured(alone, f"{alone}, with the alarm {whole}")
    progress("field: ten million samples")
    with tempfile.TemporaryDirectory() as folder:
        said, rows, python = learned(Path(folder))
        found, least = errors(rows, python)
    ((alarms, broken),) = re.findall(r"(\d+) false alarms, (\d+) numbers that are not finite", said)
    ratio = float(np.max(found / least))
    figures |= {
        "learned": Measured(ratio, f"{ratio:.2f}"),
        "false alarms of friction": Measured(int(alarms), alarms),
        "broken": Measured(int(broken), broken),
    }
    return Part(figures, [f"{line}\n" for line in left_out])


def _flags(quick: bool) -> tuple[dict[str, Measured], list[str]]:
    spoiled, tried, left_out = [], 0, []
    for family, target in PLACES[:2] if quick else PLACES:
        progress(f"field: flags of {family}, {target}")
        if absent := targets.missing(family, target):
            left_out.append(f"{family}, {target}: not installed: {', '.join(absent)}.")
            continue
        for options, real in combinations(family, target):
            tried += 1
            with tempfile.TemporaryDirectory() as folder:
                if not kept_or_refused(Path(folder), family, target, options, real):
                    spoiled.append(f"{family} {target} {' '.join(options)} {real}")
    text = f"{len(spoiled)} of {tried}" + "".join(f"; {one}" for one in spoiled)
    return {"flags": Measured(len(spoiled), text)}, left_out
