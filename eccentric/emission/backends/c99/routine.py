"""A routine of the Program as C: its kernel, the function that calls it, and the one for arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import sympy as sp

from eccentric.emission.backends.backend import assigned
from eccentric.emission.backends.c99.printer import REAL, code, filled, language, wrapped
from eccentric.emission.backends.python.dialect import printed
from eccentric.emission.program import TURN_BITS, Call, Helper, Program, Routine
from eccentric.model import Assignment, Input


# A routine in stages: the angle, what follows from it, the rest.
#
# Every operation on a sample waits for the one before it, some 150 cycles in all, and a processor's
# look-ahead is limited. In stages of a third of the length, on a block of samples, it processes several at
# once.
@dataclass(frozen=True)
class Staged:
    """The parts of a routine."""

    angles: tuple[Assignment, ...]  # calls of helpers with an input
    bent: tuple[Assignment, ...]  # calls of helpers with one of `angles`
    rest: tuple[Assignment, ...]  # the remaining part
    inputs: tuple[Input, ...]  # those that the rest uses


def staged(routine: Routine) -> Staged:
    """The routine in stages; the first two are empty if it takes no angle directly from its inputs."""
    given = {s for x in routine.inputs if x.length is None for s in x.symbols}
    angles = tuple(a for a in routine.assignments if _is_call_of(a, given))
    bent = tuple(a for a in routine.assignments if _is_call_of(a, {a.target for a in angles}))
    rest = tuple(a for a in routine.assignments if a not in (*angles, *bent))
    used = set().union(*(a.value.free_symbols for a in rest))
    # A vector stays, whichever of its elements are used.
    inputs = (x for x in routine.inputs if x.length is not None or used & set(x.symbols))
    return Staged(angles, bent, rest, tuple(inputs))


def _is_call_of(assignment: Assignment, arguments: set[sp.Symbol]) -> bool:
    return isinstance(assignment.value, Call) and assignment.value.args[1] in arguments


_EXACT = "2^{double} half turns of the link (float: 2^{single})".format_map(TURN_BITS)


def routine(program: Program, r: Routine, coefficients: set[str]) -> dict[str, Any]:
    """What the templates need of a routine; `coefficients` are the names of the prepared values."""
    parts = staged(r)
    twin = twin_of(program, r)
    return {
        "name": r.name,
        "unit": r.unit,
        "formerly": r.formerly,
        "requires": " and ".join(r.requires),
        "last": r.inputs[-1].quantity.name if r.inputs else "",
        "width": len(r.labels),
        "twin": _twin(program, twin) if twin else {},
        **_documentation(program, r, parts),
        **_signatures(program, r, parts),
        **_calls(program, r, parts, coefficients),
        "lines": _body(program, r, parts, coefficients),
    }


def twin_of(program: Program, r: Routine) -> Routine | None:
    """The first routine that computes the same as this one; None if that is this one."""

    def body(x: Routine) -> tuple[Any, ...]:
        return x.inputs, x.assignments, x.results, bool(x.labels)

    twin = next(x for x in program.routines if body(x) == body(r))
    return None if twin is r else twin


def _twin(program: Program, r: Routine) -> dict[str, str]:
    """The calls of a routine by one that computes the same."""
    own, passed = f"{program.name}_{r.name}", [x.quantity.name for x in r.inputs]
    one = f"{own}({', '.join([*passed, *(['out'] if r.labels else []), 'c'])});"
    return {
        "call": one if r.labels else f"return {one}",
        "array_call": f"{own}_n({', '.join(['n', *passed, 'out', 'c'])});",
    }


def helper(program: Program, h: Helper, coefficients: set[str]) -> dict[str, Any]:
    """What the templates need of a helper."""
    result = h.assignments[-1].target.name

    def line(target: str, text: str) -> str:
        return f"return {text};" if target == result else f"const real {target} = {text};"

    return {
        "doc": f"{h.meaning[0].upper()}{h.meaning[1:]}.",
        "signature": wrapped(
            "REAL_INLINE real", f"{program.name}_{h.name}", [f"real {h.argument.name}", _prepared(program)]
        ),
        "lines": code(assigned(h.assignments, _printer(program, coefficients, line), "/* {} */".format)),
    }


def argument(x: Input, real: str) -> str:
    """An input in the head of a function, a vector as a pointer."""
    return f"{real} {x.quantity.name}" if x.length is None else f"const {real} *{x.quantity.name}"


def _prepared(program: Program) -> str:
    return f"const {program.name}_coefficients *c"


def _documentation(program: Program, r: Routine, parts: Staged) -> dict[str, Any]:
    states = [q for q, _ in program.states]
    width, reduced = len(r.labels), f", reduced exactly up to {_EXACT}" if parts.angles else ""
    alpha, torque = map(program.axis.named, ("alpha_m", "torque"))
    # What solves for a motion is given the acceleration that it had.
    before = (
        {alpha: ", of the step before, 0 at rest"} if torque in {x.quantity.name for x in r.inputs} else {}
    )
    out = f"@param[out] out  {width} value{'s' * (width > 1)}: {', '.join(r.labels)} [{r.unit}]"
    return {
        "doc": f"{r.meaning[0].upper()}{r.meaning[1:]}.",
        "inputs": [
            {
                "name": x.quantity.name,
                "doc": f"{x.quantity.meaning} [{x.quantity.unit}]"
                + (reduced if x.quantity.name == "theta_m" else "")
                + before.get(x.quantity.name, "")
                + (f", a hidden state, which {program.name}_step advances" if x.quantity in states else ""),
            }
            for x in r.inputs
        ],
        "out": filled(out if r.labels else ""),
    }


def _signatures(program: Program, r: Routine, parts: Staged) -> dict[str, str]:
    own, last = f"{program.name}_{r.name}", _prepared(program)
    kernel = [*(argument(x, "real") for x in parts.inputs), *(f"real {name}" for name in _ready(parts))]
    arrays = [f"const ECCENTRIC_REAL *{x.quantity.name}" for x in r.inputs]
    given = [argument(x, "ECCENTRIC_REAL") for x in r.inputs]
    return {
        "kernel": wrapped(
            f"REAL_INLINE {'void' if r.labels else 'real'}",
            f"{own}_at",
            [*kernel, *(["real *out"] if r.labels else []), last],
        ),
        "signature": wrapped(
            "void" if r.labels else "ECCENTRIC_REAL",
            own,
            [*given, *(["ECCENTRIC_REAL *out"] if r.labels else []), last],
        ),
        "array_signature": wrapped("void", f"{own}_n", ["size_t n", *arrays, "ECCENTRIC_REAL *out", last]),
    }


def _calls(program: Program, r: Routine, parts: Staged, coefficients: set[str]) -> dict[str, Any]:
    """Calls of the kernel, for one sample and stage by stage for arrays."""
    own, ready, width = f"{program.name}_{r.name}", _ready(parts), len(r.labels)
    early = (*parts.angles, *parts.bent)
    passed = [*(x.quantity.name for x in parts.inputs), *ready, *(["out"] if r.labels else []), "c"]
    index = "first + k" if parts.angles else "k"
    given = ", ".join([*(_element(x, index) for x in parts.inputs), *(f"{name}[k]" for name in ready)])
    to = f"&out[{width}u * {f'({index})' if parts.angles else index}]"
    each = f"{own}_at({given}, {to}, &own);" if r.labels else f"out[{index}] = {own}_at({given}, &own);"
    return {
        "call": [
            *code(assigned(early, _printer(program, coefficients, _line_of(r)), "".format)),
            f"{'' if r.labels else 'return '}{own}_at({', '.join(passed)});",
        ],
        "array_call": code([each], 12),
        "buffers": [a.target.name for a in early],
        "stages": [
            [
                f"{a.target.name}[k] = {program.name}_{a.value.args[0]}({a.value.args[1]}[{at}], &own);"
                for a in stage
            ]
            for stage, at in ((parts.angles, index), (parts.bent, "k"))
            if stage
        ],
    }


def _body(program: Program, r: Routine, parts: Staged, coefficients: set[str]) -> list[str]:
    vectors = [x for x in r.inputs if x.length is not None]
    used = set().union(*(a.value.free_symbols for a in parts.rest))
    unpack = [
        f"const real {symbol.name} = {x.quantity.name}[{k}];"
        for x in vectors
        for k, symbol in enumerate(x.symbols)
        if symbol in used
    ]
    unpack += [f"(void){x.quantity.name};" for x in vectors if not used.intersection(x.symbols)]
    return [
        *unpack,
        *_unused(parts.rest, coefficients),
        *code(assigned(parts.rest, _printer(program, coefficients, _line_of(r)), "/* {} */".format)),
    ]


def _line_of(r: Routine) -> Callable[[str, str], str]:
    """How an assignment is spelled: a constant of its own, or what is returned."""
    results = {s.name: k for k, s in enumerate(r.results)}

    def line(target: str, text: str) -> str:
        if target not in results:
            return f"const real {target} = {text};"
        return f"out[{results[target]}] = {text};" if r.labels else f"return {text};"

    return line


def _ready(parts: Staged) -> list[str]:
    """Names of the kernel's arguments other than the inputs."""
    used = set().union(*(a.value.free_symbols for a in parts.rest))
    return [a.target.name for a in (*parts.angles, *parts.bent) if a.target in used]


def _printer(
    program: Program, coefficients: set[str], line: Callable[[str, str], str]
) -> Callable[[str, sp.Expr], str]:
    ungiven = {s.name for s in program.ungiven}

    def spelled(name: str) -> str:
        if name not in coefficients:
            return "REAL_ROUNDER" if name == "rounder" else name
        return f"REAL_GIVEN(c->{name})" if name in ungiven else f"c->{name}"

    calls = REAL | {h.name: f"MODEL_{h.name}({{0}}, c)" for h in program.helpers}
    spelling = language(program, calls, spelled, "REAL({})")
    return lambda target, value: line(target, printed(value, spelling))


def _unused(assignments: Iterable[Assignment], coefficients: set[str]) -> list[str]:
    used = set().union(*(a.value.free_symbols for a in assignments))
    return [] if any(s.name in coefficients for s in used) else ["(void)c;"]


def _element(x: Input, index: str) -> str:
    return f"{x.quantity.name}[{index}]" if x.length is None else f"{x.quantity.name} + {x.length}u * {index}"
