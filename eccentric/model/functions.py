"""Expressions as NumPy functions: printed once, and cached until a source changes.

A search evaluates the columns of 150 effects at 800 values of their shape parameters. So subexpressions that
depend on neither shapes nor states (the parts) are separate functions, evaluated once per log.
"""

from __future__ import annotations

import hashlib
import io
import marshal
import pickle
import zlib
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from functools import lru_cache
from types import CodeType, MappingProxyType
from typing import Any, TypeVar

import numpy as np
import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.printing.numpy import NumPyPrinter

from eccentric.core import derived

# Models and their expressions as bytes, structurally exact, and digests of their content.
#
# SymPy's pickles evaluate: sqrt(g (M + M_l)/(L M)) would come back as a product of roots.
_OURS = {"sympy", "eccentric"}
"""Packages whose classes are fixed as long as no source changes; a class of a user's script is not."""
_EVALUATED = sp.Add | sp.Mul | sp.Pow | sp.Function | sp.Max | sp.Min
_MOST_KNOWN = 50_000
_known: dict[sp.Basic, bytes] = {}
"""Cached digests of expressions: those of effects share a few thousand subexpressions."""


def to_bytes(value: Any) -> bytes:
    """A model, an expression or a record of them as bytes.

    Raises:
        Exception: it contains something that cannot be pickled, such as a function defined in a script.
    """
    file = io.BytesIO()
    _Pickler(file, pickle.HIGHEST_PROTOCOL).dump(value)
    return file.getvalue()


def from_bytes(content: bytes) -> Any:
    """The inverse of `to_bytes`; only for content that nobody but the user can have written."""
    return pickle.loads(content)  # noqa: S301


class _Pickler(pickle.Pickler):
    def reducer_override(self, obj: Any) -> Any:
        if isinstance(obj, _EVALUATED) and not isinstance(obj, AppliedUndef):
            return _as_written, (type(obj), obj.args)
        is_custom = type(obj).__reduce__ is not object.__reduce__
        if is_dataclass(obj) and not isinstance(obj, type) and not is_custom:  # without cached properties
            return _record, (type(obj), {f.name: getattr(obj, f.name) for f in fields(obj)})
        return NotImplemented


def _as_written(kind: type[sp.Expr], args: tuple[sp.Expr, ...]) -> sp.Expr:
    return kind(*args, evaluate=False)


def _record(kind: type, values: dict[str, Any]) -> Any:
    record = object.__new__(kind)
    for name, value in values.items():
        object.__setattr__(record, name, value)
    return record


def fingerprint(value: Any) -> str:
    """The digest of a record of expressions, the same in every process.

    Raises:
        TypeError: it has a function or a user-defined class, whose behaviour no digest can capture.
    """
    if len(_known) > _MOST_KNOWN:
        _known.clear()
    return _print_of(value, _known).hex()


def _print_of(value: Any, known: dict[sp.Basic, bytes]) -> bytes:
    if isinstance(value, sp.Basic):
        if value not in known:
            if (type(value).__module__ or "").partition(".")[
                0
            ] not in _OURS:  # an undefined function has none
                name = type(value).__qualname__
                raise TypeError(f"expected a class of SymPy or of ours, got {name}")
            inside = [_print_of(arg, known) for arg in value.args]
            text = f"{type(value).__module__}.{type(value).__qualname__}" if inside else sp.srepr(value)
            known[value] = _digest(text.encode(), *inside)
        return known[value]
    if isinstance(value, sp.MatrixBase):
        return _digest(str(value.shape).encode(), *(_print_of(x, known) for x in value))
    if is_dataclass(value) and not isinstance(value, type):
        name = type(value).__qualname__.encode()
        return _digest(name, *(_print_of(getattr(value, f.name), known) for f in fields(value)))
    if isinstance(value, Enum):
        return _digest(str(value).encode())
    if isinstance(value, Mapping):
        pairs = sorted(_digest(_print_of(k, known), _print_of(x, known)) for k, x in value.items())
        return _digest(b"{}", *pairs)
    if isinstance(value, tuple | list):
        return _digest(b"[]", *(_print_of(x, known) for x in value))
    if isinstance(value, set | frozenset):
        return _digest(b"set", *sorted(_print_of(x, known) for x in value))
    if value is None or isinstance(value, str | bytes | int | float):
        return _digest(f"{type(value).__name__} {value!r}".encode())
    raise TypeError(f"expected a record of expressions, got {type(value).__name__}")


