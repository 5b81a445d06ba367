"""Values that the rig declares wrongly: mass, inertia, torque constant, back-EMF constant, resistance."""

from __future__ import annotations

from collections.abc import Iterator

import sympy as sp

from eccentric.effects.effect import (
    GRAVITY,
    LOAD,
    Correction,
    Effect,
    Plausible,
    PossibleCause,
    Setting,
    Shape,
    Words,
)
from eccentric.effects.forms import (
    addition,
    alpha_m,
    current,
    gravity,
    inertia_torque,
    nonnegative,
    omega_m,
    rule,
)
from eccentric.model import Definition, Gated, quantity
from eccentric.model import vocabulary as v

M, L, J_l = v.M.symbol, v.L.symbol, v.J_l.symbol
CALIBRATION = "C. G. Atkeson, C. H. An and J. M. Hollerbach, Int. J. Robotics Research 5(3), 1986"
LEONHARD = "W. Leonhard, Control of Electrical Drives, Springer"

# What the base model of case C1 already contains, and the column of it.
IN_C1 = {
    "mass_mismatch": "a factor on the columns of B_lN and C_lN; its inertia is inertia_mismatch",
    "ki_mismatch": "a factor on the inertia: inertia_mismatch",
}


TOLERANCES = "HIWIN, TM-Komponenten-04-0-EN, 2021: 10 % for all values of a motor"
WARM = f"{TOLERANCES}; ferrite, neomagnetsupplier.com, 2008, up to 180 degC, class H of IEC 60085, 2007"
HOT = f"{TOLERANCES}; copper, IEC 60028, 1925, up to 180 degC, class H of IEC 60085, 2007"


def constant_off(part: sp.Expr, name: str, *, warm: bool = False) -> Plausible:
    """A constant of the motor beside the declared one, from its relative error.

    warm: at the temperature of the log; ferrite loses 0.2 %/K, from 20 degC to 180 degC: 0.9 (1 - 0.32) - 1.
    """
    return Plausible(
        100 * part,
        "%",
        -39.0 if warm else -10.0,
        10.0,
        WARM if warm else TOLERANCES,
        f"the true {name} minus the declared one",
        above="another winding, or a current in other units",
        below="another winding, a current in other units, or weakened magnets",
    )


def resistance_off(part: sp.Expr) -> Plausible:
    """The resistance beside the declared one, from its relative error: tolerance and a hot winding."""
    return Plausible(
        100 * part,
        "%",
        -10.0,
        79.0,
        HOT,
        "the true resistance minus the declared one",
        above="cable or brushes add to it, or it is another winding",
        below="another winding",
    )


def mass_mismatch(setting: Setting) -> Iterator[Effect]:
    """Three variants, case C2 only: in a log of C1 the mass affects only friction coefficients and inertia.

    `mass_mismatch` uses the true mass in gravity and normal force and keeps the inertia as declared, since it
    may have been measured; `[inertia]` uses it in the inertia as well (J_l includes M L^2); `[torque]` scales
    the gravity torque alone, as an imbalance of the link itself does.
    """
    if setting.case == "C1":
        return
    ratio = quantity("mass_ratio", "1", "true mass over the declared one, minus 1", letter="r", part_of=v.M)
    more = quantity(
        "mass_torque", "1", "true gravity torque over the declared one, minus 1", letter="r", part_of=v.M
    )
    M_true = nonnegative("M_true", "kg", "true unbalanced mass", "M^*")
    J_l_true = nonnegative("J_l_true", "kg m^2", "inertia of the link with the true mass", "J_l^*")
    words = Words(
        title="A correction of the declared mass",
        meaning="The mass on the link differs from the declared one, or the link without it is not balanced"
        " about the axis: M L has to be the first moment of all that swings.",
        causes=(PossibleCause("a wrong M or L"), PossibleCause("a link that is not balanced about the axis")),
        hint="weigh the mass; or hold the link horizontal and read the current in both directions of"
        " approach",
        kin=GRAVITY,
    )
    # A wrong k_i scales inertia and gravity: if the inertia is not declared, only gravity would show it.
    hidden = "inertia" in setting.left_open and not setting.masses
    aliases = ("ki_mismatch",) if setting.scaled and hidden else ()
    mass = Definition(M_true, M * (1 + ratio.symbol))
    inertia = Definition(J_l_true, J_l + M * L**2 * ratio.symbol)
    for variant, headline, formula, definitions, replaces in (
        ("", "", "M (1 + r) for M in gravity and normal force", (mass,), {M: mass.symbol}),
        (
            "inertia",
            ", inertia included",
            "M (1 + r) for M in gravity, normal force and inertia",
            (inertia, mass),
            {M: mass.symbol, J_l: inertia.symbol},
        ),
    ):
        yield rule(
            "mass_mismatch",
            definitions,
            variant=variant,
            replaces=replaces,
            depends_on=("gravity_load", "acceleration"),
            formula=formula,
            reference=CALIBRATION,
            aliases=aliases,
            shapes=(Shape(ratio, -0.6, 0.9, "linear", 6),),
            corrects=Correction(v.M, mass.value, looks_wrong=("M g L",)),
            words=words,
            headline=f"a correction of the declared mass{headline}",
        )
    yield addition(
        "mass_mismatch",
        [(more, gravity(setting))],
        variant="torque",
        kind="conservative",
        depends_on=("gravity_load",),
        formula="r G",
        reference=CALIBRATION,
        inputs=(v.theta_m,),
        aliases=aliases,
        words=words,
        headline="a correction of the gravity torque",
    )


