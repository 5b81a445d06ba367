"""An effect: a record that extends a Model by something physical that the paper leaves out.

It may add terms to a balance, replace a quantity, scale friction by its role, and introduce hidden states.
No part of it is a flag in the model: `extend` returns an ordinary Model, which can be extended further and is
emitted by the same code.
"""

from __future__ import annotations

import itertools
import math
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import sympy as sp

from eccentric.core import InputError, asks, run_script
from eccentric.model import AxisKind, Change, Equation, Extension, Model, Parts, Quantity, extended, missing
from eccentric.model import vocabulary as v


@dataclass(frozen=True)
class Setting:
    """The rig and its log, as far as forms and ranges of effects depend on them.

    Attributes:
        base: the model that the effects extend.
        mu: gear ratio.
        known: value of every known parameter by name, SI units.
        w_min: lowest motor speed that counts as motion [rad/s], positive.
        w_max: highest speed seen [rad/s].
        current_max: largest current seen [A].
        duration_s: length of the log [s].
        mean_loss_W: mean of friction power and R i^2 [W], positive.
        temperature_mid: median of the logged temperature [degC]; None if it is not logged.
        channels: those logged, among "current", "voltage", "temperature".
        friction: coefficients of an earlier fit of that model, by column of its regressor; they determine how
            much of the load on a gear is friction of the link.
        by_voltage: whether voltage alone measures the torque: then resistance and back-EMF constant are not
            separately known, and no current sensor has an effect.
        scaled: whether a declared constant converts to torque: k_i from a current, or R/k_i from a voltage.
        mean_force: mean of F_N [N] where it is an input of the model, as of a joint of an arm; else 0.
        left_open: what the rig leaves to be identified: roles of columns, among others "inertia" and
            "gravity", and keys of the rig's alignment, such as "theta_zero_rad".
        mean_square_A2: mean square of the current [A^2]; 0 where nobody asks for it.
        turns: range of the motor angle over the log, in turns (of a carriage, of its position over 2 pi).
        orders: periods per turn of the motor that stand out in what a first fit leaves, the strongest first.
        lines: whole orders of the motor above 24 that stand out of the drive as logged, the strongest first.
        masses: whether runs carry different known masses: their difference is in newton metres for certain.

    Raises:
        ValueError: a range is not positive.
    """

    base: Model = field(repr=False)
    mu: float
    known: Mapping[str, float]
    w_min: float
    w_max: float
    current_max: float
    duration_s: float
    mean_loss_W: float
    temperature_mid: float | None = None
    channels: frozenset[str] = frozenset({"current", "voltage"})
    friction: Mapping[str, float] = field(default_factory=dict)
    by_voltage: bool = False
    scaled: bool = True
    left_open: tuple[str, ...] = ()
    mean_force: float = 0.0
    mean_square_A2: float = 0.0
    turns: float = 0.0
    orders: tuple[float, ...] = ()
    masses: bool = False
    lines: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        for name in ("mu", "w_min", "w_max", "current_max", "duration_s", "mean_loss_W"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"setting: {name}: expected a value above 0, got {getattr(self, name)}")

    @property
    def case(self) -> str:
        """The case of the base model: "C1" if gravity does not drive it, else "C2"."""
        return "C1" if self.base.balance("mechanical").sum_of("gravity") == 0 else "C2"

    @property
    def link_radian(self) -> str:
        """The unit of an angle of the link, or of the screw of a carriage, which is never one of length."""
        return "rad" if self.base.axis.wraps else "radian"

    @property
    def has_link(self) -> bool:
        """Whether the motor may turn a link: not without an imbalance and a mass of the link."""
        known = self.known
        return 0.0 not in (known.get("M"), known.get("L")) or known.get("M_l", 0.0) > 0.0

    @property
    def measured_twice(self) -> bool:
        """Whether the circuit is a balance of its own: a voltage beside the measured current."""
        return self.has("current", "voltage") and not self.by_voltage

    def has(self, *channels: str) -> bool:
        """Whether all of these channels are logged."""
        return set(channels) <= self.channels


