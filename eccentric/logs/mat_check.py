"""Check that the elements of a MAT file of version 5 or 7 are consistent, before SciPy reads it.

SciPy's reader trusts type codes and sizes: a single wrong byte can crash the process or exhaust the memory.
So whatever it relies on is checked here first.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Container
from dataclasses import dataclass
from math import prod

from eccentric.logs.limits import DEEPEST_VARIABLE, MOST_BYTES

MATRIX, COMPRESSED = 14, 15
BYTES = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 9: 8, 12: 8, 13: 8}
"""Bytes per number, by type code."""
LETTERS = {1: 1, 2: 1, 4: 2, 16: 1, 17: 2, 18: 4}
"""The same for characters; in UTF-8 (16) they can take more."""
CELL, STRUCTURE, OBJECT, CHAR, SPARSE = 1, 2, 3, 4, 5
NUMBERS = range(6, 16)
FUNCTION, OPAQUE = 16, 17


class DamagedError(ValueError):
    """The content of the file contradicts itself."""


@dataclass
class _Bytes:
    """A piece of the file that is read from its start; `order` is that of `struct`."""

    data: memoryview
    order: str

    def element(self, padded: bool = True) -> tuple[int, memoryview]:
        """Return type code and content of the next element, and advance past it."""
        if len(self.data) < 8:
            raise DamagedError("it breaks off")
        (first,) = struct.unpack(f"{self.order}I", self.data[:4])
        kind, size, start = first & 0xFFFF, first >> 16, 4
        if size == 0:
            kind, size, start = *struct.unpack(f"{self.order}II", self.data[:8]), 8
        elif size > 4:
            raise DamagedError("a small element has more than four bytes")
        if start + size > len(self.data):
            raise DamagedError("it breaks off")
        content = self.data[start : start + size]
        self.data = self.data[8 if start == 4 else start + (size + (-size % 8 if padded else 0)) :]
        return kind, content

    def numbers(self) -> tuple[int, ...]:
        """Return the 32-bit numbers of the next element, which must be of such a type."""
        kind, content = self.require((5, 6))
        if len(content) % 4:
            raise DamagedError("numbers are cut off")
        return struct.unpack(f"{self.order}{len(content) // 4}{'i' if kind == 5 else 'I'}", content)

    def require(self, kinds: Container[int]) -> tuple[int, memoryview]:
        """Return the next element, which must be of one of these types."""
        found, content = self.element()
        if found not in kinds:
            raise DamagedError(f"an element of type {found} is not allowed here")
        return found, content


def check(data: bytes) -> list[tuple[int, ...]]:
    """Go through a file of version 5 or 7, and return the shapes of its arrays of numbers and characters.

    Raises DamagedError with a reason if SciPy must not read it.
    """
    shapes: list[tuple[int, ...]] = []
    order = {b"IM": "<", b"MI": ">"}.get(data[126:128])
    if order is None:
        raise DamagedError("its header is not that of version 5 or later; save with -v7")
    rest = _Bytes(memoryview(data)[128:], order)
    while len(rest.data):
        kind, content = rest.element(padded=False)
        if kind == COMPRESSED:
            unpacker = zlib.decompressobj()
            content = memoryview(unpacker.decompress(content, MOST_BYTES))
            if unpacker.unconsumed_tail:
                raise DamagedError(f"a variable has more than {MOST_BYTES:,} bytes")
            if not unpacker.eof:
                raise DamagedError("it breaks off")
            kind, content = _Bytes(content, order).element()
        if kind != MATRIX:
            raise DamagedError(f"a variable of type {kind} is where a matrix is required")
        _matrix(_Bytes(content, order), 0, shapes)
    return shapes


def _matrix(rest: _Bytes, depth: int, shapes: list[tuple[int, ...]]) -> None:
    """Check the content of a matrix element, and note its shape; it may be empty below the top."""
    if depth > DEEPEST_VARIABLE:
        raise DamagedError(f"it is nested deeper than {DEEPEST_VARIABLE}")
    if not len(rest.data) and depth:
        return
    flags = rest.numbers()
    if len(flags) != 2:
        raise DamagedError("array flags are two numbers")
    kind, is_complex = flags[0] & 0xFF, bool(flags[0] >> 11 & 1)
    if kind == OPAQUE:
        for _ in ("name", "type system", "class"):
            _word(rest)
        _inner(rest, depth, shapes)
        return
    shape = rest.numbers()
    count = prod(shape)
    if not 2 <= len(shape) <= 32 or min(shape) < 0 or count > MOST_BYTES:
        raise DamagedError("an array has an impossible size")
    _word(rest)
    if kind in NUMBERS or kind == CHAR:
        shapes.append(shape)
    if kind in NUMBERS:
        for _ in range(1 + is_complex):
            code, content = rest.require(BYTES)
            if len(content) != count * BYTES[code]:
                raise DamagedError("an array does not have its declared size")
    elif kind == CHAR:
        code, content = rest.require(LETTERS)
        if len(content) % LETTERS[code] or not (len(content) >= count * LETTERS[code] or not len(content)):
            raise DamagedError("a text does not have its declared length")
        if len(content) == 0 and count > 8 * DEEPEST_VARIABLE:
            raise DamagedError("a long text is empty")
    elif kind == CELL:
        _inner(rest, depth, shapes, count)
    elif kind in (STRUCTURE, OBJECT):
        if kind == OBJECT:
            _word(rest)
        (length,) = rest.numbers() or (0,)
        names = _word(rest)
        if (
            length < 1
            or len(names) % length
            or any(0 not in names[k : k + length] for k in range(0, len(names), length))
        ):
            raise DamagedError("field names do not have their declared length")
        _inner(rest, depth, shapes, count * (len(names) // length))
    elif kind == FUNCTION:
        _inner(rest, depth, shapes)
    elif kind == SPARSE:
        raise DamagedError("a sparse array is not a signal; save with full(...)")
    else:
        raise DamagedError(f"an array of class {kind} is unknown")


def _inner(rest: _Bytes, depth: int, shapes: list[tuple[int, ...]], count: int = 1) -> None:
    """Check the matrices of a cell array or structure, as many as it has."""
    if count * 8 > len(rest.data):
        raise DamagedError("it breaks off")
    for _ in range(count):
        _, content = rest.require((MATRIX,))
        _matrix(_Bytes(content, rest.order), depth + 1, shapes)


def _word(rest: _Bytes) -> bytes:
    return bytes(rest.require((1, 16))[1])
