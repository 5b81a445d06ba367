"""From a Diagnosis to the records of the report: the only file of the report that knows what a fit is."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from eccentric import __version__
from eccentric.effects.effect import Effect
from eccentric.identify.balances import elapsed
from eccentric.identify.diagnosis_words import sentence
from eccentric.identify.offered import every_effect
from eccentric.identify.outcome import Diagnosis
from eccentric.identify.refit import Refit
from eccentric.identify.report.data import (
    AddedEffect,
    Balance,
    Candidate,
    Channel,
    Errors,
    Fact,
    Finding,
    Gain,
    Parameter,
    ReportData,
    Rows,
)
from eccentric.identify.report.equation import friction_equations
from eccentric.identify.report.text import number, range_of
from eccentric.identify.rows import Rows as LogRows

__all__ = ["report_data"]

Array = np.ndarray
TURN = 2.0 * np.pi

_WORSE = {"paper": "Coulomb and viscous friction", "extended": "the paper's"}
_ORIGINS = ("effect", "friction", "bench", "rig", "unseen")
_QUARTER = TURN / 4
_QUANTITIES = {"mechanical": "friction", "electrical": "torque of the voltage"}


def report_data(found: Diagnosis, files: Sequence[tuple[str, str]] = ()) -> ReportData:
    """The records of a diagnosis; `files` are (name, what it is) of everything written beside the report."""
    attribution = found.attribution
    extended = found.extended is not found.paper
    effects = [effect for effect, _ in found.extended.effects]
    named = {effect.family for effect in effects}
    about = {effect.id: effect for effect in every_effect(found.setting, found.own)}
    balances = [_balance(found, name) for name in sorted(found.rmse, key=lambda name: name != found.balance)]
    return ReportData(
        logs=found.logs,
        rig=found.rig_name,
        model=found.base.name,
        model_title=found.base.title,
        verdict=attribution.verdict,
        sentence=sentence(found),
        balances=tuple(balances),
        gain=Gain(found.balance, found.percent, found.interval) if extended else None,
        further=tuple(_further(found)),
        holdout=found.channels.holdout.rule,
        depends_on=attribution.depends_on,
        candidates=tuple(
            Candidate(
                c.id, c.family, c.balance, c.rmse, c.probability, c.family in named, *_words(about, c.id)
            )
            for c in attribution.candidates
        ),
        tied=attribution.tied,
        chance=attribution.deviance,
        effects=tuple(
            AddedEffect(e.id, e.balance, e.formula, e.reference, found.extended.shares.get(e.id, 0.0))
            for e in effects
        ),
        parameters=tuple(_parameters(found)),
        equations=tuple(friction_equations(found.extended.model, effects)),
        facts=tuple(_facts(found)),
        warnings=tuple(
            text for text in found.warnings if text not in {finding.text for finding in found.quality}
        ),
        findings=tuple(Finding(f.kind, f.channel, f.text, f.rows, f.severity) for f in found.quality),
        next_measurement=attribution.next_measurement,
        command=_command(found),
        files=tuple(files),
        version=__version__,
    )


def _words(about: dict[str, Effect], name: str) -> tuple[str, tuple[str, ...], str]:
    effect = about.get(name)
    return ("", (), "") if effect is None else (effect.formula, effect.aliases, effect.hint)


def _balance(found: Diagnosis, name: str) -> Balance:
    """Residuals at one scale of the drive, the extended model's, as the score has them."""
    mechanical = name == "mechanical"
    residuals = {
        m: _scaled(found, fit, fit.residuals[name]) for m, fit in _fits(found) if name in fit.residuals
    }
    adopted = found.extended is not found.paper and (
        mechanical or any(effect.balance == name for effect, _ in found.extended.effects)
    )
    return Balance(
        name=name,
        quantity=_QUANTITIES[name],
        unit=found.unit,
        rows=_rows(found),
        paper=residuals["paper"],
        extended=residuals["extended"] if adopted else None,
        linear=residuals["linear"] if mechanical else None,
        measured=_scaled(found, found.paper, found.paper.target) if mechanical else None,
        rmse=found.rmse[name],
        noise_floor=found.noise_floor if mechanical else None,
    )


