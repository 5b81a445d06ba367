"""Effects: what a model may lack, each a record that extends it; one file for each subject.

In: a `Setting`, the base model and the ranges that a log covers.  Out: `library` (every effect of the
toolkit), `load_effects` (those of a person's file); `Effect.extend` -> a `Model` with the effect.
May import: `model`.
"""

from __future__ import annotations

from types import MappingProxyType

from eccentric.effects import (
    conservative,
    declared,
    harmonics,
    history,
    kinematic_error,
    loads,
    motor,
    speed,
    stribeck,
    temperature,
)
from eccentric.effects.backlash import backlash
from eccentric.effects.conservative import constant_load, with_constant_load
from eccentric.effects.effect import (
    LOAD,
    Correction,
    Effect,
    Evidence,
    Kin,
    Plausible,
    PossibleCause,
    Setting,
    Shape,
    Words,
    load_effects,
    measurement_between,
)
from eccentric.effects.empirical import ANGLES, Curve, empirical_term, variable_of
from eccentric.effects.harmonics import HIGHEST as HIGHEST_ORDER
from eccentric.effects.motor import CURRENT_DELAYS_S

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
    "PossibleCause",
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
]  # fmt: skip

FAMILIES = MappingProxyType(
    {
        "stribeck": stribeck.stribeck,
        "stribeck_load": stribeck.stribeck_load,
        "stribeck_temperature": stribeck.stribeck_temperature,
        "quadratic_drag": speed.drag,
        "cubic_drag": speed.drag,
        "oneway_windage": speed.drag,
        "sublinear_viscous": speed.sublinear_viscous,
        "eddy_current": speed.eddy_current,
        "viscosity_temperature": temperature.viscosity_temperature,
        "coulomb_temperature": temperature.coulomb_temperature,
        "hidden_thermal_drift": temperature.hidden_thermal_drift,
        "coulomb_asymmetry": speed.asymmetry,
        "viscous_asymmetry": speed.asymmetry,
        "link_harmonic_friction": harmonics.link_harmonic_friction,
        "motor_harmonic_friction": harmonics.motor_harmonic_friction,
        "nonsynchronous_friction": harmonics.nonsynchronous_friction,
        "cogging": harmonics.cogging,
        "kt_ripple": harmonics.kt_ripple,
        "local_defect": harmonics.local_defect,
        "bearing_load": loads.bearing_load,
        "load_dependent": loads.load_dependent,
        "gear_efficiency": loads.gear_efficiency,
        "presliding": history.presliding,
        "backlash": backlash,
        "cable_spring": conservative.cable_spring,
        "gravity_tilt": conservative.gravity_tilt,
        "angle_offset": conservative.angle_offset,
        "mass_mismatch": declared.mass_mismatch,
        "inertia_mismatch": declared.inertia_mismatch,
        "ki_mismatch": declared.ki_mismatch,
        "kt_saturation": motor.kt_saturation,
        "magnet_temperature": motor.magnet_temperature,
        "magnetic_hysteresis": motor.magnetic_hysteresis,
        "current_bias": motor.current_bias,
        "inverter_deadtime": motor.inverter_deadtime,
        "resistance_temperature": motor.resistance_temperature,
        "ke_mismatch": declared.armature_mismatch,
        "resistance_mismatch": declared.armature_mismatch,
        "armature_inductance": motor.armature_inductance,
        "wear_runin": history.wear_runin,
        "time_drift": history.time_drift,
        "sensor_delay": motor.sensor_delay,
        "encoder_eccentricity": kinematic_error.encoder_eccentricity,
        "kinematic_error": kinematic_error.kinematic_error,
        "joint_compliance": kinematic_error.joint_compliance,
    }
)
"""Family -> the function that makes its records for a setting."""


def library(setting: Setting) -> tuple[Effect, ...]:
    """Every effect that applies to the model and whose channels are logged, in the order of FAMILIES."""
    made = [effect for effects in dict.fromkeys(FAMILIES.values()) for effect in effects(setting)]
    return tuple(e for e in made if setting.has(*e.evidence.needs) and e.applies_to(setting.base))


def base_aliases(case: str) -> dict[str, str]:
    """Families that the base model of a case ("C1", "C2") already contains, with the column that they equal.

    No log of the case can show them in addition to the model, so `library` omits them. The file of a family
    names them in `IN_C1`; the base model of C2 contains none.
    """
    if case != "C1":
        return {}
    columns = speed.IN_C1 | loads.IN_C1 | conservative.IN_C1 | declared.IN_C1 | kinematic_error.IN_C1
    return {family: columns[family] for family in FAMILIES if family in columns}
