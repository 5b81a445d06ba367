"""A chain as a model: its recursion as definitions, and two balances for every joint."""

from __future__ import annotations

from collections.abc import Sequence

from eccentric.model.chain.chain import Chain
from eccentric.model.chain.drive import drives
from eccentric.model.chain.recursion import Recursion, recursion
from eccentric.model.equation import Equation
from eccentric.model.model import Model


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
    )