@dataclass(frozen=True)
class Kin:
    """Families that follow the same variable, so that one log may not distinguish them.

    Attributes:
        name: of the variable.
        tell_apart: what separates a family of this kin from one of the named kin, or its own: one sentence.
    """

    name: str
    tell_apart: Mapping[str, str]


TIME = Kin("time", {"time": "Log three times as long, with rests, to separate time from distance travelled."})
TEMPERATURE = Kin(
    "temperature",
    {
        "temperature": "Alternate slow and fast speeds over a ramp of 20 K or more.",
        "time": "Repeat the same speeds warm and cooled down, with the temperature logged.",
    },
)
SPEED = Kin(
    "speed",
    {"speed": "Add constant speeds at twice the present range and at its lower end, in both directions."},
)
LOAD = Kin("load", {"load": "Accelerate hard at several speeds, then repeat with another mass on the link."})
GRAVITY = Kin(
    "gravity", {"gravity": "Hold slow speeds over whole turns in both directions, with two masses."}
)


@dataclass(frozen=True)
class PossibleCause:
    """What may be behind an effect whose headline says what it does.

    Attributes:
        name: a noun phrase.
        only_with: the parts that a drive needs for it, as in `Effect`.
    """

    name: str
    only_with: Parts = field(default_factory=dict)


@dataclass(frozen=True)
class Words:
    """What a person reads about an effect.

    Attributes:
        headline: a noun phrase that continues "Missing: ...": "friction that varies
            twice per turn of the link"; "" for an effect that is known by its id only.
        title: a heading for the family, where its effects have headlines of their own.
        meaning: what the family is and where it comes from, one sentence.
        hint: what to measure to separate it from others, as a noun phrase or an instruction.
        kin: families that follow the same variable; None for one that has no kin.
        causes: what may be behind an effect whose headline says what it does, not where it comes from.
        tell_apart: family, or name of a kin -> the measurement that separates the effect from it, one
            sentence; it takes precedence over the kin's.
    """

    headline: str = ""
    title: str = ""
    meaning: str = ""
    hint: str = ""
    causes: tuple[PossibleCause, ...] = ()
    kin: Kin | None = None
    tell_apart: Mapping[str, str] = field(default_factory=dict)


