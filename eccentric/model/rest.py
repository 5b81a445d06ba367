"""Friction at rest: the levels of dry friction, and a time step with exact sticking.

Dry friction is set-valued at rest: any torque between its two levels that keeps the drive at rest. In motion
it is the level of that direction. So it enters a time step by its levels, never by the sign of a velocity:
with the momentum p that the drive would have without friction, J omega_m = p - dt f is solved in closed form
for the velocity at the end of the step (J. J. Moreau, in Nonsmooth Mechanics and Applications, CISM 302,
1988).

The state dependence of levels and viscous coefficient, including F_N and the Stribeck decrease, is evaluated
at the start of the step. So the solution is unique for any time step, even if friction falls with the speed.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import sympy as sp

from eccentric.model import vocabulary as v
from eccentric.model.balance import Equation, Identity, Role, Term
from eccentric.model.model import Model
from eccentric.model.output import Assignment
from eccentric.model.steps import (
    Backward,
    ByDirection,
    BySign,
    Clipped,
    Forward,
    Gated,
    Magnitude,
    Quotient,
    Sgn,
    Shrunk,
)


def law_at_rest(friction: sp.Expr, inertia: sp.Expr, backward: sp.Expr | None = None) -> tuple[Equation, ...]:
    """The equations of friction at rest, for friction that is linear in the velocity at a given F_N.

    Args:
        friction: the friction torque, with the sign of omega_m [N m].
        inertia: on the motor side [kg m^2].
        backward: friction for omega_m < 0, if it has other coefficients.
    """
    omega_m = v.omega_m.symbol
    f, T, dt, p, J = v.f.symbol, v.torque.symbol, v.dt.symbol, v.p.symbol, sp.Symbol("J", positive=True)
    upper, lower, b, after = v.f_upper.symbol, v.f_lower.symbol, v.b.symbol, v.omega_after.symbol
    sides = ((1, friction), (-1, friction if backward is None else backward))
    values = [sp.expand(value.subs(sp.sign(omega_m), sign)) for sign, value in sides]
    dry, viscous = ([sp.collect(x.coeff(omega_m, k), v.F_N.symbol) for x in values] for k in (0, 1))
    # Excess momentum over the levels, and the levels, as numbers of known sign.
    e, high, low, c = sp.symbols("e high low c", positive=True)
    ahead, back = e / (J + dt * c), -e / (J + dt * c)

    def of_momentum(size: sp.Expr, end: sp.Expr, friction: sp.Expr) -> sp.Expr:
        """J (end - start) - dt (T - friction), where J start + dt T is the momentum."""
        return sp.simplify(J * end + dt * friction - size)

    def never_negative(value: sp.Expr) -> sp.Expr:
        value = sp.factor(value)
        return value - sp.Abs(value)

    step = sp.Piecewise(
        ((p - dt * upper) / (inertia + dt * b), p > dt * upper),
        ((p - dt * lower) / (inertia + dt * b), p < dt * lower),
        (0, True),
    )
    names = ("f_upper", "f_lower", "b") if viscous[0] == viscous[1] else ("f_upper", "f_lower", "b^+", "b^-")
    rows = [*dry, *dict.fromkeys(viscous)]
    return (
        Equation(
            "levels",
            "",
            sp.Matrix(sp.symbols(names)),
            sp.Matrix(rows),
            ("N m", "N m", *["N m s/rad"] * (len(rows) - 2)),
            "Its dry part has a level for each direction of motion; the other part is viscous, at the load of"
            " this state.",
        ),
        Equation(
            "set_valued",
            "",
            f,
            sp.Piecewise(
                (upper + b * omega_m, omega_m > 0),
                (lower + b * omega_m, omega_m < 0),
                (sp.Min(upper, sp.Max(lower, T)), True),
            ),
            "N m",
            "At rest dry friction is any torque between its levels: it balances the torque T of all else as"
            " far as they reach.",
        ),
        Equation(
            "momentum",
            "",
            p,
            inertia * omega_m + dt * T,
            "N m s",
            "Over a time step Delta t, T alone would give the drive this momentum; friction removes"
            " Delta t f of it.",
        ),
        Equation(
            "step",
            "",
            after,
            step,
            "rad/s",
            "So the velocity at its end is, in closed form, with the levels at its start:",
            (
                Identity(
                    "forwards, the momentum that friction removes is its value at the end, times the step",
                    of_momentum(dt * high + e, ahead, high + c * ahead),
                ),
                Identity("and backwards", of_momentum(-dt * low - e, back, -low + c * back)),
                Identity(
                    "friction never drives: it has the sign of the velocity forwards",
                    never_negative((high + c * ahead) * ahead),
                ),
                Identity("and backwards", never_negative((-low + c * back) * back)),
                Identity(
                    "the drive is never faster than it would be without friction, forwards",
                    never_negative(sp.together((dt * high + e) / J - ahead)),
                ),
                Identity("and backwards", never_negative(sp.together(back - (-dt * low - e) / J))),
                Identity(
                    "both are continuous where the momentum leaves the levels",
                    sp.Abs(ahead.subs(e, 0)) + sp.Abs(back.subs(e, 0)),
                ),
            ),
        ),
    )


_SPEED = sp.Symbol("speed_of_motor", positive=True)
"""Magnitude of the velocity while sums are split, so that it cancels in a division."""
_ENDINGS = {1: "_forward", -1: "_backward"}


@dataclass(frozen=True)
class Side:
    """Friction in one direction of motion, signed as on the motor, as functions of the state."""

    dry: sp.Expr  # the level with fully developed presliding [N m]
    viscous: sp.Expr  # the rest over the velocity [N m s/rad]
    held: sp.Expr  # the level at the current presliding state [N m]
    damping: sp.Expr  # the rest over the velocity at the current presliding state [N m s/rad]
    stiffness: sp.Expr  # presliding stiffness times the time step dt [N m s/rad]


@dataclass(frozen=True)
class Levels:
    """Friction in both directions, and the definitions that differ between them."""

    forward: Side
    backward: Side
    definitions: tuple[Assignment, ...]

    def at_rest(self, direction: int) -> sp.Expr:
        """The level in a direction, 1 or -1, in terms of the model's definitions only."""
        level = (self.forward if direction > 0 else self.backward).dry
        for a in reversed(self.definitions):
            level = level.xreplace({a.target: a.value})
        return level

    @property
    def presliding(self) -> bool:
        """Whether friction builds up over a distance."""
        return self.forward.stiffness != 0 or self.backward.stiffness != 0


