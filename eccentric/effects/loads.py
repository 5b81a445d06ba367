"""Friction in proportion to a load: of the gear by the torque that it transmits, of the link's bearing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import sympy as sp

from eccentric.effects.effect import LOAD, Effect, Plausible, Setting, Shape, Words
from eccentric.effects.forms import (
    F_N,
    Column,
    addition,
    constant,
    direction,
    gravity,
    mu,
    nonnegative,
    of_an_arm,
    positive,
    transmitted,
    weight,
)
from eccentric.model import GEARS, Definition, Load, Magnitude, Quantity, Role, quantity
from eccentric.model import vocabulary as v

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


class GearLoad(NamedTuple):
    """The torque that a gear transmits, in one of its definitions.

    Attributes:
        variant, variable: which definition, and the leading variable that it depends on.
        formula: as a person writes it.
        torque: the symbol of it.
        definitions: its own, after the constants that it needs.
        shapes: the link's share of the friction without F_N, where it enters.
        inputs: of the model that it needs.
    """

    variant: str
    variable: str
    formula: str
    torque: sp.Symbol
    definitions: tuple[Definition, ...]
    shapes: tuple[Shape, ...]
    inputs: tuple[Quantity, ...]


def gear_loads(name: str, setting: Setting) -> Iterator[GearLoad]:
    """The transmitted torque, inertia included, and in case C2 the gravity torque alone; names from `name`.

    There is one share for dry and viscous friction: what two would change is a small part of the loss.
    """
    share = nonnegative(f"{name}_share", "1", "link's share of the friction without F_N", "s")
    load = quantity(f"{name}_torque", "N m", "torque that the gear transmits, motor side", letter="T")
    torque, constants = transmitted(name, setting, share.symbol)
    inputs = () if setting.case == "C1" else (v.theta_m,)
    yield GearLoad(
        "transmitted",
        "transmitted_torque",
        "G + mu^2 J_l alpha + f_lN + share (f - f_lN)",
        load.symbol,
        (*constants, Definition(load, torque)),
        () if of_an_arm(setting) else (Shape(share, 0.0, 1.0, "linear", 3),),
        inputs,
    )
    if setting.case == "C2":
        own = (Definition(load, gravity(setting)),)
        yield GearLoad("gravity", "gravity_load", "G", load.symbol, own, (), inputs)


def gear_loss(
    family: str, load: GearLoad, columns: Sequence[Column], *, shapes: tuple[Shape, ...] = (), **more: Any
) -> Effect:
    """Friction of a gear by this load; the rest as in `addition`."""
    return addition(
        family,
        columns,
        load=Load.TRANSMITTED,
        shapes=(*load.shapes, *shapes),
        definitions=load.definitions,
        inputs=load.inputs,
        only_with={"gear": GEARS},
        **more,
    )


def _efficiency(loss: sp.Symbol) -> Plausible:
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


def load_dependent(setting: Setting) -> Iterator[Effect]:
    """By the transmitted torque, inertia included, linear or progressive; in C2 also by gravity alone."""
    eta = nonnegative("load_eta", "1", "friction of the gear per transmitted torque", "eta")
    eta_2 = nonnegative("load_eta_2", "1/(N m)", "its growth with the transmitted torque", "eta_2")
    words = Words(
        title="Gear friction that follows the load",
        meaning="Friction of the gear in proportion to the load that it transmits.",
        hint="a different mass or arm at the same speeds; back-driving separates it from a gear efficiency",
        kin=LOAD,
        tell_apart={
            "gear_efficiency": (
                "Raise and lower the mass slowly at the same speeds, with the current logged and k_i known."
            )
        },
    )
    for load in gear_loads("load", setting):
        linear = (eta, sp.Abs(load.torque) * direction)
        yield gear_loss(
            "load_dependent",
            load,
            [linear],
            variant=load.variant,
            role=Role.COULOMB,
            depends_on=(load.variable,),
            formula=f"eta |{load.formula}| sgn w",
            reference="A. Gogoussis and M. Donath, IEEE ICRA 1987;"
            " P. Hamon, M. Gautier and P. Garrec, IROS 2010",
            plausible=(_efficiency(eta.symbol),),
            words=words,
            headline=f"gear friction proportional to the {load.variant} torque",
        )
        if load.variant == "transmitted":
            yield gear_loss(
                "load_dependent",
                load,
                [(eta_2, load.torque**2 * direction), linear],
                variant="progressive",
                role=Role.COULOMB,
                depends_on=(load.variable,),
                formula=f"(eta |T| + eta_2 T^2) sgn w, T = {load.formula}",
                reference="M. Duclusaud, G. Passault, V. Padois and O. Ly, arXiv:2410.08650, 2024"
                " (quadratic in the load)",
                # Its efficiency falls with the load: no figure of it, whatever the torque.
                words=words,
                headline="gear friction that grows progressively with the transmitted torque",
            )


def gear_efficiency(setting: Setting) -> Iterator[Effect]:
    """By the transmitted torque, inertia included, and in case C2 by the gravity load alone.

    |load| sgn w where the load resists and rho |load| sgn w where it drives equals, without a case
    distinction, the mean of both factors times |load| sgn w plus half their difference times the load.
    """
    eta = nonnegative("gear_eta", "1", "loss of the gear per torque, driving", "eta")
    rho = nonnegative("gear_rho", "1", "loss of the gear, back-driven over driving", "rho")
    words = Words(
        title="Gear losses that differ between driving and back-driving",
        meaning="A gear whose losses differ between driving the load and being back-driven by it.",
        hint="raise and lower the mass slowly at the same speeds: the losses should differ",
        kin=LOAD,
    )
    both, differ = (1 + rho.symbol) / 2, (1 - rho.symbol) / 2
    weaker = Shape(rho, 0.0, 0.8, "linear", 5)
    # A gear that is near to locking itself. Between the two it is `load_dependent`.
    stronger = Shape(rho, 1.25, 4.0, "log", 4)
    for load in gear_loads("gear", setting):
        # At rest the gear adds nothing, hence the squared direction.
        basis = both * sp.Abs(load.torque) * direction + differ * load.torque * direction**2
        for ending, headline, ratios in (
            ("", "gear losses that differ between driving and back-driving", weaker),
            (",driven", "gear losses that are larger when back-driving", stronger),
        ):
            yield gear_loss(
                "gear_efficiency",
                load,
                [(eta, basis)],
                variant=load.variant + ending,
                role=Role.COULOMB,
                depends_on=(load.variable, "direction"),
                formula=f"eta |T| sgn w driving, rho eta |T| sgn w back-driven, T = {load.formula}",
                reference="A. Gogoussis and M. Donath, IEEE ICRA 1987; T. Verstraten et al., IEEE Robotics"
                " and Automation Letters 1(1), 2016",
                shapes=(ratios,),
                plausible=(_efficiency(eta.symbol),),
                words=words,
                headline=f"{headline}, proportional to the {load.variant} torque",
            )


ROLLING = ("ball", "roller")
HERTZ = "K. L. Johnson, Contact Mechanics, Cambridge University Press, 1985 (area of a Hertzian contact)"
PALMGREN = (
    "A. Palmgren, Ball and Roller Bearing Engineering, SKF Industries, 1959; rolling: J. A. Greenwood,"
    " H. Minshall and D. Tabor, Proc. Royal Society A 259, 1961"
)
TABLES = "SKF, Rolling Bearings, 2016, table of constant coefficients; JTEKT, Bearing Knowledge 8-4, undated"

# What the base model of case C1 already contains, and the column of it.
IN_C1 = {
    "bearing_load": "w and w^3, the columns of B_m and B_lN: the powers 1/2 and 3/2 of F_N, M L omega_l^2"
}


def bearing_load(setting: Setting) -> Iterator[Effect]:
    """By the power 1/2 or 3/2 of F_N, and with a preload across it; none without gravity or an imbalance.

    One power below 1 and one above are enough: after the model's own columns, 1 and F_N, have taken their
    part, 1/2 and 2/3 are the same to a thousandth, and so are 4/3, 3/2 and 1.55. A preload along F_N is the
    constant part of the model. In case C1 the powers are w and w^3, and of what a preload changes
    a few hundredths are left.
    """
    still, pull = weight(setting), setting.known.get("M", 0.0) * setting.known.get("L", 0.0)
    if not setting.mean_force and (setting.case == "C1" or not still * pull):
        return
    C = nonnegative(
        "bearing_C", "m", "Coulomb friction of the link per normal force, where that is the weight", "C"
    )
    C_p = nonnegative("bearing_Cp", "m", "Coulomb friction of the preloaded bearing per force", "C_p")
    preload = positive("bearing_Fp", "N", "preload of the bearing, across the normal force", "F_p")
    ratio = positive("bearing_r", "1", "normal force over the weight", "r")
    total = positive("bearing_F", "N", "force on the preloaded bearing", "F")
    words = Words(
        title="Bearing friction that is not in proportion to its load",
        meaning=(
            "Dry friction of the link's bearing by a power of its load (rolling bearings: 4/3 to 1.55;"
            " Hertzian contact: 1/2 to 2/3), or under a preload."
        ),
        hint="the same speeds with two masses or more, up to speeds at which the load more than doubles",
        kin=LOAD,
    )
    what = "mean normal force of the log" if setting.mean_force else "weight of mass and link"
    own = constant("bearing_weight", "N", what, still, "F_0")
    # Never 0, so that the slope of its root is finite.
    relative = Definition(ratio, F_N / own.symbol + sp.Rational(1, 10**12))
    half = sp.sqrt(ratio.symbol)
    across = Definition(total, Magnitude(F_N, preload.symbol))
    power = "C mu F_0 (F_N/F_0)^({}) sgn w, F_0 the weight"
    for variant, coefficient, force, definitions, parts, formula, reference, headline in (
        (
            "degressive", C, own.symbol * half, (own, relative), (*ROLLING, "plain"), power.format("1/2"),
            HERTZ, "bearing friction that grows more slowly than the normal force",
        ),
        (
            "progressive", C, F_N * half, (own, relative), ROLLING, power.format("3/2"), PALMGREN,
            "bearing friction that grows faster than the normal force",
        ),
        (
            "preload", C_p, total.symbol, (across,), ROLLING, "C_p mu sqrt(F_N^2 + F_p^2) sgn w",
            "standard form: radial and axial load added as vectors", "a preload of the link's bearing",
        ),
    ):  # fmt: skip
        # The least coefficient that a bearing can have: that of one as wide as the link is long.
        least = Plausible(
            coefficient.symbol / v.L.symbol,
            "1",
            0.0,
            0.2,
            f"plain bearings: {TABLES}",
            "the coefficient of friction of the bearing, if it were as wide as the link is long,",
            above="not the bearing alone",
            by_part=dict.fromkeys(ROLLING, (0.0, 0.005, TABLES)),
        )
        yield addition(
            "bearing_load",
            [(coefficient, mu * force * direction)],
            variant=variant,
            role=Role.COULOMB,
            load=Load.NORMAL,
            depends_on=("velocity", "link_angle"),
            formula=formula,
            reference=reference,
            shapes=(Shape(preload, 0.1 * still, 3.0 * still, "log", 5),) if variant == "preload" else (),
            definitions=definitions,
            inputs=(v.theta_m,),
            only_with={"bearing": parts},
            plausible=(least,),
            words=words,
            headline=headline,
        )
