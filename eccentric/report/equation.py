"""The friction of a model as MathML, one term to a line, and what its letters stand for."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

import sympy as sp
from sympy.printing.mathml import MathMLPresentationPrinter
from sympy.printing.pretty.pretty_symbology import greek_unicode

from eccentric.model import Model
from eccentric.model import vocabulary as v
from eccentric.model.balance import KINDS, Term
from eccentric.model.steps import Step, meaning
from eccentric.report.data import Equation

__all__ = ["friction_equations"]


_TIMES = "<mo>&InvisibleTimes;</mo>"


class _Printer(MathMLPresentationPrinter):
    """Letters as in the paper, longer names as in code, gates as a condition in brackets."""

    def _print_Symbol(self, sym: sp.Symbol, style: str = "plain") -> Any:
        head, *tail = sym.name.split("_")
        if not tail or (len(head) > 2 and head not in greek_unicode):
            return self._element("mi", greek_unicode.get(sym.name, sym.name))
        index = self._element("mi", "_".join(greek_unicode.get(part, part) for part in tail))
        return self._element("msub", self._element("mi", greek_unicode.get(head, head)), index)

    def _print_sign(self, e: sp.Expr) -> Any:
        return self._element("mrow", self._element("mi", "sgn"), *self._bracketed("(", e.args[0], ")"))

    def _print_Heaviside(self, e: sp.Expr) -> Any:
        above = (self._element("mo", ">"), self._element("mn", "0"))
        opened, inside, closed = self._bracketed("[", e.args[0], "]")
        return self._element("mrow", opened, inside, *above, closed)

    def _bracketed(self, opening: str, e: sp.Basic, closing: str) -> tuple[Any, Any, Any]:
        return self._element("mo", opening), self._print(e), self._element("mo", closing)

    def _element(self, name: str, *content: Any) -> Any:
        element = self.dom.createElement(name)
        for part in content:
            # SymPy's own text nodes are written as they are.
            element.appendChild(self.dom.createTextNode(escape(part)) if isinstance(part, str) else part)
        return element


def friction_equations(model: Model, effects: Sequence[Any]) -> list[Equation]:
    """Friction torque of a model, what effects add besides friction, and the definitions both use.

    Args:
        model: with the effects in it.
        effects: those in it; their terms are marked (class "added").
    """
    own = {term.name for effect in effects for terms in effect.change.terms.values() for term in terms}
    friction = [term for term in model.balance("mechanical").terms if term.kind == "friction"]
    shown = [_sum("f", [(term, 1) for term in friction], own, "friction torque [N m, motor side]")]
    used = [term.value for term in friction]
    for there in model.balances:
        others = [term for term in there.terms if term.name in own and term not in friction]
        if others:
            note = f"what else is added to the {there.name} balance [{there.unit}]"
            shown.append(
                _sum(f"Delta_{there.name}", [(term, KINDS[term.kind]) for term in others], own, note)
            )
            used += [term.value for term in others]
    replaced = {old for effect in effects for old in effect.change.replaces}
    used += [new for effect in effects for new in effect.change.replaces.values()]
    return [*shown, *_definitions(model, used, replaced)]


def _sum(left: str, terms: Iterable[tuple[Term, int]], own: set[str], note: str) -> Equation:
    rows = []
    for k, (term, sign) in enumerate(terms):
        value = _readable(sign * term.value)
        minus = value.could_extract_minus_sign()
        operator = "−" if minus else "+"
        first = "" if k else f"{_mathml(sp.Symbol(left))}<mo>=</mo>"
        operator = f"<mo>{operator}</mo>" if k or minus else ""
        marked = ' class="added"' if term.name in own else ""
        body = _mathml(-value if minus else value)
        rows.append(f"<mtr{marked}><mtd>{first}</mtd><mtd>{operator}</mtd><mtd>{body}</mtd></mtr>")
    return Equation(f'<math display="block"><mtable>{"".join(rows)}</mtable></math>', note)


def _definitions(model: Model, used: Sequence[sp.Expr], replaced: set[sp.Symbol]) -> list[Equation]:
    """What the letters in expressions stand for, followed down to inputs and parameters."""
    known = {d.symbol: d for d in model.definitions}
    waiting = sorted(set().union(*(e.free_symbols for e in used)) & set(known), key=str)
    theta_l, mu = v.theta_l.symbol, v.mu.symbol
    shown: list[Equation] = []
    done: set[sp.Symbol] = set()
    while waiting:
        symbol = waiting.pop(0)
        if symbol in done:
            continue
        done.add(symbol)
        left, right = _plain_form(model, symbol, replaced) or (symbol, known[symbol].value)
        waiting += sorted((right.free_symbols & set(known)) - done, key=str)
        body = f"{_mathml(left)}<mo>=</mo>{_mathml(_readable(right))}"
        quantity = known[symbol].quantity
        shown.append(
            Equation(f'<math display="block">{body}</math>', f"{quantity.meaning} [{quantity.unit}]")
        )
    angle = f"{_mathml(theta_l)}<mo>=</mo>{_mathml(mu * v.theta_m.symbol)}"
    if any(_mathml(theta_l) in equation.mathml for equation in shown) or any(
        _readable(e).has(theta_l) for e in used
    ):
        shown.append(Equation(f'<math display="block">{angle}</math>', f"{v.theta_l.meaning} [rad]"))
    return shown


def _plain_form(model: Model, symbol: sp.Symbol, replaced: set[sp.Symbol]) -> tuple[sp.Expr, sp.Expr] | None:
    """The derivation's own formula of a quantity or its square, where no effect has changed it since."""
    inputs = {q.symbol for q in (*model.inputs, *model.parameters)}
    for equation in model.equations:
        left, right = equation.left, equation.right
        if left not in (symbol, symbol**2) or not isinstance(right, sp.Expr) or right.has(Step):
            continue
        if right.free_symbols <= inputs and not right.free_symbols & replaced:
            return left, right
    return None


def _readable(expression: sp.Expr) -> sp.Expr:
    """The careful steps as what they mean, the link angle by its letter, fitted numbers with four digits."""
    plain = meaning(expression)
    if plain.has(sp.sin, sp.cos):
        plain = sp.trigsimp(plain)
    plain = plain.subs(v.mu.symbol * v.theta_m.symbol, v.theta_l.symbol).replace(sp.exp, sp.Function("exp"))
    long = {x: sp.Float(x, 4) for x in plain.atoms(sp.Rational) if x.q > 1000}
    return plain.xreplace(long)


def _mathml(expression: sp.Basic) -> str:
    # Between a letter and a function, a product wants some space.
    return _Printer().doprint(expression).replace(_TIMES, f'{_TIMES}<mspace width="0.17em"></mspace>')
