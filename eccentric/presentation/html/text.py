"""Numbers as text, and the sentences of the report."""

from __future__ import annotations

import re
from collections.abc import Sequence
from html import escape

import numpy as np

from eccentric.diagnosis import LEAST_DEVIANCE, LEAST_SHARE
from eccentric.model import AxisKind
from eccentric.presentation.html.arrays import BalanceResiduals, RunErrors, runs_apart
from eccentric.presentation.html.data import CandidateRow, Correlations, ReportData
from eccentric.presentation.html.formulas import short_formula
from eccentric.presentation.html.panels import Panel, Trace

_MODELS = {"linear": "Coulomb + viscous", "paper": "paper's model", "extended": "extended model"}
_CURVES = _MODELS | {"before": _MODELS["paper"], "after": _MODELS["extended"], "effect": "fitted effect"}
_HEADLINES = {
    "named": "An effect is missing",
    "not_identifiable": "An effect is missing; this log does not decide which",
    "unexplained": "Something is missing that no known effect explains",
    "nothing_missing": "Nothing is missing, as far as this log can show",
}
_EACH = (
    "Each effect found is compared with what could take its place, so the probabilities of several do not add"
    " up to 1."
)
_WINDOWS = (
    "These errors are of smoothed windows, each predicted by a fit to the others: do not compare them with"
    " held-out errors."
)
MOST_NAMED = 3
"""Tied effects in a headline: more are a list, which follows below it."""
CLOSE = 0.9
"""Correlation from which two estimates are named: their own errors are then more than twice those of their
combination."""
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value: float, digits: int = 4) -> str:
    """A number with this many significant digits, a true minus sign, and powers of ten as superscripts."""
    text = f"{value:.{digits}g}"
    mantissa, e, exponent = text.partition("e")
    power = f" × 10{str(int(exponent)).translate(_SUPERSCRIPT)}" if e else ""
    return mantissa.replace("-", "−") + power


def headline(data: ReportData) -> str:
    """The answer in a few words, for the top of the page."""
    named = [effect.headline or effect.id for effect in data.extended.effects]
    if data.conclusion.verdict == "named" and named:
        last = f" and {named[-1]}" if len(named) > 1 else named[-1]
        return f"Missing: {', '.join(named[:-1])}{last}"
    tied = {
        c.family: c.headline or c.id for c in reversed(data.search.candidates) if c.family in data.search.tied
    }
    if data.conclusion.verdict == "not_identifiable" and 1 < len(tied) <= MOST_NAMED:
        either = " or ".join(reversed(tied.values()))
        return f"Missing: {', and '.join([*data.conclusion.clear, either])}"
    if data.conclusion.verdict != "named" and not data.conclusion.fits_the_rig:
        return "This log does not fit the rig"
    if not data.conclusion.confirmed:
        return "Something is missing, but the effect that fits is not confirmed"
    return _HEADLINES[data.conclusion.verdict]


def run_name(name: str) -> str:
    """A run as it is called in a sentence; a number from a column alone would not be read as one."""
    return f"run {name}" if name.replace(".", "", 1).isdigit() else name


def runs_words(runs: Sequence[RunErrors]) -> str:
    """That the runs disagree, and what to do; "" if one model suits them all."""
    apart = runs_apart(list(runs))
    if apart is None:
        return ""
    least, most = (f"{run.level[0]:.3g} times in {run_name(run.name)}" for run in apart if run.level)
    return (
        f"The runs disagree: the friction is {least} and {most} that of the model fitted to all runs."
        " No single model suits both: diagnose them separately, or log what changed between them."
    )


def correlation_words(found: Correlations) -> str:
    """The pair that is closest to one combination, if any is close; "" otherwise."""
    size = np.abs(np.tril(np.nan_to_num(found.matrix), -1))
    k, j = np.unravel_index(int(np.argmax(size)), size.shape)
    if size[k, j] < CLOSE:
        return ""
    return (
        f"{found.names[j]} and {found.names[k]} are the most strongly correlated: the log determines a"
        " combination of the two better than either."
    )


def curve_name(curve: str, axis: AxisKind) -> str:
    """The name of a model or a curve in a legend; the residual before is that of the paper's model."""
    return axis.term(_CURVES.get(curve, curve))


def range_of(interval: tuple[float, float], digits: int = 4) -> str:
    """An interval in words."""
    return f"{number(interval[0], digits)} to {number(interval[1], digits)}"


def plain_words(name: str) -> str:
    """A key such as link_angle as words."""
    return name.replace("_", " ")


def unit_text(unit: str) -> str:
    """A unit with superscripts: kg m^2 is kg m²; that of a pure number is empty."""
    shown = "" if unit == "1" else unit.replace("Ohm", "Ω")
    return re.sub(r"\^(-?\d+)", lambda found: found[1].translate(_SUPERSCRIPT), shown)


def meaning_html(meaning: str) -> str:
    """HTML of the meaning of a parameter, its letters typeset; an article would be taken for a letter."""
    article = {"a", "A"} & set(meaning.split())
    return escape(meaning) if article else short_formula(meaning)


