"""The recursion along a chain: motion from the base outwards, force and moment from the end inwards.

Each step is one of the formulas derived in `motion` and `momentum`, with the numbers and letters of the
chain in place of its letters. The result is a list of scalar definitions, linear in the number of joints.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from eccentric.model.chain.bearing import Bearing, bearing
from eccentric.model.chain.chain import Chain
from eccentric.model.chain.inwards import ZERO, Wrench, inwards, moments_of
from eccentric.model.chain.outwards import Inputs, Moving, along, motor_inputs, outwards
from eccentric.model.chain.steps import Steps
from eccentric.model.definition import Definition


@dataclass(frozen=True)
class Recursion:
    """The recursion of a chain.

    Attributes:
        chain: of which.
        inputs: of each motor.
        definitions: of everything below, in order.
        moving: each body's motion.
        wrenches: of each joint, in the frame that `Chain.links` gives it.
        bearings: what each joint's bearing carries, and what its gear passes on.
        rotors: torque that accelerates each rotor, motor side [N m].
    """

    chain: Chain
    inputs: tuple[Inputs, ...]
    definitions: tuple[Definition, ...]
    moving: tuple[Moving, ...]
    wrenches: tuple[Wrench, ...]
    bearings: tuple[Bearing, ...]
    rotors: tuple[sp.Expr, ...]

    @cached_property
    def torques(self) -> tuple[sp.Expr, ...]:
        """Torque [N m] or force [N] of each joint about or along its axis: what its gear passes on."""
        return tuple(bearing.transmitted for bearing in self.bearings)


def recursion(chain: Chain) -> Recursion:
    """The recursion of a chain: Newton and Euler for every body, from positions differentiated."""
    steps = Steps()
    inputs = tuple(motor_inputs(j) for j in range(len(chain.joints)))
    links = chain.links
    bodies = [moments_of(steps, j, link) for j, link in enumerate(links)]
    at_base = Moving(
        ZERO,
        ZERO,
        steps.vector("a_base", "m/s^2", "minus gravity", -chain.gravity),
        sp.ImmutableMatrix(sp.zeros(3)),
        sp.ImmutableMatrix(sp.eye(3)),
        ZERO,
        ZERO,
    )
    moving, before = [], at_base
    for j, link in enumerate(links):
        before = outwards(steps, j, link, before, inputs[j])
        moving.append(before)
    inner = [at_base, *moving[:-1]]
    wrenches = inwards(steps, links, bodies, moving, inputs)
    bearings = tuple(
        bearing(steps, j, link, wrench.force, wrench.moment)
        for j, (link, wrench) in enumerate(zip(links, wrenches, strict=True))
    )
    rotors = tuple(
        steps(
            f"rotor_{j}",
            "N m",
            f"torque that accelerates rotor {j}, carried by its parent",
            link.joint.J_m * (inputs[j].alpha_m.symbol + link.sign * along(link, parent.alpha)),
        )
        for j, (link, parent) in enumerate(zip(links, inner, strict=True))
    )
    return Recursion(chain, inputs, tuple(steps.definitions), tuple(moving), wrenches, bearings, rotors)
