"""How good is `eccentric diagnose`? Every family, controls, pairs and effects outside the library, on the virtual bench.

The pipeline is given log and rig only; the sealed truth is read afterwards. Seeds here are never developed on.
Run: python benchmarks/diagnosis.py --out benchmarks/results.md   (about 20 minutes on two cores; --quick for a sample)
"""

from __future__ import annotations

import argparse
import json
import resource
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from scipy.stats import beta

sys.path.insert(0, str(Path(__file__).resolve().parent))
from outside import OUTSIDE

from eccentric.bench import random_scenario, simulate, write
from eccentric.bench.effects import EFFECTS
from eccentric.bench.effects.record import Effect, simply
from eccentric.errors import InputError
from eccentric.identify.diagnose import diagnose
from eccentric.identify.diagnosis import document

HEAD = """# How often the diagnosis is right

`make bench` writes this page: `eccentric diagnose` on logs of the virtual test bench, given log and rig only.
Every family of effects at 3, 8 and 20 % of the friction, gear ratios 1 to 1/30, C1 and C2, speed runs and trajectories, current noise of 0.4 to 1.2 % of its range; controls; pairs at 12 % each; and a dozen effects that no library holds (`benchmarks/outside.py`), twice each.
One minute at 250 rows a second per log, on a shared machine with two cores.
The seeds are not those that the method was developed on.

An effect whose torque lies within 0.2 % of the friction of what the paper's own columns can take is an exact alias (w|w| and w^3 in C1) and is not counted among the singles.
Not measured: a peer (sparse regression over the same columns) beside these figures, and the error of the true structure as oracle; the sensors' white noise stands in for the latter.
A figure below what was asked for is one that was not reached.
The emitted code beside its peers: [emitted.md](emitted.md).

"""
# Those from 5000 on have been looked at while the method was changed, and judge no more.
FIRST_SEED = 20000
RATIOS = (1 / 30, 1 / 5, 1 / 2, 1.0)
NEEDS_TEMPERATURE = {"viscosity_temperature", "coulomb_temperature", "resistance_temperature"}
# What leaves less than this part of the friction beyond the paper's own columns is an exact alias of them.
ALIAS = 0.002


@dataclass(frozen=True)
class Job:
    """One log to diagnose."""

    kind: str
    seed: int
    effects: tuple[tuple[str, float], ...]
    outside: str | None = None


@dataclass
class Result:
    """What came of one job."""

    job: Job
    verdict: str = "failed"
    truth: list[str] = field(default_factory=list)
    beyond: list[float] = field(default_factory=list)
    ranked: list[str] = field(default_factory=list)
    named: list[str] = field(default_factory=list)
    depends: list[str] = field(default_factory=list)
    probability: float = 0.0
    before: float = 0.0
    after: float = 0.0
    floor: float = 0.0
    seconds: float = 0.0
    note: str = ""


def jobs(quick: bool) -> Iterator[Job]:
    """The list of logs."""
    seed = FIRST_SEED
    for family in EFFECTS:
        for strength in (0.06, 0.15) if quick else (0.03, 0.08, 0.2):
            for _ in range(1):
                yield Job("single", seed, ((family, strength),))
                seed += 1
    seed = FIRST_SEED + 1000
    for k in range(12 if quick else 64):
        yield Job("control", seed + k, ())
    seed = FIRST_SEED + 2000
    rng = np.random.default_rng(seed)
    for k in range(6 if quick else 20):
        pair = rng.choice(sorted(EFFECTS), 2, replace=False)
        yield Job("pair", seed + k, tuple((str(name), 0.12) for name in pair))
    seed = FIRST_SEED + 3000
    for k, name in enumerate(OUTSIDE):
        for repeat in range(1 if quick else 2):
            yield Job("outside", seed + 10 * k + repeat, (("stribeck", 0.12),), name)


