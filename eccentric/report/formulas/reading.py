"""Expressions as a person writes them: plain functions for stable forms, common factors extracted."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import sympy as sp

from eccentric.model import HalfCosine, HalfSine, Magnitude, meaning
from eccentric.model import vocabulary as v

__all__ = ["factors", "grouped", "plain"]

_EVERYWHERE = {q.symbol for q in (v.mu, v.omega_m, v.dt)}
"""Factors of this many terms stay inside: extracting them would hide what belongs together."""


def plain(expression: sp.Expr) -> sp.Expr:
    """The formula that an expression of a model evaluates; mu theta_m is written as theta_l."""
    expression = expression.replace(_pair, _whole_angle)
    expression = expression.replace(Magnitude, lambda p, q: sp.sqrt(p**2 + q**2, evaluate=False))
    expression = meaning(expression)
    half = v.mu.symbol * v.theta_m.symbol / 2
    if expression.has(sp.sin(half), sp.cos(half)):
        expression = sp.trigsimp(expression)
    expression = expression.replace(lambda e: isinstance(e, sp.Add), _tanh)
    if expression.has(v.theta_m.symbol):
        expression = expression.subs(v.mu.symbol * v.theta_m.symbol, v.theta_l.symbol)
    return expression.xreplace({x: sp.Float(x, 4) for x in expression.atoms(sp.Rational) if _long(x)})


def _long(x: sp.Rational) -> bool:
    """Whether a number is a fitted one rather than a fraction or a power of ten."""
    return x.q > 1000 and not (abs(x.p) == 1 and str(x.q).rstrip("0") == "1")


def _tanh(total: sp.Add) -> sp.Expr:
    """The plain form of 2/(1 + exp(-2x)) - 1, any other sum as it is; matching with a wildcard is slow."""
    before, fraction = total.as_coeff_Add()
    above, inverse = fraction.as_coeff_Mul()
    below, power = inverse.as_base_exp()
    one, e = below.as_coeff_Add()
    stable = (before, above, power, one) == (-1, 2, -1, 1) and isinstance(e, sp.exp)
    return sp.tanh(-e.args[0] / 2) if stable else total


def _pair(expression: sp.Basic) -> bool:
    """Whether it is a square or product of half-angle steps, which only come in pairs."""
    steps = [part for part in expression.args if isinstance(part, HalfCosine | HalfSine)]
    return (expression.func, len(steps)) in {(sp.Pow, 1), (sp.Mul, 2)}


def _whole_angle(pair: sp.Basic) -> sp.Expr:
    """The pair by the whole angle: cos^2 = (1 + cos x)/2, sin^2 = (1 - cos x)/2, -cos sin = -sin(x)/2."""
    steps = [part for part in pair.args if isinstance(part, HalfCosine | HalfSine)]
    x = sp.expand(sp.Mul(*steps[0].args))
    if len(steps) == 2:
        return sp.Mul(-sp.sin(x) / 2, *(part for part in pair.args if part not in steps))
    return (1 + (sp.cos(x) if isinstance(steps[0], HalfCosine) else -sp.cos(x))) / 2


def grouped(total: sp.Expr) -> sp.Expr:
    """A sum with the common factors of its terms in front; failing that, those of each group of terms."""
    if not isinstance(total, sp.Add):
        return total
    terms = list(total.args)
    if shared := _shared(terms):
        inside = grouped(sp.Add(*(term / sp.Mul(*shared) for term in terms)))
        return sp.Mul(*shared, inside, evaluate=False)
    pairs = (
        [f for f in _shared(pair) if f.is_Symbol and f not in _EVERYWHERE] for pair in combinations(terms, 2)
    )
    best = max(pairs, key=len, default=[])
    if not best or len(terms) < 3:
        return total
    inside = [term for term in terms if set(best) <= set(factors(term))]
    others = [grouped(sp.Add(*group)) for group in (set(terms) - set(inside), inside)]
    parts = [part for one in others for part in (one.args if isinstance(one, sp.Add) else (one,))]
    return sp.Add(*parts, evaluate=False)


def factors(product: sp.Expr) -> tuple[sp.Expr, ...]:
    """Factors with their powers, including those of nested products."""
    return tuple(f for part in sp.Mul.make_args(product) for f in (factors(part) if part.is_Mul else (part,)))


def _shared(terms: Sequence[sp.Expr]) -> list[sp.Expr]:
    """Factors common to all terms; of numbers, a sign or a denominator."""
    first, *rest = (factors(term.as_coeff_Mul()[1]) for term in terms)
    found = [f for f in first if not f.is_Number and all(f in other for other in rest)]
    numbers = [term.as_coeff_Mul()[0] for term in terms]
    below = {x.q if x.is_Rational else 1 for x in numbers}
    if len(below) == 1 and below != {1}:
        found.append(sp.Rational(1, below.pop()))
    return [*found, sp.Integer(-1)] if all(x.is_negative for x in numbers) else found
