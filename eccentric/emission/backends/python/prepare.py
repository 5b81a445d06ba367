"""`_prepare` of a module: values that depend on parameters only, as lines of Python."""

from __future__ import annotations

from eccentric.emission.backends.expression import printed
from eccentric.emission.backends.python.dialect import Dialect
from eccentric.emission.program import Assignment, Program, paired
from eccentric.model import Quantity


def prepare(program: Program, dialect: Dialect) -> list[str]:
    """The lines; a coefficient is an attribute of c, a parameter one of p, anything else a local name."""
    coefficients = {s.name for s in program.coefficients}
    prepared = {a.target.name for a in program.prepare}
    optional = [q for q in program.parameters if q.default is None or q.default.free_symbols]
    names = {q.name for q in optional}
    pairs = paired(program)
    doubled = {s.name for s in pairs}

    def held(name: str) -> str:
        if name in prepared:
            return f"c.{name}" if name in coefficients else name
        return name if name in names else f"p.{name}"

    def value_of(name: str) -> str:
        return f"{held(name)}.high" if name in doubled else held(name)

    plain = dialect.language(dialect.prepare, value_of, held)

    def line(a: Assignment) -> list[str]:
        is_pair = a.target in pairs
        value = dialect.pair(a.value, pairs, plain, held) if is_pair else printed(a.value, plain)
        return dialect.broken(f"{held(a.target.name)} = {value}")

    late = program.single_only if dialect.single else frozenset()
    single = [part for a in program.prepare if a.target in late for part in line(a)]
    return [
        *(part for q in optional for part in dialect.broken(_default(q, dialect))),
        *(f"c.{q.name} = {held(q.name)}" for q in program.parameters if q.name in coefficients),
        *(part for a in program.prepare if a.target not in late for part in line(a)),
        *(["if c.single:", *(f"    {part}" for part in single)] if single else []),
    ]


def _default(q: Quantity, dialect: Dialect) -> str:
    plain = dialect.language(dialect.prepare, lambda name: f"p.{name}")
    value = dialect.missing if q.default is None else printed(q.default, plain)
    return f"{q.name} = {value} if p.{q.name} is None else p.{q.name}"
