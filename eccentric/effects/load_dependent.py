"""Load-dependent friction of the gear."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import LOAD, Effect, Plausible, Setting, Shape, Words
from eccentric.effects.forms import addition, direction, gravity, of_an_arm, transmitted
from eccentric.model import GEARS, Definition, Load, Role, quantity
from eccentric.model import vocabulary as v

eta = quantity(
    "load_eta", "1", "friction of the gear per transmitted torque", "", "nonnegative", letter="eta"
)
eta_2 = quantity(
    "load_eta_2", "1/(N m)", "its growth with the transmitted torque", "", "nonnegative", letter="eta_2"
)
# One share for its dry and viscous parts: what two would change is a small part of the loss.
share = quantity("load_share", "1", "link's share of the friction without F_N", "", "nonnegative", letter="s")
load = quantity("load_torque", "N m", "torque that the gear transmits, motor side", letter="T")
# What follows no load is friction of its own here: an efficiency without it has no upper end.
SCREWS = "PBC Linear, Lead Screw Efficiency, white paper, undated: 14 to 86 % by lead and diameter"
WORMS = "ISO/TR 14521, 2010: tan(gamma)/tan(gamma + rho), lead angles from 2.9 degrees, friction up to 0.14"
WAVES = "Harmonic Drive AG, data of SHG-2UH, 1021387, 2018, and CSD-2A, 1019659, 2014: 50 to 78 %"
PLANETS = (
    "L. Eitel, Design World, 2020: at most 3 % lost in each stage, here in five; Beckhoff AG2300 and AG2400,"
    " undated: 97 % of one stage, 92 % of three"
)
EFFICIENCIES = {
    "strain wave": (50.0, 100.0, WAVES),
    "planetary": (86.0, 100.0, PLANETS),
    "worm": (25.0, 100.0, WORMS),
    "screw": (14.0, 100.0, SCREWS),
}


def efficiency(loss: sp.Symbol) -> Plausible:
    """The efficiency of a gear that drives its load, from its loss per torque."""
    return Plausible(
        100 / (1 + loss),
        "%",
        14.0,
        100.0,
        SCREWS,
        "the efficiency of the gear under load",
        below="losses beyond this gear's",
        by_part=EFFICIENCIES,
    )


REFERENCE = "A. Gogoussis and M. Donath, IEEE ICRA 1987; P. Hamon, M. Gautier and P. Garrec, IROS 2010"
SERVO = "M. Duclusaud, G. Passault, V. Padois and O. Ly, arXiv:2410.08650, 2024 (quadratic in the load)"
WORDS = Words(
    title="Gear friction that follows the load",
    meaning="Friction of the gear in proportion to the load that it transmits.",
    hint="a different mass or arm at the same speeds; back-driving separates it from a gear efficiency",
    kin=LOAD,
    tell_apart={
        "gear_efficiency": (
            "Raise and lower the mass slowly at the same speeds, with the current logged and k_i known."
        ),
    },
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """By the transmitted torque, inertia included, linear or progressive; in C2 also by gravity alone."""
    inputs = () if setting.case == "C1" else (v.theta_m,)
    found = []
    for variant, variable, torque, constants, shapes in loads("load", setting, share.symbol):
        shape = tuple(Shape(share, *span) for span in shapes)
        found.append(
            addition(
                "load_dependent",
                [(eta, sp.Abs(load.symbol) * direction)],
                variant=variant,
                role=Role.COULOMB,
                load=Load.TRANSMITTED,
                depends_on=(variable,),
                formula=f"eta |{FORMULAS[variant]}| sgn w",
                reference=REFERENCE,
                shapes=shape,
                definitions=(*constants, Definition(load, torque)),
                inputs=inputs,
                only_with={"gear": GEARS},
                plausible=(efficiency(eta.symbol),),
                words=replace(WORDS, headline=f"gear friction in proportion to the {variant} torque"),
            )
        )
        if variant == "transmitted":
            found.append(
                addition(
                    "load_dependent",
                    [(eta_2, load.symbol**2 * direction), (eta, sp.Abs(load.symbol) * direction)],
                    variant="progressive",
                    role=Role.COULOMB,
                    load=Load.TRANSMITTED,
                    depends_on=(variable,),
                    formula=f"(eta |T| + eta_2 T^2) sgn w, T = {FORMULAS[variant]}",
                    reference=SERVO,
                    shapes=shape,
                    definitions=(*constants, Definition(load, torque)),
                    inputs=inputs,
                    only_with={"gear": GEARS},
                    words=replace(
                        WORDS, headline="gear friction that grows progressively with the transmitted torque"
                    ),
                )
            )
    return tuple(found)


FORMULAS = {"gravity": "G", "transmitted": "G + mu^2 J_l alpha + f_lN + share (f - f_lN)"}

Variant = tuple[str, str, sp.Expr, tuple[Definition, ...], list[tuple[float, float, str, int]]]


def loads(name: str, setting: Setting, share: sp.Symbol) -> list[Variant]:
    """(variant, variable, torque, its constants, range of the share) of each definition of the load.

    Names begin with `name`. `gear_efficiency` uses the same loads.
    """
    torque, constants = transmitted(name, setting, share)
    spans = [] if of_an_arm(setting) else [(0.0, 1.0, "linear", 3)]
    found: list[Variant] = [("transmitted", "transmitted_torque", torque, constants, spans)]
    if setting.case == "C2":
        found.append(("gravity", "gravity_load", gravity(setting), (), []))
    return found
