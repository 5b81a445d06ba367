"""The virtual bench obeys mechanics: its motion against closed forms."""

from collections.abc import Sequence
from dataclasses import replace
from math import cos, exp, log, sin

import numpy as np
import pytest

from eccentric.virtual_bench import PlantedEffect
from eccentric.virtual_bench.plant import Motion, Plant
from eccentric.virtual_bench.simulation import laws, mover
from tests.virtual import drawn_scenario, moving

# Table 1 of the paper at mu = 1/5, in the reading that its F_1 and F_0 take: k_e = 0.2 V s/rad, F_T = M_l g.
TABLE_1 = Plant(
    case="C1", M=0.5, M_l=0.2, L=0.25, mu=0.2, R=1.0, k_i=0.02, k_e=0.2, J_m=2e-5, J_l=0.03, g=9.81,
    C_m=0.008, B_m=0.0004, C_lN=0.08, B_lN=0.004, gamma_T=0.08 * 0.2 * 9.81, beta_T=0.004 * 0.2 * 9.81,
)  # fmt: skip
C2 = replace(TABLE_1, case="C2")


def _run(
    plant: Plant,
    seconds: float,
    voltage: float,
    dt: float,
    effects: Sequence[PlantedEffect] = (),
    **start: float,
) -> Motion:
    motion, advance = moving(plant, dt, effects, **start)
    for _ in range(round(seconds / dt)):
        advance(voltage)
    return motion


def _energy(motion: Motion, plant: Plant) -> float:
    height = -plant.L * np.cos(plant.mu * motion.theta)
    return 0.5 * plant.inertia * motion.w**2 + plant.M * plant.in_plane_gravity * height


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_steady_speed_obeys_the_polynomial_that_the_paper_prints(direction: float) -> None:
    """In C1 at constant voltage, (k_i/R) u = F_3 w^3 + F_2 w^2 + F_1 w + F_0 with the digits of Table 1."""
    u = 12.0 * direction
    w = abs(_run(TABLE_1, 8.0, u, 1e-3).w)

    polynomial = 8.0e-7 * w**3 + 8.0e-5 * w**2 + 4.7139e-3 * w + 3.9392e-2
    assert 0.02 * 12.0 == pytest.approx(polynomial, rel=2e-5)  # five digits are printed


def test_spin_down_follows_its_closed_form_and_ends_in_rest() -> None:
    """Coulomb and viscous friction alone: w = (w0 + c/b) exp(-b t/J) - c/b until it stops, then exactly 0."""
    plant = replace(TABLE_1, M=0.0, k_i=0.0, k_e=0.0)
    c = plant.C_m + plant.mu * plant.gamma_T
    b = plant.B_m + plant.mu**2 * plant.beta_T
    w0, J = 40.0, plant.inertia
    stop = J / b * log(1.0 + b * w0 / c)

    half = _run(plant, 0.5, 0.0, 5e-4, w=w0).w
    assert half == pytest.approx((w0 + c / b) * exp(-b * 0.5 / J) - c / b, rel=1e-6)
    assert _run(plant, stop - 1e-3, 0.0, 5e-4, w=w0).w > 0.0
    assert _run(plant, stop + 1e-3, 0.0, 5e-4, w=w0).w == 0.0


def test_friction_takes_what_the_motor_gives_and_gravity_keeps() -> None:
    """Work of k_i i = gain of kinetic and potential energy + work of the friction (17)-(20)."""
    p, dt, voltage = C2, 2.5e-4, 9.0
    motion, advance = moving(p, dt, w=30.0)
    before, driven, lost = _energy(motion, p), 0.0, 0.0
    for _ in range(8000):
        w, theta = motion.w, motion.theta
        advance(voltage)
        w, theta = 0.5 * (w + motion.w), 0.5 * (theta + motion.theta)
        pull, weight = p.M * p.L * (p.mu * w) ** 2, (p.M + p.M_l) * p.g
        normal = np.sqrt(pull**2 + 2.0 * weight * pull * np.cos(p.mu * theta) + weight**2)
        friction = (p.B_m + p.mu**2 * p.B_lN * normal) * w + (p.C_m + p.mu * p.C_lN * normal) * np.sign(w)
        driven += dt * w * p.k_i * motion.i
        lost += dt * w * friction

    assert driven == pytest.approx(_energy(motion, p) - before + lost, rel=1e-5)


def test_the_step_is_of_second_order() -> None:
    """Halving the step of a moving link under gravity quarters its error."""
    exact = _run(C2, 0.4, 9.0, 1e-5, w=30.0).theta
    coarse, fine = (abs(_run(C2, 0.4, 9.0, dt, w=30.0).theta - exact) for dt in (2e-3, 1e-3))

    assert round(np.log2(coarse / fine), 1) == 2.0


def test_a_link_within_its_coulomb_level_does_not_creep() -> None:
    """Friction holds up to c, to the last bit; a little more torque than G + c moves the link."""
    theta = 0.3 / C2.mu
    gravity = C2.mu * C2.M * C2.g * C2.L * sin(0.3)
    level = C2.C_m + C2.mu * C2.C_lN * (C2.M + C2.M_l) * C2.g
    limit = (gravity + level) * C2.R / C2.k_i

    assert gravity < level
    assert _run(C2, 1.0, 0.0, 5e-4, theta=theta).theta == theta
    assert _run(C2, 1.0, limit * (1.0 - 1e-9), 5e-4, theta=theta).theta == theta
    assert _run(C2, 1.0, limit * (1.0 + 1e-6), 5e-4, theta=theta).theta > theta


