"""What tells one arm from another: gravity, and of every joint its name, place, gear and rotor."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from eccentric.model.chain.chain import Chain
from eccentric.model.chain.joint import Joint
from eccentric.model.chain.numbers import with_numbers

__all__ = ["identity_of", "unlike"]

_ALIKE = 1e-9
"""Numbers of one arm are the same, but for their last digits in a file."""


def identity_of(chain: Chain) -> dict[str, Any]:
    """The arm in plain numbers, SI; without its bodies, which a fit may replace and a payload changes."""
    own = with_numbers(chain)
    return {"gravity": _plain(own.gravity), "joints": [_of_joint(joint) for joint in own.joints]}


def unlike(chain: Chain, given: Mapping[str, Any]) -> str:
    """In what a chain differs from that of an identity, in words; "" if in nothing.

    Args:
        chain: the chain.
        given: as `identity_of` returns it, possibly from a file.
    """
    own, joints = identity_of(chain), given.get("joints")
    names, others = ([x.get("name") for x in table] for table in (own["joints"], joints or []))
    if names != others:
        return f"it has the joints {', '.join(map(str, others)) or 'none'}, not {', '.join(map(str, names))}"
    for here, there in zip(own["joints"], joints or [], strict=True):
        for key, value in here.items():
            if not _same(value, there.get(key)):
                return f"{key} of {here['name']} is {_shown(there.get(key))}, not {_shown(value)}"
    if not _same(own["gravity"], given.get("gravity")):
        return f"gravity is {_shown(given.get('gravity'))}, not {_shown(own['gravity'])}"
    return ""


def _of_joint(joint: Joint) -> dict[str, Any]:
    return {
        "name": joint.name,
        "kind": joint.kind,
        "mu": float(joint.mu),
        "J_m": float(joint.J_m),
        "axis": _plain(joint.axis),
        "position": _plain(joint.placement.position),
        "rotation": _plain(joint.placement.rotation),
        "bearing": float(joint.bearing),
    }


def _plain(matrix: Any) -> list[float]:
    return [float(x) for x in matrix]


def _same(left: object, right: object) -> bool:
    if isinstance(left, list) and isinstance(right, list):
        return len(left) == len(right) and all(map(_same, left, right))
    if isinstance(left, float) and isinstance(right, int | float):
        return math.isclose(left, right, rel_tol=_ALIKE, abs_tol=_ALIKE)
    return left == right


def _shown(value: object) -> str:
    if isinstance(value, list):
        return f"({', '.join(map(_shown, value))})"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
