"""Models: inputs, parameters, definitions, balances and the equations of their derivation. Immutable."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import sympy as sp

from eccentric.core import InputError
from eccentric.model import vocabulary as v
from eccentric.model.axis import TURNING, AxisKind, in_letters_of, spoken_equation, spoken_quantity
from eccentric.model.balance import Balance, Equation, Role, Term, equation_named
from eccentric.model.output import Interface
from eccentric.model.quantity import Definition, Quantity, State
from eccentric.model.steps import meaning


@dataclass(frozen=True)
class Change:
    """A change of a model.

    Attributes:
        terms: name of balance -> terms added to it; a coefficient may enter both balances.
        definitions: quantities that it introduces, each after those it uses.
        states: hidden states that it introduces.
        inputs: inputs that it uses, from the vocabulary; the model may already have some.
        replaces: symbol of the model -> symbol of one of `definitions` that replaces it.
        scales: role -> symbol of one of `definitions` that multiplies the friction terms of that role.
    """

    terms: Mapping[str, tuple[Term, ...]] = field(default_factory=dict)
    definitions: tuple[Definition, ...] = ()
    states: tuple[State, ...] = ()
    inputs: tuple[Quantity, ...] = ()
    replaces: Mapping[sp.Symbol, sp.Symbol] = field(default_factory=dict)
    scales: Mapping[Role, sp.Symbol] = field(default_factory=dict)

    def reach_term(self, term: Term) -> Term:
        """Apply replacements and scales to a term of the model or of another change."""
        basis = term.basis * self.scales[term.role] if term.role in self.scales else term.basis
        coefficient, basis = (part.xreplace(dict(self.replaces)) for part in (term.coefficient, basis))
        return replace(term, coefficient=coefficient, basis=basis)

    def reach_definition(self, definition: Definition) -> Definition:
        """Apply replacements to a definition of the model or of another change."""
        return replace(definition, value=definition.value.xreplace(dict(self.replaces)))

    def reach_state(self, state: State) -> State:
        """Apply replacements to a hidden state of the model or of another change."""
        return replace(state, update=state.update.xreplace(dict(self.replaces)))


@dataclass(frozen=True)
class Extension:
    """A change with its name, parameters and derivation.

    Attributes:
        name: in messages.
        change: the change of the model.
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
        introduced = (*self.change.definitions, *self.change.states)
        return frozenset(q.name for q in (*self.parameters, *(x.quantity for x in introduced)))


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
            a voltage alone do. Functions that need friction without it are then not emitted.
        current_known: whether the defaults determine a current in amperes; if not, functions that need one
            are not emitted.
        voltage_known: whether they determine a voltage, with R and k_e; if not, functions that need one are
            not emitted.
        torque_unit: of the defaults: "N m", or "V" or "A" if the log had no torque scale.
        caution: a warning for users of the model, such as a choice that its log did not decide.
        fits_the_rig: false if the defaults come from a log that does not fit its rig.
        axis: the kind of axis, whose names and terms are printed and emitted.
        declares: creates the outputs (the emitted functions); None for those of a single drive.

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
            self._require(known, definition.value, definition.quantity.name, " before its definition")
            known.add(definition.symbol)
        for balance in self.balances:
            for term in balance.terms:
                self._require(known, term.value, f"term {term.name}", ", which nothing defines")

    def _require(self, known: set[sp.Symbol], value: sp.Expr, whose: str, why: str) -> None:
        if unknown := ", ".join(sorted(map(str, value.free_symbols - known))):
            raise InputError(f"model {self.name}", problem=f"{whose} uses {unknown}{why}")

    @property
    def tilted(self) -> bool:
        """Whether the tilt of its motion plane is a parameter."""
        return v.phi.symbol in {q.symbol for q in self.parameters}

    @cached_property
    def with_other_values(self) -> Model:
        """The model for values other than its defaults: all functions, with the symbols of a rotary drive."""
        reset = {
            "back_emf_in_friction": False,
            "current_known": True,
            "voltage_known": True,
            "torque_unit": "N m",
            "axis": TURNING,
        }
        return self if all(getattr(self, k) == x for k, x in reset.items()) else replace(self, **reset)

    @property
    def cautions(self) -> tuple[str, ...]:
        """Warnings for users of the model, without full stops; empty for most models."""
        misfit = "" if self.fits_the_rig else "the values are of a log that does not fit its rig"
        return tuple(filter(None, (self.caution, misfit)))

    @property
    def first_function(self) -> str:
        """The emitted function to start with: friction, or voltage or current if torque has no scale."""
        friction = "friction_torque" if self.back_emf_in_friction else "mechanical_friction_torque"
        return {"V": "voltage", "A": "current"}.get(self.torque_unit, friction)

    @cached_property
    def parameter_symbols(self) -> frozenset[sp.Symbol]:
        """Symbols that depend on parameters only, including definitions."""
        symbols = {quantity.symbol for quantity in self.parameters}
        for definition in self.definitions:
            if definition.value.free_symbols <= symbols:
                symbols.add(definition.symbol)
        return frozenset(symbols)

    @property
    def replaced(self) -> dict[sp.Symbol, sp.Symbol]:
        """Symbol -> its replacement by an extension."""
        return {old: now for e in self.extensions for old, now in e.change.replaces.items()}

    @cached_property
    def friction_parameters(self) -> tuple[Quantity, ...]:
        """The coefficients of friction terms, in the order of the parameters."""
        used = {term.coefficient for term in self.balance("mechanical").terms if term.kind == "friction"}
        return tuple(quantity for quantity in self.parameters if quantity.symbol in used)

    @cached_property
    def inertia(self) -> sp.Expr:
        """The factor of alpha_m in the inertial terms, in parameters: J_m + mu^2 J_l [kg m^2]."""
        return self.expand(sp.diff(self.balance("mechanical").sum_of("inertial"), v.alpha_m.symbol))

    @property
    def torque_per_volt(self) -> sp.Expr:
        """Stall torque per volt of armature voltage, k_i/R [N m/V]."""
        drive, resistive = self.balance("mechanical"), self.balance("electrical")
        return sp.diff(drive.sum_of("drive"), v.i.symbol) / sp.diff(resistive.sum_of("resistive"), v.i.symbol)

    def balance(self, name: str) -> Balance:
        """The balance of that name; InputError if there is none, as in a chain of several joints."""
        by_name = {balance.name: balance for balance in self.balances}
        if name not in by_name:
            raise InputError(
                f"model {self.name}", f"a {name} balance of one drive", ", ".join(by_name) or "none"
            )
        return by_name[name]

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


