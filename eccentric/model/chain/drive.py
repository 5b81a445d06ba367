"""The drive and the friction of every joint: the paper's motor, gear and armature, and its postulate (7).

Link friction is viscous and Coulomb friction proportional to each load of its joint: F_N, F_T, M_B and the
transmitted torque, which excludes the friction itself. Load-independent friction is attributed to the motor,
B_m and C_m; behind the gear it would be equivalent.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import sympy as sp

from eccentric.model.balance import Balance, Equation, Load, Role, Term
from eccentric.model.chain.chain import Chain
from eccentric.model.chain.links import UNNAMED, Joint, is_zero
from eccentric.model.chain.outputs import ArmOutputs
from eccentric.model.chain.recursion import Recursion, recursion
from eccentric.model.model import Model
from eccentric.model.quantity import Quantity, quantity, symbols
from eccentric.model.steps import Sgn


@dataclass(frozen=True)
class _Followed:
    """A load that friction is proportional to: its suffix in coefficients, description, and unit of C.

    The unit of a viscous coefficient is that of C per velocity.
    """

    load: Load
    letter: str
    meaning: str
    turning: str
    sliding: str


_FOLLOWED = (
    _Followed(Load.NORMAL, "lN", "normal force", "m", "1"),
    _Followed(Load.TRANSVERSAL, "lT", "transversal force", "m", "1"),
    _Followed(Load.BENDING, "lM", "bending moment", "1", "1/m"),
    _Followed(Load.TRANSMITTED, "lG", "transmitted torque", "1", "1"),
)
_VISCOUS = {"m": "m s/rad", "1": "s/rad"}
_VISCOUS_SLIDING = {"1": "s/m", "1/m": "s/m^2"}


@dataclass(frozen=True)
class DriveSymbols:
    """The symbols in the balances of one drive.

    Attributes:
        velocity, current, voltage: inputs.
        mu: gear ratio, joint over motor.
        R, k_i, k_e: of the armature.
        B_m, C_m: load-independent viscous and Coulomb friction.
        by_load: viscous and Coulomb friction per load.
    """

    velocity: sp.Symbol
    current: sp.Symbol
    voltage: sp.Symbol
    mu: sp.Expr
    R: sp.Symbol
    k_i: sp.Symbol
    k_e: sp.Symbol
    B_m: sp.Symbol
    C_m: sp.Symbol
    by_load: Mapping[Load, tuple[sp.Symbol, sp.Symbol]]


def drive_balances(
    x: DriveSymbols,
    moved: Iterable[tuple[str, str, sp.Expr, str]],
    loads: Mapping[Load, sp.Expr],
    joint: int | None = None,
) -> tuple[Balance, Balance]:
    """The mechanical [N m, motor side] and the electrical balance [V] of a drive.

    Args:
        x: its symbols.
        moved: name, kind, value and reference of the other terms: inertia, gravity.
        loads: magnitude of each load that friction depends on.
        joint: its number, appended to names, if there are several.
    """
    end, place, one, open_ = "" if joint is None else f"_{joint}", joint or 0, sp.Integer(1), (None, None)
    sgn = Sgn(x.velocity)

    def rubbing(name: str, symbol: sp.Symbol, basis: sp.Expr, source: str, role: Role, load: Load) -> Term:
        return Term(f"{name}{end}", "friction", symbol, basis, source, role=role, load=load, joint=place)

    friction = []
    for load, size in loads.items():
        B, C = x.by_load[load]
        # On the motor side friction is mu f_l, and the joint moves with mu omega_m.
        for symbol, basis, role in (
            (B, x.mu**2 * size * x.velocity, Role.VISCOUS),
            (C, x.mu * size * sgn, Role.COULOMB),
        ):
            name = f"link_{role.value}_{load.name.lower()}"
            friction.append(rubbing(name, symbol, basis, "(7), (9)", role, load))
    mechanical = (
        Term(f"motor_torque{end}", "drive", x.k_i, x.current, "(2)", open_, joint=place),
        *(Term(f"{name}{end}", kind, one, value, of, joint=place) for name, kind, value, of in moved),
        *friction,
        rubbing("motor_viscous", x.B_m, x.velocity, "(10)", Role.VISCOUS, Load.NONE),
        rubbing("motor_coulomb", x.C_m, sgn, "(10)", Role.COULOMB, Load.NONE),
    )
    electrical = (
        Term(f"voltage{end}", "drive", one, x.voltage, "(2)", open_, joint=place),
        Term(f"resistance{end}", "resistive", x.R, x.current, "(2)", (0.0, None), joint=place),
        Term(f"back_emf{end}", "back_emf", x.k_e, x.velocity, "(2)", open_, joint=place),
    )
    return Balance(f"mechanical{end}", "N m", mechanical), Balance(f"electrical{end}", "V", electrical)


@dataclass(frozen=True)
class JointDrive:
    """The drive of one joint.

    Attributes:
        called: number and name of the joint, for comments.
        current, voltage: of its armature.
        parameters: those that its balances introduce.
        mechanical: [N m, motor side].
        electrical: [V].
    """

    called: str
    current: Quantity
    voltage: Quantity
    parameters: tuple[Quantity, ...]
    mechanical: Balance
    electrical: Balance


def drives(found: Recursion) -> tuple[JointDrive, ...]:
    """The drives of all joints, from the base outwards."""
    return tuple(_drive(found, j) for j in range(len(found.chain.joints)))


def _drive(found: Recursion, j: int) -> JointDrive:
    joint, inputs = found.chain.joints[j], found.inputs[j]
    called = _called(joint, j)
    current = quantity(f"i_{j}", "A", f"armature current of motor {called}", "(2)")
    voltage = quantity(f"u_{j}", "V", f"armature voltage of motor {called}", "(2)")
    R = quantity(f"R_{j}", "Ohm", f"armature resistance of motor {called}", "(2)", "positive")
    k_i = quantity(f"k_i_{j}", "N m/A", f"torque constant of motor {called}", "(2)", "positive")
    k_e = quantity(f"k_e_{j}", "V s/rad", f"back-EMF constant of motor {called}", "(2)", "nonnegative")
    B_m = quantity(
        f"B_m_{j}", "N m s/rad", f"viscous friction of motor {called}, and all that follows no load", "(10)",
        "nonnegative", "0",
    )  # fmt: skip
    C_m = quantity(
        f"C_m_{j}", "N m", f"Coulomb friction of motor {called}, and all that follows no load", "(10)",
        "nonnegative", "0",
    )  # fmt: skip
    nonzero = {load: x for load, x in found.bearings[j].loads.items() if not is_zero(x)}
    loads = {followed.load: nonzero[followed.load] for followed in _FOLLOWED if followed.load in nonzero}
    by_load = {
        followed.load: _coefficients(followed, j, called, turns=joint.turns)
        for followed in _FOLLOWED
        if followed.load in loads
    }
    letters = DriveSymbols(
        *(*symbols(inputs.omega_m, current, voltage), joint.mu, *symbols(R, k_i, k_e, B_m, C_m)),
        by_load={load: (B.symbol, C.symbol) for load, (B, C) in by_load.items()},
    )
    inertial = (
        ("rotor", "inertial", found.rotors[j], "(1)"),
        ("bodies", "bodies", joint.mu * found.torques[j], "(3)"),
    )
    mechanical, electrical = drive_balances(letters, inertial, loads, j)
    parameters = (R, k_i, k_e, B_m, C_m, *(q for pair in by_load.values() for q in pair))
    return JointDrive(called, current, voltage, parameters, mechanical, electrical)


def _called(joint: Joint, j: int) -> str:
    """Number and name of a joint for comments."""
    return f"{j}" if joint.name == UNNAMED else f"{j} ({joint.name})"


def friction_units(load: Load, *, turns: bool) -> tuple[str, str]:
    """The units of viscous and Coulomb friction per load, of a revolute joint or a slide."""
    followed = next(one for one in _FOLLOWED if one.load is load)
    coulomb = followed.turning if turns else followed.sliding
    return (_VISCOUS if turns else _VISCOUS_SLIDING)[coulomb], coulomb


def _coefficients(followed: _Followed, j: int, called: str, *, turns: bool) -> tuple[Quantity, Quantity]:
    viscous, coulomb = friction_units(followed.load, turns=turns)
    words = f"friction of joint {called} per {followed.meaning}"
    return (
        quantity(f"B_{followed.letter}_{j}", viscous, f"viscous {words}", "(9)", "nonnegative", "0"),
        quantity(f"C_{followed.letter}_{j}", coulomb, f"Coulomb {words}", "(9)", "nonnegative", "0"),
    )


def arm(
    chain: Chain, title: str, equations: Sequence[Equation] = (), found: Recursion | None = None
) -> Model:
    """The model of a chain.

    Args:
        chain: the chain.
        title: of the model, one line.
        equations: of its derivation.
        found: its recursion, if already computed.

    Returns:
        A model whose inputs are the paper's with the joint's number, theta_m_0, theta_m_1, ..., and whose
        balances are mechanical_0, electrical_0, mechanical_1, ...
    """
    found = found or recursion(chain)
    of_joints = drives(found)
    return Model(
        name=chain.name,
        title=title,
        inputs=(
            *(inputs.theta_m for inputs in found.inputs),
            *(inputs.omega_m for inputs in found.inputs),
            *(drive.current for drive in of_joints),
            *(drive.voltage for drive in of_joints),
            *(inputs.alpha_m for inputs in found.inputs),
        ),
        parameters=(*chain.parameters, *(q for drive in of_joints for q in drive.parameters)),
        definitions=found.definitions,
        balances=tuple(b for drive in of_joints for b in (drive.mechanical, drive.electrical)),
        equations=tuple(equations),
        defaults="those of the arm, without friction",
        declares=ArmOutputs(found),
    )
