"""C as a language of expressions: how operations are spelled in the working precision and in double."""

from __future__ import annotations

from collections.abc import Callable

from eccentric.emission.backends.expression import Language
from eccentric.emission.backends.text import number
from eccentric.emission.program import Program

REAL = {
    "sqrt": "MODEL_square_root({0})",
    "fabs": "REAL_FABS({0})",
    "sgn": "MODEL_sgn({0})",
    "forward": "MODEL_forward({0})",
    "backward": "MODEL_forward(-({0}))",
    "exp": "REAL_EXP({0})",
    "at_most": "(({0} > {1}) ? {1} : {0})",
    "within": "MODEL_within({0}, {1})",
    "in_single": "REAL_IN_SINGLE({0}, {1})",
    "sine_ratio": "MODEL_sine_ratio({0})",
    "cosine": "MODEL_cosine({0})",
}
DOUBLE = {
    "sqrt": "sqrt({0})",
    "fabs": "fabs({0})",
    "sin": "sin({0})",
    "cos": "cos({0})",
    "exp": "exp({0})",
    "rounded": "(double)(real)({0})",
    "leading": "MODEL_leading({0})",
    "in_single": "REAL_IN_SINGLE({0}, {1})",
}


def language(program: Program, calls: dict[str, str], symbol: Callable[[str], str], literal: str) -> Language:
    """C for a program: `calls` as above, `symbol` the spelling of names, `literal` a mould of numbers."""

    def branches(pairs: list[tuple[str, str]]) -> str:
        text = pairs[-1][0]
        for value, condition in reversed(pairs[:-1]):
            text = f"({condition}) ? {value} : ({text})"
        return text

    return Language(
        symbol=symbol,
        low="{}.low".format,
        number=lambda decimal: literal.format(number(decimal)),
        call=lambda name, arguments: calls[name].replace("MODEL", program.name).format(*arguments),
        pick=lambda a, relation, b, x, y: f"(({a} {relation} {b}) ? {x} : {y})",
        branches=branches,
    )
