"""Equations as blocks: on one line where that is short, a long sum one term to a line."""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree import ElementTree as ET

import sympy as sp

from eccentric.report.formulas.expression import Typesetter
from eccentric.report.formulas.letters import SPACE, operator, raised
from eccentric.report.formulas.reading import factors, grouped

__all__ = ["Line", "aligned", "block", "equation"]

WIDEST = 36
"""Glyphs per line that fit on a phone."""

Line = tuple[str, str, str]
"""Left side, relation sign, and the rest."""
_ADDED = ' class="added"'


def block(body: str) -> str:
    """MathML on a line of its own."""
    return f'<math display="block">{body}</math>'


def aligned(lines: Iterable[Line], marked: Iterable[int] = ()) -> str:
    """Lines as a block, aligned at their left sides and signs; those `marked` have the class "added"."""
    added = set(marked)
    rows = ("".join(f"<mtd>{cell}</mtd>" for cell in line) for line in lines)
    marks = (f"<mtr{_ADDED if k in added else ''}>{cells}</mtr>" for k, cells in enumerate(rows))
    return block(f"<mtable>{''.join(marks)}</mtable>")


def equation(typeset: Typesetter, left: str, right: sp.Expr, relation: str = "=") -> str:
    """An equation as a block.

    Args:
        typeset: prints the right side.
        left: left side, MathML.
        right: the expression; a root that is too long is squared on both sides.
        relation: the sign between them.
    """
    start, whole = f"{left}{operator(relation)}", typeset(right)
    if _width(f"{start}{whole}") <= WIDEST:
        return block(f"{start}{whole}")
    if isinstance(right, sp.Pow) and right.exp == sp.Rational(1, 2):
        return equation(typeset, raised(left, "<mn>2</mn>"), right.base, relation)
    lines = _lines(typeset, grouped(right))
    return aligned((start if k == 0 else "", *line) for k, line in enumerate(lines))


def _lines(typeset: Typesetter, right: sp.Expr) -> list[tuple[str, str]]:
    """Sign and body of each line: the terms of a sum, or of the sum within a product."""
    sums = [f for f in factors(right) if isinstance(f, sp.Add)]
    if isinstance(right, sp.Add) or len(sums) != 1:
        return typeset.terms(right)
    others = [f for f in factors(right) if f is not sums[0]]
    late = [f for f in others if typeset.rank(f) > typeset.rank(sums[0])]
    early = sp.Mul(*(f for f in others if f not in late))
    sign = operator("-") if early.could_extract_minus_sign() else ""
    early = -early if sign else early
    first, *middle = typeset.terms(sums[0])
    before = "" if early == 1 else typeset(early)
    opened = (sign, f"{before}{operator('(', grows=False)}{''.join(first)}")
    after = f"{SPACE}{typeset.product(late)}" if late else ""
    *middle, last = middle
    return [opened, *middle, (last[0], f"{last[1]}{operator(')', grows=False)}{after}")]


def _width(mathml: str) -> float:
    """Approximate width in glyphs."""
    return _glyphs(ET.fromstring(f"<math>{mathml}</math>"))  # noqa: S314 - written here, by `letters`


def _glyphs(element: ET.Element) -> float:
    widths = [_glyphs(child) for child in element]
    if element.tag in {"mfrac", "mover", "mtable"}:
        return max(widths)
    if element.tag in {"msub", "msup", "msubsup"}:
        return widths[0] + 0.7 * max(widths[1:])
    own = len(element.text or "")
    return own + sum(widths)
