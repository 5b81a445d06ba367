"""The models after the search: fitted on their own emitted modules, then checked on the held-out part."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from scipy.special import ndtri

from eccentric.core import InputError
from eccentric.diagnosis.limits import FITTED, MOST_APART, OF_THE_MOTION, ONE_WAY
from eccentric.diagnosis.score import BelowLowPass, Score, below_low_pass, leave_runs_out, score
from eccentric.diagnosis.search import Attribution, NextMeasurement, unconfirmed
from eccentric.effects import LOAD, Effect, Plausible
from eccentric.identification import (
    LEAST_R_SQUARED,
    FitData,
    Refit,
    fit_data_of,
    improvement,
    in_drive_unit,
    loaded_model,
    r_squared,
    refit,
    rms,
)
from eccentric.model import Model, Parts, load_model, model_names
from eccentric.signals import LEAST_HELD_OUT


@dataclass(frozen=True)
class Models:
    """What was fitted on the training part."""

    linear: Refit  # Coulomb and viscous friction
    paper: Refit  # the paper's model
    paper_unbounded: Refit  # the same with coefficients that may become negative
    extended: Refit  # with the adopted effects, `paper` itself without any

    @property
    def base(self) -> Model:
        """The paper's model."""
        return self.paper.model

    @property
    def adopted(self) -> bool:
        """Whether an effect was adopted, named or not."""
        return self.extended is not self.paper

    @property
    def r_squared(self) -> float:
        """R^2 of the drive torque on the held-out rows, of the paper's model.

        Without bounds, negative friction and inertia would follow a drive of the wrong sign.
        """
        return _r_squared(self.paper)

    @property
    def structured(self) -> bool:
        """Whether ripple or friction over the speed, which was adopted, is most of what the drive does.

        A log that contradicts its rig is not: such effects can be an image of a wrong unit or sign.
        """
        findings = self.paper.data.drive.channels.intake.findings
        if not self.adopted or any(finding.doubts_the_rig for finding in findings):
            return False
        of_the_motion = all(
            effect.evidence.depends_on[0] in OF_THE_MOTION for effect, _ in self.extended.effects
        )
        return of_the_motion and _r_squared(self.extended) >= LEAST_R_SQUARED

    @property
    def fits_the_rig(self) -> bool:
        """Whether the log can be from this rig, in these units."""
        return not self.misfit

    @property
    def misfit(self) -> str:
        """Why the log cannot be from this rig, "" if it can."""
        if self.r_squared < LEAST_R_SQUARED and not self.structured:
            axis = self.paper.data.drive.channels.rig.axis
            return f"R^2 of the drive {axis.term('torque')} {self.r_squared:.2f}"
        fitted, rows = self.paper, self.paper.data.rows
        if "electrical" not in fitted.residuals:
            return ""
        # Of an efficient motor most of the voltage is the back-EMF, by far.
        drive, speed = fitted.data.drive, fitted.data.drive.channels.motion.omega_m
        parts = drive.torque(fitted.values, fitted.scale), drive.machine.damping(fitted.values) * speed
        apart = fitted.held_out("electrical") / max(rms(rows.mean(part)[rows.score]) for part in parts)
        return f"the voltage is {apart:,.0f} times what R i + k_e w says" if apart > MOST_APART else ""

    @property
    def unsettled(self) -> tuple[str, ...]:
        """Models whose fit was stopped before it had converged."""
        return tuple(name for name, fit in vars(self).items() if not fit.settled)


def _r_squared(fitted: Refit) -> float:
    rows = fitted.data.rows
    drive = rows.mean(fitted.data.drive.driven_by(fitted.values, fitted.scale))
    return r_squared(fitted.residuals["mechanical"][rows.score], drive[rows.score])


