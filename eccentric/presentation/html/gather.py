"""A Diagnosis as the records of the report.

No other file of the report knows about fits.
"""

from __future__ import annotations

import math
import re
import shlex
from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from pathlib import Path

import numpy as np

from eccentric.diagnosis import Diagnosis
from eccentric.effects import Effect
from eccentric.identification import DRIVE_UNITS, Refit, in_drive_unit
from eccentric.model import AxisKind, spoken
from eccentric.presentation.calls_text import calls, share_words
from eccentric.presentation.diagnosis_text import (
    diagnosis_sentence,
    empirical_sentence,
    further_sentences,
    request_words,
    stability_words,
)
from eccentric.presentation.html.arrays import (
    TURN,
    BalanceResiduals,
    Channel,
    DriveSignal,
    ResidualRows,
    SmoothResiduals,
)
from eccentric.presentation.html.data import (
    AddedEffect,
    CandidateRow,
    Conclusion,
    Correlations,
    Errors,
    ExtendedModel,
    Fact,
    Gain,
    HeldOutErrors,
    LogQuality,
    Parameter,
    ReportData,
    SearchTable,
    Source,
)
from eccentric.presentation.html.equation import friction_equations, typesetter_of
from eccentric.presentation.html.text import number, range_of
from eccentric.presentation.plan_text import measurement_sentence
from eccentric.presentation.ranges_text import range_line
from eccentric.rigs import KNOWNS
from eccentric.signals import Rows
from eccentric.simulation import SimulatedErrors
from eccentric.version import __version__

# The balances of the report: residuals of the models on the rows, and the channels on the axes.


Array = np.ndarray
_QUARTER = TURN / 4


def balance_of(found: Diagnosis, name: str) -> BalanceResiduals:
    """Residuals at one scale of the drive, that of the extended model, as in the score."""
    mechanical, axis = name == "mechanical", found.rig.axis
    models = found.models
    fits = {"linear": models.linear, "paper": models.paper, "extended": models.extended}
    residuals = {
        m: _scaled(found, fit, fit.residuals[name]) for m, fit in fits.items() if name in fit.residuals
    }
    adopted = found.models.adopted and (
        mechanical or any(effect.balance == name for effect, _ in found.models.extended.effects)
    )
    return BalanceResiduals(
        name=name,
        quantity="friction" if mechanical else f"{axis.term('torque')} of the voltage",
        unit=axis.unit(found.unit),
        rows=_rows(found),
        paper=residuals["paper"],
        extended=residuals["extended"] if adopted else None,
        linear=residuals["linear"] if mechanical else None,
        measured=_scaled(found, found.models.paper, found.models.paper.target) if mechanical else None,
        rmse=found.score.rmse[name],
        noise_floor=found.noise_floor if mechanical else None,
        drive=_drive(found) if mechanical else None,
        smooth=_smooth(found, name, residuals["paper"], residuals["extended"] if adopted else None),
    )


def _smooth(found: Diagnosis, name: str, paper: Array, extended: Array | None) -> SmoothResiduals | None:
    """Residuals below the low pass, which fitted rows have passed already; None where rows are averages."""
    rows, models = found.rows, found.models
    if rows.operator is not None:
        return None

    def passed(fit: Refit, residual: Array) -> Array:
        return np.where(rows.score, fit.residual_like(models.extended, name, smooth=True), residual)

    return SmoothResiduals(
        found.rig.sampling.low_pass_hz,
        passed(models.paper, paper),
        None if extended is None else passed(models.extended, extended),
    )


def _drive(found: Diagnosis) -> DriveSignal:
    """The measured drive on the rows, and how much of it a newton metre is."""
    drive, scale = found.data.drive, found.models.extended.scale
    name = found.channels.motor.measured_by
    gain = 1.0
    if scale is not None:
        gain = scale
    elif name == "current":
        gain = float(drive.machine.current_of_torque(drive.known, 1.0))
    axis = found.rig.axis
    label, unit = axis.named(name), axis.unit(DRIVE_UNITS[name])
    signal, averaged = drive.signal(), found.rows.operator is not None
    values = found.rows.mean(signal) if averaged else found.channels.smooth(signal)
    return DriveSignal(label, unit, np.where(found.data.off, np.nan, values), gain)