def _digest(*parts: bytes) -> bytes:
    return hashlib.blake2b(
        b"".join(len(part).to_bytes(4, "big") + part for part in parts), digest_size=16
    ).digest()


T = TypeVar("T")


def cached(kind: str, record: Any, make: Callable[[], T]) -> T:
    """What `make` makes of a record of expressions; the cache keeps it, under a word for its kind."""
    try:
        key = f"{kind} {fingerprint(record)}"
    except TypeError:  # it has what only its author's script can say
        return make()
    if (kept := derived.get(key)) is not None:
        return from_bytes(zlib.decompress(kept))
    made = make()
    derived.put(key, zlib.compress(to_bytes(made)))
    return made


@dataclass(frozen=True)
class NumericFunction:
    """An expression as code.

    Attributes:
        key: the digest of the expression.
        call: the function of the argument values.
        arguments: names of signals, parameters, shapes, states and parts.
        parts: the arguments that are functions of signals and parameters.
    """

    key: str
    call: Callable[..., Any]
    arguments: tuple[str, ...]
    parts: Mapping[str, NumericFunction]


_MOST_BYTES = 64 * 2**20
"""Memory for cached values of parts on one log [bytes]: enough for all except on long logs."""
_MOST = 2000
"""Functions cached in a process: all effects of the library on a few models."""
_functions: dict[str, NumericFunction] = {}


class PartValues:
    """The values of parts on one log, cached up to a memory limit.

    given: signals (samples,) and parameters, by name.
    """

    def __init__(self, given: Mapping[str, Any]) -> None:
        self._given = given
        self._cached: dict[str, np.ndarray] = {}

    def __getitem__(self, part: NumericFunction) -> np.ndarray:
        """The values of a part (samples,)."""
        if part.key not in self._cached:
            values = np.asarray(part.call(*(self._given[name] for name in part.arguments)), float)
            if len(self._cached) * values.nbytes > _MOST_BYTES:
                return values
            self._cached[part.key] = values
        return self._cached[part.key]


@lru_cache(maxsize=_MOST)
def function_of(expression: sp.Expr) -> tuple[Callable[..., Any], tuple[str, ...]]:
    """An expression as a function of its symbols, and their names; compiled once per process."""
    code, names = _code(expression)
    return _executed(code), names


def printed(
    key: str, expression: Callable[[], sp.Expr], fixed: Collection[str], signals: Collection[str]
) -> NumericFunction:
    """An expression with its parts as functions.

    Args:
        key: cache key, which determines all other arguments; "" for no caching.
        expression: creates the expression if it is not cached.
        fixed: names whose values on a log do not depend on shapes and states.
        signals: those of them that vary along the log.
    """
    if key in _functions:
        return _functions[key]
    cached = derived.get(key) if key else None
    if cached is None:
        reduced, parts = _split(expression(), set(fixed), set(signals))
        code, arguments = _code(reduced)
        compiled = {
            name: (fingerprint(part) if key else str(part), *_code(part)) for name, part in parts.items()
        }
        record: tuple[CodeType, tuple[str, ...], dict[str, Any]] = code, arguments, compiled
        if not key:
            return _function(key, *record)
        derived.put(key, marshal.dumps(record))
    else:
        record = marshal.loads(cached)  # noqa: S302 - the user's own
    if len(_functions) >= _MOST:
        del _functions[next(iter(_functions))]
    _functions[key] = _function(key, *record)
    return _functions[key]


def _function(
    key: str,
    code: CodeType,
    arguments: tuple[str, ...],
    parts: Mapping[str, tuple[str, CodeType, tuple[str, ...]]],
) -> NumericFunction:
    compiled = {
        name: NumericFunction(part, _executed(of), of_names, {})
        for name, (part, of, of_names) in parts.items()
    }
    return NumericFunction(key, _executed(code), arguments, compiled)


