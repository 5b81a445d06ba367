"""Letters, numbers and names as MathML: Greek as Greek, what follows an underscore as an index."""

from __future__ import annotations

from html import escape

import sympy as sp
from sympy.printing.pretty.pretty_symbology import greek_unicode

__all__ = ["SPACE", "is_letter", "letter", "name", "number", "operator", "raised", "row"]

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