def _scaled(found: Diagnosis, fit: Refit, x: Array) -> Array:
    return x * ((fit.scale or 1.0) / (found.models.extended.scale or 1.0))


def _rows(found: Diagnosis) -> ResidualRows:
    channels, mu, rows = found.channels, found.setting.mu, found.rows
    axis = found.rig.axis
    # The screw of a carriage turns by an angle, whose unit is not one of length.
    turn, radian = (TURN, "rad") if axis.wraps else (None, "radian")  # "radian" is no unit of ours
    turns = axis.wraps or "pitch" in found.rig.known
    gravity = found.data.gravity if np.any(found.data.gravity) else None
    theta = channels.motion.theta_m if channels.phased else None
    given = [
        ("velocity", "motor velocity", "rad/s", channels.motion.omega_m, None),
        ("link_angle", "link angle", radian, None if theta is None or not turns else mu * theta, TURN),
        # Without a gear the motor turns with the link.
        ("motor_angle", "motor angle", "rad", theta if abs(mu) != 1.0 else None, turn),
        ("acceleration", "motor acceleration", "rad/s²", channels.motion.alpha_m, None),
        ("gravity_load", "gravity torque on the motor", found.unit, gravity, None),
        ("current", "current", "A", channels.motor.current, None),
        ("voltage", "voltage", "V", channels.motor.voltage, None),
        ("temperature", "temperature", "°C", channels.temperature, None),
        ("time", "time in the run", "s", channels.time.elapsed, None),
    ]  # fmt: skip
    made = [
        Channel(axis.named(k), axis.term(label), axis.unit(u), _mean(rows, x, period), period)
        for k, label, u, x, period in given
        if x is not None
    ]
    return ResidualRows(
        t=rows.t,
        run=rows.run,
        run_names=channels.time.run_names,
        train=rows.train,
        held_out=rows.score,
        channels=tuple(made),
        description=rows.description,
    )


def _mean(rows: Rows, x: Array, period: float | None) -> Array:
    """A channel on the rows; NaN where an average covers more than a quarter of a turn."""
    if rows.operator is None:
        return x
    mean = rows.mean(x)
    if period is None:
        return mean
    spread = rows.mean((x - x[0]) ** 2) - (mean - x[0]) ** 2
    return np.where(spread < _QUARTER**2, mean, np.nan)


# The data-quality table of the report: rows, sampling, gaps, delay, zero angle, noise.


