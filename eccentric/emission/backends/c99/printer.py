"""C as a language of expressions: how operations are spelled in the working precision and in double."""

from __future__ import annotations

import textwrap
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from functools import reduce

import mpmath
import sympy as sp

from eccentric.core import InputError
from eccentric.emission.backends.backend import number
from eccentric.emission.backends.python.dialect import Language, UnprintableError, choice_of_pairs, printed
from eccentric.emission.program import (
    BITS,
    LEADING_BITS,
    InSingle,
    Low,
    Minus,
    Plus,
    Program,
    Rounded,
    TurnLeft,
    paired,
)
from eccentric.model import Leading

REAL = {
    "sqrt": "MODEL_square_root({0})",
    "fabs": "REAL_FABS({0})",
    "sgn": "MODEL_sgn({0})",
    "forward": "MODEL_forward({0})",
    "backward": "MODEL_forward(-({0}))",
    "exp": "REAL_EXP({0})",
    "at_most": "(({0} > {1}) ? {1} : {0})",
    "within": "MODEL_within({0}, {1})",
    "in_single": "REAL_IN_SINGLE({0}, {1})",
    "sine_ratio": "MODEL_sine_ratio({0})",
    "cosine": "MODEL_cosine({0})",
}
DOUBLE = {
    "sqrt": "sqrt({0})",
    "fabs": "fabs({0})",
    "sin": "sin({0})",
    "cos": "cos({0})",
    "exp": "exp({0})",
    "rounded": "(double)(real)({0})",
    "leading": "MODEL_leading({0})",
    "in_single": "REAL_IN_SINGLE({0}, {1})",
}


def language(program: Program, calls: dict[str, str], symbol: Callable[[str], str], literal: str) -> Language:
    """C for a program: `calls` as above, `symbol` the spelling of names, `literal` a mould of numbers."""
    return Language(
        symbol=symbol,
        low="{}.low".format,
        number=lambda decimal: literal.format(number(decimal)),
        calls={name: text.replace("MODEL", program.name) for name, text in calls.items()},
        pick="(({0}) ? {1} : {2})",
        choice="({0}) ? {1} : ({2})",
    )


# The coefficients of the default parameters, computed in mpmath, so that the target need not.
NOT_GIVEN = "ECCENTRIC_NOT_GIVEN"
"""What a parameter without a default is until it is set: no NaN, which checkers of C take for an error."""
LARGEST_SINGLE = mpmath.mpf(2) ** 128


def evaluate_prepare(program: Program, single: bool) -> dict[str, str]:
    """Every parameter and prepared value at the default parameters, as decimals of the working precision.

    Parameters count as exact decimals, as written. A value without a default is "NAN".

    Raises:
        UnprintableError: an operation that no back end computes.
        InputError: a coefficient is beyond single precision.
    """
    with mpmath.workdps(50):
        values = prepared_values(program, single)
        if single:
            _require_single(program, values)
        return {symbol.name: decimal(value, single) for symbol, value in values.items()}


def decimal(value: mpmath.mpf, single: bool) -> str:
    """A number as a decimal of the working precision; "NAN" if it is none."""
    text = mpmath.nstr(value, 9 if single else 17, min_fixed=-4, max_fixed=6)
    return "NAN" if mpmath.isnan(value) else number(text)


def prepared_values(program: Program, single: bool) -> dict[sp.Symbol, mpmath.mpf]:
    """Every parameter and prepared value at the default parameters, to the digits of mpmath at this moment.

    Raises:
        UnprintableError: an operation that no back end computes.
    """
    values = {q.symbol: _default(q.default, program) for q in program.parameters}
    for a in program.prepare:
        values[a.target] = mpmath.mpf(_value(a.value, values, single))
    return values


def _require_single(program: Program, values: Mapping[sp.Symbol, mpmath.mpf]) -> None:
    """Raise InputError, with the parameter of the oddest size, for a coefficient beyond single precision."""
    far = next((s.name for s in program.coefficients if abs(values[s]) > LARGEST_SINGLE), None)
    if far is None:
        return
    given = {q.name: values[q.symbol] for q in program.parameters if abs(values[q.symbol]) > 0}
    odd = max(given, key=lambda name: abs(mpmath.log(given[name])))
    raise InputError(
        program.name,
        f"{far} within single precision",
        f"{odd} = {mpmath.nstr(given[odd], 6)}, with which it is beyond",
    )


_OPERATIONS: Mapping[type, Callable[..., mpmath.mpf]] = {
    sp.Add: lambda *terms: mpmath.fsum(terms),
    sp.Mul: lambda *factors: mpmath.fprod(factors),
    sp.Pow: mpmath.power,
    sp.Abs: abs,
    sp.Max: lambda a, *others: reduce(lambda x, y: max(y, x), others, a),
    sp.Min: lambda a, *others: reduce(lambda x, y: min(y, x), others, a),
    sp.sin: mpmath.sin,
    sp.cos: mpmath.cos,
    sp.exp: mpmath.exp,
    Plus: lambda a, b: a + b,
    Minus: lambda a, b: a - b,
    TurnLeft: lambda a, b: 2 * mpmath.pi - a * b,
}


