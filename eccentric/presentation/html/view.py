"""What the report's templates see: strings and lists of strings; all arithmetic and choices are made here."""

from __future__ import annotations

import math
from html import escape
from typing import Any

from eccentric.joints import ArmDiagnosis, arm_name, why_not_emitted
from eccentric.model import AxisKind
from eccentric.presentation.arm import arm_diagnosis_sentence
from eccentric.presentation.diagnosis_text import VERDICTS, verdict_words
from eccentric.presentation.html.arrays import BalanceResiduals, PartErrors, RunErrors, runs_of
from eccentric.presentation.html.data import CandidateRow, Errors, Parameter, ReportData
from eccentric.presentation.html.figures import Figures
from eccentric.presentation.html.formulas import is_letter, short_formula, with_symbols
from eccentric.presentation.html.panels import Panel, friction_panel, leading_panel, residual_panel, trace
from eccentric.presentation.html.pictures import Picture, drive_picture, residual_picture
from eccentric.presentation.html.text import (
    correlation_words,
    curve_name,
    figure_words,
    headline,
    meaning_html,
    number,
    plain_words,
    range_of,
    runs_words,
    trace_words,
    unit_text,
    why,
)

_ORIGINS = {
    "effect": "fitted, new",
    "friction": "fitted",
    "estimated": "estimated jointly",
    "part": "only {} is identified",
    "model": "model default, not fitted",
    "unseen": "a placeholder: nothing in this log depends on it",
    "rig": "declared in the rig file",
}
_LEADING = 5
"""Candidates shown at first: those that lead the list, and all that are adopted or tied."""
SHOWN_RUNS = 12
"""Runs of the table that are not folded."""
_MARKS = {"named": "✓", "not_identifiable": "≈", "unexplained": "?", "nothing_missing": "○"}


def view(data: ReportData, library: str) -> dict[str, Any]:
    """The variables of the templates; without the `library` that draws, figures are left out."""
    shown = [b for k, b in enumerate(data.errors.balances) if k == 0 or b.extended is not None]
    axis = data.source.axis
    figures = Figures(axis)
    residuals = [(b, _residuals(figures, b, data)) for b in shown] if library else []
    friction = [one for b in shown for one in _friction(figures, b, axis)] if library else []
    traces = [one for b in shown for one in _traces(figures, b, axis)] if library else []
    return {
        "title": f"What is the model missing? {', '.join(data.source.logs)}",
        "headline": headline(data),
        "data": data,
        "verdict": verdict_words(data.conclusion.verdict, data.conclusion.fits_the_rig),
        "mark": _MARKS[data.conclusion.verdict],
        "key_figures": _key_figures(data),
        "errors": _errors(data),
        "runs": _runs(data),
        "follows": _follows(data),
        "drive": next((one for b in shown if (one := drive_picture(b, axis))), None),
        "correlations": _correlations(data),
        "residuals": [(f"{b.name} balance", b.unit, panels) for b, panels in residuals],
        "friction": friction,
        "empirical": None if data.extended.empirical is None else _empirical(figures, data, library),
        "traces": traces,
        "rows": data.errors.balances[0].rows.description,
        "depends": ", ".join(axis.term(plain_words(key)) for key in data.conclusion.depends_on),
        "candidates": _candidates(data),
        "why": why(data),
        "parameters": [_parameter(p, axis) for p in data.extended.parameters],
        "effects": [(e, axis.text(short_formula(e.formula)), e.share) for e in data.extended.effects],
        "hints": _hints(data),
        "figures_json": figures.json(),
        "term": axis.term,
        "bokeh": library,
    }


def _figure(ids: list[str], caption: tuple[str, str]) -> dict[str, Any]:
    """The template's view of a figure, with one plot or several that belong together."""
    return {"ids": ids, "caption": caption[0], "alternative": caption[1]}


def _panel(
    figures: Figures, panel: Panel, quantity: str, balance: BalanceResiduals, axis: AxisKind
) -> dict[str, Any]:
    ids = figures.panel(panel, quantity, balance.unit)
    return _figure(ids, figure_words(panel, balance.unit, axis))


