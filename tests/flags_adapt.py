"""The emitted estimator as people compile it: what it learns from a fixed record, held to the emitted Python.

A program prints the bits of the coefficients after the record, then a row that is not a number. Their errors
are in the standard deviations that it states, of which a ten-thousandth misleads nobody in `float`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from tests.accuracy import Real
from tests.adapted import current, emitted, module, motion
from tests.flags import BITS, PRECISIONS
from tests.targets import printed

NAME = "c2_parallel"
ROWS, STEP = 600, 4e-3
BOUNDS = {"float": 1e-4, "double": 1e-12}
"""Of the error of a coefficient over its standard deviation after the record."""

_DRIVER = """#include <stdio.h>
#include <string.h>
#include "c2_parallel_adapt.h"

static const ECCENTRIC_REAL rows[][4] = {
@ROWS@
};

@BITS@
int main(void)
{
    static c2_parallel_adapt_state learned;
    unsigned long updated = 0;
    c2_parallel_adapt_init(&learned);
    for (unsigned k = 0; k < sizeof rows / sizeof rows[0]; ++k) {
        const ECCENTRIC_REAL *x = rows[k];
        updated += c2_parallel_adapt(x[0], x[1], x[2], x[3], &learned, &c2_parallel_default)
                   & C2_PARALLEL_ADAPT_UPDATED;
    }
    show(learned.coefficient, C2_PARALLEL_ADAPT_COEFFICIENTS);
    printf("%lx\\n", updated);
    updated = c2_parallel_adapt(not_a_number(), 20, 0, 1, &learned, &c2_parallel_default);
    show(learned.coefficient, C2_PARALLEL_ADAPT_COEFFICIENTS);
    printf("%lx\\n", updated);
    return 0;
}
"""


@dataclass(frozen=True, eq=False)
class Record:
    """A record, and what the emitted Python learns from it in the same precision.

    Attributes:
        driver: the program that replays it.
        coefficients, deviations: after it (4,).
        updated: number of rows learned from.
    """

    driver: str
    coefficients: np.ndarray
    deviations: np.ndarray
    updated: int


@cache
def kept() -> TemporaryDirectory[str]:
    """Return a folder that lasts as long as this process."""
    return TemporaryDirectory(prefix="estimator-")


@cache
def folder() -> Path:
    """Return where the model and its estimator are."""
    return emitted(Path(kept().name), NAME)


@cache
def record(dtype: Real) -> Record:
    """Return swings with rests in between, of a drive with a fifth more friction than assumed."""
    python = module(folder(), NAME)
    moved = motion(ROWS, 3, step=STEP)
    friction = 1.2 * np.abs(python.model.mechanical_friction_torque(*moved[:2]))
    driven = current(python.model, moved, friction, np.random.default_rng(3).normal(0, 0.007, ROWS))
    rows = np.stack([*moved, driven], axis=1).astype(dtype)
    state: Any = python.init(dtype)
    flags = python.replay(*rows.T, state)["flags"]
    assert {python.STILL, python.UPDATED} <= set(flags.tolist())
    text = ",\n".join(
        "    {" + ", ".join(f"(ECCENTRIC_REAL){x.hex()}" for x in row) + "}" for row in rows.tolist()
    )
    return Record(
        _DRIVER.replace("@BITS@", BITS).replace("@ROWS@", text),
        np.array(state.coefficient, float),
        np.array(python.deviations(state), float),
        int(np.count_nonzero(flags & python.UPDATED)),
    )


def outcome(
    place: Path, family: str, target: str, options: tuple[str, ...], real: str
) -> dict[str, float] | str:
    """Return the worst error over its bound; or what the compiler says of the estimator as it refuses it."""
    asked = record(PRECISIONS[real])
    sources = [folder() / f"{NAME}.c", folder() / f"{NAME}_adapt.c"]
    compiles, said = printed(place, family, target, options, real, sources, asked.driver)
    if not compiles:
        # The model beside it is refused as well, which would hide a source that is not.
        return "\n".join(line for line in said.splitlines() if f"{NAME}_adapt.c:" in line)
    learned, after = ([int(word, 16) for word in line.split()] for line in said.splitlines())
    dtype = np.dtype(PRECISIONS[real])
    found = np.array(learned[:-1], f"u{dtype.itemsize}").view(dtype)
    error = float(np.max(np.abs(found - asked.coefficients) / asked.deviations))  # NaN stays
    left_out = after == [*learned[:-1], 4]
    return {
        "coefficients": error / BOUNDS[real],
        "rows learned from": 0.0 if learned[-1] == asked.updated else np.inf,
        "NaN in, left out": 0.0 if left_out else np.inf,
    }
