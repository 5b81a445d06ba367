"""An effect becomes a candidate: the only bridge between physics and search.

Everything a candidate computes comes from the Effect's expressions and the Model it extends.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp

from eccentric.diagnosis.search.candidate import Candidate, Scaling, Values
from eccentric.effects import Effect, Setting, library, load_effects
from eccentric.identification import FitData, Signals, States, base_columns, compiled
from eccentric.model import Extension, Model, Role
from eccentric.model import vocabulary as v
from eccentric.rigs import Rig

Array = np.ndarray


def candidate_of(
    effect: Effect,
    model: Model,
    signals: Signals,
    friction: Array,
    balance: str | None,
    current: Array | None = None,
    instruments: Signals | None = None,
    travelled: Array | None = None,
) -> Candidate:
    """The effect as columns of torque.

    Args:
        effect: the record.
        model: the base model.
        signals: smooth signals.
        friction: (columns,) coefficients of a first fit of the base model, for the first look at effects that
            scale or replace something.
        balance: the one that shows it, None for the effect's own: with a voltage alone, effects of the
            armature show in the mechanical balance.
        current: the measured one (samples,) [A], below the low pass, if there is a voltage as well. An effect
            on the flux depends on it: the current of `signals` follows from the voltage with the declared
            back-EMF.
        instruments: the same signals without the noise of the target, None where there are none.
        travelled: the speed (samples,) [rad/s] that hidden states follow, None for that of `signals`.
    """
    extended = effect.extend(model)
    names = tuple(shape.quantity.name for shape in effect.shapes)
    followed = signals
    if travelled is not None:
        followed = replace(signals, values={**signals.values, "omega_m": travelled})
    states = States(extended, effect.change.states, followed, names)
    # On the flux: it adds a torque, and a voltage that depends on the speed.
    circuit = effect.change.terms.get("electrical", ())
    emf = any(v.omega_m.symbol in term.basis.free_symbols for term in circuit)
    seen, flux = signals, emf and "mechanical" in effect.change.terms
    if current is not None and flux:
        seen = replace(signals, values={**signals.values, "i": current})
    load = {"mechanical": sp.Integer(1), "electrical": model.torque_per_volt}
    own = {
        balance: [
            compiled(extended, load[balance] * _collected(terms, q.symbol), seen, names)
            for q in effect.coefficients
        ]
        for balance, terms in effect.change.terms.items()
    }
    # Of what is relative to a declared value, the coefficient is the same in every run.
    parts = [seen.part(q.part_of) for q in effect.coefficients]
    # The search bounds coefficients by 0 alone. Of one that may have either sign it refuses what lies beyond
    # its bounds; the upper end of the others may be one of scale, which the fit on the emitted module keeps.
    ranges = tuple(
        (-np.inf, np.inf)
        if low == 0.0
        else (-np.inf if low is None else low, np.inf if high is None else high)
        for low, high in effect.bounds
    )
    lower = tuple(0.0 if low == 0.0 else -np.inf for low, _ in effect.bounds) or (-np.inf,)
    changes = _changes(effect, model, extended, signals, names, states)

    def columns_of(*balances: str) -> Callable[[Values], Array]:
        def columns(values: Values) -> Array:
            series = states(values)
            every = [
                np.column_stack(
                    [part * column(values, series) for part, column in zip(parts, own[b], strict=True)]
                )
                for b in balances
            ]
            return np.sum(every, axis=0)

        return columns

    # Compiled only for the few that need it.
    plain = np.empty(0) if changes is None else base_columns(model, signals) @ friction

    def first_look(values: Values) -> Array:
        """The change at these values with the friction of the first fit: a direction for the search."""
        if changes is None:
            raise ValueError(f"effect {effect.id} changes nothing in the base model")
        known, base = changes(values)
        return (known + base @ friction - plain)[:, None]

    @cache
    def twin() -> Candidate:
        slow = signals if instruments is None else instruments
        own_current = None if current is None else slow.values["i"]
        speed = signals.values["omega_m"]
        return candidate_of(effect, model, slow, friction, balance, own_current, travelled=speed)

    def also_instrument(values: Values) -> Array:
        shows = twin().also
        if shows is None:
            raise ValueError(f"effect {effect.id} adds nothing to the other balance")
        return shows(values)

    # With a voltage alone both balances are one.
    shown = tuple(own) if balance == "mechanical" else (effect.balance,)
    other = (
        {"electrical": "mechanical", "mechanical": "electrical"}[effect.balance] if balance is None else ""
    )
    return Candidate(
        id=effect.id,
        family=effect.family,
        balance=balance or effect.balance,
        evidence=effect.evidence,
        columns=columns_of(*shown) if changes is None else first_look,
        shapes=effect.shapes,
        lower=lower if changes is None else (0.0,),
        ranges=ranges if changes is None else (),
        words=effect.words,
        instrument=None if instruments is None else lambda values: twin().columns(values),
        also=columns_of(other) if other in own else None,
        also_instrument=also_instrument if other in own and instruments is not None else None,
        joint=flux,
        changes=changes,
        scales=_scales(effect, model, extended, signals, names, states),
        roles=tuple(_role(effect, q.symbol) for q in effect.coefficients) if changes is None else (),
        tolerance=_tolerance(effect, signals) if changes is None else 0.0,
    )


def _tolerance(effect: Effect, signals: Signals) -> float:
    """The coefficient at which the value that an effect corrects is off by its tolerance.

    0 if it corrects none, or one that is 0 or that the rig does not declare.
    """
    wrong = effect.corrects
    if wrong is None or not wrong.tolerance:
        return 0.0
    coefficient = effect.coefficients[0].symbol
    letters = wrong.value.free_symbols - {coefficient}
    if not {letter.name for letter in letters} <= set(signals.known):
        return 0.0
    at = {coefficient: 0.0, **{letter: signals.known[letter.name] for letter in letters}}
    declared, slope = (abs(float(x.subs(at))) for x in (wrong.value, sp.diff(wrong.value, coefficient)))
    return wrong.tolerance * declared / slope if slope else 0.0


def _collected(terms: Sequence[Any], coefficient: sp.Symbol) -> sp.Expr:
    """The factor of the coefficient in the terms of one balance."""
    own = [term for term in terms if term.value.has(coefficient)]
    return sp.Add(
        *(
            term.basis if term.coefficient == coefficient else sp.expand(term.value).coeff(coefficient)
            for term in own
        )
    )


def _role(effect: Effect, coefficient: sp.Symbol) -> Role:
    """The role of the friction that a coefficient belongs to."""
    terms = effect.change.terms.get(effect.balance, ())
    roles = {term.role for term in terms if term.value.has(coefficient)}
    return roles.pop() if len(roles) == 1 else Role.NONE


def _scales(
    effect: Effect, model: Model, extended: Model, signals: Signals, names: tuple[str, ...], states: States
) -> Callable[[Values], Scaling] | None:
    """For an effect that scales: values -> its factors, on the base and by role."""
    if not effect.change.scales:
        return None
    factors = {
        role: compiled(extended, factor, signals, names) for role, factor in effect.change.scales.items()
    }
    roles = [column.role for column in signals.columns(model)]

    def scaling(values: Values) -> Scaling:
        series = states(values)
        by_role = {role: factor(values, series) for role, factor in factors.items()}
        one = np.ones(signals.size)
        own = [by_role.get(role, one) for role in roles] + [one] * len(signals.open)
        return Scaling(np.column_stack(own), by_role)

    return scaling


def _changes(
    effect: Effect, model: Model, extended: Model, signals: Signals, names: tuple[str, ...], states: States
) -> Callable[[Values], tuple[Array, Array]] | None:
    """For an effect that scales or replaces: values -> (what is known to be missing, new base columns)."""
    if not effect.change.replaces and not effect.change.scales:
        return None
    swap = dict(effect.change.replaces)
    columns = []
    for column in signals.columns(model):
        basis = column.basis.xreplace(swap) * effect.change.scales.get(column.role, 1)
        columns.append(compiled(extended, basis, signals, names))
    loads = [
        compiled(
            which, which.balance("mechanical").sum_of("inertial", "gravity", "conservative"), signals, names
        )
        for which in (extended, model)
    ]

    def changed(values: Values) -> tuple[Array, Array]:
        series = states(values)
        known = loads[0](values, series) - loads[1](values, series)
        return known, np.column_stack(
            [*(column(values, series) for column in columns), *signals.open.values()]
        )

    return changed


# Which effects are offered to the search: those of the library and the user's own that the log can show.
#
# An effect itself decides from the `Setting` whether it makes sense for a rig. What follows from the record
# of any effect is checked here: channels, balances, variables and parameters that this log has.
def offered(
    setting: Setting, own: Path | None, data: FitData, rig: Rig, base: Model, balances: set[str]
) -> tuple[Effect, ...]:
    """The effects of the library for a setting, and of the user's own file, that the log can show.

    balances: names of those that the log has.
    """
    effects = [*library(setting), *(load_effects(own, setting) if own else ())]
    return tuple(
        effect.told_for(rig.axis)
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