def _residuals(figures: Figures, balance: BalanceResiduals, data: ReportData) -> list[dict[str, Any]]:
    """One figure per channel; those that the residual depends on come first."""
    order = {key: k for k, key in enumerate(data.conclusion.depends_on)}
    found = []
    for channel in sorted(balance.rows.channels, key=lambda c: order.get(c.key, len(order))):
        panel = residual_panel(balance, channel)
        if panel is not None:
            drawn = _panel(figures, panel, "residual", balance, data.source.axis)
            found.append(drawn | {"depends": channel.key in order})
    return found


def _follows(data: ReportData) -> tuple[str, list[Picture]] | None:
    """A heading, and the residual over what each effect follows; without one, over what it depends on."""
    axis, balances = data.source.axis, {balance.name: balance for balance in data.errors.balances}
    first = data.errors.balances[0]
    if effects := [e for e in data.extended.effects if balances[e.balance].extended is not None]:
        named = [(e.headline or e.id, balances[e.balance], e.follows) for e in effects]
    else:
        channels = map(first.rows.channel, data.conclusion.depends_on[:1])
        named = [("", first, [channel for channel in channels if channel is not None])]
    pictures = [
        residual_picture(panel, balance, axis, title if len(named) > 1 else "")
        for title, balance, channels in named
        if (panel := leading_panel(balance.below, channels)) is not None
    ]
    heading = "Residual before and after" if effects else "What the residual depends on"
    return (heading, pictures) if pictures else None


def _empirical(figures: Figures, data: ReportData, library: str) -> dict[str, Any]:
    """The sentence, and the residual over the variable with and without the term; no figure without Bokeh."""
    if data.extended.empirical is None:
        return {}
    sentence, key, balance = data.extended.empirical
    channel = balance.rows.channel(key)
    panel = residual_panel(balance, channel) if library and channel is not None else None
    drawn = [_panel(figures, panel, "residual", balance, data.source.axis)] if panel is not None else []
    return {"sentence": sentence, "figures": drawn}


def _friction(figures: Figures, balance: BalanceResiduals, axis: AxisKind) -> list[dict[str, Any]]:
    found = []
    for key in ("velocity", "link_angle"):
        channel = balance.rows.channel(key)
        panel = channel and friction_panel(balance, channel)
        if panel:
            found.append(_panel(figures, panel, balance.quantity, balance, axis))
    return found


def _traces(figures: Figures, balance: BalanceResiduals, axis: AxisKind) -> list[dict[str, Any]]:
    found = trace(balance)
    if found is None:
        return []
    ids = figures.trace(found, balance.rows.run_names, balance.quantity, balance.unit)
    return [_figure(ids, trace_words(found, balance, axis))]


def _key_figures(data: ReportData) -> list[tuple[str, str]]:
    first, gain, below = data.errors.balances[0], data.errors.gain, data.errors.below
    rmse = first.rmse if below is None else below.rmse
    paper, after = rmse["paper"], rmse.get("extended", rmse["paper"])
    found = []
    if gain:
        where = "" if below is None else f" {below.name}"
        found.append((f"held-out error{where}", f"{number(paper, 3)} → {number(after, 3)} {first.unit}"))
        own = gain.interval if below is None or below.interval is None else below.interval
        percent = gain.percent if below is None else 100.0 * (1.0 - after / paper)
        found.append((f"reduction (95 % interval {range_of(own, 3)} %)", f"{number(percent, 3)} %"))
    else:
        found.append(("held-out error", f"{number(paper, 3)} {first.unit}"))
    adopted = [c for c in data.search.candidates if c.adopted]
    several = len(adopted) > 1
    found += [(f"probability{f' of {c.id}' * several}", f"{c.probability:.2f}") for c in adopted]
    if first.noise_floor is not None:
        found.append(("sensor noise", f"{number(first.noise_floor, 3)} {first.unit}"))
    return found


def _errors(data: ReportData) -> list[dict[str, Any]]:
    """Bars of the errors of every balance, then of the further ones; bars in one unit have one scale."""
    given: list[tuple[Errors, float | None]] = []
    gain = data.errors.gain
    for b in data.errors.balances:
        interval = gain.interval if gain and gain.balance == b.name else None
        rmse = {m: x for m, x in b.rmse.items() if m != "extended" or gain}
        given.append((Errors(f"{b.name} balance", b.unit, rmse, interval), b.noise_floor))
    below = [] if data.errors.below is None else [data.errors.below]
    given += [(errors, None) for errors in (*below, *data.errors.further)]
    tops: dict[str, float] = {}
    for errors, noise in given:
        own = max([*errors.rmse.values(), noise or 0.0, *_ends(errors)])
        tops[_scale(errors)] = max(tops.get(_scale(errors), 0.0), own)
    return [_bars(errors, noise, 1.02 * tops[_scale(errors)], data.source.axis) for errors, noise in given]


