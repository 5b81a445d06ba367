"""A term without a cause: which variables it follows, how many pieces it has, and its coefficients.

What is fitted is the residual of the model found so far together with that model's friction: splines of one
variable, then of a second beside it, compete by cross-validation over the blocks of the training part, and
the least number of pieces that does about as well as the best is taken. Differences of neighbouring
coefficients, and changes of the friction that the model has already, are penalised a little: what both could
explain stays where it was, so that beyond the data the model goes on as before. The held-out part then has to
confirm it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from eccentric.diagnosis import limits
from eccentric.diagnosis.search import Gram, bounded_solve, bounded_solve_each, sum_of_each
from eccentric.effects import ANGLES, Curve, Effect, Setting, empirical_term, variable_of
from eccentric.identification import FitData, Refit, base_coefficients, compiled, improvement
from eccentric.model import Load, Role

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Empirical:
    """A term without a cause, fitted beside a model.

    Attributes:
        effect: its record.
        curves: its functions, one or two.
        before, fitted: the model without it and with it; friction of the model has moved a little.
        percent, interval: held-out error that it takes out, in percent, with the 95 % interval.
    """

    effect: Effect
    curves: tuple[Curve, ...]
    before: Refit
    fitted: Refit
    percent: float
    interval: tuple[float, float]

    @property
    def variables(self) -> tuple[str, ...]:
        """What it follows."""
        return tuple(dict.fromkeys(curve.variable for curve in self.curves))

    @property
    def rmse(self) -> tuple[float, float]:
        """Held-out RMSE of the mechanical balance, without it and with it."""
        return self.before.held_out("mechanical"), self.fitted.held_out("mechanical")

    @property
    def confirmed(self) -> bool:
        """Whether the held-out part is predicted better."""
        return self.percent > 0.0

    @property
    def coefficients(self) -> dict[str, float]:
        """Its coefficients by name [N m]."""
        return dict(self.fitted.effects[-1][1])


@dataclass(frozen=True)
class _Term:
    """A curve on a log: its columns on the rows (m, k), and whether coefficients are not negative."""

    curve: Curve
    columns: Array

    @property
    def lower(self) -> Array:
        return np.full(self.columns.shape[1], -np.inf if self.curve.conservative else 0.0)

    @cached_property
    def roughness(self) -> Array:
        """The sum of squared differences of neighbouring coefficients, as a matrix (k, k)."""
        width = self.curve.width
        rows = np.diff(np.eye(width), axis=0)
        if self.curve.periodic:
            rows = np.vstack([rows, np.eye(width)[0] - np.eye(width)[-1]])
        each = rows.T @ rows
        return block_diag(*[each] * (self.columns.shape[1] // width))


class _Fit:
    """The residual of a model on the rows of a log, with its friction as columns."""

    def __init__(self, before: Refit, data: FitData, setting: Setting) -> None:
        self.before, self.data, self.setting = before, data, setting
        count = len(data.signals.columns(setting.base))
        own = base_coefficients(setting.base, data.signals)[:count]
        self.names = [c.name for c in own]
        self.roles = [(c.role, c.load) for c in data.signals.columns(setting.base)]
        residuals = data.residuals(before.model, before.shapes, before.values, before.scale)
        self.friction = residuals.design("mechanical", before.values, [(name,) for name in self.names])[1]
        self.start = np.array([before.values[name] for name in self.names])
        # What the bench leaves open besides parameters of the model, such as other bodies, stays as fitted.
        self.outside = before.residuals["mechanical"] - residuals.rows("mechanical", before.values)
        self.target = before.residuals["mechanical"] + self.friction @ self.start
        rows = data.rows
        self.train = rows.train
        self.root = np.sqrt(rows.weights[self.train])
        self.block = np.unique(rows.block[self.train], return_inverse=True)[1]

    def signal(self, variable: str) -> Array:
        own = variable_of(variable, self.setting)
        value = own.expression
        for definition in reversed(own.definitions):
            value = value.xreplace({definition.symbol: definition.value})
        return np.array(compiled(self.before.model, value, self.data.signals)({}, {}))

    def term(self, curve: Curve, signal: Array) -> _Term:
        omega = self.data.signals.values["omega_m"]
        return _Term(curve, self.data.rows.mean(curve.columns(signal, omega)))

    def penalty(self, matrix: Array, terms: Sequence[_Term], stiff: float) -> tuple[Array, Array]:
        """What is added to the normal equations of all blocks."""
        first = len(self.names)
        hold = stiff * np.diag(np.diag(matrix)[:first])
        parts, at = [hold], first
        for term in terms:
            width = term.columns.shape[1]
            own = np.diag(matrix)[at : at + width]
            parts.append(stiff * float(np.sum(own)) / width * term.roughness)
            at += width
        return block_diag(*parts), np.concatenate([hold @ self.start, np.zeros(at - first)])

    def solve(self, terms: Sequence[_Term], stiff: float) -> tuple[Array, Array]:
        """Coefficients (q,) of friction and terms, and the cross-validated loss of every group of blocks."""
        design = np.column_stack([self.friction, *(term.columns for term in terms)])
        weighted = design[self.train] * self.root[:, None]
        gram = Gram.of(weighted, self.target[self.train] * self.root, self.block)
        matrix, vector = gram.matrix.sum(axis=0), gram.vector.sum(axis=0)
        more, pull = self.penalty(matrix, terms, stiff)
        lower = np.concatenate([np.zeros(len(self.names)), *(term.lower for term in terms)])
        found = bounded_solve(matrix + more, vector + pull, lower)
        count = len(gram.square)
        group = np.arange(count) * min(count, limits.EMPIRICAL_GROUPS) // count
        left = matrix - sum_of_each(group, gram.matrix) + more
        right = vector - sum_of_each(group, gram.vector) + pull
        each = bounded_solve_each(left, right, lower)
        return found, sum_of_each(group, gram.loss(each[group]))


@dataclass(frozen=True)
class _Choice:
    terms: tuple[_Term, ...]
    coefficients: Array
    cross: Array

    @property
    def count(self) -> int:
        return sum(term.columns.shape[1] for term in self.terms)

    @property
    def score(self) -> float:
        return float(self.cross.sum())


def variables_followed(data: FitData, setting: Setting) -> tuple[str, ...]:
    """What a term may follow on a log: what it has, and what a drive knows of its own state.

    An angle needs a zero common to all runs; the load on the gear of a joint is what its arm gives it.
    """
    channels, known = data.drive.channels, setting.base
    bodies = known.balance("mechanical").sum_of("bodies") != 0
    turns = channels.phased and known.axis.wraps and not bodies
    offered = {
        "velocity": True,
        "gravity_load": bool(np.any(data.gravity)),
        "transmitted_torque": bodies,
        "link_angle": turns,
        "motor_angle": turns and abs(setting.mu) != 1.0,
        "temperature": channels.temperature is not None,
    }
    return tuple(name for name, there in offered.items() if there)


def fit_empirical(before: Refit, data: FitData, setting: Setting) -> Empirical | None:
    """The term of one or two variables that predicts the blocks of the training part best.

    Args:
        before: the model found so far.
        data: the log.
        setting: what the base model and its ranges are.

    Returns None where none predicts them clearly better than the model without it.
    """
    fit = _Fit(before, data, setting)
    offers = {name: list(_offers(fit, name)) for name in variables_followed(data, setting)}
    plain = fit.solve((), limits.EMPIRICAL_STIFF[0])[1]
    best = None
    for _ in range(2):
        grown = _best(fit, offers, () if best is None else best.terms)
        if grown is None or not _clearly(plain if best is None else best.cross, grown.cross):
            break
        best = grown
    return None if best is None else _made(fit, best)


def _best(fit: _Fit, offers: Mapping[str, Sequence[_Term]], beside: tuple[_Term, ...]) -> _Choice | None:
    taken = {(term.curve.variable, term.curve.conservative) for term in beside}
    tried = []
    for own in offers.values():
        for term in own:
            if (term.curve.variable, term.curve.conservative) in taken:
                continue
            terms = (*beside, term)
            if sum(t.columns.shape[1] for t in terms) > limits.EMPIRICAL_MOST:
                continue
            tried += [_Choice(terms, *fit.solve(terms, stiff)) for stiff in limits.EMPIRICAL_STIFF]
    if not tried:
        return None
    best = min(tried, key=lambda one: one.score)
    near = [one for one in tried if one.score <= (1.0 + limits.EMPIRICAL_WITHIN) * best.score]
    return min(near, key=lambda one: (one.count, one.score))


def _clearly(before: Array, after: Array) -> bool:
    """Whether the losses of groups fall by more than chance would let them, and by what is worth it."""
    gain, chance = before - after, np.sqrt(len(before)) * np.std(before - after, ddof=1)
    return bool(gain.sum() > max(limits.EMPIRICAL_CLEARLY * chance, limits.EMPIRICAL_LEAST * before.sum()))


def _offers(fit: _Fit, name: str) -> Iterator[_Term]:
    signal = fit.signal(name)
    rows = fit.data.rows.plain_mean(signal)[fit.train]
    if name in ANGLES:
        for pieces in limits.EMPIRICAL_TURN:
            for conservative in (False, True):
                yield fit.term(Curve(name, pieces, conservative=conservative), signal)
        return
    low, high = map(float, np.quantile(rows, limits.EMPIRICAL_RANGE))
    if not high - low > limits.EMPIRICAL_NOTHING * max(abs(low), abs(high)):
        return
    bends = (0.0, 0.2 * high) if name == "velocity" else (0.0,)
    ways = (False, True) if name == "velocity" else (False,)
    for pieces in limits.EMPIRICAL_PIECES:
        for bend in bends:
            for each_way in ways:
                yield fit.term(Curve(name, pieces, low, high, bend, each_way), signal)


def _made(fit: _Fit, choice: _Choice) -> Empirical | None:
    """The term as an effect, without the coefficients that are 0, and the model with it."""
    first, before = len(fit.names), fit.before
    friction, at = choice.coefficients[:first].copy(), first
    curves, values = [], []
    # The constant dry friction takes what all coefficients of a curve share.
    dry = [k for k, own in enumerate(fit.roles) if own == (Role.COULOMB, Load.NONE)]
    for term in choice.terms:
        own = choice.coefficients[at : at + term.columns.shape[1]].copy()
        at += len(own)
        if term.curve.conservative:
            own -= own[0]
        elif dry:
            friction[dry] += own.min()
            own -= own.min()
        kept = np.flatnonzero(np.abs(own) > limits.EMPIRICAL_NOTHING * np.max(np.abs(own), initial=0.0))
        if len(kept):
            curves.append(replace(term.curve, kept=tuple(map(int, kept))))
            values += own[kept].tolist()
    if not curves:
        return None
    effect = empirical_term(fit.setting, curves).told_for(fit.data.drive.channels.rig.axis)
    own = dict(zip((q.name for q in effect.coefficients), values, strict=True))
    model = effect.extend(before.model, own)
    moved = dict(zip(fit.names, map(float, friction), strict=True))
    everything = before.values | moved | own
    residuals = fit.data.residuals(model, before.shapes, everything, before.scale)
    after = residuals.rows("mechanical", everything) + fit.outside
    score = fit.data.rows.score
    percent, interval = improvement(before.residuals["mechanical"][score], after[score])
    held = [k for k, name in enumerate(before.estimates) if name not in moved]
    fitted = replace(
        before,
        model=model,
        effects=(*before.effects, (effect, own)),
        values=everything,
        residuals={**before.residuals, "mechanical": after},
        estimates={n: e for n, e in before.estimates.items() if n not in moved},
        covariance=before.covariance[np.ix_(held, held)],
    )
    return Empirical(effect, tuple(curves), before, fitted, percent, interval)
