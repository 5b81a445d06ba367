"""Effects of the transmitted load, and effects with memory."""

from collections.abc import Callable
from math import exp

from eccentric.virtual_bench.effects.record import (
    Law,
    PlantedEffect,
    Request,
    back_driven,
    bearing_law,
    gear_loss,
    sign,
    simply,
)
from eccentric.virtual_bench.plant import Motion

# Gear meshing follows the load within about this time; the lag also keeps the step explicit.
_SETTLING_S = 0.002


def _transmitted() -> Callable[[Motion], float]:
    """Return the law of mu tau_l, eq. (3): transmitted torque with the lag `_SETTLING_S` [N m]."""
    load, before = 0.0, 0.0

    def law(s: Motion) -> float:
        nonlocal load, before
        inertia = s.plant.mu**2 * s.plant.J_l
        now = inertia * s.alpha + s.gravity + s.link_dry * sign(s.w_mid) + s.link_viscous * s.w_mid
        load += (now - load) * (1.0 - exp(-(s.t - before) / _SETTLING_S))
        before = s.t
        return load

    return law


def load_dependent(request: Request) -> PlantedEffect:
    """Dry friction proportional to a load: gravity alone, or the transmitted torque (Gogoussis 1987)."""
    if request.variant == "gravity" and request.chosen:
        request.require_case("C2", "load_dependent[gravity]", "there is no gravity load in the other case")
    if request.variant == "gravity" and request.plant.case == "C2":
        return request.effect(
            "A |G| sgn w",
            request.strength,
            simply(dry=lambda s, a: a * abs(s.gravity)),
            ("gravity_load", "link_angle"),
            bound=0.8,
        )

    def start() -> dict[str, Law]:
        load = _transmitted()
        return {"dry": lambda s, a: a * abs(load(s))}

    return request.effect(
        "A |mu tau_l| sgn w, tau_l = J_l dw_l/dt + f_l + G",
        request.strength,
        start,
        ("transmitted_torque",),
        bound=0.6,
        variant="transmitted",
    )


def stribeck_load(request: Request) -> PlantedEffect:
    """Rise of dry friction near rest, proportional to the gear or the bearing load."""
    if request.variant != "transmitted" and request.chosen:
        request.require_case(
            "C2", f"stribeck_load[{request.variant}]", "only gravity gives a load that varies at low speed"
        )
    top = request.setting.top_speed
    if request.variant == "F_N" and request.plant.case == "C2":
        vs, weight = request.draw(0.5, 0.6) * top, (request.plant.M + request.plant.M_l) * request.plant.g

        def rise(s: Motion, a: float) -> float:
            return a * s.normal * exp(-((s.w_mid / vs) ** 2))

        return request.effect(
            "A F_N exp(-(w/vs)^2) sgn w",
            request.torque(2.0) / weight,
            simply(rise=rise),
            ("velocity", "link_angle"),
            (vs,),
            variant="F_N",
        )
    vs = request.draw(0.06, 0.14) * top
    gravity = request.variant == "gravity" and request.plant.case == "C2"

    def start() -> dict[str, Law]:
        load = (lambda s: s.gravity) if gravity else _transmitted()
        return {"rise": lambda s, a: a * abs(load(s)) * exp(-((s.w_mid / vs) ** 2))}

    return request.effect(
        f"A |{'G' if gravity else 'mu tau_l'}| exp(-(w/vs)^2) sgn w",
        2.0 * request.strength,
        start,
        ("gravity_load" if gravity else "transmitted_torque", "velocity"),
        (vs,),
        bound=0.8,
        variant="gravity" if gravity else "transmitted",
    )


def bearing_load(request: Request) -> PlantedEffect:
    """Dry friction of the link by a power of F_N, or with a preload across it, instead of by F_N.

    The powers are those of a Hertzian point contact, 2/3, and of a deep-groove ball bearing, 1.55 (Palmgren).
    At the largest amplitude all of the paper's C_lN F_N is replaced.
    """
    plant, variant = request.plant, request.variant
    request.require_case(
        "C2", "bearing_load", "by any of its laws it is a polynomial of the speed in the other"
    )
    weight = (plant.M + plant.M_l) * plant.g
    law, shape, carried = bearing_law(request, weight)
    return request.effect(
        f"A ({law} - F_N) sgn w{'' if variant == 'preload' else ', F_0 the weight'}",
        min(request.torque(3.0) / weight, plant.mu * plant.C_lN),
        simply(dry=lambda s, a: a * (carried(s.normal) - s.normal)),
        ("velocity", "link_angle"),
        (shape,),
        bound=plant.mu * plant.C_lN,
        variant=variant,
    )


