"""The drive and the friction of every joint: the paper's motor, gear and armature, and its postulate (7).

Friction of the link is viscous and Coulomb friction in proportion to each load of its joint: F_N, F_T, M_B
and what the gear passes on, which is without the friction itself. What follows no load is that of the motor,
B_m and
C_m: behind the gear it would be the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

from eccentric.model.balance import Balance, Load, Role, Term
from eccentric.model.chain.chain import Chain
from eccentric.model.chain.links import UNNAMED, Joint, is_zero
from eccentric.model.chain.outputs import ArmOutputs
from eccentric.model.chain.recursion import Recursion, recursion
from eccentric.model.equation import Equation
from eccentric.model.model import Model
from eccentric.model.quantity import Quantity, quantity
from eccentric.model.steps import Sgn


@dataclass(frozen=True)
class _Followed:
    """A load by which friction is scaled: its letter in coefficients, in words, and the unit of C by it.

    The unit of a viscous coefficient is that of C by velocity.
    """

    load: Load
    letter: str
    word: str
    meaning: str
    turning: str
    sliding: str


_FOLLOWED = (
    _Followed(Load.NORMAL, "lN", "normal", "normal force", "m", "1"),
    _Followed(Load.TRANSVERSAL, "lT", "transversal", "transversal force", "m", "1"),
    _Followed(Load.BENDING, "lM", "bending", "bending moment", "1", "1/m"),
    _Followed(Load.TRANSMITTED, "lG", "transmitted", "what the gear passes on", "1", "1"),
)
_VISCOUS = {"m": "m s/rad", "1": "s/rad"}
_VISCOUS_SLIDING = {"1": "s/m", "1/m": "s/m^2"}


@dataclass(frozen=True)
class JointDrive:
    """The drive of one joint.

    Attributes:
        called: number and name of the joint, for comments.
        current, voltage: of its armature.
        parameters: those that its balances bring along.
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
    velocity, sgn = inputs.omega_m.symbol, Sgn(inputs.omega_m.symbol)
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
    parameters, terms = [R, k_i, k_e, B_m, C_m], []
    for followed in _FOLLOWED:
        load = found.bearings[j].loads.get(followed.load, sp.Integer(0))
        if is_zero(load):
            continue
        B, C = _coefficients(followed, j, called, turns=joint.turns)
        parameters += [B, C]
        # The gear takes mu f_l from the motor; the joint moves with mu omega_m.
        for quantity_of, basis, role in (
            (B, joint.mu**2 * load * velocity, Role.VISCOUS),
            (C, joint.mu * load * sgn, Role.COULOMB),
        ):
            name = f"link_{role.value}_{followed.word}_{j}"
            coefficient, load_of = quantity_of.symbol, followed.load
            terms.append(
                Term(name, "friction", coefficient, basis, "(7), (9)", role=role, load=load_of, joint=j)
            )
    mechanical = Balance(
        f"mechanical_{j}",
        "N m",
        (
            Term(f"motor_torque_{j}", "drive", k_i.symbol, current.symbol, "(2)", (None, None), joint=j),
            Term(f"rotor_{j}", "inertial", sp.Integer(1), found.rotors[j], "(1)", joint=j),
            Term(f"bodies_{j}", "bodies", sp.Integer(1), joint.mu * found.torques[j], "(3)", joint=j),
            *terms,
            Term(f"motor_viscous_{j}", "friction", B_m.symbol, velocity, "(10)", role=Role.VISCOUS, joint=j),
            Term(f"motor_coulomb_{j}", "friction", C_m.symbol, sgn, "(10)", role=Role.COULOMB, joint=j),
        ),
    )
    electrical = Balance(
        f"electrical_{j}",
        "V",
        (
            Term(f"voltage_{j}", "drive", sp.Integer(1), voltage.symbol, "(2)", (None, None), joint=j),
            Term(f"resistance_{j}", "resistive", R.symbol, current.symbol, "(2)", (0.0, None), joint=j),
            Term(f"back_emf_{j}", "back_emf", k_e.symbol, velocity, "(2)", (None, None), joint=j),
        ),
    )
    return JointDrive(called, current, voltage, tuple(parameters), mechanical, electrical)


def _called(joint: Joint, j: int) -> str:
    """Number and name of a joint for comments."""
    return f"{j}" if joint.name == UNNAMED else f"{j} ({joint.name})"


def friction_units(load: Load, *, turns: bool) -> tuple[str, str]:
    """The units of viscous and Coulomb friction per load, of a joint that turns or of a slide."""
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


# A chain as a model: its recursion as definitions, and two balances for every joint.


def arm(
    chain: Chain, title: str, equations: Sequence[Equation] = (), found: Recursion | None = None
) -> Model:
    """The model of a chain.

    Args:
        chain: the chain.
        title: of the model, one line.
        equations: of its derivation.
        found: its recursion, if that is there already.

    Returns:
        A model whose inputs are those of the paper with the joint's number: theta_m_0, theta_m_1, ...; its
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