def run(job: Job) -> Result:
    """Simulate, diagnose, compare."""
    result = Result(job)
    rng = np.random.default_rng(job.seed)
    case, log_type = str(rng.choice(["C1", "C2"])), str(rng.choice(["runs", "traj"]))
    mu, noise = float(rng.choice(RATIOS)), float(rng.choice([0.004, 0.008, 0.012]))
    warm = any(name in NEEDS_TEMPERATURE for name, _ in job.effects)
    try:
        scenario = random_scenario(rng, case=case, mu=mu, log_type=log_type, effects=job.effects, noise=noise,
                                   temperature=warm)  # fmt: skip
    except InputError:
        case = "C2"
        scenario = random_scenario(rng, case=case, mu=mu, log_type=log_type, effects=job.effects, noise=noise,
                                   temperature=warm)  # fmt: skip
    if job.outside is not None:
        variable, port, law = OUTSIDE[job.outside]
        top = {"runs": 7.5, "traj": 6.2}[log_type] / mu
        effect = Effect(job.outside, job.outside, scenario.effects[0].amplitude,
                        simply(**{port: law(top, scenario.course.seconds)}), (variable,), strength=0.12)  # fmt: skip
        scenario = replace(scenario, effects=(effect,))
    result.note = f"{case} mu={mu:.3g} {log_type} noise={noise}"
    simulated = simulate(scenario)
    result.truth = [e["family"] for e in simulated.truth["effects"]]
    result.beyond = [e.get("rms_fraction_beyond_the_paper", 1.0) for e in simulated.truth["effects"]]
    if job.outside is not None:
        result.truth = [OUTSIDE[job.outside][0]]
    with tempfile.TemporaryDirectory() as folder:
        log, rig, _ = write(simulated, Path(folder) / "log.csv.gz")
        started = time.perf_counter()
        try:
            found = diagnose([log], rig)
            said = document(found)
        except Exception as error:  # noqa: BLE001 - a failure is a result
            result.note += f" {type(error).__name__}: {error}"
            return result
        result.seconds = time.perf_counter() - started
    result.verdict = said["verdict"]
    result.ranked = list(dict.fromkeys(c["family"] for c in said["candidates"]))
    result.named = [e["family"] for e in said["effects"]]
    result.depends = said["residual_depends_on"]
    result.probability = max((c["probability"] for c in said["candidates"][:1]), default=0.0)
    errors = said["rmse_holdout_Nm"]["mechanical"]
    result.before, result.after = errors["paper"], errors["extended"]
    result.floor = said["noise_floor_Nm"]
    return result


def interval(count: int, total: int) -> str:
    """A fraction with its 95 % Clopper-Pearson interval."""
    if total == 0:
        return "-"
    low = 0.0 if count == 0 else float(beta.ppf(0.025, count, total - count + 1))
    high = 1.0 if count == total else float(beta.ppf(0.975, count + 1, total - count))
    return f"{count}/{total} = {count / total:.2f} ({low:.2f} to {high:.2f})"


