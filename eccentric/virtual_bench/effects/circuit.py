"""Effects in the armature circuit, the torque constant and the sensors of current and angle."""

from math import sin

from eccentric.virtual_bench.effects.record import PlantedEffect, Request, simply
from eccentric.virtual_bench.plant import Motion


def kt_saturation(request: Request) -> PlantedEffect:
    """Saturation of the iron: torque and back-EMF constant fall with the current."""
    size = request.setting.current

    def flux(s: Motion, a: float) -> float:
        share = a * (s.i / size) ** 2
        return -share / (1.0 + share)

    return request.effect(
        "k_i, k_e -> k_i, k_e over 1 + A (i/i0)^2",
        request.torque(0.5) / request.motor_torque,
        simply(flux=flux),
        ("current",),
        (size,),
        bound=1.0,
        channel="electrical",
    )


def current_bias(request: Request) -> PlantedEffect:
    """Current sensor with an offset A."""
    return request.effect(
        "i_logged = i + A",
        request.torque() / request.plant.k_i,
        simply(current=lambda s, a: a),
        ("current",),
        channel="electrical",
    )


def inverter_deadtime(request: Request) -> PlantedEffect:
    """Voltage lost to the dead time of the bridge, against the current (Munoz and Lipo 1999).

    It is linear within i0 about zero current, where drop and current are solved for simultaneously.
    """
    i0 = request.draw(0.02, 0.06) * request.setting.current

    def drop(s: Motion, a: float) -> float:
        share = s.v / (a + s.plant.R * i0)
        return a * min(1.0, max(-1.0, share))

    return request.effect(
        "A sat(i/i0)",
        request.torque() * request.plant.R / request.plant.k_i,
        simply(drop=drop),
        ("current", "voltage"),
        (i0,),
        channel="electrical",
    )


def resistance_temperature(request: Request) -> PlantedEffect:
    """Winding resistance that rises with the temperature."""
    cold = request.plant.Tamb

    def drop(s: Motion, a: float) -> float:
        share = a * (s.temperature - cold)
        return s.v * share / (1.0 + share)

    size = request.torque() / (request.plant.k_i * request.setting.current * request.setting.warming)
    return request.effect(
        "R -> R (1 + A (T - Tamb))",
        size,
        simply(drop=drop),
        ("temperature", "current"),
        (cold,),
        bound=0.02,
        channel="electrical",
        needs_temperature=True,
    )


def magnet_temperature(request: Request) -> PlantedEffect:
    """Flux of the magnets, and with it torque and back-EMF constant, that falls with the temperature."""
    cold = request.plant.Tamb
    return request.effect(
        "k_i, k_e -> k_i, k_e times 1 - A (T - Tamb)",
        1.5 * request.torque() / (request.motor_torque * request.setting.warming),
        simply(flux=lambda s, a: -a * (s.temperature - cold)),
        ("temperature", "current"),
        (cold,),
        bound=0.01,
        channel="electrical",
        needs_temperature=True,
    )


def ke_mismatch(request: Request) -> PlantedEffect:
    """Back-EMF constant larger than declared by the fraction A."""
    plant = request.plant
    size = request.torque() * plant.R / (plant.k_i * plant.k_e * request.setting.speed)
    return request.effect(
        "k_e -> k_e (1 + A)",
        size,
        simply(drop=lambda s, a: a * s.plant.k_e * s.w_mid),
        ("velocity",),
        bound=0.8,
        channel="electrical",
    )


def sensor_delay(request: Request) -> PlantedEffect:
    """Current sensor with a delay A relative to angle and voltage."""
    return request.effect(
        "i_logged(t) = i(t - A)",
        0.01,
        simply(delay=lambda s, a: a),
        ("history", "current"),
        bound=0.06,
        channel="electrical",
    )


def encoder_eccentricity(request: Request) -> PlantedEffect:
    """Encoder of motor or link with an eccentric scale; the drive controls by the angle it reads."""
    plant, speed = request.plant, request.setting.speed
    rate, shift = (1.0 if request.variant == "motor" else plant.mu), request.phase()
    angle = {"motor": "thm", "link": "thl"}[request.variant]
    return request.effect(
        f"{angle}_logged = {angle} + A sin({angle} + phi)",
        request.torque() / (plant.inertia * rate * speed**2),
        simply(angle=lambda s, a: a * sin(rate * s.theta + shift) / rate),
        ("motor_angle" if request.variant == "motor" else "link_angle", "velocity"),
        (rate, shift),
        bound=0.02,
    )
