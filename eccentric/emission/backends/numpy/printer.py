"""NumPy as a language of expressions: how operations are spelled in kernels, and in `_prepare`."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from eccentric.emission.backends.expression import Language
from eccentric.emission.backends.text import number

KERNEL = {
    "sqrt": "np.sqrt({0})",
    "fabs": "abs({0})",
    "sgn": "np.sign({0})",
    "forward": "np.heaviside({0}, 0.0)",
    "backward": "np.heaviside(-({0}), 0.0)",
    "exp": "np.exp({0})",
    "at_most": "np.minimum({0}, {1})",
    "within": "np.clip({0}, -{1}, {1})",
    "in_single": "{0} if c.single else {1}",
    "sine_ratio": "runtime.sine_ratio({0}, c)",
    "cosine": "runtime.cosine({0}, c)",
}
PREPARE = {
    "sqrt": "math.sqrt({0})",
    "fabs": "abs({0})",
    "sin": "math.sin({0})",
    "cos": "math.cos({0})",
    "exp": "math.exp({0})",
    "rounded": "c.rounded({0})",
    "leading": "c.leading({0})",
    "in_single": "{0} if c.single else {1}",
}


def language(
    calls: Mapping[str, str], symbol: Callable[[str], str], pair: Callable[[str], str] = str
) -> Language:
    """NumPy with `calls` as above, `symbol` the spelling of names and `pair` of those that are Pairs."""

    def branches(pairs: list[tuple[str, str]]) -> str:
        text = pairs[-1][0]
        for value, condition in reversed(pairs[:-1]):
            text = f"{value} if {condition} else {text}"
        return text

    return Language(
        symbol=symbol,
        low=lambda name: f"{pair(name)}.low",
        number=number,
        call=lambda name, arguments: calls[name].format(*arguments),
        pick=lambda a, relation, b, x, y: f"np.where({a} {relation} {b}, {x}, {y})",
        branches=branches,
    )
