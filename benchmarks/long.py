"""Long logs: time and memory of a fit and a diagnosis of hours at 1 kHz, beside a bare scan and other engines.

The log is one hour of the virtual bench at 1 kHz with Stribeck friction; the longer one is that hour again and
again, with new noise. Each engine runs in a process of its own, which reports its peak memory.

    the scan     PyArrow reads the used columns and does nothing else; without its pre-buffer, which keeps what
                 was read in memory and takes longer
    the sums     DuckDB and Polars make the sums of four columns and the drive, pandas with NumPy fits them;
                 nothing is filtered, checked or compared
    the fit      `eccentric.fit`: the pass over all rows, the windows, and the fit

Run: python benchmarks/long.py [--quick]
"""

from __future__ import annotations

import itertools
import json
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import numpy as np

from benchmarks.asked import DIAGNOSIS
from benchmarks.record import Measured, Part, progress, table
from eccentric.virtual_bench import random_scenario, simulate

ROOT = Path(__file__).resolve().parent.parent
HOUR_S, RATE_HZ, HOURS = 3600.0, 1000, 30_000_000 / 3_600_000
GAP_S = 1.0
"""Between one hour and the next: the drive does not end where it began."""
ROUNDS = 5
_PAIRS = list(itertools.combinations_with_replacement("abdey", 2))
"""Columns whose products the peers sum: direction, speed, gravity in two parts, current."""
USED = ("time_s", "theta_m_rad", "omega_m_rad_s", "voltage_V", "current_A")
SCAN = "scan"
_OWN = {"fit": "eccentric.fit", "diagnose": "eccentric.diagnose"}
_PROCESS = """
import json, sys
from benchmarks import long
what, log, rig, rounds = sys.argv[1:]
print(json.dumps(long.timed(what, log, rig, int(rounds))))
"""


def timed(what: str, log: str, rig: str, rounds: int) -> dict[str, Any]:
    """Medians of seconds and of processor seconds over the rounds, peak memory [MB] and what was found.

    One round more comes first, which imports what is needed.
    """
    seconds, busy, found = [], [], ""
    for _ in range(rounds + (rounds > 1)):
        begun, used = time.perf_counter(), time.process_time()
        found = ENGINES[what](log, rig)
        seconds.append(time.perf_counter() - begun)
        busy.append(time.process_time() - used)
    # Not `getrusage`, whose peak begins with that of the process that has started this one.
    status = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    peak = next(int(line.split()[1]) for line in status if line.startswith("VmHWM:")) / 1e3
    return {
        "seconds": statistics.median(seconds[-rounds:]),
        "busy": statistics.median(busy[-rounds:]),
        "MB": peak,
        "found": found,
    }


def _scan(log: str, _: str) -> str:
    parquet: Any = __import__("pyarrow.parquet").parquet
    with parquet.ParquetFile(log, pre_buffer=False) as file:
        return str(sum(len(batch) for batch in file.iter_batches(1 << 17, columns=list(USED))))


def _fit(log: str, rig: str) -> str:
    import eccentric

    found = eccentric.fit(log, rig)
    return ", ".join(f"{name} {e.value:.4g}" for name, e in found.estimates.items())


def _diagnose(log: str, rig: str) -> str:
    import eccentric

    found = eccentric.diagnose(log, rig)
    return f"{found.verdict}: {', '.join(found.effects)}"


def _pandas(log: str, _: str) -> str:
    import pandas as pd  # pyright: ignore[reportMissingImports]

    table = pd.read_parquet(log, columns=list(USED))
    omega, theta = table.omega_m_rad_s.to_numpy(), table.theta_m_rad.to_numpy()
    columns = np.column_stack([np.sign(omega), omega, np.sin(0.2 * theta), np.cos(0.2 * theta)])
    found = np.linalg.lstsq(columns, table.current_A.to_numpy(), rcond=None)[0]
    return f"{len(found)} coefficients"


def _duckdb(log: str, _: str) -> str:
    import duckdb  # pyright: ignore[reportMissingImports]

    base = {"a": "sign(omega_m_rad_s)", "b": "omega_m_rad_s", "y": "current_A"}
    base |= {"d": "sin(0.2 * theta_m_rad)", "e": "cos(0.2 * theta_m_rad)"}
    table = duckdb.read_parquet(log).select(", ".join(f"{x} as {name}" for name, x in base.items()))
    return f"{len(table.aggregate(', '.join(f'sum({a} * {b})' for a, b in _PAIRS)).fetchall()[0])} sums"


def _polars(log: str, _: str) -> str:
    import polars as pl  # pyright: ignore[reportMissingImports]

    omega, theta = pl.col("omega_m_rad_s"), pl.col("theta_m_rad")
    frame = pl.scan_parquet(log).select(
        a=omega.sign(), b=omega, d=(0.2 * theta).sin(), e=(0.2 * theta).cos(), y=pl.col("current_A")
    )
    return (
        f"{frame.select((pl.col(a) * pl.col(b)).sum().alias(a + b) for a, b in _PAIRS).collect().width} sums"
    )


