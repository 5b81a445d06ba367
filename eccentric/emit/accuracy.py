"""What is promised of the emitted arithmetic: bounds that `tests/test_accuracy*.py` measure.

They hold against 50 digits, inputs and parameters taken as exact, over the whole plane, in the hollow, and
for angles of motor and link up to 1e4 rad. Where Gappa proves one, the line says so.
"""

from __future__ import annotations

import sympy as sp

from eccentric.emit.shift import split
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
SHIFTED_GRADIENT_EPS = 8  # the parts of the shift are further roundings where the link is far from the top
# Of the link angle, in rad; the parts of a shift by half a turn are not exact where theta_m is nearly 0.
LARGEST_SHIFT = 3


def promises(model: Model) -> tuple[str, ...]:
    """One line for each bound that the model has; none where an effect bends the angle or adds to F_N."""
    inputs = {q.symbol for q in model.inputs}
    F_N = model.expand(model.definition("F_N").symbol)
    angles = {
        step.args[0]: split(step.args[0], model.parameter_symbols) for step in F_N.atoms(HalfCosine, HalfSine)
    }
    if any(moving not in inputs for moving, _ in angles.values()):
        return ()
    steady = "alpha_m" not in {s.name for s in F_N.free_symbols}
    if steady and not _as_derived(F_N):
        return ()
    shifted = any(shift for _, shift in angles.values())
    slope = SHIFTED_GRADIENT_EPS if shifted else GRADIENT_EPS
    lines = _steady(model, slope if angles else None) if steady else _accelerated(model)
    # The paper's own tilt is a parameter like any other; an effect's enters the critical velocity.
    rounded = sorted(map(str, F_N.atoms(sp.sin, sp.cos))) if steady else []
    given = [f"{', '.join(rounded)} in double precision as exact, too"] if rounded else []
    given += [f"the link angle shifted by {LARGEST_SHIFT} rad at most"] if shifted else []
    return (*lines, *(["  " + "; ".join(given)] if given else []))


def _steady(model: Model, slope: int | None) -> list[str]:
    """The bounds of a model without acceleration; its slopes are relative, too, where no angle is taken."""
    lines = [f"normal_force within {NORMAL_FORCE_ULP} units in the last place"]
    lines = (
        [f"{lines[0]} (proved for parameters and speeds of 1e-6 to 1e6)"] if _few_factors(model) else lines
    )
    if not _of_one_sign(model):
        return lines
    ulp = f"within {FRICTION_TORQUE_ULP} units in the last place"
    greatest = f"within {slope} eps of its greatest value at that speed, any angle"
    return [
        *lines,
        f"friction_torque, mechanical_friction_torque, friction_torque_jacobian {ulp}",
        f"friction_torque_gradient {ulp if slope is None else greatest}",
    ]


def _accelerated(model: Model) -> list[str]:
    """With an acceleration F_N vanishes along a curve, and its direction, which a gradient needs, is lost."""
    lines = [f"normal_force within {ACCELERATED_EPS} eps (M L (omega_l^2 + |alpha_l|) + weight)"]
    if not _of_one_sign(model):
        return lines
    friction = f"within {ACCELERATED_EPS} eps of the friction at a load of that size"
    return [*lines, f"friction_torque, mechanical_friction_torque {friction}"]


def _as_derived(F_N: sp.Expr) -> bool:
    """Whether it is one product of parameters, speed and the careful steps, no effect added to it."""
    factors = [f for f in sp.Mul.make_args(F_N) if f.has(Magnitude)] or [F_N]
    careful = isinstance(factors[0], Magnitude) and isinstance(factors[0].args[0], SquareDifference)
    return careful or not F_N.has(sp.Add)


def _few_factors(model: Model) -> bool:
    """Whether F_N is a product with no more roundings than its bound has units: then Gappa proves it."""
    powers = model.expand(model.definition("F_N").symbol).as_powers_dict()
    plain = all(base.is_Symbol and power.is_Integer and power > 0 for base, power in powers.items())
    return plain and sum(powers.values()) - 1 <= NORMAL_FORCE_ULP


def _of_one_sign(model: Model) -> bool:
    """Whether friction sums terms of one sign, and so do its slopes: powers of load and velocity."""
    F_N, omega_m = model.definition("F_N").symbol, next(q.symbol for q in model.inputs if q.name == "omega_m")

    def is_power(basis: sp.Expr) -> bool:
        moving = {f: sp.Integer(1) for f in basis.atoms(Sgn, Forward, Backward)}
        plain = basis.replace(Gated, sp.Mul).xreplace(moving)
        return plain.free_symbols - model.parameter_symbols <= {F_N, omega_m} and plain.is_polynomial(
            F_N, omega_m
        )

    return all(
        is_power(term.basis)
        and all(s.is_nonnegative for s in term.value.free_symbols & model.parameter_symbols)
        for balance in model.balances
        for term in balance.terms
        if term.kind in ("friction", "back_emf")
    )
