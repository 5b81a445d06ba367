"""The variables of `header.h.jinja` and `source.c.jinja`: the Program as lines of C, nothing symbolic."""

from __future__ import annotations

from typing import Any

import sympy as sp

from eccentric.emission.backends.backend import SPLITTING, number, used_series
from eccentric.emission.backends.c99.printer import (
    DOUBLE,
    NOT_GIVEN,
    code,
    evaluate_prepare,
    language,
    pair_functions,
    pair_text,
    wrapped,
)
from eccentric.emission.backends.c99.routine import argument, helper, routine, staged, twin_of
from eccentric.emission.backends.python.dialect import Language, printed
from eccentric.emission.program import (
    ABSENT,
    LARGEST_ANGLE,
    LARGEST_RATIO,
    ROUNDER,
    Condition,
    InSingle,
    Program,
    Root,
    Size,
    Within,
    paired,
    polynomial,
)
from eccentric.emission.templates import plain
from eccentric.model import Assignment, Backward, Forward, Leading, Quantity, Sgn

# Written so that NaN in gives NaN out; one comparison per line is one instruction of a vector unit.
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
_FIRST = {
    "mechanical_friction_torque": ("the friction to compensate, at the reference velocity", ","),
    "friction_torque": ("which contains the back-EMF, as the voltage did not separate the two", ";"),
    "voltage": ("the only one in its unit, as the log had no scale for a torque", ";"),
    "current": ("the only one in its unit, as the log had no scale for a torque", ";"),
}
"""What the function to begin with is, and what separates it from the next."""