def inertia_mismatch(setting: Setting) -> Iterator[Effect]:
    """The one effect of the family, for a declared inertia; linear, since that appears only in J alpha.

    None in a coast-down, whose every torque is in proportion to the inertia.
    """
    if "inertia" in setting.left_open or not setting.channels - {"temperature"}:
        return
    ratio = quantity(
        "inertia_ratio",
        "1",
        "true inertia on the motor side over the declared one, minus 1",
        letter="r",
        part_of=v.J,
    )
    aliases = ("mass_mismatch",) if setting.case == "C1" else ()
    if setting.scaled and not setting.masses and (setting.case == "C1" or "gravity" in setting.left_open):
        # A wrong k_i scales inertia and gravity: here only the inertia would show it.
        aliases += ("ki_mismatch",)
    yield addition(
        "inertia_mismatch",
        [(ratio, Gated(v.J.symbol, alpha_m))],
        kind="inertial",
        bounds=((-0.95, None),),
        depends_on=("acceleration",),
        formula="J (1 + r) for J",
        corrects=Correction(v.J, setting.base.inertia * (1 + ratio.symbol), tolerance=0.05),
        reference=CALIBRATION,
        aliases=aliases,
        words=Words(
            headline="a correction of the declared inertia",
            meaning="The inertia differs from the declared one.",
            hint="strong accelerations and decelerations through the same speeds",
            kin=LOAD,
        ),
    )


def ki_mismatch(setting: Setting) -> Iterator[Effect]:
    """The one effect of the family, for torque computed with a declared k_i.

    Declared inertia and gravity together show it; in case C1 it is a factor on the inertia alone. Likewise
    where one of the two is left open. A known mass that some runs carry shows it in every case.
    k_i (1 + r) instead of k_i makes every torque too large by 1 + r: friction, which is fitted, absorbs this;
    inertia and gravity, which are declared, are both too small by r.
    """
    hidden = setting.case == "C1" or {"inertia", "gravity"} & set(setting.left_open)
    if not setting.scaled or (hidden and not setting.masses):
        return
    ratio = quantity("current_scale", "1", "declared torque constant over the true one, minus 1", letter="r")
    yield addition(
        "ki_mismatch",
        [(ratio, inertia_torque(setting) + gravity(setting))],
        kind="conservative",
        bounds=((-1.0, None),),
        depends_on=("gravity_load", "acceleration"),
        formula="k_i/(1 + r) for k_i: r (J alpha + G)",
        corrects=Correction(
            v.k_i, v.k_i.symbol / (1 + ratio.symbol), looks_wrong=("J", "M g L"), tolerance=0.02
        ),
        reference=f"standard form; torque constant: {LEONHARD}",
        aliases=("resistance_mismatch",) if setting.by_voltage else (),
        inputs=(v.theta_m,),
        needs=("current",),
        plausible=(constant_off(1 / (1 + ratio.symbol) - 1, "torque constant"),),
        words=Words(
            headline="a correction of the declared torque constant",
            meaning="The torque constant, or the scale of the current sensor, differs from the declared one.",
            hint=(
                "hold a known weight on a lever and read the current in both directions of approach; in SI"
                " units k_i of a DC motor equals its k_e"
            ),
            kin=LOAD,
            tell_apart={"gravity": "Weigh the mass; or accelerate hard, with the inertia declared."},
        ),
    )


def armature_mismatch(setting: Setting) -> Iterator[Effect]:
    """Back-EMF constant and resistance, which are not known if only voltage is logged."""
    if setting.by_voltage:
        return
    back_emf = quantity(
        "armature_k", "V s/rad", "true back-EMF constant minus the declared one", letter="Delta k_e"
    )
    resistance = quantity("armature_R", "Ohm", "true resistance minus the declared one", letter="Delta R")
    reference = f"standard form; armature circuit: {LEONHARD}"
    yield addition(
        "ke_mismatch",
        [(back_emf, omega_m)],
        kind="back_emf",
        balance="electrical",
        depends_on=("velocity",),
        formula="(k_e + dk) for k_e",
        corrects=Correction(v.k_e, v.k_e.symbol + back_emf.symbol, tolerance=0.02),
        special_of=("magnet_temperature",),
        plausible=(constant_off(back_emf.symbol / v.k_e.symbol, "back-EMF constant"),),
        reference=reference,
        needs=("current", "voltage"),
        words=Words(
            headline="a correction of the declared back-EMF constant",
            meaning="The back-EMF constant differs from the declared one: a different winding, or weakened"
            " magnets.",
            hint="drive the motor externally with its terminals open and read the voltage",
        ),
    )
    yield addition(
        "resistance_mismatch",
        [(resistance, current)],
        kind="actuator",
        balance="electrical",
        depends_on=("current",),
        formula="(R + dR) for R",
        corrects=Correction(v.R, v.R.symbol + resistance.symbol, tolerance=0.02),
        special_of=("resistance_temperature",),
        plausible=(resistance_off(resistance.symbol / v.R.symbol),),
        reference=reference,
        needs=("current", "voltage"),
        words=Words(
            headline="a correction of the declared resistance",
            meaning="The resistance differs from the declared one: cable, brushes, a warm winding.",
            hint="the locked rotor at several currents",
        ),
    )
