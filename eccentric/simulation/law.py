"""What moves a drive, as functions of its state: other torques, the levels of dry friction, the damping.

The expressions are those that `friction_step` is emitted from.  They are evaluated here and not by the
emitted module, whose parameters are numbers: here each of them may have one value for each trajectory, so
that windows, runs and parameter sets are integrated at once.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from types import FunctionType, SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

from eccentric.model import KINDS, Model, cached, function_of, levels, meaning
from eccentric.model import vocabulary as v
from eccentric.simulation.limits import LEAST_DECAY


# NumPy's functions of one number, for a drive that is stepped in Python floats: faster than arrays of one.
#
# Arithmetic and square roots are exact to the last bit either way. All other functions are NumPy's own, which
# have the same value for a number and in an array; Python's may differ in the last bit.
def _select(conditions: Sequence[bool], values: Sequence[float], default: float = math.nan) -> float:
    return next((x for x, holds in zip(values, conditions, strict=True) if holds), default)


def _power(base: float, exponent: float) -> float:
    return float((np.array([base]) ** exponent)[0])


def _numpys(name: str) -> Callable[..., float]:
    function = getattr(np, name)
    return lambda *x: float(function(*x))


SCALAR = SimpleNamespace(
    **{
        name: _numpys(name)
        for name in ("sin", "cos", "tan", "tanh", "arctan", "arcsinh", "exp", "expm1", "log")
    },
    sqrt=math.sqrt,
    abs=abs,
    sign=lambda x: float((x > 0.0) - (x < 0.0)),
    maximum=max,
    minimum=min,
    where=lambda condition, x, y: x if condition else y,
    select=_select,
    less=lambda x, y: x < y,
    less_equal=lambda x, y: x <= y,
    greater=lambda x, y: x > y,
    greater_equal=lambda x, y: x >= y,
    pi=math.pi,
    nan=math.nan,
)
"""What `numpy` is in the functions of a law. A value that is not finite may differ from NumPy's."""
_POWERS = {"square": lambda x: x * x, "power": _power}
_ROOTS = (sp.Rational(1, 2), sp.Rational(-1, 2), sp.S.NegativeOne)


def scalar_function(expression: sp.Basic) -> tuple[Callable[..., Any], tuple[str, ...]]:
    """An expression as a function of numbers, and the names of its symbols.

    Raises NotImplementedError for one with a function that `SCALAR` does not have.
    """
    # Python's power of a number is not NumPy's square of an array.
    opaque = expression.replace(lambda e: isinstance(e, sp.Pow) and e.exp not in _ROOTS, _opaque)
    call, names = function_of(opaque)
    code = call.__code__
    if missing := set(code.co_names) - {"numpy", "functools", "reduce", *vars(SCALAR), *_POWERS}:
        raise NotImplementedError(", ".join(sorted(missing)))
    return FunctionType(code, {"numpy": SCALAR, "functools": functools, **_POWERS}), names


def _opaque(power: sp.Pow) -> sp.Expr:
    base, exponent = power.args
    positive = -exponent if exponent.is_number and exponent.is_negative else exponent
    made = sp.Function("square")(base) if positive == 2 else sp.Function("power")(base, positive)
    return made if positive == exponent else 1 / made


_OUTSIDE = frozenset({"inertial", "friction"})
_CHANGING = frozenset({"theta_m", "omega_m", "alpha_m", "t", "temperature", "i", "u", "dt"})
_FUNCTIONS = ("exp", "expm1", "maximum", "minimum", "where")


class FrictionSide(NamedTuple):
    """Friction in one direction of motion, each a number or (trajectories,)."""

    dry: Any  # level of dry friction [N m]; with presliding, where its bristles end
    viscous: Any  # coefficient of the rest [N m s/rad]
    held: Any = None  # level while bristles bend [N m]
    damping: Any = None  # coefficient of the rest while bristles bend [N m s/rad]
    stiffness: Any = None  # how fast their torque grows, times dt [N m s/rad]


class Torques(NamedTuple):
    """The torques on the motor side at one state, each a number or (trajectories,)."""

    other: Any  # sum of all that is neither friction nor inertia [N m]
    armature: Any  # what effects change of the current that a voltage drives, as a torque [N m]
    backward: FrictionSide  # friction by the direction of motion
    forward: FrictionSide