def moving(omega_m: sp.Symbol, direction: int) -> dict[sp.Expr, sp.Expr]:
    """The values of the steps by direction for velocities above (1) or below (-1) zero."""
    return {
        Sgn(omega_m): sp.Integer(direction),
        Forward(omega_m): sp.Integer(direction > 0),
        Backward(omega_m): sp.Integer(direction < 0),
    }


def at_direction(value: sp.Expr, omega_m: sp.Symbol, direction: int) -> sp.Expr:
    """The value with the steps by the direction of omega_m evaluated: 1 forwards, -1 backwards."""
    value = value.xreplace(moving(omega_m, direction)).replace(
        lambda e: isinstance(e, ByDirection) and e.args[0] == omega_m,
        lambda e: e.args[1 if direction > 0 else 2],
    )
    return value.replace(lambda e: isinstance(e, Gated) and e.args[1].is_number, lambda e: sp.Mul(*e.args))


def levels(
    model: Model, omega_m: sp.Symbol, terms: tuple[Term, ...], given: Collection[sp.Symbol] = frozenset()
) -> Levels:
    """The levels of friction terms over the velocity omega_m, and the viscous coefficients.

    A term with a factor omega_m is viscous, any other dry. Both depend on the magnitude of the velocity.

    Args:
        model: the model of the terms.
        omega_m: the velocity.
        terms: friction.
        given: definitions evaluated at the current state in both directions: the loads of an arm.
    """
    renamed: dict[int, dict[sp.Symbol, sp.Expr]] = {1: {}, -1: {}}
    copies: list[Assignment] = []
    for d in (d for d in model.definitions if d.symbol not in given):
        both = {s: _moving(d.value, omega_m, s).xreplace(renamed[s]) for s in renamed}
        if both[1] == both[-1]:
            continue
        for s, value in both.items():
            copy = sp.Symbol(d.quantity.name + _ENDINGS[s], **d.symbol.assumptions0)
            renamed[s][d.symbol] = copy
            copies.append(Assignment(copy, value.xreplace({_SPEED: sp.Abs(omega_m)})))
    bristles = {state.symbol: state.update for state in model.states}
    # A tilt is at most a right angle, and a load of an arm is the magnitude of a force or moment.
    sizes: dict[sp.Expr, sp.Symbol] = {f(v.phi.symbol): sp.Dummy(nonnegative=True) for f in (sp.sin, sp.cos)}
    for d in model.definitions:
        if d.symbol in given and d.value.is_extended_nonnegative:
            sizes[d.symbol] = sp.Dummy(nonnegative=True)
    sides = {s: _side(omega_m, s, terms, renamed[s], bristles, sizes) for s in renamed}
    return Levels(sides[1], sides[-1], tuple(copies))


