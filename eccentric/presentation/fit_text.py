"""A fit in words: one sentence on what the model gains, and a few lines for a terminal."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eccentric.core import few
from eccentric.emission import LevelCut
from eccentric.identification import DRIVE_UNITS, LEAST_GAIN_PERCENT, MOST_POINTS, Estimate, Fit
from eccentric.model import AxisKind, model_names
from eccentric.rigs import Rig
from eccentric.signals import Band

_DRIVES = {unit: drive for drive, unit in DRIVE_UNITS.items()}


_BASELINE = "Coulomb + viscous"
_SHOWN_PERCENT = 0.05
"""What is smaller is 0.0 % with one digit, and neither better nor worse."""
_MOST_INTERVALS = 4
_OF_A_LINK = ', mu, and the zero angle (theta_zero_rad = "estimate" estimates it)'


def _of_the_link(rig: Rig) -> str:
    """What else to check where a log does not fit: no angle in a level plane, and no mu without a mass."""
    if rig.case != "C1":
        return rig.axis.term(_OF_A_LINK)
    return "" if 0.0 in (rig.known.get("M"), rig.known.get("L")) else ", and mu"


def fit_sentence(fit: Fit) -> str:
    """Return one sentence on the gain of the model over Coulomb + viscous friction on the held-out part.

    If the log does not fit the rig at all, the sentence says that instead.
    """
    axis = fit.problem.rig.axis
    if not fit.fits_the_rig:
        return (
            f"This log does not fit the rig (R^2 {fit.r_squared['paper']:.2f}): check units and signs of the "
            f"columns{_of_the_link(fit.problem.rig)}."
        )
    if fit.problem.is_baseline:
        part = 100.0 * (1.0 - fit.r_squared["paper"])
        whole = "deceleration" if fit.problem.drive.channels.motor.coasting else "drive"
        return f"The model, Coulomb + viscous friction, leaves {part:.2g} % of the {whole}'s variance."
    own = axis.term("paper's model")
    subject = f"The model {called}" if (called := _called(fit)) != "paper" else f"The {own}"
    low, high = fit.percent_interval
    gain, interval = _percent(fit.percent), f"95 % interval {_percent(low)} to {_percent(high)} %"
    of_loss = f"95 % interval {_percent(-high)} to {_percent(-low)} %"
    if low > 0.0 and fit.percent >= LEAST_GAIN_PERCENT:
        return f"{subject} has {gain} % lower held-out error than Coulomb + viscous friction ({interval})."
    if high < 0.0 and fit.percent <= -LEAST_GAIN_PERCENT:
        return (
            f"{subject} has {_percent(-fit.percent)} % higher held-out error than "
            f"Coulomb + viscous friction ({of_loss})."
        )
    if abs(fit.percent) >= LEAST_GAIN_PERCENT:
        return (
            f"{subject} has no clear gain over Coulomb + viscous friction in held-out error "
            f"({gain} %, {interval})."
        )
    if (low > 0.0 or high < 0.0) and abs(fit.percent) >= _SHOWN_PERCENT:
        which, interval = ("lower", interval) if low > 0.0 else ("higher", of_loss)
        return (
            f"{subject} has only slightly {which} held-out error than "
            f"Coulomb + viscous friction ({_percent(abs(fit.percent))} %; {interval})."
        )
    same = "about the same held-out error as Coulomb + viscous friction"
    return f"{subject} has {same} (gain {gain} %, {interval})."


def _called(fit: Fit) -> str:
    """Return "paper" for the bundled models, else the model's own name.

    A bundled model without an unbalanced mass is Coulomb + viscous friction.
    """
    name = fit.problem.model.name
    bundled = _BASELINE if fit.problem.is_baseline else "paper"
    return bundled if name in model_names() else name


def _percent(x: float) -> str:
    return f"{round(x, 1) + 0.0:.1f}"  # + 0.0 takes the sign from a zero


def fit_lines(fit: Fit, logs: Sequence[str]) -> list[str]:
    """Return the fit for a terminal."""
    problem, channels = fit.problem, fit.problem.drive.channels
    rows, axis = problem.rows, problem.rig.axis
    what = f"{np.count_nonzero(rows.train)} {rows.description} fitted"
    by = "coasting down" if channels.motor.coasting else f"driven by {axis.named(channels.motor.measured_by)}"
    head = f"{few(logs)}: {problem.model.name}, {by}; {what}, "
    head += f"{np.count_nonzero(rows.score)} held out ({channels.selection.holdout.brief})"
    above = [head, *filter(None, (channels.excerpt, problem.rig.added_words, inertia_words(problem.rig)))]
    table = estimate_table(axis.estimates({**fit.coefficients, **fit.searched}))
    out = _scale_line(fit, axis)
    own = _called(fit)
    shown = {"paper": own} if problem.is_baseline else {"linear": "linear", "paper": own}
    explained = shown | ({} if problem.is_baseline else {"linear": f"linear ({_BASELINE})"})
    errors = ", ".join(f"{name} {fit.rmse[which]:.4g}" for which, name in explained.items())
    parts = ", ".join(f"{name} {fit.r_squared[which]:.4f}" for which, name in shown.items())
    unit = axis.unit(problem.unit)
    drive = "deceleration" if channels.motor.coasting else f"drive {axis.term(_DRIVES[problem.unit])}"
    out.append(f"held-out RMSE [{unit}]: {errors}; R^2 of the {drive}: {parts}")
    out += _cubic_lines(fit)
    if fit.band is not None:
        out.append(band_line(fit.band, unit, shown["paper"]))
    if problem.rig.sampling.moving_threshold_rad_s is None:
        threshold = channels.selection.moving_threshold_rad_s
        key = axis.named("moving_threshold_rad_s")
        out.append(f"rows count as moving above {threshold:.4g} {axis.unit('rad/s')} (default of {key})")
    if fit.fits_the_rig:
        out += _bounds_line(fit, axis)
        out += _undetected_lines(fit)
    return [*above, *table, *out, fit_sentence(fit)]


def inertia_words(rig: Rig) -> str:
    """What a coast-down without an inertia is fitted in; "" for all others."""
    if not rig.per_inertia:
        return ""
    inertia, one = rig.axis.term("inertia"), rig.axis.unit("kg m^2")
    return f"no {inertia} is declared: torques are divided by it, in rad/s^2; the emitted model uses 1 {one}"


def _undetected_lines(fit: Fit) -> list[str]:
    """Upper bounds of friction by F_N that the log does not show, and whether it could have."""
    whose = "the paper's Table 1 has" if _called(fit) == "paper" else "the model's own value is"
    out = []
    for name, one in fit.undetected.items():
        line = f"{name} is not detected: at most {one.upper:.3g} {one.unit} (95 %)"
        line += _because(name, fit.coefficients)
        if one.z is not None:
            line += (
                f"; {whose} {one.reference:g} {one.unit}, which would be {float(f'{one.z:.2g}'):g} standard"
                " errors from zero in this log with all coefficients free"
            )
        out.append(line)
    return out


def cut_sentences(cuts: Sequence[LevelCut], axis: AxisKind) -> tuple[str, ...]:
    """Where levels of dry friction are cut at 0, and how far below they would be."""
    place, unit = ("link angles" if axis.wraps else axis.term("motor angles")), axis.unit("rad")
    found = []
    for cut in cuts:
        way = "" if len(cut.directions) > 1 else " forwards" if 1 in cut.directions else " backwards"
        ends = ", ".join(f"{low:.4g} to {high:.4g}" for low, high in cut.intervals[:_MOST_INTERVALS])
        more = len(cut.intervals) - _MOST_INTERVALS
        ends += f" {unit}" + (f" and {more} more intervals" if more > 0 else "")
        speed = f"at {cut.speed:.4g} {axis.unit('rad/s')}" if cut.speed else "at rest"
        found.append(
            f"the fitted dry friction{way} would be negative at {place} {ends}, down to {cut.lowest:.3g}"
            f" {axis.unit('N m')} {speed}: friction_budget and friction_step limit it to 0 there"
        )
    return tuple(found)


def _because(name: str, estimates: Mapping[str, Estimate]) -> str:
    """Why a value of several standard errors has an interval down to 0: another one is at its bound."""
    own = estimates.get(name)
    if own is None or own.bound_active or not own.widened:
        return ""
    others = [other for other, e in estimates.items() if e.bound_active]
    return f", since {' and '.join(others)} at a bound may take its place" if others else ""


def _cubic_lines(fit: Fit) -> list[str]:
    """The free cubic of a coast-down, and what no coast-down separates."""
    if not fit.cubic:
        return []
    shown = ", ".join(
        f"{name} = {e.value:.4g} ({e.interval[0]:.4g} to {e.interval[1]:.4g}) {e.unit}"
        for name, e in fit.cubic.items()
    )
    return [
        f"free cubic c_0 + c_1 |w| + c_2 w^2 + c_3 |w|^3, 95 % intervals: {shown}",
        "a coast-down does not separate air drag (w^2, w^3) from friction under a load that grows with w^2",
    ]


def band_line(band: Band, unit: str, model: str) -> str:
    """The held-out error of a model below the low pass of the angle."""
    return f"below {band.cut_hz:g} Hz: {model} {band.below:.4g} {unit}"


def estimate_table(shown: Mapping[str, Estimate]) -> list[str]:
    """Return estimates by name as lines of a table, each with standard error, interval and unit."""
    table = [("", "value", "std error", "95 % interval", "unit")]
    table += [
        (name, f"{e.value:.4g}", _error(e), _interval(e), e.unit + _bound(e)) for name, e in shown.items()
    ]
    lines = [f"  {line}" for line in aligned(table, left=(0, 4))]
    widened = [name for name, e in shown.items() if e.widened and not e.bound_active]
    return [*lines, f"  interval widened by a bound: {', '.join(widened)}"] if widened else lines


def aligned(rows: Sequence[Sequence[str]], left: Collection[int] = (0,)) -> list[str]:
    """Return the rows of a table, its columns aligned: those in `left` to the left, others to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    cells = (
        [x.ljust(w) if k in left else x.rjust(w) for k, (x, w) in enumerate(zip(row, widths, strict=True))]
        for row in rows
    )
    return ["  ".join(row).rstrip() for row in cells]


