"""Scenarios: a plant, its drive, its course, its effects and the seed of its noise."""

import re
from dataclasses import dataclass, replace
from math import atan, floor, log2, pi

import numpy as np
from scipy.optimize import brentq

from eccentric.core import InputError
from eccentric.virtual_bench.effects import (
    EFFECTS,
    VARIANTS,
    PlantedEffect,
    PlantSetting,
    Request,
    Requested,
    check_strength,
    check_values,
    known_family,
    with_strengths,
)
from eccentric.virtual_bench.plant import Plant
from eccentric.virtual_bench.trajectory import Course, MotorController, followed, speed_runs, sum_of_sines

CASES = ("C1", "C2")
LOG_TYPES = ("runs", "traj")
DRIVES = ("fine", "ordinary")
_SHORTEST_S, _LONGEST_S = 15.0, 3600.0
_FINAL_RISE_K = 60.0  # final temperature rise from the losses


@dataclass(frozen=True)
class Scenario:
    """A complete test, input of `simulate`. `noise` is that of the current, over its peak."""

    plant: Plant
    controller: MotorController
    course: Course
    effects: tuple[PlantedEffect, ...]
    noise: float
    temperature: bool  # whether the temperature is logged
    seed: int
    start_angle: float  # of the motor [rad]
    sample_rate_hz: int = 250
    steps_per_sample: int = 8
    name: str = "bench"


def random_scenario(
    rng: np.random.Generator,
    *,
    case: str,
    mu: float,
    log_type: str,
    effects: Requested = (),
    strength: float = 0.15,
    noise: float = 0.01,
    temperature: bool = False,
    seconds: float = 60.0,
    drive: str = "fine",
) -> Scenario:
    """Draw a plausible rig with that gear ratio near the paper's Table 1, a course and shapes of effects.

    `effects` are family ids, optionally with a variant in brackets (`load_dependent[gravity]`), each with or
    without its strength (fraction of the friction rms; by default `strength`). `noise` is the current's, over
    its peak. A temperature is logged if requested or if an effect needs it. The same state of `rng` gives the
    same plant and course, whatever the effects.
    `drive` is "fine" (a well damped loop, a fine encoder, a steady bus) or "ordinary": a loop of 3 to 12 Hz
    on a speed filtered at 12 to 80 Hz, which may ring, a bus that varies by up to 2 % over 20 ms, and an
    encoder of the same resolution at all gear ratios.

    Raises InputError for values out of range, an unknown effect, or one that the case cannot show.
    """
    check_values(
        {"case": (case, CASES), "log type": (log_type, LOG_TYPES), "drive": (drive, DRIVES)},
        {
            "gear ratio mu": (mu, 1e-3, 2.0),
            "strength": (strength, 1e-6, 1.0),
            "noise (fraction of the largest current)": (noise, 0.0, 0.5),
            "seconds": (seconds, _SHORTEST_S, _LONGEST_S),
        },
    )
    requested = with_strengths(effects, strength)
    for name, size in requested:
        known_effect(name)
        check_strength(name, size)
    plant = _plant(rng, case, mu)
    top_speed = float(rng.uniform(6.5, 8.5)) / mu if log_type == "runs" else float(rng.uniform(5.5, 7.0)) / mu
    course = (speed_runs if log_type == "runs" else sum_of_sines)(rng, seconds, top_speed)
    controller, theta = _controller(rng, plant), float(rng.uniform(0.0, 2.0 * pi))
    seed = int(rng.integers(2**32))
    if drive == "ordinary":
        controller = _ordinary(np.random.default_rng(seed), plant)

    setting = _setting(plant, course, top_speed)
    built = []
    for name, size in requested:
        family, variant = known_effect(name)
        # Also drawn if one is requested, for the same shapes.
        drawn = str(rng.choice(VARIANTS[family])) if family in VARIANTS else ""
        request = Request(family, size, variant or drawn, variant is not None, setting, rng)
        built.append(EFFECTS[family](request))
    logged = temperature or any(effect.needs_temperature for effect in built)
    hiding = [effect.id for effect in built if effect.hides_temperature]
    if hiding and logged:
        raise InputError(f"effect {hiding[0]}", "a log without a temperature column", "one with it")
    if logged or hiding:
        plant = replace(plant, Rth=float(f"{_FINAL_RISE_K / setting.loss:.3g}"))
    return Scenario(plant, controller, course, tuple(built), noise, logged, seed, theta)


def on_reference(scenario: Scenario, time: np.ndarray, speed: np.ndarray, start_angle: float) -> Scenario:
    """Return the scenario of the same drive on another course, for `simulate(..., again=True)`.

    Args:
        scenario: that of a `BenchRun`, with final amplitudes; the noise is drawn anew.
        time, speed: motor speed [rad/s] (n,) at these times [s] (n,), starting at 0.
        start_angle: of the motor [rad].

    Raises:
        InputError: fewer than two times, times that do not rise from 0, or values that are not numbers.
    """
    if time.ndim != 1 or time.shape != speed.shape or len(time) < 2:
        raise InputError("reference", "as many speeds as times", f"{speed.shape}, {time.shape}")
    if time[0] != 0.0 or not np.all(np.diff(time) > 0.0) or not np.all(np.isfinite(speed)):
        raise InputError("reference", problem="expected times that rise from 0, and finite speeds")
    return replace(scenario, course=followed(time, speed), seed=scenario.seed + 1, start_angle=start_angle)