def _moving(value: sp.Expr, omega_m: sp.Symbol, direction: int) -> sp.Expr:
    """The value at speed _SPEED in this direction, with the signs in sums of squares normalised."""
    value = at_direction(value, omega_m, direction).xreplace({omega_m: direction * _SPEED})
    return value.replace(Magnitude, lambda p, q: Magnitude(-p if p.could_extract_minus_sign() else p, q))


def _side(
    omega_m: sp.Symbol,
    direction: int,
    terms: tuple[Term, ...],
    renamed: Mapping[sp.Symbol, sp.Expr],
    bristles: Mapping[sp.Symbol, sp.Expr],
    sizes: Mapping[sp.Expr, sp.Symbol],
) -> Side:
    parts_sum = [sp.Integer(0)] * 5
    for term in terms:
        value = _moving(term.value, omega_m, direction)
        bent = value.free_symbols & set(bristles) if term.role is Role.PRESLIDING else set()
        updates = {z: _moving(bristles[z], omega_m, direction) for z in bent}
        # A bristle approaches its final value exponentially with distance.
        ends = {z: update.replace(_fades, lambda _: sp.Integer(0)) for z, update in updates.items()}
        now = _split(value)
        rates = (
            direction * sp.diff(now[0], z) * sp.diff(update, _SPEED).subs(_SPEED, 0)
            for z, update in updates.items()
        )
        parts = (*_split(value.xreplace(ends)), *now, sp.Add(*rates))
        parts_sum = [a + b for a, b in zip(parts_sum, parts, strict=True)]
    plain = {_SPEED: sp.Abs(omega_m)}
    dry, viscous, held, damping, stiffness = (x.xreplace(renamed).xreplace(plain) for x in parts_sum)
    # Friction never drives: neither its level nor its coefficient crosses zero.
    dry = direction * _at_least_zero(direction * dry, sizes)
    viscous, damping = (_at_least_zero(direction * x, sizes) for x in (viscous, damping))
    stiffness = _at_least_zero(stiffness, sizes)
    return Side(dry, viscous, held if stiffness != 0 else dry, damping, stiffness)


def _at_least_zero(value: sp.Expr, sizes: Mapping[sp.Expr, sp.Symbol]) -> sp.Expr:
    """The value, or 0 where it is negative; `sizes` are nonnegative."""
    return value if value.xreplace(sizes).is_nonnegative else sp.Max(0, value)


def _fades(e: sp.Basic) -> bool:
    return isinstance(e, sp.exp) and e.has(v.dt.symbol)


