"""The variables of the templates of module and runtime: the Program as lines of Python, nothing symbolic."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce
from typing import Any

import sympy as sp

from eccentric.emission.backends.backend import SPLITTING
from eccentric.emission.backends.python.dialect import (
    ON_PARAMETERS,
    WIDTH,
    Dialect,
    Language,
    broken,
    choice_of_pairs,
    on_samples,
    printed,
)
from eccentric.emission.backends.python.module import module, series, stepped
from eccentric.emission.program import COSINE, SINE_RATIO, Program, TurnLeft

_SUM, _PRODUCT, _ATOM = range(3)


def pair_text(e: sp.Expr, pairs: frozenset[sp.Symbol], plain: Language, name: Callable[[str], str]) -> str:
    """The expression as a formula that gives a Pair.

    Args:
        e: what to print.
        pairs: symbols that are Pairs.
        plain: how to print a float, which counts as exact.
        name: the spelling of a Pair.
    """
    return _Formulas(pairs, plain, name).pair(e)[0]


class _Formulas:
    """A formula is its text and its precedence."""

    def __init__(self, pairs: frozenset[sp.Symbol], plain: Language, name: Callable[[str], str]) -> None:
        self._pairs, self._plain, self._name = pairs, plain, name

    def pair(self, e: sp.Expr) -> tuple[str, int]:
        text, level, is_pair = self._term(e)
        return (text, level) if is_pair else (f"runtime.Pair({text})", _ATOM)

    def _term(self, e: sp.Expr) -> tuple[str, int, bool]:
        """The expression as a Pair, or as a float if that is exact."""
        if e in self._pairs:
            return self._name(e.name), _ATOM, True
        if isinstance(e, sp.Piecewise):
            return choice_of_pairs(e, lambda x: self.pair(x)[0], self._plain), _SUM - 1, True
        if isinstance(e, TurnLeft):
            return f"runtime.turn_less({', '.join(printed(a, self._plain) for a in e.args)})", _ATOM, True
        if e.is_Add:
            return *self._folded(" + ", _SUM, e.as_ordered_terms()), True
        if e.is_Mul:
            above, below = e.as_numer_denom()
            if below != 1:
                return *self._folded(" / ", _PRODUCT, (above, below)), True
            return *self._folded(" * ", _PRODUCT, e.as_ordered_factors()), True
        if e.is_Pow and e.exp == sp.Rational(1, 2):
            return f"{self._held(*self.pair(e.base), _ATOM)}.sqrt()", _ATOM, True
        if e.is_Pow and e.exp.is_Integer and e.exp > 0:
            return *self._folded(" * ", _PRODUCT, [e.base] * int(e.exp)), True
        if e.is_Pow and e.exp.is_Integer:
            return *self._folded(" / ", _PRODUCT, (sp.Integer(1), 1 / e)), True
        return printed(e, self._plain), _ATOM if e.is_Atom and e.is_nonnegative else _SUM, False

    def _folded(self, sign: str, level: int, parts: Sequence[sp.Expr]) -> tuple[str, int]:
        """Terms or factors from left to right; the first two are not both floats."""
        terms = [self._term(part) for part in parts]
        if not (terms[0][2] or terms[1][2]):
            terms[0] = (*self.pair(parts[0]), True)
        first, *rest = terms
        held = [self._held(*first[:2], level), *(self._held(*term[:2], level + 1) for term in rest)]
        return reduce(lambda a, b: f"{a}{sign}{b}", held), level

    @staticmethod
    def _held(text: str, own: int, level: int) -> str:
        return text if own >= level else f"({text})"


def _broken(line: str) -> list[str]:
    """The line in formatter style: a choice that is too long has a line for each part."""
    target, _, value = line.partition(" = ")
    if len(line) <= WIDTH or " if " not in value:
        return broken(f"{target} = ", value)
    first, _, rest = value.partition(" if ")
    condition, _, other = rest.partition(" else ")
    if len(value) <= WIDTH - 4:
        return [f"{target} = (", f"    {value}", ")"]
    return [f"{target} = (", f"    {first}", f"    if {condition}", f"    else {other}", ")"]


DIALECT = Dialect(
    kernel=on_samples("np")
    | {
        "sqrt": "np.sqrt({0})",
        "sine_ratio": "runtime.sine_ratio({0}, c)",
        "cosine": "runtime.cosine({0}, c)",
    },
    prepare=ON_PARAMETERS | {name: f"math.{name}({{0}})" for name in ("sqrt", "sin", "cos", "exp")},
    where="np.where({0}, {1}, {2})",
    choice="{1} if {0} else {2}",
    decorator="_model.function",
    missing="math.nan",
    divisor="math.nan",
    pair=pair_text,
    broken=_broken,
    single=True,
)


def view(program: Program, _: str) -> dict[str, Any]:
    """All variables of the templates of the NumPy module; it contains no digest."""
    common = module(program, DIALECT)
    return {
        **common,
        "needs_math": any("math." in line for line in common["prepare"]),
        "follow": _follow(program),
        "polynomials": [series(s.name) for s in (SINE_RATIO, COSINE)],
        "leading": SPLITTING,
    }


def _follow(program: Program) -> dict[str, Any]:
    """The pass of the hidden states along a log; nothing for a model without states."""
    if not program.states:
        return {}
    initial = {q.name: float(value) for q, value in program.states}
    return {
        "inputs": [name for name in stepped(program) if name not in initial],
        "initial": "{" + ", ".join(f'"{name}": {value!r}' for name, value in initial.items()) + "}",
        "width": len(initial),
    }
