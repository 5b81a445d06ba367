"""The emitted C as people compile it: any compiler, dialect, target and single flag, held to its own header.

A program prints the bits of every function at hard states, with the emitted coefficients and with prepared
ones. Its errors are those from 50 digits, in the units that the header words.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from tests import accuracy, oracle, promised, random_drives
from tests.accuracy import Real
from tests.compiled import GENERATED
from tests.emitted import width
from tests.paper import Parameters
from tests.targets import printed

NAME = "c2_parallel"
PRECISIONS: dict[str, Real] = {"float": np.float32, "double": np.float64}
FUNCTIONS = random_drives.FUNCTIONS
# The split of the period and of the critical velocity differs from drive to drive; the first are Table 1's.
RATIOS = ("0.2", "0.0333333333333333333", "1.87", "0.311")
SIZE = 12


@dataclass(frozen=True, eq=False)
class Drive:
    """A drive by its exact parameters, its states, and the bound of each function."""

    p: Parameters
    at: accuracy.Set
    bounds: dict[str, int]


@cache
def drives(dtype: Real) -> tuple[Drive, ...]:
    """Return the drives, with states anywhere, beside the tops of the link and near the zero of F_N."""
    random, found = np.random.default_rng(3), list[Drive]()
    for ratio in RATIOS:
        table, of_table = accuracy.decimals(mu=ratio), ratio in RATIOS[:2]
        values = {key: float(x) for key, x in vars(table).items()} | {"phi": 0.0}
        states = [x.astype(dtype) for x in random_drives.states(NAME, values, random, SIZE)]
        tops = accuracy.beside_the_tops(oracle.exact(values), dtype)
        few = random.choice(tops.theta_m.size, 3 * SIZE)
        at = accuracy.Set(
            ratio,
            np.concatenate([states[0], tops.theta_m[few]]),
            np.concatenate([states[1], tops.omega_m[few]]),
        )
        # The emitted coefficients are those of exact decimals, prepared ones those of parameters in double.
        p = oracle.exact(values) if found else table
        stated = promised.bounds(NAME).items()
        found.append(Drive(p, at, {key: x.table_1 if of_table else x.anywhere for key, x in stated}))
    return tuple(found)


BITS = """/* By its bits: a compiler may fold what computes it. */
static ECCENTRIC_REAL not_a_number(void)
{
    const unsigned char bytes[2][8] = {{0, 0, 0, 0, 0, 0, 0xf8, 0x7f}, {0, 0, 0xc0, 0x7f}};
    ECCENTRIC_REAL x;
    memcpy(&x, bytes[sizeof x == 4], sizeof x);
    return x;
}

static void show(const ECCENTRIC_REAL *x, unsigned n)
{
    for (unsigned k = 0; k < n; ++k) {
        unsigned char bytes[sizeof *x];
        memcpy(bytes, &x[k], sizeof *x);
        for (unsigned j = sizeof *x; j-- > 0;) { printf("%02x", bytes[j]); }
        printf(" ");
    }
}
"""
"""C for drivers: a NaN, and the bits of numbers."""
_DRIVER = """#include <stdio.h>
#include <string.h>
#include "c2_parallel.h"

@BITS@
static void at(ECCENTRIC_REAL theta_m, ECCENTRIC_REAL omega_m, const c2_parallel_coefficients *c)
{
    ECCENTRIC_REAL out[8];
@CALLS@
    puts("");
}

int main(void)
{
    c2_parallel_parameters p = c2_parallel_default_parameters;
    c2_parallel_coefficients c = c2_parallel_default;
@STATES@
    at(not_a_number(), (ECCENTRIC_REAL)1.0, &c);
    at((ECCENTRIC_REAL)1.0, not_a_number(), &c);
    return 0;
}
"""


def driver(dtype: Real) -> str:
    """Return a C program that prints the bits of all results, a line for each state."""
    calls, lines = [], []
    for function in FUNCTIONS:
        own, (shape, *_) = f"{NAME}_{function}", (*width(NAME, function), 0)
        call = f"{own}(theta_m, omega_m, out, c);" if shape else f"out[0] = {own}(theta_m, omega_m, c);"
        calls.append(f"    {call} show(out, {shape or 1}u);")
    for one in drives(dtype):
        if lines:
            lines += [
                f"    p.mu = {float(one.p.mu).hex()};",
                f"    if ({NAME}_prepare(&p, &c) != 0) {{ return 1; }}",
            ]
        for theta_m, omega_m in zip(one.at.theta_m.tolist(), one.at.omega_m.tolist(), strict=True):
            lines.append(f"    at((ECCENTRIC_REAL){theta_m.hex()}, (ECCENTRIC_REAL){omega_m.hex()}, &c);")
    text = _DRIVER.replace("@BITS@", BITS).replace("@CALLS@", "\n".join(calls))
    return text.replace("@STATES@", "\n".join(lines))


def outcome(
    folder: Path, family: str, target: str, options: tuple[str, ...], real: str
) -> dict[str, float] | str:
    """Return the worst error over its bound, by function; or what the compiler says as it refuses."""
    source = [GENERATED / f"{NAME}.c"]
    compiles, said = printed(folder, family, target, options, real, source, driver(PRECISIONS[real]))
    return errors(said, PRECISIONS[real]) if compiles else said


def errors(said: str, dtype: Real) -> dict[str, float]:
    """Return the worst error over its bound, by function, of what the program prints."""
    rows = [[int(word, 16) for word in line.split()] for line in said.splitlines()]
    values = np.array(rows, f"u{np.dtype(dtype).itemsize}").view(dtype)
    worst: dict[str, float] = dict.fromkeys(FUNCTIONS, 0.0)
    for one in drives(dtype):
        block, values = np.split(values, [one.at.theta_m.size])
        results, column = {}, 0
        for function in FUNCTIONS:
            shape = width(NAME, function)
            results[function] = block[:, column : column + shape[0]] if shape else block[:, column]
            column += shape[0] if shape else 1
        for function, error in promised.errors_of(results, NAME, one.at, one.p).items():
            worst[function] = float(np.maximum(worst[function], error / one.bounds[function]))  # NaN stays
    # Each of the last two states has one NaN: no result that depends on it is a number.
    worst["NaN in, NaN out"] = 0.0 if np.isnan(values[:, :3]).all() else np.inf
    return worst
