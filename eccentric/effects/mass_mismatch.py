"""A mass other than the declared one."""

from __future__ import annotations

from dataclasses import replace

from eccentric.effects.effect import GRAVITY, Correction, Effect, Evidence, Setting, Shape, Words
from eccentric.effects.forms import addition, gravity
from eccentric.model import Change, Definition, quantity
from eccentric.model import vocabulary as v

M, L, J_l = v.M.symbol, v.L.symbol, v.J_l.symbol
ratio = quantity("mass_ratio", "1", "true mass over the declared one, minus 1", letter="r", part_of=v.M)
more = quantity(
    "mass_torque", "1", "true gravity torque over the declared one, minus 1", letter="r", part_of=v.M
)
M_true = quantity("M_true", "kg", "true unbalanced mass", "", "nonnegative", letter="M^*")
J_l_true = quantity(
    "J_l_true", "kg m^2", "inertia of the link with the true mass", "", "nonnegative", letter="J_l^*"
)
REFERENCE = "C. G. Atkeson, C. H. An and J. M. Hollerbach, Int. J. Robotics Research 5(3), 1986"
WORDS = Words(
    title="A correction of the declared mass",
    meaning="The mass on the link differs from the declared one.",
    hint="weigh the mass; or hold the link horizontal and read the current in both directions of approach",
    kin=GRAVITY,
)

# What the base model of case C1 already contains, and the column of it.
IN_C1 = {"mass_mismatch": "a factor on the columns of B_lN and C_lN; its inertia is inertia_mismatch"}


def effects(setting: Setting) -> tuple[Effect, ...]:
    """Three variants, case C2 only: in a log of C1 the mass affects only friction coefficients and inertia.

    `mass_mismatch` uses the true mass in gravity and normal force and keeps the inertia as declared, since it
    may have been measured; `[inertia]` uses it in the inertia as well (J_l includes M L^2); `[torque]` scales
    the gravity torque alone, as an imbalance of the link itself does.
    """
    if setting.case == "C1":
        return ()
    # A wrong k_i scales inertia and gravity: if the inertia is not declared, only gravity would show it.
    hidden = "inertia" in setting.left_open and not setting.masses
    aliases = ("ki_mismatch",) if setting.scaled and hidden else ()
    true_mass = Definition(M_true, M * (1 + ratio.symbol))
    true_inertia = Definition(J_l_true, J_l + M * L**2 * ratio.symbol)
    replacing = [
        Effect(
            family="mass_mismatch",
            variant=variant,
            balance="mechanical",
            formula=formula,
            reference=REFERENCE,
            change=Change(definitions=definitions, replaces=replaces),
            evidence=Evidence(depends_on=("gravity_load", "acceleration"), aliases=aliases),
            shapes=(Shape(ratio, -0.6, 0.9, "linear", 6),),
            corrects=Correction(v.M, true_mass.value, looks_wrong=("M g L",)),
            words=replace(WORDS, headline=headline),
        )
        for variant, headline, formula, definitions, replaces in (
            (
                "",
                "a correction of the declared mass",
                "M (1 + r) for M in gravity and normal force",
                (true_mass,),
                {M: M_true.symbol},
            ),
            (
                "inertia",
                "a correction of the declared mass, inertia included",
                "M (1 + r) for M in gravity, normal force and inertia",
                (true_inertia, true_mass),
                {M: M_true.symbol, J_l: J_l_true.symbol},
            ),
        )
    ]
    torque = addition(
        "mass_mismatch",
        [(more, gravity(setting))],
        variant="torque",
        kind="conservative",
        depends_on=("gravity_load",),
        formula="r G",
        reference=REFERENCE,
        inputs=(v.theta_m,),
        aliases=aliases,
        words=replace(WORDS, headline="a correction of the gravity torque"),
    )
    return (*replacing, torque)
