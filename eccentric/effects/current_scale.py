"""A torque constant other than the declared one."""

from __future__ import annotations

from eccentric.effects.effect import LOAD, Correction, Effect, Setting, Words
from eccentric.effects.forms import addition, gravity, inertia_torque
from eccentric.model import quantity
from eccentric.model import vocabulary as v

ratio = quantity("current_scale", "1", "declared torque constant over the true one, less 1", letter="r")
WORDS = Words(
    headline="a correction of the declared torque constant",
    meaning="The torque constant, or the scale of the current sensor, differs from the declared one.",
    hint=(
        "hold a known weight on a lever and read the current in both directions of approach; in SI units"
        " k_i of a DC motor equals its k_e"
    ),
    kin=LOAD,
    tell_apart={
        "gravity": "Weigh the mass; or accelerate hard, with the inertia declared.",
    },
)

# What the base model of case C1 already contains, and the column of it.
IN_C1 = {"ki_mismatch": "a factor on the inertia: inertia_mismatch"}


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The one effect of the family, for torque computed with a declared k_i.

    Declared inertia and gravity together show it; in case C1 it is a factor on the inertia alone. Likewise
    where one of the two is left open. A known mass that some runs carry shows it in every case.
    k_i (1 + r) instead of k_i makes every torque too large by 1 + r: friction, which is fitted, absorbs this;
    inertia and gravity, which are declared, are both too small by r.
    """
    hidden = setting.case == "C1" or {"inertia", "gravity"} & set(setting.left_open)
    if not setting.scaled or (hidden and not setting.masses):
        return ()
    effect = addition(
        "ki_mismatch",
        [(ratio, inertia_torque(setting) + gravity(setting))],
        kind="conservative",
        bounds=((-1.0, None),),
        depends_on=("gravity_load", "acceleration"),
        formula="k_i/(1 + r) for k_i: r (J alpha + G)",
        corrects=Correction(
            v.k_i, v.k_i.symbol / (1 + ratio.symbol), looks_wrong=("J", "M g L"), tolerance=0.02
        ),
        reference="standard form; torque constant: W. Leonhard, Control of Electrical Drives, Springer",
        aliases=("resistance_mismatch",) if setting.by_voltage else (),
        inputs=(v.theta_m,),
        needs=("current",),
        words=WORDS,
    )
    return (effect,)
