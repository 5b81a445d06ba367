"""Which load the friction of a joint follows, or none: decided inside the training part.

The loads compete as effects do in a diagnosis: blocked cross-validation, the gain that an addition requires,
how many variants of the log find it. Loads that rise and fall together may explain a log alike.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eccentric.effects import Evidence
from eccentric.fitting import FitData, compiled
from eccentric.joints.arm_log import ArmLog
from eccentric.model import Load, Role
from eccentric.search import Candidate, balances_of, searched_loads

__all__ = ["LoadsOfAJoint", "loads_of"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LoadsOfAJoint:
    """What the training part says of the loads of a joint.

    Attributes:
        present: the loads that the log can tell apart from friction without a load.
        followed: those that friction follows, in order of adoption; none where Coulomb and viscous friction
            is enough.
        alike: loads that would explain the log as well as one of these.
        deviance: twice the gain in log-likelihood by the best single load, cross-validated.
        required: what an addition has to gain.
    """

    present: tuple[Load, ...]
    followed: tuple[Load, ...]
    alike: tuple[Load, ...]
    deviance: float
    required: float


def loads_of(log: ArmLog, j: int) -> LoadsOfAJoint:
    """Which loads the friction of joint j follows."""
    present = log.present(j)
    _, every = log.joint(j, present)
    model, plain = log.joint(j, ())
    balances, noise = balances_of(plain, log.channels[j].rig, model)
    candidates = [one for load in present for one in _candidates(load, every)]
    found = searched_loads(balances[0], candidates, noise["mechanical"], len(log))
    return LoadsOfAJoint(
        present,
        tuple(Load(name) for name in found.adopted),
        tuple(Load(name) for name in found.alike if name not in found.adopted),
        found.deviance,
        found.required,
    )


def _candidates(load: Load, data: FitData) -> list[Candidate]:
    """Friction by one load: Coulomb, with a viscous part; or viscous alone."""
    model = data.signals.base
    if model is None:
        raise AssertionError("the log of a joint has a model")
    by_role = {
        column.role: compiled(model, column.basis, data.signals)({}, {})
        for column in data.signals.columns(model)
        if column.load is load
    }
    both = np.column_stack([by_role[Role.COULOMB], by_role[Role.VISCOUS]])
    return [
        Candidate(
            id=f"{load.value}{ending}",
            family=load.value,
            balance="mechanical",
            evidence=Evidence((load.value,)),
            columns=lambda _, columns=columns: columns,
            lower=(0.0,),
        )
        for ending, columns in (("", both), (", viscous", both[:, 1:]))
    ]