def _scale_line(fit: Fit, axis: AxisKind) -> list[str]:
    problem = fit.problem
    if problem.has("scale"):
        names = [name for name in fit.combinations if name not in fit.coefficients]
        found = axis.estimates({name: fit.combinations[name] for name in names})
        combined = ", ".join(f"{name} = {e.value:.4g} {e.unit}" for name, e in found.items())
        ((name, one),) = axis.estimates(
            {c.name: fit.coefficients[c.name] for c in problem.coefficients if c.role == "scale"}
        ).items()
        scale = f"{name} = {one.value:.4g} {one.unit}"
        if problem.unit == "A":
            scale = f"{axis.named('k_i')} = {1.0 / one.value:.4g} {axis.unit('N m/A')}"
        return [f"with {scale}, in SI units: {combined}"]
    if problem.scale is not None:
        unit, inertia = axis.term("newton metres"), axis.term("inertia")
        scale = axis.named(str(problem.scale))
        why = f"no scale to {unit} (no {inertia}, gravity or load is known)"
        return [f"{why}: all values are multiplied by {scale}"]
    return []


def _interval(e: Estimate) -> str:
    return f"{e.interval[0]:.4g} to {e.interval[1]:.4g}"


def _error(e: Estimate) -> str:
    return f"{e.std_error:.2g}" if math.isfinite(e.std_error) else "-"


