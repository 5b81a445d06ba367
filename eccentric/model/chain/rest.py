"""The chain at rest: the torques that hold its weight."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from eccentric.model.chain.recursion import Recursion
from eccentric.model.definition import Definition

__all__ = ["at_rest"]


def at_rest(found: Recursion) -> tuple[tuple[Definition, ...], tuple[sp.Expr, ...]]:
    """The recursion without velocities and accelerations.

    Returns:
        What is left of its definitions, under their names, and the torque of every motor [N m].
    """
    zero = sp.Integer(0)
    known: dict[sp.Expr, sp.Expr] = {
        x.symbol: zero for inputs in found.inputs for x in (inputs.omega_m, inputs.alpha_m)
    }
    left = []
    for definition in found.definitions:
        value = definition.value.xreplace(known)
        if value.is_Atom or (-value).is_Symbol:
            known[definition.symbol] = value
        else:
            left.append(replace(definition, value=value))
    of_joints = zip(found.chain.joints, found.rotors, found.torques, strict=True)
    torques = (rotor + joint.mu * torque for joint, rotor, torque in of_joints)
    return tuple(left), tuple(torque.xreplace(known) for torque in torques)
