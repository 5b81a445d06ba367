"""Routines and helpers of the Program as functions of Python."""

from __future__ import annotations

import re
import textwrap
from collections import Counter
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from eccentric.emission.backends.python.dialect import WIDTH, Dialect, Language, broken, printed
from eccentric.emission.program import Helper, Program, Routine
from eccentric.model import Assignment

# Computations common to several routines become a function that they call: every formula is written once.
#
# This works on printed lines. Two are equivalent if they do the same operations in the same order on
# equivalent operands; names may differ from routine to routine.
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
    """A function."""

    name: str  # of the routine, or of a shared function
    inputs: tuple[str, ...]  # names
    lines: tuple[Line, ...]  # in order
    results: tuple[str, ...]  # names of the returned values
    callers: int = 0  # how many functions call it, if it is shared


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


# Formulas reassembled: a part of a formula that is used once is written where it is used.
#
# The parts were split for lines of C. Brackets keep the order of operations, and with it every bit.
_WIDTH = 102  # of `target = text`
_CHOICE, _SUM, _PRODUCT, _ATOM = range(4)
_PART = re.compile(r"part_\d+")


def inlined(lines: Iterable[Line]) -> list[Line]:
    """The lines, with each part that is used once put into the line that uses it, if that stays readable."""
    kept = list(lines)
    for line in [line for line in kept if _PART.fullmatch(line.targets[0])]:
        (name,) = line.targets
        place = re.compile(rf"(?<![\w.]){name}\b")
        readers = [k for k, other in enumerate(kept) if name in other.text and place.search(other.text)]
        at = kept.index(next(other for other in kept if other.targets == (name,)))
        text = kept[at].text
        if len(readers) != 1 or len(place.findall(kept[readers[0]].text)) != 1:
            continue
        reader = kept[readers[0]]
        put = Line(reader.targets, _put(reader.text, place, text), reader.note)
        if len(f"{put.targets[0]} = {put.text}") <= _WIDTH:
            kept[readers[0]] = put
            del kept[at]
    return kept


def _put(outer: str, place: re.Pattern[str], text: str) -> str:
    """The text in its place, in brackets if precedence requires them."""
    before, after = place.split(outer)
    needed = _SUM
    if before.endswith(("* ", "/ ", "-")):
        needed = _ATOM
    elif before.endswith(("+ ", "- ")) or after.startswith((" *", " /")):
        needed = _PRODUCT
    return f"{before}{text if _level(text) >= needed else f'({text})'}{after}"


def _level(text: str) -> int:
    """The precedence of a formula: that of its loosest operation outside brackets."""
    flat, before = text, ""
    while flat != before:
        flat, before = re.sub(r"\([^()]*\)", "", flat), flat
    if " if " in flat:
        return _CHOICE
    if " + " in flat or " - " in flat or flat.startswith("-"):
        return _SUM
    return _PRODUCT if " * " in flat or " / " in flat else _ATOM


_MARGIN = 110
_LONGEST = 100  # docstring on one line


def functions(program: Program, dialect: Dialect) -> dict[str, list[dict[str, Any]]]:
    """What the template takes of helpers, of what routines share, and of routines."""
    coefficients = {s.name for s in program.coefficients} | {"rounder"}
    calls = {**dialect.kernel, **{helper.name: f"_{helper.name}(c, {{0}})" for helper in program.helpers}}
    spelling = dialect.language(calls, lambda name: f"c.{name}" if name in coefficients else name)
    taken = {f"_{helper.name}" for helper in program.helpers}
    shared, bodies = with_shared([_body(r, spelling) for r in program.routines], taken)
    return {
        "helpers": [_helper(h, spelling) for h in program.helpers],
        "shared": [_shared(body) for body in shared],
        "routines": [
            _routine(
                r, b, nan_without(program, r) if dialect.guarded else (), steps=r.name in program.conditioned
            )
            for r, b in zip(program.routines, bodies, strict=True)
        ],
    }


def nan_without(program: Program, r: Routine) -> tuple[str, ...]:
    """The parameters without a default that a routine must have without acceleration, too: else it is NaN."""
    behind = {q.symbol: {q.name} for q in program.parameters if q.default is None}
    for a in program.prepare:
        behind[a.target] = set().union(*(behind.get(s, set()) for s in a.value.free_symbols))
    used = set().union(*(a.value.free_symbols for a in r.assignments))
    names = set().union(*(behind.get(s, set()) for s in used)) - program.inertia
    return tuple(q.name for q in program.parameters if q.name in names)


def _body(r: Routine, spelling: Language) -> CodeBody:
    """The routine as lines; a result that is just a name needs none."""
    lines = _printed(r.assignments, spelling)
    results = [str(s) for s in r.results]
    named = {line.targets[0]: line.text for line in lines if line.text.removeprefix("c.").isidentifier()}
    kept = [line for line in lines if line.targets[0] not in results or line.targets[0] not in named]
    inputs = [s.name for x in r.inputs for s in x.symbols]
    return CodeBody(r.name, tuple(inputs), tuple(kept), tuple(named.get(name, name) for name in results))


