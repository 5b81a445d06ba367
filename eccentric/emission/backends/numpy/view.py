"""The variables of the templates of module and runtime: the Program as lines of Python, nothing symbolic."""

from __future__ import annotations

from typing import Any

from eccentric.emission.backends.numpy.printer import DIALECT
from eccentric.emission.backends.python.module import module, series, stepped
from eccentric.emission.backends.text import SPLITTING
from eccentric.emission.program import COSINE, SINE_RATIO, Program


def view(program: Program, _: str) -> dict[str, Any]:
    """All variables of the templates of the NumPy module; it contains no digest."""
    common = module(program, DIALECT)
    return {
        **common,
        "needs_math": any("math." in line for line in common["prepare"]),
        "follow": _follow(program),
        "polynomials": [series(s.name) for s in (SINE_RATIO, COSINE)],
        "leading": SPLITTING,
    }


def _follow(program: Program) -> dict[str, Any]:
    """The pass of the hidden states along a log; nothing for a model without states."""
    if not program.states:
        return {}
    initial = {q.name: float(value) for q, value in program.states}
    return {
        "inputs": [name for name in stepped(program) if name not in initial],
        "initial": "{" + ", ".join(f'"{name}": {value!r}' for name, value in initial.items()) + "}",
        "width": len(initial),
    }
