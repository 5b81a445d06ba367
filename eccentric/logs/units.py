"""Units that users write, as factors to SI: `rpm`, `V s/rev`, `mNm/A`, `g cm^2`, `counts`, ...

A unit is a product of names from one table, with powers, `/` and parentheses.
Angles have no dimension (rad = 1), so `V s/rad` and `N m/A` have the same dimension, as in SI.
Hertz is left out on purpose: it is 2 pi rad/s for a speed of rotation and 1/s for everything else.
"""

from __future__ import annotations

import ast
import difflib
import functools
import math
import re
import unicodedata
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError
from eccentric.logs import limits

if TYPE_CHECKING:
    from collections.abc import Iterable


Dimension = tuple[int, int, int, int, int]
"""Powers of metre, kilogram, second, ampere, kelvin."""

Number = TypeVar("Number", float, NDArray[np.float64])

_TURN = 2.0 * math.pi
_ONE: Dimension = (0, 0, 0, 0, 0)
_NEWTON: Dimension = (1, 1, -2, 0, 0)
_TORQUE: Dimension = (2, 1, -2, 0, 0)
_INERTIA: Dimension = (2, 1, 0, 0, 0)
_VOLT: Dimension = (2, 1, -3, -1, 0)
_VOLT_SECOND: Dimension = (2, 1, -2, -1, 0)
_OHM: Dimension = (2, 1, -3, -2, 0)
_PER_SECOND: Dimension = (0, 0, -1, 0, 0)
_KELVIN: Dimension = (0, 0, 0, 0, 1)

_PREFIXES = {"": 1.0, "k": 1e3, "c": 1e-2, "m": 1e-3, "u": 1e-6, "µ": 1e-6, "μ": 1e-6}
_PREFIXED: dict[str, tuple[float, Dimension]] = {
    "m": (1.0, (1, 0, 0, 0, 0)),
    "g": (1e-3, (0, 1, 0, 0, 0)),
    "s": (1.0, (0, 0, 1, 0, 0)),
    "A": (1.0, (0, 0, 0, 1, 0)),
    "V": (1.0, _VOLT),
    "Vs": (1.0, _VOLT_SECOND),
    "N": (1.0, _NEWTON),
    "Nm": (1.0, _TORQUE),
    "ohm": (1.0, _OHM),
    "Ohm": (1.0, _OHM),
    "Ω": (1.0, _OHM),
    "rad": (1.0, _ONE),
    "rpm": (_TURN / 60.0, _PER_SECOND),
}
_PLAIN: dict[str, tuple[float, Dimension]] = {
    "1": (1.0, _ONE),
    "%": (0.01, _ONE),
    **dict.fromkeys(("deg", "°", "degree", "degrees"), (_TURN / 360.0, _ONE)),
    "rev": (_TURN, _ONE),
    "turn": (_TURN, _ONE),
    "min": (60.0, (0, 0, 1, 0, 0)),
    "h": (3600.0, (0, 0, 1, 0, 0)),
    "mph": (0.44704, (1, 0, -1, 0, 0)),
    "ns": (1e-9, (0, 0, 1, 0, 0)),
    "Ncm": (1e-2, _TORQUE),
    "lbf": (4.4482216152605, _NEWTON),
    "kgf": (9.80665, _NEWTON),
    "gf": (9.80665e-3, _NEWTON),
    "lbfin": (4.4482216152605 * 0.0254, _TORQUE),
    "lbfft": (4.4482216152605 * 0.3048, _TORQUE),
    "ozfin": (4.4482216152605 * 0.0254 / 16.0, _TORQUE),
    "kgfcm": (9.80665e-2, _TORQUE),
    "kgm2": (1.0, _INERTIA),
    "kgm^2": (1.0, _INERTIA),
    "gcm2": (1e-7, _INERTIA),
    "gcm^2": (1e-7, _INERTIA),
    "K": (1.0, _KELVIN),
    "degC": (1.0, _KELVIN),
    "°C": (1.0, _KELVIN),
}
_TABLE = _PLAIN | {
    prefix + name: (scale * factor, dimension)
    for prefix, scale in _PREFIXES.items()
    for name, (factor, dimension) in _PREFIXED.items()
}
_SHOWN = (
    "s", "ms", "us", "ns", "min", "rad", "mrad", "deg", "rev", "counts", "rad/s", "deg/s", "rev/s", "rpm",
    "counts/s", "m/s^2", "m/s", "mm/s", "m/min", "km/h", "mph", "m", "cm", "mm", "kg", "g", "N", "kN", "mN",
    "N m", "mNm", "Ncm", "A", "mA", "V", "mV", "ohm", "mohm", "N m/A", "mNm/A", "N/A", "N/V", "V s/m",
    "V s/rad",
    "V s/rev", "V/rpm", "V/krpm", "kg m^2", "g cm^2", "degC", "K",
)  # fmt: skip
_NAMES = (*_PLAIN, *_PREFIXED, "counts")
_TOKEN = re.compile(r"\s*(?:([A-Za-zµμΩ°%]+)(?:\^?(-?\d+)|([²³]))?|(1)(?![\d.])|([*·./()]))")
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_SCALED = re.compile(r"(0[.,]0*1)\s*[x*·]?\s*(?=[A-Za-z°µμΩ])")
"""Before a unit, as drives state the resolution of a signal: 0.1 rpm."""
_VALUE = re.compile(rf"\s*({_NUMBER})(?:\s*/\s*({_NUMBER}))?\s*(.*)", re.DOTALL)


