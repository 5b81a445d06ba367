"""The recursion along a chain: motion from the base outwards, force and moment from the end inwards.

Each step is one of the formulas derived in `motion`, with the chain's numbers and symbols substituted. The
result is a list of scalar definitions, linear in the number of joints.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import sympy as sp

from eccentric.model.balance import Load
from eccentric.model.chain import motion
from eccentric.model.chain.chain import Chain, Link
from eccentric.model.chain.links import is_zero
from eccentric.model.chain.motion import AXES, Steps, substituted
from eccentric.model.quantity import Definition, Quantity, quantity
from eccentric.model.steps import Magnitude


@dataclass(frozen=True)
class Inputs:
    """The motion of one motor, as in the paper: angle, velocity, acceleration."""

    theta_m: Quantity
    omega_m: Quantity
    alpha_m: Quantity


def motor_inputs(joint: int) -> Inputs:
    """The inputs of one motor, an entry of the vectors of all joints."""
    return Inputs(
        quantity(f"theta_m_{joint}", "rad", f"angle of motor {joint}", "(3)"),
        quantity(f"omega_m_{joint}", "rad/s", f"velocity of motor {joint}", "(3)"),
        quantity(f"alpha_m_{joint}", "rad/s^2", f"acceleration of motor {joint}", "(1)"),
    )


@dataclass(frozen=True)
class Moving:
    """The motion of a body, in the components of its frame."""

    w: sp.ImmutableMatrix  # angular velocity
    alpha: sp.ImmutableMatrix  # angular acceleration
    a: sp.ImmutableMatrix  # acceleration of the origin, gravity subtracted
    U: sp.ImmutableMatrix  # a + U rho is the acceleration of a point at rho
    turn: sp.ImmutableMatrix  # by the joint: axes of the frame, as columns, in the joint's frame at angle 0
    position: sp.ImmutableMatrix  # of its origin in the frame of the parent
    carried: sp.ImmutableMatrix  # angular velocity of the parent in the joint's frame at angle 0


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


def along(link: Link, parent_vector: sp.MatrixBase) -> sp.Expr:
    """The component of a vector of the parent along the axis of the joint's frame."""
    return (link.rotation[:, link.axis].T * parent_vector)[0]


def _turning(steps: Steps, j: int, w: sp.ImmutableMatrix, alpha: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """U = S(alpha) + S(w)^2 of a body, with each product of velocities formed once."""
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


@dataclass(frozen=True)
class Bearing:
    """The loads of one joint.

    A revolute joint: the radial force F_N across its axis, the axial force F_T along it, the bending moment
    M_B across it, about the centre of the bearing, and the torque about it, transmitted by the gear.

    A prismatic joint: its guide carries the force F_N across the axis and the complete moment M_B; the force
    along the axis is transmitted by the drive, so there is no axial load.
    """

    loads: Mapping[Load, sp.Expr]  # magnitudes by kind of load
    transmitted: sp.Expr  # torque [N m] or force [N] by which the joint drives its body, signed


def bearing(
    steps: Steps, j: int, link: Link, force: sp.ImmutableMatrix, moment: sp.ImmutableMatrix
) -> Bearing:
    """The loads of joint j from the force and moment on its body, in the frame of the link."""
    along = sp.ImmutableMatrix([int(k == link.axis) for k in range(3)])
    across = [k for k in range(3) if k != link.axis]
    radial = steps(
        f"F_N_{j}", "N", f"force across the axis of joint {j}", magnitude([force[k] for k in across])
    )
    # The frame and its axis: a negative sign turns the sense of the joint, not the frame.
    centre = link.sign * link.joint.bearing * along
    about_centre = steps.vector(
        f"moment_c_{j}", "N m", f"moment about the centre of bearing {j}", moment - centre.cross(force)
    )
    carried = [about_centre[k] for k in (across if link.joint.turns else range(3))]
    bending = steps(f"M_B_{j}", "N m", f"moment on the bearing of joint {j}", magnitude(carried))
    loads = {Load.NORMAL: radial, Load.BENDING: bending}
    if link.joint.turns:
        transmitted = link.sign * moment[link.axis]
        loads[Load.TRANSVERSAL] = steps(
            f"F_T_{j}", "N", f"force along the axis of joint {j}", sp.Abs(force[link.axis])
        )
    else:
        transmitted = link.sign * force[link.axis]
    unit, what = ("N m", "torque") if link.joint.turns else ("N", "force")
    loads[Load.TRANSMITTED] = steps(
        f"T_{j}", unit, f"size of the {what} that the drive of joint {j} transmits", sp.Abs(transmitted)
    )
    return Bearing(loads, transmitted)


def magnitude(components: list[sp.Expr]) -> sp.Expr:
    """The norm of a vector; components that are identically 0 are omitted."""
    nonzero = [component for component in components if not is_zero(component)]
    if len(nonzero) < 2:
        return sp.Abs(nonzero[0]) if nonzero else sp.Integer(0)
    norm = nonzero[0]
    for component in nonzero[1:]:
        norm = Magnitude(norm, component)
    return norm


ZERO = sp.ImmutableMatrix([0, 0, 0])


@dataclass(frozen=True)
class Wrench:
    """The wrench of a joint on the body that it moves; the load on the joint is the opposite."""

    force: sp.ImmutableMatrix  # in the frame of the body [N]
    moment: sp.ImmutableMatrix  # about the origin of that frame [N m]


def moments_of(steps: Steps, j: int, link: Link) -> dict[sp.Symbol, sp.Expr]:
    """The moments of mass of a body by the symbols of `motion`."""
    body, by_symbol = link.moments, {}
    by_symbol[motion.m] = steps(f"body_mass_{j}", "kg", f"mass of body {j}", body.mass)
    first = steps.vector(f"body_h_{j}", "kg m", f"first moment of body {j}", body.first)
    by_symbol |= dict(zip(motion.h, first, strict=True))
    for i in range(3):
        for k in range(i, 3):
            name = f"body_Sigma_{j}_{AXES[i]}{AXES[k]}"
            meaning = f"second moment of body {j}, component {AXES[i]}{AXES[k]}"
            by_symbol[motion.Sigma[i, k]] = steps(name, "kg m^2", meaning, body.second[i, k])
    return by_symbol


def inwards(
    steps: Steps,
    links: tuple[Link, ...],
    bodies: list[dict[sp.Symbol, sp.Expr]],
    moving: list[Moving],
    inputs: tuple[Inputs, ...],
) -> tuple[Wrench, ...]:
    """The wrench of each joint: to move its body, plus the wrench of the next joint."""
    wrenches: list[Wrench] = []
    force, moment = ZERO, ZERO  # of the next joint, in the frame of this body
    for j in reversed(range(len(links))):
        body, link, motion_j = _of_body(steps, j, bodies[j], moving[j]), links[j], moving[j]
        force = steps.vector(f"force_{j}", "N", f"force on body {j} by its joint", body.force + force)
        moment = steps.vector(f"moment_{j}", "N m", f"moment on body {j} by its joint", body.moment + moment)
        wrenches.append(Wrench(force, moment))
        if j == 0:
            break
        # Into the frame of the parent, about its origin.
        force = steps.vector(f"force_0_{j}", "N", f"force of joint {j}, at angle 0", motion_j.turn * force)
        moment = motion_j.turn * moment + _of_rotor(link, motion_j, inputs[j])
        moment = steps.vector(
            f"moment_0_{j}", "N m", f"moment of joint {j}, at angle 0, rotor included", moment
        )
        force = steps.vector(
            f"force_p_{j}", "N", f"force of joint {j}, frame of its parent", link.rotation * force
        )
        moment = link.rotation * moment + motion_j.position.cross(force)
        moment = steps.vector(
            f"moment_p_{j}", "N m", f"moment of joint {j}, about its parent's origin", moment
        )
    return tuple(reversed(wrenches))


def _of_body(steps: Steps, j: int, moments: dict[sp.Symbol, sp.Expr], moving: Moving) -> Wrench:
    """The force and moment required for the motion of a body, gravity included."""
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
        if not is_zero(moments[motion.Sigma[min(i, k), max(i, k)]])
    }
    of_motion = ((motion.a, moving.a), (motion.U, moving.U), (letters, values))
    force = substituted(motion.force(), *of_motion)
    moment = substituted(motion.moment().xreplace(differences), *of_motion)
    return Wrench(
        steps.vector(f"force_b_{j}", "N", f"mass times acceleration of body {j}", force),
        steps.vector(f"moment_b_{j}", "N m", f"rate of angular momentum of body {j}", moment),
    )


