"""Scenarios: a plant, its drive, its course, its effects and the seed of its noise."""

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import atan, exp, floor, log2, pi, sqrt

import numpy as np
from scipy.optimize import brentq
from scipy.signal import lfilter

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
from eccentric.virtual_bench.plant import Plant, rms


@dataclass(frozen=True)
class Course:
    """The reference motor speed over a log of `seconds`, and the held-out intervals [s].

    `runs`: `starts` [s] and `speeds` [rad/s] of the constant speeds, joined by smooth ramps of `ramp_s`.
    `traj`: `frequencies` [Hz], `speeds` (amplitudes, rad/s) and `phases` [rad] of the sines.
    `reference`: `speeds` [rad/s] at the times `starts` [s], interpolated linearly.
    """

    log_type: str
    seconds: float
    holdout: tuple[tuple[float, float], ...]
    speeds: tuple[float, ...]
    starts: tuple[float, ...] = ()
    ramp_s: float = 0.4
    frequencies: tuple[float, ...] = ()
    phases: tuple[float, ...] = ()

    def reference(self, time: np.ndarray) -> np.ndarray:
        """Return the reference motor speed [rad/s] at `time` [s], shape (n,)."""
        if self.log_type == "traj":
            sines = np.zeros_like(time)
            for amplitude, frequency, phase in zip(self.speeds, self.frequencies, self.phases, strict=True):
                sines += amplitude * np.sin(2.0 * np.pi * frequency * time + phase)
            return sines * _smooth(time)  # faded in over the first second
        if self.log_type == "reference":
            return np.interp(time, self.starts, self.speeds)
        speed, before = np.zeros_like(time), 0.0
        for start, value in zip(self.starts, self.speeds, strict=True):
            speed += (value - before) * _smooth((time - start) / self.ramp_s)
            before = value
        return speed


