"""Effects: what a model may lack, each a record that extends it; one file for each family or formula.

In: a `Setting`, the base model and the ranges that a log covers.  Out: `library` (every effect of the
toolkit), `load_effects` (those of a person's file); `Effect.extend` -> a `Model` with the effect.
May import: `model`.
"""

from __future__ import annotations

from types import MappingProxyType

from eccentric.effects import (
    angle_offset,
    armature,
    asymmetry,
    backlash,
    bearing_load,
    cable_spring,
    cogging,
    coulomb_temperature,
    current_bias,
    current_scale,
    drag,
    eddy_current,
    encoder_eccentricity,
    gear_efficiency,
    gravity_tilt,
    hidden_thermal_drift,
    inertia_mismatch,
    inverter_deadtime,
    joint_compliance,
    kinematic_error,
    kt_ripple,
    kt_saturation,
    link_harmonic_friction,
    load_dependent,
    local_defect,
    magnet_temperature,
    magnetic_hysteresis,
    mass_mismatch,
    motor_harmonic_friction,
    nonsynchronous_friction,
    presliding,
    resistance_temperature,
    sensor_delay,
    stribeck,
    stribeck_load,
    stribeck_temperature,
    sublinear_viscous,
    time_drift,
    viscosity_temperature,
    wear_runin,
)
from eccentric.effects.constant_load import effect as constant_load
from eccentric.effects.constant_load import with_constant_load
from eccentric.effects.effect import (
    LOAD,
    Correction,
    Effect,
    Evidence,
    Kin,
    Plausible,
    Setting,
    Shape,
    Words,
    load_effects,
    measurement_between,
)
from eccentric.effects.empirical import ANGLES, Curve, empirical_term, variable_of
from eccentric.effects.nonsynchronous_friction import HIGHEST as HIGHEST_ORDER
from eccentric.effects.sensor_delay import BOUNDS as CURRENT_DELAYS_S

__all__ = [
    "ANGLES",
    "CURRENT_DELAYS_S",
    "FAMILIES",
    "HIGHEST_ORDER",
    "LOAD",
    "Correction",
    "Curve",
    "Effect",
    "Evidence",
    "Kin",
    "Plausible",
    "Setting",
    "Shape",
    "Words",
    "base_aliases",
    "constant_load",
    "empirical_term",
    "library",
    "load_effects",
    "measurement_between",
    "variable_of",
    "with_constant_load",
]

FAMILIES = MappingProxyType(
    {
        "stribeck": stribeck,
        "stribeck_load": stribeck_load,
        "stribeck_temperature": stribeck_temperature,
        "quadratic_drag": drag,
        "cubic_drag": drag,
        "oneway_windage": drag,
        "sublinear_viscous": sublinear_viscous,
        "eddy_current": eddy_current,
        "viscosity_temperature": viscosity_temperature,
        "coulomb_temperature": coulomb_temperature,
        "hidden_thermal_drift": hidden_thermal_drift,
        "coulomb_asymmetry": asymmetry,
        "viscous_asymmetry": asymmetry,
        "link_harmonic_friction": link_harmonic_friction,
        "motor_harmonic_friction": motor_harmonic_friction,
        "nonsynchronous_friction": nonsynchronous_friction,
        "cogging": cogging,
        "kt_ripple": kt_ripple,
        "local_defect": local_defect,
        "bearing_load": bearing_load,
        "load_dependent": load_dependent,
        "gear_efficiency": gear_efficiency,
        "presliding": presliding,
        "backlash": backlash,
        "cable_spring": cable_spring,
        "gravity_tilt": gravity_tilt,
        "angle_offset": angle_offset,
        "mass_mismatch": mass_mismatch,
        "inertia_mismatch": inertia_mismatch,
        "ki_mismatch": current_scale,
        "kt_saturation": kt_saturation,
        "magnet_temperature": magnet_temperature,
        "magnetic_hysteresis": magnetic_hysteresis,
        "current_bias": current_bias,
        "inverter_deadtime": inverter_deadtime,
        "resistance_temperature": resistance_temperature,
        "ke_mismatch": armature,
        "resistance_mismatch": armature,
        "armature_inductance": armature,
        "wear_runin": wear_runin,
        "time_drift": time_drift,
        "sensor_delay": sensor_delay,
        "encoder_eccentricity": encoder_eccentricity,
        "kinematic_error": kinematic_error,
        "joint_compliance": joint_compliance,
    }
)
"""Family -> the module whose `effects(setting)` makes its records."""


def library(setting: Setting) -> tuple[Effect, ...]:
    """Every effect that applies to the model and whose channels are logged, in the order of FAMILIES."""
    made = [effect for module in dict.fromkeys(FAMILIES.values()) for effect in module.effects(setting)]
    return tuple(e for e in made if setting.has(*e.evidence.needs) and e.applies_to(setting.base))


def base_aliases(case: str) -> dict[str, str]:
    """Families that the base model of a case ("C1", "C2") already contains, with the column that they equal.

    No log of the case can show them in addition to the model, so `library` omits them. The file of a family
    names them in `IN_C1`; the base model of C2 contains none.
    """
    if case != "C1":
        return {}
    declared = (getattr(module, "IN_C1", {}) for module in dict.fromkeys(FAMILIES.values()))
    return {family: column for of_module in declared for family, column in of_module.items()}
