"""Arms for the tests: random chains, and the numbers of a recursion's definitions."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import sympy as sp

from eccentric.model import Body, Chain, Definition, Joint, Placement

FUNCTIONS = {
    "Magnitude": math.hypot, "Abs": abs, "sin": math.sin, "cos": math.cos, "Sgn": np.sign, "sqrt": math.sqrt,
}  # fmt: skip


def evaluated(
    definitions: Sequence[Definition],
    values: Mapping[sp.Symbol, Any],
    functions: Mapping[str, Any] = FUNCTIONS,
) -> dict[sp.Symbol, Any]:
    """Every definition in turn, in the arithmetic of the values."""
    known: dict[str, Any] = {symbol.name: value for symbol, value in values.items()}
    lines = "\n".join(f"{d.quantity.name} = {sp.sstr(d.value)}" for d in definitions)
    exec(compile(lines, "definitions", "exec"), dict(functions), known)  # noqa: S102 - printed by SymPy
    return {d.symbol: known[d.quantity.name] for d in definitions} | dict(values)


def behind(definitions: Sequence[Definition], results: Iterable[sp.Expr]) -> list[Definition]:
    """The definitions that the results depend on, in order."""
    wanted, kept = set().union(*(r.free_symbols for r in results)), []
    for definition in reversed(definitions):
        if definition.symbol in wanted:
            wanted |= definition.value.free_symbols
            kept.append(definition)
    return kept[::-1]


def number(expression: sp.Expr, values: Mapping[sp.Symbol, Any]) -> float:
    """The number that an expression in these symbols is."""
    return float(
        expression.xreplace(
            {symbol: sp.Float(float(values[symbol]), 17) for symbol in expression.free_symbols}
        )
    )


def random_inertia(rng: np.random.Generator) -> np.ndarray:
    """The inertia of five mass points: that of a body that can exist."""
    points = rng.normal(size=(5, 3)) * 0.2
    masses = rng.uniform(0.1, 1, 5)
    each = [m * (np.dot(p, p) * np.eye(3) - np.outer(p, p)) for p, m in zip(points, masses, strict=True)]
    return np.sum(each, axis=0)


def symmetric(inertia: np.ndarray) -> list[list[float]]:
    """The tensor with its upper triangle mirrored, exactly symmetric."""
    upper = np.triu(inertia)
    return (upper + np.triu(inertia, 1).T).tolist()


def random_chain(
    rng: np.random.Generator,
    n: int,
    *,
    aligned: bool = False,
    sliding: float = 0.3,
    geared: bool = False,
    rotors: bool = False,
) -> Chain:
    """A chain of n joints with random axes, placements, bodies, and gravity in any direction.

    Aligned: axes and frames at right angles, as most arms have them. Geared: with gear ratios, and bearings
    beside the origins of the frames.
    """
    joints, bodies = [], []
    for j in range(n):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        if aligned or rng.uniform() < 0.5:
            axis = np.eye(3)[rng.integers(3)] * rng.choice([-1, 1])
        turn = rng.choice([0.0, np.pi / 2, -np.pi / 2, np.pi], 3) if aligned else rng.uniform(-3, 3, 3)
        drive = {"mu": rng.uniform(0.05, 1), "bearing": rng.normal() * 0.1} if geared else {}
        drive |= {"J_m": rng.uniform(0.001, 0.1)} if rotors else {}
        joints.append(
            Joint(
                "prismatic" if rng.uniform() < sliding else "revolute",
                axis,
                Placement.turned(rng.normal(size=3) * 0.3, float(turn[0]), float(turn[1]), float(turn[2])),
                name=f"joint {j}",
                **drive,
            )
        )
        bodies.append(
            Body(rng.uniform(0.5, 5), rng.normal(size=3) * 0.1, symmetric(random_inertia(rng)), f"body {j}")
        )
    return Chain("arm", joints, bodies, rng.normal(size=3) * 6)


def bodies_of(chain: Chain) -> list[Body]:
    """The bodies of a chain that has no moments of mass in their place."""
    return [body for body in chain.bodies if isinstance(body, Body)]
