"""A harder question to the servo's log: is its free swing predicted by what was learned with the motor on?

Effects are searched, and all models fitted, with every row of the switched-off motor taken out.  Rows with the
motor on cannot tell the back-EMF from viscous friction: both are a torque in proportion to the speed.  So k_e is
given, as values between the k_t that others published for this servo (an ideal motor has k_e = k_t).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks.measured_plot import friction
from eccentric.diagnosis import Diagnosis
from eccentric.identification import refit

K_E = (0.32, 0.355, 0.39)
"""Published fits of k_t at the output of this servo, lowest, middle and highest [V s/rad]."""


def free_errors(whole: Diagnosis, driven: Diagnosis) -> dict[str, list[float]]:
    """RMSE over all free rows of models fitted on driven rows: model -> one error for each of `K_E` [N m].

    `whole` holds the rows, `driven` the effects.  Also the RMS of what has to be predicted, friction of the arm
    that swings freely, as "no friction".
    """
    data = whole.data
    off = data.rows.mean(data.drive.off.astype(float)) > 0.0
    rows = replace(data.rows, train=(data.rows.train | data.rows.score) & ~off)
    shapes = tuple(
        (e, {s.quantity.name: own[s.quantity.name] for s in e.shapes})
        for e, own in driven.models.extended.effects
    )
    models = {
        "no friction": None,
        "Coulomb + viscous": ((), {"bounds": False, "linear": True}),
        "paper": ((), {"bounds": False}),
        "extended": (shapes, {}),
    }
    errors: dict[str, list[float]] = {name: [] for name in models}
    for k_e in K_E:
        still_open = tuple(c for c in data.drive.open if c.role != "back_emf")
        drive = replace(data.drive, known={**data.drive.known, "k_e": k_e}, open=still_open)
        signals = replace(data.signals, open={c: data.signals.open[c] for c in still_open})
        given = replace(data, drive=drive, rows=rows, signals=signals)
        for name, options in models.items():
            effects, how = options or (shapes, {})
            found = refit(whole.models.base, effects, given, **how)
            left = found.residuals["mechanical"]
            if options is None:
                left = friction(found)
            errors[name].append(float(np.sqrt(np.mean(left[off] ** 2))))
    return errors
