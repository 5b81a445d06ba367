"""The inertial regressor of a chain: torque of every motor per inertial parameter that a motion can show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp
from sympy.printing.numpy import NumPyPrinter

from eccentric.model.chain.chain import Chain
from eccentric.model.chain.letters import with_letters
from eccentric.model.chain.recursion import Recursion, recursion
from eccentric.model.output import Assignment, needed
from eccentric.model.quantity import Quantity

# The torques are linear in the moments of mass of every body and in the inertia of every rotor. Their
# slopes are taken from the recursion itself, from each torque outwards (reverse mode): what a force or
# moment further out adds to the torque is computed once and serves all parameters of that body.
#
# Some parameters never show, others only in sums. Which, is found on random motions: a column that those
# before it span is left out, and its parameter is counted by them (base parameters; M. Gautier, "Numerical
# calculation of the base inertial parameters of robots", J. Robotic Systems 8(4), 1991).


_MOTIONS = 8
"""Random motions per parameter: enough for full rank with margin."""
_SPANNED = 1e-9
"""Part of a column, by its norm, below which those before it span it: rounding leaves some 1e-14."""
_COUNTED = 1e-9
"""Factor of a parameter in a sum, by the size of its column, below which it is not counted."""


@dataclass(frozen=True)
class Inertial:
    """The inertial regressor of a chain.

    Attributes:
        parameters: those of the columns, in order.
        sums: of each column, parameter -> factor: what the column's coefficient is the sum of.
        slopes: torque of motor j per parameter, [j][k].
        definitions: what the slopes are computed from.
    """

    parameters: tuple[Quantity, ...]
    sums: tuple[Mapping[str, float], ...]
    slopes: tuple[tuple[sp.Expr, ...], ...]
    definitions: tuple[Assignment, ...]

    @cached_property
    def words(self) -> tuple[str, ...]:
        """The sums as a person writes them."""
        return tuple(_in_words(one) for one in self.sums)


def inertial(chain: Chain) -> Inertial:
    """The inertial regressor of a chain: base parameters only."""
    lettered = with_letters(chain, chain.name, rotors=True)
    quantities = lettered.parameters[len(chain.parameters) :]
    found = recursion(lettered)
    definitions, slopes = _slopes(found, [q.symbol for q in quantities])
    values = _evaluated(found, definitions, slopes, chain)
    kept, sums = _base(values, [q.name for q in quantities])
    rows = tuple(tuple(row[k] for k in kept) for row in slopes)
    used = needed(definitions, [e for row in rows for e in row])
    return Inertial(tuple(quantities[k] for k in kept), sums, rows, used)


def _slopes(
    found: Recursion, by: Sequence[sp.Symbol]
) -> tuple[list[Assignment], tuple[tuple[sp.Expr, ...], ...]]:
    """The recursion and, behind it, what each force adds to each torque; the slopes of all torques."""
    moving = [Assignment(d.symbol, d.value) for d in found.definitions]
    # What depends on the parameters: only there slopes are carried on.
    follows = set(by)
    for assignment in moving:
        if assignment.value.free_symbols & follows:
            follows.add(assignment.target)
    added: list[Assignment] = []
    rows = []
    torques = [
        rotor + joint.mu * torque
        for joint, rotor, torque in zip(found.chain.joints, found.rotors, found.torques, strict=True)
    ]
    for j, torque in enumerate(torques):
        carried: dict[sp.Symbol, list[sp.Expr]] = {}
        _carry(carried, torque, sp.Integer(1), follows)
        for assignment in reversed(moving):
            if assignment.target not in carried:
                continue
            factor = sp.Add(*carried.pop(assignment.target))
            if not (factor.is_Atom or (-factor).is_Symbol):
                symbol = sp.Symbol(f"of_{assignment.target.name}_{j}", real=True)
                added.append(Assignment(symbol, factor))
                factor = symbol
            if factor != 0:
                _carry(carried, assignment.value, factor, follows)
        rows.append(tuple(sp.Add(*carried.get(x, [])) for x in by))
    return [*moving, *added], tuple(rows)


def _carry(
    carried: dict[sp.Symbol, list[sp.Expr]], value: sp.Expr, factor: sp.Expr, follows: set[sp.Symbol]
) -> None:
    for symbol in sorted(value.free_symbols & follows, key=str):
        carried.setdefault(symbol, []).append(factor * value.diff(symbol))


def _evaluated(
    found: Recursion,
    definitions: Sequence[Assignment],
    slopes: Sequence[Sequence[sp.Expr]],
    chain: Chain,
) -> np.ndarray:
    """The regressor on random motions and letters of the chain, shape (motions x joints, parameters)."""
    rng, printer = np.random.default_rng(0), NumPyPrinter({"fully_qualified_modules": False})
    motions = _MOTIONS * len(slopes[0])
    known: dict[str, Any] = {q.symbol.name: rng.uniform(0.5, 1.5) for q in chain.parameters}
    for joint, inputs in zip(chain.joints, found.inputs, strict=True):
        gear = float(joint.mu) if joint.mu.is_number else 1.0
        for x in (inputs.theta_m, inputs.omega_m, inputs.alpha_m):
            known[x.symbol.name] = rng.normal(size=motions) * 3.0 / gear
    used = needed(definitions, [e for row in slopes for e in row])
    lines = [f"{a.target} = {printer.doprint(a.value)}" for a in used]
    rows = ", ".join(f"[{', '.join(map(printer.doprint, row))}]" for row in slopes)
    lines.append(f"found = [{rows}]")
    exec("\n".join(lines), dict(vars(np)), known)  # noqa: S102 - printed from expressions, not from text
    columns = [[np.broadcast_to(x, motions) for x in row] for row in known["found"]]
    return np.array(columns, dtype=float).transpose(2, 0, 1).reshape(-1, len(slopes[0]))


def _base(values: np.ndarray, names: Sequence[str]) -> tuple[list[int], tuple[Mapping[str, float], ...]]:
    """The columns that those before them do not span, and which parameters each of them counts."""
    from scipy.linalg import qr  # importing it takes long, and nothing else of a model needs it

    sizes = np.linalg.norm(values, axis=0)
    shown = [k for k in range(len(names)) if sizes[k] > 0.0]
    scaled = values[:, shown] / sizes[shown]
    diagonal = np.abs(np.diag(qr(scaled, mode="r")[0]))
    is_kept = diagonal > _SPANNED
    kept, spanned = np.flatnonzero(is_kept), np.flatnonzero(~is_kept)
    factors = np.linalg.lstsq(scaled[:, kept], scaled[:, spanned], rcond=None)[0]
    sums = []
    for row, k in enumerate(kept):
        one = {names[shown[k]]: 1.0}
        for column, other in enumerate(spanned):
            if abs(factors[row, column]) > _COUNTED:
                one[names[shown[other]]] = float(factors[row, column] * sizes[shown[other]] / sizes[shown[k]])
        sums.append(one)
    return [shown[k] for k in kept], tuple(sums)


def _in_words(one: Mapping[str, float]) -> str:
    """mass_1 + 0.4 h_2_x - mass_3"""
    text = ""
    for name, factor in one.items():
        size = f"{abs(factor):.6g}"
        text += (" - " if factor < 0 else " + ") + (name if size == "1" else f"{size} {name}")
    return text.removeprefix(" + ")
