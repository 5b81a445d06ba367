"""The content of the report: plain numbers, arrays and strings, without fits, models or plots.

This is the interface: `gather.report_data` fills these records from a Diagnosis, and the rest of the report
reads nothing else. Strings may come from logs and rigs; whoever prints them escapes them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.model import TURNING, AxisKind
from eccentric.presentation.html.arrays import BalanceResiduals, Channel
from eccentric.presentation.ranges_text import effect_name
from eccentric.signals import Finding


@dataclass(frozen=True)
class Errors:
    """Errors of the models other than those of the balances.

    Attributes:
        name: what was predicted: "with the motor switched off", "every run left out once".
        unit: of the errors.
        rmse: model ("linear", "paper", "extended") -> RMSE.
        interval: 95 % interval of the extended model's improvement on the paper's, in percent; None if there
            is none.
        note: a remark; "" for none.
        own_scale: whether the bars have a scale of their own, not that of their unit.
    """

    name: str
    unit: str
    rmse: Mapping[str, float]
    interval: tuple[float, float] | None = None
    note: str = ""
    own_scale: bool = False


@dataclass(frozen=True)
class Gain:
    """Reduction of the held-out error of `balance`, in percent, with its 95 % interval."""

    balance: str
    percent: float
    interval: tuple[float, float]


@dataclass(frozen=True)
class CandidateRow:
    """A candidate that was considered on one balance.

    Attributes:
        id, family, balance: as in diagnosis.json.
        rmse: cross-validated RMSE in the unit of its balance.
        probability: among the families in its place.
        adopted: whether it is in the extended model.
        formula: what it would add; "" if unknown.
        aliases: ids that are exactly the same within the base model.
        hint: what to measure to distinguish it from others; "" if unknown.
        headline: a description for a person; "" if unknown.
        instead_of: the family of the adopted effect in whose place it is; "" for none.
    """

    id: str
    family: str
    balance: str
    rmse: float
    probability: float
    adopted: bool
    formula: str = ""
    aliases: tuple[str, ...] = ()
    hint: str = ""
    headline: str = ""
    instead_of: str = ""

    @property
    def called(self) -> str:
        """What it is, its id second."""
        return effect_name(self.headline, self.id)


@dataclass(frozen=True)
class AddedEffect:
    """An effect of the extended model: description, formula, source, how large it is.

    meaning: what it is and where it comes from, one sentence; share: "4.2 % of the friction";
    headline: the same in a few words, or "";
    stability: in how many variants of the log it is found, and what is found instead, or "";
    ranges: a line for each of its figures that is known from elsewhere;
    follows: channels that it may be drawn over.
    """

    id: str
    balance: str
    meaning: str
    formula: str
    reference: str
    share: str
    headline: str = ""
    stability: str = ""
    ranges: tuple[str, ...] = ()
    follows: tuple[Channel, ...] = ()


@dataclass(frozen=True)
class Parameter:
    """A parameter of the extended model.

    Attributes:
        name, meaning, unit, value: as the emitted code has them.
        origin: "effect" (fitted, of an adopted effect), "friction" (fitted), "estimated" (jointly),
            "part" (identified only in combination), "rig" (known beforehand), "model" (its own value) or
            "unseen" (nothing in the log depends on it).
        std_error, interval: None where it was not estimated.
        bound: "lower" or "upper" if that bound is active; "" otherwise.
        widened: whether an active bound widens the interval.
        part_of: the combination that alone is identified; "" for none.
        letter: MathML of its letter in the equations.
    """

    name: str
    meaning: str
    unit: str
    value: float
    origin: str
    std_error: float | None = None
    interval: tuple[float, float] | None = None
    bound: str = ""
    widened: bool = False
    part_of: str = ""
    letter: str = ""


@dataclass(frozen=True)
class Formula:
    """A formula: MathML (made by `formulas`, so it is trusted), and a short description."""

    mathml: str
    note: str


@dataclass(frozen=True)
class Fact:
    """A line of the data-quality table: name, value with unit, and a remark ("" for none)."""

    name: str
    value: str
    remark: str = ""


@dataclass(frozen=True)
class Source:
    """What was diagnosed.

    Attributes:
        logs, rig: file names.
        model, model_title: name and title of the base model.
        command: shell command that repeats the diagnosis.
        version: of eccentric.
        plan: shell command that plans the next measurement; "" where there is none.
        axis: what moves: all texts are in its words.
        occasion: why this log was diagnosed, in a sentence; "" if somebody asked for it.
    """

    logs: tuple[str, ...]
    rig: str
    model: str
    model_title: str
    command: str
    version: str
    plan: str = ""
    axis: AxisKind = TURNING
    occasion: str = ""


@dataclass(frozen=True)
class Conclusion:
    """What the diagnosis says.

    Attributes:
        verdict: named, not_identifiable, unexplained or nothing_missing.
        sentence: the verdict in one sentence.
        depends_on: variables that the residual of the paper's model follows, strongest first.
        closest: the best effect and its gain, where none is adopted, and a model that predicts better;
            "" otherwise.
        next_measurement: one sentence; "" if nothing is open.
        fits_the_rig: whether the log can be from this rig.
        confirmed: whether what fits the training part predicts the held-out part as well.
        clear: what effects are called that nothing else explains, beside a tie.
        calls: how firmware calls the extended model, where an effect is named, as words and code; none
            otherwise.
    """

    verdict: str
    sentence: str
    depends_on: tuple[str, ...]
    closest: str
    next_measurement: str
    fits_the_rig: bool = True
    confirmed: bool = True
    clear: tuple[str, ...] = ()
    calls: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class HeldOutErrors:
    """How well the models predict what they were not fitted on.

    Attributes:
        holdout: the rule of the held-out part, in words.
        balances: the one that the verdict is about first; residuals are drawn for it and for every other
            one with an extended model.
        gain: None if nothing was adopted.
        further: errors on other parts of the log, or in another unit.
        below: those below the low pass of the angle, where the gain is clear there only.
    """

    holdout: str
    balances: tuple[BalanceResiduals, ...]
    gain: Gain | None
    further: tuple[Errors, ...]
    below: Errors | None = None


@dataclass(frozen=True)
class SearchTable:
    """What was considered.

    Attributes:
        candidates: best first.
        tied: families that explain the log equally well.
        chance: balance -> (deviance gained by its best candidate, level that chance exceeds in 1 log of 100).
    """

    candidates: tuple[CandidateRow, ...]
    tied: tuple[str, ...]
    chance: Mapping[str, tuple[float, float]]


@dataclass(frozen=True)
class Correlations:
    """Correlations of the errors of estimates: names, and the matrix (n, n), from -1 to 1.

    NaN where an estimate has no standard error, or two are from different balances.
    """

    names: tuple[str, ...]
    matrix: NDArray[np.float64]


@dataclass(frozen=True)
class ExtendedModel:
    """The base model with the adopted effects, fitted.

    Attributes:
        effects: in order of adoption.
        parameters: in order of printing.
        equations: its friction, then the definitions of its letters.
        correlations: of the fitted parameters; None with fewer than two.
        empirical: what a term without a cause does, in a sentence, the channel that it follows, and the
            balance with the residual that it leaves; None where the emitted model has none.
    """

    effects: tuple[AddedEffect, ...]
    parameters: tuple[Parameter, ...]
    equations: tuple[Formula, ...]
    correlations: Correlations | None = None
    empirical: tuple[str, str, BalanceResiduals] | None = None


@dataclass(frozen=True)
class LogQuality:
    """What the check of the log found.

    Attributes:
        facts: rows, sampling, gaps, delay, zero angle, offset.
        findings: of the check of the data.
        warnings: of the reader and of the fits.
    """

    facts: tuple[Fact, ...]
    findings: tuple[Finding, ...]
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class ReportData:
    """Everything that the report says; `files` are (name, description) of everything beside it."""

    source: Source
    conclusion: Conclusion
    errors: HeldOutErrors
    search: SearchTable
    extended: ExtendedModel
    log: LogQuality
    files: tuple[tuple[str, str], ...]
