"""Tables of the arms in docs/measured-rigs.md, from logs that are not bundled.

    python benchmarks/measured_arms.py DATA [NAME ...]

DATA has one folder for each set of logs, with its data.csv.gz.  Writes docs/measured/arms.json, and puts its
tables between the marks of the page.  The prose there is handwritten: read it again when arms.json has changed.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from benchmarks import measured_lines
from eccentric.joints import ArmDiagnosis, ArmFit, diagnose_arm, fit_arm, payload_of, predicted
from eccentric.logs import Log, read_log
from eccentric.rigs import read_arm_rig

ROOT = Path(__file__).resolve().parent.parent
PAGE, RESULTS = ROOT / "docs" / "measured-rigs.md", ROOT / "docs" / "measured" / "arms.json"
ARMS = {
    "ur10e_arm": "ur10e_arm",
    "dfki_double_pendulum_a": "dfki_double_pendulum",
    "dfki_double_pendulum_c": "dfki_double_pendulum",
}
"""Rig -> folder of its log."""
FOREIGN = ("h14_50s", "h14_50s_payload")
"""The same trajectory of the UR10e without and with a payload; the fit leaves out both."""
MARK = r"(<!-- {0} -->\n).*?(<!-- end -->)"


def main() -> None:
    """Fit, diagnose, predict the run with payload; write results and page."""
    parser = argparse.ArgumentParser(description="Write the tables of the arms into docs/measured-rigs.md.")
    parser.add_argument("data", type=Path)
    parser.add_argument("names", nargs="*", default=list(ARMS), help=", ".join(ARMS))
    args = parser.parse_args()
    data, results = args.data, json.loads(RESULTS.read_text(encoding="utf-8"))
    for name in args.names:
        folder = ARMS[name]
        log, rig = read_log(data / folder / "data.csv.gz"), ROOT / "examples" / "rigs" / f"{name}.toml"
        arm = read_arm_rig(rig)
        found = fit_arm([log], arm, ["data.csv.gz"], print)
        results[name] = {"fit": fit_table(found)}
        diagnosed = diagnose_arm([log], arm, ["data.csv.gz"], tell=print)
        results[name]["diagnosis"] = diagnosis_table(diagnosed)
        own = {f"{name} {joint.number}": measured_lines.line_of(joint.found) for joint in diagnosed.joints}
        measured_lines.remember(own)
        if name == "ur10e_arm":
            results[name]["payload"] = payload_tables(log, rig)
    RESULTS.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    page = PAGE.read_text(encoding="utf-8")
    for name, tables in results.items():
        for what, table in tables.items():
            mark = re.compile(MARK.format(f"{name} {what}"), re.DOTALL)
            page = mark.sub(lambda m, table=table: m[1] + markdown(table) + m[2], page)
    PAGE.write_text(page, encoding="utf-8")
    measured_lines.write()


def fit_table(found: ArmFit) -> list[list[str]]:
    """Errors of each joint, held out and with every run left out in turn."""
    unit = found.joints[0].unit
    columns = f"joint | friction follows | Coulomb + viscous [{unit}] | with the load [{unit}] | error reduction, 95 % | drive, RMS"
    rows = [[*columns.split(" | "), "each run left out, error reduction"]]
    for joint in found.joints:
        follows, over = " + ".join(joint.loads.followed), joint.over_runs
        gain = (
            f"{joint.percent:.0f} % ({joint.interval[0]:.0f} to {joint.interval[1]:.0f})" if follows else "-"
        )
        runs = "-"
        if follows and over is not None:
            percent, (low, high), better = over.gains["paper"]
            runs = f"{percent:.0f} % ({low:.0f} to {high:.0f}), {better} of {over.runs} runs"
        errors = (f"{joint.rmse[key]:.3g}" for key in ("linear", "followed"))
        name, load = f"{joint.number} {joint.name}", follows.replace("_", " ") or "-"
        rows.append([name, load, *errors, gain, f"{joint.torque_rms:.3g}", runs])
    return rows


def diagnosis_table(found: ArmDiagnosis) -> list[list[str]]:
    """The verdict of each joint, beside friction by the loads of its bearing."""
    rows = [["joint", "verdict", "effects", "bearing loads alone", "with the effects", "residual depends on"]]
    for joint in found.joints:
        rmse = joint.found.score.rmse["mechanical"]
        effects = ", ".join(effect.id for effect, _ in joint.found.effects) or "-"
        depends = ", ".join(joint.found.attribution.depends_on[:3]).replace("_", " ") or "-"
        errors = (f"{rmse[key]:.3g}" for key in ("paper", "extended"))
        rows.append(
            [f"{joint.number} {joint.name}", joint.verdict.replace("_", " "), effects, *errors, depends]
        )
    return rows


def payload_tables(log: Log, rig: Path) -> list[list[str]]:
    """The run with payload predicted from the others, and with a payload beside.

    The gains of the drives are those that the controller's own torques give, on the training runs.
    """
    import tomllib

    content = tomllib.loads(rig.read_text(encoding="utf-8"))
    content["arm"] = str(rig.parent / content["arm"])
    content["runs"] = [name for name in dict.fromkeys(map(str, log.text("run"))) if name not in FOREIGN]
    content["drives"] = {"k_i_Nm_per_A": gains(log, content["runs"], content["holdout_runs"])}
    arm = read_arm_rig(content)
    found = fit_arm([log], arm, ["data.csv.gz"], print)
    rows = [["run", *(f"joint {joint.number} [N m]" for joint in found.joints), "payload [kg]"]]
    mu = [float(joint.mu) for joint in arm.chain.joints]
    for run in FOREIGN:
        foreign = predicted(found, [log], [run])
        payload = payload_of(foreign)
        mass = payload.estimates["mass_payload"]
        low, high = mass.interval
        rows.append([f"{run}, as predicted", *_side(foreign.rmse, mu), "-"])
        rows.append(
            [
                f"{run}, with a payload",
                *_side(payload.rmse, mu),
                f"{mass.value:.2f} ({low:.2f} to {high:.2f})",
            ]
        )
    return rows


def _side(errors: tuple[float, ...], mu: list[float]) -> list[str]:
    """Errors on the side of the joint [N m]."""
    return [f"{error / ratio:.3g}" for error, ratio in zip(errors, mu, strict=True)]


def gains(log: Log, runs: list[str], held_out: list[str]) -> list[float]:
    """k_i [N m/A] of each motor: the controller's torque by the measured current, beside friction."""
    names = np.array([run in runs and run not in held_out for run in map(str, log.text("run"))])
    found = []
    for j in range(1, 7):
        tau, current, w = (log.numbers(f"{key}_{j}") for key in ("tau_model_Nm", "i_A", "w_rad_s"))
        rows = names & (np.abs(w) > 0.05)
        columns = np.column_stack([tau, w, np.sign(w)])[rows]
        found.append(1.0 / float(np.linalg.lstsq(columns, current[rows], rcond=None)[0][0]) / 101.0)
    return found


def markdown(rows: list[list[str]]) -> str:
    """A table as the page has it."""
    lines = [rows[0], ["---", *["--:"] * (len(rows[0]) - 1)], *rows[1:]]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


if __name__ == "__main__":
    main()
