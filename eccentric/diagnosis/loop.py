"""Close the loop: fit the paper's model, attribute the residual, extend the model, measure the error again.

The stages, each with its result:

    drive       channels, rig -> drive torque, known and identified parameters   (`drive.drive_of`)
    signals     smooth inputs of expressions                                     (`fit_data.fit_data_of`)
    balances    both residuals as linear designs on the training part            (`balances.balances_of`)
    attribute   verdict and adopted effects                                      (`verdict.attribute`)
    extend      Model', its coefficients fitted on its own emitted module        (`models.fitted_models`)
    score       held-out RMSE before and after; the held-out part is opened there and nowhere else
                (the zero-phase low pass carries some 20 ms across its borders)
    orders      what is left inside runs and periodic in the angle               (`orders.orders_of`)
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from eccentric.diagnosis.base_script import BASE
from eccentric.diagnosis.models import fitted_models
from eccentric.diagnosis.orders import orders_of
from eccentric.diagnosis.outcome import Asked, Diagnosis
from eccentric.errors import InputError
from eccentric.estimation import bounded
from eccentric.fitting import (
    drive_noise,
    drive_of,
    fit_data_of,
    loaded_model,
    residual_samples,
    with_model_current,
)
from eccentric.logs import LogSource, read_log
from eccentric.model import Model, load_model
from eccentric.model import vocabulary as v
from eccentric.rigs import Rig, read_rig
from eccentric.search import (
    attribute,
    balances_of,
    candidate_of,
    offered,
    setting_of,
    variables_of,
)
from eccentric.signals import LEAST_HELD_OUT, BalanceDesign, Channels, read_channels, require_rows

__all__ = ["diagnose"]

Array = np.ndarray


def diagnose(
    logs: Sequence[LogSource],
    rig: str | os.PathLike[str] | Mapping[str, Any] | Rig,
    model: str | Model | None = None,
    effects: Path | None = None,
    tell: Callable[[str], None] | None = None,
) -> Diagnosis:
    """Diagnose one rig's logs.

    Args:
        logs: those of one rig, as `read_log` accepts them.
        rig: the rig, as `read_rig` accepts it.
        model: the base model, its name or the path of its derivation; by the rig's case if None.
        effects: a file with the user's own effects.
        tell: called with one line per stage.

    Raises:
        InputError: bad input; a model with a tilt, with hidden states or with what is found from the current;
            or fewer than two rows to hold out.
    """
    tell = tell or (lambda _: None)
    read = [read_log(log) for log in logs]
    channels = read_channels(read, read_rig(rig))
    rig, names = channels.rig, tuple(Path(log.path).name for log in read)
    given = rig.model if model is None else model
    plain = given if isinstance(given, Model) else load_model(given)
    _require_supported(plain, channels)
    tell(f"{channels.counts['used']} rows used of {channels.intake.read}")
    drive = drive_of(channels, rig, plain)
    base, channels = loaded_model(plain, rig), drive.channels
    data = fit_data_of(drive, rig, base)
    require_rows(data.rows.score, LEAST_HELD_OUT, f"{data.rows.description} to hold out", ", ".join(names))
    balances, noise = balances_of(data, rig, base)
    friction = _first_friction(balances)
    if not drive.measured_twice:
        data = with_model_current(data, base, friction)
    setting = setting_of(data, base, friction)
    names_of_balances = {balance.name for balance in balances}
    chosen = offered(setting, effects, data, rig, base, names_of_balances)
    only = "mechanical" if drive.by_voltage else None
    found = attribute(
        balances,
        [candidate_of(effect, base, data.signals, friction, only) for effect in chosen],
        variables_of(data),
        noise,
        len(np.unique(channels.time.run[channels.selection.fit_rows])),
        tell,
    )
    found, models, score, refused = fitted_models(found, chosen, base, data, tell)
    return Diagnosis(
        asked=Asked(names, Path(rig.path).name, given if isinstance(given, str) else BASE, effects),
        data=data,
        setting=setting,
        offered=chosen,
        attribution=found,
        models=models,
        score=score,
        refused=refused,
        noise_floor=drive_noise(data),
        orders=orders_of(data, residual_samples(models.shipped)),
    )


def _require_supported(model: Model, channels: Channels) -> None:
    if "phi" in {q.name for q in model.parameters}:
        raise InputError(
            f"{model.name}: diagnose requires a model of case C1 or C2, received one with a tilt"
        )
    if model.states:
        names = ", ".join(state.quantity.name for state in model.states)
        raise InputError(
            f"{model.name}: diagnose requires a model without hidden states, received one with {names}"
            " (diagnose adds the effect that has them itself)"
        )
    if any("electrical" in extension.change.terms for extension in model.extensions):
        raise InputError(
            f"{model.name}: diagnose requires a model with the paper's armature, received one extended by an"
            " electrical effect (diagnose adds it itself)"
        )
    mechanical = model.balance("mechanical")
    used = model.expand(mechanical.sum_of("friction", "conservative", "actuator")).free_symbols
    if {v.i.symbol, v.u.symbol} & used:
        raise InputError(
            f"{model.name}: diagnose requires a model without effects of current or voltage, received one"
            " with some (diagnose adds them itself)"
        )
    if v.temperature.symbol in used and channels.temperature is None:
        raise InputError(f"{model.name}: diagnose requires a temperature in the log, received none")


def _first_friction(balances: Sequence[BalanceDesign]) -> Array:
    """Coefficients of the mechanical balance's base, friction within its bounds: (columns,)."""
    mechanical = next(b for b in balances if b.name == "mechanical")
    none = np.full(len(mechanical.lower), np.inf)
    return bounded(mechanical.base, mechanical.target, mechanical.lower, none).coefficients
