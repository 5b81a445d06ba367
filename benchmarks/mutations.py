"""Small changes to a source text that a good test suite notices: mutants of Python files and Jinja templates.

A change replaces some bytes and leaves the rest of the file as it is.  Text for people (docstrings, comments,
messages, style sheets), annotations, imports, decorators and `raise` statements are not changed.
"""

from __future__ import annotations

import ast
import itertools
import random
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

OPERATORS = {
    ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*"), ast.Pow: ("**", "*"),
    ast.FloorDiv: ("//", "/"), ast.Mod: ("%", "*"), ast.MatMult: ("@", "*"),
    ast.BitAnd: ("&", "|"), ast.BitOr: ("|", "&"),
}  # fmt: skip
COMPARISONS = {
    ast.Lt: ("<", "<="), ast.LtE: ("<=", "<"), ast.Gt: (">", ">="), ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="), ast.NotEq: ("!=", "=="), ast.In: ("in", "not in"), ast.NotIn: (r"not\s+in", "in"),
    ast.Is: ("is", "is not"), ast.IsNot: (r"is\s+not", "is"),
}  # fmt: skip
_PAIRS = (
    "min max",
    "minimum maximum",
    "fmin fmax",
    "nanmin nanmax",
    "amin amax",
    "argmin argmax",
    "floor ceil",
)
_PAIRS = (*_PAIRS, "any all", "lower upper", "Min Max")
BOUNDS = {one: other for a, b in map(str.split, _PAIRS) for one, other in ((a, b), (b, a))}
KINDS = ("operator", "constant", "sign", "bound", "return", "arguments")
"""A bound is < or <=, min or max; an operator any other, also `not` and a negated condition of a template."""
_TYPED = {
    "isinstance",
    "issubclass",
    "getattr",
    "setattr",
    "hasattr",
    "cast",
    "min",
    "max",
    "minimum",
    "maximum",
}
"""Calls whose arguments commute, or fail at once the other way round."""
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)
_STYLES = (".css.jinja",)


@dataclass(frozen=True)
class Mutant:
    """One change.

    Attributes:
        file, line: where; the path is relative to the root.
        kind: one of KINDS.
        start, end, text: the bytes that are replaced, and by what.
        span: first and last line of the statement; a test that executes one of them can notice.
        local: inside a function; all else is executed when the module is imported.
        name: the constant of the module that is concerned, if any; a test that executes a line with it can notice.
    """

    file: str
    line: int
    kind: str
    start: int
    end: int
    text: str
    span: tuple[int, int]
    local: bool = True
    name: str = ""

    def applied(self, source: bytes) -> bytes:
        """The changed source."""
        return source[: self.start] + self.text.encode() + source[self.end :]

    def shown(self, source: bytes) -> tuple[str, str]:
        """The lines concerned, before and after, without indentation."""
        first = source.rfind(b"\n", 0, self.start) + 1
        last = source.find(b"\n", self.end)
        last = len(source) if last < 0 else last
        after = source[first : self.start] + self.text.encode() + source[self.end : last]
        return _stripped(source[first:last]), _stripped(after)


def _stripped(text: bytes) -> str:
    return "\n".join(map(str.strip, text.decode().splitlines()))


def rooms(root: Path) -> dict[str, list[str]]:
    """The files of each room: a package directly below `eccentric`, its loose modules, derivations, templates."""
    found: dict[str, list[str]] = {}
    for path in sorted((root / "eccentric").rglob("*.py")):
        parts = path.relative_to(root).parts
        found.setdefault(parts[1] if len(parts) > 2 else "eccentric", []).append("/".join(parts))
    for name, pattern in (("derivations", "*.py"), ("templates", "*/*.jinja")):
        files = sorted((root / name).glob(pattern))
        found[name] = [str(p.relative_to(root)) for p in files if not p.name.endswith(_STYLES)]
    return {name: files for name, files in found.items() if files}


def drawn(root: Path, number: int, seed: int, only: set[str] | None = None) -> list[tuple[str, Mutant]]:
    """Mutants with their rooms, in proportion to the lines of each room; fewer are the first of more.

    In a room the kinds have the same chance, and so have the lines with that kind; a line has at most one mutant.
    """
    names = rooms(root)
    sources = {file: (root / file).read_bytes() for files in names.values() for file in files}
    size = {name: sum(lines_of_code(f, sources[f]) for f in files) for name, files in names.items()}
    streams = {
        name: _stream(names[name], sources, random.Random(f"{seed} {name}"))  # noqa: S311 - a draw, no secret
        for name in names
    }
    counts, found = dict.fromkeys(names, 0), []
    while len(found) < number and streams:
        room = max(streams, key=lambda name: size[name] / (2 * counts[name] + 1))
        mutant = next(streams[room], None)
        if mutant is None:
            del streams[room]
            continue
        counts[room] += 1
        found.append((room, mutant))
    return [(room, mutant) for room, mutant in found if not only or room in only]


