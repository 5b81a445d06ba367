"""Friction by a law of the speed or of its direction: drag, thinning, eddy currents, asymmetry."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import SPEED, Effect, PossibleCause, Setting, Shape, Words
from eccentric.effects.forms import (
    addition,
    direction,
    nonnegative,
    omega_m,
    part_of_dry,
    part_of_viscous,
    positive,
)
from eccentric.effects.motor import WITH_IRON
from eccentric.effects.temperature import FILM
from eccentric.model import Backward, Definition, Forward, Magnitude, Role, quantity

forward, backward = Forward(omega_m), Backward(omega_m)
BRUSHED = {"motor": ("brushed", "coreless")}

# What the base model of case C1 already contains, and the column of it.
IN_C1 = {
    "quadratic_drag": "w|w|, the column of C_lN: F_N is M L omega_l^2",
    "cubic_drag": "w^3, the column of B_lN: F_N is M L omega_l^2",
}


def drag(setting: Setting) -> Iterator[Effect]:
    """Quadratic and cubic drag, and windage in either direction.

    In case C1 the first two are already columns of the model, see `IN_C1`, unless there is no mass, or runs
    carry different ones: F_N follows the mass, drag does not.
    """
    one_way = Words(
        title="Windage in one direction only",
        meaning="Windage in one direction only: a fan, or blades bent to one side.",
        hint="the same high speeds in both directions",
        kin=SPEED,
    )
    for sign, variant, name, which, side, gate in (
        (1, "+", "pos", "positive", ">", forward),
        (-1, "-", "neg", "negative", "<", backward),
    ):
        meaning = f"windage torque per motor velocity squared, omega_m {side} 0"
        q = nonnegative(f"windage_{name}", "N m s^2/rad^2", meaning, "D")
        yield addition(
            "oneway_windage",
            [(q, sp.Integer(sign) * omega_m**2 * gate)],
            variant=variant,
            role=Role.DRAG,
            depends_on=("velocity", "direction"),
            formula=f"D w|w| for w {side} 0 only",
            reference="J. E. Vrancik, NASA TN D-4849, 1968 (windage grows with the square of the speed)",
            words=one_way,
            headline=f"windage in the {which} direction only",
        )
    unloaded = setting.known.get("M", 1.0) * setting.known.get("L", 1.0) == 0.0
    if setting.case == "C1" and not setting.masses and not unloaded:
        return
    quadratic = nonnegative("drag_2", "N m s^2/rad^2", "drag torque per motor velocity squared", "D")
    cubic = nonnegative("drag_3", "N m s^3/rad^3", "drag torque per motor velocity cubed", "D")
    steady = (
        "steady runs over a speed range of 1 to 5 or more: over a narrow one, all powers fit equally well"
    )
    yield addition(
        "quadratic_drag",
        [(quadratic, omega_m**2 * direction)],
        role=Role.DRAG,
        depends_on=("velocity",),
        formula="D w|w|",
        reference="S. S. Ge, T. H. Lee and S. X. Ren, Int. J. Systems Science 32(4), 2001",
        words=Words(
            headline="drag that grows with the square of the speed",
            meaning="Drag of air or oil in turbulent flow: it grows with the square of the speed.",
            hint=steady,
            kin=SPEED,
        ),
    )
    yield addition(
        "cubic_drag",
        [(cubic, omega_m**3)],
        role=Role.DRAG,
        depends_on=("velocity",),
        formula="D w^3",
        reference="standard form: a polynomial of the third order, as the paper's eq (11) in case C1",
        words=Words(
            headline="drag that grows with the cube of the speed",
            meaning="Drag with the cube of the speed: a bearing whose load grows with the square of the"
            " speed.",
            hint=steady,
            kin=SPEED,
        ),
    )


def sublinear_viscous(setting: Setting) -> Iterator[Effect]:
    """Carreau's law with exponents 1/2 and 0: beside viscous and dry friction they make up the other laws.

    The model's own viscous friction is that at high speed, and a power law the limit of a low w_c. The
    exponent -1 is that of an eddy-current brake: its torque falls beyond a peak, as that of no lubricant
    does. As viscous friction it follows what scales the viscosity, such as temperature.
    """
    B = nonnegative("thinning_B", "N m s/rad", "viscous friction at low speed that is lost at high", "B")
    w_c = positive(
        "thinning_w", "rad/s", "speed above which it grows less than in proportion, motor side", "omega_c"
    )
    size = positive("thinning_x", "1", "root of 1 + (w/w_c)^2", "x")
    root = positive("thinning_root", "1", "its square root", "r")
    words = Words(
        headline="viscous friction that grows less than proportionally to speed",
        meaning=(
            "Viscous friction of a lubricant that thins with shear or heat as the speed rises, by Carreau's"
            " law; Cross's, Eyring's and power laws are so close to it that a log seldom distinguishes them."
        ),
        hint="steady runs over at least a factor of ten in speed, warm and cold, in both directions",
        causes=(
            PossibleCause("grease or oil that thins by shear", FILM),
            PossibleCause("a lubricant that warms in its contacts as speed rises", FILM),
            PossibleCause("a seal"),
            PossibleCause("the excess part of the motor's iron losses", WITH_IRON),
        ),
        kin=SPEED,
    )
    whole = Definition(size, Magnitude(omega_m / w_c.symbol, sp.Integer(1)))
    halved = Definition(root, sp.sqrt(size.symbol))
    for variant, power, thinned, definitions in (
        ("n=0.5", "-1/4", root, (whole, halved)),
        ("n=0", "-1/2", size, (whole,)),
    ):
        yield addition(
            "sublinear_viscous",
            [(B, omega_m / thinned.symbol)],
            variant=variant,
            role=Role.VISCOUS,
            depends_on=("velocity",),
            formula=f"B w (1 + (w/w_c)^2)^({power})",
            reference=(
                "P. J. Carreau, Trans. Society of Rheology 16(1), 1972; M. M. Cross, J. Colloid Science"
                " 20(5), 1965; H. Eyring, J. Chemical Physics 4(4), 1936; greases: A. W. Sisko, Industrial &"
                " Engineering Chemistry 50(12), 1958; contacts: H. Spikes and J. Zhang, Tribology Letters"
                " 56(1), 2014; gears of robots: R. Waiboer, R. Aarts and B. Jonker, ECCOMAS Multibody"
                " Dynamics, 2005"
            ),
            definitions=definitions,
            covers=("eddy_current",),
            shapes=(Shape(w_c, setting.w_min, setting.w_max, "log", 12),),
            words=words,
        )


def eddy_current(setting: Setting) -> Iterator[Effect]:
    """The one effect of the family: an eddy-current brake."""
    D = nonnegative("eddy_D", "N m s/rad", "eddy-current damping at low speed", "D")
    w_c = positive("eddy_w", "rad/s", "speed of the greatest eddy-current torque, motor side", "omega_c")
    yield addition(
        "eddy_current",
        [(D, omega_m / (1 + (omega_m / w_c.symbol) ** 2))],
        role=Role.EDDY_CURRENT,
        depends_on=("velocity",),
        formula="D w/(1 + (w/w_c)^2)",
        reference="J. H. Wouterse, IEE Proceedings B 138(4), 1991",
        shapes=(Shape(w_c, 2.0 * setting.w_min, 0.8 * setting.w_max, "log", 12),),
        # The iron of other motors is laminated: its eddy currents are weaker above a speed that no motor has.
        only_with={"motor": ("eddy-current brake", "induction")},
        words=Words(
            headline="an eddy-current brake",
            meaning="Eddy currents, in a brake or as iron losses of the motor: viscous at low speed, weaker"
            " above a critical speed.",
            hint="steady runs below, at and far above the critical speed; removing the magnet removes the"
            " effect",
            kin=SPEED,
        ),
    )


def asymmetry(setting: Setting) -> Iterator[Effect]:
    """Coulomb and viscous asymmetry, the paper's eq (14) and (21) for one bearing.

    They are written with gates: at rest they add nothing, like the sign of 0.
    """
    C = quantity(
        "coulomb_asym", "N m", "half the difference in Coulomb friction between the directions", letter="c"
    )
    B = quantity(
        "viscous_asym",
        "N m s/rad",
        "half the difference in viscous friction between the directions",
        letter="b",
    )
    reference = "B. Armstrong-Hélouvry, P. Dupont and C. Canudas de Wit, Automatica 30(7), 1994; eq (14)"
    hint = (
        "the same speeds in both directions, with the current sensor's zero checked while the drive is off; a"
        " constant load on the link looks the same, and is T_load in the rig"
    )
    dry = Words(
        headline="Coulomb friction that differs between the directions",
        meaning="Dry friction that differs by direction.",
        causes=(PossibleCause("a tilted bearing or seal"), PossibleCause("a tilted brush", BRUSHED)),
        hint=hint,
        tell_apart={
            "current_bias": "Log the voltage as well, or the current at rest.",
            "cable_spring": "Turn the link ten times as far in one direction.",
        },
    )
    apart = "half the difference between the directions"
    # Beside a voltage, the offset of the current sensor is an effect of its own.
    if not setting.measured_twice:
        dry = replace(
            dry,
            headline=f"{dry.headline}, or an offset of the drive's sensor",
            meaning="Dry friction that differs by direction, or an offset of the drive sensor: in"
            " motion they look the same.",
        )
    yield addition(
        "coulomb_asymmetry",
        [(C, forward + backward)],
        role=Role.COULOMB,
        depends_on=("direction",),
        formula="c while moving, whichever way: Coulomb friction C_m + c forwards, C_m - c backwards",
        reference=reference,
        aliases=() if setting.has("voltage") else ("current_bias",),
        special_of=("cable_spring",),
        plausible=part_of_dry(setting, C.symbol, apart, either_sign=True),
        words=dry,
    )
    yield addition(
        "viscous_asymmetry",
        [(B, omega_m * (forward - backward))],
        role=Role.VISCOUS,
        depends_on=("direction", "velocity"),
        formula="b |w|: viscous friction B_m + b forwards, B_m - b backwards",
        reference=reference,
        plausible=part_of_viscous(setting, B.symbol, apart, either_sign=True),
        words=Words(
            headline="viscous friction that differs between the directions",
            meaning="Viscous friction that differs by direction.",
            causes=(
                PossibleCause("a seal lip"),
                PossibleCause("grease pumped in one direction", {"lubricant": ("grease",)}),
            ),
            hint=hint,
        ),
    )