def facts_of(found: Diagnosis) -> list[Fact]:
    """Facts about the log, in the order of the table."""
    channels, counts = found.channels, found.channels.counts
    step = np.diff(channels.time.t)[np.diff(channels.time.segment) == 0]
    usual, points = channels.time.logged_step_s, channels.time.points_per_row
    spread = (points * step.min(), points * step.max())
    uneven = f"; steps of {spread[0]:.4g} to {spread[1]:.4g} s" if np.ptp(spread) > 0.01 * usual else ""
    runs = len(channels.time.run_names)
    gaps = int(channels.time.segment[-1]) + 1 - runs
    axis, unit = found.rig.axis, found.rig.axis.unit(found.unit)
    fastest = f"{channels.selection.moving_threshold_rad_s:.3g} {axis.unit('rad/s')}"
    moving = f"faster than {fastest}, clear of reversals and ends"
    held = "; ".join(f"{a:.4g} to {b:.4g} s" for a, b in channels.selection.holdout.intervals_s[:8])

    def aligned(name: str, field: str, unit: str, factor: float = 1.0) -> Fact:
        value = getattr(channels.alignment, field)
        if e := found.models.extended.estimates.get(field):
            return Fact(
                name, f"{number(e.value)} {unit}", f"estimated, 95 % interval {range_of(e.interval)} {unit}"
            )
        given = "from the rig file" if field in found.rig.aligned else "by default"
        given = "estimated" if field in found.rig.estimate else given
        return Fact(name, f"{number(factor * value)} {unit}", given)

    facts = [
        Fact("rows read", f"{counts['read']}", f"{runs} run{'s' * (runs > 1)}"),
        Fact("rows rejected", f"{counts['rejected']}", "with a value that is not a number"),
        Fact("rows used", f"{counts['used']}", moving),
        Fact("rows held out", f"{counts['held_out']}", held),
        Fact("errors are computed on", found.rows.description),
        Fact("sampling", f"{1.0 / usual:.4g} Hz", f"{usual:.4g} s per row{uneven}"),
        Fact("gaps in time", f"{gaps}", "sections are filtered separately" if gaps else ""),
        Fact("drive measured by", axis.named(channels.motor.measured_by)),
        Fact(
            f"step of the {axis.term('motor angle')}", f"{channels.motion.quantum_rad:.3g} {axis.unit('rad')}"
        ),
        aligned("input delay", "input_delay_s", "ms", 1e3),
        *([aligned("zero angle", "theta_zero_rad", "rad")] if axis.wraps else []),
    ]
    if channels.motor.voltage is not None:
        facts.append(aligned("voltage offset", "voltage_offset_V", "V"))
    facts += [
        Fact(
            "periodic inside runs",
            f"{o.per_turn:.2f} per {axis.term('motor turn')}",
            f"amplitude {o.amplitude:.3g} {unit}, {100 * o.share:.0f} % of the residual variance,"
            f" in {o.seen} of {o.stretches} stretches",
        )
        for o in found.orders
    ]
    if channels.excerpt:
        facts.insert(1, Fact("windows of a long log", f"{counts['used']} rows", channels.excerpt))
    if found.rig.added:
        facts.insert(1, Fact("added masses", found.rig.added_words))
    if words := request_words(found.asked.request):
        facts.insert(0, Fact("effects, as requested", words))
    noise, left = found.noise_floor, found.score.rmse["mechanical"]["extended"]
    remark = (
        f"RMS in {found.rows.description}; the held-out error is {left / noise:.3g} times this"
        if noise > 0.0
        else "none seen"
    )
    return [*facts, Fact("sensor noise", f"{noise:.3g} {unit}", remark)]


_ORIGINS = ("effect", "friction", "estimated", "part", "rig", "model", "unseen")


# The records of a report.


def report_data(
    found: Diagnosis, simulated: SimulatedErrors | None = None, files: Sequence[tuple[str, str]] = ()
) -> ReportData:
    """The records of a diagnosis.

    Args:
        found: the diagnosis.
        simulated: errors of its models' simulated motion.
        files: (name, description) of everything written beside the report.
    """
    attribution, score, findings = found.attribution, found.score, found.channels.intake.findings
    effects = [effect for effect, _ in found.models.extended.effects]
    names = sorted(score.rmse, key=lambda name: name != score.balance)
    axis = found.rig.axis
    balances = tuple(balance_of(found, name) for name in names)
    rows = balances[0].rows
    return ReportData(
        source=Source(
            logs=found.asked.logs,
            rig=found.asked.rig,
            model=found.models.base.name,
            model_title=spoken(found.models.base).title,
            command=_command(found),
            version=__version__,
            plan=_plan(found),
            axis=axis,
        ),
        conclusion=Conclusion(
            verdict=attribution.verdict,
            sentence=diagnosis_sentence(found),
            depends_on=tuple(map(axis.named, attribution.depends_on)),
            closest=" ".join(further_sentences(found)),
            next_measurement=measurement_sentence(attribution.next_measurement, axis),
            fits_the_rig=found.models.fits_the_rig,
            confirmed=not attribution.unconfirmed,
            clear=tuple(effect.words.headline or effect.id for effect, _ in found.clear),
            calls=_calls(found),
        ),
        errors=HeldOutErrors(
            holdout=found.channels.selection.holdout.rule,
            balances=balances,
            gain=Gain(score.balance, score.percent, score.interval) if found.models.adopted else None,
            further=(*_further(found), *_simulated(found, simulated)),
            below=_below(found),
        ),
        search=SearchTable(tuple(_candidates(found)), attribution.tied, attribution.deviance),
        extended=ExtendedModel(
            effects=tuple(_added(effect, found, rows.channels) for effect in effects),
            parameters=tuple(_parameters(found)),
            equations=tuple(friction_equations(spoken(found.models.extended.model), effects, axis)),
            correlations=_correlations(found.models.extended, axis),
            empirical=_empirical(found),
        ),
        log=LogQuality(
            facts=tuple(facts_of(found)),
            findings=tuple(replace(f, channel=axis.named(f.channel)) for f in findings),
            warnings=tuple(text for text in found.warnings if text not in {f.text for f in findings}),
        ),
        files=tuple(files),
    )


