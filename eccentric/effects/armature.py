"""Constants of the armature equation: corrections of the declared ones, and the inductance."""

from __future__ import annotations

from eccentric.effects.effect import Correction, Effect, Setting, Words
from eccentric.effects.forms import addition, current_slope, omega_m
from eccentric.model import quantity
from eccentric.model import vocabulary as v

resistance = quantity("armature_R", "Ohm", "true resistance minus the declared one", letter="Delta R")
back_emf = quantity(
    "armature_k", "V s/rad", "true back-EMF constant minus the declared one", letter="Delta k_e"
)
inductance = quantity("armature_L", "V s/A", "inductance of the armature", "", "nonnegative", letter="L_a")
BACK_EMF = Words(
    headline="a correction of the declared back-EMF constant",
    meaning="The back-EMF constant differs from the declared one: a different winding, or weakened magnets.",
    hint="drive the motor externally with its terminals open and read the voltage",
)
RESISTANCE = Words(
    headline="a correction of the declared resistance",
    meaning="The resistance differs from the declared one: cable, brushes, a warm winding.",
    hint="the locked rotor at several currents",
)
INDUCTANCE = Words(
    headline="the inductance of the armature",
    meaning="The winding's inductance, which the paper neglects: a voltage by the rate of the current.",
    hint="voltage steps with a locked rotor, finely sampled; a sensor's delay shows in the torque as well",
)
NEEDS = ("current", "voltage")
REFERENCE = "standard form; armature circuit: W. Leonhard, Control of Electrical Drives, Springer"


def effects(setting: Setting) -> tuple[Effect, ...]:
    """Back-EMF constant, resistance and inductance; the first two are not known if only voltage is logged."""
    return (_inductance(),) if setting.by_voltage else (*_constants(), _inductance())


def _constants() -> tuple[Effect, Effect]:
    back_emf_constant = addition(
        "ke_mismatch",
        [(back_emf, omega_m)],
        kind="back_emf",
        balance="electrical",
        depends_on=("velocity",),
        formula="(k_e + dk) for k_e",
        corrects=Correction(v.k_e, v.k_e.symbol + back_emf.symbol, tolerance=0.02),
        special_of=("magnet_temperature",),
        reference=REFERENCE,
        needs=NEEDS,
        words=BACK_EMF,
    )
    true_resistance = addition(
        "resistance_mismatch",
        [(resistance, v.i.symbol)],
        kind="actuator",
        balance="electrical",
        depends_on=("current",),
        formula="(R + dR) for R",
        corrects=Correction(v.R, v.R.symbol + resistance.symbol, tolerance=0.02),
        special_of=("resistance_temperature",),
        reference=REFERENCE,
        needs=NEEDS,
        words=RESISTANCE,
    )
    return back_emf_constant, true_resistance


def _inductance() -> Effect:
    slope, states = current_slope("armature")
    return addition(
        "armature_inductance",
        [(inductance, slope)],
        kind="actuator",
        balance="electrical",
        depends_on=("current",),
        formula="L di/dt",
        reference=REFERENCE,
        states=states,
        needs=NEEDS,
        words=INDUCTANCE,
    )
