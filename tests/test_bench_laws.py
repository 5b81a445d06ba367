"""The law of each planted effect at random states of the rig, against its formula written down once more."""

from collections.abc import Callable
from dataclasses import replace
from math import asinh, copysign, cos, exp, pi, sin, sqrt

import numpy as np
import pytest

from eccentric.virtual_bench import EFFECTS, PlantedEffect
from eccentric.virtual_bench.plant import Motion, Plant
from tests.virtual import drawn_scenario

STATES = 25
Ports = dict[str, float]
Formula = Callable[[Motion, float, Plant, PlantedEffect], Ports]


def state(rng: np.random.Generator, plant: Plant) -> Motion:
    """A random state of the rig: nothing in it is zero, speeds and currents have either sign."""
    s = Motion(plant, theta=rng.uniform(-20.0, 20.0), w=rng.uniform(-40.0, 40.0))
    s.w_mid, s.link, s.w_link = s.w, plant.mu * s.theta, plant.mu * s.w
    s.t, s.travel, s.temperature = rng.uniform(1.0, 15.0), rng.uniform(1.0, 500.0), rng.uniform(10.0, 60.0)
    s.i, s.v, s.alpha = rng.uniform(-4.0, 4.0), rng.uniform(-4.0, 4.0), rng.uniform(-90.0, 90.0)
    s.normal = normal(s, plant)
    s.gravity = plant.mu * plant.M * plant.in_plane_gravity * plant.L * sin(s.link)
    s.link_dry, s.link_viscous = rng.uniform(0.01, 0.2), rng.uniform(1e-4, 1e-3)
    s.dry, s.viscous = s.link_dry + plant.C_m, s.link_viscous + plant.B_m
    return s


def normal(
    s: Motion, plant: Plant, mass: float = 0.0, shift: float = 0.0, gravity: float | None = None
) -> float:
    """Eq. (16) with another mass [kg], angle [rad] or gravity [m/s^2]."""
    M = mass or plant.M
    g = plant.in_plane_gravity if gravity is None else gravity
    pull, weight = M * plant.L * s.w_link**2, (M + plant.M_l) * g
    return sqrt(pull**2 + 2.0 * pull * weight * cos(s.link + shift) + weight**2)


def other_gravity(
    s: Motion, plant: Plant, mass: float = 0.0, shift: float = 0.0, gravity: float | None = None
) -> Ports:
    """What another mass, angle or gravity changes: the gravity torque, and friction by the normal force."""
    g = plant.in_plane_gravity if gravity is None else gravity
    load = plant.mu * (mass or plant.M) * g * plant.L * sin(s.link + shift)
    force = normal(s, plant, mass, shift, gravity)
    gamma, beta = (plant.gamma_T, plant.beta_T) if plant.case == "C1" else (0.0, 0.0)
    return {
        "torque": load - s.gravity,
        "dry": plant.mu * (plant.C_lN * force + gamma) - s.link_dry,
        "viscous": plant.mu**2 * (plant.B_lN * force + beta) - s.link_viscous,
    }


def one_way(s: Motion, e: PlantedEffect, value: float) -> float:
    """The value in the direction of the effect, else 0."""
    return value if copysign(1.0, s.w_mid) == e.shape[0] else 0.0


def bump(s: Motion, e: PlantedEffect) -> float:
    """A Gaussian of the shorter way from the link to the defect."""
    away = abs(s.link - e.shape[0]) % (2.0 * pi)
    return exp(-(min(away, 2.0 * pi - away) ** 2) / (2.0 * e.shape[1] ** 2))


def weight(plant: Plant) -> float:
    """Of mass and link [N]."""
    return (plant.M + plant.M_l) * plant.g


