"""Outwards: the motion of a body from that of its parent, by the formulas of `motion`."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from eccentric.model.chain import motion
from eccentric.model.chain.chain import Link
from eccentric.model.chain.motion import AXES
from eccentric.model.chain.steps import Steps, substituted
from eccentric.model.quantity import Quantity, quantity


@dataclass(frozen=True)
class Inputs:
    """The motion of one motor, as the paper has it: angle, velocity, acceleration."""

    theta_m: Quantity
    omega_m: Quantity
    alpha_m: Quantity


def motor_inputs(joint: int) -> Inputs:
    """The inputs of one motor; those of all joints are a vector with one entry a joint."""
    return Inputs(
        quantity(f"theta_m_{joint}", "rad", f"angle of motor {joint}", "(3)"),
        quantity(f"omega_m_{joint}", "rad/s", f"velocity of motor {joint}", "(3)"),
        quantity(f"alpha_m_{joint}", "rad/s^2", f"acceleration of motor {joint}", "(1)"),
    )


@dataclass(frozen=True)
class Moving:
    """A body on the way outwards, in the components of its own frame.

    Attributes:
        w, alpha: angular velocity and acceleration.
        a: acceleration of the origin, gravity subtracted.
        U: a + U rho is the acceleration of a point at rho.
        turn: what the joint turns: axes of the frame, as columns, in the joint's frame at angle 0.
        position: of its origin in the frame of the parent.
        carried: angular velocity of the parent in the joint's frame at angle 0.
    """

    w: sp.ImmutableMatrix
    alpha: sp.ImmutableMatrix
    a: sp.ImmutableMatrix
    U: sp.ImmutableMatrix
    turn: sp.ImmutableMatrix
    position: sp.ImmutableMatrix
    carried: sp.ImmutableMatrix


def outwards(steps: Steps, j: int, link: Link, parent: Moving, inputs: Inputs) -> Moving:
    """The motion of a body from that of its parent."""
    joint, mu, axis = link.joint, link.joint.mu, link.axis
    unit, name = ("rad", "angle") if joint.turns else ("m", "position")
    theta = steps(f"theta_l_{j}", unit, f"{name} of joint {j}", mu * inputs.theta_m.symbol)
    omega = steps(f"omega_l_{j}", f"{unit}/s", f"velocity of joint {j}", mu * inputs.omega_m.symbol)
    alpha = steps(f"alpha_l_{j}", f"{unit}/s^2", f"acceleration of joint {j}", mu * inputs.alpha_m.symbol)
    zero = sp.Integer(0)
    theta, omega, alpha = (link.sign * x for x in (theta, omega, alpha))
    # The origin of the joint's frame, still in the components of the parent.
    direction = link.rotation[:, axis]
    slide = [zero * direction] * 3 if joint.turns else [x * direction for x in (theta, omega, alpha)]
    position = steps.vector(f"p_{j}", "m", f"joint {j} in the frame of its parent", link.position + slide[0])
    origin = substituted(
        motion.acceleration(),
        (motion.a, parent.a),
        (motion.w, parent.w),
        (motion.U, parent.U),
        (motion.s, position),
        (motion.s_dot, slide[1]),
        (motion.s_ddot, slide[2]),
    )
    origin = steps.vector(f"a_p_{j}", "m/s^2", f"acceleration of joint {j}, frame of its parent", origin)
    # In the components of the joint's frame at angle 0, which is fixed to the parent.
    back = link.rotation.T
    w = steps.vector(f"w_p_{j}", "rad/s", f"angular velocity of the parent of joint {j}", back * parent.w)
    change = steps.vector(f"alpha_p_{j}", "rad/s^2", f"its derivative, joint {j}", back * parent.alpha)
    a = steps.vector(f"a_0_{j}", "m/s^2", f"acceleration of joint {j}, at angle 0", back * origin)
    if not joint.turns:
        U = _turning(steps, j, w, change)
        return Moving(w, change, a, U, sp.ImmutableMatrix(sp.eye(3)), position, w)
    frame = motion.turned(axis)
    cosine = steps(f"cosine_{j}", "1", f"cosine of joint {j}", sp.cos(theta))
    sine = steps(f"sine_{j}", "1", f"sine of joint {j}", sp.sin(theta))
    of_angle = ((motion.cosine, motion.sine), (cosine, sine))
    rotation = substituted(frame.rotation, of_angle)
    velocity = substituted(frame.velocity, of_angle, (motion.w, w), ((motion.rate_l,), (omega,)))
    velocity = steps.vector(f"w_{j}", "rad/s", f"angular velocity of body {j}", velocity)
    change = substituted(
        frame.acceleration,
        of_angle,
        (motion.w, velocity),
        (motion.alpha, change),
        ((motion.rate_l, motion.acceleration_l), (omega, alpha)),
    )
    change = steps.vector(f"alpha_{j}", "rad/s^2", f"angular acceleration of body {j}", change)
    a = steps.vector(f"a_{j}", "m/s^2", f"acceleration of the origin of body {j}", rotation.T * a)
    return Moving(velocity, change, a, _turning(steps, j, velocity, change), rotation, position, w)


def along(link: Link, given: sp.MatrixBase) -> sp.Expr:
    """The component of a vector of the parent along the axis of the joint's frame."""
    return (link.rotation[:, link.axis].T * given)[0]


def _turning(steps: Steps, j: int, w: sp.ImmutableMatrix, alpha: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """U = S(alpha) + S(w)^2 of a body, whose products of velocities are formed once."""
    values = {
        motion.w[i] * motion.w[k]: steps(
            f"w_{j}_{AXES[i]}{AXES[k]}", "rad^2/s^2", f"product of velocities of body {j}", w[i] * w[k]
        )
        for i in range(3)
        for k in range(i, 3)
    }
    U = motion.turning().xreplace(values | dict(zip(motion.alpha, alpha, strict=True)))
    named = [
        steps(f"U_{j}_{AXES[i]}{AXES[k]}", "1/s^2", f"acceleration of body {j} by position", U[i, k])
        for i in range(3)
        for k in range(3)
    ]
    return sp.ImmutableMatrix(3, 3, named)
