"""Computations common to several routines become a function that they call: every formula is written once.

This works on printed lines. Two are equivalent if they do the same operations in the same order on equivalent
operands; names may differ from routine to routine.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache

_HEAD = 5  # lines of a function besides its body
_NAMELESS = re.compile(r"part_|result")
_NAME = re.compile(r"(?<![\w.])[A-Za-z_]\w*")


@dataclass(frozen=True)
class Line:
    """`targets = text`, with a comment before it; there are several targets where a function is called."""

    targets: tuple[str, ...]
    text: str
    note: str = ""


@dataclass(frozen=True)
class CodeBody:
    """A function.

    Attributes:
        name: of the routine, or of a shared function.
        inputs: names.
        lines: in order.
        results: names of the returned values.
        callers: how many functions call it, if it is shared.
    """

    name: str
    inputs: tuple[str, ...]
    lines: tuple[Line, ...]
    results: tuple[str, ...]
    callers: int = 0


def with_shared(bodies: Sequence[CodeBody], taken: Collection[str]) -> tuple[list[CodeBody], list[CodeBody]]:
    """The functions that bodies share, callees before callers, and the bodies that call them.

    Args:
        bodies: the routines; their lines have one target.
        taken: names that no shared function may have.
    """
    shared, rest = list[CodeBody](), list(bodies)
    numbering = dict[str, str]()
    while (alike := _most_alike([*shared, *rest], numbering)) is not None:
        callers = [body for body in [*shared, *rest] if alike <= {*_keys(body, numbering)}]
        block = _block(callers, alike, numbering, {*taken, *(body.name for body in shared)})
        shared = [block, *(_calling(body, block, numbering) if body in callers else body for body in shared)]
        rest = [_calling(body, block, numbering) if body in callers else body for body in rest]
    return shared, rest


def names_in(texts: Iterable[str]) -> set[str]:
    """The names in formulas, without those of attributes."""
    return set().union(*map(_names, texts))


@cache
def _names(text: str) -> frozenset[str]:
    return frozenset(name[0] for name in _NAME.finditer(text))


def _keys(body: CodeBody, numbering: dict[str, str]) -> list[str]:
    """The value of each line as a number, the same for equivalent lines of different bodies.

    Within a body a value is written once; where it is written again, it is a result of its own, such as a 0.
    """
    known = {name: name for name in body.inputs}
    keys, times = [], Counter[str]()
    for line in body.lines:
        meant = _NAME.sub(lambda name: known.get(name[0], name[0]), line.text)  # noqa: B023 - used at once
        times[meant] += 1
        meant = f"{meant}, result {times[meant]}" if times[meant] > 1 else meant
        keys.append(numbering.setdefault(meant, f"#{len(numbering)}"))
        known |= {name: _result(keys[-1], line, k) for k, name in enumerate(line.targets)}
    return keys


def _result(key: str, line: Line, k: int) -> str:
    return f"{key}[{k}]" if len(line.targets) > 1 else key


def _most_alike(bodies: Sequence[CodeBody], numbering: dict[str, str]) -> set[str] | None:
    """The lines, by their keys, that save most as a function; None if none saves anything.

    They are a named value with everything that it depends on, or a whole routine.
    """
    keys = [_keys(body, numbering) for body in bodies]
    candidates = [set(own) for own in keys]
    for body, own in zip(bodies, keys, strict=True):
        follows = dict[str, set[str]]()
        for key, line in zip(own, body.lines, strict=True):
            follows |= {
                name: {key}.union(*(follows.get(x, ()) for x in names_in([line.text])))
                for name in line.targets
            }
            if not _NAMELESS.match(line.targets[0]):
                candidates.append(follows[line.targets[0]])

    most, best = (0, 0), set[str]()
    for alike in candidates:
        callers = [k for k, own in enumerate(candidates[: len(keys)]) if alike <= own]
        # Lines, minus one for each returned value, which has to be read as well; and callers. Values take
        # longest to count: not where lines alone are too few.
        lines = len(callers) * (len(alike) - 1) - len(alike) - _HEAD
        if (lines, len(callers)) > most:
            given = set().union(*(_read_outside(bodies[k], keys[k], alike) for k in callers))
            if (lines - len(given), len(callers)) > most:
                most, best = (lines - len(given), len(callers)), alike
    return best if most[0] > 0 else None


def _block(
    callers: Sequence[CodeBody], alike: set[str], numbering: dict[str, str], taken: set[str]
) -> CodeBody:
    """The function of the lines, with the names that its first caller uses."""
    first = callers[0]
    keys = _keys(first, numbering)
    lines = [line for key, line in zip(keys, first.lines, strict=True) if key in alike]
    made = {name for line in lines for name in line.targets}
    names = {name: key for key, name in _named(first, keys) if name in made}
    reads = [_read_outside(body, _keys(body, numbering), alike) for body in callers]
    count = {name: sum(key in read for read in reads) for name, key in names.items()}
    results = sorted((name for name in names if count[name]), key=lambda name: -count[name])
    whole = next((body for body in callers if {*_keys(body, numbering)} == alike), None)
    name = f"_{whole.name.lstrip('_') if whole else lines[-1].targets[-1]}"
    while name in taken:
        name += "_2"
    used = names_in(line.text for line in lines)
    inputs = tuple(x for x in first.inputs if x in used)
    return CodeBody(name, inputs, tuple(lines), tuple(results), len(callers))


def _read_outside(body: CodeBody, keys: Sequence[str], alike: set[str]) -> set[str]:
    """The values of the lines that a caller uses outside them, by key; `keys` are those of the caller."""
    others = [line for key, line in zip(keys, body.lines, strict=True) if key not in alike]
    read = names_in(line.text for line in others) | {*body.results}
    made = {name for key, line in zip(keys, body.lines, strict=True) if key in alike for name in line.targets}
    return {key for key, name in _named(body, keys) if name in read & made}


def _calling(body: CodeBody, block: CodeBody, numbering: dict[str, str]) -> CodeBody:
    """The body with a call in place of the lines that the block computes."""
    of_block, own = _keys(block, numbering), _keys(body, numbering)
    made = {*of_block}
    keys = {name: key for key, name in _named(block, of_block)}
    names = dict(_named(body, own))
    call = Line(
        tuple(names[keys[name]] for name in block.results), f"{block.name}({', '.join(('c', *block.inputs))})"
    )
    at = min(k for k, key in enumerate(own) if key in made)
    rest = [line for key, line in zip(own, body.lines, strict=True) if key not in made]
    return replace(body, lines=(*rest[:at], call, *rest[at:]))


def _named(body: CodeBody, keys: Sequence[str]) -> list[tuple[str, str]]:
    """Key and name of every value of the lines, whose keys these are."""
    return [
        (_result(key, line, k), name)
        for key, line in zip(keys, body.lines, strict=True)
        for k, name in enumerate(line.targets)
    ]
