"""What `module.py.jinja` may see: the Program as lines of Python, nothing symbolic left."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from typing import Any

import sympy as sp

from eccentric.emission.backends.expression import Language, printed
from eccentric.emission.backends.pairs import pair_functions, pair_text
from eccentric.emission.backends.text import (
    assigned,
    default_text,
    domain,
    number,
    rounds,
    splitting,
    used_series,
)
from eccentric.emission.program import (
    Assignment,
    AtMost,
    Helper,
    Input,
    Pick,
    Program,
    Root,
    Routine,
    Within,
    paired,
    polynomial,
)
from eccentric.model.quantity import Quantity
from eccentric.model.steps import Backward, Forward, Sgn

_NUMPY = {
    "sqrt": "_sqrt({0})",
    "fabs": "abs({0})",
    "sgn": "_sign({0})",
    "forward": "_forward({0})",
    "backward": "_forward(-({0}))",
    "exp": "_exp({0})",
    "at_most": "_at_most({0}, {1})",
    "within": "_within({0}, {1})",
    "in_single": "{0} if _single({1}) else {1}",
    "sine_ratio": "_sine_ratio({0})",
    "cosine": "_cosine({0})",
}
_MATH = {
    "sqrt": "math.sqrt({0})",
    "fabs": "abs({0})",
    "sin": "math.sin({0})",
    "cos": "math.cos({0})",
    "exp": "math.exp({0})",
    "rounded": "float(real({0}))",
    "leading": "_leading({0}, real)",
    "in_single": "{0} if real is np.float32 else {1}",
}


def view(program: Program, _: str) -> dict[str, Any]:
    """All that the templates of the NumPy module are filled with."""
    prepared = {a.target.name for a in program.prepare}
    optional = [q for q in program.parameters if q.default is None or q.default.free_symbols]
    paired_symbols = paired(program)
    pairs = {s.name for s in paired_symbols}

    def value_of(name: str) -> str:
        own = name in prepared | {q.name for q in optional}
        return f"{name}.high" if name in pairs else name if own else f"p.{name}"

    in_prepare, single_only = _language(_MATH, value_of), program.single_only
    coefficients = [*(s.name for s in program.coefficients), *(["rounder"] if rounds(program) else [])]
    return {
        "title": program.title,
        "public": [
            *sorted(name for name, _ in program.constants),
            "Parameters",
            *sorted(r.name for r in program.routines),
        ],
        "constants": [(name, _tuple([f'"{v}"' for v in values])) for name, values in program.constants],
        "defaults": program.defaults,
        "parameters": [_parameter(q) for q in program.parameters],
        "optional": _tuple([f'"{q.name}"' for q in optional]),
        "coefficients": coefficients,
        "sources": {c: "1.5 / np.finfo(real).eps" if c == "rounder" else value_of(c) for c in coefficients},
        "pairs": pair_functions(program),
        "leading": splitting(program),
        "prepare": [
            *(_default(q) for q in optional),
            *(
                line
                for a in program.prepare
                for line in _prepared(paired_symbols, single_only, a, in_prepare)
            ),
        ],
        "operations": _operations(program),
        "series": [_series(name) for name in used_series(program)],
        "helpers": [_helper(program, h, set(coefficients)) for h in program.helpers],
        "routines": [_routine(program, r, set(coefficients)) for r in program.routines],
        "states": [{"initial": repr(float(initial))} for _, initial in program.states],
        "names": _tuple([f'"{q.name}"' for q, _ in program.states]),
        "step": _step(program),
    }


def _prepared(
    pairs: frozenset[sp.Symbol], single_only: frozenset[sp.Symbol], a: Assignment, language: Language
) -> list[str]:
    """An assignment as formatters spell it: a choice that is too long takes a line for each part."""
    target = a.target.name
    own = a.target in pairs
    value = pair_text(a.value, pairs, language, "_{}".format) if own else printed(a.value, language)
    value += " if real is np.float32 else math.nan" if a.target in single_only else ""
    if len(f"{target} = {value}") <= 106 or " if " not in value:
        return [f"{target} = {value}"]
    first, _, rest = value.partition(" if ")
    condition, _, other = rest.partition(" else ")
    if len(value) <= 102:
        return [f"{target} = (", f"    {value}", ")"]
    return [f"{target} = (", f"    {first}", f"    if {condition}", f"    else {other}", ")"]


def _step(program: Program) -> dict[str, Any]:
    """The sequential pass of the hidden states along a log; nothing for a model without."""
    if not program.states:
        return {}
    stepped = next(r for r in program.routines if r.name == "next_state")
    states = [q.name for q, _ in program.states]
    names = [x.quantity.name for x in stepped.inputs]
    passed = [f"state[{states.index(name)}]" if name in states else name for name in names]
    inputs = [n for n in names if n not in states]
    given = ", ".join(f'"{name}": {name}' for name in inputs)
    return {"inputs": inputs, "named": f"{{{given}}}", "call": ", ".join(passed)}


def _language(calls: dict[str, str], symbol: Any) -> Language:
    def branches(pairs: list[tuple[str, str]]) -> str:
        text = pairs[-1][0]
        for value, condition in reversed(pairs[:-1]):
            text = f"{value} if {condition} else {text}"
        return text

    return Language(
        symbol=symbol,
        number=number,
        call=lambda name, arguments: calls[name].format(*arguments),
        pick=lambda a, relation, b, x, y: f"_choose({a} {relation} {b}, {x}, {y})",
        branches=branches,
    )


def _default(q: Quantity) -> str:
    value = (
        "math.nan" if q.default is None else printed(q.default, _language(_MATH, lambda name: f"p.{name}"))
    )
    return f"{q.name} = {value} if p.{q.name} is None else p.{q.name}"


def _parameter(q: Quantity) -> dict[str, str]:
    required, lowest, highest = domain(q)
    symbolic = q.default is not None and q.default.free_symbols
    note = f", {q.default} if None" if symbolic else ", needed with alpha_m" if q.default is None else ""
    equation = f", eq. {q.equation}" if q.equation else ""
    return {
        "name": q.name,
        "type": "float" if q.default is not None and not symbolic else "float | None",
        "default": "None" if q.default is None or symbolic else default_text(q),
        "doc": f"{q.meaning} [{q.unit}]{equation}{note}",
        "domain": required,
        "lowest": lowest,
        "highest": highest,
    }


def _tuple(items: list[str], indent: str = "") -> str:
    """A tuple as formatters spell it."""
    line = f"({items[0]},)" if len(items) == 1 else f"({', '.join(items)})"
    return (
        line
        if len(line) <= 90
        else f"(\n{''.join(f'{indent}    {item},{chr(10)}' for item in items)}{indent})"
    )


def _series(name: str) -> dict[str, Any]:
    def horner(first: str, second: str, *rest: str) -> list[str]:
        return [f"y = {first} * x {_signed(second)}", *(f"y = y * x {_signed(c)}" for c in rest)]

    single, double = polynomial(name, True), polynomial(name, False)
    function = {"sine_ratio": "sin(h)/h - 1", "cosine": "cos(h)"}[name]
    return {
        "name": name,
        "rest": " + 1.0" if name == "cosine" else "",
        "single": horner(*single.coefficients),
        "double": horner(*double.coefficients),
        "doc": f"{function} for |h| within a quarter turn, a minimax polynomial in h^2; error"
        f" {single.error} and {double.error}.",
    }


def _signed(decimal: str) -> str:
    return f"- {decimal[1:]}" if decimal.startswith("-") else f"+ {decimal}"


def _operations(program: Program) -> set[str]:
    """The module's own functions that the routines call."""
    kinds = {Root: "sqrt", Sgn: "sgn", Forward: "forward", Backward: "forward", sp.exp: "exp"}
    kinds |= {AtMost: "at_most", Within: "within", Pick: "choose"}
    hot = program.hot()
    return {name for kind, name in kinds.items() if any(a.value.has(kind) for a in hot)}


