"""What `header.h.jinja` and `source.c.jinja` may see: the Program as lines of C, nothing symbolic left."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable
from typing import Any

import sympy as sp

from eccentric.emit.constants import evaluate_prepare
from eccentric.emit.expression import Language, printed
from eccentric.emit.pairs import pair_functions, pair_text, paired
from eccentric.emit.primitive import ROUNDER, Root, Size, Within
from eccentric.emit.program import Assignment, Helper, Input, Program, Routine
from eccentric.emit.series import polynomial
from eccentric.emit.staged import staged
from eccentric.emit.text import EXACT_HALF_TURNS, assigned, number, plain, splitting, used_series
from eccentric.model.quantity import Quantity
from eccentric.model.steps import Backward, Forward, Sgn

_WIDTH = 110

_REAL = {
    "sqrt": "REAL_SQRT({0})",
    "fabs": "REAL_FABS({0})",
    "floor": "REAL_FLOOR({0})",
    "sgn": "MODEL_sgn({0})",
    "forward": "MODEL_forward({0})",
    "backward": "MODEL_forward(-({0}))",
    "exp": "REAL_EXP({0})",
    "at_most": "(({0} > {1}) ? {1} : {0})",
    "within": "MODEL_within({0}, {1})",
    "in_single": "(ECCENTRIC_PRECISION == 1) ? ({0}) : {1}",
    "sine_ratio": "MODEL_sine_ratio({0})",
    "cosine": "MODEL_cosine({0})",
}
_DOUBLE = {
    "sqrt": "sqrt({0})",
    "fabs": "fabs({0})",
    "sin": "sin({0})",
    "cos": "cos({0})",
    "exp": "exp({0})",
    "rounded": "(double)(real)({0})",
    "leading": "MODEL_leading({0})",
    "in_single": "(ECCENTRIC_PRECISION == 1) ? {0} : {1}",
}
# Written so that NaN goes in and NaN comes out; one comparison a line is one instruction of a vector unit.
_HELPERS = {
    "sgn": (
        "const real x",
        ["return (x > REAL(0.0)) ? REAL(1.0) : ((x < REAL(0.0)) ? REAL(-1.0) : (x + REAL(0.0)));"],
    ),
    "forward": ("const real x", ["return (x > REAL(0.0)) ? REAL(1.0) : ((x <= REAL(0.0)) ? REAL(0.0) : x);"]),
    "within": (
        "const real x, const real most",
        ["const real below = (x > most) ? most : x;", "return (below < -most) ? -most : below;"],
    ),
}
_NEEDS = {"sgn": (Sgn,), "forward": (Forward, Backward), "within": (Within,)}


def view(program: Program, banner: str, digest: str) -> dict[str, Any]:
    """All that the templates of header and source are filled with."""
    prepared = {a.target.name for a in program.prepare}
    paired_symbols = paired(program)
    pairs = {s.name for s in paired_symbols}

    def value_of(name: str) -> str:
        return f"{name}.high" if name in pairs else name if name in prepared else f"p->{name}"

    in_prepare = _language(program, _DOUBLE, value_of, "{}")
    coefficients = {s.name for s in program.coefficients}
    values = {single: evaluate_prepare(program, single) for single in (True, False)}
    expressions = [a.value for a in program.hot()]
    helpers = [name for name, kinds in _NEEDS.items() if any(e.has(*kinds) for e in expressions)]
    macros = _macros(program)
    notes = dict(program.notes)
    called = [r.name + ending for r in program.routines for ending in ("", "_n")[: 2 if r.inputs else 1]]
    return {
        "names": ["prepare", "default", *called, *(["initial_state", "step"] if program.states else [])],
        "exponential": any(e.has(sp.exp) for e in expressions),
        "banner": "\n".join(["/*", *(f" * {line}".rstrip() for line in banner.splitlines()), " */"]),
        "name": program.name,
        "guard": program.name.upper(),
        "digest": f"0x{digest}UL",
        "parameters": [
            _parameter(q, values[False][q.name].replace("NAN", "(double)NAN")) for q in program.parameters
        ],
        "valid": _valid(program),
        "promises": program.promises,
        "bounded": "fastest" in {s.name for s in program.coefficients},
        "defaults": program.defaults,
        "coefficients": [
            {
                "name": s.name,
                "source": value_of(s.name),
                "single": f"(real)({values[True][s.name]})",
                "double": values[False][s.name].replace("NAN", "(real)NAN"),
                "doc": notes.get(s.name, ""),
            }
            for s in program.coefficients
        ],
        "single": [(name, single) for name, single, _ in macros],
        "double": [(name, double) for name, _, double in macros],
        "macros": [name.removesuffix("(x)") for name, _, _ in macros],
        "helpers": [
            dict(zip(("name", "arguments", "lines"), (name, *_HELPERS[name]), strict=True))
            for name in helpers
        ],
        "series": [_series(name) for name in used_series(program)],
        "leading": splitting(program),
        "pairs": pair_functions(program),
        "prepare": _code(_prepared(program, paired_symbols, a, in_prepare) for a in program.prepare),
        "helpers_of_angle": [_helper(program, h, coefficients) for h in program.helpers],
        "staged": any(staged(r).angles for r in program.routines),
        "routines": [_routine(program, r, coefficients) for r in program.routines],
        "states": [
            {"name": q.name, "doc": plain(f"{q.meaning} [{q.unit}]"), "initial": number(str(float(initial)))}
            for q, initial in program.states
        ],
        "step": _step(program),
    }


def _prepared(program: Program, pairs: frozenset[sp.Symbol], a: Assignment, language: Language) -> str:
    if a.target not in pairs:
        return f"const double {a.target.name} = {printed(a.value, language)};"
    value = pair_text(a.value, pairs, language, lambda name: f"{program.name}_{name}")
    return f"const {program.name}_pair {a.target.name} = {value};"


def _step(program: Program) -> dict[str, Any]:
    """The step of the hidden states, which the caller owns; nothing for a model without."""
    if not program.states:
        return {}
    stepped = next(r for r in program.routines if r.name == "next_state")
    states = {q.name for q, _ in program.states}
    given = [x for x in stepped.inputs if x.quantity.name not in states]
    names = [x.quantity.name for x in stepped.inputs]
    passed = [f"state->{name}" if name in states else name for name in names]
    own, coefficients = f"{program.name}_step", f"const {program.name}_coefficients *c"
    return {
        "inputs": [
            {"name": x.quantity.name, "doc": f"{x.quantity.meaning} [{x.quantity.unit}]"} for x in given
        ],
        "signature": _wrapped(
            "void",
            own,
            [f"{program.name}_state *state", *(_argument(x, "ECCENTRIC_REAL") for x in given), coefficients],
        ),
        "meaning": stepped.meaning,
        "call": f"{program.name}_next_state({', '.join([*passed, 'next', 'c'])});",
    }


def _macros(program: Program) -> list[tuple[str, str, str]]:
    """(macro, its meaning in single, in double), those that the routines use."""
    expressions = [a.value for a in program.hot()]
    used = [
        ("REAL_SQRT(x)", Root, "sqrt"),
        ("REAL_FABS(x)", Size, "fabs"),
        ("REAL_EXP(x)", sp.exp, "exp"),
    ]
    found = [("REAL(x)", "x##f", "x")]
    found += [
        (macro, f"{name}f(x)", f"{name}(x)")
        for macro, op, name in used
        if any(e.has(op) for e in expressions)
    ]
    if any(ROUNDER in e.free_symbols for e in expressions):
        found.append(("REAL_ROUNDER", "12582912.0f", "6755399441055744.0"))
    libm = {"sine_ratio": "sin", "cosine": "cos"}
    names = [libm[series] for series in used_series(program)]
    found += [(f"REAL_{name.upper()}(x)", f"{name}f(x)", f"{name}(x)") for name in names]
    return found


def _language(program: Program, calls: dict[str, str], symbol: Any, literal: str) -> Language:
    def branches(pairs: list[tuple[str, str]]) -> str:
        text = pairs[-1][0]
        for value, condition in reversed(pairs[:-1]):
            text = f"({condition}) ? {value} : ({text})"
        return text

    return Language(
        symbol=symbol,
        number=lambda decimal: literal.format(number(decimal)),
        call=lambda name, arguments: calls[name].replace("MODEL", program.name).format(*arguments),
        pick=lambda a, relation, b, x, y: f"(({a} {relation} {b}) ? {x} : {y})",
        branches=branches,
    )


def _parameter(q: Quantity, value: str) -> dict[str, str]:
    equation = f", eq. {q.equation}" if q.equation else ""
    note = ", no default" if q.default is None else ""
    if q.default is not None and q.default.free_symbols:
        note = f", by default {q.default}: set it along".replace("*", " ")
    return {
        "name": q.name,
        "unit": q.unit,
        "default": value,
        "doc": f"{q.meaning} [{q.unit}]{equation}{note}",
    }


def _valid(program: Program) -> str:
    kinds = {
        kind: [q.name for q in program.parameters if q.domain == kind]
        for kind in ("positive", "tilt", "real")
    }
    words = {"positive": "positive", "tilt": "from 0 to pi/2", "real": "any finite number"}
    named = [f"{', '.join(names)} {words[kind]}" for kind, names in kinds.items() if names]
    return "; ".join([*named, "the others not negative"])


def _series(name: str) -> dict[str, Any]:
    def horner(single: bool) -> list[str]:
        first, *rest = polynomial(name, single).coefficients
        lines = [f"real y = REAL({first});", *(f"y = y * x + REAL({c});" for c in rest)]
        return [*lines, f"return y * x{' + REAL(1.0)' if name == 'cosine' else ''};"]

    single, double = polynomial(name, True), polynomial(name, False)
    function, libm = {
        "sine_ratio": ("sin(h)/h - 1", "(h == REAL(0.0)) ? REAL(0.0) : (REAL_SIN(h) / h - REAL(1.0))"),
        "cosine": ("cos(h)", "REAL_COS(h)"),
    }[name]
    return {
        "name": name,
        "single": horner(True),
        "double": horner(False),
        "libm": libm,
        "doc": f"{function}, |h| within a quarter turn: minimax in x = h^2, error {single.error}"
        f" (float), {double.error} (double).",
    }


def _routine(program: Program, r: Routine, coefficients: set[str]) -> dict[str, Any]:
    results = {s.name: k for k, s in enumerate(r.results)}

    def line(target: str, text: str) -> str:
        if target not in results:
            return f"const real {target} = {text};"
        return f"out[{results[target]}] = {text};" if r.labels else f"return {text};"

    unpack = [
        f"const real {symbol.name} = {x.quantity.name}[{k}];"
        for x in r.inputs
        if x.length is not None
        for k, symbol in enumerate(x.symbols)
    ]
    own, parts = f"{program.name}_{r.name}", staged(r)
    ready = [a.target.name for a in parts.bent]
    coefficient_argument = f"const {program.name}_coefficients *c"
    out = ["ECCENTRIC_REAL *out"] if r.labels else []
    width = len(r.labels)
    reduced = f", reduced exactly up to {EXACT_HALF_TURNS}" if parts.angles else ""
    kernel = [*(_argument(x, "real") for x in parts.inputs), *(f"real {name}" for name in ready)]
    passed = [*(x.quantity.name for x in parts.inputs), *ready, *(["out"] if r.labels else []), "c"]
    index = "first + k" if parts.angles else "k"
    each = [*(_element(x, index) for x in parts.inputs), *(f"{name}[k]" for name in ready)]
    to, given = f"&out[{width}u * {f'({index})' if parts.angles else index}]", ", ".join(each)
    return {
        "name": r.name,
        "doc": f"{r.meaning[0].upper()}{r.meaning[1:]}.",
        "unit": r.unit,
        "inputs": [
            {
                "name": x.quantity.name,
                "doc": f"{x.quantity.meaning} [{x.quantity.unit}]"
                + (reduced if x.quantity.name == "theta_m" else ""),
            }
            for x in r.inputs
        ],
        "out": _filled(
            f"@param[out] out  {width} value{'s' * (width > 1)}: {', '.join(r.labels)} [{r.unit}]"
            if r.labels
            else ""
        ),
        "width": width,
        "kernel": _wrapped(
            f"REAL_INLINE {'void' if r.labels else 'real'}",
            f"{own}_at",
            [*kernel, *(["real *out"] if r.labels else []), coefficient_argument],
        ),
        "call": [
            *_code(assigned((*parts.angles, *parts.bent), _printer(program, coefficients, line), "".format)),
            f"{'' if r.labels else 'return '}{own}_at({', '.join(passed)});",
        ],
        "signature": _wrapped(
            "void" if r.labels else "ECCENTRIC_REAL",
            own,
            [*(_argument(x, "ECCENTRIC_REAL") for x in r.inputs), *out, coefficient_argument],
        ),
        "array_signature": _wrapped(
            "void",
            f"{own}_n",
            [
                "size_t n",
                *(f"const ECCENTRIC_REAL *{x.quantity.name}" for x in r.inputs),
                "ECCENTRIC_REAL *out",
                coefficient_argument,
            ],
        ),
        "array_call": _code(
            [f"{own}_at({given}, {to}, &own);" if r.labels else f"out[{index}] = {own}_at({given}, &own);"],
            12,
        ),
        "buffers": [a.target.name for a in (*parts.angles, *parts.bent)],
        "stages": [
            [
                f"{a.target.name}[k] = {program.name}_{a.value.args[0]}({a.value.args[1]}[{at}], &own);"
                for a in stage
            ]
            for stage, at in ((parts.angles, index), (parts.bent, "k"))
            if stage
        ],
        "lines": [
            *unpack,
            *_unused(parts.rest, coefficients),
            *_code(assigned(parts.rest, _printer(program, coefficients, line), "/* {} */".format)),
        ],
    }


def _helper(program: Program, helper: Helper, coefficients: set[str]) -> dict[str, Any]:
    result = helper.assignments[-1].target.name

    def line(target: str, text: str) -> str:
        return f"return {text};" if target == result else f"const real {target} = {text};"

    argument = f"const {program.name}_coefficients *c"
    return {
        "doc": f"{helper.meaning[0].upper()}{helper.meaning[1:]}.",
        "signature": _wrapped(
            "REAL_INLINE real", f"{program.name}_{helper.name}", [f"real {helper.argument.name}", argument]
        ),
        "lines": _code(
            assigned(helper.assignments, _printer(program, coefficients, line), "/* {} */".format)
        ),
    }


def _printer(
    program: Program, coefficients: set[str], line: Callable[[str, str], str]
) -> Callable[[str, sp.Expr], str]:
    def spelled(name: str) -> str:
        return "REAL_ROUNDER" if name == "rounder" else f"c->{name}" if name in coefficients else name

    calls = _REAL | {helper.name: f"MODEL_{helper.name}({{0}}, c)" for helper in program.helpers}
    language = _language(program, calls, spelled, "REAL({})")
    return lambda target, value: line(target, printed(value, language))


def _unused(assignments: Iterable[Assignment], coefficients: set[str]) -> list[str]:
    used = set().union(*(a.value.free_symbols for a in assignments))
    return [] if any(s.name in coefficients for s in used) else ["(void)c;"]


def _argument(x: Input, real: str) -> str:
    return f"{real} {x.quantity.name}" if x.length is None else f"const {real} *{x.quantity.name}"


def _element(x: Input, index: str) -> str:
    return f"{x.quantity.name}[{index}]" if x.length is None else f"{x.quantity.name} + {x.length}u * {index}"


def _filled(text: str, indent: int = 4) -> list[str]:
    """The lines of a text that is set in, those after the first a little more."""
    return textwrap.wrap(
        text, _WIDTH - indent, subsequent_indent="    ", break_long_words=False, break_on_hyphens=False
    )


def _code(lines: Iterable[str], indent: int = 4) -> list[str]:
    """The lines of a function's body, long ones broken."""
    return [part for line in lines for part in _filled(line, indent)]


def _wrapped(result: str, name: str, arguments: list[str]) -> str:
    line = f"{result} {name}({', '.join(arguments)})"
    if len(line) < _WIDTH:
        return line
    return f"{result} {name}(\n    " + ",\n    ".join(arguments) + ")"