def _stream(files: list[str], sources: Mapping[str, bytes], rng: random.Random) -> Iterator[Mutant]:
    """The mutants of a room in random order, each of another line."""
    places: dict[str, dict[tuple[str, int], list[Mutant]]] = {}
    for file in files:
        for mutant in mutants(file, sources[file]):
            places.setdefault(mutant.kind, {}).setdefault((file, mutant.line), []).append(mutant)
    orders = {kind: sorted(places[kind]) for kind in KINDS if kind in places}
    for order in orders.values():
        rng.shuffle(order)
    taken = set()
    while orders:
        kind = rng.choice(list(orders))
        place = orders[kind].pop()
        mutant = rng.choice(places[kind][place])
        if not orders[kind]:
            del orders[kind]
        if place not in taken and _differs(mutant, sources[mutant.file]):
            taken.add(place)
            yield mutant


def _differs(mutant: Mutant, source: bytes) -> bool:
    """Whether the changed file is a program, and another one."""
    if not mutant.file.endswith(".py"):
        return True
    try:
        return ast.dump(ast.parse(mutant.applied(source))) != ast.dump(ast.parse(source))
    except SyntaxError:
        return False


def lines_of_code(file: str, source: bytes) -> int:
    """Lines with code: neither empty nor of comments or docstrings alone."""
    lines = {n for n, line in enumerate(source.splitlines(), 1) if line.strip()}
    if not file.endswith(".py"):
        return len(lines)
    lines -= {n for n, line in enumerate(source.splitlines(), 1) if line.lstrip().startswith(b"#")}
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Expr) and _is_text(node.value):
            lines -= {*range(node.lineno, (node.end_lineno or node.lineno) + 1)}
    return len(lines)


def mutants(file: str, source: bytes) -> list[Mutant]:
    """All mutants of a file."""
    return _Python(file, source).found if file.endswith(".py") else _of_template(file, source)


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str))


def _is_strict(node: ast.AST) -> bool:
    """Whether a node is `strict` of `zip`, a check of what is equally long anyway."""
    return isinstance(node, ast.keyword) and node.arg == "strict"


