"""The bodies of an arm from its logs: base parameters of all joints at once, and bodies that have them.

Each joint's torque is linear in the inertial parameters and in its own friction. The joints are weighted by
what a fit of each alone leaves, so that a strong drive does not drown the wrist.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.estimation import Coefficient, Design, Estimate
from eccentric.fitting import base_coefficients, base_columns
from eccentric.joints.arm_log import ArmLog
from eccentric.joints.base_parameters import BaseParameters, base_of, names_of
from eccentric.joints.possible import PossibleBodies, possible_bodies
from eccentric.model import letters_of

__all__ = ["IdentifiedBodies", "identified_bodies"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class IdentifiedBodies:
    """What the logs say of the bodies.

    Attributes:
        base: the sums of inertial parameters that they determine.
        estimates: of each, by the name of its first parameter, with the sum in words in `sums`.
        sums: in words.
        bodies: bodies that could exist, next to the declared ones.
    """

    base: BaseParameters
    estimates: Mapping[str, Estimate]
    sums: tuple[str, ...]
    bodies: PossibleBodies


def identified_bodies(log: ArmLog) -> IdentifiedBodies | None:
    """The bodies by the training part; None where they are known, or a drive has no torque.

    Friction is Coulomb and viscous, and by the loads of the declared bodies where a joint can show it.
    """
    if not log.rig.open or any(log.drive(j).unit != "N m" for j in range(len(log))):
        return None
    blocks = [_block(log, j) for j in range(len(log))]
    base = base_of(np.vstack([block.bodies * block.weight for block in blocks]))
    bodies = [
        Coefficient(name, "bodies", letters_of(0)[place % 10].unit)
        for place, name in ((p, names_of(len(log))[p]) for p in base.chosen)
    ]
    friction = [c for block in blocks for c in block.coefficients]
    rows = sum(len(block.target) for block in blocks)
    columns = np.zeros((rows, len(bodies) + len(friction)))
    target, weights, at, own = np.empty(rows), np.empty(rows), 0, len(bodies)
    for block in blocks:
        here, there = slice(at, at + len(block.target)), slice(own, own + len(block.coefficients))
        columns[here, : len(bodies)] = block.bodies[:, base.chosen]
        columns[here, there] = block.friction
        target[here], weights[here] = block.target, block.weight**2
        at, own = here.stop, there.stop
    design = Design((*bodies, *friction), target, columns, np.ones(rows, dtype=bool), weights)
    solution = design.solve()
    error, unit = solution.spread(), np.eye(columns.shape[1])
    estimates = {
        c.name: error.estimate(float(solution.values[k]), unit[k], c.unit) for k, c in enumerate(bodies)
    }
    found = solution.values[: len(bodies)]
    errors = np.array([e.std_error for e in estimates.values()])
    possible = possible_bodies(log.values, base, found, errors, log.rig.known)
    return IdentifiedBodies(base, estimates, tuple(base.words(names_of(len(log)))), possible)


@dataclass(frozen=True)
class _Block:
    """The training rows of one joint; the torque without the rotors' share, in N m."""

    coefficients: tuple[Coefficient, ...]
    target: Array
    bodies: Array
    friction: Array
    weight: float


def _block(log: ArmLog, j: int) -> _Block:
    rows, drive = log.rows(j), log.drive(j)
    train = rows.train
    loads = log.present(j)
    model, data = log.joint(j, loads)
    own = [k for k, c in enumerate(base_coefficients(model, data.signals)) if c.role == "friction"]
    coefficients = [base_coefficients(model, data.signals)[k] for k in own]
    friction = rows.mean(base_columns(model, data.signals)[:, own])[train]
    regressor = rows.plain_mean(log.regressor(j))[train]
    rotors = log.module.torques(log.motion(), np.zeros(log.module.count))[:, j]
    target = rows.mean(drive.torque())[train] - rows.plain_mean(rotors)[train]
    named = tuple(
        Coefficient(f"{c.name}_{log.rig.number(j)}", "friction", c.unit, c.lower, c.upper)
        for c in coefficients
    )
    base = base_of(regressor)
    whole = np.column_stack([regressor[:, base.chosen], friction])
    left = target - whole @ np.linalg.lstsq(whole, target, rcond=None)[0]
    return _Block(named, target, regressor, friction, 1.0 / float(np.sqrt(np.mean(left**2))))
