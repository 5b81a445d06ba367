"""Stribeck friction that follows a load: that of the gear, or the paper's normal force."""

from __future__ import annotations

import math
from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import LOAD, Effect, Setting, Shape, Words
from eccentric.effects.forms import addition, direction, speed, weight
from eccentric.effects.load_dependent import FORMULAS, loads
from eccentric.effects.stribeck import speed_at_the_output
from eccentric.model import GEARS, Definition, Load, Role, quantity
from eccentric.model import vocabulary as v

eta = quantity(
    "loadrise_eta",
    "1",
    "increase of the gear's friction near rest per transmitted torque",
    "",
    "nonnegative",
    letter="eta",
)
C = quantity(
    "loadrise_C",
    "m",
    "increase of the link's friction near rest per normal force",
    "",
    "nonnegative",
    letter="C",
)
w_s = quantity("loadrise_v", "rad/s", "Stribeck velocity, motor side", "", "positive", letter="v")
share = quantity(
    "loadrise_share", "1", "link's share of the friction without F_N", "", "nonnegative", letter="s"
)
load = quantity("loadrise_torque", "N m", "torque that the gear transmits, motor side", letter="T")

JOINT = "A. C. Bittencourt and S. Gunnarsson, J. Dynamic Systems, Measurement and Control 134(5), 2012"
SERVO = "M. Duclusaud, G. Passault, V. Padois and O. Ly, arXiv:2410.08650, 2024"
HERSEY = "R. Stribeck, Zeitschrift des VDI 46, 1902; M. D. Hersey, J. Washington Academy of Sciences 4, 1914"
WORDS = Words(
    title="Stribeck friction that follows the load",
    meaning=("The increase of friction near rest grows with the load, as dry friction does."),
    hint="slow runs through whole turns, below the Stribeck velocity, with two masses",
    kin=LOAD,
    tell_apart={
        "stribeck": "Run slowly through whole turns: the load varies, the speed does not.",
        "load_dependent": "Hold several speeds below and far above the Stribeck velocity, under load.",
    },
)
# The least Stribeck speed over w*, at which centrifugal force and weight are equal, for which F_N is more
# than the weight: at 0.4 it varies by 0.16. Below, Stribeck friction by F_N is `stribeck`.
LEAST = 0.4


def effects(setting: Setting) -> tuple[Effect, ...]:
    """By the torque of the gear with two exponents; in case C2 by F_N as well."""
    return (*_gear(setting), *(_bearing(setting) if setting.case == "C2" else ()))


def _gear(setting: Setting) -> list[Effect]:
    inputs = () if setting.case == "C1" else (v.theta_m,)
    return [
        addition(
            "stribeck_load",
            [(eta, sp.Abs(load.symbol) * sp.exp(-((speed / w_s.symbol) ** d)) * direction)],
            variant=f"{variant},d={d}",
            role=Role.STRIBECK,
            load=Load.TRANSMITTED,
            depends_on=(variable, "velocity"),
            formula=f"eta |T| exp(-(|w|/v)^{d}) sgn w, T = {FORMULAS[variant]}",
            reference=f"{JOINT}; {SERVO}",
            shapes=(
                *(Shape(share, *span) for span in shapes),
                Shape(w_s, setting.w_min, 0.4 * setting.w_max, "log", 8),
            ),
            definitions=(*constants, Definition(load, torque)),
            inputs=inputs,
            only_with={"gear": GEARS},
            plausible=(speed_at_the_output(w_s),),
            words=replace(
                WORDS, headline=f"Stribeck friction with exponent {d} that follows the {variant} torque"
            ),
        )
        for variant, variable, torque, constants, shapes in loads("loadrise", setting, share.symbol)
        for d in (1, 2)
    ]


def _bearing(setting: Setting) -> list[Effect]:
    """By F_N, with a constant Stribeck velocity.

    None if the log has no speed at which F_N is much more than the weight.
    """
    still, pull = weight(setting), setting.known.get("M", 0.0) * setting.known.get("L", 0.0)
    least = LEAST * math.sqrt(still / pull) / setting.mu if pull > 0.0 else math.inf
    if setting.mean_force:
        # The force on a joint of an arm varies by the motion of the others, at any speed.
        least = 0.0
    low, high = max(least, setting.w_min), 0.6 * setting.w_max
    if not still or low >= high:
        return []
    fall = sp.exp(-((speed / w_s.symbol) ** 2))
    effect = addition(
        "stribeck_load",
        [(C, v.mu.symbol * v.F_N.symbol * fall * direction)],
        variant="F_N",
        role=Role.STRIBECK,
        load=Load.NORMAL,
        depends_on=("velocity", "link_angle"),
        formula="C mu F_N exp(-(|w|/v)^2) sgn w",
        reference=f"eq (9), its Coulomb part; {HERSEY}",
        shapes=(Shape(w_s, low, high, "log", 4),),
        inputs=(v.theta_m,),
        words=replace(WORDS, headline="Stribeck friction in proportion to the normal force"),
    )
    return [effect]
