"""Losses of the gear that differ between driving and being driven."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import LOAD, Effect, Setting, Shape, Words
from eccentric.effects.forms import addition, direction
from eccentric.effects.load_dependent import FORMULAS, efficiency, loads
from eccentric.model import GEARS, Definition, Load, Role, quantity
from eccentric.model import vocabulary as v

eta = quantity("gear_eta", "1", "loss of the gear per torque, driving", "", "nonnegative", letter="eta")
rho = quantity(
    "gear_rho",
    "1",
    "loss of the gear, back-driven over driving",
    "",
    "nonnegative",
    letter="rho",
)
share = quantity("gear_share", "1", "link's share of the friction without F_N", "", "nonnegative", letter="s")
load = quantity("gear_torque", "N m", "torque that the gear transmits, motor side", letter="T")
WORDS = Words(
    title="Gear losses that differ between driving and being driven",
    meaning="A gear whose losses differ between driving the load and being driven by it.",
    hint="raise and lower the mass slowly at the same speeds: the losses should differ",
    kin=LOAD,
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """By the transmitted torque, inertia included, and in case C2 by the gravity load alone.

    |load| sgn w where the load resists and rho |load| sgn w where it drives equals, without a case
    distinction, the mean of both factors times |load| sgn w plus half their difference times the load.
    """
    inputs = () if setting.case == "C1" else (v.theta_m,)
    both, differ = (1 + rho.symbol) / 2, (1 - rho.symbol) / 2
    # At rest the gear adds nothing, hence the squared direction.
    basis = both * sp.Abs(load.symbol) * direction + differ * load.symbol * direction**2
    return tuple(
        addition(
            "gear_efficiency",
            [(eta, basis)],
            variant=variant + ending,
            role=Role.COULOMB,
            load=Load.TRANSMITTED,
            depends_on=(variable, "direction"),
            formula=f"eta |T| sgn w driving, rho eta |T| sgn w back-driven, T = {FORMULAS[variant]}",
            reference="A. Gogoussis and M. Donath, IEEE ICRA 1987; T. Verstraten et al., IEEE Robotics"
            " and Automation Letters 1(1), 2016",
            shapes=(*(Shape(share, *span) for span in shapes), ratios),
            definitions=(*constants, Definition(load, torque)),
            inputs=inputs,
            only_with={"gear": GEARS},
            plausible=(efficiency(eta.symbol),),
            words=replace(WORDS, headline=headline + f", by the {variant} torque"),
        )
        for variant, variable, torque, constants, shapes in loads("gear", setting, share.symbol)
        for ending, headline, ratios in (
            (
                "",
                "gear losses that differ between driving and being driven",
                Shape(rho, 0.0, 0.8, "linear", 5),
            ),
            # A gear that is near to locking itself. Between the two it is `load_dependent`.
            (
                ",driven",
                "gear losses that are larger when the load drives the motor",
                Shape(rho, 1.25, 4.0, "log", 4),
            ),
        )
    )
