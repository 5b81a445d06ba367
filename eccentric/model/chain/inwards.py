"""Inwards: the force and moment of every joint, by the formulas of `momentum`."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from eccentric.model.chain import momentum, motion
from eccentric.model.chain.chain import Link
from eccentric.model.chain.exact import is_zero
from eccentric.model.chain.motion import AXES
from eccentric.model.chain.outwards import Inputs, Moving
from eccentric.model.chain.steps import Steps, substituted

ZERO = sp.ImmutableMatrix([0, 0, 0])


@dataclass(frozen=True)
class Wrench:
    """What a joint exerts on the body that it moves; the load on the joint is the opposite.

    Attributes:
        force: in the frame of the body [N].
        moment: about the origin of that frame [N m].
    """

    force: sp.ImmutableMatrix
    moment: sp.ImmutableMatrix


def moments_of(steps: Steps, j: int, link: Link) -> dict[sp.Symbol, sp.Expr]:
    """The moments of mass of a body by the letters of `momentum`."""
    given, found = link.moments, {}
    found[momentum.m] = steps(f"body_mass_{j}", "kg", f"mass of body {j}", given.mass)
    first = steps.vector(f"body_h_{j}", "kg m", f"first moment of body {j}", given.first)
    found |= dict(zip(momentum.h, first, strict=True))
    for i in range(3):
        for k in range(i, 3):
            name = f"body_Sigma_{j}_{AXES[i]}{AXES[k]}"
            meaning = f"second moment of body {j}, component {AXES[i]}{AXES[k]}"
            found[momentum.Sigma[i, k]] = steps(name, "kg m^2", meaning, given.second[i, k])
    return found


def inwards(
    steps: Steps,
    links: tuple[Link, ...],
    bodies: list[dict[sp.Symbol, sp.Expr]],
    moving: list[Moving],
    inputs: tuple[Inputs, ...],
) -> tuple[Wrench, ...]:
    """The wrench of each joint: what moves its body, and what that hands on to the next one."""
    found: list[Wrench] = []
    force, moment = ZERO, ZERO  # of the next joint, in the frame of this body
    for j in reversed(range(len(links))):
        own, link, here = _of_body(steps, j, bodies[j], moving[j]), links[j], moving[j]
        force = steps.vector(f"force_{j}", "N", f"force on body {j} by its joint", own.force + force)
        moment = steps.vector(f"moment_{j}", "N m", f"moment on body {j} by its joint", own.moment + moment)
        found.append(Wrench(force, moment))
        if j == 0:
            break
        # Into the frame of the parent, about its origin.
        force = steps.vector(f"force_0_{j}", "N", f"force of joint {j}, at angle 0", here.turn * force)
        moment = here.turn * moment + _of_rotor(link, here, inputs[j])
        moment = steps.vector(
            f"moment_0_{j}", "N m", f"moment of joint {j}, at angle 0, rotor included", moment
        )
        force = steps.vector(
            f"force_p_{j}", "N", f"force of joint {j}, frame of its parent", link.rotation * force
        )
        moment = link.rotation * moment + here.position.cross(force)
        moment = steps.vector(
            f"moment_p_{j}", "N m", f"moment of joint {j}, about its parent's origin", moment
        )
    return tuple(reversed(found))


def _of_body(steps: Steps, j: int, moments: dict[sp.Symbol, sp.Expr], moving: Moving) -> Wrench:
    """The force and moment that move a body as it does, gravity included."""
    letters, values = tuple(moments), tuple(moments.values())
    # (U_zz - U_yy) Sigma_yz: the difference is formed once.
    differences = {
        motion.U[k, k] - motion.U[i, i]: steps(
            f"U_{j}_{AXES[k]}{AXES[k]}_{AXES[i]}{AXES[i]}",
            "1/s^2",
            f"difference of two of body {j}",
            moving.U[k, k] - moving.U[i, i],
        )
        for i, k in ((1, 2), (2, 0), (0, 1))
        if not is_zero(moments[momentum.Sigma[min(i, k), max(i, k)]])
    }
    of_motion = ((motion.a, moving.a), (motion.U, moving.U), (letters, values))
    force = substituted(momentum.force(), *of_motion)
    moment = substituted(momentum.moment().xreplace(differences), *of_motion)
    return Wrench(
        steps.vector(f"force_b_{j}", "N", f"mass times acceleration of body {j}", force),
        steps.vector(f"moment_b_{j}", "N m", f"rate of angular momentum of body {j}", moment),
    )


def _of_rotor(link: Link, moving: Moving, inputs: Inputs) -> sp.ImmutableMatrix:
    """The moment of the turning rotor on its carrier, the parent: gyroscopic, and by its acceleration."""
    speeds = (link.sign * inputs.omega_m.symbol, link.sign * inputs.alpha_m.symbol)
    if is_zero(link.joint.J_m):
        return ZERO
    return substituted(
        momentum.rotor(link.axis),
        (motion.w, moving.carried),
        ((momentum.J_m, momentum.omega_m, momentum.alpha_m), (link.joint.J_m, *speeds)),
    )
