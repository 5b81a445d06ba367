"""Write docs/normal-force.md: does friction follow F_N?  Every number on it is computed from the logs.

    python benchmarks/normal_force.py DATA

DATA has the folders measured and field.  The page and its figure are written whole; the prose is below.
"""

from __future__ import annotations

import argparse
import math
import sys
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import eccentric
from benchmarks.measured_logs import ROOT, measured_log
from benchmarks.measured_plot import AFTER, BEFORE, INK, STYLE
from eccentric.identification import Emitted, covariance, detection_power, own_letters
from eccentric.joints import fit_arm
from eccentric.model import load_model, regressor
from eccentric.planning import DetectionPlan
from eccentric.rigs import read_arm_rig, read_rig
from eccentric.signals import read_channels, turn_line

PAGE, FIGURE = ROOT / "docs" / "normal-force.md", ROOT / "docs" / "normal_force.svg"
LETTERS = ("C_lN", "B_lN")
TABLE_1 = own_letters(load_model("c2_parallel"))
G = 9.81
ONE_SIDED = 1.645
INDEPENDENT_HZ = 50.0
"""Independent rows a second below a low pass of 25 Hz, as in `eccentric plan`."""
SINGLE = {
    "dfki_ak80_pendulum": "quasi-direct drive, pendulum",
    "tue_unbalanced_disc": "DC motor, unbalanced disc",
    "bam_xl330_pendulum": "hobby servo, pendulum",
}
ARMS = {"dfki_double_pendulum_a": "double pendulum A", "dfki_double_pendulum_c": "double pendulum C"}


@dataclass(frozen=True)
class Bound:
    """What a log says of a coefficient: value, error, interval, and Table 1's value in standard errors."""

    value: float
    error: float
    low: float
    high: float
    z: float


@dataclass(frozen=True)
class Row:
    """A drive whose F_N varies: least and largest F_N [N] of the fitted rows, bounds by letter."""

    name: str
    force: tuple[float, float]
    bounds: Mapping[str, Bound]


def main() -> None:
    """Fit, plan, draw, write."""
    parser = argparse.ArgumentParser(description="Write docs/normal-force.md.")
    parser.add_argument("data", type=Path)
    data = parser.parse_args().data
    rows, plans = [], []
    for name, label in SINGLE.items():
        row, plan = single(data / "measured", name, label)
        rows.append(row)
        plans.append((label, plan))
    rows += [row for name, label in ARMS.items() for row in arm(data / "measured", name, label)]
    logs = data / "field" / "logs"
    facts = motor(logs) | flywheel(logs) | drum(logs) | dynamometer(logs) | screws(data / "measured")
    draw(rows, facts["motor_C"], facts["motor_B"])
    PAGE.write_text(page(rows, plans, facts), encoding="utf-8")


def single(data: Path, name: str, label: str) -> tuple[Row, DetectionPlan]:
    """A drive with one axis: its fit, and what its rig would have to do, by the noise of its log."""
    log, rig_path = measured_log(data, name)
    found, channels = eccentric.fit(log, rig_path), read_channels([log], read_rig(rig_path))
    rows, motion = channels.selection.fit_rows, channels.motion
    force = found.module.normal_force(motion.theta_m[rows], motion.omega_m[rows])
    bounds = {}
    estimates = {**found.estimates, **found.combinations}
    for letter in LETTERS:
        one = estimates[letter]
        said = found.document["undetected"].get(letter, {"z": one.value / one.std_error})
        bounds[letter] = Bound(one.value, one.std_error, *one.interval, said["z"])
    rig = read_rig(rig_path)
    scale = next((e.value for key, e in found.estimates.items() if key == "R/k_i"), 1.0)
    averaged = channels.rig.sampling.average_over or 0.3
    noise = found.rmse["mechanical"]["paper"] / scale * math.sqrt(INDEPENDENT_HZ * averaged)
    lasts = [np.ptp(channels.time.t[channels.time.run == k]) for k in range(len(channels.time.run_names))]
    limits: dict[str, Any] = {
        "speed_rad_s": float(np.quantile(np.abs(motion.omega_m[rows]), 0.99)),
        "acceleration_rad_s2": float(np.quantile(np.abs(motion.alpha_m[rows]), 0.99)),
        "current_A": 1.0,
        "time_s": float(sum(lasts)),
    }
    reach = np.quantile(motion.theta_m[rows], (0.005, 0.995))
    if np.ptp(reach) < 4.0 * math.pi:
        limits["angle_rad"] = [float(x) for x in reach]
    plan = eccentric.plan_detection(rig, limits, LETTERS, noise=f"{noise:.6g} N m").plan
    return Row(label, (float(force.min()), float(force.max())), bounds), plan


