"""A chain with a letter for every inertial parameter: ten for each body, linear in forces and moments."""

from __future__ import annotations

import copy
from collections.abc import Sequence

import sympy as sp

from eccentric.model.chain.body import Moments
from eccentric.model.chain.chain import Chain
from eccentric.model.chain.motion import AXES
from eccentric.model.quantity import Quantity, quantity

__all__ = ["letters_of", "moments_from", "with_letters"]

_UPPER = [(i, k) for i in range(3) for k in range(i, 3)]


def letters_of(j: int) -> tuple[Quantity, ...]:
    """The inertial parameters of body j about the origin of its joint's frame: mass, h, Sigma row by row."""
    body = f"of body {j}"
    return (
        quantity(f"mass_{j}", "kg", f"mass {body}", "", "real", "0", letter=f"m_{j}"),
        *(quantity(f"h_{j}_{a}", "kg m", f"first moment {body}, {a}", "", "real", "0") for a in AXES),
        *(
            quantity(
                f"Sigma_{j}_{AXES[i]}{AXES[k]}",
                "kg m^2",
                f"second moment {body}, {AXES[i]}{AXES[k]}",
                "",
                "real",
                "0",
            )
            for i, k in _UPPER
        ),
    )


def _rotor_letter(j: int) -> Quantity:
    """The inertia of rotor j."""
    return quantity(f"J_m_{j}", "kg m^2", f"inertia of rotor {j}")


def moments_from(x: Sequence[sp.Expr]) -> Moments:
    """The moments of mass of a body from its ten inertial parameters, in the order of `letters_of`."""
    entries = dict(zip(_UPPER, x[4:], strict=True))
    second = [[entries[min(i, k), max(i, k)] for k in range(3)] for i in range(3)]
    return Moments(x[0], sp.ImmutableMatrix(x[1:4]), sp.ImmutableMatrix(second))


def with_letters(chain: Chain, name: str, *, rotors: bool = False) -> Chain:
    """The same chain with letters for its bodies, the payload part of the last one; its own letters stay.

    Args:
        chain: the chain.
        name: of the result.
        rotors: whether the inertias of rotors are letters as well.
    """
    joints, letters = list(chain.joints), []
    bodies = []
    for j, joint in enumerate(chain.joints):
        own = letters_of(j)
        letters += own
        bodies.append(moments_from([q.symbol for q in own]))
        if rotors:
            joints[j] = copy.copy(joint)
            joints[j].J_m = _rotor_letter(j).symbol
    letters += [_rotor_letter(j) for j in range(len(joints))] if rotors else []
    return Chain(name, joints, bodies, chain.gravity, None, (*chain.parameters, *letters))
