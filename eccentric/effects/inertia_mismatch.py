"""An inertia other than the declared one."""

from __future__ import annotations

from eccentric.effects.effect import LOAD, Correction, Effect, Setting, Words
from eccentric.effects.forms import addition, alpha_m
from eccentric.model import Gated, quantity
from eccentric.model import vocabulary as v

ratio = quantity(
    "inertia_ratio",
    "1",
    "true inertia on the motor side over the declared one, minus 1",
    letter="r",
    part_of=v.J,
)
WORDS = Words(
    headline="a correction of the declared inertia",
    meaning="The inertia differs from the declared one.",
    hint="strong accelerations and decelerations through the same speeds",
    kin=LOAD,
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """The one effect of the family, for a declared inertia; linear, since that appears only in J alpha.

    None in a coast-down, whose every torque is in proportion to the inertia.
    """
    if "inertia" in setting.left_open or not setting.channels - {"temperature"}:
        return ()
    aliases = ("mass_mismatch",) if setting.case == "C1" else ()
    if setting.scaled and not setting.masses and (setting.case == "C1" or "gravity" in setting.left_open):
        # A wrong k_i scales inertia and gravity: here only the inertia would show it.
        aliases += ("ki_mismatch",)
    effect = addition(
        "inertia_mismatch",
        [(ratio, Gated(v.J.symbol, alpha_m))],
        kind="inertial",
        bounds=((-0.95, None),),
        depends_on=("acceleration",),
        formula="J (1 + r) for J",
        corrects=Correction(v.J, setting.base.inertia * (1 + ratio.symbol), tolerance=0.05),
        reference="C. G. Atkeson, C. H. An and J. M. Hollerbach, Int. J. Robotics Research 5(3), 1986",
        aliases=aliases,
        words=WORDS,
    )
    return (effect,)
