"""A constant load on the link, if the rig has one: not an effect to be found, but part of the base model."""

from __future__ import annotations

from collections.abc import Mapping

from eccentric.effects import constant_load, with_constant_load
from eccentric.fitting.expressions import evaluated
from eccentric.model import Model
from eccentric.rigs import Rig

__all__ = ["load_gain", "loaded_model"]


def loaded_model(base: Model, rig: Rig) -> Model:
    """The model, extended by a constant load if the rig has one."""
    declared = "T_load" in rig.known or "T_load" in rig.unknown
    return with_constant_load(base, rig.known.get("T_load", 0.0)) if declared else base


def load_gain(known: Mapping[str, float]) -> float:
    """The torque at the motor per newton metre of load: mu, if it is known."""
    (term,) = constant_load.change.terms["mechanical"]
    return float(evaluated(term.basis, {"mu": 1.0, **known}))