KELVIN = 273.15
FORMULAS: dict[str, Formula] = {
    "stribeck": lambda s, a, p, e: {"rise": a * exp(-(abs(s.w / e.shape[0]) ** e.shape[1]))},
    "quadratic_drag": lambda s, a, p, e: {"drag": a * abs(s.w)},
    "cubic_drag": lambda s, a, p, e: {"drag": a * s.w * s.w},
    "oneway_windage": lambda s, a, p, e: {"drag": one_way(s, e, a * abs(s.w))},
    "coulomb_asymmetry": lambda s, a, p, e: {"dry": one_way(s, e, a)},
    "viscous_asymmetry": lambda s, a, p, e: {"viscous": one_way(s, e, a)},
    "eddy_current": lambda s, a, p, e: {"drag": a * e.shape[0] ** 2 / (e.shape[0] ** 2 + s.w**2)},
    "sublinear_viscous[Eyring]": lambda s, a, p, e: {
        "viscous": a * e.shape[0] / s.w * asinh(s.w / e.shape[0])
    },
    "sublinear_viscous[Cross]": lambda s, a, p, e: {
        "viscous": a * e.shape[0] ** (2 / 3) / (e.shape[0] ** (2 / 3) + abs(s.w) ** (2 / 3))
    },
    "sublinear_viscous[power law]": lambda s, a, p, e: {
        "viscous": a * (e.shape[0] / max(abs(s.w), 0.01 * e.shape[0])) ** 0.4
    },
    "viscosity_temperature[exponential]": lambda s, a, p, e: {
        "warm viscous": exp(-a * (s.temperature - p.Tamb)) - 1.0
    },
    "viscosity_temperature[arrhenius]": lambda s, a, p, e: {
        "warm viscous": exp(a / (s.temperature + KELVIN) - a / (p.Tamb + KELVIN)) - 1.0
    },
    "coulomb_temperature": lambda s, a, p, e: {"warm dry": a * (p.Tamb - s.temperature)},
    "stribeck_temperature": lambda s, a, p, e: {
        "rise": a * exp(-abs(s.w) / (e.shape[0] * exp(e.shape[1] * (s.temperature - p.Tamb))))
    },
    "hidden_thermal_drift": lambda s, a, p, e: {
        "warm dry": a * (p.Tamb - s.temperature),
        "warm viscous": a * (p.Tamb - s.temperature),
        "warm rise": a * (p.Tamb - s.temperature),
    },
    "wear_runin": lambda s, a, p, e: {"dry": a * exp(-s.travel / e.shape[0])},
    "time_drift": lambda s, a, p, e: {"dry": a * s.t / 15.0},  # seconds of the scenario
    "link_harmonic_friction[n=3]": lambda s, a, p, e: {"dry": a * cos(3 * s.link + e.shape[1])},
    "motor_harmonic_friction[n=2]": lambda s, a, p, e: {"dry": a * cos(2 * s.theta + e.shape[1])},
    "nonsynchronous_friction": lambda s, a, p, e: {"dry": a * cos(e.shape[0] * s.theta + e.shape[1])},
    "cogging[n=4]": lambda s, a, p, e: {"torque": a * cos(4 * s.theta + e.shape[1])},
    "kt_ripple[n=6]": lambda s, a, p, e: {"flux": a * cos(6 * s.theta + e.shape[1])},
    "local_defect": lambda s, a, p, e: {"dry": a * bump(s, e)},
    "cable_spring": lambda s, a, p, e: {"torque": a * (s.link - e.shape[0])},
    "gravity_tilt": lambda s, a, p, e: other_gravity(s, p, gravity=p.g * cos(a)),
    "gravity_tilt, C1": lambda s, a, p, e: other_gravity(s, p, gravity=p.g * sin(a), shift=e.shape[0]),
    "angle_offset": lambda s, a, p, e: other_gravity(s, p, shift=a),
    "mass_mismatch": lambda s, a, p, e: other_gravity(s, p, mass=p.M * (1.0 + a)),
    "kinematic_error[motor,n=2]": lambda s, a, p, e: gear_error(a, 2.0, 2.0 * s.theta + e.shape[1]),
    "kinematic_error[link,n=1]": lambda s, a, p, e: gear_error(a, p.mu, s.link + e.shape[1]),
    "inertia_mismatch": lambda s, a, p, e: {"inertia": a * (p.J_m + p.mu**2 * p.J_l)},
    "load_dependent[gravity]": lambda s, a, p, e: {"dry": a * abs(s.gravity)},
    "load_dependent[transmitted]": lambda s, a, p, e: {"dry": a * abs(transmitted(s, p))},
    "stribeck_load[gravity]": lambda s, a, p, e: {"rise": a * abs(s.gravity) / exp(s.w**2 / e.shape[0] ** 2)},
    "stribeck_load[transmitted]": lambda s, a, p, e: {
        "rise": a * abs(transmitted(s, p)) / exp(s.w**2 / e.shape[0] ** 2)
    },
    "stribeck_load[F_N]": lambda s, a, p, e: {"rise": a * s.normal / exp(s.w**2 / e.shape[0] ** 2)},
    "bearing_load[Hertz]": lambda s, a, p, e: {
        "dry": a * s.normal * ((weight(p) / s.normal) ** (1 / 3) - 1.0)
    },
    "bearing_load[Palmgren]": lambda s, a, p, e: {
        "dry": a * s.normal * ((s.normal / weight(p)) ** 0.55 - 1.0)
    },
    "bearing_load[preload]": lambda s, a, p, e: {
        "dry": a * s.normal * (sqrt(1.0 + (e.shape[0] / s.normal) ** 2) - 1.0)
    },
    "gear_efficiency[easy]": lambda s, a, p, e: {"dry": a * abs(s.gravity) * driven(s.gravity, s, e)},
    "gear_efficiency[hard]": lambda s, a, p, e: {"dry": a * abs(s.gravity) * driven(s.gravity, s, e)},
    "gear_efficiency[hard], C1": lambda s, a, p, e: {
        "dry": a * abs(transmitted(s, p)) * driven(transmitted(s, p), s, e)
    },
    "kt_saturation": lambda s, a, p, e: {"flux": 1.0 / (1.0 + a * (s.i / e.shape[0]) ** 2) - 1.0},
    "current_bias": lambda s, a, p, e: {"current": a},
    "inverter_deadtime": lambda s, a, p, e: {"drop": dead_time(s.v, a, p.R, e.shape[0])},
    "resistance_temperature": lambda s, a, p, e: {
        "drop": s.v - p.R * s.v / (p.R * (1.0 + a * (s.temperature - p.Tamb)))
    },
    "magnet_temperature": lambda s, a, p, e: {"flux": a * (p.Tamb - s.temperature)},
    "ke_mismatch": lambda s, a, p, e: {"drop": a * p.k_e * s.w},
    "sensor_delay": lambda s, a, p, e: {"delay": a},
    "encoder_eccentricity[motor]": lambda s, a, p, e: {"angle": a * sin(s.theta + e.shape[1])},
    "encoder_eccentricity[link]": lambda s, a, p, e: {"angle": a * sin(s.link + e.shape[1]) / p.mu},
}
"""Family, with its variant and the case where it is not C2 -> what its ports take; the rest has memory."""
WITH_MEMORY = {"presliding", "magnetic_hysteresis", "backlash"}