def test_a_stalled_motor_warms_up_by_the_first_order_law() -> None:
    """At rest the loss is u^2/R, so the temperature is Tamb + Rth u^2/R (1 - exp(-t/tau))."""
    plant = replace(TABLE_1, C_m=10.0, Rth=2.0, tau=5.0, Tamb=20.0)

    expected = 20.0 + 2.0 * 9.0 * (1.0 - exp(-3.0 / 5.0))
    assert _run(plant, 3.0, 3.0, 1e-3).temperature == pytest.approx(expected, rel=1e-4)


def test_dead_time_takes_its_voltage_from_the_current() -> None:
    """At stall the current is (u - A)/R."""
    scenario = drawn_scenario(effects=["inverter_deadtime"])
    plant = replace(scenario.plant, C_m=10.0)
    effect = replace(scenario.effects[0], amplitude=0.4)

    assert _run(plant, 0.1, 6.0, 1e-3, [effect]).i == pytest.approx((6.0 - 0.4) / plant.R, rel=1e-12)


def test_backlash_lets_go_of_the_link_for_the_gap() -> None:
    """After a reversal the link's friction is gone while the motor turns by the gap, and only then."""
    scenario = drawn_scenario(case="C1", effects=["backlash"])
    effect = replace(scenario.effects[0], amplitude=0.5)
    motion, advance = moving(scenario.plant, 1e-5, [effect], w=20.0)
    free = 0.0
    for _ in range(100_000):
        travel = motion.travel
        advance(-20.0)
        if motion.acting[0]:
            assert motion.acting[0] == -motion.link_dry
            free += motion.travel - travel

    assert motion.w < 0.0
    assert free == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize("family", ["kt_ripple[n=2]", "kt_saturation"])
def test_what_the_circuit_gives_the_flux_turns_into_work(family: str) -> None:
    """Without friction or gravity, u i - R i^2 summed over a start is the kinetic energy."""
    scenario = drawn_scenario(case="C1", effects=[family])
    plant = replace(scenario.plant, C_m=0.0, B_m=0.0, C_lN=0.0, B_lN=0.0, gamma_T=0.0, beta_T=0.0)
    dt, given = 5e-4, 0.0
    motion, advance = moving(plant, dt, [replace(scenario.effects[0], amplitude=0.3)])
    for _ in range(2000):
        advance(8.0)
        given += dt * (8.0 * motion.i - plant.R * motion.i**2)

    assert given == pytest.approx(0.5 * plant.inertia * motion.w**2, rel=1e-9)


@pytest.mark.parametrize(
    ("warm", "other", "reached"),
    [
        ("coulomb_temperature", "link_harmonic_friction[n=2]", True),
        ("coulomb_temperature", "local_defect", True),
        ("coulomb_temperature", "stribeck", False),
        ("viscosity_temperature[exponential]", "viscous_asymmetry", True),
        ("viscosity_temperature[exponential]", "quadratic_drag", False),
        ("hidden_thermal_drift", "stribeck", True),
    ],
)
def test_warmth_changes_the_friction_of_other_effects(warm: str, other: str, reached: bool) -> None:
    """One oil, one pair of surfaces: temperature is a factor on all friction of its kind."""
    given = {}
    for names in ([warm, other], [warm]):
        scenario = drawn_scenario(effects=names)
        bound = laws(scenario.effects)
        motion = Motion(scenario.plant, theta=-3.0, w=25.0, effects=len(bound))
        motion.temperature = scenario.plant.Tamb + 20.0
        mover(scenario.plant, motion, 1e-4, bound)(1.0)
        given[len(names)] = dict(zip([(e.family, port) for port, e, _ in bound], motion.acting, strict=True))
    family = warm.partition("[")[0]
    (added,) = (value for (name, _), value in given[2].items() if name != family)
    more = sum(given[2][key] - given[1][key] for key in given[1])
    (falls,) = {round(law(motion, e.amplitude), 12) for _, e, law in bound}

    assert added != 0.0
    assert (falls * added if reached else 0.0) == pytest.approx(more, rel=1e-6, abs=1e-15)


def test_warm_dry_friction_slows_a_coasting_drive_by_what_is_left_of_it() -> None:
    """Where warmth takes half of it, the speed falls by half of c dt/J in a step with nothing else."""
    scenario = drawn_scenario(effects=["coulomb_temperature"])
    dry = {"M": 0.0, "k_i": 0.0, "k_e": 0.0, "B_m": 0.0, "B_lN": 0.0}
    plant, effect, dt = replace(scenario.plant, **dry), scenario.effects[0], 1e-3
    motion, advance = moving(plant, dt, [effect], w=40.0)
    motion.temperature = plant.Tamb + 0.5 / effect.amplitude
    advance(0.0)
    level = plant.C_m + plant.mu * plant.C_lN * plant.M_l * plant.g

    assert 0.5 * level * dt / plant.inertia == pytest.approx(40.0 - motion.w, rel=1e-9)


def test_an_effect_acts_on_the_rig_that_moves() -> None:
    """Drawn on one rig and carried to one of twice the mass, a tilt A leaves M g cos A of its gravity."""
    scenario = drawn_scenario(effects=[("gravity_tilt", 0.1)])
    effect, heavy = scenario.effects[0], replace(scenario.plant, M=2.0 * scenario.plant.M)
    motion = Motion(heavy, theta=0.5 / heavy.mu)
    motion.gravity = heavy.mu * heavy.M * heavy.g * heavy.L * sin(0.5)

    change = effect.start()["torque"](motion, effect.amplitude)

    total = heavy.mu * heavy.M * heavy.g * heavy.L * sin(0.5) * cos(effect.amplitude)
    assert motion.gravity + change == pytest.approx(total, rel=1e-12)