class _Bound:
    """An expression as a function of those of its symbols that have no value yet, by name."""

    def __init__(self, expression: sp.Basic, known: Mapping[str, Any], arithmetic: Any) -> None:
        function = function_of if arithmetic is np else scalar_function
        self._call, names = function(expression)
        self._values = [known.get(name) for name in names]
        self._places = [(k, name) for k, name in enumerate(names) if name not in known]
        self.names = frozenset(name for _, name in self._places)

    def __call__(self, here: Mapping[str, Any]) -> Any:
        values = self._values
        for k, name in self._places:
            values[k] = here[name]
        return self._call(*values)


class LawAt:
    """A law at the values of its parameters, as a function of inputs, `dt` [s] and hidden states by name."""

    def __init__(
        self,
        torques: sp.Basic,
        advances: Mapping[str, sp.Basic],
        known: Mapping[str, Any],
        arithmetic: Any,
        armature: bool,
    ) -> None:
        self.armature = armature
        self._torques = _Bound(torques, known, arithmetic)
        self._advances = {name: _Bound(x, known, arithmetic) for name, x in advances.items()}
        self.names = self._torques.names.union(*(x.names for x in self._advances.values()))

    def torques(self, here: Mapping[str, Any]) -> Torques:
        """The torques; the velocity is that before the step, and its friction is given in both directions."""
        other, armature, *sides = self._torques(here)
        half = len(sides) // 2
        return Torques(other, armature, FrictionSide(*sides[:half]), FrictionSide(*sides[half:]))

    def advanced(self, here: Mapping[str, Any]) -> dict[str, Any]:
        """The hidden states one step later."""
        return {name: advance(here) for name, advance in self._advances.items()}


class Law:
    """The torques of a model as functions of inputs, hidden states and parameters.

    Args:
        model: of one drive.
        armature: whether what effects change in the armature is a torque as well, as where the current comes
            from a voltage by R and k_e alone.
    """

    def __init__(self, model: Model, armature: bool = False) -> None:
        self.model, self.armature = model, armature
        self._fixed: dict[sp.Expr, sp.Symbol] = {}
        found = cached("law", (model, armature), self._expressions)
        self._torques, self._advances, self._fixed = found

    def _expressions(self) -> tuple[sp.Tuple, dict[str, sp.Expr], dict[sp.Expr, sp.Symbol]]:
        """The torques, the hidden states one step later, and the symbols of what is fixed in them."""
        model, terms = self.model, self.model.balance("mechanical").terms
        outside = sp.Add(*(KINDS[t.kind] * t.value for t in terms if t.kind not in _OUTSIDE))
        change = (
            model.torque_per_volt * model.balance("electrical").residual() if self.armature else sp.S.Zero
        )
        found = levels(model, v.omega_m.symbol, tuple(t for t in terms if t.kind == "friction"))
        names = ("dry", "viscous", *(("held", "damping", "stiffness") if found.presliding else ()))
        sides = [getattr(side, name) for side in (found.backward, found.forward) for name in names]
        for a in reversed(found.definitions):
            sides = [side.xreplace({a.target: a.value}) for side in sides]
        torques = sp.Tuple(*map(self._plain, (outside, change, *sides)))
        return torques, {s.quantity.name: self._plain(s.update) for s in model.states}, self._fixed

    @property
    def initial(self) -> dict[str, float]:
        """The hidden states before anything has moved, by name."""
        return {state.quantity.name: float(state.initial) for state in self.model.states}

    def prepared(self, parameters: Mapping[str, Any]) -> dict[str, Any]:
        """The parameters by name, each a number or (trajectories,), and what follows from them alone.

        `inertia` is that of the drive at the motor [kg m^2].
        """
        with np.errstate(all="ignore"):  # of the pieces of a choice, one is not taken
            found = {s.name: value_of(e, parameters) for e, s in self._fixed.items()}
        return {**parameters, **found, "inertia": value_of(meaning(self.model.inertia), parameters)}

    def at(self, known: Mapping[str, Any], arithmetic: Any = np) -> LawAt:
        """The law at prepared parameters; `arithmetic` is NumPy, or `SCALAR` where all are numbers."""
        return LawAt(self._torques, self._advances, known, arithmetic, self.armature)

    def _plain(self, expression: sp.Expr) -> sp.Expr:
        found = meaning(self.model.expand(expression))
        # As printed, a greatest of a number and an array has no common shape.
        found = found.replace(sp.Max, _greatest)
        return self._hoisted(found)

    def _hoisted(self, e: sp.Expr) -> sp.Expr:
        """The expression with a symbol for each of its largest parts of parameters alone."""
        if e.is_number or e.is_Symbol:
            return e
        if self._is_fixed(e):
            return self._fixed.setdefault(e, sp.Symbol(f"_fixed_{len(self._fixed)}"))
        if isinstance(e, sp.Piecewise):
            return self._selected(e)
        if isinstance(e, sp.Add | sp.Mul):
            own = [a for a in e.args if self._is_fixed(a)]
            rest = [self._hoisted(a) for a in e.args if a not in own]
            return e.func(self._hoisted(e.func(*own)), *rest)
        return e.func(*map(self._hoisted, e.args))

    def _selected(self, e: sp.Piecewise) -> sp.Expr:
        """Pieces chosen by parameters alone as a sum, each times 1 or 0: the choice is made once."""
        if not all(self._is_fixed(condition) for _, condition in e.args):
            return e
        pieces = [piece for piece, _ in e.args]
        chosen = [
            sp.Piecewise(*((int(k == one), condition) for k, (_, condition) in enumerate(e.args)))
            for one in range(len(pieces))
        ]
        return sp.Add(*(self._hoisted(c) * self._hoisted(x) for c, x in zip(chosen, pieces, strict=True)))

    def _is_fixed(self, e: sp.Basic) -> bool:
        states = {state.symbol for state in self.model.states}
        return all(s.name not in _CHANGING and s not in states for s in e.free_symbols)