class _Python:
    """The mutants of a Python file."""

    def __init__(self, file: str, source: bytes) -> None:
        self.file, self.source, self.found = file, source, list[Mutant]()
        self._starts = [0]
        for line in source.splitlines(keepends=True):
            self._starts.append(self._starts[-1] + len(line))
        for node in ast.parse(source).body:
            target = node.targets[0] if isinstance(node, ast.Assign) else getattr(node, "target", None)
            self._name = target.id if isinstance(target, ast.Name) else ""
            self._walk(node, (1, 1), local=False)

    def _walk(self, node: ast.AST, span: tuple[int, int], *, local: bool) -> None:
        if isinstance(
            node, ast.Import | ast.ImportFrom | ast.Raise | ast.JoinedStr | ast.Global | ast.Nonlocal
        ):
            return
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            return
        if isinstance(node, ast.Assign) and "__all__" in map(ast.unparse, node.targets):
            return
        if isinstance(node, ast.stmt):
            body = getattr(node, "body", None)
            end = max(node.lineno, body[0].lineno - 1) if body else node.end_lineno or node.lineno
            span = node.lineno, end
        for start, stop, kind, text in self._changes(node, local=local):
            line = self.source.count(b"\n", 0, start) + 1
            self.found.append(Mutant(self.file, line, kind, start, stop, text, span, local, self._name))
        if isinstance(node, _FUNCTIONS):
            inner = node.body[0].lineno, node.end_lineno or node.lineno
            for default in (*node.args.defaults, *node.args.kw_defaults):
                if default:
                    self._walk(default, inner, local=True)
            for child in node.body:
                self._walk(child, span, local=True)
            return
        for name, value in ast.iter_fields(node):
            if name in {"annotation", "decorator_list"} or (name == "value" and _is_strict(node)):
                continue
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST):
                    self._walk(child, span, local=local)

    def _range(self, node: Any) -> tuple[int, int]:
        return (
            self._starts[node.lineno - 1] + node.col_offset,
            self._starts[node.end_lineno - 1] + node.end_col_offset,
        )

    def _text(self, node: ast.AST) -> str:
        return self.source[slice(*self._range(node))].decode()

    def _between(self, left: ast.AST, right: ast.AST, token: str) -> tuple[int, int] | None:
        """Where a token is, between two nodes; comments there are passed over."""
        start, stop = self._range(left)[1], self._range(right)[0]
        text = re.sub(rb"#[^\n]*", lambda m: b" " * len(m[0]), self.source[start:stop])
        found = re.search(token.encode(), text)
        return found and (start + found.start(), start + found.end())

    def _changes(self, node: ast.AST, *, local: bool) -> Iterator[tuple[int, int, str, str]]:
        """Start, end, kind and new text of each change to a node, not to those below it."""
        match node:
            case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
                token, other = OPERATORS[type(op)]
                types = isinstance(op, ast.BitOr) and not local
                if not (types or _is_text(left) or _is_text(right)) and (
                    at := self._between(left, right, re.escape(token))
                ):
                    yield *at, "operator", other
            case ast.AugAssign(target=target, op=op, value=value) if type(op) in OPERATORS:
                token, other = OPERATORS[type(op)]
                if not _is_text(value) and (at := self._between(target, value, re.escape(token))):
                    yield *at, "operator", other
            case ast.Compare():
                operands = [node.left, *node.comparators]
                for left, op, right in zip(operands, node.ops, node.comparators, strict=False):
                    token, other = COMPARISONS[type(op)]
                    if at := self._between(left, right, token):
                        yield *at, "bound" if token[0] in "<>" else "operator", other
            case ast.BoolOp(op=op, values=values):
                token, other = ("and", "or") if isinstance(op, ast.And) else ("or", "and")
                for left, right in itertools.pairwise(values):
                    if at := self._between(left, right, rf"\b{token}\b"):
                        yield *at, "operator", other
            case ast.Constant(value=bool(value)):
                yield *self._range(node), "constant", str(not value)
            case ast.Constant(value=int(value)):
                yield *self._range(node), "constant", str(value + 1)
            case ast.Constant(value=float(value)):
                yield *self._range(node), "constant", repr(2 * value or 1.0)
            case ast.UnaryOp(op=ast.USub()):
                start, _ = self._range(node)
                yield start, start + 1, "sign", "+"
            case ast.UnaryOp(op=ast.Not()):
                start, stop = self._range(node)
                length = len(self.source[start:stop]) - len(
                    self.source[start:stop].removeprefix(b"not").lstrip()
                )
                yield start, start + length, "operator", ""
            case ast.Return(value=ast.BinOp(op=ast.Add() | ast.Sub() | ast.Mult() | ast.Div()) as value):
                if not any(map(_is_text, ast.walk(node))):
                    yield *self._range(value), "sign", f"-({self._text(value)})"
            case ast.Call():
                yield from self._of_call(node)
            case ast.FunctionDef() | ast.AsyncFunctionDef():
                yield from self._returns(node)

    def _of_call(self, node: ast.Call) -> Iterator[tuple[int, int, str, str]]:
        name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        if name in BOUNDS:
            _, stop = self._range(node.func)
            yield stop - len(name), stop, "bound", BOUNDS[name]
        if name in _TYPED:
            return
        for one, two in itertools.pairwise(node.args):
            a, b = self._text(one), self._text(two)
            if a != b and not isinstance(one, ast.Starred) and not isinstance(two, ast.Starred):
                (start, first), (second, stop) = self._range(one), self._range(two)
                yield start, stop, "arguments", f"{b}{self.source[first:second].decode()}{a}"

    def _returns(self, node: ast.FunctionDef | ast.AsyncFunctionDef) -> Iterator[tuple[int, int, str, str]]:
        """An early return: nothing, the first argument, or a truth value where one is announced."""
        body = (
            node.body[1:]
            if isinstance(node.body[0], ast.Expr) and _is_text(node.body[0].value)
            else node.body
        )
        if not body or isinstance(body[0], ast.Raise | ast.Pass) or ast.unparse(body[0]) in {"...", "return"}:
            return
        first = min([body[0].lineno, *(d.lineno for d in getattr(body[0], "decorator_list", []))])
        indent = " " * body[0].col_offset
        start = self._starts[first - 1] + len(indent)
        if self.source[self._starts[first - 1] : start].strip():  # behind the colon
            return
        announced = ast.unparse(node.returns) if node.returns else ""
        names = [a.arg for a in (*node.args.posonlyargs, *node.args.args) if a.arg not in {"self", "cls"}]
        values = ["True", "False"] if announced == "bool" else ["None"]
        if announced not in {"bool", "None"}:
            values += names[:1]
        for value in values:
            yield start, start, "return", f"return {value}\n{indent}"