def fitted_models(
    found: Attribution, offered: Sequence[Effect], base: Model, data: FitData, tell: Callable[[str], None]
) -> tuple[Attribution, Models, Score, Score | None]:
    """Fit the models and open the held-out part.

    Effects that it does not confirm lose their name: the attribution then says so, the models omit them, and
    their score is the last result. `tell` is called with one line per stage.
    """
    tell("refitting on the emitted module")
    by_id = {effect.id: effect for effect in offered}
    adopted = tuple((by_id[a.variant.candidate.id], dict(a.variant.values)) for a in found.adopted)
    if found.verdict in {"unexplained", "nothing_missing"}:
        adopted = ()
    paper = refit(base, (), data)
    unbounded = refit(base, (), data, bounds=False)
    extended = refit(base, adopted, data) if adopted else paper
    linear = refit(base, (), data, linear=True)
    models = Models(linear, paper, unbounded, extended)
    if models.misfit:
        doubts = (f.mend for f in data.drive.channels.intake.findings if f.doubts_the_rig and f.mend)
        correct = NextMeasurement("correct", mends=tuple(doubts))
        found = replace(unconfirmed(found), next_measurement=correct)
        models = replace(models, extended=paper)
    balance = found.adopted[0].balance if models.adopted else "mechanical"
    scored = _scored(models, balance, data)
    refused = None
    # Voltage and current show an effect twice: the held-out part must not contradict it. With one signal
    # alone, that part is the only check: an effect has to predict it better than the paper's model does at
    # its best, its coefficients free to imitate what it lacks.
    against = _against(models, scored, data) if models.adopted else None
    if against is not None:
        tell("the held-out part does not confirm it")
        refused, found, models = against, unconfirmed(found), replace(models, extended=paper)
        scored = _scored(models, "mechanical", data)
    # Of a tie of effects under load, an open torque constant may settle it.
    following = constant_first(found.next_measurement, found.tied, offered, data)
    found, channels = replace(found, next_measurement=following), data.drive.channels
    moving = channels.motion.omega_m[channels.selection.moving]
    return _with_both_directions_first(found, moving), models, scored, refused


def _with_both_directions_first(found: Attribution, speed: NDArray[np.float64]) -> Attribution:
    """A tie on a log of one direction: with the other, friction changes its sign and other torques do not."""
    following = found.next_measurement
    least = min(np.mean(speed > 0.0), np.mean(speed < 0.0))
    if following is None or following.code != "separate" or least > ONE_WAY:
        return found
    return replace(found, next_measurement=replace(following, one_way=True))


def constant_first(
    found: NextMeasurement | None, tied: Sequence[str], offered: Sequence[Effect], data: FitData
) -> NextMeasurement | None:
    """The measurement for tied families, with whether an open torque constant is to be given before it."""
    under_load = {effect.family for effect in offered if effect.words.kin is LOAD}
    is_open = data.drive.scale is not None and not data.drive.by_voltage
    if found is None or not tied or not is_open or not under_load.issuperset(tied):
        return found
    return replace(found, constant_first=True)


def _scored(models: Models, balance: str, data: FitData) -> Score:
    over_runs = leave_runs_out(models.base, models.extended, data)
    return score(models.linear, models.paper, models.extended, balance, over_runs)


def _against(models: Models, scored: Score, data: FitData) -> Score | None:
    """The score of the held-out part if it does not confirm what was adopted, else None."""
    if not data.drive.measured_twice:
        return None if confirms(scored, models, data) else scored
    found = contradiction(models, data)
    return None if found is None else replace(scored, balance=found[0], percent=found[1], interval=found[2])


def contradiction(models: Models, data: FitData) -> tuple[str, float, tuple[float, float]] | None:
    """The balance that the extended model predicts clearly worse than the paper's, and its gain in percent.

    Below the low pass of the angle: row by row, the model of a ripple above it only adds error. Without the
    rows where the motion cannot show a ripple that the circuit shows.
    """
    fits, shown = (models.paper, models.extended), ~models.extended.unresolved_rows
    for balance in models.paper.residuals:
        scored = data.rows.score & shown if balance == "mechanical" else data.rows.score
        if np.count_nonzero(scored) < LEAST_HELD_OUT:
            continue
        paper, extended = (m.residual_like(models.paper, balance, smooth=True)[scored] for m in fits)
        if np.array_equal(paper, extended):
            continue
        percent, interval = improvement(paper, extended)
        if interval[1] < 0.0:
            return balance, percent, interval
    return None


