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
import re
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from benchmarks import measured_figures as figures
from benchmarks import measured_lines
from benchmarks.measured_logs import ROOT, SETS, measured_log
from benchmarks.measured_plot import friction
from eccentric.diagnosis import Diagnosis, diagnose
from eccentric.identification import refit
from eccentric.presentation import diagnosis_lines

TABLE = re.compile(r"(?:^\|.*\n)+", re.MULTILINE)
TERMINAL = re.compile(r"```console\n.*?```", re.DOTALL)
Cell = float | list[float] | None
Table = dict[str, Any]
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
    write_page(ROOT / "docs" / "measured-rigs.md", results)
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


# A harder question to the servo's log: is its free swing predicted by what was learned with the motor on?
#
# Effects are searched, and all models fitted, with every row of the switched-off motor taken out. Rows with the motor
# on cannot tell the back-EMF from viscous friction: both are a torque in proportion to the speed. So k_e is given, as
# values between the k_t that others published for this servo (an ideal motor has k_e = k_t).


K_E = (0.32, 0.355, 0.39)
"""Published fits of k_t at the output of this servo, lowest, middle and highest [V s/rad]."""


def free_errors(whole: Diagnosis, driven: Diagnosis) -> dict[str, list[float]]:
    """RMSE over all free rows of models fitted on driven rows: model -> one error for each of `K_E` [N m].

    `whole` holds the rows, `driven` the effects.  Also the RMS of what has to be predicted, friction of the arm
    that swings freely, as "no friction".
    """
    data = whole.data
    off = data.rows.mean(data.drive.off.astype(float)) > 0.0
    rows = replace(data.rows, train=(data.rows.train | data.rows.score) & ~off)
    shapes = tuple(
        (e, {s.quantity.name: own[s.quantity.name] for s in e.shapes})
        for e, own in driven.models.extended.effects
    )
    models = {
        "no friction": None,
        "Coulomb + viscous": ((), {"bounds": False, "linear": True}),
        "paper": ((), {"bounds": False}),
        "extended": (shapes, {}),
    }
    errors: dict[str, list[float]] = {name: [] for name in models}
    for k_e in K_E:
        still_open = tuple(c for c in data.drive.open if c.role != "back_emf")
        drive = replace(data.drive, known={**data.drive.known, "k_e": k_e}, open=still_open)
        signals = replace(data.signals, open={c: data.signals.open[c] for c in still_open})
        given = replace(data, drive=drive, rows=rows, signals=signals)
        for name, options in models.items():
            effects, how = options or (shapes, {})
            found = refit(whole.models.base, effects, given, **how)
            left = found.residuals["mechanical"]
            if options is None:
                left = friction(found)
            errors[name].append(float(np.sqrt(np.mean(left[off] ** 2))))
    return errors


# What was identified from a log, beside what others state of its rig.


def _identified(found: Diagnosis, shown: dict[str, tuple[str, float]]) -> dict[str, list[Cell]]:
    """Estimates of the shipped model: name -> label with the unit, factor to that unit."""
    every = found.models.extended.estimates
    return {
        label: [factor * every[name].value, [factor * x for x in every[name].interval]]
        for name, (label, factor) in shown.items()
        if name in every
    }


def _with_known(rows: dict[str, list[Cell]], known: dict[str, Cell]) -> dict[str, list[Cell]]:
    """A column more: what others say."""
    return {label: [*row, known.get(label)] for label, row in rows.items()}


def _servo(found: Diagnosis) -> Table:
    shown = {
        "R/k_i": ("R/k_i [V/(N m)]", 1.0),
        "k_e": ("k_e [V s/rad]", 1.0),
        "J_m": ("J_m, rotor and gear [g m^2]", 1e3),
        "theta_zero_rad": ("zero angle [rad]", 1.0),
        "C_m": ("C, Coulomb [mN m]", 1e3),
        "B_m": ("B, viscous [mN m s/rad]", 1e3),
        "C_lN": ("C_lN, by F_N [mm]", 1e3),
        "B_lN": ("B_lN, by F_N [mm s/rad]", 1e3),
        "load_eta": ("eta, by the load", 1.0),
        "load_eta_2": ("eta_2, by its square [1/(N m)]", 1.0),
        "resistance_alpha": ("alpha, of the resistance [%/K]", 100.0),
    }
    # Fits of this servo by others: R 2.8 to 4.8 ohm, k_t 0.32 to 0.39 N m/A, inertia 1.6 to 1.8 g m^2.
    published: dict[str, Cell] = {
        "R/k_i [V/(N m)]": [2.8 / 0.39, 4.8 / 0.32],
        "k_e [V s/rad]": [0.32, 0.39],
        "J_m, rotor and gear [g m^2]": [1.6, 1.8],
        "alpha, of the resistance [%/K]": 0.39,
    }
    rows = _with_known(_identified(found, shown), published)
    return table(["quantity", "value", "95 % interval", "elsewhere"], rows)


def _screw(found: Diagnosis) -> Table:
    shown = {
        "C_m": ("C, Coulomb [mN m]", 1e3),
        "B_m": ("B, viscous [mN m s/rad]", 1e3),
        "T_load": ("constant load [mN m]", 1e3),
        "stribeck_A": ("A, Stribeck torque [mN m]", 1e3),
        "stribeck_v": ("v, Stribeck velocity [rad/s]", 1.0),
    }
    shown = {name: how for name, how in shown.items() if name in found.models.extended.estimates}
    return table(["quantity", "value", "95 % interval"], _identified(found, shown))


