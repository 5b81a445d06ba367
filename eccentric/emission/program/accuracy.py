"""What is promised of the emitted arithmetic: bounds that `tests/test_accuracy*.py` measure.

They are relative to 50 digits, with inputs and parameters taken as exact, over the whole plane, including the
zero of F_N, for motor angles up to 1e4 rad. Bounds proved by Gappa are marked. The others were found by a
search over states and parameters, and are stated one to two units above the worst case found.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from typing import NamedTuple

import sympy as sp

from eccentric.emission.program.digits import TURN_BITS
from eccentric.emission.program.functions import normal_force
from eccentric.emission.program.one_sided import moving
from eccentric.emission.program.shift import split
from eccentric.model import (
    Gated,
    HalfCosine,
    HalfSine,
    Magnitude,
    Model,
    Quantity,
    SquareDifference,
)
from eccentric.model import vocabulary as v


class Bound(NamedTuple):
    """The largest error in units, with any parameters and with those of Table 1."""

    anywhere: int
    table_1: int

    def within(self, unit: str, table_1: bool) -> str:
        """The bound in words, with a tighter one if the defaults of the model are Table 1."""
        tighter = f" (Table 1: {self.table_1})" if table_1 and self.table_1 < self.anywhere else ""
        return f"within {self.anywhere}{tighter} {unit}"


# In units in the last place of the exact value; without an angle the slopes are as accurate as the friction.
PROVED_FORCE = Bound(5, 5)
NORMAL_FORCE = Bound(8, 7)
FRICTION_TORQUE = Bound(9, 8)
WITHOUT_ANGLE = Bound(6, 6)
# In eps of the working precision, of the sizes that `promises` words.
GRADIENT = Bound(15, 7)
ACCELERATED_FORCE = Bound(12, 12)
ACCELERATED_FRICTION = Bound(12, 12)
ACCELERATED_GRADIENT = Bound(12, 7)
# Of the link angle, in rad; the parts of a shift by half a turn are not exact where theta_m is nearly 0.
LARGEST_SHIFT = 3
LARGEST_ANGLE = 10_000  # of the motor, in rad
# A link that turns further would pass more half turns within that angle than are subtracted exactly.
LARGEST_RATIO = int(2 ** min(TURN_BITS.values()) * math.pi / LARGEST_ANGLE)

# F_N of case C1, eq (8), as emitted: the input of Gappa.
_CENTRIFUGAL = v.M.symbol * v.L.symbol * (v.mu.symbol * v.omega_m.symbol) ** 2


def promises(model: Model) -> tuple[str, ...]:
    """One line for each bound that the model has; none if an effect changes the angle or adds to F_N."""
    inputs = {q.symbol for q in model.inputs}
    force = normal_force(model)
    if force is None:
        return ()
    F_N = model.expand(force)
    angles = {
        step.args[0]: split(step.args[0], model.parameter_symbols) for step in F_N.atoms(HalfCosine, HalfSine)
    }
    if any(moving not in inputs for moving, _ in angles.values()):
        return ()
    steady = "alpha_m" not in {s.name for s in F_N.free_symbols}
    if not _as_derived(F_N, steady):
        return ()
    shifted = any(shift for _, shift in angles.values())
    tabled = _of_table_1(model)
    lines = _steady(model, bool(angles), tabled) if steady else _accelerated(model, tabled)
    # The paper's own tilt is an ordinary parameter; that of an effect enters the critical velocity.
    rounded = sorted(map(str, F_N.atoms(sp.sin, sp.cos))) if steady else []
    given = [f"{', '.join(rounded)} in double precision as exact, too"] if rounded else []
    given += [f"the link angle shifted by {LARGEST_SHIFT} rad at most"] if shifted else []
    given += (
        ["Table 1: with its parameters, mu 1/5 or 1/30"] if any("Table 1" in line for line in lines) else []
    )
    return (*lines, *(["  " + "; ".join(given)] if given else []))


def of_functions(lines: Sequence[str], names: Collection[str]) -> tuple[str, ...]:
    """The bounds of these functions only."""
    found = []
    for line in lines:
        functions, within, bound = line.partition(" within")
        kept = [name for name in functions.split(", ") if name in names]
        if kept:
            found.append(", ".join(kept) + within + bound)
        elif not within and found:  # what holds for all of them
            found.append(line)
    return tuple(found)


def _steady(model: Model, angle: bool, tabled: bool) -> list[str]:
    """The bounds of a model without acceleration; its slopes are relative as well if there is no angle."""
    last = "units in the last place"
    if angle:
        force, friction = NORMAL_FORCE.within(last, tabled), FRICTION_TORQUE.within(last, tabled)
        slope = GRADIENT.within("eps of its greatest value at that speed, any angle", tabled)
    else:
        proved = model.expand(model.definition("F_N").symbol) == _CENTRIFUGAL
        force = (PROVED_FORCE if proved else WITHOUT_ANGLE).within(last, table_1=False)
        force += " (proved for parameters and speeds of 1e-6 to 1e6)" if proved else ""
        friction = slope = WITHOUT_ANGLE.within(last, table_1=False)
    return _lines(model, force, friction, slope)


def _accelerated(model: Model, tabled: bool) -> list[str]:
    """With an acceleration F_N vanishes along a curve, and near it the digits of its direction are lost."""
    greatest = "its greatest value, any direction of F_N, times that load over F_N"
    return _lines(
        model,
        ACCELERATED_FORCE.within("eps (M L (omega_l^2 + |alpha_l|) + weight)", tabled),
        ACCELERATED_FRICTION.within("eps of what they are at that load", tabled),
        ACCELERATED_GRADIENT.within(f"eps of {greatest}", tabled),
    )


def _lines(model: Model, force: str, friction: str, slope: str) -> list[str]:
    lines = [f"normal_force {force}"]
    if not _of_one_sign(model):
        return lines
    mechanical = "" if model.back_emf_in_friction else "mechanical_friction_torque, "
    torques = f"friction_torque, {mechanical}friction_torque_jacobian"
    return [*lines, f"{torques} {friction}", f"friction_torque_gradient {slope}"]


def _of_table_1(model: Model) -> bool:
    """Whether its parameters are the paper's, of either direction or both, with the values of Table 1."""
    paper = [q for q in vars(v).values() if isinstance(q, Quantity)]
    split = [v.directed(q, direction) for q in paper for direction in ("pos", "neg")]
    return not model.defaults and set(model.parameters) <= {*paper, *split}