ENGINES = {
    SCAN: _scan,
    "fit": _fit,
    "diagnose": _diagnose,
    "pandas": _pandas,
    "duckdb": _duckdb,
    "polars": _polars,
}
PEERS = ("pandas", "duckdb", "polars")


def run(what: str, log: Path, rig: Path, rounds: int) -> dict[str, Any] | None:
    """Measure one engine in its own process; None where it is not installed."""
    progress(f"{log.stem}: {what}")
    command = [sys.executable, "-c", _PROCESS, what, str(log), str(rig), str(rounds)]
    told = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False)
    if told.returncode and "ModuleNotFoundError" in told.stderr:
        return None
    if told.returncode:
        raise RuntimeError(told.stderr.strip().splitlines()[-1])
    return json.loads(told.stdout.splitlines()[-1])


def written(folder: Path, seconds: float) -> tuple[Path, Path, Path]:
    """The log of an hour, the longer one and their rig."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    progress("simulating an hour at 1 kHz")
    drawn = random_scenario(
        np.random.default_rng(3),
        case="C2",
        mu=0.2,
        log_type="traj",
        effects=[("stribeck", 0.2)],
        seconds=seconds,
    )
    # As many steps a second as at the bench's own rate.
    steps = drawn.steps_per_sample * drawn.sample_rate_hz // RATE_HZ
    found = simulate(replace(drawn, sample_rate_hz=RATE_HZ, steps_per_sample=steps))
    rig, hour, hours = folder / "rig.json", folder / "hour.parquet", folder / "hours.parquet"
    rig.write_text(json.dumps(found.rig), encoding="utf-8")
    pq.write_table(pa.table(found.columns), hour, row_group_size=1 << 17)
    rng, rows = np.random.default_rng(1), len(found.columns["time_s"])
    schema, left, start = pa.table(found.columns).schema, round(HOURS * rows), 0.0
    bit = float(np.max(np.abs(found.columns["current_A"]))) / 2048
    with pq.ParquetWriter(hours, schema) as writer:
        while left > 0:
            own = {name: x[:left] for name, x in found.columns.items()}
            own["time_s"] = np.round(own["time_s"] + start, 3)
            own["current_A"] = own["current_A"] + bit * rng.standard_normal(len(own["current_A"]))
            writer.write_table(pa.table(own, schema=schema), row_group_size=1 << 17)
            left, start = left - rows, float(own["time_s"][-1]) + GAP_S
    return hour, hours, rig


def measured(quick: bool) -> Part:
    """Times and memory; in the quick form, of six minutes and fifty."""
    rounds = 3 if quick else ROUNDS
    figures: dict[str, Measured] = {}
    lines = [
        "| log | engine | time | processor time | over the scan | memory | |",
        "|---|---|---|---|---|---|---|",
    ]
    with tempfile.TemporaryDirectory() as name:
        hour, hours, rig = written(Path(name), HOUR_S / 10 if quick else HOUR_S)
        for key, log in (("hour", hour), ("hours", hours)):
            found = {}
            for what in (SCAN, "fit", *PEERS, "diagnose"):
                one = run(what, log, rig, 1 if what == "diagnose" else rounds)
                if one is not None:
                    found[what] = one
            # Processor time: on a shared machine a short scan is seldom interrupted, a long fit often.
            ratio = {what: one["busy"] / found[SCAN]["busy"] for what, one in found.items()}
            for what, one in found.items():
                lines.append(
                    f"| {int(found[SCAN]['found']):,} rows | {_OWN.get(what, what)} | {one['seconds']:.3g} s |"
                    f" {one['busy']:.3g} s | {ratio[what]:.3g} | {one['MB']:.0f} MB | {one['found']} |"
                )
            peer = "; ".join(f"{what} {ratio[what]:.1f}" for what in PEERS if what in ratio)
            figures[f"long fit {key}"] = Measured(
                ratio["fit"], f"{ratio['fit']:.1f} ({found['fit']['seconds']:.2f} s)", peer
            )
            seconds, gigabytes = found["diagnose"]["seconds"], found["diagnose"]["MB"] / 1e3
            if key == "hour":
                figures["long seconds"] = Measured(seconds, f"{seconds:.0f} s")
            figures[f"long memory {key}"] = Measured(gigabytes, f"{gigabytes:.2f} GB")
    return Part(figures, lines)


if __name__ == "__main__":
    part = measured("--quick" in sys.argv)
    print("\n".join([*part.details, "", *table({key: DIAGNOSIS[key] for key in part.figures}, part.figures)]))
