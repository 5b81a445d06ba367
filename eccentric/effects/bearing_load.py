"""Friction of the link's bearing that is not in proportion to F_N."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import LOAD, Effect, Plausible, Setting, Shape, Words
from eccentric.effects.forms import addition, constant, direction, weight
from eccentric.model import Definition, Load, Magnitude, Quantity, Role, quantity
from eccentric.model import vocabulary as v

C = quantity(
    "bearing_C",
    "m",
    "Coulomb friction of the link per normal force, where that is the weight",
    "",
    "nonnegative",
    letter="C",
)
ratio = quantity("bearing_r", "1", "normal force over the weight", "", "positive", letter="r")
C_p = quantity(
    "bearing_Cp", "m", "Coulomb friction of the preloaded bearing per force", "", "nonnegative", letter="C_p"
)
preload = quantity(
    "bearing_Fp", "N", "preload of the bearing, across the normal force", "", "positive", letter="F_p"
)
total = quantity("bearing_F", "N", "force on the preloaded bearing", "", "positive", letter="F")

ROLLING = ("ball", "roller")
CONTACTS = (*ROLLING, "plain")
HERTZ = "K. L. Johnson, Contact Mechanics, Cambridge University Press, 1985 (area of a Hertzian contact)"
PALMGREN = (
    "A. Palmgren, Ball and Roller Bearing Engineering, SKF Industries, 1959; rolling: J. A. Greenwood,"
    " H. Minshall and D. Tabor, Proc. Royal Society A 259, 1961"
)
TABLES = "SKF, Rolling Bearings, 2016, table of constant coefficients; JTEKT, Bearing Knowledge 8-4, undated"


def _coefficient(lever: Quantity) -> Plausible:
    """The least coefficient of friction that a bearing can have: that of one as wide as the link is long."""
    return Plausible(
        lever.symbol / v.L.symbol,
        "1",
        0.0,
        0.2,
        f"plain bearings: {TABLES}",
        "the coefficient of friction of the bearing, if it were as wide as the link is long,",
        above="not the bearing alone",
        by_part=dict.fromkeys(ROLLING, (0.0, 0.005, TABLES)),
    )


WORDS = Words(
    title="Bearing friction that is not in proportion to its load",
    meaning=(
        "Dry friction of the link's bearing by a power of its load (rolling bearings: 4/3 to 1.55; Hertzian"
        " contact: 1/2 to 2/3), or under a preload."
    ),
    hint="the same speeds with two masses or more, up to speeds at which the load more than doubles",
    kin=LOAD,
)

IN_C1 = {
    "bearing_load": "w and w^3, the columns of B_m and B_lN: the powers 1/2 and 3/2 of F_N, M L omega_l^2",
}


def effects(setting: Setting) -> tuple[Effect, ...]:
    """By the power 1/2 or 3/2 of F_N, and with a preload across it; none without gravity or an imbalance.

    One power below 1 and one above are enough: after the model's own columns, 1 and F_N, have taken their
    part, 1/2 and 2/3 are the same to a thousandth, and so are 4/3, 3/2 and 1.55. A preload along F_N is the
    constant part of the model. In case C1 the powers are w and w^3, and of what a preload changes
    a few hundredths are left.
    """
    known = {name: setting.known.get(name, 0.0) for name in ("M", "L")}
    still = weight(setting)
    if not setting.mean_force and (setting.case == "C1" or not still * known["M"] * known["L"]):
        return ()
    what = "mean normal force of the log" if setting.mean_force else "weight of mass and link"
    own = constant("bearing_weight", "N", what, still, "F_0")
    # Never 0, so that the slope of its root is finite.
    relative = Definition(ratio, v.F_N.symbol / own.symbol + sp.Rational(1, 10**12))
    half = sp.sqrt(ratio.symbol)
    across = Definition(total, Magnitude(v.F_N.symbol, preload.symbol))
    shape = Shape(preload, 0.1 * still, 3.0 * still, "log", 5)
    power = "C mu F_0 (F_N/F_0)^({}) sgn w, F_0 the weight"
    return (
        _by(
            "degressive", C, own.symbol * half, (own, relative), (), CONTACTS, power.format("1/2"), HERTZ,
            "bearing friction that grows more slowly than the normal force",
        ),
        _by(
            "progressive", C, v.F_N.symbol * half, (own, relative), (), ROLLING, power.format("3/2"),
            PALMGREN, "bearing friction that grows faster than the normal force",
        ),
        _by(
            "preload", C_p, total.symbol, (across,), (shape,), ROLLING, "C_p mu sqrt(F_N^2 + F_p^2) sgn w",
            "standard form: radial and axial load added as vectors", "a preload of the link's bearing",
        ),
    )  # fmt: skip


def _by(
    variant: str, coefficient: Quantity, force: sp.Expr, definitions: tuple[Definition, ...],
    shapes: tuple[Shape, ...], parts: tuple[str, ...], formula: str, reference: str, headline: str,
) -> Effect:  # fmt: skip
    return addition(
        "bearing_load",
        [(coefficient, v.mu.symbol * force * direction)],
        variant=variant,
        role=Role.COULOMB,
        load=Load.NORMAL,
        depends_on=("velocity", "link_angle"),
        formula=formula,
        reference=reference,
        shapes=shapes,
        definitions=definitions,
        inputs=(v.theta_m,),
        only_with={"bearing": parts},
        plausible=(_coefficient(coefficient),),
        words=replace(WORDS, headline=headline),
    )