def _scale(errors: Errors) -> str:
    """What has one scale: bars in one unit; a simulated motion leaves the measured one, each at its pace."""
    return errors.name if errors.own_scale else errors.unit


def _ends(errors: Errors) -> list[float]:
    """The interval of the extended model's error; none without an interval of the improvement."""
    if not errors.interval:
        return []
    return [errors.rmse["paper"] * (1.0 - percent / 100.0) for percent in reversed(errors.interval)]


def _bars(errors: Errors, noise: float | None, top: float, axis: AxisKind) -> dict[str, Any]:
    """A bar as long as `top` has full width; the interval of the improvement is a whisker on "extended"."""
    ends = _ends(errors)
    part = 100.0 / top if top > 0.0 else 0.0
    bars = [
        {
            "model": model,
            "name": curve_name(model, axis),
            "value": number(value),
            "width": f"{value * part:.2f}",
        }
        for model, value in errors.rmse.items()
    ]
    return {
        "name": errors.name,
        "unit": errors.unit,
        "bars": bars,
        "whisker": [f"{x * part:.2f}" for x in (ends[0], ends[1] - ends[0])] if ends else [],
        "interval": [number(x) for x in ends],
        "noise": None if noise is None else (number(noise, 3), f"{noise * part:.2f}"),
        "note": errors.note,
    }


def _runs(data: ReportData) -> dict[str, Any] | None:
    """The table of runs, the first of it shown, the rest folded; None with a single run."""
    balance = data.errors.balances[0]
    runs = runs_of(balance) if len(balance.rows.run_names) > 1 else []
    if len(runs) < 2:
        return None
    rows = [_run(run) for run in runs]
    return {
        "unit": balance.unit,
        "after": balance.extended is not None,
        "level": any(row["level"] for row in rows),
        "parts": [("", rows[:SHOWN_RUNS])]
        + ([(f"{len(rows) - SHOWN_RUNS} further runs", rows[SHOWN_RUNS:])] if len(rows) > SHOWN_RUNS else []),
        "apart": runs_words(runs),
    }


def _run(run: RunErrors) -> dict[str, Any]:
    level = run.level
    return {
        "name": run.name,
        "parts": [_part(run.fitted), _part(run.held_out)],
        "level": "" if level is None else f"{level[0]:.4f} ± {level[1]:.4f}",
    }


def _part(part: PartErrors | None) -> tuple[str, str, str]:
    """Rows, error before, error after."""
    if part is None:
        return "", "", ""
    after = "" if part.after is None else number(part.after, 3)
    return f"{part.rows}", number(part.before, 3), after


def _correlations(data: ReportData) -> dict[str, Any] | None:
    """The lower triangle; a cell's tint is the size of its correlation."""
    found = data.extended.correlations
    if found is None:
        return None
    rows = []
    for k, name in enumerate(found.names):
        cells = [_cell(float(found.matrix[k, j])) for j in range(k)]
        rows.append((_name(name), cells, len(found.names) - 1 - k))
    names = [_name(name) for name in found.names[:-1]]
    return {"names": names, "rows": rows[1:], "close": correlation_words(found)}


def _name(name: str) -> str:
    """HTML of a parameter: its symbol; one that is a word is code."""
    return with_symbols(name) if is_letter(name) else f"<code>{escape(name)}</code>"


def _cell(r: float) -> tuple[str, str, str]:
    """Text, kind and tint in percent."""
    if not math.isfinite(r):
        return "", "", "0"
    return f"{r:.2f}".replace("-", "−"), "minus" if r < 0.0 else "plus", f"{60.0 * min(abs(r), 1.0):.0f}"