def _printed(assignments: Iterable[Assignment], spelling: Language) -> list[Line]:
    return inlined(Line((a.target.name,), printed(a.value, spelling), a.note) for a in assignments)


def _lines(body: CodeBody, *, vector: bool) -> list[str]:
    """The lines of a function, which returns a tuple if it is a vector."""
    lines = []
    for k, line in enumerate(body.lines):
        lines += [f"# {part}" for part in textwrap.wrap(line.note, 100)]
        several = len(line.targets) > 1
        read = names_in(later.text for later in body.lines[k + 1 :]) | {*body.results} if several else set()
        lines += _assigned(line, read)
    if body.lines and body.lines[-1].targets == body.results and vector == (len(body.results) > 1):
        own = len(_assigned(body.lines[-1], {*body.results}))
        return [*lines[:-own], *broken("return ", body.lines[-1].text)]
    return [*lines, *_returned(body.results, vector)]


def _assigned(line: Line, read: set[str]) -> list[str]:
    """An assignment; unused ones of several values are left out."""
    if len(line.targets) == 1:
        return broken(f"{line.targets[0]} = ", line.text)
    if not read.intersection(line.targets[1:]):
        return [f"{line.targets[0]} = {line.text}[0]"]
    targets = ", ".join(name if name in read else "_" for name in line.targets)
    if len(f"{targets} = {line.text}") <= WIDTH:
        return [f"{targets} = {line.text}"]
    function, _, inputs = line.text.partition("(")
    return [f"{targets} = {function}(", f"    {inputs[:-1]}", ")"]


def _returned(results: Sequence[str], vector: bool) -> list[str]:
    text = f"return {', '.join(results)}" if len(results) > 1 or not vector else f"return ({results[0]},)"
    if len(text) <= WIDTH:
        return [text]
    return ["return (", *(f"    {name}," for name in results), ")"]


def _helper(helper: Helper, spelling: Language) -> dict[str, Any]:
    result = helper.assignments[-1].target.name
    body = CodeBody(
        helper.name, (helper.argument.name,), tuple(_printed(helper.assignments, spelling)), (result,)
    )
    return {
        "name": f"_{helper.name}",
        "inputs": ["c", helper.argument.name],
        "doc": sentence(helper.meaning),
        "lines": _lines(body, vector=False),
    }


def _shared(body: CodeBody) -> dict[str, Any]:
    last = body.lines[-1]
    whole = f"the values of {body.name[1:]}"
    meaning = (last.note or last.targets[-1]) if body.name == f"_{last.targets[-1]}" else whole
    doc = f"{sentence(meaning)[:-1]}, with what it takes; {body.callers} functions call this."
    return {
        "name": body.name,
        "inputs": ["c", *body.inputs],
        "doc": doc if len(doc) <= _LONGEST else doc.replace("; ", ".\n\n    ") + "\n    ",
        "lines": _lines(body, vector=len(body.results) > 1),
    }


def _routine(r: Routine, body: CodeBody, absent: Sequence[str], *, steps: bool) -> dict[str, Any]:
    names = [x.quantity.name for x in r.inputs]
    defaults = ["=0.0" if r.last_is_optional and x is r.inputs[-1] else "" for x in r.inputs]
    vectors = {x.quantity.name: x.length for x in r.inputs if x.length is not None}
    unpacked = [
        f"({', '.join(s.name for s in x.symbols)},) = {x.quantity.name}" for x in r.inputs if x.length
    ]
    options = [f"needs={quoted(r.requires)}"] if r.requires else []
    options += [f"nan_without={quoted(absent)}"] if absent else []
    options += [f"vectors={vectors}"] if vectors else []
    options += ["steps=True"] if steps else []
    return {
        "name": r.name,
        "formerly": r.formerly,
        "options": f"({', '.join(options)})" if options else "",
        "inputs": ["c", *(name + default for name, default in zip(names, defaults, strict=True))],
        "doc": _documentation(r),
        "lines": [*unpacked, *_lines(body, vector=bool(r.labels))],
    }


def _documentation(r: Routine) -> str:
    """Meaning, unit and columns; the meaning of the inputs is added when the module is loaded."""
    axis = f"; last axis ({', '.join(r.labels)})" if r.labels else ""
    doc = f"{sentence(r.meaning).removesuffix('.')} [{r.unit}]{axis}."
    if len(doc) <= _LONGEST:
        return doc
    return "\n    ".join([f"{sentence(r.meaning)}\n", *textwrap.wrap(f"In {r.unit}{axis}.", 100), ""])


def sentence(text: str) -> str:
    """The text as a sentence."""
    return f"{text[0].upper()}{text[1:]}."


def quoted(items: Sequence[str], before: str = "") -> str:
    """A tuple of strings in formatter style, after `before` on its line."""
    strings = [f'"{item}"' for item in items]
    line = f"({', '.join(strings)}{',' * (len(strings) == 1)})"
    return (
        line
        if len(before + line) <= _MARGIN
        else "".join(["(\n", *(f"    {string},\n" for string in strings), ")"])
    )