def _disc(found: Diagnosis) -> Table:
    scale, values, channels = found.models.linear.scale or 1.0, found.models.linear.values, found.channels
    estimates = found.models.linear.estimates
    rows: dict[str, list[Cell]] = {
        "input delay [ms]": [1e3 * channels.alignment.input_delay_s, None, None],
        "zero angle [rad]": [
            estimates["theta_zero_rad"].value,
            list(estimates["theta_zero_rad"].interval),
            None,
        ],
        "offset [V]": [
            estimates["voltage_offset_V"].value,
            list(estimates["voltage_offset_V"].interval),
            None,
        ],
        # The simulator of the source: J, tau and K of a model with viscous friction only.
        "R/k_i [V/(N m)]": [scale, list(estimates["R/k_i"].interval), 0.397973 / (10.5082 * 2.44211e-4)],
        "inertia [g m^2]": [1e3 * (values["J_m"] + values["J_l"]), None, 0.244211],
        "Coulomb [V]": [scale * estimates["C_m"].value, [scale * x for x in estimates["C_m"].interval], None],
        "viscous and back-EMF [V s/rad]": [
            scale * estimates["B_m"].value,
            [scale * x for x in estimates["B_m"].interval],
            1.0 / 10.5082,
        ],
    }
    return table(["quantity", "value", "95 % interval", "simulator of the source"], rows)


def _direct(found: Diagnosis) -> Table:
    values, g = found.models.extended.values, 9.81
    arm = found.models.extended.estimates["L"]
    # 0.546 kg at 0.5 m; rod and mount, 0.13 kg, put the centre of the whole at 0.45 m: a rod of 0.48 m.
    inertia = 0.546 * 0.5**2 + 0.13 * 0.48**2 / 3 + 36 * 6.07e-5
    gravity = [values["M"] * g * length for length in (arm.value, *arm.interval)]
    rows = _identified(found, {"C_m": ("C, Coulomb [N m]", 1.0), "B_m": ("B, viscous [N m s/rad]", 1.0)})
    known: dict[str, Cell] = {
        "gravity torque, arm level [N m]": 0.676 * g * 0.45,
        "inertia [kg m^2]": inertia,
    }
    rows = {
        "gravity torque, arm level [N m]": [gravity[0], gravity[1:]],
        "inertia [kg m^2]": [values["J_m"] + values["J_l"], None],
        **rows,
    }
    return table(["quantity", "value", "95 % interval", "from the geometry"], _with_known(rows, known))


IDENTIFIED = {
    "bam_xl330_pendulum": _servo,
    "tro2021_drive1": _screw,
    "tro2021_drive3": _screw,
    "tue_unbalanced_disc": _disc,
    "dfki_ak80_pendulum": _direct,
}


# Tables, and how they come into the page: tables and terminal blocks are replaced, the prose stays.


def table(columns: list[str], rows: Mapping[str, Sequence[Cell]]) -> Table:
    """A table, its numbers with six digits."""
    return {
        "columns": columns,
        "rows": {label: [_short(cell) for cell in row] for label, row in rows.items()},
    }


def _short(cell: Cell) -> Cell:
    if isinstance(cell, list):
        return [float(f"{x:.6g}") for x in cell]
    return None if cell is None else float(f"{cell:.6g}")


def write_page(path: Path, results: dict[str, Any]) -> None:
    """Put results into the page: the tables of a rig's section in their order, and what its command printed.

    SystemExit where a section is missing or has another number of tables.
    """
    parts = re.split(r"(?m)^(?=## )", path.read_text(encoding="utf-8"))
    for name, found in results.items():
        own = [k for k, part in enumerate(parts) if f"--rig examples/rigs/{name}.toml" in part]
        if len(own) != 1 or len(TABLE.findall(parts[own[0]])) != len(found["tables"]):
            raise SystemExit(f"{path}: expected one section with {len(found['tables'])} tables for {name}")
        rendered = iter(map(markdown, found["tables"]))
        text = TABLE.sub(lambda _, tables=rendered: next(tables), parts[own[0]])
        block = "\n".join(
            ["```console", command(name), *found["console"], f"build/{name}: report.html, ...", "```"]
        )
        parts[own[0]] = TERMINAL.sub(lambda _, block=block: block, text)
    path.write_text("".join(parts), encoding="utf-8")


def command(name: str) -> str:
    """The command of a rig, as the page shows it."""
    return f"$ eccentric diagnose data.csv.gz --rig examples/rigs/{name}.toml --out build/{name}"


def markdown(table: dict[str, Any]) -> str:
    """A table with three digits a number."""
    lines = [table["columns"], ["---", *["--:"] * (len(table["columns"]) - 1)]]
    lines += [[label, *map(_cell, row)] for label, row in table["rows"].items()]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def _cell(value: float | list[float] | None) -> str:
    if value is None:
        return "-"
    return " to ".join(f"{x:.3g}" for x in (value if isinstance(value, list) else [value]))


if __name__ == "__main__":
    main()