def transmitted(s: Motion, plant: Plant) -> float:
    """Eq. (3): the torque through the gear on the motor side, after the transient of the mesh."""
    friction = copysign(s.link_dry, s.w) + s.link_viscous * s.w
    return plant.mu**2 * plant.J_l * s.alpha + s.gravity + friction


def driven(load: float, s: Motion, e: PlantedEffect) -> float:
    """1 where the motor drives the load, and the other factor where the load drives it."""
    return 1.0 if (load > 0.0) == (s.w > 0.0) else e.shape[0]


def gear_error(a: float, rate: float, angle: float) -> Ports:
    """A sine of the motor angle, and its first two derivatives."""
    return {
        "link angle": a * sin(angle),
        "link ratio": a * rate * cos(angle),
        "link bend": -a * rate**2 * sin(angle),
    }


def dead_time(voltage: float, a: float, R: float, i0: float) -> float:
    """The drop a sat(i/i0) with R i = voltage - drop: solved on each of the three pieces."""
    linear = voltage / (R + a / i0)
    return a * linear / i0 if abs(linear) <= i0 else copysign(a, voltage)


def planted(name: str, seed: int = 3) -> tuple[PlantedEffect, Plant]:
    """An effect by its key of the table, on a rig."""
    family, _, case = name.partition(", ")
    scenario = drawn_scenario(seed, case=case or "C2", effects=[family])
    return scenario.effects[0], scenario.plant


def test_every_family_without_memory_has_its_formula() -> None:
    """The table has all families but those that remember."""
    assert set(EFFECTS) - WITH_MEMORY == {name.partition(",")[0].partition("[")[0] for name in FORMULAS}


@pytest.mark.parametrize("name", FORMULAS)
def test_a_law_is_its_formula(name: str) -> None:
    """At random states, on two rigs: the ports and what they take."""
    for seed in (3, 4):
        effect, plant = planted(name, seed)
        rng, a = np.random.default_rng(seed), effect.amplitude
        for _ in range(STATES):
            s = state(rng, plant)
            expected = FORMULAS[name](s, a, plant, effect)
            laws = effect.start()

            assert set(expected) == set(laws)
            assert expected == pytest.approx(
                {port: law(s, a) for port, law in laws.items()}, rel=1e-9, abs=1e-12
            )