def _lines(program: Program, assignments: Iterable[Assignment], coefficients: set[str]) -> list[str]:
    calls = _NUMPY | {helper.name: f"_{helper.name}(c, {{0}})" for helper in program.helpers}
    language = _language(calls, lambda name: f"c.{name}" if name in coefficients else name)
    return assigned(assignments, lambda to, value: f"{to} = {printed(value, language)}", "# {}".format)


def _helper(program: Program, helper: Helper, coefficients: set[str]) -> dict[str, Any]:
    *lines, last = _lines(program, helper.assignments, coefficients)
    return {
        "name": helper.name,
        "argument": helper.argument.name,
        "doc": f"{helper.meaning[0].upper()}{helper.meaning[1:]}.",
        "lines": lines,
        "result": last.partition(" = ")[2],
    }


def _routine(program: Program, r: Routine, coefficients: set[str]) -> dict[str, Any]:
    lines = _lines(program, r.assignments, coefficients)
    arguments = [f"{x.quantity.name} [{x.quantity.unit}]: {x.quantity.meaning}" for x in r.inputs]
    shape = f"last axis ({', '.join(r.labels)})" if r.labels else "shape of the broadcast inputs"
    doc = f"{r.meaning[0].upper()}{r.meaning[1:]} [{r.unit}]; {shape}."
    if len(doc) > 98:
        doc = f"{r.meaning[0].upper()}{r.meaning[1:]}.\n\n    {_filled(f'In {r.unit}; {shape}.')}"
    if arguments:
        doc += "\n\n    " + "\n    ".join(arguments)
    if "\n" in doc:
        doc += "\n    "
    inputs = [_input(x, r) for x in r.inputs]
    return {
        "name": r.name,
        "inputs": inputs,
        "unpacked": [s.name for x in r.inputs for s in x.symbols],
        "lines": lines,
        "results": _tuple([s.name for s in r.results], "    "),
        "width": len(r.results) if r.labels else 0,
        "doc": doc,
        "requires": _tuple([f'"{name}"' for name in r.requires]) if r.requires else "",
        "passed": _tuple([x["call"] for x in inputs]),
    }


def _filled(text: str) -> str:
    return "\n    ".join(textwrap.wrap(text, 100))


def _input(x: Input, r: Routine) -> dict[str, str]:
    name = x.quantity.name
    call = name if x.length is None else f"*np.moveaxis(np.asarray({name}), -1, 0)"
    return {"name": name, "default": " = 0.0" if r.requires and x is r.inputs[-1] else "", "call": call}
