"""Close the loop: fit the paper's model, attribute what is left, extend the model, measure the error again.

The stages, each with what it hands on:

    drive       channels, rig -> drive torque, known and identified parameters   (`drive.drive_of`)
    signals     smooth inputs of expressions                                     (`balances.bench_of`)
    balances    both residuals as linear designs on the training part            (`balances.balances_of`)
    attribute   verdict and adopted effects                                      (`verdict.attribute`)
    extend      Model', its coefficients fitted on its own emitted module        (`refit`)
    orders      what is left inside runs and periodic in the angle               (`orders.orders_of`)
    score       held-out RMSE before and after; the held-out part is opened here and nowhere else
                (the zero-phase low pass carries some 20 ms across its borders)
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType

import numpy as np

from eccentric.effects import Setting, library, load_effects
from eccentric.effects.effect import Effect
from eccentric.emit import load_module
from eccentric.errors import InputError
from eccentric.identify.adapter import Signals, candidate
from eccentric.identify.attribution import Rules
from eccentric.identify.balances import (
    balances_of,
    bench_of,
    drive_current,
    drive_noise,
    setting_of,
    with_model_current,
)
from eccentric.identify.candidates import Candidate
from eccentric.identify.channels import Channels, read_channels
from eccentric.identify.drive import drive_of, loaded_model
from eccentric.identify.emitted import Bench
from eccentric.identify.finding import Finding
from eccentric.identify.least_squares import bounded
from eccentric.identify.orders import Order, orders_of
from eccentric.identify.refit import Refit, refit, residual_samples
from eccentric.identify.rig import Rig, read_rig
from eccentric.identify.rows import LEAST_HELD_OUT, MANY_RUNS, Rows, require_rows
from eccentric.identify.score import Score, leave_runs_out, score
from eccentric.identify.verdict import Attribution, attribute, unconfirmed
from eccentric.model import Model, load_model

__all__ = ["Diagnosis", "diagnose"]

Array = np.ndarray
_UNSEEN = {"current_bias", "sensor_delay", "ke_mismatch", "resistance_mismatch"}
"""Families that a voltage alone cannot show: of a current sensor, and of R and k_e, which are open then."""
Progress = Callable[[str], None]
LEAST_R2 = 0.5
"""R^2 of the drive torque under which a log is not of this rig, or not in its units: nothing is named."""
OVER_RUNS = 0.15
"""Part of the structure that may stay open where runs are left out as a whole: no two are quite alike, and
what is named has to predict those that were not seen."""


@dataclass(frozen=True)
class Diagnosis:
    """What a diagnosis found.

    Attributes:
        logs, rig_name: file names; model: name or path of the base model.
        base: the paper's model; its fit is `paper`.
        setting: what the library of effects was made for.
        own: effects of the user's own file, if any.
        bench: drive, signals and rows that models were fitted on.
        attribution: verdict, candidates, dependence.
        effects: adopted effects with their parameters, in order of adoption; empty without a name.
        linear, paper, extended: fits on the training part; `extended` is `paper` if nothing was adopted.
        shipped: what is emitted: `extended`, or without an effect the paper's model within its bounds.
        score: held-out errors and the improvement.
        refused: those of effects that the held-out part did not confirm, if any were adopted before.
        noise_floor: RMS of the sensors' noise in the mechanical balance, in its unit.
        r_squared: of the drive torque, on the training part, under the paper's model.
        orders: what the residual of the shipped model is periodic in while the motor turns one way.
    """

    logs: tuple[str, ...]
    rig_name: str
    model: str
    channels: Channels
    rig: Rig
    base: Model
    setting: Setting
    own: Path | None
    bench: Bench
    attribution: Attribution
    effects: tuple[tuple[Effect, dict[str, float]], ...]
    linear: Refit
    paper: Refit
    extended: Refit
    shipped: Refit
    score: Score
    refused: Score | None
    noise_floor: float
    r_squared: float
    orders: tuple[Order, ...]

    @property
    def rmse(self) -> Mapping[str, Mapping[str, float]]:
        """Balance -> model ("linear", "paper", "extended") -> held-out RMSE in `unit`."""
        return self.score.rmse

    @property
    def balance(self) -> str:
        """The balance that the improvement is one of."""
        return self.score.balance

    @property
    def percent(self) -> float:
        """Improvement of the held-out RMSE, 100 (1 - extended/paper)."""
        return self.score.percent

    @property
    def interval(self) -> tuple[float, float]:
        """Its 95 % interval."""
        return self.score.interval

    @property
    def shipped_module(self) -> ModuleType:
        """The emitted NumPy module of what is shipped."""
        return load_module(self.shipped.model)

    @property
    def quality(self) -> tuple[Finding, ...]:
        """What is odd about the record."""
        return self.channels.findings

    @property
    def unsettled(self) -> tuple[str, ...]:
        """Those of the models whose fit was stopped before it had settled."""
        fits = {
            "linear": self.linear,
            "paper": self.paper,
            "extended": self.extended,
            "shipped": self.shipped,
        }
        return tuple(name for name, fit in fits.items() if not fit.settled)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Of the reader, of the first fit, and of fits that have not settled."""
        said = (*self.channels.warnings, *self.bench.drive.warnings)
        if not self.unsettled:
            return said
        models = f"model{'s' * (len(self.unsettled) > 1)} {', '.join(self.unsettled)}"
        return (*said, f"the fit of the {models} has not settled: its values and errors are not final")

    @property
    def rows(self) -> Rows:
        """The rows that errors are reported on."""
        return self.bench.rows

    @property
    def unit(self) -> str:
        """Unit of torques: "N m", or that of the drive where nothing tells the scale."""
        return self.bench.drive.unit


