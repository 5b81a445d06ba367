"""Equations as blocks: on one line where that is short, a long sum one term to a line."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from html import escape
from itertools import groupby
from xml.etree import ElementTree as ET

import sympy as sp

from eccentric.presentation.html.formulas.expression import (
    SPACE,
    Typesetter,
    factors,
    grouped,
    is_letter,
    letter,
    name,
    operator,
    raised,
    row,
)

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


# A formula typed as text within a sentence: letters are typeset, words are kept, and lines may break.


_FUNCTIONS = frozenset({"exp", "sin", "cos", "tanh", "sqrt", "sgn", "max", "min"})
_TOKEN = re.compile(r"[A-Za-z]{2,}(?:-[A-Za-z]{2,})+|[A-Za-z]\w*|\d+(?:\.\d+)?|\s+|.")
_RATE = re.compile(r"d(2?)([A-Za-z])(2?)")
_ONE_TIMES = re.compile(r"(?<![\w.])1 (?=[A-Za-z])")
_BREAKS = frozenset("+-=")
_STOPS = frozenset(",:;.")


@lru_cache(maxsize=1000)
def short_formula(text: str) -> str:
    """HTML of a formula such as "eta |T| sgn w driving, T = G + mu^2 J_l alpha".

    Letters, numbers, functions and signs become MathML, in pieces between which a line may break; w is omega.
    Anything else is a word, or the name of a quantity if a sign is next to it anywhere in the formula. A
    factor of 1 is left out.
    """
    marks = _TOKEN.findall(_ONE_TIMES.sub("", text))
    solid = [k for k, mark in enumerate(marks) if not mark.isspace()]
    pieces = dict(zip(solid, _pieces([marks[k] for k in solid]), strict=True))
    html = ""
    for piece, group in groupby(solid, key=pieces.__getitem__):
        inside = list(group)
        space = " " if html and marks[inside[0] - 1].isspace() else ""
        if piece:
            before = marks[inside[0] - 1 - bool(space)] if html else ","
            binary = marks[inside[0]] in _BREAKS and (before[-1].isalnum() or before in {")", "|"})
            space = "<wbr/>" if binary else space  # the sign has its own space
            html += f"{space}<math>{row(*_set([marks[k] for k in inside], binary=binary))}</math>"
        else:
            html += space + escape("".join(marks[inside[0] : inside[-1] + 1]))
    return html


_SYMBOL = re.compile(
    r"""(?<![\w.,\[\\'"-])(?:[A-Za-z]+_[A-Za-z0-9]{1,3}(?:_(?:pos|neg))?|mu(?=\^))(?:\^\d)?(?![\w\]\[('"]|\.\w)"""
)


def with_symbols(text: str) -> str:
    """HTML of a sentence: its letters with an index, such as B_lN, are typeset, all else is escaped."""
    text = text.replace("R^2", "R²")
    found, end = "", 0
    for mark in _SYMBOL.finditer(text):
        if is_letter(mark[0].partition("^")[0]):
            found += f"{escape(text[end : mark.start()])}<math>{letter(mark[0])}</math>"
            end = mark.end()
    return found + escape(text[end:])


def _pieces(marks: Sequence[str]) -> Iterator[int]:
    """The number of the piece of formula that each mark belongs to, 0 for words and punctuation."""
    names = set(_names(marks))
    depth = piece = 0
    opened, last = False, 0
    for mark in marks:
        depth += (mark == "(") - (mark == ")")
        opened ^= mark == "|"
        word = mark[0].isalpha() and not is_letter(mark) and mark not in _FUNCTIONS
        if (word and mark not in names) or (mark in _STOPS and depth == 0):
            last = 0
        elif last == 0 or (mark in _BREAKS and depth == 0 and not opened):
            piece += 1
            last = piece
        yield last


def _names(marks: Sequence[str]) -> Iterator[str]:
    """Marks next to a sign or within brackets or bars: a word among them is the name of a quantity."""
    opened = False
    for before, mark, after in zip(["", *marks], marks, [*marks[1:], ""], strict=False):
        opened ^= mark == "|"
        if before in set("+-/^(=") or (before == "|" and opened) or after in set("+-/^)="):
            yield mark


def _set(marks: Sequence[str], *, binary: bool = False) -> Iterator[str]:
    """Parts of a formula as MathML; the first is a sign between two of them, if `binary`."""
    k = bars = 0
    while k < len(marks):
        mark = marks[k]
        part, k = _one(mark), k + 1
        if k == 1 and binary:
            part = part.replace("<mo", '<mo form="infix"', 1)
        if mark == "|":
            bars += 1
            part = f'<mo stretchy="false" form="{"prefix" if bars % 2 else "postfix"}">|</mo>'
        if marks[k : k + 1] == ["^"]:
            end = marks.index(")", k) if marks[k + 1] == "(" else k + 1
            exponent = marks[k + 2 : end] if end > k + 1 else marks[k + 1 : k + 2]
            part, k = f"<msup>{part}{row(*_set(exponent))}</msup>", end + 1
        ends = mark[0].isalnum() or mark == ")" or (mark == "|" and bars % 2 == 0)
        apart = ends and k < len(marks) and marks[k][0].isalnum()
        yield f"{part}{SPACE}" if apart else part


def _one(mark: str) -> str:
    if mark[0].isdigit():
        return f"<mn>{mark}</mn>"
    if mark == "sqrt":
        return operator("√")
    if mark[0].isalpha():
        if rate := _RATE.fullmatch(mark):
            return row(
                *(
                    raised(name(x), "<mn>2</mn>") if n else name(x)
                    for x, n in (("d", rate[1]), rate.group(2, 3))
                )
            )
        return name(mark) if mark in _FUNCTIONS else letter(re.sub(r"^w(?=_|$)", "omega", mark))
    return operator(mark, grows=False)
