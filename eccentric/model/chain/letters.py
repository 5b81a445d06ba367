"""A chain with a letter for every inertial parameter: ten for each body, linear in forces and moments."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping, Sequence

import sympy as sp

from eccentric.core import InputError
from eccentric.model.chain.chain import Chain
from eccentric.model.chain.links import Moments, exact
from eccentric.model.chain.motion import AXES
from eccentric.model.quantity import Quantity, quantity

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


# A chain with the moments of mass that a fit found in place of its bodies.


_NOTHING = 1e-12
"""Of the largest of its kind on the arm: less is what rounding leaves of a zero."""
_ROUNDED = 1e-6
"""Negative part of the moments, by their size, that numbers of six digits leave."""


def with_bodies(chain: Chain, values: Mapping[str, float]) -> Chain:
    """The same chain with other bodies.

    A payload with letters stays one: the last body is what the values leave without its defaults. Any other
    payload is part of the last body.

    Args:
        chain: joints, gravity, payload, and the parameters that they need.
        values: mass_0 [kg], h_0_x to h_0_z [kg m], Sigma_0_xx to Sigma_0_zz [kg m^2] of every body, payload
            included, in the frame of its joint: the inertial parameters of the emitted `inertial_regressor`.

    Raises:
        InputError: one is missing or too many, or a body cannot exist: its mass is negative, or its moments
            are those of no mass.
    """
    left = dict(values)
    bodies = _without_rounding([_body(chain, j, left) for j in range(len(chain.joints))])
    if left:
        raise InputError("bodies", problem=f"{next(iter(left))} is of no body of {chain.name}")
    for j, body in enumerate(bodies):
        _require_possible(j, body)
    payload = chain.payload
    if payload is not None:
        letters = {q.symbol: q.default for q in chain.parameters}
        held = payload.moments
        if held.mass.free_symbols | held.first.free_symbols | held.second.free_symbols:
            mass, first, second = (x.xreplace(letters) for x in (held.mass, held.first, held.second))
            bodies[-1] += Moments(-mass, -first, -second)
            bodies = _without_rounding(bodies)
        else:
            payload = None
    kept = [chain.gravity]
    for joint in chain.joints:
        kept += [joint.mu, joint.J_m, joint.bearing, joint.placement.position, joint.placement.rotation]
    if payload is not None:
        kept += [payload.mass, payload.centre, payload.inertia]
    needed = set().union(*(x.free_symbols for x in kept))
    parameters = [q for q in chain.parameters if q.symbol in needed]
    return Chain(chain.name, chain.joints, bodies, chain.gravity, payload, parameters)


def _without_rounding(bodies: Sequence[Moments]) -> list[Moments]:
    """The bodies with exact zeros where rounding leaves next to nothing: what they multiply folds away."""
    sizes = [max((abs(x) for body in bodies for x in kind(body)), default=0) for kind in _KINDS]

    def cleared(body: Moments) -> Moments:
        mass, first, second = (
            [0 if abs(x) < _NOTHING * size else x for x in kind(body)]
            for kind, size in zip(_KINDS, sizes, strict=True)
        )
        return Moments(sp.sympify(mass[0]), sp.ImmutableMatrix(first), sp.ImmutableMatrix(3, 3, second))

    return [cleared(body) for body in bodies]


_KINDS: tuple[Callable[[Moments], list[sp.Expr]], ...] = (
    lambda body: [body.mass],
    lambda body: list(body.first),
    lambda body: list(body.second),
)
"""Mass, first and second moments of a body: compared among themselves."""


def _body(chain: Chain, j: int, left: dict[str, float]) -> Moments:
    """Body j; what is read is taken out of `left`."""
    names = [q.name for q in letters_of(j)]
    for name in names:
        if name not in left:
            joints = f"the {len(chain.joints)} joints of {chain.name}"
            raise InputError("bodies", problem=f"expected {name} for {joints}")
    return moments_from([exact(left.pop(name), name) for name in names])


def _require_possible(j: int, found: Moments) -> None:
    """Some mass has these moments: [[Sigma, h], [h, m]] is nowhere negative, but for rounding."""
    import numpy as np

    last = found.first.T.row_join(sp.Matrix([[found.mass]]))
    whole = np.array(found.second.row_join(found.first).col_join(last).tolist(), dtype=float)
    scale = np.sqrt(np.maximum(np.diag(whole), np.finfo(float).tiny))
    if whole[3, 3] < 0 or np.linalg.eigvalsh(whole / np.outer(scale, scale))[0] < -_ROUNDED:
        raise InputError("bodies", "moments that a mass can have", "others", why=f"of body {j}")