def diagnose(
    logs: Sequence[str | Path],
    rig_path: str | Path,
    model: str | None = None,
    effects: Path | None = None,
    tell: Progress | None = None,
) -> Diagnosis:
    """Diagnose one rig's logs.

    Args:
        logs: paths of logs of the same rig.
        rig_path: the rig file.
        model: name or path of the base model; by the rig's case if None.
        effects: a file with effects of the user's own.
        tell: told one line per stage.

    Raises:
        InputError: bad input, a model with a tilt, or fewer than two rows to hold out.
    """
    tell = tell or (lambda _: None)
    rig = read_rig(rig_path)
    channels = read_channels(logs, rig)
    rig = channels.rig
    plain = load_model(model or rig.model)
    if "phi" in {q.name for q in plain.parameters}:
        raise InputError(f"{plain.name}: required a model of case C1 or C2 for diagnose, got one with a tilt")
    tell(f"{channels.counts['used']} rows used of {channels.rows_read}")
    drive = drive_of(channels, rig, plain)
    base, channels = loaded_model(plain, rig), drive.channels
    bench = bench_of(drive, rig, base)
    names = tuple(Path(log).name for log in logs)
    held_out = f"{bench.rows.description} to hold out"
    require_rows(bench.rows.score, LEAST_HELD_OUT, held_out, ", ".join(names))
    signals = bench.signals
    balances, noise = balances_of(bench, rig, base)
    mechanical = next(b for b in balances if b.name == "mechanical")
    none = np.full(len(mechanical.lower), np.inf)
    friction = bounded(mechanical.base, mechanical.target, mechanical.lower, none).coefficients
    if not drive.measured_twice:
        bench = with_model_current(bench, base, friction)
        signals = bench.signals
    setting = setting_of(bench, base, friction)
    offered = [*library(setting), *(load_effects(effects, setting) if effects else ())]
    offered = [e for e in offered if _shown(e, bench, rig, setting, {b.name for b in balances})]
    offered = [e for e in offered if _known(e, base, signals)]
    by_id = {effect.id: effect for effect in offered}
    candidates = [_candidate(effect, bench, base, friction) for effect in offered]
    runs = len(np.unique(channels.run[channels.fit_rows]))
    rules = Rules() if runs < MANY_RUNS else Rules(unexplained_part=OVER_RUNS)
    smooth = _smooth_channels(bench, rig)
    found = attribute(
        balances, smooth, candidates, signals.known["mu"], bench.gravity, noise, rules, progress=tell
    )
    adopted = [(by_id[a.term.candidate.id], dict(a.term.shape)) for a in found.adopted]
    if found.verdict in {"unexplained", "nothing_missing"}:
        adopted = []
    tell("refitting on the emitted module")
    paper = refit(base, (), bench, bounds=False)
    extended = refit(base, tuple(adopted), bench) if adopted else paper
    linear = refit(base, (), bench, bounds=False, linear=True)
    fits = explained(paper)
    if fits < LEAST_R2:
        found = replace(unconfirmed(found), next_measurement="Mend the rig file or the log first.")
        adopted, extended = [], paper
    balance = found.adopted[0].balance if adopted else "mechanical"
    scored = score(linear, paper, extended, balance, leave_runs_out(base, extended, bench))
    refused = None
    # Voltage and current tell an effect twice, and row by row a ripple above the low pass is worse for being
    # in the model. One signal alone has nothing but the held-out part to be checked by.
    if adopted and not drive.measured_twice and not scored.confirms:
        tell("the held-out part does not confirm it")
        refused, found, adopted, extended = scored, unconfirmed(found), [], paper
        scored = score(linear, paper, paper, "mechanical", leave_runs_out(base, paper, bench))
    shipped = extended if adopted else refit(base, (), bench)
    return Diagnosis(
        logs=names,
        rig_name=Path(rig_path).name,
        model=model or rig.model,
        channels=channels,
        rig=rig,
        base=base,
        setting=setting,
        own=effects,
        bench=bench,
        attribution=found,
        effects=extended.effects if found.verdict == "named" else (),
        linear=linear,
        paper=paper,
        extended=extended,
        shipped=shipped,
        score=scored,
        refused=refused,
        noise_floor=drive_noise(bench),
        r_squared=fits,
        orders=orders_of(bench, residual_samples(shipped)),
    )