def _empirical(found: Diagnosis) -> tuple[str, str, BalanceResiduals] | None:
    """What the term without a cause does, the first channel that it follows, and the residuals."""
    own = found.empirical
    if own is None or not own.confirmed:
        return None
    balance = balance_of(found, "mechanical")
    left = _scaled(found, own.fitted, own.fitted.residuals["mechanical"])
    keys = map(found.rig.axis.named, (*own.variables, "velocity"))
    channel = next(key for key in keys if balance.rows.channel(key) is not None)
    before = balance.paper if balance.extended is None else balance.extended
    return empirical_sentence(found), channel, replace(balance, paper=before, extended=left)


def _simulated(found: Diagnosis, simulated: SimulatedErrors | None) -> Iterator[Errors]:
    """The errors of the simulated motion, a record for each horizon."""
    if simulated is None:
        return
    axis, adopted = found.rig.axis, found.models.adopted
    for k, horizon in enumerate(simulated.horizons_s):
        errors = {m.name: m.horizons[k] for m in simulated.models if m.name != "extended" or adopted}
        shown = {name: x for name, x in errors.items() if x is not None and math.isfinite(x)}
        if not shown:
            continue
        count = simulated.windows[k]
        windows = f"{count} held-out window{'s' * (count > 1)}"
        yield Errors(
            f"simulated {axis.term('motor angle')} over {horizon:g} s",
            axis.unit("rad"),
            shown,
            note="Mean absolute error of the motion simulated from the log's drive signal, in"
            f" {windows} started from the measured state.",
            own_scale=True,
        )


_CALL = re.compile(r"(?P<words>.*?)(?P<code>\w+\([^()]*\))?$")


def _calls(found: Diagnosis) -> tuple[tuple[str, str], ...]:
    """How firmware calls the extended model; none where the answer is a wrong value in the rig file."""
    if found.attribution.verdict != "named" or all(effect.corrects for effect, _ in found.effects):
        return ()
    first, *rest = calls(found)
    lines = (_CALL.match(line) for line in (first.removeprefix("to call: "), *rest))
    return tuple((one["words"].strip(), one["code"] or "") for one in lines if one)


def _candidates(found: Diagnosis) -> Iterator[CandidateRow]:
    adopted = {effect.family for effect, _ in found.models.extended.effects}
    about = {effect.id: effect for effect in found.offered}
    for c in found.attribution.candidates:
        row = CandidateRow(
            c.id, c.family, c.balance, c.rmse, c.probability, c.family in adopted, instead_of=c.instead_of
        )
        if e := about.get(c.id):
            words = {"hint": e.words.hint, "headline": e.words.headline}
            row = replace(row, formula=e.formula, aliases=e.evidence.aliases, **words)
        yield row


def _added(effect: Effect, found: Diagnosis, channels: Sequence[Channel]) -> AddedEffect:
    return AddedEffect(
        id=effect.id,
        balance=effect.balance,
        meaning=effect.words.meaning,
        formula=effect.formula,
        reference=effect.reference,
        share=share_words(found.models.extended, effect),
        headline=effect.words.headline,
        stability=stability_words(found, effect),
        ranges=tuple(range_line(check) for check in found.ranges if check.effect == effect.id),
        follows=_follows(effect, found, channels),
    )