@dataclass(frozen=True)
class Unit:
    """A unit: SI value = `factor` * value + `offset`; temperatures come out in degC, all else in SI."""

    text: str
    factor: float
    dimension: Dimension
    offset: float = 0.0

    def to_si(self, value: Number) -> Number:
        """Return the value (float or array) in SI, a temperature in degC."""
        return value * self.factor + self.offset


class _UnknownNameError(Exception):
    """A name that is not in the table."""


def parse_unit(
    text: str, where: str, counts_per_rev: float | None = None, required: str | None = None
) -> Unit:
    """Return the unit that a text names.

    `where` opens the error message (file and key); `counts_per_rev` defines `counts`; a message proposes
    units of the same dimension as `required`.
    Raises InputError for an unknown name, and for `counts` without counts per revolution.
    """
    # The ohm sign and the Greek letter look alike.
    stripped = unicodedata.normalize("NFC", " ".join(text.split()))
    scaled = _SCALED.match(stripped)
    scale = float(scaled[1].replace(",", ".")) if scaled else 1.0
    bare = stripped[scaled.end() :] if scaled else stripped
    if bare in ("K", "degC", "°C"):
        return Unit(stripped, scale, _KELVIN, -273.15 if bare == "K" else 0.0)
    tokens = _tokens(bare, where)
    try:
        factor, dimension, rest = _product(tokens, stripped, where, counts_per_rev)
    except _UnknownNameError as unknown:
        same = _choices(required, where) if required else _SHOWN
        close = _closest(stripped, same) or _closest(str(unknown), _NAMES)
        hint = f"did you mean {close!r}? " if close else ""
        inside = "" if str(unknown) == text else f" in {text!r}"
        raise InputError(
            where, problem=f"unknown unit {str(unknown)!r}{inside}; {hint}known are {', '.join(same)}"
        ) from None
    if rest:
        raise InputError(where, problem=f"unit {text!r} has an unmatched ')'")
    return Unit(stripped, factor * scale, dimension)


def seconds_in(text: str) -> float:
    """Return how many seconds one of a unit of time is; 1 for no unit, and for one of anything else."""
    try:
        found = parse_unit(text, "")
    except InputError:
        return 1.0
    return found.factor if found.dimension == (0, 0, 1, 0, 0) else 1.0


def parse_value(text: str, required: str, where: str, counts_per_rev: float | None = None) -> float:
    """Return the SI value of a text such as `0.2 V s/rev` or `1/30`; `required` is a unit of its dimension.

    Raises InputError if there is no number, no unit, an unknown unit, or one of another dimension.
    """
    match = _VALUE.fullmatch(text)
    if match is None:
        raise InputError(
            where, "a number with a unit", f"{text!r}", why=f"({', '.join(_choices(required, where))})"
        )
    if re.match(r",\s*\d", match[3]):
        point = text.replace(",", ".", 1)
        raise InputError(where, "a decimal point", f"{text!r}", why=f", as in {point!r}")
    if match[3].startswith(":"):
        raise InputError(where, "a ratio with '/', as in '1/5'", f"{text!r}")
    if required == "rad" and not match[3]:
        raise InputError(where, "a unit", f"{text!r}", why="(deg, rad)")
    divisor = float(match[2]) if match[2] else 1.0
    if divisor == 0.0:
        raise InputError(where, "a finite number", f"{text!r}")
    try:
        unit = require_unit(match[3] or "1", required, where, counts_per_rev)
    except InputError:
        if match[3]:
            raise
        choices = ", ".join(_choices(required, where))
        raise InputError(where, "a unit", f"{text!r}", why=f"({choices})") from None
    return unit.to_si(float(match[1]) / divisor)


def require_unit(text: str, required: str, where: str, counts_per_rev: float | None = None) -> Unit:
    """Return the unit that a text names; InputError if it does not have the dimension of `required`."""
    unit = parse_unit(text, where, counts_per_rev, required)
    if unit.dimension != parse_unit(required, where).dimension:
        choices = ", ".join(_choices(required, where))
        raise InputError(where, f"a unit like {choices}", f"{text!r}")
    return unit


_WITH_ANGLES = {"1": ["1", "%"], "rad": ["deg", "rad"], "m/rad": ["m/rad", "mm/rev"]}