def table(results: list[Result]) -> str:
    """The results as Markdown."""
    single = [r for r in results if r.job.kind == "single" and max(r.beyond, default=0) > ALIAS]
    hidden = [r for r in results if r.job.kind == "single" and max(r.beyond, default=0) <= ALIAS]
    control = [r for r in results if r.job.kind == "control"]
    pair = [r for r in results if r.job.kind == "pair"]
    outside = [r for r in results if r.job.kind == "outside"]
    first = sum(bool(r.ranked) and r.ranked[0] == r.truth[0] for r in single)
    three = sum(r.truth[0] in r.ranked[:3] for r in single)
    wrong = sum(r.verdict == "named" and bool(r.named) and r.named[0] not in r.truth for r in single)
    extra = sum(r.verdict == "named" and bool(set(r.named) - set(r.truth)) for r in single)
    abstained = sum(r.verdict in {"not_identifiable", "unexplained"} for r in single)
    alarms = sum(r.verdict != "nothing_missing" for r in control)
    both = sum(set(r.truth) <= set(r.named) for r in pair)
    honest = sum(r.verdict == "unexplained" and r.truth[0] in r.depends[:2] for r in outside)
    sure = [r for r in [*single, *pair] if r.verdict == "named" and r.probability >= 0.9]
    right = sum(r.named[0] in r.truth for r in sure)
    seconds = sorted(r.seconds for r in results if r.seconds)
    found = [r for r in single if r.verdict == "named" and r.named[0] == r.truth[0]]
    excess = sorted(100 * (r.after / r.floor - 1) for r in found) or [float("nan")]
    memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e6
    lines = [
        "| what | measured (95 % interval) | asked for |",
        "|---|---|---|",
        f"| right family first | {interval(first, len(single))} | 0.90 |",
        f"| right family among the first three | {interval(three, len(single))} | 0.97 |",
        f"| wrong name given | {interval(wrong, len(single))} | at most 0.03 |",
        f"| wrong name given, further names counted too | {interval(extra, len(single))} | - |",
        f"| abstained (not_identifiable, unexplained) on a family of the library | {interval(abstained, len(single))} | - |",
        f"| false alarms on controls | {interval(alarms, len(control))} | at most 1 in 60 |",
        f"| both of two effects named | {interval(both, len(pair))} | all |",
        f"| `unexplained` with the right variable, outside the library | {interval(honest, len(outside))} | all |",
        f"| named with probability 0.9 or more, and right | {interval(right, len(sure))} | about nine in ten |",
        f"| exact aliases of the paper's columns left alone | {interval(sum(r.verdict == 'nothing_missing' for r in hidden), len(hidden))} | - |",
        f"| held-out RMSE after, above the sensors' white noise: median, 90th percentile |"
        f" {np.median(excess):+.1f} %, {np.quantile(excess, 0.9):+.1f} % | - |",
        f"| seconds per log (15,000 rows), median and longest | {np.median(seconds):.1f}, {seconds[-1]:.1f} | - |",
        f"| memory of a worker | {memory:.2f} GB | 1 GB |",
    ]
    lines += [
        "",
        "Misses:",
        "",
        "| kind | seed | rig | truth | verdict | named | first three | depends |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for r in results:
        good = {
            "single": max(r.beyond, default=0) <= ALIAS or (r.verdict == "named" and r.named == r.truth),
            "control": r.verdict == "nothing_missing",
            "pair": r.verdict == "named" and set(r.named) == set(r.truth),
            "outside": r.verdict == "unexplained" and r.truth[0] in r.depends[:2],
        }[r.job.kind]
        if not good:
            truth = ", ".join(f"{t} {b:.3f}" for t, b in zip(r.truth, r.beyond, strict=False))
            lines.append(
                f"| {r.job.kind} {r.job.outside or ''} | {r.job.seed} | {r.note} | {truth} | {r.verdict} |"
                f" {', '.join(r.named)} | {', '.join(r.ranked[:3])} | {', '.join(r.depends[:3])} |"
            )
    return "\n".join(lines)


def main() -> None:
    """Run all jobs on two processes and write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--kinds", default="single,control,pair,outside")
    parser.add_argument("--seed", type=int, default=None, help="another first seed, for development")
    parser.add_argument("--out", type=Path)
    arguments = parser.parse_args()
    if arguments.seed is not None:
        global FIRST_SEED  # noqa: PLW0603 - the one setting of this script
        FIRST_SEED = arguments.seed
    listed = [job for job in jobs(arguments.quick) if job.kind in arguments.kinds.split(",")]
    results = []
    with ProcessPoolExecutor(2) as pool:
        for result in pool.map(run, listed):
            results.append(result)
            print(json.dumps([result.job.kind, result.job.seed, result.truth, result.verdict, result.named,
                              result.ranked[:3], result.depends[:2], round(result.seconds, 1), result.note]),
                  file=sys.stderr, flush=True)  # fmt: skip
    text = table(results)
    print(text)
    if arguments.out:
        arguments.out.write_text(f"{HEAD}{text}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
