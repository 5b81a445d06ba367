"""Models that ship for the same case: whether one predicts better as it stands than what was found."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eccentric.diagnosis.models import Models
from eccentric.errors import InputError
from eccentric.estimation import improvement, rms
from eccentric.fitting import FitData, fit_data_of, loaded_model, refit
from eccentric.model import Model, load_model, model_names
from eccentric.signals import LEAST_HELD_OUT

__all__ = ["Sibling", "better_sibling"]


@dataclass(frozen=True)
class Sibling:
    """A shipped model that predicts the held-out part better.

    rmse: of its mechanical balance in the unit of the extended model's; percent: less error than the model
    that was found, with its 95 % `interval`.
    """

    name: str
    rmse: float
    percent: float
    interval: tuple[float, float]


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
        if not _separable(model, own):
            continue
        fit = refit(model, (), own)
        after = fit.residual_like(found)[rows]
        percent, interval = improvement(before, after)
        below = fit.residual_like(found, smooth=True)[rows]
        if interval[0] > 0.0 and improvement(smooth, below)[1][0] > 0.0:
            better.append(Sibling(name, rms(after), percent, interval))
    return min(better, key=lambda sibling: sibling.rmse, default=None)


def _separable(model: Model, data: FitData) -> bool:
    """Whether the training rows separate all coefficients of a model: one direction alone may not."""
    try:
        data.require_rank(model, model.name)
    except InputError:
        return False
    return True


def _case(model: Model) -> tuple[bool, bool]:
    """Whether gravity acts in the plane, and whether the plane is tilted: the same for models of one case."""
    return model.balance("mechanical").sum_of("gravity") != 0, model.tilted
