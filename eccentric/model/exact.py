"""Models and their expressions as bytes, exactly as they are written, and the digest of what they say.

SymPy's own pickles evaluate: sqrt(g (M + M_l)/(L M)) would come back as a product of roots.
"""

from __future__ import annotations

import hashlib
import io
import pickle
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

_OURS = {"sympy", "eccentric"}
"""Packages whose classes mean the same as long as no source changes; one of a person's script need not."""
_MOST_KNOWN = 50_000
_known: dict[sp.Basic, bytes] = {}
"""Digests of expressions: those of effects consist of the same few thousand parts."""


def to_bytes(value: Any) -> bytes:
    """A model, an expression or a record of them as bytes.

    Raises:
        Exception: it contains what cannot be pickled, such as a function defined in a script.
    """
    file = io.BytesIO()
    _Pickler(file, pickle.HIGHEST_PROTOCOL).dump(value)
    return file.getvalue()


def from_bytes(content: bytes) -> Any:
    """The value of `to_bytes`; only for content that the user alone can have written."""
    return pickle.loads(content)  # noqa: S301


class _Pickler(pickle.Pickler):
    def reducer_override(self, obj: Any) -> Any:
        if isinstance(obj, sp.Add | sp.Mul | sp.Pow | sp.Function) and not isinstance(obj, AppliedUndef):
            return _as_written, (type(obj), obj.args)
        own = type(obj).__reduce__ is not object.__reduce__
        if is_dataclass(obj) and not isinstance(obj, type) and not own:  # without what it has cached
            return _record, (type(obj), {f.name: getattr(obj, f.name) for f in fields(obj)})
        return NotImplemented


def _as_written(kind: type[sp.Expr], args: tuple[sp.Expr, ...]) -> sp.Expr:
    return kind(*args, evaluate=False)


def _record(kind: type, values: dict[str, Any]) -> Any:
    made = object.__new__(kind)
    for name, value in values.items():
        object.__setattr__(made, name, value)
    return made


def fingerprint(value: Any) -> str:
    """The digest of a record of expressions, the same in every process.

    Raises:
        TypeError: it has a function, or a class of a person's own: what that means, no digest can say.
    """
    if len(_known) > _MOST_KNOWN:
        _known.clear()
    return _print_of(value, _known).hex()


def _print_of(value: Any, known: dict[sp.Basic, bytes]) -> bytes:
    if isinstance(value, sp.Basic):
        if value not in known:
            if type(value).__module__.partition(".")[0] not in _OURS:
                name = type(value).__qualname__
                raise TypeError(f"a class of SymPy or of ours is required, received {name}")
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
    raise TypeError(f"a record of expressions is required, received {type(value).__name__}")


def _digest(*parts: bytes) -> bytes:
    return hashlib.blake2b(
        b"".join(len(part).to_bytes(4, "big") + part for part in parts), digest_size=16
    ).digest()