def view(program: Program, digest: str) -> dict[str, Any]:
    """All variables of the templates of header and source; `digest` is that of the code."""
    prepared = {a.target.name for a in program.prepare}
    paired_symbols = paired(program)
    pairs = {s.name for s in paired_symbols}

    def value_of(name: str) -> str:
        return f"{name}.high" if name in pairs else name if name in prepared else f"p->{name}"

    def coefficient(s: sp.Symbol) -> dict[str, str]:
        single, double = (values[one][s.name].replace("NAN", NOT_GIVEN) for one in (True, False))
        return {
            "name": s.name,
            "source": value_of(s.name),
            "single": f"(real)({single})",
            "double": double,
            "doc": notes.get(s.name, ""),
        }

    in_prepare = language(program, DOUBLE, value_of, "{}")
    given = {q.name for q in program.parameters if q.symbol in program.ungiven}
    in_pairs = language(
        program,
        DOUBLE,
        lambda name: f"{program.name}_given(p->{name})" if name in given else value_of(name),
        "{}",
    )

    def prepared_lines(*, late: bool) -> list[str]:
        """Those of both precisions, or those of single precision only."""
        chosen = (a for a in program.prepare if (a.target in program.single_only) == late)
        return code(
            _prepared(program, a, in_pairs if a.target in paired_symbols else in_prepare) for a in chosen
        )

    coefficients = {s.name for s in program.coefficients}
    values = {single: evaluate_prepare(program, single) for single in (True, False)}
    expressions = [a.value for a in program.hot()]
    helpers = [name for name, kinds in _NEEDS.items() if any(e.has(*kinds) for e in expressions)]
    macros = _macros(program)
    notes = dict(program.notes)
    held, shared = program.held(single=True), len(program.held(single=False))
    absent = program.ungiven.intersection(program.coefficients) if program.fixed else program.ungiven
    array_names = [f"{r.name}_n" for r in program.routines if r.inputs]
    called = [
        name
        for r in program.routines
        for name in (r.name, f"{r.name}_n")
        if name == r.name or (r.inputs and program.arrays == "with")
    ]
    return {
        "arrays": program.arrays,
        "fixed": program.fixed,
        "array_names": array_names,
        "names": [
            *(["default"] if program.fixed else ["prepare", "default", "default_parameters"]),
            *called,
            *(["initial_state", "step"] if program.states else []),
        ],
        "exponential": any(e.has(sp.exp) for e in expressions),
        "name": program.name,
        "said": program.axis.text,
        "guard": program.name.upper(),
        "first": _first(program),
        "digest": f"0x{digest}UL",
        "parameters": [
            _parameter(q, values[False][q.name].replace("NAN", NOT_GIVEN)) for q in program.parameters
        ],
        "valid": _valid(program),
        "checks": _checks(program),
        "promises": program.promises,
        "far": f", |theta_m| to {LARGEST_ANGLE} rad, mu to {LARGEST_RATIO}",
        "bounded": "fastest" in {s.name for s in program.coefficients},
        "defaults": program.defaults,
        "coefficients": list(map(coefficient, held[:shared])),
        "single_coefficients": list(map(coefficient, held[shared:])),
        "single": [(name, single) for name, single, _ in macros],
        "double": [(name, double) for name, _, double in macros],
        "ungiven": f"{NOT_GIVEN} ({ABSENT:.1f})" if absent else "",
        "given": any(
            program.ungiven & a.value.free_symbols for a in program.prepare if a.target in paired_symbols
        ),
        "root": any(e.has(Root) for e in expressions),
        "macros": [name.partition("(")[0] for name, _, _ in macros],
        "helpers": [
            dict(zip(("name", "arguments", "lines"), (name, *_HELPERS[name]), strict=True))
            for name in helpers
        ],
        "series": [_series(name) for name in used_series(program)],
        "leading": SPLITTING if any(a.value.has(Leading) for a in program.prepare) else None,
        "pairs": pair_functions(program),
        "prepare": prepared_lines(late=False),
        "single_prepare": prepared_lines(late=True),
        "helpers_of_angle": [helper(program, h, coefficients) for h in program.helpers],
        "angle": any(staged(r).angles for r in program.routines),
        "staged": program.arrays != "none" and any(staged(r).angles for r in program.routines),
        "routines": [routine(program, r, coefficients) for r in program.routines],
        "states": [
            {"name": q.name, "doc": plain(f"{q.meaning} [{q.unit}]"), "initial": number(str(float(initial)))}
            for q, initial in program.states
        ],
        "step": _step(program),
        "calls": [
            *([("next_state", "step")] if program.states else []),
            *((twin.name, r.name) for r in program.routines if (twin := twin_of(program, r))),
        ],
    }


def _first(program: Program) -> dict[str, str]:
    """The function to begin with: in a choice the first one, by its meaning."""
    name, said = program.first, program.axis.text
    known = {said(function): (said(doc), end) for function, (doc, end) in _FIRST.items()}
    if program.chosen or name not in known:
        meaning = next(r.meaning for r in program.routines if r.name == name)
        return {"name": name, "doc": meaning, "end": ";"}
    doc, end = known[name]
    return {"name": name, "doc": doc, "end": end}


def _prepared(program: Program, a: Assignment, language: Language) -> str:
    """An assignment of `prepare`: without a parameter that it needs, its result is not given either."""
    pairs = paired(program)
    if a.target not in pairs:
        value = printed(a.value, language)
        absent = sorted(language.symbol(s.name) for s in (a.value.free_symbols & program.ungiven) - pairs)
        if absent:
            lacking = " || ".join(f"({name} == {NOT_GIVEN})" for name in absent)
            value = f"({lacking}) ? {NOT_GIVEN} : ({value})"
        return f"const double {a.target.name} = {value};"
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
        "signature": wrapped(
            "void",
            own,
            [f"{program.name}_state *state", *(argument(x, "ECCENTRIC_REAL") for x in given), coefficients],
        ),
        "meaning": stepped.meaning,
        "call": f"{program.name}_next_state({', '.join([*passed, 'next', 'c'])});",
    }