def _fits(found: Diagnosis) -> list[tuple[str, Refit]]:
    return [("linear", found.linear), ("paper", found.paper), ("extended", found.extended)]


def _scaled(found: Diagnosis, fit: Refit, x: Array) -> Array:
    return x * ((fit.scale or 1.0) / (found.extended.scale or 1.0))


def _rows(found: Diagnosis) -> Rows:
    channels, mu, rows = found.channels, found.setting.mu, found.rows
    gravity = found.bench.gravity if np.any(found.bench.gravity) else None
    theta = channels.theta_m if channels.phased else None
    given = [
        ("velocity", "motor velocity", "rad/s", channels.omega_m, None),
        ("link_angle", "link angle", "rad", None if theta is None else mu * theta, TURN),
        # Without a gear the motor turns with the link.
        ("motor_angle", "motor angle", "rad", theta if abs(mu) != 1.0 else None, TURN),
        ("acceleration", "motor acceleration", "rad/s²", channels.alpha_m, None),
        ("gravity_load", "gravity torque on the motor", found.unit, gravity, None),
        ("current", "current", "A", channels.current, None),
        ("voltage", "voltage", "V", channels.voltage, None),
        ("temperature", "temperature", "°C", channels.temperature, None),
        ("time", "time in the run", "s", elapsed(channels), None),
    ]  # fmt: skip
    made = [
        Channel(k, label, u, _mean(rows, x, period), period)
        for k, label, u, x, period in given
        if x is not None
    ]
    return Rows(
        t=rows.t,
        run=rows.run,
        run_names=channels.run_names,
        train=rows.train,
        held_out=rows.score,
        channels=tuple(made),
        description=rows.description,
    )


def _mean(rows: LogRows, x: Array, period: float | None) -> Array:
    """A channel on the rows; NaN where an average goes over more than a quarter of a turn."""
    mean = rows.mean(x)
    if rows.weights is None or period is None:
        return mean
    spread = rows.mean((x - x[0]) ** 2) - (mean - x[0]) ** 2
    return np.where(spread < _QUARTER**2, mean, np.nan)


def _further(found: Diagnosis) -> list[Errors]:
    """Errors that are there for some logs: in the drive's unit, of free motion, over whole runs."""
    score = found.score
    models = {"linear", "paper"} | ({"extended"} if found.extended is not found.paper else set())

    def of(rmse: Mapping[str, float]) -> dict[str, float]:
        return {model: value for model, value in rmse.items() if model in models}

    further = []
    if score.per_drive:
        unit = {"voltage": "V", "current": "A", "torque": "N m"}[found.channels.drive]
        further.append(Errors("mechanical balance, as measured", unit, of(score.per_drive)))
    if score.free:
        note = "No electrical effect is in these rows: what predicts them is mechanical."
        further.append(Errors("with the motor switched off", found.unit, of(score.free), note=note))
    if over := score.over_runs:
        gains = [
            f"Gain of the {name} model on {_WORSE[name]}: {number(percent, 3)} % (95 % interval"
            f" {range_of((low, high), 3)} %), in {better} of {over.runs} runs."
            for name, (percent, (low, high), better) in over.gains.items()
            if name in models
        ]
        note = " ".join(
            [
                "Coefficients refitted on the other runs; the effect itself was chosen on the training runs.",
                *gains,
            ]
        )
        interval = over.gains["extended"][1] if "extended" in over.gains and "extended" in models else None
        further.append(Errors("every run left out once", found.unit, of(over.rmse), interval, note))
    return further