def figure_words(panel: Panel, unit: str, axis: AxisKind) -> tuple[str, str]:
    """Caption and text alternative of a panel, by its numbers."""
    label, curves, plain = panel.channel.label, panel.curves, axis.term("the paper's model")
    times = f" × sgn {axis.term('ω')}" if panel.against_motion else ""
    if "before" in curves:
        before = f"{number(curves['before'].swing, 3)} {unit}"
        swing = f"Plotted against the {label}, the mean residual{times} varies by {before}"
        if "after" in curves:
            swing += f" with {plain} and by {number(curves['after'].swing, 3)} {unit} with the extended one"
        what = "Residual" if "after" in curves else f"Residual of {plain}"
    else:
        middle = curves["measured"].middle
        missed = {
            name: float(np.nanmax(np.abs(curves[name].middle - middle)))
            for name in ("paper", "extended")
            if name in curves
        }
        parts = [f"{number(value, 3)} {unit} ({curve_name(name, axis)})" for name, value in missed.items()]
        means = f"the predicted means{times} are off by at most {' and '.join(parts)}"
        swing = f"Plotted against the {label}, {means}"
        what = "Measured and predicted friction"
    rows = panel.rows[panel.rows > 0]
    stands = "one row per point" if rows.max() == 1 else f"{rows.min()}–{rows.max()} rows per point"
    if panel.left_out:
        stands += f", {panel.left_out} rows in sparse bins not drawn"
    at = panel.at[np.isfinite(panel.at)]
    extent = f"from {number(float(at[0]), 3)} to {number(float(at[-1]), 3)} {panel.channel.unit}"
    return f"{swing}; {stands}.", f"{what} over the {label} {extent}. {swing}."


def trace_words(found: Trace, balance: BalanceResiduals, axis: AxisKind) -> tuple[str, str]:
    """Caption and text alternative of the time traces."""
    stands = (
        "every row is drawn"
        if found.rows_per_point == 1
        else f"a point is the mean of up to {found.rows_per_point} consecutive rows, the shaded band their"
        " minimum and maximum"
    )
    cuts = " Dotted lines mark gaps between the rows." if len(found.cuts) else ""
    errors = ", ".join(
        f"{curve_name(name, axis)} {number(value, 3)} {balance.unit}" for name, value in balance.rmse.items()
    )
    caption = f"The {found.rows} held-out rows; {stands}.{cuts}"
    return caption, f"Measured and predicted {balance.quantity} along time. Held-out RMSE: {errors}."


def why(data: ReportData) -> list[str]:
    """Why the runner-up lost, or why nothing won; a sentence for each balance that was searched."""
    units = {balance.name: balance.unit for balance in data.errors.balances}
    sentences = []
    for name in dict.fromkeys(c.balance for c in data.search.candidates):
        own = [c for c in data.search.candidates if c.balance == name]
        winners, others = [c for c in own if c.adopted], [c for c in own if not c.adopted]
        if winners and data.conclusion.verdict in {"named", "not_identifiable"}:
            tied = [c for c in own if c.family in data.search.tied]
            # Every effect has rivals of its own.
            beaten = [c for c in winners if others and c.family == others[0].instead_of]
            pair = (tied or [(beaten or winners)[0], *others])[:2]
            if len(pair) == 2:
                sentences.append(_against(pair[0], pair[1], units.get(name, ""), bool(tied)))
        elif name in data.search.chance:
            torque = data.source.axis.term("torque")
            sentences.append(_chance(own[0], data.search.chance[name], data.conclusion.verdict, torque))
    if (
        data.conclusion.verdict in {"named", "not_identifiable"}
        and sum(c.adopted for c in data.search.candidates) > 1
    ):
        sentences.append(_EACH)
    return sentences


def _against(winner: CandidateRow, runner: CandidateRow, unit: str, tied: bool) -> str:
    times = runner.rmse / winner.rmse if winner.rmse else 1.0
    error, least = f"{number(runner.rmse)} {unit}", f"{number(winner.rmse)} {unit}"
    if tied:
        chances = f"probabilities {winner.probability:.2f} and {runner.probability:.2f}"
        return (
            f"Undecided between {winner.called} and {runner.called}: they leave errors of {least} and {error}"
            f" ({chances}). {_WINDOWS}"
        )
    return (
        f"Why the runner-up lost: {runner.called} leaves an error of {error}, {number(times, 3)} times the"
        f" {least} of {winner.called} (probability {runner.probability:.2f} against"
        f" {winner.probability:.2f}). {_WINDOWS}"
    )


def _chance(best: CandidateRow, chance: tuple[float, float], verdict: str, torque: str) -> str:
    gained, level = chance
    sentence = (
        f"The best candidate of the {best.balance} balance is {best.called}; it lowers the"
        f" deviance by {number(gained, 3)}"
    )
    if gained <= level:
        return f"{sentence}. One log in a hundred reaches {number(level, 3)} by chance: this may be chance."
    if verdict == "unexplained":
        return (
            f"{sentence}, more than the {number(level, 3)} that one log in a hundred reaches by chance."
            " Its residual still depends on a variable: its shape is not right, or more is missing."
        )
    if gained <= LEAST_DEVIANCE:
        return (
            f"{sentence}, but {LEAST_DEVIANCE:g} is required. Chance alone reaches {number(level, 3)} in one"
            " log in a hundred; the margin allows for filter and sampling errors."
        )
    return (
        f"{sentence}, more than chance ({number(level, 3)} in one log in a hundred), but removes less than"
        f" {100.0 * LEAST_SHARE:g} % of the RMS {torque}, which is the size of"
        " filter and sampling errors."
    )