def confirms(scored: Score, models: Models, data: FitData) -> bool:
    """Whether the extended model predicts better than the paper's without bounds; `scored` is with them."""
    if not any(estimate.bound_active for estimate in models.paper.estimates.values()):
        return scored.confirms
    over_runs = leave_runs_out(models.base, models.extended, data, bounds=False)
    return score(models.linear, models.paper_unbounded, models.extended, scored.balance, over_runs).confirms


@dataclass(frozen=True)
class Sibling:
    """A shipped model that predicts the held-out part better."""

    name: str
    rmse: float  # of its mechanical balance in the unit of the extended model's
    percent: float  # less error than the model that was found
    interval: tuple[float, float]  # 95 % of that


def better_sibling(plain: Model, models: Models) -> Sibling | None:
    """The best of them, fitted on the same rows with the same drive; None if none is surely better.

    `plain` is the base model without the rig's load. A model of one's own has no siblings.
    """
    if not models.fits_the_rig or plain.extensions or plain.name not in model_names():
        return None
    data, found, better = models.paper.data, models.extended, []
    rows, rig = data.rows.score & ~found.unresolved_rows, data.drive.channels.rig
    if np.count_nonzero(rows) < LEAST_HELD_OUT:
        return None
    before = found.residuals["mechanical"][rows]
    # Row by row, a ripple that was found above the low pass of the angle only adds error.
    smooth = found.smooth_residual()[rows]
    for name in model_names():
        model = load_model(name)
        if name == plain.name or _case(model) != _case(plain):
            continue
        model = loaded_model(model, rig)
        own = fit_data_of(data.drive, rig, model)
        try:
            own.require_rank(model, name)
        except InputError:  # Rows of one direction alone may not separate all of its coefficients.
            continue
        fit = refit(model, (), own)
        after = fit.residual_like(found)[rows]
        percent, interval = improvement(before, after)
        below = fit.residual_like(found, smooth=True)[rows]
        if interval[0] > 0.0 and improvement(smooth, below)[1][0] > 0.0:
            better.append(Sibling(name, rms(after), percent, interval))
    return min(better, key=lambda sibling: sibling.rmse, default=None)


def _case(model: Model) -> tuple[bool, bool]:
    """Whether gravity acts in the plane, and whether the plane is tilted: the same for models of one case."""
    return model.balance("mechanical").sum_of("gravity") != 0, model.tilted


@dataclass(frozen=True)
class Closest:
    """The best single effect of the search whose fit settles, and what it gains on the held-out part."""

    effect: Effect
    balance: str  # the one that shows it
    before: float  # held-out RMSE of the paper's model, in the unit of the balance
    after: float  # of the model with this effect
    percent: float  # 100 (1 - after/before)
    interval: tuple[float, float]  # 95 % of that
    below: BelowLowPass | None  # the same below the low pass, as in `Score`


def closest_effect(found: Attribution, offered: Sequence[Effect], models: Models) -> Closest | None:
    """The best effect of the search's first step, fitted; None if effects were adopted or none was found.

    The errors of different balances are not comparable: the effect that takes out the largest part of its
    balance's error is the best. One whose fit does not settle is passed over: what the rig leaves open may
    take its part without end, or up to a bound, where the training part is fitted worse than without it.
    """
    firsts = [search for search in found.searches.values() if search.ranked]
    if models.adopted or not firsts or not models.fits_the_rig:
        return None
    best = min(firsts, key=lambda search: search.ranked[0].score / search.base.score)
    paper, by_id = models.paper, {effect.id: effect for effect in offered}
    tried = ((by_id[f.last.id], dict(f.variants[-1].values)) for f in best.ranked[:FITTED])
    fits = ((effect, refit(models.base, ((effect, values),), paper.data)) for effect, values in tried)
    rows, balance = paper.data.rows, best.screen.balance.name

    def explains(fit: Refit) -> bool:
        before, after = paper.residual_like(fit, balance)[rows.train], fit.residuals[balance][rows.train]
        return fit.settled and rms(after) <= rms(before)

    effect, with_it = next(((effect, fit) for effect, fit in fits if explains(fit)), (None, paper))
    if effect is None:
        return None
    before, after = paper.residual_like(with_it, balance)[rows.score], with_it.residuals[balance][rows.score]
    return Closest(
        effect,
        balance,
        rms(before),
        rms(after),
        *improvement(before, after),
        below_low_pass(paper, with_it, balance),
    )


