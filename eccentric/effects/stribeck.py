"""Stribeck friction: alone, in proportion to a load, and of a film whose viscosity falls with temperature."""

from __future__ import annotations

import math
from collections.abc import Iterator

import sympy as sp

from eccentric.effects.effect import LOAD, SPEED, TEMPERATURE, Effect, Plausible, Setting, Shape, Words
from eccentric.effects.forms import (
    F_N,
    addition,
    direction,
    mu,
    nonnegative,
    omega_m,
    positive,
    reference_temperature,
    root,
    speed,
    temperature,
    weight,
)
from eccentric.effects.loads import gear_loads, gear_loss
from eccentric.effects.temperature import FILM, thinning
from eccentric.model import Load, Quantity, Role
from eccentric.model import vocabulary as v

SERVOS = (
    "M. Duclusaud et al., github.com/Rhoban/bam, fitted to geared servos from XL-320 to MX-106, 2024:"
    " 0.12 to 2.0 rad/s at the output"
)
JOINT = "A. C. Bittencourt and S. Gunnarsson, J. Dynamic Systems, Measurement and Control 134(5), 2012"
SERVO = "M. Duclusaud, G. Passault, V. Padois and O. Ly, arXiv:2410.08650, 2024"
HERSEY = "M. D. Hersey, J. Washington Academy of Sciences 4, 1914"


def _at_the_output(velocity: Quantity) -> Plausible:
    """The Stribeck velocity of a drive, which is known of small geared servos only."""
    return Plausible(
        mu * velocity.symbol,
        "rad/s",
        0.0,
        math.inf,
        f"none but of servos: {SERVOS}",
        "the Stribeck velocity at the output",
        above="a slow fall of friction that has another cause",
        by_part={"spur": (0.12, 2.0, SERVOS)},
    )


def stribeck(setting: Setting) -> Iterator[Effect]:
    """One effect for each exponent d."""
    A = nonnegative("stribeck_A", "N m", "Stribeck torque: increase of the friction near rest", "A")
    w_s = positive("stribeck_v", "rad/s", "Stribeck velocity, motor side", "v")
    words = Words(
        title="Stribeck friction",
        meaning="Dry friction that is higher at low speed, until a film of lubricant carries the load.",
        hint="steady runs at several speeds below and around the Stribeck velocity, in both directions",
        kin=SPEED,
        tell_apart={"presliding": "Move slowly below the Stribeck velocity, far from reversals."},
    )
    ratio = speed / w_s.symbol
    half, definitions = root("stribeck", omega_m / w_s.symbol, "speed over the Stribeck velocity")
    # A general exponent would require `pow`; these are the four in use.
    for d, power in {"0.5": half, "1": ratio, "1.5": ratio * half, "2": ratio**2}.items():
        yield addition(
            "stribeck",
            [(A, sp.exp(-power) * direction)],
            variant=f"d={d}",
            role=Role.STRIBECK,
            depends_on=("velocity",),
            formula=f"A exp(-(|w|/v)^{d}) sgn w",
            reference="R. Stribeck, Zeitschrift des VDI 46, 1902; with an exponent L. C. Bo and D. Pavelescu,"
            " Wear 82(3), 1982",
            definitions=definitions if power.has(half) else (),
            # Bristles that bend over no angle at all leave LuGre's g(w) alone; under a constant load, or at
            # one temperature, Stribeck friction that follows it is this one.
            special_of=("presliding", "stribeck_load", "stribeck_temperature"),
            plausible=(_at_the_output(w_s),),
            shapes=(Shape(w_s, setting.w_min, 0.6 * setting.w_max, "log", 12),),
            words=words,
            headline=f"Stribeck friction with exponent {d}",
        )


LEAST = 0.4
"""The least Stribeck speed over w*, at which centrifugal force and weight are equal, for which F_N is more
than the weight: there it varies by 0.16. Below, Stribeck friction by F_N is `stribeck`."""