def arm(data: Path, name: str, label: str) -> list[Row]:
    """The joints of the double pendulum, with every load that their logs show."""
    found = fit_arm(
        [data / "dfki_double_pendulum" / "data.csv.gz"],
        read_arm_rig(ROOT / "examples" / "rigs" / f"{name}.toml"),
        [name],
    )
    rows = []
    for joint, called in zip(found.joints, ("shoulder", "elbow"), strict=True):
        estimates, force = joint.every.estimates, joint.every.data.signals.values["load_N"]
        bounds = {
            letter: Bound(
                estimates[letter].value,
                estimates[letter].std_error,
                *estimates[letter].interval,
                TABLE_1[letter] / estimates[letter].std_error,
            )
            for letter in LETTERS
        }
        rows.append(Row(f"{label}, {called}", (float(np.min(force)), float(np.max(force))), bounds))
    return rows


def mean_of(x: np.ndarray) -> tuple[float, float]:
    """The mean of rows (n,) in order of time, and its standard error for correlated rows."""
    one = np.ones((len(x), 1))
    return float(x.mean()), math.sqrt(float(covariance(one, x - x.mean())[0, 0]))


def motor(logs: Path) -> dict[str, Any]:
    """The brushless motor with and without an unbalanced disc: mean current, line, bounds."""
    folder = next(logs.glob("15-*"))
    means, lines = {}, {}
    for path in sorted(folder.glob("*.csv")):
        key = "disc" if path.name.startswith("unbalanced") else "bare"
        counts, rpm = np.loadtxt(path, delimiter=",", skiprows=1).T
        means[key] = (*mean_of(counts), float(np.median(rpm)), float(np.mean(counts < 0.1 * counts.mean())))
        lines[key] = turn_line(np.arange(len(counts)) / 2000.0, counts, rpm * np.pi / 30.0)
    fall = means["disc"][0] - means["bare"][0]
    error = math.hypot(means["disc"][1], means["bare"][1])
    speed = means["disc"][2] * np.pi / 30.0
    # The line is M g L in counts, so that k_i cancels: F_N = M L w^2 = amplitude w^2/g.
    most = abs(fall) + ONE_SIDED * error
    per_count = G / (lines["disc"].amplitude * speed**2)
    return {
        "bare": means["bare"],
        "disc": means["disc"],
        "fall": fall,
        "fall_error": error,
        "lines": lines,
        "clock": lines["disc"].frequency * 60.0 / means["disc"][2],
        "clock_bare": lines["bare"].frequency * 60.0 / means["bare"][2],
        "amplitude": lines["disc"].amplitude,
        "motor_C": most * per_count,
        "motor_B": most * per_count / speed,
        "expected": TABLE_1["C_lN"] / per_count,
        "stray": means["disc"][3],
        "speed": speed,
    }


