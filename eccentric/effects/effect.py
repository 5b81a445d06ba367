"""An effect: a record that extends a Model by something physical that the paper leaves out.

It may add terms to a balance, replace a quantity, scale the friction coefficients, and bring hidden states
along. Nothing of it is a flag in the model: what comes out of `extend` is a Model like any other, derived
further and emitted by the same code.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import sympy as sp

from eccentric.effects.words import Words
from eccentric.model import Definition, Equation, Model, Quantity, Role, State, Term


@dataclass(frozen=True)
class Shape:
    """A parameter that enters nonlinearly: searched over a grid, then refined.

    Attributes:
        quantity: the parameter.
        low, high: range of the search, in its unit.
        scale: "log" or "linear".
        points: of the grid.
    """

    quantity: Quantity
    low: float
    high: float
    scale: str = "linear"
    points: int = 8


@dataclass(frozen=True)
class Effect:
    """One way in which the world differs from the model.

    Attributes:
        id: name in reports, e.g. "link_harmonic_friction[n=3]".
        family: what it is called in a diagnosis, a key of `eccentric.effects.FAMILIES`.
        balance: the balance that shows it, "mechanical" or "electrical".
        depends_on: variables it depends on, the leading one first: velocity, direction, link_angle,
            motor_angle, gravity_load, transmitted_torque, acceleration, current, voltage, temperature, time,
            history.
        formula: what it adds, as a person would write it.
        reference: where the form comes from.
        coefficients: its linear parameters, in the order of their terms; a default of None counts as 0.
        bounds: of each coefficient.
        terms: name of balance -> terms it adds there; a coefficient may stand in both balances.
        shapes: its nonlinear parameters.
        definitions: quantities it brings along, each after those it uses.
        replaces: symbol -> symbol of one of `definitions`, to stand in its place wherever the model used it.
        scales: role -> symbol of one of `definitions` that multiplies the friction terms of that role.
        inputs: further inputs, of the vocabulary: temperature, t.
        states: hidden states.
        needs: channels of the log without which it cannot be seen.
        aliases: ids that are exactly the same within the base model.
        special_of: families of which this one is a special case.
        repeats: whether another effect of the family may join it (harmonics of other orders).
        words: what a person reads of it.
        corrects: a quantity that the rig declares and its true value, for an effect that is nothing but a
            wrong declaration; without the effect's parameters it is the declared one.
    """

    id: str
    family: str
    balance: str
    depends_on: tuple[str, ...]
    formula: str
    reference: str
    coefficients: tuple[Quantity, ...] = ()
    bounds: tuple[tuple[float | None, float | None], ...] = ()
    terms: Mapping[str, tuple[Term, ...]] = field(default_factory=dict)
    shapes: tuple[Shape, ...] = ()
    definitions: tuple[Definition, ...] = ()
    replaces: Mapping[sp.Symbol, sp.Symbol] = field(default_factory=dict)
    scales: Mapping[Role, sp.Symbol] = field(default_factory=dict)
    inputs: tuple[Quantity, ...] = ()
    states: tuple[State, ...] = ()
    needs: tuple[str, ...] = ()
    aliases: tuple[str, ...] = ()
    special_of: tuple[str, ...] = ()
    repeats: bool = False
    words: Words = field(default_factory=Words)
    corrects: tuple[Quantity, sp.Expr] | None = None

    @property
    def parameters(self) -> tuple[Quantity, ...]:
        """All its parameters: coefficients, then shapes."""
        return (*self.coefficients, *(shape.quantity for shape in self.shapes))

    def extend(self, model: Model, values: Mapping[str, float] | None = None) -> Model:
        """The model with this effect in it.

        Args:
            model: any model, also one that is extended already.
            values: default of each parameter of the effect, by name; 0 for a coefficient and the middle of
                its range for a shape if not given.

        Raises:
            ValueError: the model has something of one of these names already, a quantity to be replaced is
                not there or was replaced by another effect, or a balance does not exist.
        """
        values = values or {}
        taken = {q.name for q in (*model.parameters, *model.inputs, *(d.quantity for d in model.definitions))}
        taken |= {state.quantity.name for state in model.states}
        own = [*self.parameters, *(d.quantity for d in self.definitions), *(s.quantity for s in self.states)]
        if clash := sorted(q.name for q in own if q.name in taken):
            raise ValueError(f"effect {self.id}: {', '.join(clash)}: taken in {model.name} by another effect")
        parameters = [
            replace(q, default=_exact(values.get(q.name, _start(self, q)))) for q in self.parameters
        ]
        swap = dict(self.replaces)
        used = set().union(*(d.value.free_symbols for d in model.definitions))
        used |= set().union(*(t.value.free_symbols for b in model.balances for t in b.terms))
        if absent := [old for old in swap if old not in used]:
            raise ValueError(f"effect {self.id}: {absent[0]} does not occur in {model.name}")
        steps = {equation.name for equation in model.equations}
        if again := [old for old in swap if _replaced(old) in steps]:
            raise ValueError(
                f"effect {self.id}: {again[0]} is replaced in {model.name} by another effect already"
            )
        definitions = [replace(d, value=d.value.xreplace(swap)) for d in model.definitions]
        balances = []
        for balance in model.balances:
            terms = [self._scaled(t, balance.name) for t in balance.terms]
            terms = [replace(t, basis=t.basis.xreplace(swap)) for t in terms]
            balances.append(replace(balance, terms=(*terms, *self.terms.get(balance.name, ()))))
        if unknown := set(self.terms) - {b.name for b in model.balances}:
            raise ValueError(f"effect {self.id}: {model.name} has no balance {min(unknown)!r}")
        new_inputs = [q for q in self.inputs if q.symbol not in {known.symbol for known in model.inputs}]
        inputs = sorted([*model.inputs, *new_inputs], key=lambda q: _INPUTS.get(q.name, len(_INPUTS) - 2))
        states = tuple(replace(state, update=state.update.xreplace(swap)) for state in model.states)
        return replace(
            model,
            inputs=tuple(inputs),
            parameters=(*model.parameters, *parameters),
            definitions=_ordered(
                [*self.definitions, *definitions],
                inputs,
                [*model.parameters, *parameters],
                [*model.states, *self.states],
            ),
            balances=tuple(balances),
            states=(*states, *self.states),
            equations=(*model.equations, *self.equations()),
        )

    def equations(self) -> tuple[Equation, ...]:
        """Its steps of the derivation: one for each quantity it replaces, then what it adds or scales."""
        values = {definition.symbol: definition for definition in self.definitions}
        replacing = tuple(
            Equation(
                _replaced(old),
                "",
                new,
                values[new].value,
                values[new].quantity.unit,
                f"Effect {self.id}: stands for {old}. {self.reference}.",
            )
            for old, new in self.replaces.items()
        )
        return replacing if replacing and not self.terms else (*replacing, self.equation())

    def equation(self) -> Equation:
        """The effect as a step of the derivation: the torque (or voltage) it adds, or what it replaces."""
        added = self.terms.get(self.balance, ())
        unit = {"mechanical": "N m", "electrical": "V"}[self.balance]
        if added:
            left, right = sp.Symbol(f"Delta_{self.family}"), sp.Add(*(term.value for term in added))
        else:
            last = self.definitions[-1]
            left, right, unit = last.symbol, last.value, last.quantity.unit
        name = self.id.replace("[", "_").replace("]", "").replace("=", "_")
        return Equation(name, "", left, right, unit, f"Effect {self.id}: {self.formula}. {self.reference}.")

    def _scaled(self, term: Term, balance: str) -> Term:
        if balance != "mechanical" or term.kind != "friction":
            return term
        return replace(term, basis=term.basis * self.scales.get(term.role, 1))


# The order of inputs, as `Model.inputs` wants it; what is not listed comes before alpha_m.
_INPUTS = {
    name: k for k, name in enumerate(("theta_m", "omega_m", "i", "u", "t", "temperature", "", "alpha_m"))
}


def _replaced(old: sp.Symbol) -> str:
    """Name of the equation by which a model remembers that a quantity was replaced."""
    return f"{old.name}_replaced"


def _exact(value: float) -> sp.Rational:
    return sp.Rational(repr(float(value)))


def _start(effect: Effect, q: Quantity) -> float:
    for shape in effect.shapes:
        if shape.quantity == q:
            return (shape.low * shape.high) ** 0.5 if shape.scale == "log" else 0.5 * (shape.low + shape.high)
    return 0.0


def _ordered(
    definitions: list[Definition], inputs: list[Quantity], parameters: list[Quantity], states: list[State]
) -> tuple[Definition, ...]:
    """The definitions, each after those it uses; what can be computed from parameters comes first."""
    known = {q.symbol for q in (*inputs, *parameters, *(s.quantity for s in states))}
    waiting, done = list(definitions), []
    while waiting:
        ready = next((d for d in waiting if d.value.free_symbols <= known), None)
        if ready is None:
            names = ", ".join(d.quantity.name for d in waiting)
            raise ValueError(f"definitions use each other in a circle, or something unknown: {names}")
        waiting.remove(ready)
        done.append(ready)
        known.add(ready.symbol)
    return tuple(done)
