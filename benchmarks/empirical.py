"""A term without a cause beside learned functions, on real drives that no effect of the library explains.

    python benchmarks/empirical.py [--data DATA] [TARGET ...]

Every model is fitted on the training part and judged on the held-out one: whole runs, or blocks where there is
one run. The peers learn the residual of the paper's model from the variables that the term may choose from.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from benchmarks.diagnosis import RATIOS
from benchmarks.footprint import footprint, instructions
from benchmarks.record import Measured, Part, progress
from eccentric.core import InputError
from eccentric.diagnosis import fit_empirical, staged, staged_log, variables_followed
from eccentric.diagnosis.stage import Stage
from eccentric.effects import ANGLES, variable_of
from eccentric.identification import FitData, Refit, compiled, improvement, refit
from eccentric.joints.fitted import prepared
from eccentric.joints.joint_model import DECLARED
from eccentric.logs import read_log
from eccentric.model import with_values
from eccentric.rigs import read_arm_rig
from eccentric.virtual_bench import Scenario, random_scenario, simulate, write

ROOT = Path(__file__).resolve().parent.parent
DATA = ROOT.parent / "shared" / "data"
RIGS = ROOT / "examples" / "rigs"
SINGLE = {
    "disc": ("measured/tue_unbalanced_disc/data.csv.gz", RIGS / "tue_unbalanced_disc.toml"),
    "worm gear": ("measured/tro2021_screw_drives/data.csv.gz", RIGS / "tro2021_drive3.toml"),
    "Franka joint": ("field/logs/04-franka-joint/case3_slow.csv", "rig-case3_slow.toml"),
    "FAIRINO joint": (
        "field/logs/05-fairino-joint/verify_robot_S_slow_processed.csv",
        "rig-verify_robot_S_slow_processed.toml",
    ),
}
"""Target -> log, and its rig file: ours, or the one beside the log."""
ARM = "measured/ur10e_arm/data.csv.gz"
JOINTS = {3: "UR10e elbow", 4: "UR10e wrist 1", 5: "UR10e wrist 2", 6: "UR10e wrist 3"}
SHOWN_ONLY = {"FAIRINO joint"}
"""Not judged: it moves by 2 degrees."""
FUNCTION, CORE = "mechanical_friction_torque", "Cortex-M4F"
POINTS, SEEDS, THIRDS = 800, 3, ("lowest", "middle", "highest")
FIRST_CONTROL, CONTROLS = 500000, 124


def targets(data: Path, names: Sequence[str] = ()) -> Iterator[tuple[str, Stage]]:
    """The drives, each as its log is before a search."""
    for name, (log, rig) in SINGLE.items():
        if not names or name in names:
            path = data / log
            yield name, staged_log([path], rig if isinstance(rig, Path) else path.parent / rig)[0]
    wanted = {number: name for number, name in JOINTS.items() if not names or name in names}
    if wanted:
        arm = read_arm_rig(RIGS / "ur10e_arm.toml")
        log, _ = prepared([read_log(data / ARM)], arm, lambda _: None)
        for number, name in wanted.items():
            j = number - arm.number(0)
            model, signals = log.joint(j, log.present(j, DECLARED), f"ur10e_joint_{number}")
            yield name, staged(model, model, signals, None, name)


@dataclass
class Found:
    """What one drive gives: gains in percent of the held-out error of the paper's model.

    variables, coefficients, gain, interval: of the term that is emitted, none and 0 without one; peers: learned
    function -> gain with its interval; outside: third of the speeds left out -> error of the paper's model there
    and with the term, and the gain with its interval; cost: text and constants in bytes, instructions of a
    call, of the paper's model and with the term.
    """

    name: str
    peers: dict[str, tuple[float, tuple[float, float]]]
    variables: tuple[str, ...] = ()
    coefficients: int = 0
    gain: float = 0.0
    interval: tuple[float, float] = (0.0, 0.0)
    outside: dict[str, tuple[float, float, tuple[float, float]]] = field(default_factory=dict)
    cost: tuple[tuple[int, ...], ...] = ()

    @property
    def share(self) -> float:
        """The gain over that of the best peer; 1 where none of them gains anything."""
        best = max(gain for gain, _ in self.peers.values())
        return self.gain / best if best > 0.0 else 1.0


def judged(name: str, stage: Stage, folder: Path) -> Found:
    """The term of one drive beside its peers."""
    before, data = refit(stage.base, (), stage.data), stage.data
    term = fit_empirical(before, data, stage.setting)
    rows, left = data.rows, before.residuals["mechanical"]
    inputs = rows.plain_mean(inputs_of(stage))
    guesses = learned(inputs[rows.train], left[rows.train], inputs[rows.score])
    gains = {peer: improvement(left[rows.score], left[rows.score] - y) for peer, y in guesses.items()}
    found, fits, functions = Found(name, gains, outside=thirds(stage)), [before], [FUNCTION]
    if term is not None and term.confirmed:
        found.variables, found.coefficients = term.variables, len(term.coefficients)
        found.gain, found.interval = term.percent, term.interval
        fits.append(term.fitted)
        functions += ["gravity_torque"] if any(curve.conservative for curve in term.curves) else []
    found.cost = tuple(cost(fit, functions, folder / str(k)) for k, fit in enumerate(fits))
    return found


def inputs_of(stage: Stage) -> np.ndarray:
    """The velocity with its sign, and every other variable that a term may follow (samples, k)."""
    data, columns = stage.data, [stage.data.signals.values["omega_m"]]
    for name in variables_followed(data, stage.setting):
        own = variable_of(name, stage.setting)
        value = own.expression
        for definition in reversed(own.definitions):
            value = value.xreplace({definition.symbol: definition.value})
        signal = compiled(stage.base, value, data.signals)({}, {})
        if name in ANGLES:
            columns += [np.cos(signal), np.sin(signal)]
        elif name != "velocity":
            columns.append(signal)
    return np.column_stack(columns)


def learned(x: np.ndarray, y: np.ndarray, at: np.ndarray) -> dict[str, np.ndarray]:
    """What peers predict (m,) at other rows, from rows of inputs (n, k) and a target (n,)."""
    from gplearn.genetic import SymbolicRegressor
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
    from sklearn.neural_network import MLPRegressor
    from sklearn.preprocessing import StandardScaler

    scaler, size = StandardScaler().fit(x), float(np.std(y))
    z, there, few = scaler.transform(x), scaler.transform(at), len(y) < 200
    some = np.random.default_rng(0).permutation(len(y))[:POINTS]
    kernel = ConstantKernel() * RBF(np.ones(x.shape[1]), (1e-2, 1e2)) + WhiteKernel(0.5, (1e-6, 10.0))
    process = GaussianProcessRegressor(kernel, normalize_y=True, n_restarts_optimizer=1, random_state=0)
    networks = [
        MLPRegressor(
            hidden_layer_sizes=(32, 32),
            solver="lbfgs" if few else "adam",
            early_stopping=not few,
            alpha=1e-3,
            max_iter=400,
            random_state=seed,
        )
        for seed in range(SEEDS)
    ]
    formula = SymbolicRegressor(
        population_size=1000,
        generations=15,
        function_set=("add", "sub", "mul", "div", "sqrt", "abs", "sin", "cos"),
        parsimony_coefficient=1e-3,
        random_state=0,
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return {
            "Gaussian process": process.fit(z[some], y[some]).predict(there),
            "network": size * np.mean([one.fit(z, y / size).predict(there) for one in networks], axis=0),
            "symbolic regression": size * formula.fit(z[some], y[some] / size).predict(there),
        }


def thirds(stage: Stage) -> dict[str, tuple[float, float, tuple[float, float]]]:
    """Errors within each third of the speeds, left out of the training part."""
    rows, found = stage.data.rows, {}
    speed = np.abs(rows.plain_mean(stage.data.signals.values["omega_m"]))
    used = rows.train | rows.score
    low, high = np.quantile(speed[used], (0.002, 0.998))
    place = np.clip((3.0 * (speed - low) / (high - low)).astype(int), 0, 2)
    for k, name in enumerate(THIRDS):
        out = used & (place == k)
        if np.count_nonzero(rows.train & ~out) < rows.per_coefficient * 4 or np.count_nonzero(out) < 2:
            continue
        data = replace(stage.data, rows=replace(rows.trained_on(rows.train & ~out), score=out))
        try:
            before = refit(stage.base, (), data)
            term = fit_empirical(before, data, stage.setting)
        except InputError:
            continue
        errors = (before.held_out("mechanical"), *([] if term is None else [term.rmse[1]]))
        percent = (0.0, 0.0) if term is None else term.interval
        found[name] = errors[0], errors[-1], percent
    return found


def cost(fit: Refit, functions: Sequence[str], folder: Path) -> tuple[int, ...]:
    """Text and constants [B], and instructions of a call on a Cortex-M4F."""
    letters = {q.name for q in fit.model.parameters}
    values = {n: x for n, x in fit.values.items() if n in letters and x is not None}
    model = with_values(fit.model, values, "m", {}, "m")
    sums = np.zeros(3, int)
    for function in functions:
        try:
            size = footprint(folder, function, CORE, model)
        except InputError:  # the model has none: nothing drives it by gravity
            continue
        sums += (size.text, size.constants, instructions(folder, function, CORE, "m"))
    return tuple(map(int, sums))


def control(seed: int) -> float | None:
    """What the term of a bench log that lacks nothing gains on another log of the same rig [%]; None without."""
    one, other = _scenario(seed), _scenario(seed + 10**6)
    stage = _stage(one, False)
    before = refit(stage.base, (), stage.data)
    term = fit_empirical(before, stage.data, stage.setting)
    if term is None or not term.confirmed:
        return None
    data: FitData = _stage(replace(one, course=other.course, seed=one.seed + 1), True).data
    rows = data.rows.train | data.rows.score
    errors = [
        data.residuals(fit.model, {}, fit.values, fit.scale).rows("mechanical", fit.values)[rows]
        for fit in (before, term.fitted)
    ]
    return improvement(*errors)[0]


def _scenario(seed: int) -> Scenario:
    rng = np.random.default_rng(seed)
    given = {
        "case": str(rng.choice(["C1", "C2"])),
        "log_type": str(rng.choice(["runs", "traj"])),
        "mu": float(rng.choice(RATIOS)),
        "noise": float(rng.choice([0.004, 0.012, 0.03])),
        "drive": "ordinary" if seed % 2 else "fine",
    }
    return random_scenario(rng, **given)


def _stage(scenario: Scenario, again: bool) -> Stage:
    with tempfile.TemporaryDirectory() as folder:
        log, rig, _ = write(simulate(scenario, again=again), Path(folder) / "log.csv.gz")
        return staged_log([log], rig)[0]


def measured(quick: bool, data: Path = DATA, names: Sequence[str] = ()) -> Part:
    """The table of the targets, and the controls."""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for k, (name, stage) in enumerate(targets(data, names)):
            progress(name)
            found.append(judged(name, stage, Path(folder) / str(k)))
    count = 4 if quick else CONTROLS
    return part_of(found, [control(FIRST_CONTROL + k) for k in range(0 if names else count)])


def part_of(found: Sequence[Found], controls: Sequence[float | None]) -> Part:
    """What drives and controls give."""
    given = [gain for gain in controls if gain is not None]
    ours = [one for one in found if one.name not in SHOWN_ONLY]
    shares = [one.share for one in ours]
    outside = [gain for one in ours for _, _, gain in one.outside.values()]
    figures = {
        "term median": Measured(float(np.median(shares))),
        "term least": Measured(min(shares)),
        "term coefficients": Measured(max(one.coefficients for one in ours)),
        "term worse": Measured(sum(one.interval[1] < 0.0 for one in ours)),
        "term outside": Measured(
            sum(high < 0.0 for _, high in outside), f"{sum(h < 0.0 for _, h in outside)} of {len(outside)}"
        ),
    }
    if controls:
        worse = sum(gain < 0.0 for gain in given)
        figures["term controls"] = Measured(worse, f"{worse} of {len(controls)}, {len(given)} have a term")
    return Part(figures, lines_of(found))


def lines_of(found: Sequence[Found]) -> list[str]:
    """The tables in Markdown."""
    peers = list(found[0].peers)
    head = [
        "drive",
        "follows",
        "coefficients",
        "gain [%], 95 %",
        *(f"{peer}, 95 %" for peer in peers),
        "of the best",
    ]
    rows = [head, ["---", "---", *["--:"] * (len(head) - 2)]]
    for one in found:
        cells = [_with_interval(*one.peers[peer]) for peer in peers]
        follows, count, gain = "none", "", "0"
        if one.variables:
            follows, count = ", ".join(one.variables).replace("_", " "), str(one.coefficients)
            gain = _with_interval(one.gain, one.interval)
        share = f"{one.share:.2f}{' (not judged)' if one.name in SHOWN_ONLY else ''}"
        rows.append([one.name, follows, count, gain, *cells, share])
    rows2 = [
        ["drive", *(f"{third} third left out [%]" for third in THIRDS), "text, constants [B], instructions"]
    ]
    rows2.append(["---", *["--:"] * 4])
    for one in found:
        thirds_ = [_outside(one, third) for third in THIRDS]
        costs = " → ".join(" / ".join(map(str, own)) for own in one.cost)
        rows2.append([one.name, *thirds_, costs])
    return [
        "Reduction of the held-out error, in percent of that of the paper's model. The peers learn its residual from"
        " the velocity and every other variable that the term may follow: a Gaussian process (800 rows), the mean of"
        " three networks with two layers of 32, and a symbolic regression (gplearn).",
        "",
        *(f"| {' | '.join(row)} |" for row in rows),
        "",
        "A third of the speed range left out of training: gain of the term there, with its 95 % interval; 0 where it"
        f" has none. `{FUNCTION}` of the paper's model, and with the term, on a Cortex-M4F in single precision, with"
        " fixed parameters; with `gravity_torque`, where the term has a torque over the angle.",
        "",
        *(f"| {' | '.join(row)} |" for row in rows2),
    ]


def _outside(one: Found, third: str) -> str:
    if third not in one.outside:
        return "-"
    before, after, (low, high) = one.outside[third]
    if before == after:
        return "0"
    return _with_interval(100.0 * (1.0 - after / before), (low, high))


def _with_interval(gain: float, interval: tuple[float, float]) -> str:
    return f"{gain:.1f} ({interval[0]:.1f} to {interval[1]:.1f})"


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="A term without a cause beside learned functions.")
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("names", nargs="*", metavar="TARGET")
    args = parser.parse_args()
    part = measured(False, args.data, args.names)
    print("\n".join(part.details))
    for key, one in part.figures.items():
        print(f"{key}: {one.text or one.value}")


if __name__ == "__main__":
    main()
