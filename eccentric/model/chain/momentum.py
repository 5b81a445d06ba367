"""Newton and Euler for a body: the accelerations of its mass points, summed.

A point at rho in the frame of the body is accelerated by a + U rho (`motion.acceleration`). The force is the
sum of this over the mass, the moment about the origin that of rho x (a + U rho). Both are linear in the
moments of
mass: m, h (first) and Sigma (second).
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from eccentric.model.chain.motion import (
    AXES,
    U,
    acceleration,
    acceleration_l,
    alpha,
    cosine,
    letters,
    pythagoras,
    rate_l,
    s,
    s_ddot,
    s_dot,
    sine,
    turned,
    turning,
    w,
)

m = sp.Symbol("m", real=True)
h, rho = letters("h"), letters("rho")
Sigma = sp.ImmutableMatrix(
    3, 3, lambda i, k: sp.Symbol(f"Sigma_{AXES[min(i, k)]}{AXES[max(i, k)]}", real=True)
)
J_m, omega_m, alpha_m = sp.symbols("J_m omega_m alpha_m", real=True)


def _of_point() -> sp.ImmutableMatrix:
    """Acceleration of a point that is at rest in the body."""
    at_rest = dict.fromkeys((*s_dot, *s_ddot), sp.Integer(0))
    return acceleration().xreplace(at_rest | dict(zip(s, rho, strict=True)))


def _sum_of_mass(density: sp.Expr) -> sp.Expr:
    """The sum over the mass points of a polynomial in rho: 1 is m, rho_i is h_i, rho_i rho_k is Sigma_ik."""
    total = sp.Integer(0)
    for powers, coefficient in sp.Poly(sp.expand(density), *rho).terms():
        axes = [k for k, power in enumerate(powers) for _ in range(power)]
        moment = (m, *(h[k] for k in axes[:1]), *(Sigma[i, axes[0]] for i in axes[1:]))[len(axes)]
        total += sp.collect(coefficient, U) * moment
    # U_zz Sigma_yz - U_yy Sigma_yz as (U_zz - U_yy) Sigma_yz
    return sp.collect(sp.expand(total), list(Sigma))


@cache
def force() -> sp.ImmutableMatrix:
    """Newton: the sum of forces on the body, m times the acceleration of its centre of mass."""
    return _of_point().applyfunc(_sum_of_mass)


@cache
def moment() -> sp.ImmutableMatrix:
    """Euler: the sum of moments on the body about the origin of its frame."""
    return sp.ImmutableMatrix(rho.cross(_of_point())).applyfunc(_sum_of_mass)


@cache
def rotor(axis: int) -> sp.ImmutableMatrix:
    """The moment that the carrier of a turning rotor bears beyond that of a locked one.

    The rotor turns by theta_m about an axis of its carrier, about which it is symmetrical; J_m is its inertia
    about it. In w of the carrier, omega_m and alpha_m of the rotor.
    """
    frame, angle = turned(axis), sp.Symbol("angle", real=True)
    across, along, own = sp.Symbol("across"), sp.Symbol("along"), letters("own")
    mass = {Sigma[i, k]: sp.Integer(0) for i in range(3) for k in range(i)} | dict.fromkeys(h, sp.Integer(0))
    mass |= {Sigma[k, k]: along if k == axis else across for k in range(3)}
    # Its own w and alpha are those of a frame that turns in the carrier, moved by the rotor.
    velocity = frame.velocity.xreplace(dict(zip(w, own, strict=True)))
    change = frame.acceleration.xreplace(dict(zip(w, velocity, strict=True)))
    motion = dict(zip(alpha, change, strict=True)) | dict(zip(w, velocity, strict=True))
    found = moment().xreplace(dict(zip(U, turning(), strict=True)) | mass).xreplace(motion)
    found = (frame.rotation * found).xreplace(dict(zip(own, w, strict=True)))
    found = found.xreplace({rate_l: omega_m, acceleration_l: alpha_m})
    locked = {omega_m: sp.Integer(0), alpha_m: sp.Integer(0), cosine: sp.Integer(1), sine: sp.Integer(0)}
    beyond = (found - found.xreplace(locked)).xreplace({cosine: sp.cos(angle), sine: sp.sin(angle)})
    # The inertia about the axis is the sum of both second moments across it.
    return sp.ImmutableMatrix(
        beyond.applyfunc(lambda entry: sp.factor(pythagoras(entry, angle)).subs(across, J_m / 2))
    )