# Estimates beside what is known from elsewhere: outside such a range, a name is not the whole story.
@dataclass(frozen=True)
class RangeCheck:
    """A figure of an effect beside the known range.

    Attributes:
        effect: id of the effect.
        known: the range, for the parts that the rig has, with its source.
        value, interval: the figure with its 95 % interval, in its unit.
    """

    effect: str
    known: Plausible
    value: float
    interval: tuple[float, float]

    @property
    def outside(self) -> str:
        """Where all of the interval lies: "above" or "below" the range, "" for neither."""
        low, high = self.interval
        return "above" if low > self.known.high else "below" if high < self.known.low else ""


def range_checks(fit: Refit, parts: Parts, unit: str) -> tuple[RangeCheck, ...]:
    """The figures of the effects of a fit that are known from elsewhere and that the log determines.

    A figure is left out where it takes a quantity that the rig does not have, or a torque that is known in
    the `unit` of the drive only.
    """
    return tuple(
        check
        for effect, _ in fit.effects
        for known in (plausible.for_parts(parts) for plausible in effect.plausible)
        if np.isfinite(known.high)
        and all(
            in_drive_unit(q.unit, unit) == q.unit
            for q in effect.parameters
            if q.symbol in known.value.free_symbols
        )
        and (check := _check(effect, known, fit)) is not None
    )


def _check(effect: Effect, known: Plausible, fit: Refit) -> RangeCheck | None:
    letters = sorted(known.value.free_symbols, key=lambda letter: letter.name)
    if not {letter.name for letter in letters} <= set(fit.values):
        return None
    at: dict[sp.Basic, float] = {letter: fit.values[letter.name] for letter in letters}
    value = _number(known.value, at)
    own = [letter for letter in letters if letter.name in fit.estimates]
    if not own:
        return None
    interval = _of_one(known, own[0], at, fit) if len(own) == 1 else _of_several(known, own, at, fit)
    if not all(map(np.isfinite, (value, *interval))):
        return None
    return RangeCheck(effect.id, known, value, interval)


def _of_one(
    known: Plausible, letter: sp.Basic, at: Mapping[sp.Basic, float], fit: Refit
) -> tuple[float, float]:
    """The ends of the interval of one parameter, carried over: figures rise or fall with it."""
    ends = fit.estimates[str(letter)].interval
    if not all(map(np.isfinite, ends)):
        return np.nan, np.nan
    low, high = sorted(_number(known.value, {**at, letter: end}) for end in ends)
    return low, high


def _of_several(
    known: Plausible, own: list[sp.Basic], at: Mapping[sp.Basic, float], fit: Refit
) -> tuple[float, float]:
    """The interval by the slopes of the figure and the covariance of its parameters."""
    value, names = _number(known.value, at), list(fit.estimates)
    places = [names.index(str(letter)) for letter in own]
    slope = np.array([_number(sp.diff(known.value, letter), at) for letter in own])
    spread = ndtri(0.975) * np.sqrt(slope @ fit.covariance[np.ix_(places, places)] @ slope)
    return value - spread, value + spread


def _number(expression: sp.Expr, at: Mapping[sp.Basic, float]) -> float:
    """The value of an expression; NaN where it has none, such as a part of friction that is 0."""
    value = expression.subs(at)
    return float(value) if value.is_finite else np.nan
