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
from collections.abc import Callable, Iterable


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
