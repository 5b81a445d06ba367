"""Which effects are offered to the search: those of the library and the user's own that the log can show.

An effect itself decides from the `Setting` whether it makes sense for a rig. What follows from the record of
any effect is checked here: channels, balances, variables and parameters that this log has.
"""

from __future__ import annotations

import math
from pathlib import Path

from eccentric.effects import Effect, Setting, library, load_effects
from eccentric.fitting import FitData
from eccentric.model import Extension, Model
from eccentric.rigs import Rig

__all__ = ["offered"]


def offered(
    setting: Setting, own: Path | None, data: FitData, rig: Rig, base: Model, balances: set[str]
) -> tuple[Effect, ...]:
    """The effects of the library for a setting, and of the user's own file, that the log can show.

    balances: names of those that the log has.
    """
    effects = [*library(setting), *(load_effects(own, setting) if own else ())]
    return tuple(
        effect
        for effect in effects
        if setting.has(*effect.evidence.needs)
        and _in_a_balance(effect, data, balances)
        and _varies(effect, data, rig)
        and _known(effect, base, data, balances)
        and _absent(effect, base)
        and _occurs(effect, base)
    )


def _absent(effect: Effect, base: Model) -> bool:
    """Whether the base model is not extended by the effect, or by one in its place, already."""
    new = Extension(effect.id, effect.change, effect.parameters)
    return not any(
        there.names & new.names or set(there.change.replaces) & set(new.change.replaces)
        for there in base.extensions
    )


def _occurs(effect: Effect, base: Model) -> bool:
    """Whether the base model has what the effect replaces: a joint of an arm has no angle."""
    terms = (term.value for balance in base.balances for term in balance.terms)
    values = (definition.value for definition in base.definitions)
    used = set().union(*(x.free_symbols for x in (*terms, *values)))
    return set(effect.change.replaces) <= used


def _in_a_balance(effect: Effect, data: FitData, balances: set[str]) -> bool:
    """Whether a balance of the log shows the effect."""
    # With a voltage alone, effects of the armature show in the torque computed from it.
    if data.drive.by_voltage:
        return effect.balance != "electrical" or set(effect.change.terms) == {"electrical"}
    return effect.balance in balances


def _varies(effect: Effect, data: FitData, rig: Rig) -> bool:
    """Whether the variables of the effect are comparable from row to row and from run to run."""
    variables = set(effect.evidence.depends_on)
    if variables & rig.axis.absent or effect.family in rig.axis.foreign:
        return False
    if math.isinf(rig.sampling.average_over) and {"time", "acceleration", "history"} & variables:
        return False
    # Without a common zero of the angle, phases of different runs are not comparable.
    return data.drive.channels.phased or not {"link_angle", "motor_angle", "gravity_load"} & variables


def _known(effect: Effect, base: Model, data: FitData, balances: set[str]) -> bool:
    """Whether the rig knows every parameter of the base model that the effect uses where the log shows it."""
    unknown = {q.name for q in base.parameters} - set(data.signals.known)
    shown = effect.change.terms if data.drive.by_voltage else balances
    unknown -= {str(t.coefficient) for t in base.balance("mechanical").terms}
    used = set().union(
        *(d.value.free_symbols for d in effect.change.definitions),
        *(s.update.free_symbols for s in effect.change.states),
        *(t.basis.free_symbols for b, terms in effect.change.terms.items() if b in shown for t in terms),
    )
    return not unknown & {s.name for s in used}
