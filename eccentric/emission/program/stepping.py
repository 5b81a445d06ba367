"""The hidden states one time step later, for any time step: without elapsed time, nothing changes.

A model defines the update of a state over a positive time step. Firmware also passes 0 (the first sample, a
repeated time stamp) and negative ones (a counter overflow). Then the states stay unchanged, and nothing in
the computation divides by less than the shortest time step.
"""

from __future__ import annotations

import sympy as sp

from eccentric.emission.program.primitive import BELOW, Pick
from eccentric.model import Definition, Model, quantity
from eccentric.model import vocabulary as v

# In seconds: shorter than any loop, and second differences of a current over it do not overflow in float.
SHORTEST = "1e-9"
_DT, _LEAST = v.dt.symbol, sp.Rational(SHORTEST)
_ELAPSED = Definition(quantity("elapsed", "s", "time step, at least the shortest"), sp.Max(_DT, _LEAST))


def meaning(model: Model) -> str:
    """The result of `next_state`, in words."""
    kept = f", unchanged if dt is less than {SHORTEST} s" if _is_timed(model) else ""
    return f"the hidden states one time step later{kept}"


def updates(model: Model) -> tuple[tuple[str, sp.Expr], ...]:
    """Name and value one time step later of each hidden state; without dt, every call is one time step."""
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
    """Definitions that the updates need in addition to the model's."""
    return (_ELAPSED,) if _is_timed(model) else ()


def _is_timed(model: Model) -> bool:
    return any(state.update.has(_DT) for state in model.states)
