"""Models: inputs, parameters, definitions, balances and the equations of their derivation. Immutable."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import sympy as sp

from eccentric.core import InputError
from eccentric.model.axis import TURNING, AxisKind, in_letters_of, spoken_equation, spoken_quantity
from eccentric.model.balance import Balance, Role, Term
from eccentric.model.equation import Equation, equation_named
from eccentric.model.output import Interface
from eccentric.model.quantity import Definition, Quantity, State
from eccentric.model.steps import meaning
from eccentric.model.vocabulary import alpha_m, i, phi

# Changes of a model: terms to add, quantities to replace, friction to scale.


@dataclass(frozen=True)
class Change:
    """A change of a model.

    Attributes:
        terms: name of balance -> terms added to it; a coefficient may enter both balances.
        definitions: quantities that it introduces, each after those it uses.
        states: hidden states that it introduces.
        inputs: inputs that it uses, from the vocabulary; the model may already have some of them.
        replaces: symbol of the model -> symbol of one of `definitions`, to be used in its place.
        scales: role -> symbol of one of `definitions` that multiplies the friction terms of that role.
    """

    terms: Mapping[str, tuple[Term, ...]] = field(default_factory=dict)
    definitions: tuple[Definition, ...] = ()
    states: tuple[State, ...] = ()
    inputs: tuple[Quantity, ...] = ()
    replaces: Mapping[sp.Symbol, sp.Symbol] = field(default_factory=dict)
    scales: Mapping[Role, sp.Symbol] = field(default_factory=dict)

    def reach_term(self, term: Term) -> Term:
        """A term from elsewhere under the rules of this change."""
        basis = term.basis * self.scales[term.role] if term.role in self.scales else term.basis
        coefficient, basis = (part.xreplace(dict(self.replaces)) for part in (term.coefficient, basis))
        return replace(term, coefficient=coefficient, basis=basis)

    def reach_definition(self, definition: Definition) -> Definition:
        """A definition from elsewhere under the rules of this change."""
        return replace(definition, value=definition.value.xreplace(dict(self.replaces)))

    def reach_state(self, state: State) -> State:
        """A hidden state from elsewhere under the rules of this change."""
        return replace(state, update=state.update.xreplace(dict(self.replaces)))


@dataclass(frozen=True)
class Extension:
    """A change with its name, its parameters and its steps in the derivation.

    Attributes:
        name: in messages.
        change: what it changes.
        parameters: those that it introduces, with their defaults.
        equations: its steps in the derivation.
    """

    name: str
    change: Change
    parameters: tuple[Quantity, ...] = ()
    equations: tuple[Equation, ...] = ()

    @property
    def names(self) -> frozenset[str]:
        """Names of the parameters, definitions and states that it introduces."""
        own = (*self.change.definitions, *self.change.states)
        return frozenset(q.name for q in (*self.parameters, *(x.quantity for x in own)))


@dataclass(frozen=True)
class Model:
    """The result of a derivation, and the input of emission.

    Attributes:
        name: in code; equals the stem of the derivation.
        title: one line.
        inputs: motor-side inputs; theta_m and omega_m first, alpha_m last.
        parameters: in the order in which code lists them.
        definitions: quantities that follow from others, each after those it uses.
        balances: mechanical and electrical.
        equations: the derivation, in reading order.
        states: hidden states that effects introduced; the paper's models have none.
        defaults: origin of the parameters' defaults, in words; "" for the quantities' own.
        extensions: those of the model; their rules apply to all further extensions.
        back_emf_in_friction: whether the defaults of viscous friction contain the back-EMF, as estimates from
            a voltage alone do. What needs the friction without it is then not emitted.
        current_known: whether the defaults give a current in amperes. What needs one is else not emitted.
        voltage_known: whether they give a voltage, with R and k_e. What needs one is else not emitted.
        torque_unit: of the defaults: "N m", or "V" or "A" where the log had no scale for a torque.
        caution: what to know before the model is used, such as a choice that its log did not decide.
        fits_the_rig: false if the defaults are of a log that does not fit its rig.
        axis: what moves: the words of all that is written for a person or emitted.
        declares: makes the outputs, the functions that are emitted; None for those of one drive.

    Raises:
        InputError: a definition or term uses a symbol that is neither an input nor a parameter nor defined
            before.
    """

    name: str
    title: str
    inputs: tuple[Quantity, ...]
    parameters: tuple[Quantity, ...]
    definitions: tuple[Definition, ...]
    balances: tuple[Balance, ...]
    equations: tuple[Equation, ...] = ()
    states: tuple[State, ...] = ()
    defaults: str = ""
    extensions: tuple[Extension, ...] = ()
    back_emf_in_friction: bool = False
    current_known: bool = True
    voltage_known: bool = True
    torque_unit: str = "N m"
    caution: str = ""
    fits_the_rig: bool = True
    axis: AxisKind = TURNING
    declares: Callable[[Model], Interface] | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        states = (state.quantity for state in self.states)
        known = {q.symbol for q in (*self.inputs, *self.parameters, *states)}
        for definition in self.definitions:
            if unknown := definition.value.free_symbols - known:
                names = ", ".join(sorted(map(str, unknown)))
                raise InputError(
                    f"model {self.name}",
                    problem=f"{definition.quantity.name} uses {names} before its definition",
                )
            known.add(definition.symbol)
        for balance in self.balances:
            for term in balance.terms:
                if unknown := term.value.free_symbols - known:
                    names = ", ".join(sorted(map(str, unknown)))
                    raise InputError(
                        f"model {self.name}", problem=f"term {term.name} uses {names}, which nothing defines"
                    )

    @property
    def tilted(self) -> bool:
        """Whether the tilt of its motion plane is a parameter."""
        return phi.symbol in {q.symbol for q in self.parameters}

    @cached_property
    def with_other_values(self) -> Model:
        """The same for values that are not its defaults: every function is emitted, by its own letters."""
        plain = {
            "back_emf_in_friction": False,
            "current_known": True,
            "voltage_known": True,
            "torque_unit": "N m",
            "axis": TURNING,
        }
        return self if all(getattr(self, k) == x for k, x in plain.items()) else replace(self, **plain)

    @property
    def cautions(self) -> tuple[str, ...]:
        """What to know before the model is used, each without a full stop; empty for most models."""
        misfit = "" if self.fits_the_rig else "the values are of a log that does not fit its rig"
        return tuple(filter(None, (self.caution, misfit)))

    @property
    def first_function(self) -> str:
        """The emitted function to begin with: the friction, or the drive where that alone has its unit."""
        friction = "friction_torque" if self.back_emf_in_friction else "mechanical_friction_torque"
        return {"V": "voltage", "A": "current"}.get(self.torque_unit, friction)

    @cached_property
    def parameter_symbols(self) -> frozenset[sp.Symbol]:
        """Symbols that depend on parameters only, including definitions."""
        found = {quantity.symbol for quantity in self.parameters}
        for definition in self.definitions:
            if definition.value.free_symbols <= found:
                found.add(definition.symbol)
        return frozenset(found)

    @property
    def replaced(self) -> dict[sp.Symbol, sp.Symbol]:
        """Symbol -> its replacement by an extension."""
        return {old: now for e in self.extensions for old, now in e.change.replaces.items()}

    @cached_property
    def friction_parameters(self) -> tuple[Quantity, ...]:
        """The parameters that friction terms have as coefficients, in the order of the parameters."""
        used = {term.coefficient for term in self.balance("mechanical").terms if term.kind == "friction"}
        return tuple(quantity for quantity in self.parameters if quantity.symbol in used)

    @cached_property
    def inertia(self) -> sp.Expr:
        """The factor of alpha_m in the inertial terms, in parameters: J_m + mu^2 J_l [kg m^2]."""
        return self.expand(sp.diff(self.balance("mechanical").sum_of("inertial"), alpha_m.symbol))

    @property
    def torque_per_volt(self) -> sp.Expr:
        """Torque of the motor at rest for a volt at its armature, k_i/R [N m/V]."""
        drive, resistive = self.balance("mechanical"), self.balance("electrical")
        return sp.diff(drive.sum_of("drive"), i.symbol) / sp.diff(resistive.sum_of("resistive"), i.symbol)

    def balance(self, name: str) -> Balance:
        """The balance of that name; InputError if there is none, as in a chain of several joints."""
        found = {balance.name: balance for balance in self.balances}
        if name not in found:
            raise InputError(
                f"model {self.name}", f"a {name} balance of one drive", ", ".join(found) or "none"
            )
        return found[name]

    def definition(self, name: str) -> Definition:
        """The definition of the quantity of that name; KeyError if there is none."""
        return {definition.quantity.name: definition for definition in self.definitions}[name]

    def equation(self, name: str) -> Equation:
        """The equation of that name; KeyError if there is none."""
        return equation_named(self.equations, name)

    def expand(self, expression: sp.Expr) -> sp.Expr:
        """The expression with all definitions substituted, in inputs and parameters only."""
        for definition in reversed(self.definitions):
            expression = expression.xreplace({definition.symbol: definition.value})
        return expression

    def value(self, expression: sp.Expr, values: Mapping[str, float]) -> float:
        """The number that an expression evaluates to.

        Args:
            expression: in parameters, definitions and inputs.
            values: parameter or input by name -> value in SI units.

        Raises:
            KeyError: a value that it needs is missing.
        """
        plain = meaning(self.expand(expression))
        return float(plain.xreplace({symbol: sp.Float(values[symbol.name]) for symbol in plain.free_symbols}))

    def units(self) -> dict[sp.Symbol, str]:
        """The unit of every symbol of the model."""
        named = (*self.inputs, *self.parameters, *(d.quantity for d in self.definitions))
        named = (*named, *(state.quantity for state in self.states))
        return {quantity.symbol: quantity.unit for quantity in named}

    def __str__(self) -> str:
        """The derivation for a terminal, equation by equation."""
        heading = f"{self.title}\n{'=' * len(self.title)}"
        return "\n\n".join([heading, *(spoken_equation(self.axis, e).text() for e in self.equations)])

    def latex(self) -> str:
        """The derivation in LaTeX, equation by equation."""
        return "\n\n".join(
            [rf"\section*{{{self.title}}}", *(spoken_equation(self.axis, e).latex() for e in self.equations)]
        )


# A model in the words of its axis: letters, units and meanings, for whoever reads it.


def spoken(model: Model) -> Model:
    """The same model in the words of its axis; nothing computes with it."""
    axis = model.axis
    if axis is TURNING:
        return model
    put = in_letters_of(axis)

    def quantity(q: Quantity) -> Quantity:
        return spoken_quantity(axis, q)

    return replace(
        model,
        title=axis.text(model.title),
        inputs=tuple(map(quantity, model.inputs)),
        parameters=tuple(map(quantity, model.parameters)),
        definitions=tuple(
            Definition(quantity(definition.quantity), put(definition.value))
            for definition in model.definitions
        ),
        balances=tuple(
            replace(
                balance,
                unit=axis.unit(balance.unit),
                terms=tuple(
                    replace(term, coefficient=put(term.coefficient), basis=put(term.basis))
                    for term in balance.terms
                ),
            )
            for balance in model.balances
        ),
        equations=tuple(spoken_equation(axis, equation) for equation in model.equations),
        states=tuple(
            replace(
                state,
                quantity=quantity(state.quantity),
                initial=put(state.initial),
                update=put(state.update),
            )
            for state in model.states
        ),
        extensions=(),
        axis=TURNING,
    )
