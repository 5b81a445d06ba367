"""The effects that the search is offered: of the library and the user's own, those that a log can show."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

from eccentric.effects import Setting, library, load_effects
from eccentric.effects.effect import Effect
from eccentric.fitting import FitData, Signals
from eccentric.model import Model
from eccentric.rigs import Rig

__all__ = ["every_effect", "offered"]

_UNSEEN = {"current_bias", "sensor_delay", "ke_mismatch", "resistance_mismatch"}
"""Families that a voltage alone cannot show: of a current sensor, and of R and k_e, which are open then."""


def every_effect(setting: Setting, own: Path | None) -> list[Effect]:
    """The library for a setting and, from a file of the user's, effects of their own."""
    return [*library(setting), *(load_effects(own, setting) if own else ())]


def offered(
    effects: list[Effect], data: FitData, rig: Rig, setting: Setting, base: Model, balances: set[str]
) -> list[Effect]:
    """Those of the effects that the log can show, on the balances that it has, with what the rig knows."""
    return [
        _aliased(effect, data, setting.case)
        for effect in effects
        if set(effect.needs) <= setting.channels
        and _told(effect, data, balances)
        and _told_apart(effect, data, rig)
        and _known(effect, base, data.signals)
    ]


def _told(effect: Effect, data: FitData, balances: set[str]) -> bool:
    """Whether what measures the drive can show the effect at all."""
    if effect.family == "ki_mismatch" and not _scaled(data):
        return False
    if data.drive.by_voltage:
        if effect.balance == "electrical" and set(effect.terms) != {"electrical"}:
            return False
        return effect.family not in _UNSEEN
    if effect.balance not in balances:
        return False
    # The current would be the model's, whose noise is that of the acceleration.
    return effect.family != "sensor_delay" or data.drive.measured_twice


def _scaled(data: FitData) -> bool:
    """Whether a declared k_i makes the torque, and declared inertia and gravity tell it from either."""
    return _declared(data) and not {"J_m", "gravity"} & set(data.drive.open)


def _declared(data: FitData) -> bool:
    """Whether a declared k_i makes the torque, from a current or, by R/k_i, from a voltage."""
    return data.drive.scale is None and data.drive.channels.drive in {"current", "voltage"}


def _aliased(effect: Effect, data: FitData, case: str) -> Effect:
    """The effect with what no log of this rig tells from it.

    A wrong k_i scales inertia and gravity: where one of them is open, or is not there, the other alone shows
    it. A voltage alone knows R/k_i only.
    """
    if not _declared(data):
        return effect
    left_open = set(data.drive.open)
    alike = {
        "mass_mismatch": {"ki_mismatch"} if "J_m" in left_open else set(),
        "inertia_mismatch": {"ki_mismatch"} if case == "C1" or "gravity" in left_open else set(),
        "ki_mismatch": {"resistance_mismatch"} if data.drive.by_voltage else set(),
    }
    return replace(effect, aliases=(*effect.aliases, *alike.get(effect.family, set())))


def _told_apart(effect: Effect, data: FitData, rig: Rig) -> bool:
    """Whether the effect is told from what the rig leaves open, from run to run and from angle to angle."""
    if effect.family == "angle_offset" and "theta_zero_rad" in rig.estimate:
        return False
    if math.isinf(rig.average_over) and {"time", "acceleration", "history"} & set(effect.depends_on):
        return False
    # Without a common zero of the angle, phases of different runs do not compare.
    angles = {"link_angle", "motor_angle", "gravity_load"}
    return data.drive.channels.phased or not angles & set(effect.depends_on)


def _known(effect: Effect, base: Model, signals: Signals) -> bool:
    """Whether the rig knows every parameter of the base model that the effect uses."""
    unknown = {q.name for q in base.parameters} - set(signals.known)
    unknown -= {str(t.coefficient) for t in base.balance("mechanical").terms}
    used = set().union(
        *(d.value.free_symbols for d in effect.definitions),
        *(s.update.free_symbols for s in effect.states),
        *(t.basis.free_symbols for terms in effect.terms.values() for t in terms),
    )
    return not unknown & {s.name for s in used}