def _split(value: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """The part without a factor of the speed, and the rest divided by the speed."""
    dry, viscous = [], []
    for addend in sp.Add.make_args(sp.expand_mul(value, deep=False)):
        powers = addend.as_powers_dict()
        if sp.sympify(powers.get(_SPEED, 0)).is_positive:
            viscous.append(addend / _SPEED)
        else:
            dry.append(addend)
    return sp.Add(*dry), sp.Add(*viscous)


def budget(dry: Levels, omega_m: sp.Symbol = v.omega_m.symbol) -> tuple[tuple[str, sp.Expr], ...]:
    """Lower and upper level, and the viscous coefficient in the direction of motion."""
    viscous = chosen(omega_m, dry.forward.viscous, dry.backward.viscous)
    return ("lower", dry.backward.dry), ("upper", dry.forward.dry), ("viscous", viscous)


class NamedSteps:
    """The assignments of a routine; a call assigns a state-dependent value to a name."""

    def __init__(self, model: Model) -> None:
        self._fixed = model.parameter_symbols
        self.listed: list[Assignment] = []
        self._named: dict[sp.Expr, sp.Expr] = {}

    def __call__(self, name: str, value: sp.Expr, note: str = "") -> sp.Expr:
        """A symbol for the value; parameter-only and already named values are returned unchanged."""
        if value.is_Atom or value.free_symbols <= self._fixed:
            return value
        if -value in self._named:
            return -self._named[-value]
        if value not in self._named:
            self._named[value] = sp.Symbol(name, real=True)
            self.listed.append(Assignment(self._named[value], value, note))
        return self._named[value]

    def sides(self, dry: Levels, end: str = "") -> tuple[Side, Side]:
        """Both sides, with a name ending in `end` for each value."""
        forward, backward = dry.forward, dry.backward
        one = "slope" if forward.viscous == backward.viscous else "slope_forward"
        return (
            Side(
                self(f"upper{end}", forward.dry, "levels of dry friction [N m]"),
                self(f"{one}{end}", forward.viscous),
                self(f"held_upper{end}", forward.held, "levels of the bristles as they are bent [N m]"),
                self(f"damping_forward{end}", forward.damping),
                self(f"stiffness_forward{end}", forward.stiffness),
            ),
            Side(
                self(f"lower{end}", backward.dry),
                self(f"slope_backward{end}", backward.viscous),
                self(f"held_lower{end}", backward.held),
                self(f"damping_backward{end}", backward.damping),
                self(f"stiffness_backward{end}", backward.stiffness),
            ),
        )


Stepped = tuple[tuple[Assignment, ...], tuple[tuple[str, sp.Expr], ...]]


def step(model: Model, dry: Levels, inertia: sp.Expr) -> Stepped:
    """Velocity after a time step and the friction torque in it, with their intermediate assignments.

    While presliding builds up, friction is the smaller of two laws: that of the bristles, linear in the
    velocity over the step, and that of sliding. The smaller friction gives the greater speed.
    """
    omega_m, torque, dt = v.omega_m.symbol, v.torque.symbol, v.dt.symbol
    named = NamedSteps(model)
    forward, backward = named.sides(dry)
    without = "momentum at the end of the step, if there were no friction [N m s]"
    momentum = named("momentum", inertia * omega_m + dt * torque, without)
    excess = named(
        "excess",
        Shrunk(momentum, dt * backward.held, dt * forward.held),
        "its part that friction at rest does not take up [N m s]",
    )

    def by_excess(name: str) -> sp.Expr:
        return chosen(excess, getattr(forward, name), getattr(backward, name))

    viscous = named("damped", by_excess("viscous"))
    held = momentum / dt
    if not dry.presliding:
        end = named("velocity_after", excess / (inertia + dt * viscous))
        # At rest within the levels, without a viscous part; in motion the level of its direction.
        friction = named("dry", Clipped(held, backward.dry, forward.dry)) + viscous * end
    else:
        taken = by_excess("damping") + by_excess("stiffness")
        bent_by = named("bent_by", taken, "torque per velocity while bristles bend")
        bent = named("bent", excess / (inertia + dt * bent_by), "velocity while bristles bend [rad/s]")
        over = named("sliding", Shrunk(momentum, dt * backward.dry, dt * forward.dry))
        slid = named("slid", over / (inertia + dt * viscous), "velocity while surfaces slide [rad/s]")
        end = named("velocity_after", ByDirection(excess, sp.Max(bent, slid), sp.Min(bent, slid)))
        first, second = by_excess("held") + bent_by * end, by_excess("dry") + viscous * end
        first, second = named("while_bending", first), named("while_sliding", second)
        friction = BySign(excess, sp.Min(first, second), sp.Max(first, second), held)
    return tuple(named.listed), ((omega_m.name, end), ("friction", friction))


def acceleration(model: Model, dry: Levels, inertia: sp.Expr) -> Stepped:
    """The acceleration by a torque, 0 at rest within the levels, with its intermediate assignments."""
    omega_m, torque = v.omega_m.symbol, v.torque.symbol
    named = NamedSteps(model)
    forward, backward = named.sides(dry)
    starting = named("starting", Shrunk(torque, backward.held, forward.held))
    damping = chosen(omega_m, forward.damping, backward.damping)
    net = BySign(omega_m, torque - forward.held, torque - backward.held, starting) - omega_m * damping
    return tuple(named.listed), (("", Quotient(net, inertia)),)


def chosen(by: sp.Expr, forward: sp.Expr, backward: sp.Expr) -> sp.Expr:
    """The value of the direction, simplified if both are equal."""
    return forward if forward == backward else ByDirection(by, forward, backward)
