"""The variables of the templates of the JAX module: the Program as lines of Python, nothing symbolic."""

from __future__ import annotations

from typing import Any

from eccentric.emission.backends.jax.printer import DIALECT, differentiable
from eccentric.emission.backends.python.module import module, series, stepped
from eccentric.emission.backends.text import used_series
from eccentric.emission.program import COSINE, LEADING_BITS, SINE_RATIO, Program


def view(program: Program, _: str) -> dict[str, Any]:
    """All variables of the templates of the JAX module."""
    return {
        **module(differentiable(program), DIALECT),
        "wraps": program.axis.wraps,
        "leading": LEADING_BITS,
        # Each is in the derivative of the other.
        "polynomials": [series(s.name) for s in (SINE_RATIO, COSINE)] if used_series(program) else [],
        **_states(program),
    }


def _states(program: Program) -> dict[str, Any]:
    """How the hidden states are passed to `next_state`; empty for a model without."""
    states, passed = [q.name for q, _ in program.states], stepped(program)
    return {
        "initial": [repr(float(value)) for _, value in program.states],
        "stepped": [f"state[{states.index(name)}]" if name in states else name for name in passed],
        "logged": [name for name in passed if name not in states],
    }
