"""A term without a cause: B-splines over one variable or two, for what no effect of the library explains.

Its friction is c(x) sgn w with c a sum of quadratic B-splines whose coefficients are not negative, so that
it never drives, whatever they are; beyond its knots c is constant. What is the same in both directions is a
torque over an angle, of zero mean over a turn, which does no work over one. It is no family of the library:
nothing offers it to a search for causes, and its id says which variables it follows, never why.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.effects.effect import Effect, Setting, Words
from eccentric.effects.forms import Column, addition, direction, gravity, omega_m, speed, theta_m, transmitted
from eccentric.model import Backward, Bump, Clipped, Definition, Forward, FromTop, Quantity, Role, quantity
from eccentric.model import vocabulary as v

Array = NDArray[np.float64]

FAMILY = "empirical"
REFERENCE = (
    "C. de Boor, A Practical Guide to Splines, Springer 1978; P. H. C. Eilers and B. D. Marx, Statistical"
    " Science 11(2), 1996"
)
ANGLES = frozenset({"link_angle", "motor_angle"})
"""Variables over which a curve is periodic."""


@dataclass(frozen=True)
class Curve:
    """A function of one variable: where its knots are.

    Attributes:
        variable: "velocity" (the speed |w|), "gravity_load", "transmitted_torque" (the size of it),
            "temperature", "link_angle" or "motor_angle".
        pieces: number of intervals between knots, 3 or more over an angle.
        low, high: first and last knot, in the unit of the variable; over an angle a turn, whatever they are.
        bend: knots are even in x/(x + bend), closer to each other at small x; 0 for even ones.
        each_way: whether both directions of motion have coefficients of their own.
        conservative: whether it is the torque that is the same in both directions, not friction.
        kept: B-splines whose coefficient is not zero, by number; all if None.
    """

    variable: str
    pieces: int
    low: float = 0.0
    high: float = 0.0
    bend: float = 0.0
    each_way: bool = False
    conservative: bool = False
    kept: tuple[int, ...] | None = None

    @property
    def periodic(self) -> bool:
        """Whether it closes over a turn."""
        return self.variable in ANGLES

    @property
    def width(self) -> int:
        """Number of B-splines, of one direction."""
        return self.pieces if self.periodic else self.pieces + 2

    @property
    def numbers(self) -> tuple[int, ...]:
        """The B-splines that it has; from `width` on those of the other direction."""
        return self.kept if self.kept is not None else tuple(range(self.width * (1 + self.each_way)))

    @property
    def middle(self) -> float:
        """The middle of its knots, of the variable as it is bent."""
        return 0.5 * (self._bent(self.low) + self._bent(self.high))

    @property
    def step(self) -> float:
        """From one knot to the next, of the variable as it is bent."""
        return (self._bent(self.high) - self._bent(self.low)) / self.pieces

    def _bent(self, x: float) -> float:
        return x / (x + self.bend) if self.bend else x

    @property
    def knots(self) -> tuple[float, ...]:
        """Ends of its pieces, in the unit of the variable; of an angle in rad, 0 at the bottom."""
        if self.periodic:
            return tuple(2.0 * np.pi * k / self.pieces for k in range(self.pieces + 1))
        bent = self.middle + self.step * (np.arange(self.pieces + 1) - 0.5 * self.pieces)
        return tuple(float(y * self.bend / (1.0 - y)) if self.bend else float(y) for y in bent)

    def _centres(self, number: int) -> list[sp.Rational]:
        """Where the B-spline of this number is, in pieces; over an angle with its images a turn away."""
        number %= self.width
        half = sp.Rational(self.pieces, 2)
        if not self.periodic:
            return [number - half - sp.Rational(1, 2)]
        images = (number - half + turn * self.pieces for turn in (-1, 0, 1))
        return [centre for centre in images if abs(centre) < half + sp.Rational(3, 2)]

    def place(self, x: Array) -> Array:
        """Values of the variable (n,), an angle in rad from the bottom, in pieces from the middle."""
        if self.periodic:
            turned = x / (2.0 * np.pi) - 0.5
            return self.pieces * (turned - np.round(turned))
        bent = x / (x + self.bend) if self.bend else x
        return np.clip((bent - self.middle) / self.step, -0.5 * self.pieces, 0.5 * self.pieces)

    def columns(self, x: Array, omega: Array) -> Array:
        """Torque per coefficient (n, k) at values of the variable and the motor velocity (n,)."""
        place, sign = self.place(x), np.sign(omega)
        found = []
        for number in self.numbers:
            value = sum(_bump(place - float(centre)) for centre in self._centres(number))
            if self.conservative:
                found.append(value - 1.0 / self.pieces)
            elif self.each_way:
                way = 1.0 if number < self.width else -1.0
                found.append(value * np.where(sign == way, way, 0.0))
            else:
                found.append(value * sign)
        return np.column_stack(found)

    def basis(self, place: sp.Symbol, number: int) -> sp.Expr:
        """The same of one coefficient, as an expression in the place."""
        value = sp.Add(*(Bump(place - centre) for centre in self._centres(number)))
        if self.conservative:
            return value - sp.Rational(1, self.pieces)
        if self.each_way:
            return value * (Forward(omega_m) if number < self.width else -Backward(omega_m))
        return value * direction


def _bump(x: Array) -> Array:
    size = np.abs(x)
    inner, outer = np.maximum(0.0, 0.5 - size), np.maximum(0.0, 1.5 - size)
    return 0.5 * outer**2 - 1.5 * inner**2


@dataclass(frozen=True)
class Variable:
    """What a curve may follow: expression, unit and words, and the definitions and inputs that it needs."""

    expression: sp.Expr
    unit: str
    meaning: str
    definitions: tuple[Definition, ...] = ()
    inputs: tuple[Quantity, ...] = ()


def variable_of(name: str, setting: Setting, prefix: str = FAMILY) -> Variable:
    """The variable of that name; names of constants begin with `prefix`.

    Raises:
        KeyError: there is none.
    """
    if name == "transmitted_torque":
        value, definitions = transmitted(prefix, setting, sp.Integer(0))
        return Variable(sp.Abs(value), "N m", "torque that the gear transmits, motor side", definitions)
    return {
        "velocity": Variable(speed, "rad/s", "speed of the motor"),
        "gravity_load": Variable(gravity(setting), "N m", "gravity torque, motor side"),
        "link_angle": Variable(
            v.mu.symbol * theta_m, "rad", "angle of the link, 0 at the bottom", inputs=(v.theta_m,)
        ),
        "motor_angle": Variable(theta_m, "rad", "angle of the motor", inputs=(v.theta_m,)),
        "temperature": Variable(v.temperature.symbol, "K", "temperature", inputs=(v.temperature,)),
    }[name]


def empirical_term(setting: Setting, curves: Sequence[Curve]) -> Effect:
    """The sum of curves as an effect; its id names their variables."""
    columns: list[Column] = []
    roles: list[Role] = []
    definitions: list[Definition] = []
    inputs: list[Quantity] = []
    said = []
    for k, curve in enumerate(curves, 1):
        prefix = f"{FAMILY}_{k}"
        own = variable_of(curve.variable, setting, prefix)
        place, needed = _place(prefix, curve, own)
        definitions += [*own.definitions, *needed]
        inputs += own.inputs
        for number in curve.numbers:
            way = "" if not curve.each_way else ", forwards" if number < curve.width else ", backwards"
            q = quantity(
                f"{prefix}_{number}",
                "N m",
                f"coefficient {number % curve.width} of the curve over the {own.meaning}{way}",
                "",
                "real" if curve.conservative else "nonnegative",
                letter=f"c_{number}",
            )
            columns.append((q, curve.basis(place, number)))
            roles.append(Role.NONE if curve.conservative else Role.COULOMB)
        said.append(f"c(x_{k}){'' if curve.conservative else ' sgn w'}, x_{k} the {own.meaning}")
    names = tuple(dict.fromkeys(curve.variable for curve in curves))
    return addition(
        FAMILY,
        columns,
        variant=",".join(names),
        role=roles,
        kind="conservative",
        depends_on=names,
        formula=" + ".join(said),
        reference=REFERENCE,
        definitions=tuple(definitions),
        inputs=tuple(dict.fromkeys(inputs)),
        words=Words(headline="a term without a cause", title="A term without a cause"),
    )


def _place(prefix: str, curve: Curve, of: Variable) -> tuple[sp.Symbol, tuple[Definition, ...]]:
    """The place of the variable among the knots, and the definitions that it needs."""
    place = quantity(f"{prefix}_x", "1", f"place among the knots over the {of.meaning}", letter="x")
    if curve.periodic:
        rate = v.mu.symbol if curve.variable == "link_angle" else sp.Integer(1)
        turned = FromTop(theta_m, rate) * rate * _number(curve.pieces / (2.0 * np.pi))
        return place.symbol, (Definition(place, turned),)
    bent = of.expression / (of.expression + _number(curve.bend)) if curve.bend else of.expression
    per_unit = 1.0 / curve.step
    end = sp.Rational(curve.pieces, 2)
    value = Clipped(_number(per_unit) * bent - _number(per_unit * curve.middle), -end, end)
    return place.symbol, (Definition(place, value),)


def _number(x: float) -> sp.Rational:
    return sp.Rational(repr(float(x)))
