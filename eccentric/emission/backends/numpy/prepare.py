"""`_prepare` of the module: values that depend on parameters only, as lines of Python."""

from __future__ import annotations

from eccentric.emission.backends.expression import printed
from eccentric.emission.backends.numpy.pairs import pair_text
from eccentric.emission.backends.numpy.printer import PREPARE, language
from eccentric.emission.program import Assignment, Program, paired
from eccentric.model import Quantity

_WIDTH = 106


def prepare(program: Program) -> list[str]:
    """The lines; a coefficient is an attribute of c, a parameter one of p, anything else a local name."""
    coefficients = {s.name for s in program.coefficients}
    prepared = {a.target.name for a in program.prepare}
    optional = [q for q in program.parameters if q.default is None or q.default.free_symbols]
    pairs = paired(program)

    def held(name: str) -> str:
        if name in prepared:
            return f"c.{name}" if name in coefficients else name
        return name if name in {q.name for q in optional} else f"p.{name}"

    def value_of(name: str) -> str:
        return f"{held(name)}.high" if name in {s.name for s in pairs} else held(name)

    spelling = language(PREPARE, value_of, held)
    given = [q for q in program.parameters if q.name in coefficients]

    def line(a: Assignment) -> list[str]:
        value = pair_text(a.value, pairs, spelling, held) if a.target in pairs else printed(a.value, spelling)
        return _broken(held(a.target.name), value)

    single = [part for a in program.prepare if a.target in program.single_only for part in line(a)]
    return [
        *(part for q in optional for part in _broken(held(q.name), _default(q))),
        *(f"c.{q.name} = {held(q.name)}" for q in given),
        *(part for a in program.prepare if a.target not in program.single_only for part in line(a)),
        *(["if c.single:", *(f"    {part}" for part in single)] if single else []),
    ]


def _default(q: Quantity) -> str:
    plain = language(PREPARE, lambda name: f"p.{name}")
    value = "math.nan" if q.default is None else printed(q.default, plain)
    return f"{value} if p.{q.name} is None else p.{q.name}"


def _broken(target: str, value: str) -> list[str]:
    """An assignment in formatter style: a choice that is too long has a line for each part."""
    if len(f"{target} = {value}") <= _WIDTH or " if " not in value:
        return [f"{target} = {value}"]
    first, _, rest = value.partition(" if ")
    condition, _, other = rest.partition(" else ")
    if len(value) <= _WIDTH - 4:
        return [f"{target} = (", f"    {value}", ")"]
    return [f"{target} = (", f"    {first}", f"    if {condition}", f"    else {other}", ")"]
