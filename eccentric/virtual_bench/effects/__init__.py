"""Effects missing in the paper's model: one builder per family, independent of the toolkit.

`EFFECTS` maps a family to its builder, `builder(request) -> PlantedEffect`, and `VARIANTS` to its variants,
if any. A builder draws the shape; the amplitude is a first guess for the requested strength, which the
simulation then measures and corrects.
"""

from eccentric.virtual_bench.effects import circuit, geometry, loads, speed
from eccentric.virtual_bench.effects.record import (
    Builder,
    Law,
    PlantedEffect,
    PlantSetting,
    Request,
    Requested,
    back_driven,
    bearing_law,
    check_strength,
    check_values,
    gear_loss,
    known_family,
    simply,
    with_strengths,
)

EFFECTS: dict[str, Builder] = {
    name: builder
    for file in (speed, speed, geometry, loads, circuit)
    for name, builder in vars(file).items()
    if getattr(builder, "__module__", "") == file.__name__ and not name.startswith("_")
}
"""Every public function of these files."""

VARIANTS = {
    "link_harmonic_friction": ("n=1", "n=2", "n=3", "n=4"),
    "motor_harmonic_friction": ("n=2", "n=13"),
    "cogging": ("n=2", "n=4", "n=6"),
    "kt_ripple": ("n=2", "n=4", "n=6"),
    "viscosity_temperature": ("exponential", "arrhenius"),
    "load_dependent": ("gravity", "transmitted"),
    "gear_efficiency": ("easy", "hard"),
    "bearing_load": ("Hertz", "Palmgren", "preload"),
    "stribeck_load": ("gravity", "transmitted", "F_N"),
    "presliding": ("dahl", "lugre"),
    "sublinear_viscous": ("Eyring", "Cross", "power law"),
    "encoder_eccentricity": ("motor", "link"),
    "kinematic_error": ("motor,n=1", "motor,n=2", "link,n=1", "link,n=2"),
}
"""Variants of a family, by its id; a family without an entry has none."""
