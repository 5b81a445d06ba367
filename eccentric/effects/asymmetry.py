"""Friction that differs between the directions of motion, the paper's eq (14) and (21) for one bearing."""

from __future__ import annotations

from dataclasses import replace

from eccentric.effects.effect import Effect, Setting, Words
from eccentric.effects.forms import addition, omega_m
from eccentric.model import Backward, Forward, Role, quantity

C = quantity(
    "coulomb_asym", "N m", "half the difference in Coulomb friction between the directions", letter="c"
)
B = quantity(
    "viscous_asym",
    "N m s/rad",
    "half the difference in viscous friction between the directions",
    letter="b",
)
REFERENCE = "B. Armstrong-Hélouvry, P. Dupont and C. Canudas de Wit, Automatica 30(7), 1994; eq (14)"
HINT = (
    "the same speeds in both directions, with the current sensor's zero checked while the drive is off; a"
    " constant load on the link looks the same, and is T_load in the rig"
)
DRY = Words(
    headline="Coulomb friction that differs between the directions",
    meaning="Dry friction that differs by direction: a tilted bearing, seal or brush.",
    hint=HINT,
    tell_apart={
        "current_bias": "Log the voltage as well, or the current at rest.",
        "cable_spring": "Turn the link ten times as far in one direction.",
    },
)
DRY_OR_OFFSET = replace(
    DRY,
    headline="Coulomb friction that differs between the directions, or an offset of the drive's sensor",
    meaning="Dry friction that differs by direction (a tilted bearing, seal or brush), or an offset of the"
    " sensor of the drive: in motion they are the same.",
)
VISCOUS = Words(
    headline="viscous friction that differs between the directions",
    meaning="Viscous friction that differs by direction: a seal lip, or grease pumped in one direction.",
    hint=HINT,
)


def effects(setting: Setting) -> tuple[Effect, ...]:
    """Coulomb and viscous asymmetry, written with gates: at rest they add nothing, like the sign of 0."""
    forward, backward = Forward(omega_m), Backward(omega_m)
    dry = addition(
        "coulomb_asymmetry",
        [(C, forward + backward)],
        role=Role.COULOMB,
        depends_on=("direction",),
        formula="c while moving, whichever way: Coulomb friction C_m + c forwards, C_m - c backwards",
        reference=REFERENCE,
        aliases=() if setting.has("voltage") else ("current_bias",),
        special_of=("cable_spring",),
        # Beside a voltage, the offset of the current sensor is an effect of its own.
        words=DRY if setting.measured_twice else DRY_OR_OFFSET,
    )
    viscous = addition(
        "viscous_asymmetry",
        [(B, omega_m * (forward - backward))],
        role=Role.VISCOUS,
        depends_on=("direction", "velocity"),
        formula="b |w|: viscous friction B_m + b forwards, B_m - b backwards",
        reference=REFERENCE,
        words=VISCOUS,
    )
    return dry, viscous