def stribeck_load(setting: Setting) -> Iterator[Effect]:
    """By the torque of the gear with two exponents; in case C2 by F_N as well, with a constant velocity.

    Not by F_N if the log has no speed at which that is much more than the weight.
    """
    eta = nonnegative(
        "loadrise_eta", "1", "increase of the gear's friction near rest per transmitted torque", "eta"
    )
    C = nonnegative("loadrise_C", "m", "increase of the link's friction near rest per normal force", "C")
    w_s = positive("loadrise_v", "rad/s", "Stribeck velocity, motor side", "v")
    words = Words(
        title="Stribeck friction that follows the load",
        meaning="The increase of friction near rest grows with the load, as dry friction does.",
        hint="slow runs through whole turns, below the Stribeck velocity, with two masses",
        kin=LOAD,
        tell_apart={
            "stribeck": "Run slowly through whole turns: the load varies, the speed does not.",
            "load_dependent": "Hold several speeds below and far above the Stribeck velocity, under load.",
        },
    )
    for load in gear_loads("loadrise", setting):
        for d in (1, 2):
            yield gear_loss(
                "stribeck_load",
                load,
                [(eta, sp.Abs(load.torque) * sp.exp(-((speed / w_s.symbol) ** d)) * direction)],
                variant=f"{load.variant},d={d}",
                role=Role.STRIBECK,
                depends_on=(load.variable, "velocity"),
                formula=f"eta |T| exp(-(|w|/v)^{d}) sgn w, T = {load.formula}",
                reference=f"{JOINT}; {SERVO}",
                shapes=(Shape(w_s, setting.w_min, 0.4 * setting.w_max, "log", 8),),
                plausible=(_at_the_output(w_s),),
                words=words,
                headline=f"Stribeck friction with exponent {d} that follows the {load.variant} torque",
            )
    if setting.case == "C1":
        return
    still, pull = weight(setting), setting.known.get("M", 0.0) * setting.known.get("L", 0.0)
    least = LEAST * math.sqrt(still / pull) / setting.mu if pull > 0.0 else math.inf
    if setting.mean_force:
        # The force on a joint of an arm varies by the motion of the others, at any speed.
        least = 0.0
    low, high = max(least, setting.w_min), 0.6 * setting.w_max
    if still and low < high:
        yield addition(
            "stribeck_load",
            [(C, mu * F_N * sp.exp(-((speed / w_s.symbol) ** 2)) * direction)],
            variant="F_N",
            role=Role.STRIBECK,
            load=Load.NORMAL,
            depends_on=("velocity", "link_angle"),
            formula="C mu F_N exp(-(|w|/v)^2) sgn w",
            reference=f"eq (9), its Coulomb part; R. Stribeck, Zeitschrift des VDI 46, 1902; {HERSEY}",
            shapes=(Shape(w_s, low, high, "log", 4),),
            inputs=(v.theta_m,),
            plausible=(_at_the_output(w_s),),
            words=words,
            headline="Stribeck friction in proportion to the normal force",
        )


def stribeck_temperature(setting: Setting) -> Iterator[Effect]:
    """The one effect of the family; none if no temperature is logged."""
    if setting.temperature_mid is None:
        return
    A = nonnegative("filmrise_A", "N m", "Stribeck torque: increase of the friction near rest", "A")
    w_s = positive("filmrise_v", "rad/s", "Stribeck velocity at T_0, motor side", "v")
    b = nonnegative("filmrise_b", "1/K", "relative fall of the viscosity per kelvin", "b")
    zero = reference_temperature("filmrise", setting.temperature_mid)
    thinner = sp.exp(-b.symbol * (temperature - zero.symbol))
    yield addition(
        "stribeck_temperature",
        [(A, sp.exp(-speed * thinner / w_s.symbol) * direction)],
        role=Role.STRIBECK,
        depends_on=("temperature", "velocity"),
        formula="A exp(-|w| exp(-b (T - T_0))/v) sgn w",
        reference=f"{HERSEY}; {JOINT}",
        shapes=(
            # At the median temperature: cold it is a fraction of that, and below 0.4 w_max as in `stribeck`.
            Shape(w_s, setting.w_min, setting.w_max, "log", 9),
            # Below 0.5 % per kelvin it is `stribeck`; oils lose 2 to 6 %.
            Shape(b, 0.005, 0.1, "log", 4),
        ),
        definitions=(zero,),
        inputs=(v.temperature,),
        needs=("temperature",),
        only_with=FILM,
        plausible=(thinning(b.symbol),),
        words=Words(
            headline="Stribeck friction whose velocity rises with temperature",
            meaning="A warm film of lubricant is thin and needs a higher speed to carry the load: the"
            " Stribeck velocity rises as the viscosity falls, at a constant product of both (Hersey number).",
            hint="slow runs at several speeds below and around the Stribeck velocity, cold and warm",
            kin=TEMPERATURE,
            tell_apart={"stribeck": "Repeat slow runs at several speeds over a ramp of 20 K or more."},
        ),
    )