def _choices(required: str, where: str) -> list[str]:
    # An angle has no dimension: units that only differ by one are not shown for each other.
    if required in _WITH_ANGLES:
        return _WITH_ANGLES[required]
    dimension = parse_unit(required, where).dimension
    return [s for s in _SHOWN if parse_unit(s, where, 1.0).dimension == dimension] or [required]


def _closest(name: str, names: Iterable[str]) -> str | None:
    by_lower = {known.lower(): known for known in names}
    return next((by_lower[close] for close in difflib.get_close_matches(name.lower(), by_lower, 1)), None)


def _tokens(text: str, where: str) -> list[str]:
    tokens: list[str] = []
    position = 0
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            raise InputError(where, problem=f"unit {text!r} is not understood at {text[position:]!r}")
        tokens.append(match[0].strip())
        position = match.end()
    if not tokens:
        raise InputError(where, "a unit", "an empty text")
    return tokens


def _product(
    tokens: list[str], text: str, where: str, counts_per_rev: float | None
) -> tuple[float, Dimension, list[str]]:
    """Read factors up to the end or a closing parenthesis: factor, dimension, remaining tokens."""
    factor, dimension, divide, after_slash = 1.0, _ONE, False, False
    previous = ""
    while tokens and tokens[0] != ")":
        part, tokens = tokens[0], tokens[1:]
        if part in ("*", "·", ".", "/"):
            if previous in ("", "*", "·", ".", "/"):
                raise InputError(where, problem=f"unit {text!r} has a {part!r} without a unit before it")
            divide, previous = part == "/", part
            continue
        if after_slash and not divide:
            raise InputError(
                where, problem=f"unit {text!r} is ambiguous after '/': write parentheses, as in N m/(rad/s)"
            )
        if part == "(":
            scale, powers, tokens = _product(tokens, text, where, counts_per_rev)
            if not tokens:
                raise InputError(where, problem=f"unit {text!r} has an unmatched '('")
            tokens = tokens[1:]
        else:
            scale, powers = _power(part, text, where, counts_per_rev)
        sign = -1 if divide else 1
        factor *= scale**sign
        dimension = _combine(dimension, powers, sign)
        after_slash, divide, previous = after_slash or divide, False, part
    if previous in ("", "*", "·", ".", "/"):
        raise InputError(where, problem=f"unit {text!r} is incomplete")
    return factor, dimension, tokens


def _power(part: str, text: str, where: str, counts_per_rev: float | None) -> tuple[float, Dimension]:
    if part in _TABLE:
        return _TABLE[part]
    match = _TOKEN.fullmatch(part)
    name = match[1] if match and match[1] else part
    exponent = int(match[2] or {"²": 2, "³": 3, None: 1}[match[3]]) if match else 1
    if name in ("count", "counts"):
        if counts_per_rev is None:
            raise InputError(where, problem=f"unit {text!r} requires encoder_counts_per_rev in the rig file")
        return (_TURN / counts_per_rev) ** exponent, _ONE
    if name not in _TABLE:
        raise _UnknownNameError(name)
    if abs(exponent) > 9:
        raise InputError(where, problem=f"unit {text!r} has a power above 9")
    factor, dimension = _TABLE[name]
    return factor**exponent, _combine(_ONE, dimension, exponent)


def _combine(left: Dimension, right: Dimension, power: int) -> Dimension:
    a, b, c, d, e = (x + power * y for x, y in zip(left, right, strict=True))
    return a, b, c, d, e


# Arithmetic on the columns of a log: `pwm_counts / 885 * supply_V`, `torque_enable == 1 and speed > 0`.
#
# Python's own parser reads the text; the nodes on a whitelist are evaluated with NumPy here. Nothing is run
# as code: there are no calls, attributes, indices or powers, and length and depth are bounded. A column
# whose name is not a plain word is put in backticks: `` `speed (rpm)` / 60 ``.


if TYPE_CHECKING:
    from collections.abc import Callable, Iterable


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
_OPERATOR = re.compile(r"[+*/<>=]|\s-\s")
_EXPECTED = (
    "a column of the log, or arithmetic of + - * / ( ), numbers, comparisons, and, or, not"
    " and column names (in `backticks` if not one word)"
)


def is_arithmetic(text: str, columns: Iterable[str]) -> bool:
    """Whether a text is arithmetic on columns of a log rather than the name of a column that is not there.

    Arithmetic has one of the columns, a name in backticks, or an operator between parts that are allowed.
    """
    if "`" in text or any(re.search(rf"(?<!\w){re.escape(name)}(?!\w)", text) for name in columns):
        return True
    try:
        return bool(_OPERATOR.search(text) and column_names(text, ""))
    except InputError:
        return False


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
        raise InputError(where, _EXPECTED, f"{ast.unparse(node)!r} in {text!r}")

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
        raise InputError(where, _EXPECTED, f"{text!r}") from None


def _finite(number: float, text: str, where: str) -> float:
    try:
        converted = float(number)
    except OverflowError:
        converted = math.inf
    if not math.isfinite(converted):
        raise InputError(where, problem=f"expected a finite number in {text!r}")
    return converted
