"""Scenario -> log, rig and sealed truth; the effects' amplitudes are measured and corrected."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import cos, hypot, log, pi, sin
from typing import Any

import numpy as np

from eccentric.core import InputError
from eccentric.virtual_bench.effects import Law, PlantedEffect
from eccentric.virtual_bench.plant import Motion, Plant, rms
from eccentric.virtual_bench.scenario import Scenario, servo, supply

BoundLaw = tuple[str, PlantedEffect, Law]
"""A port, the effect that acts there, and its law with fresh memory."""


# One step of the rig's motion: second order in time while moving, exact while sticking.
#
# (J_m + mu^2 J_l) dw/dt + G(theta) + (b + k_i k_e / R) w + c Sgn(w) + effects = k_i u / R
#
# A gear of variable ratio r(theta) transmits the link's torques by r instead of mu, its inertia by r^2, and
# adds J_l r dr/dtheta w^2.
#
# Angles drift for half a step, the speed is kicked, angles drift for the other half. In the kick the linear
# damping is evaluated at the mean of old and new speed, and the Coulomb friction c is set-valued: the new
# speed solves
#
# (J + b dt/2) w' + dt c Sgn(w') contains (J - b dt/2) w + dt T,
#
# whose unique solution is a soft threshold. A link below its Coulomb level is therefore exactly at rest,
# without tanh, creep or event search.
def laws(effects: Sequence[PlantedEffect]) -> list[BoundLaw]:
    """All laws of the effects with ports and fresh memory, in the order of `Motion.acting`."""
    return [(port, effect, law) for effect in effects for port, law in effect.start().items()]


def mover(plant: Plant, motion: Motion, dt: float, bound: Sequence[BoundLaw] = ()) -> Callable[[float], None]:
    """Return `advance(u)`, which advances `motion` by `dt` seconds under the armature voltage u [V].

    `bound` is from `laws`; `motion` must have as many places.
    """
    s = motion
    mu, k_i, k_e, R = plant.mu, plant.k_i, plant.k_e, plant.R
    C_m, B_m, C_N, B_N = plant.C_m, plant.B_m, mu * plant.C_lN, mu**2 * plant.B_lN
    C_T, B_T = plant.link_friction(0.0)
    ML, weight = plant.M * plant.L, (plant.M + plant.M_l) * plant.in_plane_gravity
    MgL, flat = mu * plant.M * plant.in_plane_gravity * plant.L, plant.case == "C1"
    half, damping, acting = 0.5 * dt, k_i * k_e / R, s.acting
    Rth, Tamb, heating = plant.Rth, plant.Tamb, dt / plant.tau

    def of(port: str) -> list[tuple[int, Law, float]]:
        return [(n, law, e.amplitude) for n, (where, e, law) in enumerate(bound) if where == port]

    dry_laws, viscous_laws, torque_laws, drop_laws = of("dry"), of("viscous"), of("torque"), of("drop")
    flux_laws, rise_laws, drag_laws = of("flux"), of("rise"), of("drag")
    gear_laws = of("link angle"), of("link ratio"), of("link bend")
    uneven, J_l, constant_ratio = any(gear_laws), plant.J_l, (0.0, 0.0, 0.0)
    warm_dry, warm_viscous, warm_rise = of("warm dry"), of("warm viscous"), of("warm rise")
    even = plant.inertia
    for n, law, amplitude in of("inertia"):
        acting[n] = law(s, amplitude)
        even += acting[n]

    def gear() -> tuple[float, float, float]:
        sums = [0.0, 0.0, 0.0]
        for k, port_laws in enumerate(gear_laws):
            for n, law, amplitude in port_laws:
                acting[n] = value = law(s, amplitude)
                sums[k] += value
        return sums[0], sums[1], sums[2]

    def advance(u: float) -> None:
        w, before = s.w, s.w_before
        theta = s.theta + half * w
        w_mid = 1.5 * w - 0.5 * before
        if w_mid * w <= 0.0:
            w_mid = w
        s.theta = theta
        beyond, more, bend = gear() if uneven else constant_ratio
        ratio = mu + more
        link, w_link = mu * theta + beyond, ratio * w_mid
        pull = ML * w_link * w_link
        if flat:
            normal, gravity = pull, 0.0
        else:
            sine = sin(link)
            normal, gravity = hypot(pull * sine, pull * cos(link) + weight), MgL * sine
        s.w_mid, s.link, s.w_link, s.normal, s.gravity = w_mid, link, w_link, normal, gravity
        s.link_dry = C_N * normal + C_T
        s.link_viscous = B_N * normal + B_T
        s.dry = dry = C_m + s.link_dry
        s.viscous = viscous = B_m + s.link_viscous
        flux = 1.0
        for n, law, amplitude in flux_laws:
            acting[n] = value = law(s, amplitude)
            flux += value
        s.v = u - k_e * flux * w_mid
        torque, drop, inertia = gravity, 0.0, even
        if uneven:
            # The effects' laws use the link torques at the ratio mu.
            gain = ratio / mu
            dry += (gain - 1.0) * s.link_dry
            viscous += (gain * gain - 1.0) * s.link_viscous
            torque = gain * gravity + J_l * ratio * bend * w_mid * w_mid
            inertia += J_l * (ratio * ratio - mu * mu)
        for n, law, amplitude in dry_laws:
            acting[n] = value = law(s, amplitude)
            dry += value
        for n, law, amplitude in viscous_laws:
            acting[n] = value = law(s, amplitude)
            viscous += value
        level, coefficient = dry, viscous  # temperature scales these, including other effects' parts
        for n, law, amplitude in warm_dry:
            acting[n] = value = law(s, amplitude) * level
            dry += value
        for n, law, amplitude in warm_viscous:
            acting[n] = value = law(s, amplitude) * coefficient
            viscous += value
        near_rest = 0.0
        for n, law, amplitude in rise_laws:
            acting[n] = value = law(s, amplitude)
            near_rest += value
        dry += near_rest
        for n, law, amplitude in warm_rise:
            acting[n] = value = law(s, amplitude) * near_rest
            dry += value
        for n, law, amplitude in drag_laws:
            acting[n] = value = law(s, amplitude)
            viscous += value
        for n, law, amplitude in torque_laws:
            acting[n] = value = law(s, amplitude)
            torque += value
        for n, law, amplitude in drop_laws:
            acting[n] = value = law(s, amplitude)
            drop += value

        loss = half * (viscous + damping * flux * flux)
        push = (inertia - loss) * w + dt * (k_i * flux * (u - drop) / R - torque)
        hold = dt * dry if dry > 0.0 else 0.0
        if push > hold:
            after = (push - hold) / (inertia + loss)
        elif push < -hold:
            after = (push + hold) / (inertia + loss)
        else:
            after = 0.0
        mean = 0.5 * (w + after)
        s.i = current = (u - drop - k_e * flux * mean) / R
        s.alpha = (after - w) / dt
        s.w_before, s.w = w, after
        s.theta = theta + half * after
        s.t += dt
        s.travel += dt * abs(mean)
        if Rth:
            lost = R * current * current + (dry + viscous * abs(mean)) * abs(mean)
            s.temperature += heating * (Rth * lost - (s.temperature - Tamb))

    return advance


_TOLERANCE, _MOST_RUNS = 2e-3, 6
_LOG_TYPES = {"runs": "speed_runs", "traj": "trajectory", "reference": "reference"}


@dataclass(frozen=True)
class BenchRun:
    """A log (`columns`: name -> array of shape (rows,), as written), its `rig` and its sealed `truth`."""

    columns: dict[str, np.ndarray]
    rig: dict[str, Any]
    truth: dict[str, Any]
    scenario: Scenario


def simulate(scenario: Scenario, *, again: bool = False) -> BenchRun:
    """Run the bench; the same scenario gives the same run.

    Each effect's amplitude is corrected until its rms over rows in motion is the requested strength times
    the rms of the paper's friction there: to 0.2 %, or as close as its physical bound allows.

    Args:
        scenario: the scenario.
        again: whether the rig is that of an earlier run: amplitudes are then unchanged.

    Raises:
        InputError: the motor cannot move the drive, whose friction at rest the effects make too high.
    """
    raw = _moved(scenario)
    powers = [1.0] * len(scenario.effects)
    for _ in range(0 if again else _MOST_RUNS - 1):
        effects = _corrected(scenario.effects, _fractions(raw), powers)
        if effects == scenario.effects:
            break
        before, scenario = (scenario, raw), replace(scenario, effects=effects)
        raw = _moved(scenario)
        powers = _powers(before, (scenario, raw), powers)
    columns = _log(scenario, raw)
    return BenchRun(columns, _rig(scenario, columns, raw), _truth(scenario, raw), scenario)


@dataclass(frozen=True)
class _Raw:
    """The true motion, one row per sample, torques in N m on the motor side."""

    theta: np.ndarray
    drive_speed: np.ndarray
    u: np.ndarray
    i: np.ndarray
    temperature: np.ndarray
    friction: np.ndarray
    base: np.ndarray  # (rows, 4): the paper's columns sgn w, w, F_N sgn w, F_N w
    torques: np.ndarray  # (rows, effects)
    moving: np.ndarray
    threshold: float


def _moved(scenario: Scenario) -> _Raw:
    """Run the scenario; InputError if the drive never moves."""
    raw = _run(scenario)
    if raw.moving.any():
        return raw
    effects = " and ".join(f"{effect.id}={effect.strength:g}" for effect in scenario.effects) or "none"
    raise InputError(
        f"effect {effects}",
        "friction at rest that the motor can overcome",
        "more: choose a smaller strength, or another seed",
    )


def _run(scenario: Scenario) -> _Raw:
    plant, steps = scenario.plant, scenario.steps_per_sample
    rows = round(scenario.course.seconds * scenario.sample_rate_hz)
    dt = 1.0 / (scenario.sample_rate_hz * steps)
    bound = laws(scenario.effects)
    motion = Motion(plant, scenario.start_angle, effects=len(bound))
    advance = mover(plant, motion, dt, bound)
    angle_laws = [(law, effect.amplitude) for port, effect, law in bound if port == "angle"]

    def read() -> float:
        return motion.theta + sum(law(motion, amplitude) for law, amplitude in angle_laws)

    control = servo(scenario.controller, plant, read(), dt)
    applied = supply(scenario.controller, dt, rows * steps, np.random.default_rng(scenario.seed + 1))
    reference = scenario.course.reference(np.arange(rows * steps) * dt).tolist()

    # The drive averages voltage and current over the two pulses around the sample, so neither leads.
    samples, acting, fine_current = [], [], []
    voltage, n = 0.0, 0
    for _ in range(rows):
        theta, w, u_before, i_before = read(), motion.w, voltage, motion.i
        voltage, speed = control(theta, reference[n])
        advance(applied(voltage, n))
        fine_current.append(motion.i)
        friction = motion.dry * ((motion.w_mid > 0.0) - (motion.w_mid < 0.0)) + motion.viscous * motion.w_mid
        u, i = 0.5 * (u_before + voltage), 0.5 * (i_before + motion.i)
        samples.append(
            (theta, w, speed, u, i, motion.temperature, friction,
             motion.w_mid, motion.alpha, motion.normal)
        )  # fmt: skip
        acting.append(motion.acting.copy())
        for k in range(n + 1, n + steps):
            voltage, _ = control(read(), reference[k])
            advance(applied(voltage, k))
            fine_current.append(motion.i)
        n += steps

    theta, w, speed, u, i, temperature, friction, w_mid, alpha, normal = np.array(samples).T
    threshold = round(0.02 * float(np.max(np.abs(w))), 4)
    logged, torques = i.copy(), np.zeros((rows, len(scenario.effects)))
    time = np.arange(rows) / scenario.sample_rate_hz
    for k, (port, effect, law) in enumerate(bound):
        place = next(n for n, one in enumerate(scenario.effects) if one is effect)
        value = np.array(acting)[:, k]
        if port in {"dry", "rise", "warm dry", "warm rise"}:
            value = value * np.sign(w_mid)
        elif port in {"viscous", "drag", "warm viscous"}:
            value = value * w_mid
        elif port == "inertia":
            value = value * alpha
        elif port == "flux":  # in torque and back-EMF alike, each as a torque
            value = value * np.hypot(plant.k_i * i, plant.k_i * plant.k_e * w_mid / plant.R)
        elif port == "drop":
            value = value * plant.k_i / plant.R
        elif port == "current":
            bias = law(motion, effect.amplitude)
            value, logged = np.full(rows, plant.k_i * bias), logged + bias
        elif port == "delay":
            middles = (np.arange(rows * steps) + 0.5) * dt
            late = np.interp(time - law(motion, effect.amplitude), middles, fine_current)
            value, logged = plant.k_i * (late - i), logged + late - i
        elif port == "angle":
            value = _misread(plant, law, effect.amplitude, (theta, w_mid, alpha))
        elif port == "link angle":
            value = _geared(plant, effect, (theta, w_mid, alpha))
        elif port in {"link ratio", "link bend"}:  # in that torque already
            value = np.zeros(rows)
        torques[:, place] += value
    direction = np.sign(w_mid)
    base = np.stack([direction, w_mid, normal * direction, normal * w_mid], axis=1)
    moving = np.abs(w_mid) > threshold
    return _Raw(theta, speed, u, logged, temperature, friction, base, torques, moving, threshold)


def _misread(
    plant: Plant, law: Law, amplitude: float, motion: tuple[np.ndarray, np.ndarray, np.ndarray]
) -> np.ndarray:
    """Return the torque error (rows,) of inertia, gravity and back-EMF computed at the measured angle."""
    theta, w, alpha = motion
    probe, step = Motion(plant), 1e-3

    def error(angle: float) -> float:
        probe.theta = angle
        return law(probe, amplitude)

    before, here, after = (np.array([error(x + h) for x in theta]) for h in (-step, 0.0, step))
    slope, bend = (after - before) / (2.0 * step), (after - 2.0 * here + before) / step**2
    gravity = [
        plant.gravity_torque(plant.mu * (x + e)) - plant.gravity_torque(plant.mu * x)
        for x, e in zip(theta, here, strict=True)
    ]
    torque = plant.inertia * (slope * alpha + bend * w**2) + np.array(gravity)
    return np.hypot(torque, plant.k_i * plant.k_e / plant.R * slope * w)


def _geared(
    plant: Plant, effect: PlantedEffect, motion: tuple[np.ndarray, np.ndarray, np.ndarray]
) -> np.ndarray:
    """Return the torque (rows,) of the link on the motor, minus that through a gear of ratio mu."""
    probe, gear = Motion(plant), effect.start()

    def torque(theta: float, w: float, alpha: float, amplitude: float) -> float:
        probe.theta = theta
        angle, ratio, bend = (
            gear[port](probe, amplitude) for port in ("link angle", "link ratio", "link bend")
        )
        link, gain = plant.mu * theta + angle, 1.0 + ratio / plant.mu
        dry, viscous = plant.link_friction(plant.normal_force(link, plant.mu * gain * w))
        inertial = plant.mu * plant.J_l * (plant.mu * gain * alpha + bend * w * w)
        friction = dry * float(np.sign(w)) + viscous * gain * w
        return gain * (inertial + plant.gravity_torque(link) + friction)

    return np.array([torque(*row, effect.amplitude) - torque(*row, 0.0) for row in zip(*motion, strict=True)])


def _fractions(raw: _Raw) -> list[float]:
    friction = rms(raw.friction[raw.moving])
    return [float(rms(torque[raw.moving]) / friction) for torque in raw.torques.T]


def _corrected(
    effects: tuple[PlantedEffect, ...], fractions: list[float], powers: list[float]
) -> tuple[PlantedEffect, ...]:
    """Return the effects with corrected amplitudes; strengths scale with amplitude to the power `powers`."""
    scales = [
        (effect.strength / max(fraction, 1e-3 * effect.strength)) ** (1.0 / power)
        for effect, fraction, power in zip(effects, fractions, powers, strict=True)
    ]
    amplitudes = [
        min(e.bound, e.amplitude * min(5.0, max(0.2, s))) for e, s in zip(effects, scales, strict=True)
    ]
    if all(abs(a / e.amplitude - 1.0) <= _TOLERANCE for e, a in zip(effects, amplitudes, strict=True)):
        return effects
    return tuple(replace(effect, amplitude=a) for effect, a in zip(effects, amplitudes, strict=True))


def _powers(before: tuple[Scenario, _Raw], after: tuple[Scenario, _Raw], powers: list[float]) -> list[float]:
    """Return the exponents of strength over amplitude between two runs; the old ones if undetermined."""
    exponents = []
    for k, power in enumerate(powers):
        step = log(after[0].effects[k].amplitude / before[0].effects[k].amplitude)
        was, now = _fractions(before[1])[k], _fractions(after[1])[k]
        growth = log(now / was) / step if abs(step) > 1e-3 and was > 0.0 and now > 0.0 else power
        exponents.append(min(3.0, max(0.4, growth)))
    return exponents


def _log(scenario: Scenario, raw: _Raw) -> dict[str, np.ndarray]:
    """Return the columns as recorded by a drive: quantised, noisy, rounded to the file's digits."""
    rng = np.random.default_rng(scenario.seed)
    peak = float(np.max(np.abs(raw.i))) or 1.0
    quantum, bit = 2.0 * pi / scenario.controller.counts, 1.5 * peak / 2048
    current = raw.i + scenario.noise * peak * rng.standard_normal(len(raw.i))
    columns = {
        "time_s": np.round(np.arange(len(raw.i)) / scenario.sample_rate_hz, 3),
        "theta_m_rad": np.round(np.floor(raw.theta / quantum + 0.5) * quantum, 5),
        "omega_m_rad_s": np.round(raw.drive_speed, 4),
        "voltage_V": np.round(raw.u, 3),
        "current_A": np.round(np.floor(current / bit + 0.5) * bit, 4),
    }
    if scenario.temperature:
        sensed = raw.temperature + 0.05 * rng.standard_normal(len(raw.i))
        columns["temperature_C"] = np.round(np.floor(sensed / 0.1 + 0.5) * 0.1, 2)
    return {name: column + 0.0 for name, column in columns.items()}  # no negative zeros


