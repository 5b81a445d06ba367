"""Fleets: what is found on a large one of the virtual bench, and the cost of sums beside a bare scan and peers.

Run: python benchmarks/fleet.py [JOINTS [SECONDS [SEED]]]     (1000 joints, 40 s a log, seed 21; 12 months)

The peers read the same columns and form the same normal equations of four friction terms by joint and month
from angle and current as logged, with np.gradient for the rates: without low pass, mask, intervals or QR, they
do less than what they are compared with. DuckDB and Polars are timed where they are installed.
"""

from __future__ import annotations

import importlib
import json
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import eccentric
from eccentric.fleet import Assigned, connected, gather, plan_of
from eccentric.fleet import find as find_logs

COLUMNS = ["time_s", "theta_m_rad", "current_A", "temperature_C"]
TIMED_JOINTS = 40


def main(argv: Sequence[str]) -> int:
    """Write a fleet, run it, print what was found, then the times of a part of it."""
    given = [*argv, *("1000", "40", "21")[len(argv) :]]
    joints, seconds, seed = int(given[0]), float(given[1]), int(given[2])
    with tempfile.TemporaryDirectory() as place:
        root = Path(place)
        eccentric.bench_fleet(
            root / "fleet",
            joints=joints,
            months=12,
            degrading=joints // 50,
            bad_sensors=2,
            seconds=seconds,
            seed=seed,
        )
        size = sum(p.stat().st_size for p in root.rglob("*.parquet"))
        print(
            f"{joints} joints, 12 months, {joints * 12 * seconds * 200:.3g} rows, {size / 1e9:.2f} GB of Parquet"
        )
        _times(root)
        _found(root)
    return 0


def _found(root: Path) -> None:
    """How many of the joints that change are found, and named."""
    start = time.perf_counter()
    result = eccentric.diagnose_fleet(root / "fleet" / "logs", root / "fleet" / "rigs.csv", root / "out")
    took = time.perf_counter() - start
    truth: dict[str, Any] = json.loads((root / "fleet" / "truth.json").read_text(encoding="utf-8"))
    worn = {joint for joint, sealed in truth.items() if not sealed["sensor"]}
    called = {one.joint: one for one in result.drifting if not one.sensor}
    words = {"coulomb": "Coulomb", "load": "follows the load"}
    right = {
        j for j in worn & set(called) if words.get(truth[j]["way"], str(truth[j]["way"])) in called[j].what
    }
    print(f"whole run: {took:.0f} s")
    print(
        f"found {len(worn & set(called))} of {len(worn)}; family right {len(right)}; false alarms {len(set(called) - worn)}"
    )
    for joint in sorted(worn - right):
        print(
            f"  {joint}: {truth[joint]['way']}, said: {called[joint].what if joint in called else 'nothing'}"
        )
    for joint in sorted(set(called) - worn):
        print(f"  {joint}: no change, said: {called[joint].what}")


def _times(root: Path) -> None:
    """Seconds for the logs of some joints, once each in this order, all in one process but the two clusters."""
    part = root / "part"
    for folder in sorted((root / "fleet" / "logs").iterdir())[:TIMED_JOINTS]:
        shutil.copytree(folder, part / folder.name)
    files = sorted(part.rglob("*.parquet"))
    _scan(files)
    scan = _timed(lambda: _scan(files))
    print(f"{len(files)} files; bare scan by PyArrow {scan:.2f} s; over it:")
    for workers in (1, 2):
        took, memory = _sums(part, root, workers)
        print(
            f"  sums, {workers} worker(s): {took / scan:.1f} ({took:.2f} s), a worker's memory {memory / 1e6:.0f} MB"
        )
    peers: dict[str, tuple[str, Callable[[Sequence[Path]], None]]] = {
        "NumPy by file, lstsq": ("numpy", _numpy),
        "pandas groupby, lstsq": ("pandas", _pandas),
        "DuckDB": ("duckdb", _duckdb),
        "Polars": ("polars", _polars),
    }
    for name, (module, run) in peers.items():
        try:
            importlib.import_module(module)
        except ImportError:
            print(f"  {name}: not installed")
            continue
        print(f"  {name}: {_timed(lambda run=run: run(files)) / scan:.1f}")


def _sums(part: Path, root: Path, workers: int) -> tuple[float, float]:
    """Time of the sums on a cluster that has done some before, and the largest memory of a worker [B]."""
    import psutil

    rigs = Assigned(str(root / "fleet" / "rigs.csv"))
    logs = find_logs(str(part))[0]
    with connected(None, workers) as client:
        for place, some in (("warm", logs[:: max(len(logs) // 48, 1)]), ("all", logs)):
            out = root / f"{place}{workers}"
            plan = plan_of(some, rigs, out)
            took = _timed(lambda plan=plan, out=out: gather(plan, client, out, lambda part, what: None))
        memory = max(client.run(lambda: psutil.Process().memory_info().rss).values())
    return took, memory


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


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