def _as_derived(F_N: sp.Expr, steady: bool) -> bool:
    """Whether it is one product of parameters, speed and stable steps, without an effect added to it."""
    magnitude = next((f for f in sp.Mul.make_args(F_N) if isinstance(f, Magnitude)), None)
    if magnitude is None:
        return not F_N.has(sp.Add)
    along = magnitude.args[0]
    return isinstance(along, SquareDifference) if steady else along.has(SquareDifference)


def _of_one_sign(model: Model) -> bool:
    """Whether friction sums powers of load and speed that all oppose the motion, as its slopes then do."""
    F_N, omega_m = normal_force(model), next(q.symbol for q in model.inputs if q.name == "omega_m")
    size = sp.Symbol("size", positive=True)
    tilts = [q.symbol for q in model.parameters if q.domain == "tilt"]  # from 0 to pi/2
    upright = {of(tilt): sp.Dummy(nonnegative=True) for tilt in tilts for of in (sp.sin, sp.cos)}

    def opposes(value: sp.Expr, direction: int) -> bool:
        known = moving(omega_m, direction) | {omega_m: direction * size}
        against = direction * value.replace(Gated, sp.Mul).xreplace(known)
        if against.free_symbols - model.parameter_symbols - {F_N, size} or not against.is_polynomial(
            F_N, size
        ):
            return False
        return all(c.xreplace(upright).is_nonnegative for c in sp.Poly(against, F_N, size).coeffs())

    return all(
        opposes(term.value, direction)
        for balance in model.balances
        for term in balance.terms
        if term.kind in ("friction", "back_emf")
        for direction in (1, -1)
    )
