"""The models after the search: fitted on their own emitted modules, and held against what was held out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from eccentric.diagnosis.score import Score, leave_runs_out, score
from eccentric.effects import Effect
from eccentric.fitting import FitData, Refit, refit
from eccentric.model import Model
from eccentric.search import Attribution, unconfirmed

__all__ = ["LEAST_R2", "Trial", "trial"]

LEAST_R2 = 0.5
"""R^2 of the drive torque under which a log is not of this rig, or not in its units: nothing is named."""


@dataclass(frozen=True)
class Trial:
    """What became of the attribution; the fields are those of `outcome.Diagnosis`."""

    attribution: Attribution
    linear: Refit
    paper: Refit
    extended: Refit
    shipped: Refit
    score: Score
    refused: Score | None
    r_squared: float


def trial(
    found: Attribution, effects: Sequence[Effect], base: Model, data: FitData, tell: Callable[[str], None]
) -> Trial:
    """Fit the three models and open the held-out part; what it does not confirm loses its name.

    `effects` are those that were offered; `tell` is told one line per stage.
    """
    tell("refitting on the emitted module")
    by_id = {effect.id: effect for effect in effects}
    adopted = tuple((by_id[a.variant.candidate.id], dict(a.variant.values)) for a in found.adopted)
    if found.verdict in {"unexplained", "nothing_missing"}:
        adopted = ()
    paper = refit(base, (), data, bounds=False)
    extended = refit(base, adopted, data) if adopted else paper
    linear = refit(base, (), data, bounds=False, linear=True)
    r_squared = _explained(paper)
    if r_squared < LEAST_R2:
        found = replace(unconfirmed(found), next_measurement="Mend the rig file or the log first.")
        extended = paper
    balance = "mechanical" if extended is paper else found.adopted[0].balance
    scored = score(linear, paper, extended, balance, leave_runs_out(base, extended, data))
    refused = None
    # Voltage and current tell an effect twice, and row by row a ripple above the low pass is worse for being
    # in the model. One signal alone has nothing but the held-out part to be checked by.
    if extended is not paper and not data.drive.measured_twice and not scored.confirms:
        tell("the held-out part does not confirm it")
        refused, found, extended = scored, unconfirmed(found), paper
        scored = score(linear, paper, paper, "mechanical", leave_runs_out(base, paper, data))
    shipped = refit(base, (), data) if extended is paper else extended
    return Trial(found, linear, paper, extended, shipped, scored, refused, r_squared)


def _explained(paper: Refit) -> float:
    """R^2 of the drive torque on the training rows: friction, inertia and gravity of the paper's model."""
    rows = paper.data.rows
    drive = rows.mean(paper.data.drive.torque())[rows.train]
    return 1.0 - float(np.mean(paper.residuals["mechanical"][rows.train] ** 2) / np.mean(drive**2))