def _bound(e: Estimate) -> str:
    return f"  ({e.bound_active} bound active)" if e.bound_active else ""


def _bounds_line(fit: Fit, axis: AxisKind) -> list[str]:
    free, held = fit.rmse["paper_unbounded"], fit.rmse["paper"]
    if not fit.bounds_active:
        return []
    gain = 100.0 * (1.0 - free / held)
    at, stays = ("its bound", "it stays") if len(fit.bounds_active) == 1 else ("their bounds", "they stay")
    out = [f"{axis.named(', '.join(fit.bounds_active))}: at {at}"]
    if any(e.widened for e in fit.coefficients.values()):
        out[0] += f"; the standard errors assume that {stays} there, the intervals do not"
    if gain <= 0.0:
        return out
    text = f"without bounds the held-out RMSE is {free:.4g} {axis.unit(fit.problem.unit)}"
    contradicted = any(f.doubts_the_rig for f in fit.problem.drive.channels.intake.findings)
    if gain >= LEAST_GAIN_PERCENT and not contradicted:
        text += f", {gain:.2g} % lower, which suggests a missing effect"
    return [*out, text]


# The figure of a fit: measured against predicted friction, and both over speed, on the held-out rows.


Array = NDArray[np.float64]

NEEDS_MATPLOTLIB = "matplotlib is required for the figure (extra `figures`): pip install matplotlib"
# As in the report of a diagnosis: the colours of Okabe and Ito.
_MEASURED, _LINEAR, _PAPER = "#8a8a8a", "#cc79a7", "#d55e00"


