"""How steep the friction of a model can be: bounds of its levels and slopes, from the expressions themselves.

Every expression of friction is walked once, and of each part its largest size, its least value and its
largest slope by each input are written down, from those of its own parts: the slope of a sum is at most the
sum of the slopes, that of a product follows from the product rule, a root of two squares is as steep as both
together, and so on. What comes out are formulas in the parameters and in the largest speed, proved by how
they were made; none is a sample. They may be larger than need be, and never smaller.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from eccentric.core import InputError
from eccentric.emission.check import limits
from eccentric.model import Model, levels, spoken_quantity
from eccentric.model import steps as s
from eccentric.model import vocabulary as v

Slopes = Mapping[sp.Symbol, sp.Expr]
ZERO, ONE = sp.Integer(0), sp.Integer(1)


@dataclass(frozen=True)
class SlopeBound:
    """Of an expression, for all inputs within their ranges."""

    size: sp.Expr  # at least its magnitude
    # at most its value; 0 where nothing better is known of a value that is never negative, and None
    # of one that may be
    least: sp.Expr | None
    slopes: Slopes  # at least the magnitude of its slope by each input that it depends on


class Walk:
    """Bounds of expressions by the rules below; the names of definitions stand for their bounds.

    Args:
        inputs: each with the bound of its size; the slope of an input by itself is 1.
        nonnegative: inputs that are never negative.
    """

    def __init__(self, inputs: Mapping[sp.Symbol, sp.Expr], nonnegative: frozenset[sp.Symbol]) -> None:
        self._known = {
            x: SlopeBound(size, ZERO if x in nonnegative else None, {x: ONE}) for x, size in inputs.items()
        }
        self._prepared: set[sp.Symbol] = set()

    def define(self, symbol: sp.Symbol, bound: SlopeBound) -> None:
        """From now on, what the bound of this symbol is."""
        self._known[symbol] = bound

    def prepare(self, symbol: sp.Symbol, value: sp.Expr) -> None:
        """From now on, a symbol is a number that follows from the parameters, by this formula."""
        try:
            sure = self(value).least is not None
        except InputError:  # its sign is not known then
            sure = False
        if sure:
            self._prepared.add(symbol)

    def __call__(self, e: sp.Expr) -> SlopeBound:
        """The bound of an expression.

        Raises:
            InputError: it contains an operation without a rule.
        """
        if e in self._known:
            return self._known[e]
        if e.is_Number or e.is_NumberSymbol or e.is_Symbol:  # a number such as pi, or a parameter
            return (
                SlopeBound(e, e, {})
                if e in self._prepared
                else SlopeBound(sp.Abs(e), e if e.is_nonnegative else None, {})
            )
        if e.is_Pow and e.exp.is_negative and e.base.is_Symbol and e.base not in self._known:
            return SlopeBound(
                sp.Abs(e), e if e.base.is_nonnegative or e.base in self._prepared else None, {}
            )  # of a parameter, not 0
        if isinstance(e, sp.exp):
            return _exponential(self(e.args[0]), falling=self(-e.args[0]).least is not None)
        if isinstance(e, sp.Piecewise):  # by parameters alone
            return self._cases(e)
        for kinds, rule in _RULES:
            if isinstance(e, kinds):
                return rule(e, *map(self, e.args))
        raise InputError("compensation", "an operation whose slope is bounded", str(e.func))

    def _cases(self, e: sp.Piecewise) -> SlopeBound:
        if any(self(x).slopes for _, condition in e.args for x in condition.free_symbols):
            raise InputError("compensation", "a choice by parameters alone", str(e))
        values = [(self(value), condition) for value, condition in e.args]

        def of(pick: object) -> sp.Expr:
            return sp.Piecewise(*((pick(one), condition) for one, condition in values))  # type: ignore[operator]

        known = all(one.least is not None for one, _ in values)
        slopes = {
            x: of(lambda one, x=x: one.slopes.get(x, ZERO)) for x in _inputs(*(one for one, _ in values))
        }
        return SlopeBound(of(lambda one: one.size), of(lambda one: one.least) if known else None, slopes)


def _inputs(*parts: SlopeBound) -> list[sp.Symbol]:
    return list(dict.fromkeys(x for part in parts for x in part.slopes))


def _added(e: sp.Expr, *parts: SlopeBound) -> SlopeBound:
    slopes = {x: sp.Add(*(p.slopes.get(x, ZERO) for p in parts)) for x in _inputs(*parts)}
    leasts = [x if x.is_Number else p.least for x, p in zip(e.args, parts, strict=True)]
    least = None if None in leasts else sp.Add(*leasts)
    return SlopeBound(
        sp.Add(*(p.size for p in parts)), None if least is None or not least.is_nonnegative else least, slopes
    )


def _product(first: SlopeBound, second: SlopeBound) -> SlopeBound:
    slopes = {
        x: first.slopes.get(x, ZERO) * second.size + first.size * second.slopes.get(x, ZERO)
        for x in _inputs(first, second)
    }
    least = None if first.least is None or second.least is None else first.least * second.least
    return SlopeBound(first.size * second.size, least, slopes)


def _multiplied(_: sp.Expr, *parts: SlopeBound) -> SlopeBound:
    found = parts[0]
    for part in parts[1:]:
        found = _product(found, part)
    return found


def _power(e: sp.Expr, base: SlopeBound, exponent: SlopeBound) -> SlopeBound:
    n = e.args[1]
    if n.is_Integer and n > 0:
        found = _multiplied(e, *[base] * int(n))
        return SlopeBound(
            found.size, ZERO if found.least is None and n % 2 == 0 else found.least, found.slopes
        )
    if n.is_negative and base.least is not None:
        # 1 over a number that is at least this one; a power of it as a product.
        inverse = SlopeBound(
            ONE / base.least, ONE / base.size, {x: k / base.least**2 for x, k in base.slopes.items()}
        )
        return inverse if n == -1 else _power(sp.Pow(sp.Dummy(), -n), inverse, exponent)
    if n == sp.Rational(1, 2) and (base.least is not None or not base.slopes):
        slopes = {x: k / (2 * sp.sqrt(base.least)) for x, k in base.slopes.items() if base.least is not None}
        return SlopeBound(sp.sqrt(base.size), None if base.least is None else sp.sqrt(base.least), slopes)
    raise InputError("compensation", "an operation whose slope is bounded", str(e))


def _steepest(*parts: SlopeBound) -> Slopes:
    return {x: sp.Max(*(p.slopes.get(x, ZERO) for p in parts)) for x in _inputs(*parts)}


def _extreme(e: sp.Expr, *parts: SlopeBound) -> SlopeBound:
    """The largest or the smallest: as steep as the steepest of them."""
    leasts = [p.least for p in parts if p.least is not None]
    known = leasts if isinstance(e, sp.Max) or len(leasts) == len(parts) else []
    least = None if not known else (sp.Max if isinstance(e, sp.Max) else sp.Min)(*known)
    return SlopeBound(sp.Max(*(p.size for p in parts)), least, _steepest(*parts))


def _either(_: sp.Expr, _by: SlopeBound, *parts: SlopeBound) -> SlopeBound:
    """One by the direction of motion: continuous where it is multiplied by the velocity, or has one value."""
    return SlopeBound(sp.Max(*(p.size for p in parts)), None, _steepest(*parts))


def _size(_: sp.Expr, part: SlopeBound) -> SlopeBound:
    return SlopeBound(part.size, part.least or ZERO, part.slopes)


def _exponential(part: SlopeBound, *, falling: bool) -> SlopeBound:
    size = ONE if falling else sp.exp(part.size)
    return SlopeBound(size, ZERO, {x: size * k for x, k in part.slopes.items()})


def _wave(e: sp.Expr, part: SlopeBound, mu: SlopeBound | None = None) -> SlopeBound:
    """A sine or cosine, of the angle or of half the link angle; a tilt is at most a right angle."""
    scale = ONE if mu is None else mu.size / 2
    upright = not part.slopes and (isinstance(e, sp.cos) or part.least is not None)
    return SlopeBound(ONE, ZERO if upright else None, {x: scale * k for x, k in part.slopes.items()})


def _magnitude(_: sp.Expr, p: SlopeBound, q: SlopeBound) -> SlopeBound:
    slopes = {x: sp.sqrt(p.slopes.get(x, ZERO) ** 2 + q.slopes.get(x, ZERO) ** 2) for x in _inputs(p, q)}
    leasts = [one.least for one in (p, q) if one.least is not None]
    return SlopeBound(sp.sqrt(p.size**2 + q.size**2), sp.Max(ZERO, *leasts), slopes)


def _difference_of_squares(_: sp.Expr, v: SlopeBound, w: SlopeBound) -> SlopeBound:
    slopes = {
        x: 2 * v.size * v.slopes.get(x, ZERO) + 2 * w.size * w.slopes.get(x, ZERO) for x in _inputs(v, w)
    }
    return SlopeBound(sp.Max(v.size**2, w.size**2), None, slopes)


def _bounded(_: sp.Expr, x: SlopeBound, most: SlopeBound) -> SlopeBound:
    """A value limited to one on either side of 0: as steep as the steeper of the two."""
    return SlopeBound(sp.Min(x.size, most.size), x.least and ZERO, _steepest(x, most))


def _limited(_: sp.Expr, x: SlopeBound, low: SlopeBound, high: SlopeBound) -> SlopeBound:
    """A value limited to one on either side of 0: as steep as the steepest of the three."""
    return SlopeBound(sp.Max(low.size, high.size), None, _steepest(x, low, high))


def _bump(_: sp.Expr, x: SlopeBound) -> SlopeBound:
    """A quadratic B-spline: its slope is largest at its inner knots, 1."""
    return SlopeBound(sp.Rational(3, 4), ZERO, x.slopes)


def _from_top(e: sp.Expr, part: SlopeBound, _mu: SlopeBound) -> SlopeBound:
    """The angle within its turn; what is made of it has no jump where it has."""
    return SlopeBound(sp.pi / sp.Abs(e.args[1]), None, part.slopes)


def _flat(_: sp.Expr, *_parts: SlopeBound) -> SlopeBound:
    """A step by a direction: 1, 0 or -1, with no slope on either side."""
    return SlopeBound(ONE, None, {})


_RULES = (
    (sp.Add, _added),
    ((sp.Mul, s.Gated), _multiplied),
    (sp.Pow, _power),
    ((sp.Max, sp.Min), _extreme),
    (sp.Abs, _size),
    ((sp.sin, sp.cos, s.HalfCosine, s.HalfSine), _wave),
    (s.Magnitude, _magnitude),
    (s.SquareDifference, _difference_of_squares),
    (s.Bounded, _bounded),
    (s.ByDirection, _either),
    (s.Clipped, _limited),
    (s.Bump, _bump),
    (s.FromTop, _from_top),
    ((s.Sgn, s.Forward, s.Backward), _flat),
)


@dataclass(frozen=True)
class Steepness:
    """Assignments name = formula, and the names of what the constants follow from."""

    # in the order of their computation; of the parameters and of the largest speed, `speed`
    assignments: tuple[tuple[str, sp.Expr], ...]
    size: sp.Expr  # the largest level of dry friction up to this speed
    by: Mapping[str, sp.Expr]  # input -> the largest slope of the friction in one direction of motion


_FASTEST_MOTION = sp.Symbol("speed_at_most", nonnegative=True)


def steepness(model: Model) -> Steepness:
    """Of the friction of a model in the letters of its axis, from its own levels."""
    omega_m = v.omega_m.symbol
    friction = tuple(t for t in model.balance("mechanical").terms if t.kind == "friction")
    found = levels(model, omega_m, friction)
    inputs = {q.symbol: q for q in (*model.inputs, *(state.quantity for state in model.states))}
    sizes = {x: sp.Float(max(map(abs, limits(q, model.axis)))) for x, q in inputs.items()}
    never = frozenset(x for x, q in inputs.items() if limits(q, model.axis)[0] >= 0.0)
    walk = Walk(sizes | {omega_m: _FASTEST_MOTION}, never)
    names: dict[sp.Expr, sp.Symbol] = {}
    listed: list[tuple[sp.Symbol, sp.Expr]] = []

    def named(name: str, value: sp.Expr) -> sp.Expr:
        if value.is_Atom:
            return value
        if value not in names:
            names[value] = sp.Symbol(name, nonnegative=True)
            listed.append((names[value], value))
        return names[value]

    def kept(name: str, bound: SlopeBound) -> SlopeBound:
        size = named(f"{name}_size", bound.size)
        least = None if bound.least is None else named(f"{name}_least", bound.least)
        return SlopeBound(size, least, {x: named(f"{name}_by_{x.name}", k) for x, k in bound.slopes.items()})

    definitions = [(d.symbol, d.value) for d in model.definitions]
    definitions += [(a.target, a.value) for a in found.definitions]
    sides = (found.forward, found.backward)
    needed = {x for side in sides for e in (side.dry, side.viscous) for x in e.free_symbols}
    for symbol, value in reversed(definitions):
        if symbol in needed:
            needed |= value.free_symbols
    varying = set(sizes)
    for symbol, value in definitions:
        if symbol not in needed:
            continue
        if value.free_symbols & varying or value.has(sp.sin, sp.cos, s.OpaqueStep):
            varying.add(symbol)
            walk.define(symbol, kept(symbol.name, walk(value)))
        else:  # a number, once the parameters are known
            walk.prepare(symbol, value)
            names[value] = symbol
            listed.append((symbol, value))
    dry = [kept(f"dry_{k}", walk(side.dry)) for k, side in enumerate(sides)]
    wet = [kept(f"viscous_{k}", walk(side.viscous * omega_m)) for k, side in enumerate(sides)]
    slopes = {
        x: named(
            f"friction_by_{x.name}",
            sp.Max(*(d.slopes.get(x, ZERO) + b.slopes.get(x, ZERO) for d, b in zip(dry, wet, strict=True))),
        )
        for x in inputs
        if any(x in one.slopes for one in (*dry, *wet))
    }
    size = named("level_size", sp.Max(*(d.size for d in dry)))
    by = {spoken_quantity(model.axis, inputs[x]).name: k for x, k in slopes.items()}
    # Only what the constants follow from.
    live = set().union(size.free_symbols, *(k.free_symbols for k in by.values()))
    used = []
    for symbol, value in reversed(listed):
        if symbol in live:
            used.append((symbol.name, value))
            live |= value.free_symbols
    return Steepness(tuple(reversed(used)), size, by)
