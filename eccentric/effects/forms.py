"""Building blocks of several families: columns, harmonics, constants, loads, losses and hidden states.

Angles enter through the half-turn steps only, so that emitted code needs no library sine:
cos(x) = 2 HalfCosine^2 - 1 and sin(x) = -2 HalfCosine HalfSine for x = rate theta_m.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from eccentric.effects.effect import Correction, Effect, Evidence, Plausible, Setting, Shape, Words
from eccentric.model import (
    Change,
    Definition,
    Gated,
    HalfCosine,
    HalfSine,
    Load,
    Magnitude,
    Parts,
    Quantity,
    Role,
    Sgn,
    State,
    Term,
    quantity,
    regressor,
)
from eccentric.model import Column as FrictionColumn
from eccentric.model import vocabulary as v

omega_m, theta_m, alpha_m, dt = v.omega_m.symbol, v.theta_m.symbol, v.alpha_m.symbol, v.dt.symbol
mu, F_N, current, time, temperature = (q.symbol for q in (v.mu, v.F_N, v.i, v.t, v.temperature))
speed = sp.Abs(omega_m)
direction = Sgn(omega_m)

Bounds = tuple[float | None, float | None]
Column = tuple[Quantity, sp.Expr]


def positive(name: str, unit: str, meaning: str, letter: str, **more: Any) -> Quantity:
    """A quantity above 0, by its letter in formulas."""
    return quantity(name, unit, meaning, "", "positive", letter=letter, **more)


def nonnegative(name: str, unit: str, meaning: str, letter: str, **more: Any) -> Quantity:
    """A quantity of 0 or above, by its letter in formulas."""
    return quantity(name, unit, meaning, "", "nonnegative", letter=letter, **more)


def addition(
    family: str,
    columns: Sequence[Column],
    *,
    variant: str = "",
    role: Role | Sequence[Role] = Role.NONE,
    load: Load = Load.NONE,
    kind: str = "friction",
    balance: str = "mechanical",
    circuit: Sequence[sp.Expr] = (),
    bounds: Sequence[Bounds] | None = None,
    depends_on: tuple[str, ...],
    formula: str,
    reference: str,
    definitions: tuple[Definition, ...] = (),
    states: tuple[State, ...] = (),
    inputs: tuple[Quantity, ...] = (),
    shapes: tuple[Shape, ...] = (),
    needs: tuple[str, ...] = (),
    aliases: tuple[str, ...] = (),
    special_of: tuple[str, ...] = (),
    repeats: bool = False,
    second_order: tuple[str, ...] = (),
    one_of: int = 1,
    covers: tuple[str, ...] = (),
    per_turn: sp.Expr | int = 0,
    words: Words | None = None,
    headline: str = "",
    corrects: Correction | None = None,
    only_with: Parts | None = None,
    plausible: tuple[Plausible, ...] = (),
) -> Effect:
    """An effect that adds coefficient times basis to a balance, one term for each of the columns.

    Args:
        family, variant, formula, reference, shapes, words, corrects, only_with, plausible: as in `Effect`.
        columns: coefficient and basis of each term.
        role: of the terms, or of each of them; a term with a role is friction.
        load: the load that the friction is proportional to.
        kind: of the terms without a role, see `eccentric.model.KINDS`.
        balance: the one with the terms; of an effect on both the one that shows it.
        circuit: of an effect on both balances, the basis of each coefficient in the electrical one [V].
        per_turn: of the terms, as in `eccentric.model.Term`.
        bounds: of each coefficient; by default at least 0 if its domain says so, else open.
        depends_on, needs, aliases, special_of, repeats, second_order, one_of, covers: as in `Evidence`.
        definitions, states, inputs: as in `eccentric.model.Change`.
        headline: that of the words, for a family whose effects have their own.
    """
    roles = [role] * len(columns) if isinstance(role, Role) else role
    bounds = bounds or [(None if q.domain == "real" else 0.0, None) for q, _ in columns]
    added = tuple(
        Term(
            q.name,
            kind if does is Role.NONE else "friction",
            q.symbol,
            basis,
            reference,
            bound,
            does,
            Load.NONE if does is Role.NONE else load,
            per_turn=per_turn,
        )
        for (q, basis), bound, does in zip(columns, bounds, roles, strict=True)
    )
    terms = {"mechanical" if circuit else balance: added}
    if circuit:
        pairs = zip(added, circuit, strict=True)
        terms["electrical"] = tuple(replace(t, name=f"{t.name}_u", basis=basis) for t, basis in pairs)
    words = words or Words()
    return Effect(
        family=family,
        variant=variant,
        balance=balance,
        formula=formula,
        reference=reference,
        change=Change(terms, definitions, states, inputs),
        evidence=Evidence(depends_on, needs, aliases, special_of, repeats, second_order, one_of, covers),
        coefficients=tuple(q for q, _ in columns),
        shapes=shapes,
        words=replace(words, headline=headline) if headline else words,
        corrects=corrects,
        only_with=only_with or {},
        plausible=plausible,
    )


def rule(
    family: str,
    definitions: tuple[Definition, ...],
    *,
    replaces: Mapping[sp.Symbol, sp.Symbol] | None = None,
    scales: Iterable[Role] = (),
    terms: tuple[Term, ...] = (),
    **more: Any,
) -> Effect:
    """An effect that replaces quantities by some of its definitions, or scales friction by the last of them.

    Args:
        family, definitions, more: as in `addition`.
        replaces: as in `eccentric.model.Change`.
        scales: roles of the friction that is scaled.
        terms: without a coefficient, added to the mechanical balance.
    """
    made = addition(family, (), definitions=definitions, **more)
    change = replace(
        made.change,
        terms={"mechanical": terms} if terms else {},
        replaces=replaces or {},
        scales=dict.fromkeys(scales, definitions[-1].symbol),
    )
    return replace(made, change=change)


def of_flux(
    family: str, columns: Sequence[Column], setting: Setting, *, needs: tuple[str, ...] = (), **more: Any
) -> Effect:
    """An effect on the motor's flux: columns of the relative change of its torque constant.

    The back-EMF constant changes by the same factor: k_i i w is the electrical power that becomes mechanical,
    whatever the flux. With current and voltage logged the electrical balance shows it first: it measures the
    constant without friction.

    Args:
        family, more: as in `addition`.
        columns: coefficient and basis of each part of the relative change.
        setting: which channels are logged.
        needs: channels besides the current.
    """
    return addition(
        family,
        [(q, -v.k_i.symbol * current * basis) for q, basis in columns],
        circuit=[v.k_e.symbol * omega_m * basis for _, basis in columns],
        kind="actuator",
        balance="electrical" if setting.measured_twice else "mechanical",
        needs=("current", *needs),
        **more,
    )


def constant(name: str, unit: str, meaning: str, value: float, letter: str = "") -> Definition:
    """A number with a name and a unit, such as a reference temperature."""
    return Definition(quantity(name, unit, meaning, letter=letter), sp.Rational(repr(float(value))))


def reference_temperature(name: str, celsius: float) -> Definition:
    """The median of the logged temperature, as a constant."""
    return constant(f"{name}_T0", "K", "reference temperature in degC", celsius, letter="T_0")


def earlier_fit(name: str, setting: Setting) -> list[tuple[FrictionColumn, Definition]]:
    """Columns of the friction of the base model, with their coefficients from an earlier fit as constants."""
    return [
        (
            column,
            constant(
                f"{name}_{column.name}",
                column.unit,
                f"{column.name} from an earlier fit",
                setting.friction[column.name],
                f"{column.name}^0",
            ),
        )
        for column in regressor(setting.base)
        if column.name in setting.friction
    ]


def harmonic(rate: sp.Expr | int, angle: sp.Expr = theta_m) -> tuple[sp.Expr, sp.Expr]:
    """cos(rate angle) and sin(rate angle)."""
    cosine, sine = HalfCosine(angle, sp.sympify(rate)), HalfSine(angle, sp.sympify(rate))
    return 2 * cosine**2 - 1, -2 * cosine * sine


def root(name: str, x: sp.Expr, meaning: str) -> tuple[sp.Expr, tuple[Definition, ...]]:
    """sqrt(|x|), off by at most 1e-6 so that its slope at 0 is finite; and the definitions that it needs."""
    size = Definition(
        quantity(f"{name}_x", "1", f"{meaning}, never 0", letter="x"), Magnitude(x, sp.Rational(1, 10**12))
    )
    value = quantity(f"{name}_root", "1", f"square root of the {meaning}", letter="r")
    return value.symbol, (size, Definition(value, sp.sqrt(size.symbol) - sp.Rational(1, 10**6)))


def gravity(setting: Setting) -> sp.Expr:
    """Gravity torque of the base model on the motor side [N m], eq (5); none in case C1."""
    return setting.base.balance("mechanical").sum_of("gravity")


def inertia_torque(setting: Setting) -> sp.Expr:
    """Inertia torque of the base model on the motor side [N m], J alpha_m; of a chain, that of all bodies."""
    return setting.base.balance("mechanical").sum_of("inertial", "bodies")


def of_an_arm(setting: Setting) -> bool:
    """Whether the base model is that of a joint of an arm: the torque of its bodies is an input."""
    return setting.base.balance("mechanical").sum_of("bodies") != 0


def _link_inertia_torque(setting: Setting) -> sp.Expr:
    """The same of the link alone: without the rotor. Without acceleration J_l need not be known."""
    bodies = setting.base.balance("mechanical").sum_of("bodies")
    if bodies != 0:
        return bodies
    link = setting.base.inertia.subs(v.J_m.symbol, 0)
    beside = link.subs(v.J_l.symbol, 0)
    return Gated(v.J_l.symbol, alpha_m) * sp.diff(link, v.J_l.symbol) + beside * alpha_m


# Friction of the base model at rest, of which an effect cannot take away more than there is.

DISSIPATES = (
    "friction never drives: B. Armstrong-Hélouvry, P. Dupont and C. Canudas de Wit, Automatica 30(7), 1994"
)


def part_of_dry(
    setting: Setting, torque: sp.Expr, name: str, *, either_sign: bool = False
) -> tuple[Plausible, ...]:
    """A torque as part of the dry friction at rest; none in a tilted plane, where the tilt decides on it."""
    link = v.C_lT.symbol * v.F_T.symbol if setting.case == "C1" else v.C_lN.symbol * _weight()
    return _part_of(setting, torque / (v.C_m.symbol + mu * link), "dry", name, either_sign)


def part_of_viscous(
    setting: Setting, coefficient: sp.Expr, name: str, *, either_sign: bool = False
) -> tuple[Plausible, ...]:
    """A coefficient as part of that of the viscous friction at rest; none in a tilted plane."""
    link = v.B_lT.symbol * v.F_T.symbol if setting.case == "C1" else v.B_lN.symbol * _weight()
    return _part_of(setting, coefficient / (v.B_m.symbol + mu**2 * link), "viscous", name, either_sign)


def _weight() -> sp.Expr:
    return (v.M.symbol + v.M_l.symbol) * v.g.symbol


def _part_of(
    setting: Setting, part: sp.Expr, kind: str, name: str, either_sign: bool
) -> tuple[Plausible, ...]:
    if setting.base.tilted:
        return ()
    low, beyond = -100.0 if either_sign else 0.0, f"more than the {kind} friction itself: not friction alone"
    return (Plausible(100 * part, "%", low, 100.0, DISSIPATES, name, above=beyond, below=beyond),)


def weight(setting: Setting) -> float:
    """Weight of mass and link in the plane of motion [N]; 0 if the rig does not know it.

    Of a joint of an arm, the mean of the normal force.
    """
    if setting.mean_force:
        return setting.mean_force
    known = {name: setting.known.get(name, 0.0) for name in ("M", "M_l", "g")}
    inside = math.cos(setting.known.get("phi", 0.0)) if setting.base.tilted else 1.0
    return (known["M"] + known["M_l"]) * known["g"] * inside


def transmitted(
    name: str, setting: Setting, share: sp.Symbol, of_viscous: sp.Symbol | None = None
) -> tuple[sp.Expr, tuple[Definition, ...]]:
    """Torque that the gear transmits to the link, on the motor side [N m]; and the constants it needs.

    Gravity, inertia, the friction that follows a force on the link, and the link's share of the rest: the
    motor cannot distinguish the dry and viscous parts of the two. That friction is taken from an earlier fit:
    with the model's own coefficients in its load, friction would no longer be linear in them.

    Of a joint of an arm it is that of the bodies alone, as in `eccentric.model.chain.drive`.

    Args:
        name: names of constants begin with it.
        setting: the log.
        share: the link's share of the friction without a force.
        of_viscous: that of the viscous part, if it is another one.
    """
    if of_an_arm(setting):
        return gravity(setting) + _link_inertia_torque(setting), ()
    fitted = earlier_fit(name, setting)
    own = {Role.VISCOUS: of_viscous or share}
    friction = sp.Add(
        *(
            known.symbol * column.basis * (own.get(column.role, share) if column.load is Load.NONE else 1)
            for column, known in fitted
        )
    )
    constants = tuple(known for _, known in fitted)
    return gravity(setting) + _link_inertia_torque(setting) + friction, constants


def loss(setting: Setting) -> sp.Expr:
    """Heat dissipated in drive and bearings [W], from measured inputs and known parameters only.

    Of a joint of an arm whose rig does not give R, that of friction alone.
    """
    friction = v.k_i.symbol * v.i.symbol - inertia_torque(setting) - gravity(setting)
    if setting.mean_force and v.R.name not in setting.known:
        return friction * omega_m
    return friction * omega_m + v.R.symbol * v.i.symbol**2


def copper(setting: Setting) -> tuple[sp.Expr, Definition] | None:
    """Heat in the windings alone [W], where `loss` lacks it for want of R; with the definition that it needs.

    Without R only its course counts: its mean is that of the other losses. None but for a joint of an arm
    whose rig does not give R, and where no current flows.
    """
    if not setting.mean_force or v.R.name in setting.known or not setting.mean_square_A2:
        return None
    ohmic = setting.mean_loss_W / setting.mean_square_A2
    R = constant("heat_R", "Ohm", "resistance that gives the windings those mean losses", ohmic, "R_P")
    return R.symbol * v.i.symbol**2, R


def thermal_times(setting: Setting) -> tuple[float, float]:
    """Range of thermal time constants [s] that a log of this length can show."""
    return min(8.0, 0.2 * setting.duration_s), min(300.0, 5.0 * setting.duration_s)


def heating(
    name: str, setting: Setting, power: sp.Expr, tau: sp.Symbol
) -> tuple[sp.Expr, tuple[Definition, ...], State]:
    """First-order heating: its rise, about 1 at the end of the log, the definitions it needs, and its state.

    The state is the power, averaged by a body of time constant tau. The step is implicit, stable for any time
    step and free of 1 - exp(-dt/tau), which loses its digits in single precision.
    """
    state = quantity(f"{name}_P", "W", "heating power, averaged over the thermal time constant", letter="P")
    scale = quantity(
        f"{name}_full", "W", "averaged power at the end of the identification log", letter="P_end"
    )
    mean = constant(
        f"{name}_mean", "W", "mean losses over the identification log", setting.mean_loss_W, "P_0"
    )
    end = constant(f"{name}_end", "s", "length of the identification log", setting.duration_s, "t_end")
    full = Definition(scale, mean.symbol * (1 - sp.exp(-end.symbol / tau)))
    update = state.symbol + dt / (tau + dt) * (power - state.symbol)
    return state.symbol / scale.symbol, (mean, end, full), State(state, sp.Integer(0), update)


def relaxation(
    name: str, meaning: str, path: sp.Expr, length: sp.Symbol, way: sp.Expr, letter: str = ""
) -> State:
    """A state that follows the sign of `way`, exponentially in the distance, exact over a time step."""
    state = quantity(name, "1", meaning, letter=letter)
    end = Sgn(way)
    return State(state, sp.Integer(0), end + (state.symbol - end) * sp.exp(-path / length))
