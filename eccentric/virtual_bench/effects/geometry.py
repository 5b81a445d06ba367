"""Effects of the link or motor angle, and of a rig that differs from its declaration."""

from math import cos, exp, hypot, pi, sin

from eccentric.virtual_bench.effects.record import Law, PlantedEffect, Request, simply
from eccentric.virtual_bench.plant import Motion, Plant


def link_harmonic_friction(request: Request) -> PlantedEffect:
    """Dry friction that varies n times per turn of the link (misalignment, bent shaft, lobed bearing)."""
    order, shift = int(request.variant[2:]), request.phase()
    return request.effect(
        f"A cos({order} thl + phi) sgn w",
        request.torque(1.4),
        simply(dry=lambda s, a: a * cos(order * s.link + shift)),
        ("link_angle",),
        (float(order), shift),
    )


def motor_harmonic_friction(request: Request) -> PlantedEffect:
    """Dry friction that varies n times per turn of the motor: wave generator, teeth of the pinion.

    Unless it is chosen, n is 2 where a turn of the link has more than 24 of them, and 13 elsewhere: a low
    order of the link may be the same.
    """
    drawn = 2 if request.plant.mu < 1.0 / 12.0 else 13
    order, shift = int(request.variant[2:]) if request.chosen else drawn, request.phase()
    return request.effect(
        f"A cos({order} thm + phi) sgn w",
        request.torque(1.4),
        simply(dry=lambda s, a: a * cos(order * s.theta + shift)),
        ("motor_angle",),
        (float(order), shift),
        variant=f"n={order}",
    )


def nonsynchronous_friction(request: Request) -> PlantedEffect:
    """Dry friction at a non-integer order of the motor: balls and cage of a bearing rolling without slip.

    The orders are ball-pass orders or, if the link turns too slowly for the log to show such a ripple, those
    of a slower bearing inside the gear.
    """
    slow = request.plant.mu < 1.0 / 12.0
    integer = 0 if slow else int(request.rng.integers(2, 6))
    order, shift = integer + request.draw(0.55 if slow else 0.2, 0.8), request.phase()
    return request.effect(
        f"A cos({order:g} thm + phi) sgn w",
        request.torque(1.4),
        simply(dry=lambda s, a: a * cos(order * s.theta + shift)),
        ("motor_angle",),
        (order, shift),
    )


def cogging(request: Request) -> PlantedEffect:
    """Cogging torque of slots and magnets, n times per turn of the motor (Hanselman 2003)."""
    order, shift = int(request.variant[2:]), request.phase()
    return request.effect(
        f"A cos({order} thm + phi)",
        request.torque(1.4),
        simply(torque=lambda s, a: a * cos(order * s.theta + shift)),
        ("motor_angle",),
        (float(order), shift),
    )


def kt_ripple(request: Request) -> PlantedEffect:
    """Torque and back-EMF constant that vary n times per turn of the motor (commutation)."""
    order, shift = int(request.variant[2:]), request.phase()
    return request.effect(
        f"k_i, k_e -> k_i, k_e times 1 + A cos({order} thm + phi)",
        request.torque(1.4) / request.motor_torque,
        simply(flux=lambda s, a: a * cos(order * s.theta + shift)),
        ("motor_angle", "current"),
        (float(order), shift),
        bound=0.6,
        channel="electrical",
    )


def local_defect(request: Request) -> PlantedEffect:
    """Tight spot at one angle of the link: a bump of dry friction."""
    centre, width = request.phase(), request.draw(0.15, 0.4)

    def dry(s: Motion, a: float) -> float:
        away = (s.link - centre + pi) % (2.0 * pi) - pi
        return a * exp(-0.5 * (away / width) ** 2)

    return request.effect(
        "A exp(-((thl - th0)/d)^2/2) sgn w",
        request.torque(3.0),
        simply(dry=dry),
        ("link_angle",),
        (centre, width),
    )


def cable_spring(request: Request) -> PlantedEffect:
    """Cable or hose that winds up with the link."""
    rest = request.phase()
    return request.effect(
        "A (thl - th0)",
        request.torque(0.1),
        simply(torque=lambda s, a: a * (s.link - rest)),
        ("link_angle",),
        (rest,),
    )


def _other_gravity(gravity: Law, turn: Law) -> dict[str, Law]:
    """Return the changes due to `gravity` [m/s^2] in the plane, with the vertical turned by `turn` [rad]."""

    def friction(s: Motion, a: float) -> tuple[float, float]:
        force = s.plant.normal_force(s.link + turn(s, a), s.w_link, gravity(s, a))
        return s.plant.link_friction(force)

    return {
        "torque": lambda s, a: s.plant.gravity_torque(s.link + turn(s, a), gravity(s, a)) - s.gravity,
        "dry": lambda s, a: friction(s, a)[0] - s.link_dry,
        "viscous": lambda s, a: friction(s, a)[1] - s.link_viscous,
    }