def explained(paper: Refit) -> float:
    """R^2 of the drive torque on the training rows: friction, inertia and gravity of the paper's model."""
    rows = paper.bench.rows
    drive = rows.mean(paper.bench.drive.torque())[rows.train]
    return 1.0 - float(np.mean(paper.residuals["mechanical"][rows.train] ** 2) / np.mean(drive**2))


def _shown(effect: Effect, bench: Bench, rig: Rig, setting: Setting, balances: set[str]) -> bool:
    """Whether this log can show the effect at all."""
    if not set(effect.needs) <= setting.channels:
        return False
    if bench.drive.by_voltage:
        if effect.balance == "electrical" and set(effect.terms) != {"electrical"}:
            return False
        if effect.family in _UNSEEN:
            return False
    elif effect.balance not in balances:
        return False
    if effect.family == "sensor_delay" and not bench.drive.measured_twice:
        return False  # its current would be the model's, whose noise is that of the acceleration
    if effect.family == "angle_offset" and "theta_zero_rad" in rig.estimate:
        return False  # that is what the rig leaves open
    if math.isinf(rig.average_over) and {"time", "acceleration", "history"} & set(effect.depends_on):
        return False
    # Angles integrated from the speed begin at zero in every run: their phases do not compare.
    several = len(bench.drive.channels.run_names) > 1
    if several and bench.drive.channels.quantum_rad == 0.0:
        return not {"link_angle", "motor_angle", "gravity_load"} & set(effect.depends_on)
    return True


def _candidate(effect: Effect, bench: Bench, base: Model, friction: Array) -> Candidate:
    balance = "mechanical" if bench.drive.by_voltage else None
    return candidate(effect, base, bench.signals, friction, balance)


class _Smooth:
    """Channels as candidates and smooth terms take them."""

    def __init__(self, **values: Array | bool | None) -> None:
        self.__dict__.update(values)


def _smooth_channels(bench: Bench, rig: Rig) -> _Smooth:
    channels = bench.drive.channels
    phased = len(channels.run_names) == 1 or channels.quantum_rad > 0.0
    return _Smooth(
        t=channels.t,
        theta_m=channels.theta_m if phased else None,
        omega_m=channels.omega_m,
        alpha_m=channels.alpha_m,
        current=drive_current(bench),
        voltage=bench.signals.values.get("u"),
        temperature=channels.temperature,
        steady=math.isinf(rig.average_over),
    )


def _known(effect: Effect, base: Model, signals: Signals) -> bool:
    """Whether the rig knows every parameter of the base model that the effect uses."""
    unknown = {q.name for q in base.parameters} - set(signals.known)
    unknown -= {str(t.coefficient) for t in base.balance("mechanical").terms}
    used = set().union(
        *(d.value.free_symbols for d in effect.definitions),
        *(s.update.free_symbols for s in effect.states),
        *(t.basis.free_symbols for terms in effect.terms.values() for t in terms),
    )
    return not unknown & {s.name for s in used}
