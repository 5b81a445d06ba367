"""Results of `eccentric diagnose` and `eccentric fit` on the reference logs, in a folder, to compare with another.

    python benchmarks/reference_results.py OUT --data DATA [NAME ...]
    python benchmarks/compare_results.py BEFORE OUT

DATA has a folder `examples` (example1 to example4, each a log and a rig) and a folder `measured` (one folder for
each set of logs).  The bundled log needs no DATA.  Writes OUT/NAME/diagnose/diagnosis.json and OUT/NAME/fit/fit.json
with the rest of what the two commands write.  Every run is a process of its own, one for each processor at a time.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from benchmarks.measured_logs import ROOT, SETS, measured_log

COMMANDS = ("diagnose", "fit")
Logs = Mapping[str, tuple[Path, Path]]
"""Name -> log and rig file."""


def reference_logs(data: Path | None) -> Logs:
    """The bundled log and, where `data` is given, the four examples and the five measured rigs."""
    bundled = ROOT / "examples" / "bench"
    logs = {"bench": (bundled / "bench.csv.gz", bundled / "bench.json")}
    if data is None:
        return logs
    examples = {f"example{k}": data / "examples" / f"example{k}" for k in range(1, 5)}
    return {
        **logs,
        **{name: (path.with_suffix(".csv.gz"), path.with_suffix(".json")) for name, path in examples.items()},
        **{name: measured_log(data / "measured", name) for name in SETS},
    }


def run(command: str, name: str, log: Path, rig: Path, out: Path) -> str:
    """Run one command on one log into OUT/NAME/COMMAND; return what went wrong, "" if nothing did."""
    arguments = [command, str(log), "--rig", str(rig), "--out", str(out / name / command)]
    # One thread each: those of a linear algebra library would wait for each other.
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-m", "eccentric", *arguments],
        capture_output=True,
        text=True,
        check=False,
        env=environment,
    )
    return f"{command} {name}: {done.stderr.strip()}" if done.returncode else ""


def run_all(logs: Logs, out: Path) -> Sequence[str]:
    """Run both commands on all logs; return what went wrong, one line each."""
    jobs = [(command, name, *files, out) for name, files in logs.items() for command in COMMANDS]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return [failed for failed in pool.map(lambda job: run(*job), jobs) if failed]


def main() -> int:
    """Write the results; status 1 if a command failed."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("out", type=Path, help="a folder that does not exist yet")
    parser.add_argument("names", nargs="*", metavar="NAME", help="logs, by default all")
    parser.add_argument("--data", type=Path, help="folder of the logs that are not bundled")
    args = parser.parse_args()
    logs = reference_logs(args.data)
    if unknown := sorted(set(args.names) - set(logs)):
        parser.error(f"{unknown[0]}: required one of {', '.join(logs)}")
    if args.out.exists():
        parser.error(f"{args.out}: required a new folder; received one that exists")
    failed = run_all({name: logs[name] for name in args.names or logs}, args.out)
    print("\n".join(failed), end="\n" if failed else "")
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main())