def gear_efficiency(request: Request) -> PlantedEffect:
    """Loss proportional to the load, smaller or larger when back-driven."""
    gravity, back = request.plant.case == "C2", back_driven(request)
    letter, load = ("G", "gravity_load") if gravity else ("mu tau_l", "transmitted_torque")
    return request.effect(
        f"A |{letter}| sgn w when driving, {back} A |{letter}| sgn w when back-driven",
        1.4 * request.strength,
        lambda: {"dry": gear_loss((lambda s: s.gravity) if gravity else _transmitted(), back)},
        (load, "direction"),
        (back,),
        bound=0.6,
    )


def backlash(request: Request) -> PlantedEffect:
    """Gap of A at the motor, which it crosses without the link's torques after a reversal of the load.

    An approximation: the link's friction and gravity are decoupled while the motor crosses the gap, but its
    inertia remains coupled. A load that reverses again within the gap returns to the first flank. A true
    two-mass contact would need steps of microseconds. It acts only at reversals, so a short log meets the
    requested strength approximately; the truth contains the actual one.
    """
    bound = 0.25 / request.plant.mu

    def start() -> dict[str, Law]:
        flank, remaining, travel = 0.0, 0.0, 0.0

        def free(s: Motion, a: float) -> bool:
            nonlocal flank, remaining, travel
            load = s.gravity + (s.link_dry + s.link_viscous * abs(s.w_mid)) * sign(s.w_mid)
            remaining -= s.travel - travel
            travel = s.travel
            if load * flank < 0.0:  # the way back to the previous flank is the distance covered so far
                remaining = a - max(remaining, 0.0)
            if load:
                flank = sign(load)
            return remaining > 0.0

        state = False

        def dry(s: Motion, a: float) -> float:  # evaluated first; the other ports depend on it
            nonlocal state
            state = free(s, a)
            return -s.link_dry if state else 0.0

        return {
            "dry": dry,
            "viscous": lambda s, a: -s.link_viscous if state else 0.0,
            "torque": lambda s, a: -s.gravity if state else 0.0,
        }

    return request.effect(
        "-(mu f_l + G) while the motor turns A after a reversal of the load",
        0.1 / request.plant.mu,
        start,
        ("history", "direction"),
        bound=bound,
    )


_MICRO_DAMPING_S = 0.01  # sigma_1/sigma_0 of the bristles


def presliding(request: Request) -> PlantedEffect:
    """Compliant contact (seal, grease, strain-wave gear) that builds up torque over x0 after each reversal.

    Dahl 1968: dz = dx/x0 (1 - z sgn dx), solved exactly over each step. LuGre (Canudas de Wit 1995) has a
    level g that falls with the speed, here towards 0.6 of its value at rest, which also limits the bristle
    deflection, dz = dx/x0 (1 - z sgn(dx)/g), and a torque proportional to dz/dt.
    """
    x0 = request.draw(0.08, 0.3)
    reach, vs = x0 / request.plant.mu, 0.1 * request.setting.top_speed
    falls = request.variant == "lugre"

    def start() -> dict[str, Law]:
        z, travel = 0.0, 0.0

        def torque(s: Motion, a: float) -> float:
            nonlocal z, travel
            way = sign(s.w_mid)
            level = 0.6 + 0.4 * exp(-((s.w_mid / vs) ** 2)) if falls else 1.0
            z = way * level + (z - way * level) * exp(-(s.travel - travel) / (reach * level))
            travel = s.travel
            rate = (s.w_mid - abs(s.w_mid) * z / level) / reach if falls else 0.0
            return a * (z + _MICRO_DAMPING_S * rate)

        return {"torque": torque}

    form = (
        f"A (z + {_MICRO_DAMPING_S} dz/dt), dz/dx = (1 - z sgn(w)/g)/x0, g = 0.6 + 0.4 exp(-(w/vs)^2)"
        if falls
        else "A z, dz/dx = (1 - z sgn w)/x0"
    )
    shape = (x0, vs) if falls else (x0,)
    return request.effect(form, request.torque(), start, ("history", "direction"), shape)


def magnetic_hysteresis(request: Request) -> PlantedEffect:
    """Remanent magnetisation: the torque lags the current in a loop of half-width A in torque.

    An elastic-plastic element of the current, dz = di/i0 within [-1, 1]. Duhem's smooth form is unsuitable:
    the current ripple of the pulses pulls its loop to the centre, but iron does not follow small changes.
    """
    i0 = request.draw(0.3, 0.6) * request.setting.current

    def start() -> dict[str, Law]:
        z, last = 0.0, 0.0

        def torque(s: Motion, a: float) -> float:
            nonlocal z, last
            z = min(1.0, max(-1.0, z + (s.i - last) / i0))
            last = s.i
            return a * z

        return {"torque": torque}

    return request.effect(
        "A z, dz = di/i0 within [-1, 1]", request.torque(1.3), start, ("current", "history"), (i0,)
    )
