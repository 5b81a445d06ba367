"""One joint of an arm as a separate model, with torques and loads from the other bodies as inputs.

Its terms are those of a chain's joint in `eccentric.model.chain.drive`, with the loads from the arm's emitted
`bearing_loads`. So everything that works for a single drive works for a joint.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from eccentric.joints.base_parameters import Bodies
from eccentric.model import (
    Definition,
    DriveSymbols,
    Load,
    Model,
    Quantity,
    drive_balances,
    friction_units,
    quantity,
    symbols,
)
from eccentric.model import vocabulary as v

Array = NDArray[np.float64]

R, k_i, k_e = (replace(q, default=None) for q in (v.R, v.k_i, v.k_e))
"""Without a default: a value missing from the rig is not that of the paper's drive."""

T_g = quantity("T_g", "N m", "torque that holds the arm against gravity, motor side", "(5)", letter="T_g")
T_d = quantity("T_d", "N m", "torque that moves the bodies, gravity aside, motor side", "(3)", letter="T_d")
T_r = quantity("T_r", "N m", "torque that accelerates the rotor of the motor", "(1)", letter="T_r")
N_l = quantity("load_N", "N", "force across the axis of the joint", "(8)", "nonnegative", letter="N_l")
T_l = quantity("load_T", "N", "force along the axis of the joint", "(8)", "nonnegative", letter="T_l")
M_l = quantity("load_M", "N m", "moment on the bearing across the axis", "(8)", "nonnegative", letter="M_B")
T = quantity("load_G", "N m", "size of the torque that the gear transmits, motor side", "(3)", letter="T")

B_lM = quantity(
    "B_lM", "s/rad", "viscous friction of the joint per bending moment", "(9)", "nonnegative", "0"
)
C_lM = quantity("C_lM", "1", "Coulomb friction of the joint per bending moment", "(9)", "nonnegative", "0")
B_lG = quantity("B_lG", "s/rad", "viscous friction per torque of the gear", "(9)", "nonnegative", "0")
C_lG = quantity("C_lG", "1", "Coulomb friction per torque of the gear", "(9)", "nonnegative", "0")

DECLARED = (Load.NORMAL, Load.TRANSVERSAL, Load.BENDING)
"""Bearing loads of the paper's joint model, eq (7). Friction by the transmitted torque is an effect."""
EVERY = (*DECLARED, Load.TRANSMITTED)
FORCE = N_l.name
"""The input that is the normal force."""

OF_FORCES = (v.B_lN, v.C_lN, v.B_lT, v.C_lT)
"""Coefficients of friction by a force on the bearing."""
OF_BENDING = (B_lM, C_lM)
"""Coefficients of friction by the bending moment, viscous and Coulomb."""
_COEFFICIENTS: Mapping[Load, tuple[Quantity, Quantity]] = {
    Load.NORMAL: (v.B_lN, v.C_lN),
    Load.TRANSVERSAL: (v.B_lT, v.C_lT),
    Load.BENDING: OF_BENDING,
    Load.TRANSMITTED: (B_lG, C_lG),
}


def sources_of(j: int, labels: Sequence[str]) -> dict[str, str]:
    """Input of the joint model -> its source in the emitted arm, in words.

    Args:
        j: index of the joint, 0 next to the base.
        labels: of the values of `bearing_loads`.
    """
    loads = {N_l: f"F_N_{j}", T_l: f"F_T_{j}", M_l: f"M_B_{j}"}
    words = {
        q.name: f"{label} of bearing_loads, out[{labels.index(label)}]"
        for q, label in loads.items()
        if label in labels
    }
    return words | {
        T_g.name: f"out[{j}] of gravity_torque",
        T_d.name: f"mu T_{j} of bearing_loads with the sign of inverse_dynamics - J_m alpha_m, less T_g",
        T_r.name: f"out[{j}] of inverse_dynamics, less T_g and T_d",
    }


def joint_model(
    name: str,
    title: str,
    loads: Collection[Load] = DECLARED,
    sources: Mapping[str, str] | None = None,
    *,
    turns: bool = True,
) -> Model:
    """The model of a joint with Coulomb and viscous friction and friction by some loads.

    Args:
        name: in code.
        title: one line.
        loads: those that the joint's friction depends on.
        sources: where a caller gets an input, in words for its comment.
        turns: whether the joint is revolute; a slide has friction in other units.
    """
    notes = {} if sources is None else sources
    met = [
        replace(q, meaning=f"{q.meaning}: {notes[q.name]}") if q.name in notes else q
        for q in (T_g, T_d, T_r, N_l, T_l, M_l)
    ]
    size = {
        Load.NORMAL: v.F_N.symbol,
        Load.TRANSVERSAL: T_l.symbol,
        Load.BENDING: M_l.symbol,
        Load.TRANSMITTED: T.symbol / v.mu.symbol,
    }
    by_load = {
        load: tuple(
            replace(q, unit=unit)
            for q, unit in zip(_COEFFICIENTS[load], friction_units(load, turns=turns), strict=True)
        )
        for load in EVERY
        if load in loads
    }
    letters = DriveSymbols(
        *symbols(v.omega_m, v.i, v.u, v.mu, v.R, v.k_i, v.k_e, v.B_m, v.C_m),
        by_load={load: (B.symbol, C.symbol) for load, (B, C) in by_load.items()},
    )
    inertial = (
        ("rotor", "inertial", T_r.symbol, "(1)"),
        ("bodies", "bodies", T_d.symbol, "(3)"),
        ("gravity", "gravity", T_g.symbol, "(5)"),
    )
    gear = [Definition(T, sp.Abs(T_g.symbol + T_d.symbol))] if Load.TRANSMITTED in loads else []
    return Model(
        name=name,
        title=title,
        inputs=(v.theta_m, v.omega_m, v.i, v.u, *met, v.alpha_m),
        parameters=(v.mu, R, k_i, k_e, *(q for pair in by_load.values() for q in pair), v.B_m, v.C_m),
        definitions=(Definition(v.F_N, N_l.symbol), *gear),
        balances=drive_balances(letters, inertial, {load: size[load] for load in by_load}),
    )


def signals_of(met: Bodies) -> dict[str, Array]:
    """Inputs of the joint model by name, each (n,)."""
    return {
        T_g.name: met.gravity,
        T_d.name: met.moving,
        T_r.name: met.rotor,
        N_l.name: met.F_N,
        T_l.name: met.F_T,
        M_l.name: met.M_B,
    }


def joint_inputs(
    gravity: sp.Expr, moving: sp.Expr, rotor: sp.Expr, loads: Mapping[Load, sp.Expr]
) -> dict[sp.Expr, sp.Expr]:
    """Inputs of the joint model in symbols of the arm: torques on the motor side, loads."""
    return {
        T_g.symbol: gravity,
        T_d.symbol: moving,
        T_r.symbol: rotor,
        N_l.symbol: loads[Load.NORMAL],
        T_l.symbol: loads[Load.TRANSVERSAL],
        M_l.symbol: loads[Load.BENDING],
    }