def _candidates(data: ReportData) -> list[tuple[str, list[dict[str, Any]]]]:
    """The table of the leading candidates and, folded below its heading, that of all others."""
    made = [_candidate(c, data) for c in data.search.candidates]
    shown = max([_LEADING, *(k + 1 for k, c in enumerate(made) if c["standing"])])
    heading = f"{len(made) - shown} further candidates"
    return [part for part in (("", made[:shown]), (heading, made[shown:])) if part[1]]


def _hints(data: ReportData) -> list[tuple[str, CandidateRow, str]]:
    """Candidates whose hint is worth a further log, between the words that say what for."""
    found = []
    for c in data.search.candidates:
        if c.hint and c.family in data.search.tied:
            found.append(("separate", c, " from other effects"))
        elif c.hint and c.adopted:
            found.append(("confirm", c, ""))
    return found


def _candidate(c: CandidateRow, data: ReportData) -> dict[str, Any]:
    units = {balance.name: balance.unit for balance in data.errors.balances}
    standing = "tied" if c.family in data.search.tied else "adopted" if c.adopted else ""
    return {
        "standing": standing,
        "id": c.id,
        "headline": c.headline,
        "formula": data.source.axis.text(short_formula(c.formula)),
        "balance": c.balance,
        "rmse": f"{number(c.rmse)} {units.get(c.balance, '')}",
        "probability": f"{c.probability:.2f}",
        "width": f"{100.0 * c.probability:.1f}",
        "aliases": ", ".join(c.aliases),
    }


def _parameter(p: Parameter, axis: AxisKind) -> dict[str, Any]:
    notes = [f"{p.bound} bound active"] if p.bound else []
    if p.widened and not p.bound:
        notes.append("widened by a bound")
    return {
        "name": p.name,
        "letter": p.letter,
        # A symbol is its own name in code: B_lN.
        "code": not (p.letter and is_letter(p.name)),
        "meaning": axis.text(meaning_html(p.meaning)),
        "value": number(p.value),
        "error": "" if p.std_error is None else number(p.std_error, 2),
        "interval": "" if p.interval is None else range_of(p.interval),
        "unit": unit_text(p.unit),
        "note": "; ".join([_ORIGINS[p.origin].format(p.part_of), *notes]),
        "origin": p.origin,
    }


# The page of an arm: its joints in a table, each with a page of its own, and its bodies.


NOTE = (
    "Errors are RMS values on the held-out part. Each joint is treated as one drive, with the loads from the"
    " other joints as inputs; its own page shows what is missing. The header of its emitted model says which"
    " values of the emitted arm's bearing_loads are its inputs."
)


def _emitted(found: ArmDiagnosis) -> str:
    """What is emitted of the arm as a whole, for the note."""
    if why := why_not_emitted(found):
        return f"The arm as a whole is not emitted: {why}."
    name = arm_name(found)
    return f"The arm with the friction of all joints as fitted is emitted next to this page as {name}."


def arm_view(found: ArmDiagnosis) -> dict[str, Any]:
    """The variables of the template."""
    joints = [
        {
            "href": f"joint_{joint.number}/report.html",
            "name": f"{joint.number} {joint.name}",
            "verdict": verdict_words(joint.verdict, joint.fits_the_rig),
            "effects": ", ".join(effect.id for effect, _ in joint.found.effects) or "-",
            **{model: number(error) for model, error in joint.found.score.rmse["mechanical"].items()},
            "noise": number(joint.found.noise_floor),
            "unit": joint.found.unit,
        }
        for joint in found.joints
    ]
    sums, bodies = [], ""
    if (identified := found.bodies) is not None:
        bodies = (
            "Identified from all joints at once; the values are physically realizable."
            if identified.bodies.explain
            else "Identified from all joints at once; the values are not physically realizable."
        )
        sums = [
            {"words": words, "value": number(e.value), "interval": range_of(e.interval), "unit": e.unit}
            for words, e in zip(identified.sums, identified.estimates.values(), strict=True)
        ]
    return {
        "title": f"What is the arm's model missing? {', '.join(found.names)}",
        "verdict": found.verdict,
        "verdict_words": VERDICTS[found.verdict],
        "sentence": arm_diagnosis_sentence(found),
        "note": f"{NOTE} {_emitted(found)}",
        "joints": joints,
        "bodies": bodies,
        "sums": sums,
        "warnings": list(found.warnings),
    }
