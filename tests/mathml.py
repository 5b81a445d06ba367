"""Presentation MathML read back as a number: what a person sees, evaluated."""

from __future__ import annotations

import math
from collections.abc import Mapping
from xml.etree import ElementTree as ET

from sympy.printing.pretty.pretty_symbology import greek_unicode

_LATIN = {letter: name for name, letter in greek_unicode.items()}
_CALLED = ("sin", "cos", "exp", "tanh", "sgn", "max", "min")
_KNOWN = {name: getattr(math, name, None) or {"max": max, "min": min}.get(name) for name in _CALLED}
_KNOWN |= {"sgn": lambda x: (x > 0) - (x < 0), "abs": abs, "sqrt": math.sqrt}


def read(mathml: str) -> tuple[str, str, str]:
    """Left side, relation and right side of an equation; the right side as Python over names of letters.

    A letter with an index is `omega_m`, with a mark above it `F_N__star`; lines of a table are read in order.
    """
    flat: list[str] = []
    _flatten(ET.fromstring(mathml), flat)  # noqa: S314 - made here
    at = next(k for k, part in enumerate(flat) if part in {"=", "→", "←"})
    return "".join(flat[:at]), flat[at], _python(flat[at + 1 :])


def value(python: str, letters: Mapping[str, float]) -> float:
    """The value of a right side, where letters have these values."""
    return float(eval(python, {"__builtins__": {}}, {**_KNOWN, **letters}))  # noqa: S307 - made here


def _flatten(element: ET.Element, flat: list[str]) -> None:
    if element.tag in {"math", "mrow", "mtable", "mtr", "mtd"}:
        for child in element:
            _flatten(child, flat)
    elif element.tag == "mfrac":
        above, below = (_python(_text(child)) for child in element)
        flat.append(f"(({above})/({below}))")
    elif element.tag == "msqrt":
        flat.append(f"sqrt({_python([part for child in element for part in _text(child)])})")
    elif element.tag in {"msub", "msup", "msubsup"}:
        inside = [_text(child) for child in element]
        flat += _scripted(element.tag, ["".join(one) for one in inside], inside)
    elif element.tag != "mspace":
        text = element.text or ""
        mark = element.get("form")
        flat.append(
            {"prefix": "abs(", "postfix": ")"}[mark] if text == "|" and mark else _LATIN.get(text, text)
        )


def _text(element: ET.Element) -> list[str]:
    flat: list[str] = []
    _flatten(element, flat)
    return [_python(flat)] if element.tag == "mrow" else flat


def _scripted(tag: str, texts: list[str], inside: list[list[str]]) -> list[str]:
    """A letter with an index, a mark or a power; a called function keeps its power for its value."""
    base = f"{texts[0]}_{texts[1]}" if tag != "msup" else texts[0]
    if tag == "msub":
        return [base]
    above = texts[-1]
    marks = {"*": "star", "+": "plus", "−": "minus", "′": "rate", "″": "rate2", "0": "zero"}
    if above in marks:
        return [f"{base}__{marks[above]}"]
    if base in _CALLED:
        return [f"{base}^{above}"]
    return ["(", *([base] if tag == "msubsup" else inside[0]), "**", above.replace("−", "-"), ")"]


def _python(flat: list[str]) -> str:
    """Parts side by side as a product; a function takes what follows, up to a sign or another function."""
    python, k = "", 0
    while k < len(flat):
        part, power = [*flat[k].split("^"), ""][:2]
        if (
            python
            and (python[-1].isalnum() or python[-1] in ")_")
            and (part[0].isalnum() or part in {"(", "abs(", "["})
        ):
            python += "*"
        if part in _CALLED:
            end = _argument(flat, k + 1)
            inside = _python(flat[k + 1 : end])
            python += (
                f"({part}({inside.removeprefix('(').removesuffix(')') if ',' in inside else inside})"
                + (f"**{power})" if power else ")")
            )
            k = end
            continue
        python += {"−": "-", "·": "*", "[": "(1.0 if ", "]": " else 0.0)"}.get(part, part)
        k += 1
    return python


def _argument(flat: list[str], start: int) -> int:
    """Where the argument ends: after its parentheses, or before a sign or a function."""
    depth, k = 0, start
    while k < len(flat):
        depth += flat[k].count("(") - flat[k].count(")")
        k += 1
        if depth == 0 and (
            flat[start] == "("
            or k == len(flat)
            or flat[k] in {"+", "−", ")", "]", ">", "<", ","}
            or flat[k].split("^")[0] in _CALLED
        ):
            return k
    return k