def flywheel(logs: Path) -> dict[str, Any]:
    """The coast-down of the flywheel: the free cubic beside the published one, and the exact aliases."""
    folder = next(logs.glob("16-*"))
    about = tomllib.loads((folder / "about.toml").read_text(encoding="utf-8"))
    published = next(one["value"] for one in about["published"] if "deceleration" in one["quantity"])
    rows = np.loadtxt(folder / about["logs"][0]["file"])
    log = {"t_ms": rows[:, 5], "rpm": rows[:, 3]}
    columns = {"time": {"column": "t_ms", "unit": "ms"}, "omega_m": {"column": "rpm", "unit": "rpm"}}
    rig = {"drive": "none", "columns": columns, "known": {"case": "C1", "mu": 1, "M": "0 kg", "L": "0 m"}}
    whole = eccentric.fit(log, rig).document["free_cubic"]
    without = {**rig, "columns": {**columns, "use": "rpm > 0"}}
    clean = eccentric.fit(log, without).document["free_cubic"]
    slow, fast = (np.pi / 30.0 * float(x) for x in (rows[-1, 3], rows[:, 3].max()))
    middle = 0.5 * (slow + fast)
    here = np.polyval([one["value"] for one in reversed(clean.values())], middle)
    return {
        "cubic": whole,
        "clean": clean,
        "published": published,
        "stopped": int(np.sum(rows[int(rows[:, 3].argmax()) :, 3] == 0.0)),
        "alike": aliases(),
        "range": (slow, fast),
        "middle": (middle, float(here), float(np.polyval(published[::-1], middle))),
    }


def aliases() -> float:
    """The largest deviation of the columns of C_lN and B_lN in case C1 from w|w| and w^3, relative to them."""
    model = load_model("c1_perpendicular")
    emitted, speed = Emitted(model), np.linspace(1.0, 100.0, 50)
    columns = emitted("regressor", {"omega_m": speed}, emitted.parameters({"M": 1.0, "L": 1.0}))
    names = [column.parameter.name for column in regressor(model)]
    ratios = [columns[:, names.index(letter)] / speed**n for letter, n in (("C_lN", 2), ("B_lN", 3))]
    return max(float(np.ptp(ratio) / np.mean(ratio)) for ratio in ratios)


def drum(logs: Path) -> dict[str, Any]:
    """The drum and the tyre on it, each by the times of its turns."""
    rows = np.loadtxt(next(logs.glob("17-*/*.csv")), delimiter=",")
    log = {"us": rows[:, 0], "drum": rows[:, 2], "tyre": rows[:, 4]}
    found = {}
    for name in ("drum", "tyre"):
        rig = {
            "drive": "none",
            "events": "revolution",
            "columns": {"time": {"column": "us", "unit": "us"}, "theta_m": {"column": name, "unit": "rev"}},
            "known": {"case": "C1", "mu": 1, "M": "0 kg", "L": "0 m"},
        }
        found[name] = eccentric.fit(log, rig)
    return {"turns": found}


def dynamometer(logs: Path) -> dict[str, Any]:
    """The torque sensor beside k_i i at each speed: means of the rows near it, less the sensor at rest."""
    folder = next(logs.glob("18-*"))
    path = next(folder.glob("futek*.csv"))
    rig = read_rig(next(folder.glob("rig-*.toml")))
    log = eccentric.read_log(path)
    asked, speed, current, sensor = (
        log.numbers(name)
        for name in ("a1 velocity cmd [Hz]", "a1 velocity [rad/s]", "a1 q-axis [A]", "trs605-5 torque [Nm]")
    )
    means = []
    for value in np.unique(asked):
        own = (asked == value) & (np.abs(speed - 2.0 * np.pi * value) <= 0.15 * 2.0 * np.pi * value + 0.5)
        means.append([float(x[own].mean()) for x in (speed, rig.known["k_i"] * current, sensor)])
    rest, *moving = means
    turns = np.array(moving)
    turns[:, 2] -= rest[2]
    whole, idle = (np.polyfit(turns[:, 0], turns[:, k], 1) for k in (1, 2))
    return {"steps": turns, "at_rest": rest[2], "viscous": (whole[0], idle[0]), "dry": (whole[1], idle[1])}


def screws(data: Path) -> dict[str, Any]:
    """The screw drives, which carry no unbalanced mass."""
    return {
        "screws": {n: eccentric.fit(*measured_log(data, n)) for n in ("tro2021_drive1", "tro2021_drive3")}
    }


