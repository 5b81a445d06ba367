"""The hidden states one time step later, for any time step: without elapsed time, nothing changes.

A model says what a state becomes over a time step, which is positive. Firmware also passes 0 (the first
sample, a time stamp twice) and less (a counter that ran over). Then the states stay, and nothing that is
computed on the way divides by less than the shortest time step.
"""

from __future__ import annotations

import sympy as sp

from eccentric.emission.program.primitive import BELOW, Pick
from eccentric.model import Definition, Model, quantity
from eccentric.model import vocabulary as v

# In seconds: less than any loop takes, and second differences of a current over it are no overflow in float.
SHORTEST = "1e-9"
_DT, _LEAST = v.dt.symbol, sp.Rational(SHORTEST)
_ELAPSED = Definition(quantity("elapsed", "s", "time step, at least the shortest"), sp.Max(_DT, _LEAST))


def meaning(model: Model) -> str:
    """What `next_state` gives, in words."""
    kept = f", unchanged where dt is less than {SHORTEST} s" if _is_timed(model) else ""
    return f"the hidden states one time step later{kept}"


def updates(model: Model) -> tuple[tuple[str, sp.Expr], ...]:
    """Name and value one time step later of each hidden state; without a time step every call is one."""
    if not _is_timed(model):
        return tuple((state.quantity.name, state.update) for state in model.states)
    return tuple(
        (
            state.quantity.name,
            Pick(_DT, BELOW, _LEAST, state.symbol, state.update.xreplace({_DT: _ELAPSED.symbol})),
        )
        for state in model.states
    )


def definitions(model: Model) -> tuple[Definition, ...]:
    """What the updates need beyond the model's own definitions."""
    return (_ELAPSED,) if _is_timed(model) else ()


def _is_timed(model: Model) -> bool:
    return any(state.update.has(_DT) for state in model.states)
