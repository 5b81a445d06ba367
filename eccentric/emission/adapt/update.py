"""The arithmetic of one row, written out for n coefficients, in the words that C and Python share.

A line is `name = expression`, or a store into the state `s`; constants are in capitals. Both languages
evaluate such an expression in the same order, so that they give the same bits. It is written out, without
loops, since most of the instructions of a small loop are not arithmetic.

The covariance of the coefficients, over the squared noise, is P = U diag(d) U' (Bierman 1977), with U unit
upper triangular: in these factors it cannot lose its sign. With p the row of the regressor, f = U'p and
zeta = p'P p, a row adds eps p p' to the information, eps = lambda - (1 - lambda)/zeta (Kulhavy 1987; Kulhavy
and Karny 1984): it brings its own, and the part 1 - lambda is forgotten in its direction alone. What no row
excites is not forgotten, so that nothing winds up, and zeta tends to (1 - lambda)/lambda. All of it is one
pass of Bierman's with 1/eps in place of the noise, of either sign: the sums b stay between 1 and
lambda (1 + zeta).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import mpmath
import sympy as sp

from eccentric.core import InputError
from eccentric.emission.backends import code, decimal, prepared_values
from eccentric.emission.check import limits
from eccentric.emission.program import Program, Routine
from eccentric.emission.templates import plain
from eccentric.model import Column, Model, spoken, spoken_quantity
from eccentric.model import vocabulary as v


def place(row: int, column: int) -> int:
    """Where U[row, column], row < column, is in the state: column by column."""
    return column * (column - 1) // 2 + row


def loaded(n: int) -> list[str]:
    """The factors of the state as names."""
    triangle = [f"u_{i}_{j} = s.u[{place(i, j)}]" for j in range(n) for i in range(j)]
    return [*triangle, *(f"d_{j} = s.d[{j}]" for j in range(n))]


def innovation(n: int) -> list[str]:
    """The innovation over the noise, z, from the residual of the balance and the row of the regressor.

    The residual is that with the coefficients `own` of the caller; the difference to those of the state is
    put in.
    """
    part = " + ".join(f"column[{j}] * (own[{j}] - s.coefficient[{j}])" for j in range(n))
    return [
        f"innovation = (residual + ({part})) * PER_NOISE",
        *(f"p_{j} = column[{j}] * SCALE_{j}" for j in range(n)),
        *(f"f_{j} = " + " + ".join([*(f"p_{i} * u_{i}_{j}" for i in range(j)), f"p_{j}"]) for j in range(n)),
        *(f"v_{j} = d_{j} * f_{j}" for j in range(n)),
        # A sum of squares: the sign changes nothing, and tells Eva so.
        "squares = " + " + ".join(f"f_{j} * v_{j}" for j in range(n)),
        "zeta = size(squares)",
    ]


def scaled() -> list[str]:
    """The innovation over its standard deviation."""
    return ["root = sqrt(ONE + zeta)", "z = limited(innovation / root, s.limit)"]


def updated(n: int) -> list[str]:
    """The factors and coefficients after the row; `x` are coefficients before their bounds are kept."""
    lines = ["eps = LAMBDA - FORGET / zeta", "w_0 = eps * f_0", "b_0 = at_least(ONE + w_0 * v_0, LEAST_B)"]
    lines += ["r_0 = ONE / b_0", "s.d[0] = at_most(d_0 * r_0, ONE)"]
    for j in range(1, n):
        lines += [
            f"w_{j} = eps * f_{j}",
            f"b_{j} = at_least(b_{j - 1} + w_{j} * v_{j}, LEAST_B)",
            f"r_{j} = ONE / b_{j}",
            f"s.d[{j}] = at_most(d_{j} * (b_{j - 1} * r_{j}), ONE)",
            f"g_{j} = w_{j} * r_{j - 1}",
        ]
        for i in range(j):
            k = _k(i, j - 1)
            lines += [
                f"s.u[{place(i, j)}] = limited(u_{i}_{j} - g_{j} * {k}, MOST_U)",
                f"{_k(i, j)} = {k} + v_{j} * u_{i}_{j}",
            ]
    lines.append("step = z / root")
    return [*lines, *(f"x_{j} = s.coefficient[{j}] + STEP_{j} * step * {_k(j, n - 1)}" for j in range(n))]


def _k(i: int, j: int) -> str:
    """Entry i of P p, with the first j + 1 columns summed; the first summand is v."""
    return f"v_{i}" if i == j else f"k_{i}_{j}"


def known(n: int) -> list[str]:
    """The coefficients over their prior deviations, and the factor of their covariance by the innovations.

    It is their mean square, and (1 + rho)/(1 - rho): by so much the variance of a mean of many is larger if
    each is correlated with the next by rho.
    """
    return [
        *(f"y_{j} = s.coefficient[{j}] / STEP_{j}" for j in range(n)),
        "spread = s.square * (ONE + s.rho) / (ONE - s.rho)",
    ]


def shared(n: int) -> list[str]:
    """The share of the friction that is sure at a `row` of the regressor times prior deviations."""
    return [
        *(
            f"t_{j} = " + " + ".join([*(f"s.u[{place(i, j)}] * row[{i}]" for i in range(j)), f"row[{j}]"])
            for j in range(n)
        ),
        "squares = " + " + ".join(f"s.d[{j}] * (t_{j} * t_{j})" for j in range(n)),
        "friction = " + " + ".join(f"row[{j}] * y_{j}" for j in range(n)),
        "bound = DEVIATIONS * sqrt(spread * size(squares))",
        "share = within((friction - bound) / at_least(friction, LEAST_FRICTION), ZERO, ONE)",
    ]


def kept(n: int) -> list[str]:
    """The coefficients, which are within their bounds."""
    return [f"s.coefficient[{j}] = x_{j}" for j in range(n)]


def in_c(prefix: str, lines: Iterable[str]) -> list[str]:
    """The lines in C, with names of the model's own."""

    def spelled(text: str) -> str:
        text = re.sub(r"\b(within|limited|at_least|at_most)\(", rf"{prefix}_adapt_\1(", text)
        return (
            text.replace("sqrt(", f"{prefix}_adapt_square_root(")
            .replace("size(", "REAL_FABS(")
            .replace("s.", "s->")
        )

    return _lines(
        lines,
        lambda name, value: (
            f"{spelled(name)} = {spelled(value)};"
            if name.startswith("s.")
            else f"const real {name} = {spelled(value)};"
        ),
    )