def _value(e: sp.Expr, values: Mapping[sp.Symbol, mpmath.mpf], single: bool) -> mpmath.mpf:
    """The expression, evaluated operation by operation.

    Raises:
        UnprintableError: an operation that no back end computes either.
    """
    if e.is_Symbol:
        return values[e]
    if e.is_Rational:
        return mpmath.mpf(e.p) / e.q
    if e.is_number and not e.args:
        return mpmath.mpf(e.evalf(mpmath.mp.dps))
    if isinstance(e, sp.Piecewise):
        return next(_value(x, values, single) for x, condition in e.args if _holds(condition, values, single))
    if isinstance(e, Low):  # nothing is rounded here
        return mpmath.mpf(0)
    if isinstance(e, InSingle):
        return _value(e.args[0 if single else 1], values, single)
    arguments = [_value(a, values, single) for a in e.args]
    precision = "single" if single else "double"
    if isinstance(e, Leading):
        return _round(arguments[0], LEADING_BITS[precision])
    if isinstance(e, Rounded):
        return _round(arguments[0], BITS[precision])
    if type(e) not in _OPERATIONS:
        raise UnprintableError(e)
    return _OPERATIONS[type(e)](*arguments)


def _holds(condition: sp.Basic, values: Mapping[sp.Symbol, mpmath.mpf], single: bool) -> bool:
    if condition == sp.true:
        return True
    if not isinstance(condition, sp.Eq):
        raise UnprintableError(condition)
    left, right = (_value(side, values, single) for side in condition.args)
    return left == right


def _default(default: sp.Expr | None, program: Program) -> mpmath.mpf:
    if default is None:
        return mpmath.mpf("nan")
    known = {q.symbol: q.default for q in program.parameters if q.default is not None}
    exact = sp.Rational(default.xreplace(known))
    return mpmath.mpf(exact.p) / mpmath.mpf(exact.q)


def _round(value: mpmath.mpf, bits: int) -> mpmath.mpf:
    with mpmath.workprec(bits):
        return +value


def pair_functions(program: Program) -> frozenset[str]:
    """The names of the pair functions that `pair_text` calls for the program."""
    found: set[str] = set()

    def noted(name: str) -> str:
        found.add(name)
        return name

    pairs = paired(program)
    silent = Language(str, str, str, defaultdict(str), "", "")
    for a in program.prepare:
        if a.target in pairs:
            pair_text(a.value, pairs, silent, noted)
    return frozenset(found)


def pair_text(e: sp.Expr, pairs: frozenset[sp.Symbol], plain: Language, call: Callable[[str], str]) -> str:
    """The expression as nested calls that return a pair.

    Args:
        e: what to print.
        pairs: symbols that are pairs themselves.
        plain: how to print a double, which counts as exact.
        call: the spelling of a pair function: `exact`, `plus`, `times`, `over`, `root` or `turn_left`.
    """

    def text(part: sp.Expr) -> str:
        return pair_text(part, pairs, plain, call)

    def folded(name: str, parts: Iterable[sp.Expr]) -> str:
        return reduce(lambda a, b: f"{call(name)}({a}, {b})", map(text, parts))

    if e in pairs:
        return e.name
    if isinstance(e, sp.Piecewise):
        return choice_of_pairs(e, text, plain)
    if isinstance(e, TurnLeft):
        return f"{call('turn_left')}({', '.join(printed(a, plain) for a in e.args)})"
    if e.is_Add:
        return folded("plus", e.as_ordered_terms())
    if e.is_Mul:
        above, below = e.as_numer_denom()
        if below != 1:
            return f"{call('over')}({text(above)}, {text(below)})"
        return folded("times", e.as_ordered_factors())
    if e.is_Pow and e.exp == sp.Rational(1, 2):
        return f"{call('root')}({text(e.base)})"
    if e.is_Pow and e.exp.is_Integer and e.exp > 0:
        return folded("times", [e.base] * int(e.exp))
    if e.is_Pow and e.exp.is_Integer:
        return f"{call('over')}({text(sp.Integer(1))}, {text(1 / e)})"
    return f"{call('exact')}({printed(e, plain)})"


_WIDTH = 110


def filled(text: str, indent: int = 4) -> list[str]:
    """The lines of an indented text, with a further indent after the first."""
    return textwrap.wrap(
        text, _WIDTH - indent, subsequent_indent="    ", break_long_words=False, break_on_hyphens=False
    )


def code(lines: Iterable[str], indent: int = 4) -> list[str]:
    """The lines of a function's body, long ones broken."""
    return [part for line in lines for part in filled(line, indent)]


def wrapped(result: str, name: str, arguments: list[str]) -> str:
    """The head of a function, with one argument per line if it is long."""
    line = f"{result} {name}({', '.join(arguments)})"
    if len(line) < _WIDTH:
        return line
    return f"{result} {name}(\n    " + ",\n    ".join(arguments) + ")"
