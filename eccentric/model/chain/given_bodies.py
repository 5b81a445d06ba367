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


def with_bodies(chain: Chain, values: Mapping[str, float]) -> Chain:
    """The same chain with other bodies, the payload part of the last one.

    Args:
        chain: joints, gravity, and the parameters that they need.
        values: mass_0 [kg], h_0_x to h_0_z [kg m], Sigma_0_xx to Sigma_0_zz [kg m^2] of every body, in the
            frame of its joint: the inertial parameters of the emitted `inertial_regressor`.

    Raises:
        InputError: one is missing.
    """
    bodies = []
    for j in range(len(chain.joints)):

        def value(name: str, j: int = j) -> sp.Expr:
            key = name.format(j)
            if key not in values:
                joints = f"the {len(chain.joints)} joints of {chain.name}"
                raise InputError(f"bodies: {key} is required for {joints}")
            return exact(values[key], key)

        second = sp.ImmutableMatrix(
            3, 3, lambda i, k, of=value: of(f"Sigma_{{}}_{_AXES[min(i, k)]}{_AXES[max(i, k)]}")
        )
        first = sp.ImmutableMatrix([value(f"h_{{}}_{axis}") for axis in _AXES])
        bodies.append(Moments(value("mass_{}"), first, second))
    left = [chain.gravity]
    for joint in chain.joints:
        left += [joint.mu, joint.J_m, joint.bearing, joint.placement.position, joint.placement.rotation]
    needed = set().union(*(x.free_symbols for x in left))
    kept = [q for q in chain.parameters if q.symbol in needed]
    return Chain(chain.name, chain.joints, bodies, chain.gravity, None, kept)