def in_python(lines: Iterable[str], constants: Iterable[str]) -> list[str]:
    """The lines in Python, with constants as attributes of k."""
    pattern = re.compile(rf"\b({'|'.join(constants)})\b")
    return _lines(
        lines,
        lambda name, value: f"{name} = {pattern.sub(lambda m: f'k.{m[1]}', value)}".replace(
            "sqrt(", "k.sqrt("
        ).replace("size(", "abs("),
    )


def _lines(lines: Iterable[str], spelled: Callable[[str, str], str]) -> list[str]:
    return [spelled(*line.split(" = ", 1)) for line in lines]


# How the coefficients in C follow from those of friction: each is a constant and a sum of products.
#
# `prepare` computes them from all parameters, in double. While only the friction changes, they are linear
# functions of its coefficients; constant and factors are computed here to 50 digits.
_CLOSE = mpmath.mpf(10) ** -30


@dataclass(frozen=True)
class Followed:
    """One coefficient of the C that depends on friction."""

    name: str  # of the coefficient
    constant: str  # decimal, "" if it is 0
    factors: Mapping[int, str]  # column -> decimal, where it is not 0; "1.0" is a copy


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
                    f"model {model.name}: an estimator of its friction",
                    "coefficients linear in those of friction",
                    s.name,
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


STATES = (
    "-eva-domains equality -eva-slevel 20 -eva-slevel-function NAME_project:2000,NAME_variance:100,main:100"
)
"""Options of the proof: loops over coefficients are followed index by index, and nothing else is."""


def bounds(n: int) -> list[tuple[str, str, str]]:
    """The invariant of the state: field, lowest and highest value."""
    return [
        *((f"coefficient[{k}]", f"LOWEST_{k}", f"HIGHEST_{k}") for k in range(n)),
        *((f"d[{k}]", "ZERO", "ONE") for k in range(n)),
        *((f"u[{k}]", "-(MOST_U)", "MOST_U") for k in range(n * (n - 1) // 2)),
        ("before", "-(MOST_LIMIT)", "MOST_LIMIT"),
        ("square", "LEAST_SQUARE", "MOST_SQUARE"),
        ("product", "-(MOST_SQUARE)", "MOST_SQUARE"),
        ("rho", "ZERO", "MOST_RHO"),
        ("sharpness", "LEAST_SHARPNESS", "MOST_SHARPNESS"),
        ("limit", "LEAST_LIMIT", "MOST_LIMIT"),
        ("rate", "RATE", "FIRST_RATE"),
        ("up", "ZERO", "THRESHOLD"),
        ("down", "ZERO", "THRESHOLD"),
    ]


def within(n: int) -> str:
    """The condition in C that the coefficients are within their bounds."""
    return " && ".join(f"(x_{k} >= LOWEST_{k}) && (x_{k} <= HIGHEST_{k})" for k in range(n))


NEEDED = ("mechanical_residual", "regressor", "friction_coefficients")
"""The functions of the model that it calls."""


def ranged_inputs(model: Model, routines: Mapping[str, Routine]) -> list[dict[str, Any]]:
    """The motion, the current, and whatever else the balance depends on."""
    found = {
        x.quantity.name: x.quantity for name in NEEDED for x in routines[name].inputs if x.length is None
    }
    first = [spoken_quantity(model.axis, q).name for q in (v.theta_m, v.omega_m, v.alpha_m, v.i)]
    known = {q.name: q for q in spoken(model).inputs}
    ordered = [*(x for x in first if x in known), *(x for x in found if x not in first)]
    quantities = [found.get(x) or known[x] for x in ordered]
    return [
        {
            "name": q.name,
            "doc": plain(f"{q.meaning} [{q.unit}]"),
            "low": limits(q, model.axis)[0],
            "high": limits(q, model.axis)[1],
        }
        for q in quantities
    ]


def inside(inputs: list[dict[str, Any]]) -> str:
    """The condition in C that the inputs are within their ranges; NaN is not."""
    names = [x["name"] for x in inputs]
    return " && ".join(f"({name} >= LEAST_{name}) && ({name} <= MOST_{name})" for name in names)