def _follows(effect: Effect, found: Diagnosis, channels: Sequence[Channel]) -> tuple[Channel, ...]:
    """The channels that an effect may be drawn over: its leading variable, over a period too, or any."""
    by_key, axis, mu = {channel.key: channel for channel in channels}, found.rig.axis, found.setting.mu
    motor, link = axis.named("motor_angle"), axis.named("link_angle")
    key = axis.named(effect.evidence.depends_on[0])
    if key == motor and motor not in by_key:
        key = link  # without a gear the motor turns with it
    if key not in by_key:
        return tuple(channels)
    channel = by_key[key]
    period = TURN * (abs(mu) if key == link else 1.0) / abs(effect.per_turn(mu, found.models.extended.values))
    if not 0.0 < period < (1.0 - 1e-9) * TURN or found.rows.operator is not None:
        return (channel,)
    times = TURN / period
    whole = abs(times - round(times)) < 1e-6 * times
    part = f"{period:.3g} {channel.unit}"
    if whole and channel.unit == "rad":
        part = "π" if round(times) == 2 else f"2π/{times:.0f}"
    return channel, replace(channel, label=f"{channel.label} modulo {part}", period=period)


def _below(found: Diagnosis) -> Errors | None:
    below = found.score.below
    if below is None or not found.score.only_below:
        return None
    axis = found.rig.axis
    name, rmse = (
        f"below {below.cut_hz:g} Hz, the cut-off frequency of the {axis.term('angle')}",
        (below.before, below.after),
    )
    note = "Row by row, a model of ripple above the cut-off frequency adds error."
    return Errors(
        name, axis.unit(found.unit), dict(zip(("paper", "extended"), rmse, strict=True)), below.interval, note
    )