_TAG = re.compile(r"{{.*?}}|{%.*?%}", re.DOTALL)
_QUIET = {
    "py": re.compile(r'"""(?:.|\n)*?"""|(?:(?<=\s)|^)#[^\n]*|"[^"\n]*"', re.MULTILINE),
    "c": re.compile(r'/\*(?:.|\n)*?\*/|//[^\n]*|#\s*include[^\n]*|"[^"\n]*"'),
    "html": re.compile(r"(?:.|\n)*"),
}
_SWAPS = {
    "+": "-",
    "-": "+",
    "*": "/",
    "/": "*",
    "<": "<=",
    "<=": "<",
    ">": ">=",
    ">=": ">",
    "==": "!=",
    "!=": "==",
}
_SWAPPED = re.compile(r"(?<= )(?:[-+*/]|[<>=!]=|[<>])(?= )")
_LOGIC = {"&&": "||", "||": "&&", "and": "or", "or": "and"}
_LOGICAL = re.compile(r"(?<= )(?:&&|\|\||and|or)(?= )")
_NUMBER = re.compile(r"(?<![\w.\0])\d+(?:\.\d*)?(?:e[-+]?\d+)?(?=[uUfF]?(?![\w.\0]))")
_MINUS = re.compile(r"(?<=[(\[=,:?{ ])-(?=[\w\0(])")
_NAMES = re.compile(rf"\b(?:{'|'.join(BOUNDS)})(?=\()", re.IGNORECASE)
_NOT = re.compile(r"\bnot (?!in\b)|(?<=\()!(?=[\w(])")
_IF = re.compile(r"{%-?\s*(?:el)?if\s+(.*?)\s*-?%}")


def _of_template(file: str, source: bytes) -> list[Mutant]:
    """The mutants of a template: of its conditions and expressions, and of the code that it writes."""
    text = source.decode()
    blank = _blanked(re.compile(r"{#(?:.|\n)*?#}"), text)
    suffix = file.removesuffix(".jinja").rpartition(".")[2]
    quiet = _QUIET.get({"h": "c", "js": "c"}.get(suffix, suffix), _QUIET["html"])
    code = _blanked(quiet, _blanked(_TAG, blank))
    kept = [False] * len(text)
    for tag in _TAG.finditer(blank):
        kept[tag.start() : tag.end()] = [True] * len(tag[0])
    tags = "".join(c if keep or c == "\n" else "\0" for c, keep in zip(blank, kept, strict=True))
    tags = _blanked(re.compile(r"\"[^\"\n]*\"|'[^'\n]*'"), tags)
    found = []

    def add(start: int, stop: int, kind: str, new: str) -> None:
        line = text.count("\n", 0, start) + 1
        ends = (len(text[:start].encode()), len(text[:stop].encode()))
        found.append(Mutant(file, line, kind, *ends, new, (line, line)))

    for match in _IF.finditer(tags):
        add(*match.span(1), "operator", f"not ({text[slice(*match.span(1))]})")
    for part in (tags, code):
        for match in _SWAPPED.finditer(part):
            add(*match.span(), "bound" if match[0][0] in "<>" else "operator", _SWAPS[match[0]])
        for match in _LOGICAL.finditer(part):
            add(*match.span(), "operator", _LOGIC[match[0]])
        for match in _NUMBER.finditer(part):
            number = match[0]
            add(
                *match.span(),
                "constant",
                str(int(number) + 1) if number.isdigit() else repr(2 * float(number) or 1.0),
            )
        for match in _MINUS.finditer(part):
            add(*match.span(), "sign", "+")
        for match in _NAMES.finditer(part):
            if match[0] in BOUNDS:
                add(*match.span(), "bound", BOUNDS[match[0]])
        for match in _NOT.finditer(part):
            add(*match.span(), "operator", "")
    return found


def _blanked(pattern: re.Pattern[str], text: str) -> str:
    return pattern.sub(lambda m: re.sub(r"[^\n]", "\0", m[0]), text)