def test_a_dead_time_is_solved_on_both_sides_of_its_corner() -> None:
    """Below the corner the drop is in proportion to the voltage, above it is the amplitude."""
    effect, plant = planted("inverter_deadtime")
    a, i0 = effect.amplitude, effect.shape[0]
    corner = a + plant.R * i0
    s = state(np.random.default_rng(1), plant)
    drops = {}
    for voltage in (-2.0 * corner, -0.5 * corner, 0.5 * corner, 2.0 * corner):
        s.v = voltage
        drops[voltage / corner] = effect.start()["drop"](s, a) / a

    assert {-2.0: -1.0, -0.5: -0.5, 0.5: 0.5, 2.0: 1.0} == pytest.approx(drops)


@pytest.mark.parametrize("variant", ["dahl", "lugre"])
def test_presliding_builds_up_over_its_length_and_turns_round(variant: str) -> None:
    """At constant speed z = g (1 - exp(-travel/(g x0))) from rest, and from there after a reversal."""
    effect, plant = planted(f"presliding[{variant}]")
    reach, speed = effect.shape[0] / plant.mu, 0.7 * plant.mu
    level = 1.0 if variant == "dahl" else 0.6 + 0.4 * exp(-((speed / effect.shape[1]) ** 2))
    damping = 0.0 if variant == "dahl" else 0.01 * speed / reach
    s, (law,) = Motion(plant), effect.start().values()
    s.w_mid = speed
    bent, felt = [], []
    for share in (0.5, 1.0, 3.0):
        s.travel = share * reach * level
        felt.append(law(s, 2.0))
        bent.append(level * (1.0 - exp(-share)))
    s.w_mid, s.travel = -speed, 4.0 * reach * level
    felt.append(law(s, 2.0))
    bent.append(-level + (bent[-1] + level) * exp(-1.0))

    ways = (1.0, 1.0, 1.0, -1.0)
    expected = [2.0 * (z + damping * (way - z / level)) for z, way in zip(bent, ways, strict=True)]
    assert expected == pytest.approx(felt)


def test_hysteresis_follows_the_current_within_its_play() -> None:
    """The element goes with the current by di/i0 and stops at 1 and -1; it turns round at once."""
    effect, plant = planted("magnetic_hysteresis")
    i0 = effect.shape[0]
    s, (law,) = Motion(plant), effect.start().values()
    found = []
    for current in (0.25, 0.75, 3.0, 2.5, 0.0, -1.0):
        s.i = current * i0
        found.append(law(s, 4.0))

    assert [1.0, 3.0, 4.0, 2.0, -4.0, -4.0] == pytest.approx(found)


def test_the_transmitted_torque_settles_within_milliseconds() -> None:
    """A load that appears at once is followed with a time constant of 2 ms."""
    effect, plant = planted("load_dependent[transmitted]")
    s, (law,) = state(np.random.default_rng(2), plant), effect.start().values()
    s.t = 0.002
    early = law(s, 1.0)
    s.t = 0.004
    later = law(s, 1.0)

    load = abs(transmitted(s, plant))
    assert [load * (1.0 - exp(-1.0)), load * (1.0 - exp(-2.0))] == pytest.approx([early, later])


@pytest.mark.parametrize("family", sorted(EFFECTS))
def test_the_first_amplitude_grows_with_the_strength(family: str) -> None:
    """Twice the strength, twice the amplitude, but for backlash and delay, which the simulation finds."""
    options = {"case": "C1"} if family in {"oneway_windage", "gravity_tilt"} else {}
    weak, strong = (
        drawn_scenario(5, effects=[family], strength=strength, **options).effects[0]
        for strength in (0.05, 0.1)
    )

    free = family in {"sensor_delay", "backlash"}
    assert (1.0 if free else 2.0) == pytest.approx(strong.amplitude / weak.amplitude)
    assert 0.0 < weak.amplitude <= weak.bound
    assert replace(weak, amplitude=strong.amplitude, strength=0.1, start=strong.start) == strong


@pytest.mark.parametrize("seed", [3, 4])
def test_friction_of_one_direction_is_not_there_at_rest(seed: int) -> None:
    """The sign of w is 0 at rest: in neither direction is the level of the other one raised."""
    effect, plant = planted("coulomb_asymmetry", seed)
    s, (law,) = Motion(plant), effect.start().values()
    found = []
    for speed in (-1.0, 0.0, 1.0):
        s.w_mid = effect.shape[0] * speed
        found.append(law(s, 2.0))

    assert [0.0, 0.0, 2.0] == found