def _parameters(found: Diagnosis) -> list[Parameter]:
    """Those of the effects, fitted friction, what the log had to give of the bench, what the rig knew."""
    own = {q.name for effect, _ in found.shipped.effects for q in effect.parameters}
    terms = found.shipped.model.balance("mechanical").terms
    friction = {str(term.coefficient) for term in terms if term.kind == "friction"}
    estimates = found.shipped.estimates
    given = {*found.bench.drive.identified, *estimates}
    rows = []
    for q in found.shipped.model.parameters:
        value = found.shipped.values.get(q.name)
        kinds = (("effect", own), ("friction", friction), ("bench", given))
        last = "rig" if q.name in found.rig.known else "unseen"
        origin = next((name for name, letters in kinds if q.name in letters), last)
        # A coefficient that is one with another is not fitted: the other stands for their sum.
        if value is None or (origin == "friction" and estimates and q.name not in estimates):
            continue
        row = Parameter(q.name, q.meaning, q.unit, value, origin)
        if e := estimates.get(q.name):
            row = replace(
                row, std_error=e.std_error, interval=e.interval, bound=e.bound_active or "", widened=e.widened
            )
        rows.append(row)
    return sorted(rows, key=lambda row: _ORIGINS.index(row.origin))


def _facts(found: Diagnosis) -> list[Fact]:
    channels, counts = found.channels, found.channels.counts
    step = np.diff(channels.t)[np.diff(channels.segment) == 0]
    usual, points = channels.logged_step_s, channels.points_per_row
    spread = (points * step.min(), points * step.max())
    uneven = f"; steps of {spread[0]:.4g} to {spread[1]:.4g} s" if np.ptp(spread) > 0.01 * usual else ""
    runs = len(channels.run_names)
    gaps = int(channels.segment[-1]) + 1 - runs
    moving = f"faster than {channels.moving_threshold_rad_s:.3g} rad/s, clear of reversals and ends"
    held = "; ".join(f"{a:.4g} to {b:.4g} s" for a, b in channels.holdout.intervals_s[:8])

    def aligned(name: str, field: str, unit: str, factor: float = 1.0) -> Fact:
        value = getattr(channels, field)
        if e := found.shipped.estimates.get(field):
            return Fact(
                name, f"{e.value:.4g} {unit}", f"estimated, 95 % interval {range_of(e.interval)} {unit}"
            )
        given = "estimated" if field in found.rig.estimate else "from the rig file" if value else "none given"
        return Fact(name, f"{factor * value:.4g} {unit}", given)

    facts = [
        Fact("rows read", f"{counts['read']}", f"{runs} run{'s' * (runs > 1)}"),
        Fact("rows rejected", f"{counts['rejected']}", "not numbers"),
        Fact("rows used", f"{counts['used']}", moving),
        Fact("rows held out", f"{counts['held_out']}", held),
        Fact("models are compared on", found.rows.description),
        Fact("sampling", f"{1.0 / usual:.4g} Hz", f"{usual:.4g} s a row{uneven}"),
        Fact("gaps in time", f"{gaps}", "nothing is filtered across one" if gaps else ""),
        Fact("drive measured by", channels.drive),
        Fact("step of the motor angle", f"{channels.quantum_rad:.3g} rad"),
        aligned("input delay", "input_delay_s", "ms", 1e3),
        aligned("zero angle", "theta_zero_rad", "rad"),
    ]
    if channels.voltage is not None:
        facts.append(aligned("voltage offset", "voltage_offset_V", "V"))
    facts += [
        Fact(
            "periodic inside runs",
            f"{o.per_turn:.2f} per motor turn",
            f"amplitude {o.amplitude:.3g} {found.unit}, {100 * o.share:.0f} % of the variance that is left,"
            f" in {o.seen} of {o.stretches} stretches",
        )
        for o in found.orders
    ]
    noise = f"{found.noise_floor:.3g} {found.unit}"
    return [*facts, Fact("noise of the sensors", noise, "RMS of a row; no model can be better")]


def _command(found: Diagnosis) -> str:
    words = ["eccentric", "diagnose", *found.logs, "--rig", found.rig_name]
    if found.model != found.rig.model:
        words += ["--model", Path(found.model).name]
    if found.own is not None:
        words += ["--effects", found.own.name]
    return shlex.join([*words, "--out", "DIR"])
