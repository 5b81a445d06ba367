"""An effect: a record that extends a Model by something physical that the paper leaves out.

It may add terms to a balance, replace a quantity, scale friction by its role, and introduce hidden states.
No part of it is a flag in the model: `extend` returns an ordinary Model, which can be extended further and is
emitted by the same code.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import sympy as sp

from eccentric.effects.words import Words
from eccentric.model import Change, Equation, Extension, Model, Quantity, extended
from eccentric.model import vocabulary as v


@dataclass(frozen=True)
class Shape:
    """A parameter that enters nonlinearly: searched over a grid, then refined.

    Attributes:
        quantity: the parameter.
        low, high: range of the search, in its unit.
        scale: "log" or "linear".
        points: number of grid points.
        jumps: whether the residual jumps with it, such as where it decides when something happens: between
            the points of the grid it has no slope.
    """

    quantity: Quantity
    low: float
    high: float
    scale: str = "linear"
    points: int = 8
    jumps: bool = False

    @property
    def middle(self) -> float:
        """The middle of the range, on its scale."""
        return (self.low * self.high) ** 0.5 if self.scale == "log" else 0.5 * (self.low + self.high)

    def at(self, place: float) -> float:
        """The value at a place in the range, on its scale: 0 is its lower end, 1 its upper."""
        if self.scale == "log":
            return float(self.low * (self.high / self.low) ** place)
        return float(self.low + (self.high - self.low) * place)

    def place_of(self, value: float) -> float:
        """The place of a value in the range, from 0 to 1."""
        if self.scale == "log":
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)


@dataclass(frozen=True)
class Evidence:
    """How an effect shows in a log.

    Attributes:
        depends_on: variables it depends on, the leading one first: velocity, direction, link_angle,
            motor_angle, gravity_load, transmitted_torque, acceleration, current, voltage, temperature, time,
            history.
        needs: channels that the log must have to show it: "current", "voltage", "temperature".
        aliases: families that are exactly the same within the base model.
        special_of: families of which this one is a special case.
        repeats: whether another effect of the family may join it (harmonics of other orders).
        second_order: families that look like what its record leaves out: terms of second order, or a bound
            that it has not.
        one_of: of how many orders it is one, each as likely as the others.
    """

    depends_on: tuple[str, ...]
    needs: tuple[str, ...] = ()
    aliases: tuple[str, ...] = ()
    special_of: tuple[str, ...] = ()
    repeats: bool = False
    second_order: tuple[str, ...] = ()
    one_of: int = 1


@dataclass(frozen=True)
class Correction:
    """A quantity whose declared value is wrong.

    Attributes:
        quantity: the quantity.
        value: its true value; with the effect's parameters at 0 it is the declared one.
        looks_wrong: what else a check of the record finds wrong because of it: "J", "M g L".
        tolerance: usual limit of the relative error of a declared value, 0 if it is weighed.
    """

    quantity: Quantity
    value: sp.Expr
    looks_wrong: tuple[str, ...] = ()
    tolerance: float = 0.0


@dataclass(frozen=True)
class Effect:
    """One way in which the world differs from the model.

    Attributes:
        family: its name in a diagnosis, a key of `eccentric.effects.FAMILIES` or a user's own.
        variant: what distinguishes it within the family, e.g. "n=3"; "" for the plain one.
        balance: the balance that shows it, "mechanical" or "electrical".
        formula: what it adds, as a person would write it.
        reference: source of the form.
        change: what it changes in a model.
        evidence: how it shows in a log.
        coefficients: its linear parameters, in the order of their terms; a default of None counts as 0.
        shapes: its nonlinear parameters.
        words: what a person reads about it.
        corrects: what the rig declares wrongly, for an effect that is only a wrong declaration.
    """

    family: str
    balance: str
    formula: str
    reference: str
    change: Change
    evidence: Evidence
    variant: str = ""
    coefficients: tuple[Quantity, ...] = ()
    shapes: tuple[Shape, ...] = ()
    words: Words = field(default_factory=Words)
    corrects: Correction | None = None

    @property
    def id(self) -> str:
        """Its name in reports, e.g. "link_harmonic_friction[n=3]"."""
        return f"{self.family}[{self.variant}]" if self.variant else self.family

    @property
    def shows_in(self) -> tuple[str, ...]:
        """The balances that it changes; that which shows it first is `balance`."""
        return (self.balance, *(other for other in self.change.terms if other != self.balance))

    @property
    def parameters(self) -> tuple[Quantity, ...]:
        """All its parameters: coefficients, then shapes."""
        return (*self.coefficients, *(shape.quantity for shape in self.shapes))

    @property
    def bounds(self) -> tuple[tuple[float | None, float | None], ...]:
        """Bounds of each coefficient, from its terms; None for an open side."""
        terms = [term for terms in self.change.terms.values() for term in terms]
        of = {term.coefficient: term.bounds for term in terms}
        return tuple(of[q.symbol] for q in self.coefficients)

    def applies_to(self, model: Model) -> bool:
        """Whether the model has every quantity that the effect uses, such as a torque constant k_i."""
        change = self.change
        own = {q.symbol for q in (*self.parameters, *change.inputs)}
        own |= {x.symbol for x in (*change.definitions, *change.states)} | {v.dt.symbol}
        used = set(change.replaces).union(
            *(term.value.free_symbols for terms in change.terms.values() for term in terms),
            *(definition.value.free_symbols for definition in change.definitions),
            *(state.update.free_symbols for state in change.states),
        )
        return used - own <= set(model.units())

    def extend(self, model: Model, values: Mapping[str, float] | None = None) -> Model:
        """The model extended by this effect; the order of several effects makes no difference.

        Args:
            model: any model, including one that is already extended.
            values: default of each parameter of the effect, by name; 0 for a coefficient and the middle of
                its range for a shape if not given.

        Raises:
            InputError: the model cannot be extended by it, or not in addition to an effect that it already
                has.
        """
        given = {q.name: 0.0 for q in self.coefficients}
        given |= {shape.quantity.name: shape.middle for shape in self.shapes}
        given |= values or {}
        parameters = tuple(
            replace(q, default=sp.Rational(repr(float(given[q.name])))) for q in self.parameters
        )
        return extended(model, Extension(self.id, self.change, parameters, self.equations()))

    def equations(self) -> tuple[Equation, ...]:
        """Its steps in the derivation: one for each quantity it replaces, then what it adds or scales."""
        values = {definition.symbol: definition for definition in self.change.definitions}
        replacing = tuple(
            Equation(
                f"{old.name}_replaced",
                "",
                new,
                values[new].value,
                values[new].quantity.unit,
                f"Effect {self.id}: replaces {old}. {self.reference}.",
            )
            for old, new in self.change.replaces.items()
        )
        return replacing if replacing and not self.change.terms else (*replacing, self.equation())

    def equation(self) -> Equation:
        """The effect as a step in the derivation: the torque (or voltage) it adds, or what it replaces."""
        added = self.change.terms.get(self.balance, ())
        unit = {"mechanical": "N m", "electrical": "V"}[self.balance]
        if added:
            left, right = sp.Symbol(f"Delta_{self.family}"), sp.Add(*(term.value for term in added))
        else:
            last = self.change.definitions[-1]
            left, right, unit = last.symbol, last.value, last.quantity.unit
        name = "_".join(filter(None, (self.family, self.variant.replace("=", "_"))))
        return Equation(name, "", left, right, unit, f"Effect {self.id}: {self.formula}. {self.reference}.")