# Extensions: changes of a model, independent of their order.
#
# A change adds terms, replaces quantities and scales friction. Addition commutes. Replacing and scaling are
# rules rather than single operations: the model stores them and also applies them to whatever later
# extensions add. Hence the order of extensions makes no difference:
#
# - a scale factor multiplies every friction term of its role, including those of other extensions;
# - a quantity is replaced everywhere, including in the terms, definitions and states of other extensions;
# - an extension's own parts are taken as written: M_true = M (1 + r) keeps its M.
#
# Two extensions that introduce the same name, or replace the same quantity, are refused.
def extended(model: Model, new: Extension) -> Model:
    """Add an extension to a model; the order of several makes no difference.

    Raises:
        InputError: the model already has this extension, or one that introduces the same name or replaces the
            same quantity; it lacks a quantity to replace or a balance to add terms to; or definitions would
            use each other in a circle.
    """
    _require_free_names(model, new)
    _require_replaceable(model, new)
    if unknown := sorted(set(new.change.terms) - {balance.name for balance in model.balances}):
        raise InputError(new.name, problem=f"expected a balance {unknown[0]!r}, but {model.name} has none")
    definitions, states, terms = new.change.definitions, new.change.states, dict(new.change.terms)
    for earlier in (extension.change for extension in model.extensions):
        definitions = tuple(map(earlier.reach_definition, definitions))
        states = tuple(map(earlier.reach_state, states))
        terms = {name: tuple(map(earlier.reach_term, added)) for name, added in terms.items()}
    inputs = sorted({q.symbol: q for q in (*new.change.inputs, *model.inputs)}.values(), key=_place)
    parameters = (*model.parameters, *new.parameters)
    states = (*map(new.change.reach_state, model.states), *states)
    definitions = (*definitions, *map(new.change.reach_definition, model.definitions))
    known = {q.symbol for q in (*inputs, *parameters, *(state.quantity for state in states))}
    names = " and ".join(sorted(e.name for e in (*model.extensions, new)))
    return replace(
        model,
        inputs=tuple(inputs),
        parameters=parameters,
        definitions=_ordered(definitions, known, f"{model.name} with {names}"),
        balances=tuple(_balance(b, new.change, terms.get(b.name, ())) for b in model.balances),
        states=states,
        equations=(*model.equations, *new.equations),
        extensions=(*model.extensions, new),
    )