@dataclass(frozen=True)
class Comparison:
    """Measured and predicted friction on held-out rows, at most `MOST_POINTS` of them.

    Attributes:
        speed: of the motor [rad/s], of a carriage [m/s] (n,).
        measured: (n,) in `unit`.
        paper, linear: predicted by the fitted model and by Coulomb + viscous friction, (n,) in `unit`.
        rmse: model ("paper", "linear") -> held-out RMSE in `unit`; "paper" alone where that is linear itself.
        model: what the fitted model is called in a legend.
        quantity: what is compared, for an axis.
        unit: "N m", "V" or "A".
        title: rig, and what a row is.
        velocity: what `speed` is, for an axis.
    """

    speed: Array
    measured: Array
    paper: Array
    linear: Array
    rmse: Mapping[str, float]
    model: str
    quantity: str
    unit: str
    title: str
    velocity: str


def compare(fit: Fit) -> Comparison:
    """Return the data of the figure of a fit."""
    problem = fit.problem
    paper, linear = fit.solutions["paper"], fit.solutions["linear"]
    rows = np.flatnonzero(problem.rows.score)
    rows = rows[:: -(-len(rows) // MOST_POINTS)]
    friction = [k for k, c in enumerate(problem.coefficients) if c.role == "friction"]
    axis, called = problem.rig.axis, _called(fit)
    predicted = paper.design.columns[rows][:, friction] @ paper.values[friction]
    measured = predicted + paper.residual[rows]
    return Comparison(
        speed=problem.rows.mean(problem.drive.channels.motion.omega_m)[rows],
        measured=measured,
        paper=predicted,
        linear=measured - linear.residual[rows],
        rmse={name: fit.rmse[name] for name in ("paper", "linear")[: 1 if problem.is_baseline else 2]},
        model=axis.term("paper's model") if called == "paper" else called,
        quantity="friction (and back-EMF)" if problem.unit == "V" else "friction",
        unit=axis.unit(problem.unit),
        title=f"{problem.rig.name}: held-out {problem.rows.description}",
        velocity=f"{axis.term('motor velocity')} [{axis.unit('rad/s')}]",
    )


def plot_fit(shown: Comparison, left: Any, right: Any = None) -> None:
    """Draw measured against predicted friction on the left axes, both over the speed on the right ones."""
    drawn = [left] if right is None else [left, right]
    name, unit = shown.quantity, shown.unit
    both = np.concatenate([shown.measured, shown.paper, shown.linear])
    ends = [float(both.min()), float(both.max())]
    style = {"linestyle": "none", "marker": ".", "rasterized": True}
    # The linear model is drawn on top, in smaller dots: its few values would be hidden by the paper's.
    models = [(shown.paper, _PAPER, "paper", shown.model, 3.0)]
    if "linear" in shown.rmse:
        models.append((shown.linear, _LINEAR, "linear", _BASELINE, 1.5))
    if right is not None:
        right.plot(shown.speed, shown.measured, color=_MEASURED, label="measured", markersize=3.0, **style)
    for values, color, which, called, size in models:
        label = f"{called}\nRMSE {shown.rmse[which]:.3g} {unit}"
        left.plot(values, shown.measured, color=color, label=label, markersize=size, **style)
        if right is not None:
            right.plot(shown.speed, values, color=color, label=called, markersize=size, **style)
    left.plot(ends, ends, color="black", linewidth=0.8)
    left.set(xlabel=f"predicted {name} [{unit}]", ylabel=f"measured {name} [{unit}]")
    if right is not None:
        right.set(xlabel=shown.velocity, ylabel=f"{name} [{unit}]")
    for axes in drawn:
        axes.grid(linewidth=0.3)
        # Inside: above the axes it would cover a title, or the legend beside it.
        axes.legend(loc="best", handletextpad=0.2, fontsize=8.0)
        for handle in axes.get_legend().legend_handles:
            handle.set_markersize(10.0)
    left.set_title(shown.title, loc="left", fontsize=9.0)
