"""Friction that falls as the drive warms up, temperature not logged."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import TEMPERATURE, Effect, Evidence, Setting, Shape, Words
from eccentric.effects.forms import addition, copper, direction, heating, loss, omega_m, thermal_times
from eccentric.model import CONTACT, Change, Definition, Role, State, quantity

tau = quantity("heat_tau", "s", "thermal time constant", "", "positive", letter="tau")
fall = quantity(
    "heat_b", "1", "fall of the logarithm of friction over the log", "", "nonnegative", letter="b"
)
B = quantity(
    "heat_B", "N m s/rad", "viscous friction of the bearing that warms up", "", "nonnegative", letter="B"
)
C = quantity("heat_C", "N m", "fall of the Coulomb friction over the log", "", "nonnegative", letter="C")
factor = quantity("heat_factor", "1", "friction over that of the cold drive", "", "positive", letter="kappa")
REFERENCE = "L. Simoni, M. Beschi, G. Legnani and A. Visioli, Robotica 37(5), 2019 (temperature not measured)"
WORDS = Words(
    title="Friction that falls as the drive warms up",
    meaning=(
        "Friction falls as the drive warms up, and no temperature is logged: first-order heating by "
        "the losses."
    ),
    hint="start cold, hold one speed until friction is steady, rest, repeat; or log a temperature",
    kin=TEMPERATURE,
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """All friction, all viscous friction, or viscous or Coulomb friction of one bearing.

    None if a temperature is logged: `viscosity_temperature` and `coulomb_temperature` then use it. Where the
    losses lack those of the windings, all friction is offered once more, heated by these alone.
    """
    if setting.temperature_mid is not None:
        return ()
    rise, definitions, state = heating("heat", setting, loss(setting), tau.symbol)
    constant_of_time = Shape(tau, *thermal_times(setting), "log", 8)
    depends_on = ("time", "history")
    warm = rise, definitions, state
    scaling = [
        _scaling(constant_of_time, "", "friction", CONTACT, "losses", warm),
        _scaling(constant_of_time, "viscous", "viscous friction", {Role.VISCOUS}, "losses", warm),
    ]
    if (windings := copper(setting)) is not None:
        power, resistance = windings
        rise_i, by_current, state_i = heating("heat", setting, power, tau.symbol)
        warm = rise_i, (resistance, *by_current), state_i
        scaling.append(_scaling(constant_of_time, "windings", "friction", CONTACT, "R i^2", warm))
    bearing = addition(
        "hidden_thermal_drift",
        [(B, omega_m * (sp.exp(-fall.symbol * rise) - 1))],
        variant="bearing",
        role=Role.VISCOUS,
        depends_on=depends_on,
        formula="B w (exp(-b rise) - 1), tau d(rise)/dt = losses/mean - rise",
        shapes=(constant_of_time, Shape(fall, 0.1, 2.5, "log", 3)),
        reference=REFERENCE,
        definitions=definitions,
        states=(state,),
        words=replace(WORDS, headline="viscous friction of one bearing that falls as the drive warms up"),
    )
    dry = addition(
        "hidden_thermal_drift",
        [(C, -direction * rise)],
        variant="coulomb",
        role=Role.COULOMB,
        depends_on=depends_on,
        formula="-C rise sgn w, tau d(rise)/dt = losses/mean - rise",
        shapes=(constant_of_time,),
        reference=REFERENCE,
        definitions=definitions,
        states=(state,),
        words=replace(WORDS, headline="Coulomb friction that falls as the drive warms up"),
    )
    return (*scaling, bearing, dry)


def _scaling(
    constant_of_time: Shape,
    variant: str,
    which: str,
    roles: Collection[Role],
    heat: str,
    heated: tuple[sp.Expr, tuple[Definition, ...], State],
) -> Effect:
    """Friction of these roles, `which`, times a factor that falls as this heat makes the drive warm."""
    rise, definitions, state = heated
    return Effect(
        family="hidden_thermal_drift",
        variant=variant,
        balance="mechanical",
        formula=f"{which} times exp(-b rise), tau d(rise)/dt = {heat}/mean - rise",
        reference=REFERENCE,
        change=Change(
            definitions=(*definitions, Definition(factor, sp.exp(-fall.symbol * rise))),
            states=(state,),
            scales=dict.fromkeys(roles, factor.symbol),
        ),
        evidence=Evidence(("time", "history")),
        shapes=(constant_of_time, Shape(fall, 0.03, 1.5, "log", 3)),
        words=replace(WORDS, headline=f"{which} that falls as the drive warms up"),
    )
