"""Drag: torque by a power of the speed, in both directions (air, oil, a seal) or one (a fan)."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from eccentric.effects.effect import SPEED, Effect, Setting, Words
from eccentric.effects.forms import addition, direction, omega_m
from eccentric.model import Backward, Forward, Role, quantity

quadratic = quantity(
    "drag_2", "N m s^2/rad^2", "drag torque per motor velocity squared", "", "nonnegative", letter="D"
)
cubic = quantity(
    "drag_3",
    "N m s^3/rad^3",
    "drag torque per motor velocity cubed",
    "",
    "nonnegative",
    letter="D",
)
WINDAGE = "J. E. Vrancik, NASA TN D-4849, 1968 (windage grows with the square of the speed)"
BY_SPEED = "steady runs over a speed range of 1 to 5 or more: over a narrow one, all powers fit equally well"
QUADRATIC = Words(
    headline="drag that grows with the square of the speed",
    meaning="Drag of air or oil in turbulent flow: it grows with the square of the speed.",
    hint=BY_SPEED,
    kin=SPEED,
)
CUBIC = Words(
    headline="drag that grows with the cube of the speed",
    meaning="Drag with the cube of the speed: a bearing whose load grows with the square of the speed.",
    hint=BY_SPEED,
    kin=SPEED,
)
ONE_WAY = Words(
    title="Windage in one direction only",
    meaning="Windage in one direction only: a fan, or blades bent to one side.",
    hint="the same high speeds in both directions",
    kin=SPEED,
)

# What the base model of case C1 already contains, and the column of it.
IN_C1 = {
    "quadratic_drag": "w|w|, the column of C_lN: F_N is M L omega_l^2",
    "cubic_drag": "w^3, the column of B_lN: F_N is M L omega_l^2",
}


def effects(setting: Setting) -> tuple[Effect, ...]:
    """Quadratic and cubic drag, and windage in either direction.

    In case C1 the first two are already columns of the model, see `IN_C1`, unless there is no mass, or runs
    carry different ones: F_N follows the mass, drag does not.
    """
    found = list(_oneway())
    unloaded = setting.known.get("M", 1.0) * setting.known.get("L", 1.0) == 0.0
    if setting.case == "C2" or setting.masses or unloaded:
        found += [
            addition(
                "quadratic_drag",
                [(quadratic, omega_m**2 * direction)],
                role=Role.DRAG,
                depends_on=("velocity",),
                formula="D w|w|",
                reference="S. S. Ge, T. H. Lee and S. X. Ren, Int. J. Systems Science 32(4), 2001",
                words=QUADRATIC,
            ),
            addition(
                "cubic_drag",
                [(cubic, omega_m**3)],
                role=Role.DRAG,
                depends_on=("velocity",),
                formula="D w^3",
                reference="standard form: a polynomial of the third order, as the paper's eq (11) in case C1",
                words=CUBIC,
            ),
        ]
    return tuple(found)


def _oneway() -> tuple[Effect, ...]:
    found = []
    for sign, name, which, gate in (
        (1, "pos", "positive", Forward(omega_m)),
        (-1, "neg", "negative", Backward(omega_m)),
    ):
        meaning = f"windage torque per motor velocity squared, omega_m {'>' if sign > 0 else '<'} 0"
        q = quantity(f"windage_{name}", "N m s^2/rad^2", meaning, "", "nonnegative", letter="D")
        found.append(
            addition(
                "oneway_windage",
                [(q, sp.Integer(sign) * omega_m**2 * gate)],
                variant=f"{'+' if sign > 0 else '-'}",
                role=Role.DRAG,
                depends_on=("velocity", "direction"),
                formula=f"D w|w| for w {'>' if sign > 0 else '<'} 0 only",
                reference=WINDAGE,
                words=replace(ONE_WAY, headline=f"windage in the {which} direction only"),
            )
        )
    return tuple(found)