def _macros(program: Program) -> list[tuple[str, str, str]]:
    """(macro, its meaning in single, in double), those that the routines use."""
    expressions = [a.value for a in program.hot()]
    used = [("REAL_SQRT(x)", Root, "sqrt"), ("REAL_FABS(x)", Size, "fabs"), ("REAL_EXP(x)", sp.exp, "exp")]
    found = [("REAL(x)", "x##f", "x")]
    if any(program.ungiven & e.free_symbols for e in expressions):
        given = f"(((x) == (real){NOT_GIVEN}) ? (real)NAN : (x))"
        found.append(("REAL_GIVEN(x)", given, given))
    found += [
        (macro, f"{name}f(x)", f"{name}(x)")
        for macro, op, name in used
        if any(e.has(op) for e in expressions)
    ]
    if any(e.has(InSingle) for e in expressions):
        found.append(("REAL_IN_SINGLE(x, y)", "(x)", "(y)"))
    if any(ROUNDER in e.free_symbols for e in expressions):
        found.append(("REAL_ROUNDER", "12582912.0f", "6755399441055744.0"))
    libm = {"sine_ratio": "sin", "cosine": "cos"}
    names = [libm[series] for series in used_series(program)]
    found += [(f"REAL_{name.upper()}(x)", f"{name}f(x)", f"{name}(x)") for name in names]
    return found


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


def _checks(program: Program) -> list[str]:
    """The lines that find the first invalid parameter, from the last to the first."""
    failing: dict[str, list[str]] = {}
    for one in program.conditions:
        failing.setdefault(one.parameter.name, []).append(_fails(program, one))
    lines = []
    for place, q in reversed(list(enumerate(program.parameters, 1))):
        tests = [_invalid(q), *failing.get(q.name, [])]
        if len(tests) == 1:
            lines.append(f"invalid = ({tests[0]}) ? {place} : invalid;")
        else:
            lines += code([f"invalid = ({' || '.join(f'({test})' for test in tests)}) ? {place} : invalid;"])
    return lines


def _fails(program: Program, condition: Condition) -> str:
    """The condition in C that another one fails; while a parameter in it is not given, it holds."""
    plain = language(program, DOUBLE, "p->{}".format, "{}")
    used = condition.loss.free_symbols | condition.inertia.free_symbols
    absent = [q.name for q in program.parameters if q.symbol in used and q.default is None]
    loss, inertia = (printed(e, plain) for e in (condition.loss, condition.inertia))
    return " && ".join([*(f"(p->{name} != {NOT_GIVEN})" for name in absent), f"({loss} >= {inertia})"])


def _invalid(q: Quantity) -> str:
    """The condition in C that a parameter is invalid; one without a default may be absent or NaN."""
    x, most = f"p->{q.name}", "1.5707964" if q.domain == "tilt" else "DBL_MAX"
    low, below = {"positive": ("> 0.0", "<= 0.0"), "real": (">= -DBL_MAX", "< -DBL_MAX")}.get(
        q.domain, (">= 0.0", "< 0.0")
    )
    if q.default is None:
        return f"(({x} {below}) && ({x} != {NOT_GIVEN})) || ({x} > {most})"
    return f"!(({x} {low}) && ({x} <= {most}))"


def _valid(program: Program) -> str:
    kinds = {
        kind: [q.name for q in program.parameters if q.domain == kind]
        for kind in ("positive", "tilt", "real")
    }
    words = {"positive": "positive", "tilt": "from 0 to pi/2", "real": "any finite number"}
    named = [f"{', '.join(names)} {words[kind]}" for kind, names in kinds.items() if names]
    if limited := ", ".join(one.parameter.name for one in program.conditions):
        named.append(f"{limited} with acceleration-dependent friction below the inertia")
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
        "doc": f"{function}, |h| within a quarter turn: minimax in x = h^2.",
        "errors": f"{function.partition(' - ')[0]}: method {single.error} and {double.error},"
        f" rounding {single.rounding} and {double.rounding}",
    }
