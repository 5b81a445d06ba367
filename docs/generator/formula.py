"""Formulas of effects as LaTeX, and LaTeX as MathML: typeset by the browser, without a script or a font."""

from __future__ import annotations

from collections.abc import Iterator

import sympy as sp
from docutils.utils.math.latex2mathml import tex2mathml
from sympy.printing.latex import LatexPrinter

from eccentric.effects import Effect
from eccentric.model import vocabulary as v
from eccentric.model.steps import Gated, HalfCosine, HalfSine, Magnitude

_LETTERS = {"temperature": "T", "dt": r"\Delta t", "omega": r"\omega", "theta": r"\theta", "alpha": r"\alpha"}
_LETTERS |= {"mu": r"\mu", "phi": r"\phi", "rho": r"\rho", "tau": r"\tau", "eta": r"\eta"}
_LEFT = {"mechanical": r"\Delta\tau", "electrical": r"\Delta u"}


class _Printer(LatexPrinter):
    """Symbols by their names in code, steps by what they mean."""

    def _print_Symbol(self, expr: sp.Symbol, style: str = "plain") -> str:
        del style
        head, *tail = (_letter(part) for part in expr.name.split("_"))
        return rf"{head}_{{{','.join(tail)}}}" if tail else head

    def _print_Rational(self, expr: sp.Rational) -> str:
        zeros = len(str(expr.q)) - 1
        if expr.p == 1 and zeros > 4 and expr.q == 10**zeros:
            return f"10^{{-{zeros}}}"
        return super()._print_Rational(expr) if expr.q < 5 else f"{float(expr):g}"

    def _print_Sgn(self, expr: sp.Expr, exp: str = "") -> str:
        power = f"^{{{exp}}}" if exp else ""
        return rf"\operatorname{{sgn}}{power}\left({self._print(expr.args[0])}\right)"

    def _print_Forward(self, expr: sp.Expr) -> str:
        return rf"\left[{self._print(expr.args[0])} > 0\right]"

    def _print_Backward(self, expr: sp.Expr) -> str:
        return rf"\left[{self._print(expr.args[0])} < 0\right]"


def _letter(part: str) -> str:
    return _LETTERS.get(part, part if len(part) == 1 or part.isdigit() else rf"\mathrm{{{part}}}")


def latex(expression: sp.Expr) -> str:
    """The expression with plain sines, cosines and roots in place of the careful steps."""
    expression = expression.replace(_product, _whole_angle)
    expression = expression.subs(v.mu.symbol * v.theta_m.symbol, v.theta_l.symbol)
    expression = expression.replace(Magnitude, lambda p, q: sp.sqrt(p**2 + q**2, evaluate=False))
    return _Printer().doprint(expression.replace(Gated, sp.Mul))


def _product(expression: sp.Basic) -> bool:
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


def equations(effect: Effect) -> Iterator[str]:
    """The effect's equations in LaTeX: what it adds, replaces or scales, then its definitions and states."""
    for balance, terms in effect.change.terms.items():
        yield f"{_LEFT[balance]} = {latex(sp.Add(*(term.value for term in terms)))}"
    for old, new in effect.change.replaces.items():
        yield rf"{latex(old)} \;\to\; {latex(new)}"
    for factor in dict.fromkeys(effect.change.scales.values()):
        roles = sorted(role for role, by in effect.change.scales.items() if by == factor)
        which = r",\,".join(rf"\mathrm{{{role}}}" for role in roles)
        yield rf"f_{{{which}}} \;\to\; {latex(factor)} \cdot f_{{{which}}}"
    for definition in effect.change.definitions:
        if not definition.value.is_number:  # a number stands in the table
            yield f"{latex(definition.symbol)} = {latex(definition.value)}"
    for state in effect.change.states:
        yield rf"{latex(state.symbol)} \;\leftarrow\; {latex(state.update)}"


def mathml(text: str, *, block: bool) -> str:
    """LaTeX as MathML."""
    return tex2mathml(text, as_block=block)
