"""Backlash: when the load on the gear changes its side, the motor turns free until the teeth meet again."""

from __future__ import annotations

import sympy as sp

from eccentric.effects.effect import Effect, Shape
from eccentric.effects.forms import (
    addition,
    direction,
    dt,
    gravity,
    harmonic,
    link_force,
    omega_m,
    relaxation,
    speed,
)
from eccentric.effects.setting import Setting
from eccentric.model import Term, quantity
from eccentric.model import vocabulary as v
from eccentric.model.model import State
from eccentric.model.steps import Sgn

gap = quantity("backlash_gap", "rad", "gap, motor side", "", "positive")
arm = quantity(
    "backlash_arm", "m", "dry friction of the link per force, as part of the load", "", "nonnegative"
)
free = quantity("backlash_free", "1", "share of the gap that is left", "", "nonnegative")
side = quantity("backlash_side", "1", "side that the load was on, 1 or -1")
GRAVITY = quantity(
    "backlash_G", "1", "gravity torque not felt in the gap, 1 for all of it", "", "nonnegative"
)
TORQUE = quantity("backlash_T", "N m", "gravity torque by the link's lag, per full gap", "", "nonnegative")
REFERENCE = "form of our own, smoothed; backlash: M. Nordin and P.-O. Gutman, Automatica 38(10), 2002"
HINT = "slow swings that change the side of the load often, with an encoder on the link if there can be one"


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The link not felt in the gap; in case C2 also the link that lags by the gap.

    The gap closes exponentially with the travelled angle, its mean being the gap: a sharp end is below what a
    filtered log shows, and so the states are linear in themselves.
    """
    return (_freed(setting),) if setting.case == "C1" else (_freed(setting), _lag(setting))


def _freed(setting: Setting) -> Effect:
    dry = v.mu.symbol * link_force(setting) * arm.symbol * direction
    load = gravity(setting) + dry if setting.case == "C2" else direction
    changed = (1 - Sgn(load) * side.symbol) / 2
    closing = sp.exp(-speed * dt / gap.symbol)
    states = (
        State(side, sp.Integer(0), Sgn(load)),
        State(free, sp.Integer(0), closing * (changed + (1 - changed) * free.symbol)),
    )
    force = v.F_N.symbol if setting.case == "C2" else sp.Integer(1)
    per_force = setting.case == "C2"
    B = quantity(
        "backlash_B",
        "m s/rad" if per_force else "N m s/rad",
        "viscous friction of the link",
        "",
        "nonnegative",
    )
    C = quantity("backlash_C", "m" if per_force else "N m", "Coulomb friction of the link", "", "nonnegative")
    columns = [
        (B, -free.symbol * v.mu.symbol**2 * force * omega_m),
        (C, -free.symbol * v.mu.symbol * force * direction),
    ]
    shapes = [Shape(gap, 3e-3 / setting.mu, 0.5 / setting.mu, "log", 10)]
    fields = {}
    if setting.case == "C2":
        columns.insert(0, (GRAVITY, -free.symbol * gravity(setting)))
        shapes.append(Shape(arm, 0.0, 0.4 * setting.known.get("L", 0.25), "linear", 3))
        kinds = ("conservative", "friction", "friction")
        fields["terms"] = {
            "mechanical": tuple(
                Term(q.name, kind, q.symbol, basis, REFERENCE)
                for kind, (q, basis) in zip(kinds, columns, strict=True)
            )
        }
        fields["inputs"] = (v.theta_m,)
    return addition(
        "backlash",
        columns,
        depends_on=("history",),
        formula="-free (friction and gravity of the link), free falls from 1 with the angle after the"
        " load changed its side",
        reference=REFERENCE,
        shapes=tuple(shapes),
        states=states,
        hint=HINT,
        **fields,
    )


def _lag(setting: Setting) -> Effect:
    state = relaxation("backlash_z", "lag of the link, in gaps", speed * dt, gap.symbol, omega_m)
    return addition(
        "backlash[lag]",
        [(TORQUE, -harmonic(v.mu.symbol)[0] * state.symbol)],
        kind="conservative",
        depends_on=("history",),
        formula="-T z cos(theta_l), z the side of the gap, following the direction of motion",
        reference=REFERENCE,
        shapes=(Shape(gap, 2e-3 / setting.mu, 0.5 / setting.mu, "log", 6),),
        inputs=(v.theta_m,),
        states=(state,),
        hint=HINT,
    )
