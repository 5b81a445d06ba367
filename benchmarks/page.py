"""What was asked of the emitted code beside what is measured and its peers: benchmarks/emitted.md, one figure.

Run: python benchmarks/page.py [--quick]     (--quick: fewer rounds and states, no peers on the target)
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
from benchmarks import host, speed  # noqa: E402
from tests import accuracy, oracle  # noqa: E402
from tests.emitted import module  # noqa: E402

HERE = Path(__file__).resolve().parent


def main() -> None:
    """Write page and figure."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--quick", action="store_true", help="fewer rounds and states, no peers on the target"
    )
    quick = parser.parse_args().quick
    python = sys.executable
    size, few = ("300", ["--no-peers"]) if quick else ("60000", [])
    result = speed.measured(quick)
    rows = [*speed.asked(result), *host.asked(), _derivation(3 if quick else 7)]
    figure(result, HERE / "emitted.svg")
    page = [
        "# The emitted code, measured",
        "",
        "`make bench` writes this page. Case C2 with the parameters of Table 1 unless told otherwise;",
        f"a shared x86-64 machine with {os.cpu_count()} cores, times as processor time on one core, medians of"
        " paired rounds.",
        "How often the diagnosis is right: [results.md](results.md).",
        "",
        "| what | asked | measured | |",
        "|---|---|---|---|",
        *(f"| {what} | {least} | {told} | {_judged(reached)} |" for what, least, told, reached in rows),
        "",
        "![speed against array size, error against distance from the hollow](emitted.svg)",
        "",
        "## Speed",
        "",
        *speed.table(result),
        *(f"\n{package}: left out, {reason}." for package, reason in result["absent"].items()),
        "",
        "## Accuracy",
        "",
        _printed(python, "benchmarks/accuracy.py", "--size", size),
        "## Cortex-M4F and x86-64",
        "",
        _printed(python, "benchmarks/target.py", *few),
    ]
    (HERE / "emitted.md").write_text("\n".join(page).rstrip() + "\n", encoding="utf-8")
    print("\n".join(page[6 : 9 + len(rows)]))


def _judged(reached: bool) -> str:
    return "" if reached else "not reached"


def _printed(*command: str) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
    return done.stdout + (
        f"\nNot measured: {done.stderr.strip().splitlines()[-1]}\n" if done.returncode else ""
    )


def _derivation(rounds: int) -> tuple[str, str, str, bool]:
    """`eccentric derive` of all models beside the import of SymPy: processor time, medians of paired rounds."""
    commands = ([sys.executable, "-m", "eccentric", "derive"], [sys.executable, "-c", "import sympy"])
    times: tuple[list[float], list[float]] = ([], [])
    for _ in range(rounds):
        for taken, command in zip(times, commands, strict=True):
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            subprocess.run(command, capture_output=True, check=True, cwd=ROOT)
            taken.append(resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before)
    own, peer = map(float, map(np.median, times))
    told = f"{own / peer:.1f} ({own:.2f} / {peer:.2f} s)"
    return "derivation of all models / import sympy", "at most 10", told, own <= 10 * peer


def figure(result: dict[str, Any], path: Path) -> None:
    """Speed against array size; error of F_N in single precision against the distance from the hollow."""
    mpl.rcParams["svg.hashsalt"] = "eccentric"
    drawing, (left, right) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    for name in result["torque"]["1"]:
        left.loglog(speed.SIZES, [result["torque"][str(n)][name] for n in speed.SIZES], "o-", label=name)
    left.set(xlabel="elements", ylabel="ns an element", title="friction torque, double, one core")
    left.legend(fontsize="small")
    for name, distances, errors in _near_hollow():
        right.loglog(distances, errors, label=name)
    right.set(
        xlabel="distance from the hollow [rad, rad/s]", ylabel="worst error of F_N [ULP]", title="float"
    )
    right.legend(fontsize="small")
    drawing.savefig(path, metadata={"Date": None})


def _near_hollow() -> list[tuple[str, np.ndarray, np.ndarray]]:
    """(form, distance, worst error in units of the last place): emitted, and the paper's as it is printed."""
    decimals, real = accuracy.decimals(), np.float32
    binary = oracle.exact({letter: float(value) for letter, value in vars(decimals).items()})
    p = {letter: float(value) for letter, value in vars(decimals).items()}
    weight = (p["M"] + p["M_l"]) * p["g"]
    top, fastest = np.pi / p["mu"], np.sqrt(weight / (p["M"] * p["L"])) / p["mu"]
    distances, generator = np.logspace(-6, 1, 29), np.random.default_rng(2)
    worst: dict[str, list[float]] = {"emitted": [], "the paper's (16)": []}
    for distance in distances:
        turn = generator.uniform(0, 2 * np.pi, 100)
        theta = (top + distance * np.cos(turn)).astype(real)
        omega = (fastest + distance * np.sin(turn)).astype(real)
        exact = accuracy.normal_force("c2_parallel", accuracy.Set("", theta, omega), binary)
        a = real(p["M"] * p["L"] * p["mu"] ** 2) * omega**2
        b = real(weight)
        with np.errstate(invalid="ignore"):
            printed = np.sqrt(a * a + b * b + real(2) * a * b * np.cos(real(p["mu"]) * theta))
        for name, value in (
            ("emitted", module("c2_parallel").normal_force(theta, omega)),
            ("the paper's (16)", printed),
        ):
            worst[name].append(float(np.nanmax(accuracy.units(np.asarray(value, real), exact))))
    return [(name, distances, np.array(errors)) for name, errors in worst.items()]


if __name__ == "__main__":
    main()