def _smooth(x: np.ndarray) -> np.ndarray:
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def speed_runs(rng: np.random.Generator, seconds: float, top_speed: float) -> Course:
    """Draw constant speeds in both directions, each for 2 to 3.5 s, with one held out in each fifth.

    Magnitudes are spread evenly over 8 to 100 % of `top_speed` [rad/s], in random order; the fastest run in
    either direction is never held out, so that held-out speeds lie within the training range.
    """
    count = max(10, round(seconds / 2.75))
    lengths = rng.uniform(2.0, 3.5, count)
    edges = np.round(np.concatenate([[0.0], np.cumsum(lengths) * seconds / lengths.sum()]), 3)
    pairs = (count + 1) // 2
    sizes = np.linspace(0.08, 1.0, pairs) * top_speed * rng.uniform(0.94, 1.0, pairs)
    speeds = rng.permutation(np.concatenate([sizes, -sizes * rng.uniform(0.92, 1.0, pairs)])[:count])
    extremes = {int(np.argmax(speeds)), int(np.argmin(speeds))}
    holdout = []
    for fifth in range(5):
        inside = [
            k for k in range(fifth * count // 5, (fifth + 1) * count // 5) if k > 0 and k not in extremes
        ]
        run = int(rng.choice(inside or [(fifth + 1) * count // 5 - 1]))
        holdout.append((float(edges[run]), float(edges[run + 1])))
    ramp = round(float(rng.uniform(0.25, 0.45)), 2)
    return Course(
        "runs", seconds, tuple(holdout), tuple(np.round(speeds, 3).tolist()), tuple(edges[:-1].tolist()), ramp
    )


def followed(time: np.ndarray, speed: np.ndarray) -> Course:
    """Return the course of a reference: motor speed [rad/s] (n,) at `time` [s] (n,), from 0 on.

    Five blocks of 4 % of it are held out, evenly spread.
    """
    seconds = round(float(time[-1]), 3)
    holdout = tuple(
        (round(k * seconds / 25, 3), round((k + 1) * seconds / 25, 3)) for k in (3, 8, 13, 18, 23)
    )
    return Course("reference", seconds, holdout, tuple(speed.tolist()), tuple(time.tolist()))


def sum_of_sines(rng: np.random.Generator, seconds: float, top_speed: float) -> Course:
    """Draw six sines, 0.05 to 1.2 Hz, below about `top_speed` [rad/s], with five blocks of 4 % held out."""
    frequencies = np.exp(np.linspace(np.log(0.06), np.log(1.1), 6)) * rng.uniform(0.9, 1.1, 6)
    amplitudes = rng.uniform(0.6, 1.0, 6)
    amplitudes *= top_speed / (0.85 * amplitudes.sum())
    phases = rng.uniform(-np.pi, np.pi, 6)
    blocks = [5 * fifth + int(rng.integers(1 if fifth == 0 else 0, 5)) for fifth in range(5)]
    holdout = tuple((round(b * seconds / 25, 3), round((b + 1) * seconds / 25, 3)) for b in blocks)
    return Course(
        "traj",
        seconds,
        holdout,
        tuple(np.round(amplitudes, 3).tolist()),
        frequencies=tuple(np.round(frequencies, 4).tolist()),
        phases=tuple(np.round(phases, 4).tolist()),
    )


@dataclass(frozen=True)
class MotorController:
    """Measurement and control of the servo drive.

    Gains in V s/rad and V/rad. The voltage at the motor is the commanded one times 1 plus a sine of amplitude
    `ripple` plus noise of RMS `wander`, correlated over `wander_s`.
    """

    counts: int  # encoder counts per motor turn
    filter_hz: float  # corner of the velocity filter
    filter_order: int  # 1 or 2 equal poles
    kp: float
    ki: float
    bus_V: float
    ripple: float = 0.0
    ripple_hz: float = 100.0
    wander: float = 0.0
    wander_s: float = 0.02


def servo(
    controller: MotorController, plant: Plant, theta: float, dt: float
) -> Callable[[float, float], tuple[float, float]]:
    """Return `control(theta, reference)` -> (commanded voltage [V], measured velocity [rad/s]), every `dt`.

    The controller uses the filtered difference of encoder counts as velocity, which is delayed and quantised.
    The integrator stops while the bus saturates.
    """
    per_rad, quantum = controller.counts / (2.0 * pi), 2.0 * pi / controller.counts
    pole = 1.0 - exp(-2.0 * pi * controller.filter_hz * dt)
    second = controller.filter_order == 2
    kp, ki, k_e, bus = controller.kp, controller.ki * dt, plant.k_e, controller.bus_V
    last, first, speed, integral = floor(theta * per_rad + 0.5), 0.0, 0.0, 0.0

    def control(theta: float, reference: float) -> tuple[float, float]:
        nonlocal last, first, speed, integral
        count = floor(theta * per_rad + 0.5)
        first += pole * ((count - last) * quantum / dt - first)
        speed = speed + pole * (first - speed) if second else first
        last = count
        error = reference - speed
        voltage = kp * error + integral + k_e * reference
        if voltage > bus:
            voltage = bus
            integral += min(0.0, ki * error)
        elif voltage < -bus:
            voltage = -bus
            integral += max(0.0, ki * error)
        else:
            integral += ki * error
        return voltage, speed

    return control


def supply(
    controller: MotorController, dt: float, steps: int, rng: np.random.Generator
) -> Callable[[float, int], float]:
    """Return `applied(u, n)`: the motor voltage in step n with bus ripple and wander."""
    if not controller.ripple and not controller.wander:
        return lambda u, _: u
    gain = 1.0 + controller.ripple * np.sin(2.0 * pi * controller.ripple_hz * dt * np.arange(steps))
    if controller.wander:
        pole = exp(-dt / controller.wander_s)
        noise = rng.standard_normal(steps) * controller.wander * sqrt(1.0 - pole**2)
        gain += lfilter([1.0], [1.0, -pole], noise)
    gains = gain.tolist()
    return lambda u, n: u * gains[n]


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
    warming = max(1.0, _FINAL_RISE_K * float(heated))
    friction_rms, speed_rms, current_rms = (float(rms(x)) for x in (torque, speed, current))
    return PlantSetting(plant, friction_rms, speed_rms, top_speed, current_rms, warming, course.seconds, loss)
