"""Simulated motion: how far fitted models move from the measured angle, and how fast they are simulated."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np

import eccentric
from benchmarks.record import Measured, Part, progress
from eccentric.model import Load, Model, load_model
from eccentric.simulation import DrivePlant, Law, Recording, integrate, whole_runs

ROOT = Path(__file__).resolve().parents[1]
BENCH = ROOT / "examples" / "bench"
SERVO = ROOT.parent / "shared" / "data" / "measured" / "bam_xl330_pendulum" / "data.csv.gz"
RIG = ROOT / "examples" / "rigs" / "bam_xl330_pendulum.toml"
MODEL = ROOT / "examples" / "servo" / "servo.py"
PUBLISHED = "m1 79, m2 79, m3 66, m4 67, m5 72, m6 71 mrad (BAM's published models on these runs)"
RUNS, SECONDS = 12, 6.0


def measured(quick: bool) -> Part:
    """Errors of the bundled log and of a hobby servo, and simulated over real time."""
    figures: dict[str, Measured] = {}
    progress("simulated: bundled log")
    errors = eccentric.simulate(BENCH / "bench.csv.gz", BENCH / "bench.toml").errors
    for horizon, ratio in zip(errors.horizons_s, errors.ratios("extended", "paper"), strict=True):
        if ratio is not None:
            figures[f"simulated {horizon:g} s"] = Measured(ratio, f"{ratio:.3f}")
    progress("simulated: speed")
    times, alone = (real_time(2.0 if quick else SECONDS, runs) for runs in (RUNS, 1))
    figures["simulated speed"] = Measured(times, f"{times:.0f} ({alone:.0f} for a single run)")
    if not SERVO.exists():
        return Part(figures, ["Hobby servo: its recordings are not here."])
    lines = []
    peers = {"the paper's model": None, "Coulomb and viscous friction": coulomb_viscous()}
    for key, model in {"servo": str(MODEL), **peers}.items():
        progress(f"simulated: hobby servo, {key}")
        found = eccentric.fit(SERVO, RIG, model, simulated=True)
        said = found.document["simulated"]
        held, train = said["held_out"]["after"], said["training"]["after"]
        count = len(read_held(found))
        every = (said["spans"] * train + count * held) / (said["spans"] + count)
        if key == "servo":
            figures["servo all"] = Measured(1e3 * every, f"{1e3 * every:.1f}", PUBLISHED)
            figures["servo held out"] = Measured(1e3 * held, f"{1e3 * held:.1f}")
        else:
            lines.append(
                f"Hobby servo, {key} refined in the same way: {1e3 * every:.1f} mrad over all runs,"
                f" {1e3 * held:.1f} held out."
            )
    return Part(figures, lines)


def coulomb_viscous() -> Model:
    """Case C2 without friction that follows the load."""
    paper = load_model("c2_parallel")
    mechanical, electrical = (paper.balance(x) for x in ("mechanical", "electrical"))
    kept = tuple(t for t in mechanical.terms if t.kind != "friction" or t.load is Load.NONE)
    gone = {t.coefficient for t in mechanical.terms} - {t.coefficient for t in kept}
    return replace(
        paper,
        name="coulomb_viscous",
        title="Case C2, Coulomb and viscous friction",
        parameters=tuple(q for q in paper.parameters if q.symbol not in gone),
        balances=(replace(mechanical, terms=kept), electrical),
        equations=(),
    )


def read_held(found: eccentric.FitResult) -> list[str]:
    """Names of the runs that the rig holds out."""
    return found.document["holdout"]["rule"].partition(": ")[2].split(", ")


def real_time(seconds: float, runs: int) -> float:
    """Simulated time over the processor time that it takes: runs of case C2 at 1 kHz at once, NumPy."""
    rows = round(seconds * 1000)
    t = np.tile(np.arange(rows) / 1e3, runs).astype(np.float64)
    run = np.repeat(np.arange(runs), rows)
    zero, no = np.zeros(len(t)), np.zeros(len(t), bool)
    torque = np.asarray(0.3 * np.sin(3.0 * t + run), np.float64)
    log = Recording(
        t=t,
        segment=run,
        run=run,
        theta_m=zero,
        omega_m=zero,
        alpha_m=zero,
        measured=zero,
        inputs={"signal": torque, "t": t},
        off=no,
        held_out=no,
        wanted=~no,
    )
    model = load_model("c2_parallel")
    values = {q.name: float(q.default) for q in model.parameters if q.default is not None}
    plant = DrivePlant(Law(model), {**values, "J_m": 2e-4, "J_l": 0.04}, 1.0, 0.0)
    took = []
    for _ in range(3):
        begun = time.process_time()
        integrate(plant, log, whole_runs(log))
        took.append(time.process_time() - begun)
    return runs * seconds / min(took)