def _rig(scenario: Scenario, columns: dict[str, np.ndarray], raw: _Raw) -> dict[str, Any]:
    return {
        "format": "rotlink-log/1",
        "name": scenario.name,
        "log_type": _LOG_TYPES[scenario.course.log_type],
        "known": scenario.plant.known(),
        "encoder_counts_per_rev": scenario.controller.counts,
        "sample_rate_hz": scenario.sample_rate_hz,
        "columns": list(columns),
        "moving_threshold_rad_s": raw.threshold,
        "holdout_intervals_s": [list(interval) for interval in scenario.course.holdout],
    }


def _truth(scenario: Scenario, raw: _Raw) -> dict[str, Any]:
    plant, count = scenario.plant, len(scenario.effects)
    beyond = _beyond_the_paper(raw)
    return {
        "name": scenario.name,
        "kind": ("control", "single", "double")[count] if count < 3 else "several",
        "log": scenario.course.log_type,
        "noise_frac_of_range": scenario.noise,
        "counts": scenario.controller.counts,
        "velocity_filter_hz": scenario.controller.filter_hz,
        "velocity_filter_order": scenario.controller.filter_order,
        "bus_ripple": scenario.controller.ripple,
        "bus_wander": scenario.controller.wander,
        "rows": len(raw.theta),
        "mu": plant.mu,
        "case": plant.case,
        "friction_rms_Nm": float(rms(raw.friction[raw.moving])),
        "hidden_parameters": plant.hidden(),
        "thermal": {"Rth": plant.Rth, "tau": plant.tau, "Tamb": plant.Tamb},
        "temperature_range": [float(raw.temperature.min()), float(raw.temperature.max())],
        "effects": [
            {
                "id": effect.id,
                "family": effect.family,
                "form": effect.form,
                "amplitude": effect.amplitude,
                "shape": list(effect.shape),
                "rms_fraction_asked": effect.strength,
                "rms_fraction_of_friction": fraction,
                "rms_fraction_beyond_the_paper": fraction if effect.channel == "electrical" else unseen,
                "channel": effect.channel,
                "depends_on": list(effect.depends_on),
            }
            for effect, fraction, unseen in zip(scenario.effects, _fractions(raw), beyond, strict=True)
        ],
    }


def _beyond_the_paper(raw: _Raw) -> list[float]:
    """Return each effect's rms residual after refitting the paper's model, over the friction rms."""
    base, torques = raw.base[raw.moving], raw.torques[raw.moving]
    coefficients, *_ = np.linalg.lstsq(base, torques, rcond=None)
    friction = rms(raw.friction[raw.moving])
    return [float(rms(rest) / friction) for rest in (torques - base @ coefficients).T]