def gravity_tilt(request: Request) -> PlantedEffect:
    """Plane of motion tilted by A from the declared one, in gravity torque and normal force."""
    g, load = request.plant.g, _gravity_size(request.plant)
    if request.plant.case == "C1":
        shift = request.phase()
        start = simply(**_other_gravity(lambda s, a: g * sin(a), lambda s, a: shift))
        form, size, shape = ("tilt A: g' = g sin A, down at thl = -phi", request.torque(1.4) / load, (shift,))
    else:
        start = simply(**_other_gravity(lambda s, a: g * cos(a), lambda s, a: 0.0))
        form, size, shape = "tilt A: g' = g cos A", (request.torque(2.8) / load) ** 0.5, ()
    return request.effect(form, size, start, ("link_angle", "gravity_load"), shape, bound=0.7)


def angle_offset(request: Request) -> PlantedEffect:
    """Zero of the link angle off by A, so that gravity acts at a different logged angle."""
    request.require_case("C2", "angle_offset", "without gravity in the plane no angle is special")
    g = request.plant.g
    return request.effect(
        "G(thl + A) - G(thl), and F_N likewise",
        request.torque(1.4) / _gravity_size(request.plant),
        simply(**_other_gravity(lambda s, a: g, lambda s, a: a)),
        ("link_angle", "gravity_load"),
        bound=0.7,
    )


def mass_mismatch(request: Request) -> PlantedEffect:
    """Unbalanced mass larger than declared by the fraction A, in gravity and normal force, not in J_l."""
    request.require_case(
        "C2", "mass_mismatch", "without gravity in the plane it is an alias of B_lN and C_lN"
    )

    def friction(s: Motion, a: float) -> tuple[float, float]:
        plant = s.plant
        ratio = (plant.M * (1.0 + a) + plant.M_l) / (plant.M + plant.M_l)
        force = plant.normal_force(s.link, s.w_link * ((1.0 + a) / ratio) ** 0.5) * ratio
        return plant.link_friction(force)

    start = simply(
        torque=lambda s, a: a * s.gravity,
        dry=lambda s, a: friction(s, a)[0] - s.link_dry,
        viscous=lambda s, a: friction(s, a)[1] - s.link_viscous,
    )
    size = request.torque(1.4) / _gravity_size(request.plant)
    return request.effect(
        "M -> M (1 + A) in G and F_N", size, start, ("gravity_load", "link_angle"), bound=0.9
    )


def kinematic_error(request: Request) -> PlantedEffect:
    """Gear whose ratio varies n times per turn of the motor or the link (transmission error).

    Unless requested otherwise, it follows the link angle for reductions above 12: a log at 250 rows per
    second cannot show a ripple of so fast a motor.
    """
    plant, setting = request.plant, request.setting
    where, order = request.variant.split(",n=")
    if not request.chosen and plant.mu < 1.0 / 12.0:
        where = "link"
    n = int(order)
    rate, shift = (n if where == "motor" else n * plant.mu), request.phase()
    load = hypot(plant.gravity_torque(pi / 2, plant.in_plane_gravity), setting.friction)
    inertial = plant.mu**2 * plant.J_l * rate * setting.speed**2
    letter = {"motor": "thm", "link": "thl"}[where]
    return request.effect(
        f"thl = mu thm + A sin({n} {letter} + phi), in angle, ratio and acceleration of the link",
        request.torque(1.4) * plant.mu / (rate * hypot(load, inertial)),
        simply(
            **{
                "link angle": lambda s, a: a * sin(rate * s.theta + shift),
                "link ratio": lambda s, a: a * rate * cos(rate * s.theta + shift),
                "link bend": lambda s, a: -a * rate**2 * sin(rate * s.theta + shift),
            }
        ),
        ("motor_angle" if where == "motor" else "link_angle", "transmitted_torque", "acceleration"),
        (rate, shift),
        variant=f"{where},n={n}",
        bound=0.2 * plant.mu / rate,
    )


def inertia_mismatch(request: Request) -> PlantedEffect:
    """Inertia on the motor side larger than declared by the fraction A."""
    return request.effect(
        "A J dw/dt",
        request.strength,
        simply(inertia=lambda s, a: a * s.plant.inertia),
        ("acceleration",),
        bound=3.0,
    )


def _gravity_size(plant: Plant) -> float:
    return plant.gravity_torque(pi / 2, plant.g)
