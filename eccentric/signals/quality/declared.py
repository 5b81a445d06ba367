"""What a rig declares of its body and its motor, evaluated by the definitions of the general derivation."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import sympy as sp

from eccentric.model import load_model
from eccentric.model import vocabulary as v
from eccentric.signals.quality.limits import LEVEL

if TYPE_CHECKING:
    from eccentric.model import Model
    from eccentric.rigs import Rig

__all__ = ["gravity_of", "inertia_of", "torque_per_unit", "upright_gravity_of"]

# It holds every case: the tilt says which.
MODEL = "rotating_link"


def inertia_of(rig: Rig) -> float | None:
    """Return all of the inertia at the motor [kg m^2], None where the rig does not declare it."""
    model = load_model(rig.model)
    return _value(model, model.inertia, rig.known)


def gravity_of(rig: Rig) -> float | None:
    """Return the amplitude of gravity at the motor [N m], None where the rig does not declare it."""
    upright = upright_gravity_of(rig)
    if upright is None or "phi" not in rig.known:
        return None
    found = _gravity(rig.known)
    return 0.0 if found is None or found <= LEVEL * upright else found


def upright_gravity_of(rig: Rig) -> float | None:
    """Return what it would be in an upright plane."""
    return _gravity({**rig.known, "phi": 0.0})


def torque_per_unit(drive: str, rig: Rig) -> float | None:
    """Return newton metres per unit of the drive, None where the rig does not declare it."""
    if drive == "torque":
        return 1.0
    model, unit = load_model(rig.model), {"i": 1.0, "u": 1.0, "omega_m": 0.0, "k_e": 0.0}
    torque = model.balance("mechanical").sum_of("drive")
    if drive == "voltage":
        torque = torque.xreplace({v.i.symbol: model.balance("electrical").solved_for(v.i.symbol)})
    return _value(model, torque, {**rig.known, **unit})


def _gravity(known: Mapping[str, float]) -> float | None:
    """With the link a quarter of a turn from where it hangs down."""
    if "mu" not in known:
        return None
    quarter = math.pi / 2.0 / known["mu"]
    model = load_model(MODEL)
    return _value(model, model.balance("mechanical").sum_of("gravity"), {**known, "theta_m": quarter})


def _value(model: Model, expression: sp.Expr, known: Mapping[str, float]) -> float | None:
    try:
        return model.value(expression, known)
    except KeyError:
        return None