def _greatest(*values: sp.Expr) -> sp.Expr:
    first, *others = values
    for other in others:
        first = (first + other + sp.Abs(first - other)) / 2
    return first


def step(
    torques: Torques, inertia: Any, omega_m: Any, other: Any, damping: Any, dt: Any, arithmetic: Any = np
) -> Any:
    """The velocity [rad/s] after a step of the inclusion J dw/dt + damping w + friction(w) = other.

    Moreau's step, as `friction_step` has it: the momentum that all other torques leave is reduced by the
    level of dry friction, and what lies between the levels is exactly at rest. Damping is solved exactly over
    the step, for a torque that is constant in it: stable for any dt, and of second order, so that parameters
    which are fitted to the motion do not take in what a step adds. While presliding builds up, the bristles
    hold what is less, and all damping acts at the end of the step.

    Args:
        torques: at the start of the step.
        inertia: of the drive at the motor [kg m^2].
        omega_m: velocity before it [rad/s].
        other: all torques but friction [N m].
        damping: of the drive, beside that of friction [N m s/rad].
        dt: duration [s].
        arithmetic: NumPy, or `SCALAR` for numbers.
    """
    back, ahead = torques.backward, torques.forward
    exp, expm1, maximum, minimum, where = (getattr(arithmetic, name) for name in _FUNCTIONS)

    def chosen(by: Any, one: Any, two: Any) -> Any:
        return one if one is two else where(by > 0.0, one, two)

    def shrunk(x: Any, low: Any, high: Any) -> Any:
        return x - minimum(maximum(x, low), high)

    if ahead.held is None:
        decay = dt * (chosen(omega_m, ahead.viscous, back.viscous) + damping) / inertia
        # decay/(1 - exp(-decay)), whose limit is 1.
        some = maximum(decay, LEAST_DECAY)
        more = some / -expm1(-some)
        momentum = inertia * omega_m * more * exp(-decay) + dt * other
        return shrunk(momentum, dt * back.dry, dt * ahead.dry) / (inertia * more)
    momentum = inertia * omega_m + dt * other
    over = shrunk(momentum, dt * back.dry, dt * ahead.dry)
    excess = shrunk(momentum, dt * back.held, dt * ahead.held)
    slid = over / (inertia + dt * (chosen(excess, ahead.viscous, back.viscous) + damping))
    bristles = chosen(excess, ahead.damping, back.damping) + chosen(excess, ahead.stiffness, back.stiffness)
    bent = excess / (inertia + dt * (bristles + damping))
    return where(excess > 0.0, maximum(bent, slid), minimum(bent, slid))


def value_of(expression: sp.Basic, known: Mapping[str, Any]) -> Any:
    """The value of an expression, or of a tuple of them, at values of its symbols by name."""
    function, names = function_of(expression)
    return function(*(known[name] for name in names))
