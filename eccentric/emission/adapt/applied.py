"""How the coefficients in C follow from those of friction: each is a constant and a sum of products.

`prepare` computes them from all parameters, in double. While only the friction changes, they are linear
functions of its coefficients; constant and factors are computed here to 50 digits.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import mpmath
import sympy as sp

from eccentric.emission.backends import code, decimal, prepared_values
from eccentric.emission.program import Program
from eccentric.errors import InputError
from eccentric.model import Column, Model

_CLOSE = mpmath.mpf(10) ** -30


@dataclass(frozen=True)
class Followed:
    """One coefficient of the C that depends on friction.

    Attributes:
        name: of the coefficient.
        constant: decimal, "" if it is 0.
        factors: column -> decimal, where it is not 0; "1.0" is a copy.
    """

    name: str
    constant: str
    factors: Mapping[int, str]


def followed(model: Model, program: Program, columns: Sequence[Column], single: bool) -> list[Followed]:
    """The coefficients of the C that depend on friction, in its order.

    Raises:
        InputError: one of them is not linear in the coefficients of friction.
    """
    friction = {q.symbol for q in model.friction_parameters}
    letters = [column.parameter.symbol for column in columns]

    def at(values: Mapping[sp.Symbol, sp.Expr]) -> dict[sp.Symbol, mpmath.mpf]:
        own = tuple(
            replace(q, default=values.get(q.symbol, sp.Integer(0)) if q.symbol in friction else q.default)
            for q in program.parameters
        )
        return prepared_values(replace(program, parameters=own), single)

    with mpmath.workdps(50):
        none = at({})
        each = [at({letter: sp.Integer(1)}) for letter in letters]
        probe = {letter: sp.Rational(k + 3, 7) for k, letter in enumerate(letters)}
        probed = at(probe)
        found = []
        for s in program.held(single=single):
            slopes = [one[s] - none[s] for one in each]
            if all(slope == 0 for slope in slopes):
                continue
            linear = none[s] + mpmath.fsum(
                slope * mpmath.mpf(probe[x].p) / probe[x].q for slope, x in zip(slopes, letters, strict=True)
            )
            if not abs(linear - probed[s]) <= _CLOSE * max(abs(linear), abs(probed[s])):
                raise InputError(
                    f"model {model.name}: an estimator of its friction: coefficients linear in those of"
                    f" friction are required, received {s.name}"
                )
            found.append(
                Followed(
                    s.name,
                    "" if none[s] == 0 else decimal(none[s], single),
                    {k: decimal(slope, single) for k, slope in enumerate(slopes) if slope != 0},
                )
            )
        return found


def applied_lines(model: Model, program: Program, columns: tuple[Column, ...], single: bool) -> list[str]:
    """The lines of C that write what was learned into the coefficients."""
    suffix = "f" if single else ""
    lines = []
    for one in followed(model, program, columns, single):
        terms = [
            f"state->coefficient[{k}]" if x == "1.0" else f"{x}{suffix} * state->coefficient[{k}]"
            for k, x in one.factors.items()
        ]
        lines.append(
            f"c->{one.name} = {' + '.join([*terms, *([one.constant + suffix] if one.constant else [])])};"
        )
    return code(lines)
