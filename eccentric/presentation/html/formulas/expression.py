"""An expression on one line, with factors and terms in the order that a person would choose."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from itertools import combinations

import sympy as sp
from sympy.core.function import Application
from sympy.core.relational import Relational
from sympy.printing.pretty.pretty_symbology import greek_unicode

from eccentric.model import HalfCosine, HalfSine, Magnitude, Quantity, meaning
from eccentric.model import vocabulary as v

# Letters, numbers and names as MathML: Greek as Greek, what follows an underscore as an index.


SPACE = '<mspace width="0.17em"></mspace>'
"""Space between a function and its neighbours."""

_SHOWN = {"-": "−", "'": "′", "''": "″"}


def row(*parts: str) -> str:
    """Parts of a formula as one element."""
    return parts[0] if len(parts) == 1 else f"<mrow>{''.join(parts)}</mrow>"


def operator(sign: str, *, grows: bool = True) -> str:
    """A sign or a bracket; one that grows is as high as its content."""
    attribute = "" if grows else ' stretchy="false"'
    return f"<mo{attribute}>{escape(_SHOWN.get(sign, sign))}</mo>"


def name(text: str) -> str:
    """A name as spelled; MathML sets names of several letters upright."""
    return f"<mi>{escape(text)}</mi>"


def number(x: sp.Number) -> str:
    """A nonnegative number: an integer, a simple fraction, a power of ten, or four digits."""
    if x.is_Integer:
        return f"<mn>{x}</mn>"
    if x.is_Rational and x.p == 1 and x.q >= 10**4 and str(x.q).rstrip("0") == "1":
        return f"<msup><mn>10</mn><mn>−{len(str(x.q)) - 1}</mn></msup>"
    if x.is_Rational and x.q < 5:
        return f"<mfrac><mn>{x.p}</mn><mn>{x.q}</mn></mfrac>"
    digits, _, exponent = f"{float(x):.4g}".partition("e")
    if not exponent:
        return f"<mn>{digits}</mn>"
    return (
        f"<mn>{digits}</mn><mo>·</mo><msup><mn>10</mn><mn>{str(int(exponent)).replace('-', '−')}</mn></msup>"
    )


def is_letter(text: str) -> bool:
    """Whether a name is a letter, with or without an index: x, omega_m, B_lN, but not load_torque."""
    head = text.split("_", 1)[0]
    return len(head) == 1 or head in greek_unicode


def letter(notation: str) -> str:
    """A letter from its name in code: `eta_2`, `B_lN^+`, `Delta k_e`, `i^'`; other names as spelled."""
    before, _, rest = notation.rpartition(" ")
    if before:
        return row(letter(before), letter(rest))
    text, _, above = rest.partition("^")
    if not is_letter(text):
        return name(notation)
    head, *index = (_part(part) for part in text.split("_"))
    below = index[0] if len(index) == 1 else f"<mrow>{operator(',').join(index)}</mrow>" if index else ""
    lettered = f"<msub>{head}{below}</msub>" if below else head
    return raised(lettered, _part(above)) if above else lettered


def raised(body: str, exponent: str) -> str:
    """A letter with an exponent, above its index if it has one."""
    if body.startswith("<msub>"):
        return f"<msubsup>{body.removeprefix('<msub>').removesuffix('</msub>')}{exponent}</msubsup>"
    return f"<msup>{body}{exponent}</msup>"


def _part(text: str) -> str:
    if text.isdigit():
        return f"<mn>{text}</mn>"
    return name(greek_unicode.get(text, text)) if text.isalnum() else operator(text)


# Expressions as a person writes them: plain functions for stable forms, common factors extracted.


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


# Order of the factors of a product: gains of the drive, coefficients and a model's own quantities, these,
# others.
_GAINS = (v.R, v.k_i, v.k_e)
_BODIES = (v.mu, v.M, v.M_l, v.g, v.L, v.J, v.J_m, v.J_l, v.F_N, v.F_T)
_SIGNALS = (v.i, v.u, v.t, v.dt, v.theta_m, v.theta_l, v.omega_m, v.omega_l, v.alpha_m, v.alpha_l)
_OWN, _LATE = 1, 10
_REST = (sp.Pow, sp.Abs, sp.Add, sp.exp, sp.sin, sp.cos, sp.tanh, sp.Heaviside, sp.sign)
_SUM = (_LATE + _REST.index(sp.Add), 0)
_NAMES = {sp.sign: "sgn", sp.Max: "max", sp.Min: "min"}
_BARE = (sp.sin, sp.cos, sp.tanh, sp.sign)
"""Functions that need no parentheses around a letter."""
_VOCABULARY = {q.symbol: q for q in vars(v).values() if isinstance(q, Quantity)}


class Typesetter:
    """Prints expressions in the letters of their quantities.

    If quantities share a letter, the paper's keeps it and the others are printed by their names in code.
    """

    def __init__(self, quantities: Iterable[Quantity] = ()) -> None:
        """All quantities of the formulas; those outside the vocabulary in their order within a product."""
        given = {q.symbol: q for q in quantities}
        own = {symbol: q for symbol, q in given.items() if symbol not in _VOCABULARY}
        taken = [_mark(q) for q in given.values()]
        self._letters = {symbol: letter(_mark(q)) for symbol, q in _VOCABULARY.items()}
        for symbol, q in own.items():
            self._letters[symbol] = name(q.name) if taken.count(_mark(q)) > 1 else letter(_mark(q))
        self._spelled = {
            s for s, x in self._letters.items() if x.startswith(("<mi>", "<mrow>")) and len(x) > 10
        }
        groups = (_GAINS, tuple(own.values()), _BODIES, _SIGNALS)
        self._order = {q.symbol: (k, n) for k, group in enumerate(groups) for n, q in enumerate(group)}

    def __call__(self, e: sp.Basic) -> str:
        """Print an expression."""
        e = grouped(e) if isinstance(e, sp.Add) else e
        if isinstance(e, sp.Add):
            return row(*(f"{sign}{body}" for sign, body in self.terms(e)))
        if isinstance(e, sp.Mul) or (isinstance(e, sp.Pow) and e.exp.could_extract_minus_sign()):
            return self._product(e)
        if isinstance(e, sp.Pow):
            return self._power(e)
        if isinstance(e, sp.Symbol):
            return self._letters.get(e) or letter(e.name)
        if isinstance(e, sp.Number):
            return number(e) if e.is_nonnegative else f"{operator('-')}{number(-e)}"
        return self._function(e)

    def terms(self, total: sp.Expr) -> list[tuple[str, str]]:
        """Sign and magnitude of each term of a sum, positive ones first; the first term has no plus sign."""
        signed = [(term.could_extract_minus_sign(), term) for term in sp.Add.make_args(total)]
        powers = max(_degree(term) for _, term in signed) > 1
        signed.sort(key=lambda found: (found[0], *_place(found[1], powers=powers)))
        signs = [
            operator("-") if minus else operator("+") if k else "" for k, (minus, _) in enumerate(signed)
        ]
        return [(sign, self(-t if minus else t)) for sign, (minus, t) in zip(signs, signed, strict=True)]

    def product(self, parts: Sequence[sp.Expr]) -> str:
        """Factors side by side, functions separated by a thin space."""
        ordered = sorted(parts, key=self.rank)
        found = [self._parenthesised(f) if isinstance(f, sp.Add) else self(f) for f in ordered]
        for k in range(1, len(found)):
            tight = {type(_base(f)) for f in ordered[k - 1 : k + 1]} <= {sp.Symbol, sp.Add}
            tight &= not self._spelled & {_base(f) for f in ordered[k - 1 : k + 1]}
            found[k] = found[k] if tight else f"{SPACE}{found[k]}"
        return row(*found)

    def rank(self, factor: sp.Expr) -> tuple[int, int]:
        """The position of a factor in its product."""
        base = _base(factor)
        if base in self._order:
            return self._order[base]
        if base.is_Symbol:
            return (_OWN, -1)
        return (_LATE + _REST.index(type(base)) if type(base) in _REST else 9, 0)

    def _product(self, e: sp.Expr) -> str:
        parts = [inner for f in factors(e) for inner in factors(grouped(f))]
        count = sp.Mul(*(f for f in parts if f.is_Number))
        sign, count = ([operator("-")], -count) if count.is_negative else ([], count)
        parts = [f for f in parts if not f.is_Number]
        below = [1 / f for f in parts if isinstance(f, sp.Pow) and f.exp.could_extract_minus_sign()]
        above = [f for f in parts if 1 / f not in below]
        if count.is_Rational and count.q != 1 and (below or count.q < 5):
            below, count = [sp.Integer(count.q), *below], sp.Integer(count.p)
        counted = [number(count)] if count != 1 else []
        if not below:
            return row(*sign, *counted, self.product(above))
        beside = [f for f in above if self.rank(f) >= _SUM]
        if len(beside) == len(above):
            beside = [f for f in above if not isinstance(f, sp.Add)]
        over = [f for f in above if f not in beside]
        if len(below) == 2 and below[0].is_Symbol | below[0].is_Pow and isinstance(below[1], sp.Add):
            below = [sp.expand(sp.Mul(*below))]  # x^2 (1 + y^2/x^2)
        one = [] if over or counted else ["<mn>1</mn>"]
        fraction = f"<mfrac>{row(*one, *counted, *self._side(over))}{row(*self._side(below))}</mfrac>"
        return row(*sign, fraction, *([SPACE, self.product(beside)] if beside else []))

    def _side(self, parts: Sequence[sp.Expr]) -> list[str]:
        """Numerator or denominator of a fraction; a single sum needs no parentheses there."""
        return [self(parts[0]) if len(parts) == 1 else self.product(parts)] if parts else []

    def _power(self, e: sp.Pow) -> str:
        base, exponent = e.args
        if exponent == sp.Rational(1, 2):
            return f"<msqrt>{self(base)}</msqrt>"
        if isinstance(base, _BARE):
            return self._function(base, self(exponent))
        body = self(base)
        if not isinstance(base, sp.Symbol | sp.Abs) or body.startswith(("<msup", "<msubsup", "<mrow")):
            body = self._parenthesised(base)
        return raised(body, self(exponent))

    def _function(self, e: sp.Basic, power: str = "") -> str:
        if isinstance(e, sp.Abs):
            return f'<mrow><mo form="prefix">|</mo>{self(e.args[0])}<mo form="postfix">|</mo></mrow>'
        if isinstance(e, sp.Heaviside):
            side = e.args[0]
            sign, side = ("<", -side) if side.could_extract_minus_sign() else (">", side)
            return row(operator("["), self(side), operator(sign), "<mn>0</mn>", operator("]"))
        if isinstance(e, sp.Piecewise):
            cells = ((self(x), "<mtext>else</mtext>" if c == sp.true else self(c)) for x, c in e.args)
            cases = "".join(f"<mtr><mtd>{x}</mtd><mtd>{condition}</mtd></mtr>" for x, condition in cells)
            return row(operator("{"), f"<mtable>{cases}</mtable>")
        if isinstance(e, Relational):
            return row(self(e.lhs), operator("=" if isinstance(e, sp.Eq) else str(e.rel_op)), self(e.rhs))
        if not isinstance(e, Application):
            return name(str(e))
        called = name(_NAMES.get(e.func) or str(e.func))
        called = f"<msup>{called}{power}</msup>" if power else called
        inside = operator(",").join(self(x) for x in e.args)
        if isinstance(e, _BARE) and e.args[0].as_coeff_Mul()[1].is_Symbol:
            return row(called, SPACE, inside)
        return row(called, f"<mrow>{operator('(')}{inside}{operator(')')}</mrow>")

    def _parenthesised(self, e: sp.Basic) -> str:
        return f"<mrow>{operator('(')}{self(e)}{operator(')')}</mrow>"


def _mark(q: Quantity) -> str:
    return q.letter or q.name


def _base(factor: sp.Expr) -> sp.Expr:
    """The base of a power; a root does not count as one."""
    power = isinstance(factor, sp.Pow) and factor.exp.is_Integer
    return factor.base if power else factor


def _degree(term: sp.Expr) -> int:
    """Power of the speed in a term of a polynomial."""
    powers = [int(f.exp) for f in factors(term) if f.is_Pow and f.base == v.omega_m.symbol]
    return max(powers, default=int(term.has(v.omega_m.symbol)))


def _place(term: sp.Expr, *, powers: bool) -> tuple[int, int, int, str]:
    """Order of terms: 1 +, powers of the speed, letters, gravity, inertia, the rest; a bare sign last."""
    one = term.is_number and term >= 1
    kinds = (one, powers, term.is_Symbol, term.has(v.g.symbol), term.has(v.alpha_m.symbol), True)
    return (kinds.index(True), -_degree(term) if powers else 0, int(term.has(sp.sign)), str(term))