def _split(expression: sp.Expr, fixed: set[str], signals: set[str]) -> tuple[sp.Expr, dict[str, sp.Expr]]:
    """Replace the largest subexpressions without shapes and states by symbols; returns them by name.

    If the expression has neither shapes nor states, its functions, such as cosines, become the parts.
    """
    parts: dict[sp.Expr, sp.Symbol] = {}
    names = {s.name for s in expression.free_symbols}
    every = names <= fixed

    def part(e: sp.Expr) -> sp.Expr:
        return parts.setdefault(e, sp.Symbol(f"_part_{len(parts)}"))

    def is_part(e: sp.Basic) -> bool:
        inside = {s.name for s in e.free_symbols}
        return bool(e.args) and inside <= fixed and not inside.isdisjoint(signals)

    def walk(e: sp.Basic) -> sp.Basic:
        if isinstance(e, sp.Function) and is_part(e):
            return part(e)
        if isinstance(e, sp.Piecewise) or not e.args:
            return e
        if every:
            return e.func(*map(walk, e.args))
        if is_part(e):
            return part(e)
        if isinstance(e, sp.Add | sp.Mul):
            constant = [arg for arg in e.args if {s.name for s in arg.free_symbols} <= fixed]
            if len(constant) > 1 and is_part(grouped := e.func(*constant)):
                rest = [arg for arg in e.args if arg not in constant]
                return e.func(part(grouped), *map(walk, rest))
        return e.func(*map(walk, e.args))

    reduced = walk(expression)
    return reduced, {symbol.name: e for e, symbol in parts.items()}


def _code(expression: sp.Expr) -> tuple[CodeType, tuple[str, ...]]:
    names = tuple(sorted(s.name for s in expression.free_symbols))
    return compile(_SharedPartsPrinter(expression).function("evaluate", names), "<expression>", "exec"), names


def _executed(code: CodeType) -> Callable[..., Any]:
    namespace: dict[str, Any] = {}
    exec(code, namespace)  # noqa: S102
    return namespace["evaluate"]


class _SharedPartsPrinter(NumPyPrinter):
    """Prints an expression as NumPy code with common subexpressions evaluated once.

    `sp.lambdify` does the same, but spends most of its time on documentation and on common partial sums.
    """

    def __init__(self, expression: sp.Expr) -> None:
        super().__init__({"inline": True, "allow_unknown_functions": True})
        self._expression = expression
        self._repeated: set[sp.Basic] = set()
        self._variables: dict[sp.Basic, str] = {}
        self._lines: list[str] = []
        seen: set[sp.Basic] = set()
        pending: list[sp.Basic] = [expression]
        while pending:
            part = pending.pop()
            if part in seen:
                self._repeated.add(part)
            elif part.args:
                seen.add(part)
                pending += part.args

    def function(self, name: str, arguments: Sequence[str]) -> str:
        """The text of a module with a function of these arguments."""
        result = self.doprint(self._expression)
        lines = [*self._lines, f"return {result}"]
        body = "".join(f"    {line}\n" for line in lines)
        imports = "".join(f"import {module}\n" for module in ("builtins", *self.module_imports))
        return f"{imports}def {name}({', '.join(arguments)}):\n{body}"

    def _print(self, expr: Any, **kwargs: Any) -> str:
        if expr not in self._repeated:
            return super()._print(expr, **kwargs)
        if expr not in self._variables:
            text = super()._print(expr, **kwargs)
            self._variables[expr] = f"_step_{len(self._variables)}"
            self._lines.append(f"{self._variables[expr]} = {text}")
        return self._variables[expr]


Parts = Mapping[str, tuple[str, ...]]
"""Kind of part -> words for it."""


# The components of a drive as declared in a rig, and whether they allow a cause.
#
# An undeclared component rules out nothing. If a drive has several components of a kind, such as a planetary
# gear and a belt, one of them suffices for a cause.
NO_PART = "none"
GEARS = ("strain wave", "planetary", "worm", "spur", "belt", "screw")
DRIVE_PARTS: Parts = MappingProxyType(
    {
        "gear": (*GEARS, NO_PART),
        "motor": (
            *("brushed", "coreless", "brushless", "slotless", "stepper", "induction"),
            *("eddy-current brake", NO_PART),
        ),
        "bearing": ("ball", "roller", "plain", "air", NO_PART),
        "lubricant": ("grease", "oil", NO_PART),
    }
)
"""All values that a rig may declare, as defined in `docs/rig-reference.md`."""

IRON = ("brushed", "brushless", "stepper")
"""Motors with magnets and iron teeth, which have cogging."""
MAGNETS = (*IRON, "coreless", "slotless")
MOTORS = (*MAGNETS, "induction")


REDUCERS = frozenset({"strain wave", "planetary", "worm"})
"""Gears whose ratio is never 1."""
ANGLE, MOTOR_ANGLE, OUTPUT_ANGLE = "angle", ("motor",), ("output",)
"""Kind and values derived from a rig: whether the motor angle is known."""


def missing(needs: Parts, given: Parts) -> dict[str, tuple[str, ...]]:
    """Kind -> the required components of which the `given` ones include none; empty if none is missing."""
    return {
        kind: words for kind, words in needs.items() if given.get(kind) and not set(words) & set(given[kind])
    }
