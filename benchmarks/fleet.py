"""Fleets: what is found on a large one of the virtual bench, and the cost of sums beside a bare scan and peers.

Run: python benchmarks/page.py fleet cost

The peers read the same columns and form the same normal equations of four friction terms by joint and month
from angle and current as logged, with np.gradient for the rates: without low pass, mask, intervals or QR, they
do less than what they are compared with. tsfresh extracts features in their place. All but NumPy are timed where
they are installed.
"""

from __future__ import annotations

import importlib.util
import json
import os
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import eccentric
from benchmarks.record import Measured, Part, peak, progress
from eccentric.fleet import Assigned, connected, gather, plan_of
from eccentric.fleet import find as find_logs

COLUMNS = ["time_s", "theta_m_rad", "current_A", "temperature_C"]
JOINTS = 1000
MONTHS = 12
SECONDS = 450.0
"""A log's length [s] where findings are counted: the fleet as arrays is then 26 GB."""
TIMED_S = 500.0
"""Where times are taken: files of a few megabytes, as a fleet has that is larger than memory."""
RATE_HZ = 200.0
ROW_BYTES = 24
SEED = 23
TIMED_JOINTS = 24
"""Of whose logs times are taken: enough that it does not matter which worker has the last ones."""
ROUNDS = 5
SCAN = "bare scan by PyArrow"
WORKERS = ("sums, one worker", "sums, two workers")


def found(quick: bool) -> Part:
    """What is found on the fleet; in the quick form, of sixty joints with short logs."""
    joints, seconds = (60, 40.0) if quick else (JOINTS, SECONDS)
    with tempfile.TemporaryDirectory() as place:
        root = Path(place)
        progress(f"writing {joints} joints")
        eccentric.bench_fleet(
            root / "fleet",
            joints=joints,
            months=MONTHS,
            degrading=joints // 50,
            bad_sensors=2,
            seconds=seconds,
            seed=SEED,
        )
        size = sum(p.stat().st_size for p in root.rglob("*.parquet"))
        rows = joints * MONTHS * seconds * RATE_HZ
        lines = [
            f"{joints} joints, {MONTHS} months, {rows:.3g} rows: {size / 1e9:.1f} GB of Parquet,"
            f" {rows * ROW_BYTES / 1e9:.1f} GB as arrays.",
            "",
        ]
        figures, told = _found(root)
    return Part(figures, [*lines, *told])


def cost(quick: bool) -> Part:
    """What sums cost beside a bare scan and peers; in the quick form, of short logs."""
    with tempfile.TemporaryDirectory() as place:
        figures, lines = _times(Path(place), 40.0 if quick else TIMED_S)
    return Part(figures, lines)


def _found(root: Path) -> tuple[dict[str, Measured], list[str]]:
    """How many of the joints that change are found, and named."""
    progress("the whole fleet")
    start = time.perf_counter()
    with connected(None, os.cpu_count() or 1) as client:
        result = eccentric.diagnose_fleet(
            root / "fleet" / "logs",
            root / "fleet" / "rigs.csv",
            root / "out",
            scheduler=client.scheduler.address,
        )
        memory = max(client.run(peak).values())
    took = time.perf_counter() - start
    truth: dict[str, Any] = json.loads((root / "fleet" / "truth.json").read_text(encoding="utf-8"))
    worn = {joint for joint, sealed in truth.items() if not sealed["sensor"]}
    called = {one.joint: one for one in result.drifting if not one.sensor}
    words = {"coulomb": "Coulomb", "load": "follows the load"}
    right = {
        j for j in worn & set(called) if words.get(truth[j]["way"], str(truth[j]["way"])) in called[j].what
    }
    false = set(called) - worn
    figures = {
        "fleet found": Measured(
            len(worn & set(called)) / len(worn), f"{len(worn & set(called))} of {len(worn)}"
        ),
        "fleet family": Measured(len(right) / len(worn), f"{len(right)} of {len(worn)}"),
        "fleet alarms": Measured(len(false)),
        "fleet memory": Measured(memory / 1e9),
    }
    lines = [
        f"The whole run, from files to the page with its reports, took {took:.0f} s.",
        *(
            f"- {joint}: {truth[joint]['way']}, said: {called[joint].what if joint in called else 'nothing'}"
            for joint in sorted(worn - right)
        ),
        *(f"- {joint}: no change, said: {called[joint].what}" for joint in sorted(false)),
        "",
    ]
    return figures, lines


