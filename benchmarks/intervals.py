"""Do 95 % intervals hold the truth? Inertia, friction and parameters of effects, on logs of the virtual bench.

The fit knows which effect there is, not how large it is; filters, quantisation and the closed loop are those
of the bench, which shares no code with the model. Run: python benchmarks/intervals.py SEED [LOGS]
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from math import cos, sin
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from benchmarks.asked import DIAGNOSIS
from benchmarks.record import Measured, Part, progress, table
from eccentric.core import InputError
from eccentric.diagnosis.stage import stage_of
from eccentric.identification import refit
from eccentric.logs import read_log
from eccentric.model import load_model
from eccentric.rigs import read_rig
from eccentric.signals import read_channels
from eccentric.virtual_bench import random_scenario, simulate, write
from eccentric.virtual_bench.plant import Plant

# Seeds below this one were used while the intervals were developed.
FIRST_SEED = 140000
LOGS = 400
RATIOS = (1 / 30, 1 / 5, 1 / 2, 1.0)
NOISE = {"fine": (0.004, 0.008, 0.012), "ordinary": (0.002, 0.004, 0.01, 0.02, 0.03)}
EFFECTS = ("stribeck", "eddy_current", "cogging")
KINDS = ("inertia", "friction", "effect")


@dataclass(frozen=True)
class Result:
    """Whether the intervals of a log hold the truth, by kind and quantity; why it could not be fitted."""

    note: str
    held: Mapping[str, Mapping[str, bool]] = field(default_factory=dict)
    failed: str = ""


def friction_of(plant: Plant) -> dict[str, float]:
    """The coefficients of the columns that a log separates, by the paper's letters."""
    bearing = {"C_lN": plant.C_lN, "B_lN": plant.B_lN}
    if plant.case == "C1":
        # The transversal force is constant, and adds to the motor's own friction.
        return bearing | {
            "C_m": plant.C_m + plant.mu * plant.gamma_T,
            "B_m": plant.B_m + plant.mu**2 * plant.beta_T,
        }
    return bearing | {"C_m": plant.C_m, "B_m": plant.B_m}


def effect_of(truth: Mapping[str, Any]) -> tuple[str, dict[str, float]]:
    """Id of the effect in the library, and its parameters."""
    size, shape = truth["amplitude"], truth["shape"]
    if truth["family"] == "stribeck":
        return f"stribeck[d={shape[1]:g}]", {"stribeck_A": size, "stribeck_v": shape[0]}
    if truth["family"] == "eddy_current":
        return "eddy_current", {"eddy_D": size, "eddy_w": shape[0]}
    n = int(shape[0])
    return f"cogging[n={n}]", {f"cogging_c{n}": size * cos(shape[1]), f"cogging_s{n}": -size * sin(shape[1])}


def run(seed: int) -> Result:
    """Simulate a log with one effect of 10 % of the friction, fit it, compare."""
    rng = np.random.default_rng(seed)
    drive = ("fine", "ordinary")[seed % 2]
    case, log_type = str(rng.choice(["C1", "C2"])), str(rng.choice(["runs", "traj"]))
    mu, noise = float(rng.choice(RATIOS)), float(rng.choice(NOISE[drive]))
    planted = str(rng.choice(EFFECTS))
    scenario = random_scenario(
        rng, case=case, mu=mu, log_type=log_type, effects=[(planted, 0.1)], noise=noise, drive=drive
    )
    note = f"{seed} {case} mu={mu:.3g} {log_type} noise={noise} {drive} {planted}"
    try:
        simulated = simulate(scenario)
    except InputError as error:
        return Result(note, {}, f"{error}")
    (only,) = simulated.truth["effects"]
    name, parameters = effect_of(only)
    plant = scenario.plant
    rig = {**simulated.rig, "known": {k: x for k, x in simulated.rig["known"].items() if k != "J_l_kgm2"}}
    rig["unknown"] = {"J_l": ["0 kg m^2", "1000 kg m^2"]}
    with tempfile.TemporaryDirectory() as folder:
        log, _, _ = write(simulated, Path(folder) / "log.csv.gz")
        channels = read_channels([read_log(log)], read_rig(rig))
    truth = {"inertia": {"J_l": plant.J_l}, "friction": friction_of(plant), "effect": parameters}
    try:
        stage = stage_of(channels, load_model(channels.rig.model), None, "log")
        effects = tuple((effect, shapes) for effect, shapes, _ in stage.chosen("with", [name]))
        found = refit(stage.base, effects, stage.data).estimates
    except (
        InputError
    ) as error:  # a refusal in one line gives no interval, right or wrong: it is counted apart
        return Result(note, {}, f"{error}")
    except Exception as error:  # noqa: BLE001 - a failure is a result
        # What gave no interval held no truth.
        none = {kind: dict.fromkeys(own, False) for kind, own in truth.items()}
        return Result(note, none, f"{type(error).__name__}: {error}")
    return Result(note, {
        kind: {q: found[q].interval[0] <= x <= found[q].interval[1] for q, x in own.items()}
        for kind, own in truth.items()
    })  # fmt: skip


def counted(results: list[Result], kind: str) -> tuple[int, int]:
    """How many intervals of a kind hold the truth, of how many."""
    every = [held for r in results for held in r.held.get(kind, {}).values()]
    return sum(every), len(every)


def details(results: list[Result]) -> Iterator[str]:
    """A table by quantity, and what could not be fitted."""
    yield "| quantity | holds the truth |"
    yield "|---|---|"
    names = dict.fromkeys(q for r in results for kind in KINDS for q in r.held.get(kind, {}))
    for name in names:
        every = [own[name] for r in results for own in r.held.values() if name in own]
        if len(every) >= 20:
            yield f"| {name} | {sum(every)}/{len(every)} = {np.mean(every):.2f} |"
    failed = [r for r in results if r.failed]
    if failed:
        yield ""
        refused = sum(not r.held for r in failed)
        yield (
            f"Of {len(results)} logs {refused} were refused in one line and have no intervals,"
            f" {len(failed) - refused} ended in an error, whose intervals count as wrong;"
            f" the first is {failed[0].note}: {failed[0].failed}"
        )


def measured(quick: bool, first: int = FIRST_SEED, logs: int = LOGS) -> Part:
    """Run all logs, one per processor."""
    results: list[Result] = []
    with ProcessPoolExecutor() as pool:
        for result in pool.map(run, range(first, first + (8 if quick else logs))):
            results.append(result)
            progress(f"intervals: {len(results)} of {logs} logs")
    figures = {}
    for kind in KINDS:
        held, of = counted(results, kind)
        figures[f"coverage {kind}"] = Measured(
            held / of if of else float("nan"), f"{held}/{of} = {held / max(of, 1):.3f}"
        )
    return Part(figures, [
        "95 % intervals of fits that know which effect there is, on one-minute logs of the virtual bench with an open"
        " inertia and an effect of 10 % of the friction; half of them on ordinary drives.",
        "",
        *details(results),
    ])  # fmt: skip


if __name__ == "__main__":
    part = measured(quick=False, first=int(sys.argv[1]), logs=int(sys.argv[2]) if len(sys.argv) > 2 else LOGS)
    print("\n".join([*part.details, "", *table({key: DIAGNOSIS[key] for key in part.figures}, part.figures)]))
