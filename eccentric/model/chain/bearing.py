"""What a joint's bearing carries, and what its gear passes on: the loads that friction follows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from eccentric.model.chain.chain import Link
from eccentric.model.chain.exact import is_zero
from eccentric.model.chain.steps import Steps
from eccentric.model.role import Load
from eccentric.model.steps import Magnitude


@dataclass(frozen=True)
class Bearing:
    """The loads of one joint.

    A revolute joint: the radial force F_N across its axis, the axial force F_T along it, the bending moment
    M_B across it, about the centre of the bearing, and the torque about it, which the gear passes on.

    A prismatic joint: its guide carries the force F_N across the axis and the whole moment M_B; the force
    along the axis is what the drive passes on, so there is no axial load.

    Attributes:
        loads: magnitudes by the load that they are.
        transmitted: torque [N m] or force [N] by which the joint drives its body, with its sign.
    """

    loads: Mapping[Load, sp.Expr]
    transmitted: sp.Expr


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
        f"T_{j}", unit, f"size of the {what} that the drive of joint {j} passes on", sp.Abs(transmitted)
    )
    return Bearing(loads, transmitted)


def magnitude(components: list[sp.Expr]) -> sp.Expr:
    """The norm of a vector without its components that are 0."""
    given = [component for component in components if not is_zero(component)]
    if len(given) < 2:
        return sp.Abs(given[0]) if given else sp.Integer(0)
    found = given[0]
    for component in given[1:]:
        found = Magnitude(found, component)
    return found