def known_effect(name: str) -> tuple[str, str | None]:
    """Split `family[variant]`; InputError, listing the known effects, for an unknown one."""
    return known_family(str(name), re.fullmatch(r"(\w+)(?:\[(.+)\])?", str(name)), EFFECTS, VARIANTS)


def _plant(rng: np.random.Generator, case: str, mu: float) -> Plant:
    """Draw a plant; motor size grows with its torque, by power laws through three catalogue motors."""
    k = float(f"{0.02 * (30.0 * mu) ** 0.64:.2g}")
    M, M_l, L = (
        round(float(rng.uniform(low, high)), 3) for low, high in ((0.45, 0.6), (0.16, 0.23), (0.23, 0.29))
    )
    near = [float(x) for x in rng.uniform(0.9, 1.15, 6)]
    return Plant(
        case=case, M=M, M_l=M_l, L=L, mu=mu, R=round(float(rng.uniform(0.8, 1.1)), 1), k_i=k, k_e=k,
        J_m=float(f"{4e-4 * (2.0 * mu) ** 1.1:.1g}"), J_l=round(M * L**2 + M_l * L**2 / 3.0, 8), g=9.81,
        C_m=0.45 * k * near[0], B_m=3.4e-4 * (k / 0.02) ** 1.32 * near[1],
        C_lN=0.08 * near[2], B_lN=0.004 * near[3],
        gamma_T=0.08 * (M + M_l) * 9.81 * near[4], beta_T=0.004 * (M + M_l) * 9.81 * near[5],
        tau=round(float(rng.uniform(50.0, 90.0)), 0), Tamb=round(float(rng.uniform(18.0, 25.0)), 1),
    )  # fmt: skip


def _controller(rng: np.random.Generator, plant: Plant) -> MotorController:
    """Draw a controller with a loop of 4 to 6 Hz, stable despite the lag of the velocity filter.

    The encoder is finer at low reductions, since the resolution at the link matters.
    """
    finer = 2 ** max(0, floor(log2(30.0 * plant.mu)))
    bandwidth = 2.0 * pi * float(rng.uniform(4.0, 6.0))
    kp = bandwidth * plant.inertia * plant.R / plant.k_i
    return MotorController(
        counts=int(rng.choice([4096, 8192])) * finer,
        filter_hz=float(rng.choice([30.0, 40.0, 60.0])),
        filter_order=int(rng.choice([1, 2])),
        kp=kp,
        ki=kp * float(rng.uniform(3.0, 6.0)),
        bus_V=24.0 if plant.mu <= 1.0 else 48.0,
    )


def _ordinary(rng: np.random.Generator, plant: Plant) -> MotorController:
    """Draw a controller as found in the field, with a possibly ringing loop, a poor bus and encoder.

    The loop is as fast as drawn, or as a phase margin of 10 degrees allows.
    """
    bandwidth = 2.0 * pi * float(rng.uniform(3.0, 12.0))
    corner = float(rng.choice([12.0, 16.0, 24.0, 40.0, 80.0]))
    integral = float(rng.uniform(3.0, 6.0))
    while _phase_margin(bandwidth, 2.0 * pi * corner, integral) < pi / 18.0:
        bandwidth *= 0.95
    kp = bandwidth * plant.inertia * plant.R / plant.k_i
    return MotorController(
        counts=int(rng.choice([4096, 8192, 16384])),
        filter_hz=corner,
        filter_order=2,
        kp=kp,
        ki=kp * integral,
        bus_V=24.0 if plant.mu <= 1.0 else 48.0,
        wander=float(rng.uniform(0.0, 0.02)),
    )


def _phase_margin(bandwidth: float, corner: float, integral: float) -> float:
    """Phase margin [rad] of an inertia under a PI controller behind two poles at `corner` [rad/s].

    `bandwidth` [rad/s] is the crossover without the poles, `integral` [1/s] the integral over the
    proportional gain.
    """
    # Crossover: bandwidth/w over 1 + (w/corner)^2 is one.
    crossover = float(brentq(lambda w: w * (1.0 + (w / corner) ** 2) - bandwidth, 0.0, bandwidth))
    return pi / 2.0 - 2.0 * atan(crossover / corner) - atan(integral / crossover)


def _setting(plant: Plant, course: Course, top_speed: float) -> PlantSetting:
    """Return approximate signal magnitudes along the course, for an ideal drive without inertia."""
    time = np.arange(0.0, course.seconds, 0.02)
    speed = course.reference(time)
    link = plant.mu * np.cumsum(speed) * 0.02
    torque = [
        plant.friction_torque(a, plant.mu * w) for a, w in zip(link.tolist(), speed.tolist(), strict=True)
    ]
    drive = np.array([t + plant.gravity_torque(a) for t, a in zip(torque, link.tolist(), strict=True)])
    current = drive / plant.k_i
    loss = float(np.mean(plant.R * current**2 + np.abs(np.array(torque) * speed)))
    heated = 1.0 - (1.0 - np.exp(-course.seconds / plant.tau)) * plant.tau / course.seconds
    friction_rms, speed_rms, current_rms = (
        float(np.sqrt(np.mean(np.square(x)))) for x in (torque, speed, current)
    )
    return PlantSetting(
        plant,
        friction_rms,
        speed_rms,
        top_speed,
        current_rms,
        max(1.0, _FINAL_RISE_K * float(heated)),
        course.seconds,
        loss,
    )