def _further(found: Diagnosis) -> list[Errors]:
    """Errors that only some logs have: in the drive's unit, of free motion, over whole runs."""
    score, axis = found.score, found.rig.axis
    own_unit = axis.unit(found.unit)
    worse = {"paper": "Coulomb and viscous friction", "extended": axis.term("the paper's")}
    models = {"linear", "paper"} | ({"extended"} if found.models.adopted else set())

    def of(rmse: Mapping[str, float]) -> dict[str, float]:
        return {model: value for model, value in rmse.items() if model in models}

    further = []
    if score.per_drive:
        unit = axis.unit(DRIVE_UNITS[found.channels.motor.measured_by])
        further.append(Errors("mechanical balance, as measured", unit, of(score.per_drive)))
    if score.free:
        note = "These rows contain no electrical effect: only mechanical terms predict them."
        further.append(Errors("with the motor switched off", own_unit, of(score.free), note=note))
    if over := score.over_runs:
        gains = [
            f"Gain of the {name} model on {worse[name]}: {number(percent, 3)} % (95 % interval"
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
        further.append(Errors("every run left out once", own_unit, of(over.rmse), interval, note))
    return further


def _parameters(found: Diagnosis) -> list[Parameter]:
    """Parameters of the effects, fitted friction, those of the bench that were estimated, and known ones."""
    own = {q.name for effect, _ in found.models.extended.effects for q in effect.parameters}
    terms = found.models.extended.model.balance("mechanical").terms
    friction = {str(term.coefficient) for term in terms if term.kind == "friction"}
    estimates = found.models.extended.estimates
    given = {*found.data.drive.identified, *estimates} - set(found.rig.known)
    shared, placeholders = _shared(found, given), _placeholders(found)
    shown = spoken(found.models.extended.model)
    letters, typeset = {q.name: q for q in shown.parameters}, typesetter_of(shown)
    axis, rows = found.rig.axis, []
    for q in found.models.extended.model.parameters:
        value = found.models.extended.values.get(q.name)
        kinds = (
            ("effect", own),
            ("friction", friction),
            ("part", shared),
            ("estimated", given),
            ("rig", found.rig.known),
            ("model", found.data.drive.known.keys() - {known.name for known in KNOWNS}),
        )
        origin = next((name for name, letters in kinds if q.name in letters), "unseen")
        # A coefficient that is inseparable from another is not fitted: the other represents their sum.
        if value is None or (origin == "friction" and estimates and q.name not in estimates):
            continue
        if q.name in placeholders - set(estimates) and origin != "effect":
            continue
        fitted = origin in {"effect", "friction", "estimated"}
        unit = in_drive_unit(q.unit, found.unit) if fitted else q.unit
        own_letter = letters[axis.named(q.name)]
        letter, unit = typeset(own_letter.symbol), axis.unit(unit)
        row = Parameter(own_letter.name, own_letter.meaning, unit, value, origin, letter=letter)
        row = replace(row, part_of=shared.get(q.name, ""))
        if e := estimates.get(q.name):
            error = e.std_error if math.isfinite(e.std_error) else None
            ends = e.interval if all(map(math.isfinite, e.interval)) else None
            row = replace(row, std_error=error, interval=ends, bound=e.bound_active or "", widened=e.widened)
        rows.append(row)
    return sorted(rows, key=lambda row: _ORIGINS.index(row.origin))


def _shared(found: Diagnosis, given: AbstractSet[str]) -> dict[str, str]:
    """Parameters -> what the log identifies of them: only the inertia as a whole, only R over k_i."""
    drive, axis = found.data.drive, found.rig.axis
    machine, shared = drive.machine, {}
    if machine.link and {machine.rotor, machine.link} <= given:
        letters = (axis.named(name) for name in (machine.rotor, machine.link))
        shared |= dict.fromkeys((machine.rotor, machine.link), "{} + mu^2 {}".format(*letters))
    motor = {*machine.torque_letters, *machine.resistance_letters}
    if drive.by_voltage and motor <= given:
        shared |= dict.fromkeys(motor, axis.named("R/k_i"))
    return shared


def _placeholders(found: Diagnosis) -> set[str]:
    """Parameters that stand for nothing known or identified: of the motor, and 1 kg m^2 of a coast-down."""
    drive = found.data.drive
    return drive.placeholders | (set(drive.machine.inertias) if found.rig.per_inertia else set())


def _correlations(fit: Refit, axis: AxisKind) -> Correlations | None:
    """Those of the estimates that have an error: a bound leaves none."""
    error = np.sqrt(np.diag(fit.covariance))
    free = np.flatnonzero(np.isfinite(error) & (error > 0.0))
    if len(free) < 2:
        return None
    names = list(fit.estimates)
    own = fit.covariance[np.ix_(free, free)]
    return Correlations(tuple(axis.named(names[k]) for k in free), own / np.outer(error[free], error[free]))


def _plan(found: Diagnosis) -> str:
    """The command that plans the next measurement; "" after a narrowed search, or for a misfit."""
    narrowed = found.asked.effects is not None or request_words(found.asked.request)
    if narrowed or not found.models.fits_the_rig:
        return ""
    words = ["eccentric", "plan", *found.asked.logs, "--rig", found.asked.rig, "--limits", "limits.toml"]
    return shlex.join([*words, *_model(found), "--out", "plan"])


def _model(found: Diagnosis) -> list[str]:
    named = found.asked.model != found.rig.model and not found.asked.request.including
    return ["--model", Path(found.asked.model).name] if named else []


def _command(found: Diagnosis) -> str:
    words = ["eccentric", "diagnose", *found.asked.logs, "--rig", found.asked.rig]
    words += _model(found)
    if found.asked.effects is not None:
        words += ["--effects", found.asked.effects.name]
    request = found.asked.request
    for flag, names in (("with", request.including), ("without", request.without), ("only", request.only)):
        words += [word for name in names for word in (f"--{flag}", name)]
    words += ["--empirical"] if request.empirical else []
    return shlex.join([*words, "--out", "DIR"])