def _balance(balance: Balance, change: Change, added: Iterable[Term]) -> Balance:
    return replace(balance, terms=(*map(change.reach_term, balance.terms), *added))


def _require_free_names(model: Model, new: Extension) -> None:
    for other in model.extensions:
        if other.name == new.name:
            raise InputError(new.name, problem=f"is already in {model.name}")
        if both := sorted(other.names & new.names):
            first, second = sorted((other.name, new.name))
            raise InputError(f"{first} and {second}", problem=f"both introduce {', '.join(both)}")
    defined = (x.quantity for x in (*model.definitions, *model.states))
    taken = {q.name for q in (*model.parameters, *model.inputs, *defined)}
    if clash := sorted(new.names & taken):
        raise InputError(
            new.name, problem=f"{', '.join(clash)}: {model.name} already has a quantity of that name"
        )


def _require_replaceable(model: Model, new: Extension) -> None:
    for other in model.extensions:
        if both := sorted(map(str, set(other.change.replaces) & set(new.change.replaces))):
            first, second = sorted((other.name, new.name))
            raise InputError(f"{first} and {second}", problem=f"both replace {', '.join(both)}")
    brought = {name for extension in model.extensions for name in extension.names}
    added = {term.name for e in model.extensions for terms in e.change.terms.values() for term in terms}
    used = set().union(
        *(d.value.free_symbols for d in model.definitions if d.quantity.name not in brought),
        *(t.value.free_symbols for b in model.balances for t in b.terms if t.name not in added),
    )
    if absent := sorted(map(str, set(new.change.replaces) - used)):
        raise InputError(new.name, problem=f"{absent[0]} does not occur in {model.name}")


_INPUTS = (v.theta_m, v.omega_m, v.i, v.u, v.t, v.temperature)


def _place(quantity: Quantity) -> int:
    """Sort key of an input: as in the vocabulary, alpha_m last."""
    if quantity.symbol == v.alpha_m.symbol:
        return len(_INPUTS) + 1
    known = [q.symbol for q in _INPUTS]
    return known.index(quantity.symbol) if quantity.symbol in known else len(_INPUTS)


def _ordered(definitions: Iterable[Definition], known: set[sp.Symbol], whose: str) -> tuple[Definition, ...]:
    """The definitions, each after those it uses."""
    pending, done = list(definitions), []
    while pending:
        ready = next((d for d in pending if d.value.free_symbols <= known), None)
        if ready is None:
            names = ", ".join(sorted(d.quantity.name for d in pending))
            raise InputError(whose, problem=f"{names} use each other in a circle, or something unknown")
        pending.remove(ready)
        done.append(ready)
        known.add(ready.symbol)
    return tuple(done)


def spoken(model: Model) -> Model:
    """The model with the symbols, units and terms of its axis; for display only."""
    axis = model.axis
    if axis is TURNING:
        return model
    put = in_letters_of(axis)

    def quantity(q: Quantity) -> Quantity:
        return spoken_quantity(axis, q)

    definitions = [Definition(quantity(d.quantity), put(d.value)) for d in model.definitions]
    states = [State(quantity(x.quantity), put(x.initial), put(x.update)) for x in model.states]
    balances = [
        Balance(
            b.name,
            axis.unit(b.unit),
            tuple(replace(t, coefficient=put(t.coefficient), basis=put(t.basis)) for t in b.terms),
        )
        for b in model.balances
    ]
    return replace(
        model,
        title=axis.text(model.title),
        inputs=tuple(map(quantity, model.inputs)),
        parameters=tuple(map(quantity, model.parameters)),
        definitions=tuple(definitions),
        balances=tuple(balances),
        equations=tuple(spoken_equation(axis, equation) for equation in model.equations),
        states=tuple(states),
        extensions=(),
        axis=TURNING,
    )
