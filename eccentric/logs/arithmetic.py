"""Arithmetic on the columns of a log: `pwm_counts / 885 * supply_V`, `torque_enable == 1 and speed > 0`.

Python's own parser reads the text; the nodes on a whitelist are evaluated with NumPy here. Nothing is run as
code: there are no calls, attributes, indices or powers, and length and depth are bounded. A column whose
name is not a plain word is put in backticks: `` `speed (rpm)` / 60 ``.
"""

from __future__ import annotations

import ast
import functools
import math
import re
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError
from eccentric.logs import limits

if TYPE_CHECKING:
    from collections.abc import Callable


Value = NDArray[Any] | float

_ARITHMETIC: dict[type[ast.AST], Callable[[Value, Value], NDArray[Any]]] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.true_divide,
}
_COMPARISON: dict[type[ast.AST], Callable[[Value, Value], NDArray[Any]]] = {
    ast.Lt: np.less,
    ast.LtE: np.less_equal,
    ast.Gt: np.greater,
    ast.GtE: np.greater_equal,
    ast.Eq: np.equal,
    ast.NotEq: np.not_equal,
}
_ALLOWED = "+ - * / ( ), numbers, column names, comparisons, and, or, not"


def column_names(text: str, where: str) -> list[str]:
    """The columns that an expression names. InputError for what is not on the whitelist."""
    names: dict[str, None] = {}

    def column(name: str) -> NDArray[np.float64]:
        names[name] = None
        return np.ones(1)

    evaluate(text, column, where, constant=True)
    return list(names)


def evaluate(
    text: str, column: Callable[[str], NDArray[np.float64]], where: str, *, constant: bool = False
) -> NDArray[Any]:
    """Return the value of an arithmetic expression on columns: float64 (n,), or bool (n,) for a condition.

    `column` returns the numbers of a named column and raises InputError for a name that is not in the log.
    `where` opens the error message. A division by zero gives inf or NaN, later counted as missing.
    Raises InputError for anything that is not on the whitelist, and for an expression without a column,
    unless it may be `constant`.
    """
    tree, quoted = _parse(text, where)

    def value(node: ast.AST, depth: int) -> Value:
        if depth > limits.DEEPEST_ARITHMETIC:
            raise InputError(where, problem=f"{text!r} is nested deeper than {limits.DEEPEST_ARITHMETIC}")
        match node:
            case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
                return _finite(number, text, where)
            case ast.Name(id=name):
                return column(quoted.get(name, name))
            case ast.UnaryOp(op=ast.USub() | ast.UAdd() as op, operand=operand):
                inner = number_of(operand, depth)
                return -inner if isinstance(op, ast.USub) else inner
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                return np.logical_not(condition_of(operand, depth))
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _ARITHMETIC:
                return _ARITHMETIC[type(op)](number_of(left, depth), number_of(right, depth))
            case ast.Compare(left=left, ops=ops, comparators=others) if all(
                type(op) in _COMPARISON for op in ops
            ):
                sides = [number_of(side, depth) for side in (left, *others)]
                pairs = zip(ops, sides, sides[1:], strict=False)
                return functools.reduce(np.logical_and, [_COMPARISON[type(op)](a, b) for op, a, b in pairs])
            case ast.BoolOp(op=op, values=values):
                both = np.logical_and if isinstance(op, ast.And) else np.logical_or
                return functools.reduce(both, [condition_of(side, depth) for side in values])
        part = ast.unparse(node)
        raise InputError(where, problem=f"{part!r} in {text!r} is not allowed; required: {_ALLOWED}")

    def number_of(node: ast.AST, depth: int) -> Value:
        inner = value(node, depth + 1)
        if np.asarray(inner).dtype == bool:
            raise InputError(where, "a number", f"the condition {ast.unparse(node)!r}")
        return inner

    def condition_of(node: ast.AST, depth: int) -> Value:
        inner = value(node, depth + 1)
        if np.asarray(inner).dtype != bool:
            raise InputError(where, "a condition", f"the number {ast.unparse(node)!r}")
        return inner

    with np.errstate(all="ignore"):
        result = np.asarray(value(tree, 0))
    if result.ndim == 0 and not constant:
        raise InputError(where, problem=f"{text!r} names no column")
    return result


@functools.lru_cache(maxsize=64)
def _parse(text: str, where: str) -> tuple[ast.AST, dict[str, str]]:
    """Return the syntax tree, and for each placeholder the column name that was in backticks."""
    if len(text) > limits.LONGEST_ARITHMETIC:
        raise InputError(where, f"arithmetic of at most {limits.LONGEST_ARITHMETIC} characters", len(text))
    quoted: dict[str, str] = {}

    def placeholder(match: re.Match[str]) -> str:
        name = f"__column{len(quoted)}"
        quoted[name] = match[1]
        return f" {name} "

    plain = re.sub(r"`([^`]+)`", placeholder, text).strip()
    try:
        return ast.parse(plain, mode="eval").body, quoted
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        raise InputError(
            where, problem=f"{text!r} is neither a column of the log nor arithmetic of {_ALLOWED}"
        ) from None


def _finite(number: float, text: str, where: str) -> float:
    try:
        converted = float(number)
    except OverflowError:
        converted = math.inf
    if not math.isfinite(converted):
        raise InputError(where, problem=f"expected a finite number in {text!r}")
    return converted