def draw(rows: list[Row], motor_c: float, motor_b: float) -> None:
    """Upper bounds beside Table 1's values."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(7.0, 2.9), layout="constrained")
        for axes, letter, unit, own in zip(
            figure.subplots(1, 2, sharey=True), LETTERS, ("m", "m s/rad"), (motor_c, motor_b), strict=True
        ):
            labels = [*(row.name for row in rows), "brushless motor, disc"]
            for k, row in enumerate(rows):
                one = row.bounds[letter]
                seen = one.z >= 5.0
                axes.plot(one.high, k, "<", color=AFTER if seen else BEFORE, markersize=6)
                if one.low > 0.0:
                    axes.plot([one.low, one.high], [k, k], color=AFTER)
            axes.plot(own, len(rows), "<", color=INK, markersize=6, markerfacecolor="none")
            axes.axvline(TABLE_1[letter], color=INK, linewidth=0.9, linestyle="--")
            axes.text(TABLE_1[letter], -0.9, " Table 1", fontsize=8, va="bottom", ha="right")
            axes.set(xscale="log", xlabel=f"{letter} [{unit}], at most", ylim=(len(rows) + 0.6, -1.0))
            axes.set_yticks(range(len(labels)), labels)
        figure.savefig(FIGURE, metadata={"Date": None})
        text = FIGURE.read_text(encoding="utf-8")
        FIGURE.write_text("\n".join(line.rstrip() for line in text.splitlines()) + "\n", encoding="utf-8")


def number(x: float | None) -> str:
    """Three digits, or a dash."""
    return "-" if x is None else f"{x:.3g}"


def table(columns: str, rows: list[list[str]]) -> str:
    """A table, its first column left."""
    names = columns.split(" | ")
    lines = [names, ["---", *["--:"] * (len(names) - 1)], *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def bounds_table(rows: list[Row]) -> str:
    """Least and largest F_N, and for both coefficients the bound, what part of Table 1 it is, and z."""
    cells = []
    for row in rows:
        cells.append([row.name, f"{row.force[0]:.3g} to {row.force[1]:.3g}"])
        for letter in LETTERS:
            one = row.bounds[letter]
            span = number(one.high) if one.low <= 0.0 else f"{one.low:.3g} to {one.high:.3g}"
            cells[-1] += [span, f"{100.0 * one.high / TABLE_1[letter]:.2g} %", number(one.z)]
    cells.append(["**Table 1**", "", *(x for k in LETTERS for x in (f"**{TABLE_1[k]:g}**", "", ""))])
    units = {"C_lN": "m", "B_lN": "m s/rad"}
    return table(
        "drive | F_N [N] | " + " | ".join(f"{k} at most [{units[k]}] | of Table 1 | z" for k in LETTERS),
        cells,
    )


def plan_table(plans: list[tuple[str, Any]]) -> str:
    """What would show Table 1's values at z = 5, by the noise of each log."""
    cells = []
    for label, plan in plans:
        bounds = plan.bounds
        angle = "-" if bounds.angle is None else f"{np.ptp(bounds.angle):.3g}"
        now = [number(x) for x in (bounds.speed, bounds.time, plan.mass, plan.noise, plan.z)]
        needs = [number(x) for x in (plan.time_s, plan.speed_rad_s, plan.mass_kg)]
        cells.append([label, angle, *now, *needs])
    return table(
        "drive | stroke [rad] | speed [rad/s] | time [s] | mass [kg] | noise [N m] | z"
        " | z = 5 by time [s] | by speed [rad/s] | by mass [kg]",
        cells,
    )


def cubic_table(facts: Mapping[str, Any]) -> str:
    """The free cubic of the flywheel beside the published one."""
    cells = []
    for k, published in enumerate(facts["published"]):
        row = [f"c_{k} [{facts['cubic'][f'c_{k}']['unit']}]"]
        for which in ("cubic", "clean"):
            one = facts[which][f"c_{k}"]
            row.append(f"{one['value']:.3g} ({one['interval_95'][0]:.3g} to {one['interval_95'][1]:.3g})")
        cells.append([*row, number(published)])
    return table("coefficient | all rows | without rows at 0 | published", cells)


