"""What is promised of the emitted arithmetic: bounds that `tests/test_accuracy.py` measures.

They hold against 50 digits, inputs and parameters taken as exact, over the whole plane, in the hollow, and
for |theta_m| up to 1e4 rad.
"""

from __future__ import annotations

import sympy as sp

from eccentric.model import Model
from eccentric.model.steps import (
    Backward,
    Forward,
    Gated,
    HalfCosine,
    HalfSine,
    Magnitude,
    Sgn,
    SquareDifference,
)

# Units in the last place of the exact value.
NORMAL_FORCE_ULP = 5
FRICTION_TORQUE_ULP = 6
# In eps of the working precision, of the sizes that `promises` words.
ACCELERATED_EPS = 6
GRADIENT_EPS = 6


def promises(model: Model) -> tuple[str, ...]:
    """One line for each bound that the model has; none where an effect shifts the angle or adds to F_N."""
    inputs = {q.symbol for q in model.inputs}
    F_N = model.expand(model.definition("F_N").symbol)
    if any(step.args[0] not in inputs for step in F_N.atoms(HalfCosine, HalfSine)):
        return ()
    if "alpha_m" in {s.name for s in F_N.free_symbols}:
        return (f"normal_force within {ACCELERATED_EPS} eps (M L (omega_l^2 + |alpha_l|) + weight)",)
    if not _as_derived(F_N):
        return ()
    lines = [f"normal_force within {NORMAL_FORCE_ULP} units in the last place"]
    if _only_the_papers_friction(model):
        lines += [
            f"friction_torque within {FRICTION_TORQUE_ULP} units in the last place",
            f"its derivatives within {GRADIENT_EPS} eps of their greatest value at that speed, any angle",
        ]
    return tuple(lines)


def _as_derived(F_N: sp.Expr) -> bool:
    """Whether it is one product of parameters, speed and the careful steps, no effect added to it."""
    factors = [f for f in sp.Mul.make_args(F_N) if f.has(Magnitude)] or [F_N]
    careful = isinstance(factors[0], Magnitude) and isinstance(factors[0].args[0], SquareDifference)
    return careful or not F_N.has(sp.Add)


def _only_the_papers_friction(model: Model) -> bool:
    """Whether friction is a sum of terms of one sign: load and velocity, and their direction."""
    moving = {model.definition("F_N").symbol, next(q.symbol for q in model.inputs if q.name == "omega_m")}
    return all(
        term.basis.free_symbols - model.parameter_symbols <= moving
        and all(isinstance(f, Sgn | Forward | Backward | Gated) for f in term.basis.atoms(sp.Function))
        for term in model.balance("mechanical").terms
        if term.kind == "friction"
    )