def measurement_between(first: tuple[str, Words], second: tuple[str, Words]) -> str:
    """The measurement that separates two families, each with its words; "" if neither knows one.

    What a family says of the other family takes precedence over what it says of the other's kin, and that
    over what the kins say of each other.
    """
    pairs = ((first, second), (second, first))
    own = [own.tell_apart.get(other) for (_, own), (other, _) in pairs]
    of_kin = [own.tell_apart.get(other.kin.name) for (_, own), (_, other) in pairs if other.kin]
    kins = [own.kin.tell_apart.get(other.kin.name) for (_, own), (_, other) in pairs if own.kin and other.kin]
    return next(filter(None, [*own, *of_kin, *kins]), "")


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
        covers: families that do what its headline says as well: where a log does not tell them apart, this is
            the name of all.
    """

    depends_on: tuple[str, ...]
    needs: tuple[str, ...] = ()
    aliases: tuple[str, ...] = ()
    special_of: tuple[str, ...] = ()
    repeats: bool = False
    second_order: tuple[str, ...] = ()
    one_of: int = 1
    covers: tuple[str, ...] = ()


@dataclass(frozen=True)
class Plausible:
    """What is known from elsewhere of a parameter of an effect, or of a figure that follows from several.

    Attributes:
        value: the figure, in parameters of the effect and of the model it extends.
        unit: of the figure; it need not be one of SI: "%/K".
        low, high: range that the source gives; without an end if only drives with some parts have a range.
        source: author, maker or standard; title; year.
        name: the figure as a noun phrase: "the temperature coefficient of the resistance".
        usual: its usual value, None where there is none, and `whose` that is: "copper's".
        above, below: what a value beyond an end of the range says, as in "not the winding alone"; "" if it
            says no more than that.
        by_part: words of the rig's parts -> a narrower (low, high, source), for drives that have that part.
    """

    value: sp.Expr
    unit: str
    low: float
    high: float
    source: str
    name: str
    usual: float | None = None
    whose: str = ""
    above: str = ""
    below: str = ""
    by_part: Mapping[str, tuple[float, float, str]] = field(default_factory=dict)

    def for_parts(self, parts: Parts) -> Plausible:
        """The same for a drive that has these parts: of several parts the widest of their ranges."""
        words = [word for given in parts.values() for word in given]
        own = [self.by_part[word] for word in words if word in self.by_part]
        if not own:
            return self
        lows, highs, sources = zip(*own, strict=True)
        return replace(self, low=min(lows), high=max(highs), source="; ".join(dict.fromkeys(sources)))


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
        only_with: kind of part -> words of `eccentric.model.DRIVE_PARTS`: only a drive with one of them, or
            whose rig says nothing of that kind, can have the effect.
        plausible: ranges that its parameters are known to have, each with its source.
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
    only_with: Parts = field(default_factory=dict)
    plausible: tuple[Plausible, ...] = ()

    def lacks(self, parts: Parts) -> dict[str, tuple[str, ...]]:
        """Kind -> the parts one of which the effect needs and a drive of these parts has not; {} if none."""
        return missing(self.only_with, parts)

    def periods_seen(self, setting: Setting) -> float:
        """How many of its longest periods the log of a setting travels; infinite if it has none."""
        names = [shape.quantity.name for shape in self.shapes]
        ends = itertools.product(*((shape.low, shape.high) for shape in self.shapes))
        rates = (self.per_turn(setting.mu, dict(zip(names, one, strict=True))) for one in ends)
        longest = min(rates)
        return longest * setting.turns if math.isfinite(longest) else math.inf

    def per_turn(self, mu: float, shapes: Mapping[str, float]) -> float:
        """Its longest period as periods per turn of the motor, for these shapes; infinite if it has none."""
        at = {v.mu.symbol: mu} | {shape.quantity.symbol: shapes[shape.quantity.name] for shape in self.shapes}
        rates = {term.per_turn for terms in self.change.terms.values() for term in terms} - {0}
        return min((float(sp.sympify(x).subs(at)) for x in rates), default=math.inf)

    def told_for(self, axis: AxisKind) -> Effect:
        """The effect with its words and its formula for an axis; its physics is the same."""
        if not axis.words:
            return self
        own = self.words
        apart = {other: axis.text(text) for other, text in own.tell_apart.items()}
        named = {name: axis.text(getattr(own, name)) for name in ("headline", "title", "meaning", "hint")}
        causes = tuple(replace(cause, name=axis.text(cause.name)) for cause in own.causes)
        words = replace(own, tell_apart=apart, causes=causes, **named)
        return replace(self, formula=axis.text(self.formula), words=words)

    @property
    def id(self) -> str:
        """Its name in reports, e.g. "link_harmonic_friction[n=3]"."""
        return f"{self.family}[{self.variant}]" if self.variant else self.family

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


def load_effects(path: str | Path, setting: Setting) -> tuple[Effect, ...]:
    """The effects of a script: what its `effects(setting)` returns, or its module-level `effect`.

    Raises:
        InputError: there is no such script, it raises an error, or it has neither name with the right type.
    """
    path = Path(path)
    if path.suffix != ".py" or not path.is_file():
        raise InputError(path, problem="no such script of effects (.py)")
    name = f"eccentric_effects_{path.stem}"
    asks(str(path), path.resolve())
    try:
        module = run_script(path.resolve(), name)
        made = getattr(module, "effects", None)
        found = made(setting) if callable(made) else getattr(module, "effect", None)
        found = (found,) if isinstance(found, Effect) else found
        effects = tuple(found) if isinstance(found, Iterable) else None
    except InputError:
        raise
    except Exception as error:
        raise InputError(path, problem=f"the effects stopped with {type(error).__name__}: {error}") from error
    finally:
        sys.modules.pop(name, None)
    if effects is None:
        raise InputError(
            path, "a function `effects(setting)` or an `effect` of type Effect", type(found).__name__
        )
    if wrong := [type(one).__name__ for one in effects if not isinstance(one, Effect)]:
        raise InputError(path, "effects of type Effect", wrong[0])
    return effects