def page(rows: list[Row], plans: list[tuple[str, Any]], facts: Mapping[str, Any]) -> str:
    """The page."""
    able = {k: [row for row in rows if row.bounds[k].z >= 5.0] for k in LETTERS}
    worst = {k: max(row.bounds[k].high for row in able[k]) / TABLE_1[k] for k in LETTERS}
    seen = [row.name for row in rows if any(row.bounds[k].low > 0.0 for k in LETTERS)]
    above = [
        f"{row.name} ({k} = {row.bounds[k].value:.2g} ± {row.bounds[k].error:.1g} {unit})"
        for row in rows
        for k, unit in (("C_lN", "m"), ("B_lN", "m s/rad"))
        if row.bounds[k].value > 0.0
    ]
    blind = [row for row in rows if min(row.bounds[k].z for k in LETTERS) < 5.0]
    bare, disc = facts["bare"], facts["disc"]
    drum, tyre = (facts["turns"][name] for name in ("drum", "tyre"))
    steps = facts["steps"]
    share = facts["viscous"][1] / facts["viscous"][0]
    screws = ", ".join(
        f"{1e3 * found.estimates['C'].value:.3g} ({1e3 * found.estimates['C'].interval[0]:.3g} to"
        f" {1e3 * found.estimates['C'].interval[1]:.3g}) mN m"
        for found in facts["screws"].values()
    )
    inside = all(
        facts["cubic"][f"c_{k}"]["interval_95"][0] <= x <= facts["cubic"][f"c_{k}"]["interval_95"][1]
        for k, x in enumerate(facts["published"])
    )
    middle, without, published = facts["middle"]
    return f"""# Does friction follow F_N?

In the paper, friction in the link's bearing is proportional to the normal force F_N: f_l = B_lN F_N ω + C_lN F_N sgn ω.
Its parameters are assumed; the paper contains no experiment.
This page examines public logs. `python benchmarks/normal_force.py DATA` generates it; every number comes from the logs.

## The question

Table 1 has C_lN = {TABLE_1["C_lN"]:g} m and B_lN = {TABLE_1["B_lN"]:g} m s/rad.
C_lN is a length, a friction coefficient times the radius at which it acts: {TABLE_1["C_lN"]:g} m would be a shaft of {1e3 * TABLE_1["C_lN"]:g} mm radius sliding with a coefficient of 1.
There are two separate questions: is it as large as in Table 1, and does it exist at all?
A log can answer the first if Table 1's value is many standard errors from zero: z below is that number, with all other coefficients free; at z = 5, a log would reveal it with a probability of {100 * detection_power(5.0):.1f} %.

## Drives that swing a mass

F_N varies in every log, due to the motion alone or also to gravity; the upper bounds are 95 % limits from a fit with non-negative coefficients.
For the double pendulum, the fit contains every load that its logs show, not only F_N.

{bounds_table(rows)}

![Upper bounds of both coefficients for each drive, on logarithmic axes, left of the dashed line of Table 1](normal_force.svg)

Blue: Table 1's value would have z = 5 or more. Red: the log could not have revealed it. Open: from the argument on the brushless motor below.

{len(able["C_lN"])} of {len(rows)} joints could have revealed Table 1's C_lN, {len(able["B_lN"])} its B_lN.
On these, C_lN is at most {100 * worst["C_lN"]:.2g} % and B_lN at most {100 * worst["B_lN"]:.2g} % of Table 1's value, and {"the interval excludes 0 on " + ", ".join(seen) if seen else "every interval contains 0"}.
The best fit has a coefficient above 0 for {", ".join(above) or "none"}, with standard errors that assume that estimates at a bound stay there; the intervals reach 0, since they allow these to leave their bounds.
{"; ".join(f"The log of the {row.name} cannot decide" for row in blind)}: its z is {number(min(min(row.bounds[k].z for k in LETTERS) for row in blind)) if blind else "-"}, and its bounds come from a model without the effects of its gear.

## What would have revealed it

`eccentric plan --for B_lN,C_lN` needs no log; here it uses the noise, strokes, speeds and times of the three single drives.
Each of the last three columns is the value that would give z = 5 for both coefficients if nothing else changed.

{plan_table(plans)}

Where z exceeds 5, less would have sufficed. A dash: no speed suffices within this stroke and acceleration.

## Logs without a known mass

**Brushless motor with and without an unbalanced disc** (15-microchip-iq-rpm): the mean current is {bare[0]:.2f} ± {bare[1]:.2f} counts bare and {disc[0]:.2f} ± {disc[1]:.2f} with the disc, a change of {facts["fall"]:.2f} ± {facts["fall_error"]:.2f}: it falls, whereas friction that follows F_N could only raise it.
The spectral line at once per turn has an amplitude of {facts["amplitude"]:.1f} counts; if the axis is level and the speed loop stiff, this is M g L, so F_N = M L ω² is known in counts too, and k_i cancels.
Table 1's C_lN would have added {facts["expected"]:.0f} counts.
Mounting the disc changed the friction by the amount observed, so a smaller effect cannot be excluded: allowing for this change and its noise, C_lN is at most {facts["motor_C"]:.2g} m and B_lN at most {facts["motor_B"]:.2g} m s/rad.
The line also checks the clock: it is at {facts["clock"]:.4f} times the logged speed, and the bare motor's pole line at {facts["clock_bare"]:.4f}, so one of the two clocks is {100 * (facts["clock"] - 1):.1f} % off.
The logged current is an absolute value, but it is near zero in only {100 * facts["stray"]:.1f} % of rows.

**Flywheel coasting down** (16-duke-spin-down): a free cubic in the speed, from {facts["range"][0]:.0f} to {facts["range"][1]:.0f} rad/s.

{cubic_table(facts)}

The published values {"are" if inside else "are not all"} inside the intervals for all rows, which are wide because of {facts["stopped"]} rows with a speed of 0 among the others.
Without those rows, the curves agree at {middle:.0f} rad/s ({without:.4g} here, {published:.4g} rad/s² published) but the coefficients do not: the published fit extends to a lower speed, and a cubic is not a physical law.
A coast-down says nothing about F_N: on a level axis, the columns of C_lN and B_lN are those of air drag, ω|ω| and ω³, to within {facts["alike"]:.0e} of their size.

**Drum and tyre, from the times of their turns** (17-hpvdt-revolutions): for an inertia of 1 kg m², friction is {drum.estimates["C"].value:.3g} + {drum.estimates["B"].value:.3g} |ω| rad/s² for the drum and {tyre.estimates["C"].value:.3g} + {tyre.estimates["B"].value:.3g} |ω| for the tyre.
This is a single load; only a comparison across loads would say anything about F_N.

**Torque sensor between two equal motors** (18-actuator-dynamometer): after subtracting the sensor's {facts["at_rest"]:.3g} N m at rest, the sensor reads {", ".join(f"{row[2]:.3g} N m where k_i i is {row[1]:.3g} N m ({row[0]:.0f} rad/s)" for row in steps)}.
Viscous friction of the idle motor is {facts["viscous"][1]:.2g} N m s/rad, {100 * share:.0f} % of the value from the current for both motors, as expected; its dry friction depends on the sensor's zero, which a shaft at rest does not reveal.
There is no unbalanced mass, so F_N never changes.

**Screw drives** (measured): no unbalanced mass either. Dry friction is {screws} under one constant load, so there is nothing to compare.

## Result

No log shows friction that follows F_N{"" if not seen else ", but for " + ", ".join(seen)}, and {len(able["C_lN"])} of {len(rows)} would almost certainly have revealed the size that Table 1 assumes.
Table 1's coefficients are excluded for these drives, by a factor of {1 / worst["C_lN"]:.0f} or more for C_lN and {1 / worst["B_lN"]:.0f} or more for B_lN.
The idea itself is not excluded: a rolling bearing has a small coefficient at a small radius, and such a C_lN may be below every bound here.

## Limitations

- A bound assumes that the model is otherwise complete. If it is not, as for the servo, friction from another cause can hide a positive coefficient or push it to its bound of 0.
- The pendulums' torque is the motor driver's own estimate from its current, with an unknown scale; L or the masses absorb it in the fit, and the bounds scale with it.
- The disc almost always turns through {np.ptp(plans[1][1].bounds.angle):.2g} rad or less: its F_N varies only by a factor of {rows[1].force[1] / rows[1].force[0]:.2g}, and its z depends on this and on the voltage model.
- The argument on the brushless motor requires a level axis. If the axis is vertical, the line is something else and F_N is unknown.
- z accounts for the noise of the log, including its correlation, but not for drift from one day to the next.
"""


if __name__ == "__main__":
    main()