def _of_rotor(link: Link, moving: Moving, inputs: Inputs) -> sp.ImmutableMatrix:
    """The gyroscopic and acceleration moment of a rotor on its carrier, the parent."""
    speeds = (link.sign * inputs.omega_m.symbol, link.sign * inputs.alpha_m.symbol)
    if is_zero(link.joint.J_m):
        return ZERO
    return substituted(
        motion.rotor(link.axis),
        (motion.w, moving.carried),
        ((motion.J_m, motion.omega_m, motion.alpha_m), (link.joint.J_m, *speeds)),
    )


@dataclass(frozen=True)
class Recursion:
    """The recursion of a chain.

    Attributes:
        chain: the chain.
        inputs: of each motor.
        definitions: of all symbols below, in order.
        moving: motion of each body.
        wrenches: of each joint, in its frame of `Chain.links`.
        bearings: bearing loads and transmitted torque of each joint.
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
        """Torque [N m] or force [N] of each joint about or along its axis, transmitted by its gear."""
        return tuple(bearing.transmitted for bearing in self.bearings)

    @cached_property
    def motor_torques(self) -> tuple[sp.Expr, ...]:
        """Torque [N m] of each motor for bodies, rotors and gravity, without friction."""
        of_joints = zip(self.chain.joints, self.rotors, self.torques, strict=True)
        return tuple(rotor + joint.mu * torque for joint, rotor, torque in of_joints)

    @cached_property
    def standing(self) -> dict[sp.Expr, sp.Expr]:
        """Velocities and accelerations of the motors -> 0."""
        return {x.symbol: sp.Integer(0) for inputs in self.inputs for x in (inputs.omega_m, inputs.alpha_m)}


def recursion(chain: Chain) -> Recursion:
    """The recursion of a chain: Newton and Euler for every body, derived from positions."""
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


def at_rest(found: Recursion) -> tuple[tuple[Definition, ...], tuple[sp.Expr, ...]]:
    """The recursion without velocities and accelerations.

    Returns:
        The remaining definitions, under their names, and the torque of every motor [N m].
    """
    known, remaining = dict(found.standing), []
    for definition in found.definitions:
        value = definition.value.xreplace(known)
        if value.is_Atom or (-value).is_Symbol:
            known[definition.symbol] = value
        else:
            remaining.append(replace(definition, value=value))
    return tuple(remaining), tuple(torque.xreplace(known) for torque in found.motor_torques)
