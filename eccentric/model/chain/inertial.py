"""Inertial parameters of a chain: their symbols, bodies from values, and the regressor of base parameters."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp
from sympy.printing.numpy import NumPyPrinter

from eccentric.core import InputError
from eccentric.model.chain.chain import Chain
from eccentric.model.chain.links import Moments, exact
from eccentric.model.chain.motion import AXES
from eccentric.model.chain.recursion import Recursion, recursion
from eccentric.model.output import Assignment, needed
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
    return quantity(f"J_m_{j}", "kg m^2", f"inertia of rotor {j}")


def moments_from(x: Sequence[sp.Expr]) -> Moments:
    """The moments of mass of a body from its ten inertial parameters, in the order of `letters_of`."""
    entries = dict(zip(_UPPER, x[4:], strict=True))
    second = [[entries[min(i, k), max(i, k)] for k in range(3)] for i in range(3)]
    return Moments(x[0], sp.ImmutableMatrix(x[1:4]), sp.ImmutableMatrix(second))


def with_letters(chain: Chain, name: str, *, rotors: bool = False) -> Chain:
    """The chain with symbolic bodies, the payload part of the last one; existing symbols are retained.

    Args:
        chain: the chain.
        name: of the result.
        rotors: whether rotor inertias become symbols as well.
    """
    joints, letters = list(chain.joints), []
    bodies = []
    for j, joint in enumerate(chain.joints):
        parameters = letters_of(j)
        letters += parameters
        bodies.append(moments_from([q.symbol for q in parameters]))
        if rotors:
            joints[j] = copy.copy(joint)
            joints[j].J_m = _rotor_letter(j).symbol
    letters += [_rotor_letter(j) for j in range(len(joints))] if rotors else []
    return Chain(name, joints, bodies, chain.gravity, None, (*chain.parameters, *letters))


_NOTHING = 1e-12
"""Relative size, by the largest of its kind on the arm, below which a value is a rounded zero."""
_ROUNDED = 1e-6
"""Relative negative eigenvalue that six-digit rounding may cause."""


def with_bodies(chain: Chain, values: Mapping[str, float]) -> Chain:
    """The chain with other bodies.

    A payload with symbols is retained: the last body is then the values minus its defaults. Any other payload
    becomes part of the last body.

    Args:
        chain: joints, gravity, payload, and the parameters that they need.
        values: mass_0 [kg], h_0_x to h_0_z [kg m], Sigma_0_xx to Sigma_0_zz [kg m^2] of every body, payload
            included, in the frame of its joint: the inertial parameters of the emitted `inertial_regressor`.

    Raises:
        InputError: a value is missing or superfluous, or a body is impossible: its mass is negative, or no
            mass distribution has its moments.
    """
    unused = dict(values)
    bodies = _without_rounding([_body(chain, j, unused) for j in range(len(chain.joints))])
    if unused:
        raise InputError("bodies", problem=f"{next(iter(unused))} is of no body of {chain.name}")
    for j, body in enumerate(bodies):
        _require_possible(j, body)
    payload = chain.payload
    if payload is not None:
        letters = {q.symbol: q.default for q in chain.parameters}
        parts = (payload.moments.mass, payload.moments.first, payload.moments.second)
        if any(x.free_symbols for x in parts):
            mass, first, second = (x.xreplace(letters) for x in parts)
            bodies[-1] += Moments(-mass, -first, -second)
            bodies = _without_rounding(bodies)
        else:
            payload = None
    used = [chain.gravity]
    for joint in chain.joints:
        used += [joint.mu, joint.J_m, joint.bearing, joint.placement.position, joint.placement.rotation]
    if payload is not None:
        used += [payload.mass, payload.centre, payload.inertia]
    needed = set().union(*(x.free_symbols for x in used))
    parameters = [q for q in chain.parameters if q.symbol in needed]
    return Chain(chain.name, chain.joints, bodies, chain.gravity, payload, parameters)


def _without_rounding(bodies: Sequence[Moments]) -> list[Moments]:
    """The bodies with rounded zeros made exact, so that products with them fold away."""
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
"""Mass, first and second moments of a body, each compared with its kind."""


def _body(chain: Chain, j: int, values: dict[str, float]) -> Moments:
    """Body j; its entries are removed from `values`."""
    names = [q.name for q in letters_of(j)]
    for name in names:
        if name not in values:
            joints = f"the {len(chain.joints)} joints of {chain.name}"
            raise InputError("bodies", problem=f"expected {name} for {joints}")
    return moments_from([exact(values.pop(name), name) for name in names])


def _require_possible(j: int, moments: Moments) -> None:
    """Require a positive semidefinite pseudo-inertia [[Sigma, h], [h, m]], up to rounding."""
    last = moments.first.T.row_join(sp.Matrix([[moments.mass]]))
    matrix = np.array(moments.second.row_join(moments.first).col_join(last).tolist(), dtype=float)
    scale = np.sqrt(np.maximum(np.diag(matrix), np.finfo(float).tiny))
    if matrix[3, 3] < 0 or np.linalg.eigvalsh(matrix / np.outer(scale, scale))[0] < -_ROUNDED:
        raise InputError("bodies", "moments that a mass can have", "others", why=f"of body {j}")


# The inertial regressor: torque of every motor per base parameter.
#
# The torques are linear in the moments of mass of every body and the inertia of every rotor. Their
# derivatives are taken from the recursion in reverse mode, from each torque outwards: the factor of a force
# or moment further out is computed once and used for all parameters of that body.
#
# Some parameters have no influence, others only in linear combinations. These are determined numerically on
# random motions: a column spanned by earlier ones is omitted, and its parameter added to theirs (base
# parameters; M. Gautier, "Numerical calculation of the base inertial parameters of robots", J. Robotic
# Systems 8(4), 1991).
_MOTIONS = 8
"""Random motions per parameter: enough for full rank with margin."""
_SPANNED = 1e-9
"""Relative residual below which earlier columns span a column: rounding leaves about 1e-14."""
_COUNTED = 1e-9
"""Factor of a parameter in a sum, relative to its column, below which it is omitted."""


@dataclass(frozen=True)
class Inertial:
    """The inertial regressor of a chain."""

    parameters: tuple[Quantity, ...]  # those of the columns, in order
    # of each column, parameter -> factor: the linear combination that is its coefficient
    sums: tuple[Mapping[str, float], ...]
    slopes: tuple[tuple[sp.Expr, ...], ...]  # torque of motor j per parameter, [j][k]
    definitions: tuple[Assignment, ...]  # intermediate assignments of the slopes

    @cached_property
    def words(self) -> tuple[str, ...]:
        """The sums as text."""
        return tuple(_in_words(one) for one in self.sums)


def inertial(chain: Chain) -> Inertial:
    """The inertial regressor of a chain: base parameters only."""
    lettered = with_letters(chain, chain.name, rotors=True)
    quantities = lettered.parameters[len(chain.parameters) :]
    lettered_recursion = recursion(lettered)
    definitions, slopes = _slopes(lettered_recursion, [q.symbol for q in quantities])
    values = _evaluated(lettered_recursion, definitions, slopes, chain)
    columns, sums = _base(values, [q.name for q in quantities])
    rows = tuple(tuple(row[k] for k in columns) for row in slopes)
    used = needed(definitions, [e for row in rows for e in row])
    return Inertial(tuple(quantities[k] for k in columns), sums, rows, used)


def _slopes(
    chain_recursion: Recursion, by: Sequence[sp.Symbol]
) -> tuple[list[Assignment], tuple[tuple[sp.Expr, ...], ...]]:
    """The recursion followed by the derivatives of each torque by each force; the slopes of all torques."""
    moving = [Assignment(d.symbol, d.value) for d in chain_recursion.definitions]
    # Derivatives are propagated only through values that depend on the parameters.
    follows = set(by)
    for assignment in moving:
        if assignment.value.free_symbols & follows:
            follows.add(assignment.target)
    added: list[Assignment] = []
    rows = []
    for j, torque in enumerate(chain_recursion.motor_torques):
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
    found: Recursion, definitions: Sequence[Assignment], slopes: Sequence[Sequence[sp.Expr]], chain: Chain
) -> np.ndarray:
    """The regressor on random motions and parameters of the chain, shape (motions x joints, parameters)."""
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
    lines.append(f"regressor = [{rows}]")
    exec("\n".join(lines), dict(vars(np)), known)  # noqa: S102 - printed from expressions, not from text
    columns = [[np.broadcast_to(x, motions) for x in row] for row in known["regressor"]]
    return np.array(columns, dtype=float).transpose(2, 0, 1).reshape(-1, len(slopes[0]))


def _base(values: np.ndarray, names: Sequence[str]) -> tuple[list[int], tuple[Mapping[str, float], ...]]:
    """The columns not spanned by earlier ones, and the parameters combined in each of them."""
    from scipy.linalg import qr  # slow to import, and nothing else of a model needs it

    sizes = np.linalg.norm(values, axis=0)
    shown = [k for k in range(len(names)) if sizes[k] > 0.0]
    scaled = values[:, shown] / sizes[shown]
    diagonal = np.abs(np.diag(qr(scaled, mode="r")[0]))
    is_independent = diagonal > _SPANNED
    independent, spanned = np.flatnonzero(is_independent), np.flatnonzero(~is_independent)
    factors = np.linalg.lstsq(scaled[:, independent], scaled[:, spanned], rcond=None)[0]
    sums = []
    for row, k in enumerate(independent):
        column_sum = {names[shown[k]]: 1.0}
        for column, other in enumerate(spanned):
            if abs(factors[row, column]) > _COUNTED:
                column_sum[names[shown[other]]] = float(
                    factors[row, column] * sizes[shown[other]] / sizes[shown[k]]
                )
        sums.append(column_sum)
    return [shown[k] for k in independent], tuple(sums)


def _in_words(one: Mapping[str, float]) -> str:
    """Text such as mass_1 + 0.4 h_2_x - mass_3."""
    text = ""
    for name, factor in one.items():
        size = f"{abs(factor):.6g}"
        text += (" - " if factor < 0 else " + ") + (name if size == "1" else f"{size} {name}")
    return text.removeprefix(" + ")
