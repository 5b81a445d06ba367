"""Numbers and figures of docs/measured-rigs.md, from logs that are not bundled.

    python benchmarks/measured_rigs.py DATA [NAME ...]

DATA has one folder for each set of logs, with its data.csv.gz; NAME is one of `measured_logs.SETS`, by default all.
Writes docs/measured/results.json and the pictures beside it, and puts its tables and what the commands printed
into the page.  The prose there is handwritten: read it again when results.json has changed.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from benchmarks import measured_figures as figures
from benchmarks import measured_lines, measured_page
from benchmarks.measured_free import K_E, free_errors
from benchmarks.measured_identified import IDENTIFIED
from benchmarks.measured_logs import ROOT, SETS, measured_log
from benchmarks.measured_page import Cell, Table, table
from eccentric.diagnosis import Diagnosis, diagnose
from eccentric.presentation import diagnosis_lines

OUT = ROOT / "docs" / "measured"

DRIVEN_ROWS = ('motor_off = "torque_enable == 0"', 'use = "torque_enable == 1"')
"""Line of a rig file with free rows, and what leaves them out altogether."""

MODELS = {"linear": "Coulomb + viscous", "paper": "paper", "extended": "extended"}


def main() -> None:
    """Diagnose the rigs, draw the pictures, write the results; those of rigs not named stay."""
    parser = argparse.ArgumentParser(description="Numbers and pictures of docs/measured-rigs.md.")
    parser.add_argument("data", type=Path, help="folder of the measured sets")
    parser.add_argument("names", nargs="*", default=list(SETS), help=", ".join(SETS))
    args = parser.parse_args()
    if unknown := set(args.names) - set(SETS):
        parser.error(f"{min(unknown)}: required one of {', '.join(SETS)}")
    path = OUT / "results.json"
    results = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    for name in args.names:
        log, rig = measured_log(args.data, name)
        found = diagnose([log], rig)
        results[name] = page(name, found)
        measured_lines.remember({name: measured_lines.line_of(found)})
        if np.any(found.data.drive.off):
            driven = changed(log, rig, DRIVEN_ROWS)
            results[name]["tables"].append(free(found, driven))
            results[name]["driven rows only"] = diagnosis_lines(driven)
        figures.draw(name, found, OUT)
        print("\n".join(results[name]["console"]), "\n")
    OUT.mkdir(exist_ok=True)
    text = json.dumps({name: results[name] for name in SETS if name in results}, indent=1, ensure_ascii=False)
    path.write_text(text + "\n", encoding="utf-8")
    measured_page.write(ROOT / "docs" / "measured-rigs.md", results)
    measured_lines.write()


def changed(log: Path, rig: Path, change: tuple[str, str]) -> Diagnosis:
    """Diagnose the log with one line of the rig changed."""
    text = rig.read_text(encoding="utf-8")
    if change[0] not in text:
        raise SystemExit(f"{rig}: required the line {change[0]}, which a variant changes")
    with tempfile.TemporaryDirectory() as folder:
        other = Path(folder) / rig.name
        other.write_text(text.replace(*change), encoding="utf-8")
        return diagnose([log], other)


def page(name: str, found: Diagnosis) -> dict[str, Any]:
    """The page's content for one rig: lines of the terminal, and tables in their order."""
    tables = [errors(found), IDENTIFIED[name](found)]
    if found.orders:
        tables.append(orders(found))
    return {"verdict": found.attribution.verdict, "console": diagnosis_lines(found), "tables": tables}


def models(found: Diagnosis) -> dict[str, str]:
    """Models that differ: without a mass, or at its bounds, the paper's is Coulomb + viscous; without an effect none extends it."""
    kept = dict(MODELS)
    rmse = found.score.rmse["mechanical"]
    if math.isclose(rmse["paper"], rmse["linear"], rel_tol=1e-9):
        del kept["paper"]
    if not found.models.adopted:
        del kept["extended"]
    return kept


def errors(found: Diagnosis) -> Table:
    """RMSE of the models: held out, and every run predicted from the others."""
    score, milli = found.score, 1e3
    columns = {"held out [mN m]": {n: milli * x for n, x in score.rmse["mechanical"].items()}}
    if score.per_drive:
        columns["held out [mV]"] = {n: milli * x for n, x in score.per_drive.items()}
    if score.over_runs is not None:
        columns["each run left out [mN m]"] = {n: milli * x for n, x in score.over_runs.rmse.items()}
    rows = {label: [column[name] for column in columns.values()] for name, label in models(found).items()}
    return table(["model", *columns], rows)


def free(found: Diagnosis, driven: Diagnosis) -> Table:
    """RMSE while the motor is off: as diagnosed (held-out rows), and from driven rows alone (all free rows)."""
    labels = {"linear": MODELS["linear"], "paper": "paper", "extended": "extended"}
    blind = free_errors(found, driven)
    off = found.rows.mean(found.data.drive.off.astype(float)) > 0.5
    fits = {"linear": found.models.linear, "paper": found.models.paper, "extended": found.models.extended}
    mean = {n: float(m.residuals["mechanical"][off & found.rows.score].mean()) for n, m in fits.items()}
    columns = [
        "model",
        "held out [mN m]",
        "mean held-out residual [mN m]",
        *(f"driven rows only, k_e = {k:g} V s/rad [mN m]" for k in K_E),
    ]
    rows: dict[str, list[Cell]] = {"no friction": [None, None, *(1e3 * x for x in blind["no friction"])]}
    for name, label in labels.items():
        rows[label] = [1e3 * found.score.free[name], 1e3 * mean[name], *(1e3 * x for x in blind[label])]
    return table(columns, rows)


def orders(found: Diagnosis) -> Table:
    """Periods of the torque within runs."""
    rows: dict[str, list[Cell]] = {
        str(round(o.per_turn)): [o.per_turn, 1e3 * o.amplitude, 100 * o.share, o.seen, o.stretches]
        for o in found.orders
    }
    columns = [
        "order",
        "cycles per input turn",
        "amplitude [mN m]",
        "share of the variance [%]",
        "seen in runs",
        "of",
    ]
    return table(columns, rows)


if __name__ == "__main__":
    main()
