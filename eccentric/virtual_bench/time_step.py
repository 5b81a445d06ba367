"""One step of the rig's motion: second order in time while moving, exact while sticking.

    (J_m + mu^2 J_l) dw/dt + G(theta) + (b + k_i k_e / R) w + c Sgn(w) + effects = k_i u / R

A gear of variable ratio r(theta) transmits the link's torques by r instead of mu, its inertia by r^2, and
adds J_l r dr/dtheta w^2.

Angles drift for half a step, the speed is kicked, angles drift for the other half. In the kick the linear
damping is evaluated at the mean of old and new speed, and the Coulomb friction c is set-valued: the new speed
solves

    (J + b dt/2) w' + dt c Sgn(w') contains (J - b dt/2) w + dt T,

whose unique solution is a soft threshold. A link below its Coulomb level is therefore exactly at rest,
without tanh, creep or event search.
"""

from collections.abc import Callable, Sequence
from math import cos, hypot, sin

from eccentric.virtual_bench.effects import Law, PlantedEffect
from eccentric.virtual_bench.plant import Motion, Plant

BoundLaw = tuple[str, PlantedEffect, Law]
"""A port, the effect that acts there, and its law with fresh memory."""


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
