"""A chain with the moments of mass that a fit found in place of its bodies."""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp

from eccentric.errors import InputError
from eccentric.model.chain.body import Moments
from eccentric.model.chain.chain import Chain
from eccentric.model.chain.exact import exact

__all__ = ["with_bodies"]

_AXES = "xyz"
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
    bodies = [_body(chain, j, left) for j in range(len(chain.joints))]
    if left:
        raise InputError(f"bodies: {next(iter(left))} is of no body of {chain.name}")
    payload = chain.payload
    if payload is not None:
        letters = {q.symbol: q.default for q in chain.parameters}
        held = payload.moments
        if held.mass.free_symbols | held.first.free_symbols | held.second.free_symbols:
            mass, first, second = (x.xreplace(letters) for x in (held.mass, held.first, held.second))
            bodies[-1] += Moments(-mass, -first, -second)
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


def _body(chain: Chain, j: int, left: dict[str, float]) -> Moments:
    """Body j; what is read is taken out of `left`."""
    names = [f"mass_{j}", *(f"h_{j}_{a}" for a in _AXES)]
    names += [f"Sigma_{j}_{_AXES[i]}{_AXES[k]}" for i in range(3) for k in range(i, 3)]
    for name in names:
        if name not in left:
            joints = f"the {len(chain.joints)} joints of {chain.name}"
            raise InputError(f"bodies: {name} is required for {joints}")
    given = {name: float(left.pop(name)) for name in names}
    second = [[given[f"Sigma_{j}_{_AXES[min(i, k)]}{_AXES[max(i, k)]}"] for k in range(3)] for i in range(3)]
    first = [given[f"h_{j}_{a}"] for a in _AXES]
    _require_possible(j, given[f"mass_{j}"], first, second)
    mass, *rest = (exact(x, f"body {j}") for x in (given[f"mass_{j}"], *first))
    entries = [[exact(x, f"body {j}") for x in row] for row in second]
    return Moments(mass, sp.ImmutableMatrix(rest), sp.ImmutableMatrix(entries))


def _require_possible(j: int, mass: float, first: list[float], second: list[list[float]]) -> None:
    """Some mass has these moments: [[Sigma, h], [h, m]] is nowhere negative, but for rounding."""
    import numpy as np

    whole = np.block(
        [[np.array(second), np.array(first)[:, None]], [np.array(first)[None], np.array([[mass]])]]
    )
    scale = np.sqrt(np.maximum(np.diag(whole), np.finfo(float).tiny))
    if mass < 0 or np.linalg.eigvalsh(whole / np.outer(scale, scale))[0] < -_ROUNDED:
        raise InputError(f"bodies: moments that a mass can have are required of body {j}, received others")