def _times(root: Path, seconds: float) -> tuple[dict[str, Measured], list[str]]:
    """Times for the logs of some joints: medians of rounds, one thread but for the two workers."""
    some = root / "some"
    eccentric.bench_fleet(
        some, joints=TIMED_JOINTS, months=MONTHS, degrading=1, bad_sensors=1, seconds=seconds, seed=SEED
    )
    files = sorted(some.rglob("*.parquet"))
    peers: dict[str, Callable[[], object]] = {SCAN: lambda: _scan(files)}
    for name, (module, run) in PEERS.items():
        if importlib.util.find_spec(module):
            peers[name] = lambda run=run: run(files)
    rigs, logs = Assigned(str(some / "rigs.csv")), find_logs(str(some / "logs"))[0]
    times: dict[str, list[float]] = {name: [] for name in (*peers, *WORKERS)}
    for run in peers.values():
        run()
    with connected(None, 1) as one, connected(None, 2) as two:
        for k in range(ROUNDS + 1):
            for client, name in zip((one, two), WORKERS, strict=True):
                progress(f"{name}, round {k}")
                out = root / name.replace(" ", "_") / str(k)
                plan = plan_of(logs, rigs, out)
                scan = _timed(peers[SCAN])
                took = _timed(
                    lambda plan=plan, client=client, out=out: gather(
                        plan, client, out, lambda part, what: None
                    )
                )
                if k:  # The first round starts the workers' imports.
                    times[SCAN].append(scan)
                    times[name].append(took)
    for name in list(peers)[1:]:
        times[name] = [_timed(peers[name]) for _ in range(ROUNDS)]
    took = {name: statistics.median(some) for name, some in times.items() if some}
    over = {name: seconds / took[SCAN] for name, seconds in took.items()}
    alone, together = (took[name] for name in WORKERS)
    others = "; ".join(f"{name} {over[name]:.1f}" for name in peers if name != SCAN)
    figures = {
        "fleet cost": Measured(alone / took[SCAN], f"{alone / took[SCAN]:.1f} ({alone:.2f} s)", others),
        "fleet two": Measured(alone / together),
    }
    table = [
        f"Sums of {len(files)} files of {seconds * RATE_HZ:.0f} rows, with their QR, written to a store;"
        " the peers form bare normal equations.",
        "",
        "| | time | over the scan |",
        "|---|---|---|",
        *(f"| {name} | {took[name]:.2f} s | {over[name]:.1f} |" for name in took),
    ]
    return figures, table


def _timed(run: Callable[[], object]) -> float:
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def _scan(files: Sequence[Path]) -> None:
    from pyarrow import parquet

    for path in files:
        with parquet.ParquetFile(path) as file:
            file.read(COLUMNS, use_threads=False)


def _design(t: Any, theta: Any) -> Any:
    """Four columns of friction, from angle alone."""
    w = np.gradient(theta, t)
    force = np.hypot(w**2 * np.sin(0.2 * theta), w**2 * np.cos(0.2 * theta) + 1.0)
    sign = np.sign(w)
    return np.column_stack([w * force, sign * force, w, sign])


def _numpy(files: Sequence[Path]) -> None:
    from pyarrow import parquet

    for path in files:
        with parquet.ParquetFile(path) as file:
            table = file.read(COLUMNS, use_threads=False)
        t, theta, current = (np.asarray(table[name], float) for name in COLUMNS[:3])
        np.linalg.lstsq(_design(t, theta), current, rcond=None)


def _pandas(files: Sequence[Path]) -> None:
    pandas = importlib.import_module("pandas")
    frames = (pandas.read_parquet(p, columns=COLUMNS).assign(file=k) for k, p in enumerate(files))
    for _, rows in pandas.concat(frames).groupby("file"):
        t, theta, current = (rows[name].to_numpy(float) for name in COLUMNS[:3])
        np.linalg.lstsq(_design(t, theta), current, rcond=None)


def _tsfresh(files: Sequence[Path]) -> None:
    """Its minimal set of features, ten numbers of a channel such as mean and variance, in place of sums."""
    pandas, tsfresh = importlib.import_module("pandas"), importlib.import_module("tsfresh")
    chosen = importlib.import_module("tsfresh.feature_extraction").MinimalFCParameters()
    for path in files:
        rows = pandas.read_parquet(path, columns=COLUMNS).assign(file=0)
        tsfresh.extract_features(
            rows,
            column_id="file",
            column_sort="time_s",
            default_fc_parameters=chosen,
            n_jobs=0,
            disable_progressbar=True,
        )


_TERMS = ("w * f", "s * f", "w", "s")


def _products() -> list[str]:
    terms = [*_TERMS, "current_A"]
    return [f"sum(({a}) * ({b}))" for k, a in enumerate(terms) for b in terms[k:]]


def _duckdb(files: Sequence[Path]) -> None:
    duckdb = importlib.import_module("duckdb")
    sums = ", ".join(_products())
    force = "sqrt(power(w * w * sin(0.2 * theta_m_rad), 2) + power(w * w * cos(0.2 * theta_m_rad) + 1, 2))"
    steps = (
        "(lead(theta_m_rad) over p - lag(theta_m_rad) over p) / (lead(time_s) over p - lag(time_s) over p)"
    )
    connection = duckdb.connect()
    connection.execute("set threads = 1")
    connection.execute(
        f"select filename, {sums} from (select *, sign(w) as s, {force} as f from (select filename, theta_m_rad,"  # noqa: S608 - names are ours
        f" current_A, {steps} as w from read_parquet({list(map(str, files))}, filename = true)"
        " window p as (partition by filename order by time_s))) group by filename"
    ).fetchall()


def _polars(files: Sequence[Path]) -> None:
    polars = importlib.import_module("polars")
    theta, t, current = polars.col("theta_m_rad"), polars.col("time_s"), polars.col("current_A")
    w = (theta.shift(-1) - theta.shift(1)) / (t.shift(-1) - t.shift(1))
    force = ((w**2 * (0.2 * theta).sin()) ** 2 + (w**2 * (0.2 * theta).cos() + 1.0) ** 2).sqrt()
    terms = [w * force, w.sign() * force, w, w.sign(), current]
    products = [
        (a * b).sum().alias(f"{j}{k}") for j, a in enumerate(terms) for k, b in enumerate(terms) if k >= j
    ]
    for path in files:
        polars.read_parquet(path, columns=COLUMNS).select(products)


PEERS: dict[str, tuple[str, Callable[[Sequence[Path]], None]]] = {
    "NumPy by file, lstsq": ("numpy", _numpy),
    "pandas groupby, lstsq": ("pandas", _pandas),
    "DuckDB": ("duckdb", _duckdb),
    "Polars": ("polars", _polars),
    "tsfresh, minimal features": ("tsfresh", _tsfresh),
}
