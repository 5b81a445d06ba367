"""A fitted drive as what is simulated: a law, its parameters, and the torque of a drive signal."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from eccentric.identification import Drive, Machine, Refit, state_series
from eccentric.model import Model
from eccentric.rigs import ALIGNMENT, AddedMass
from eccentric.simulation.law import Law, value_of
from eccentric.simulation.recording import Recording, recording_of


@dataclass(frozen=True)
class DrivePlant:
    """A drive at the values of its parameters, each a number or (sets, 1).

    Attributes:
        law: of its model.
        parameters: by name, as the emitted Parameters have them.
        gain: torque on the motor side per unit of the drive signal [N m per V, A or N m].
        damping: torque that the back-EMF takes per velocity while the motor is on [N m s/rad].
        zero: motor angle of the recording at which the mass hangs straight down [rad].
        offset: drive signal of the recording where none acts.
        load: constant torque against positive motion, whether or not the motor is on [N m].
    """

    law: Law
    parameters: Mapping[str, Any]
    gain: Any
    damping: Any
    zero: Any = 0.0
    offset: Any = 0.0
    load: Any = 0.0

    @property
    def ampere(self) -> Any:
        """The current of a newton metre [A/(N m)], by its parameters."""
        return Machine(self.law.model).current_of_torque(self.parameters, 1.0)

    def carrying(self, added: AddedMass) -> DrivePlant:
        """The same with a mass on the link."""
        machine = Machine(self.law.model)
        sets = max((np.size(x) for x in self.parameters.values()), default=1)
        each = [
            machine.carrying({name: _of_set(x, k) for name, x in self.parameters.items()}, added)
            for k in range(sets)
        ]
        joined = {name: stacked([one[name] for one in each]) for name in each[0]}
        return dataclasses.replace(self, parameters=joined)


def _of_set(x: Any, k: int) -> float:
    return float(np.ravel(x)[k if np.size(x) > 1 else 0])


def stacked(values: Sequence[float]) -> Any:
    """Values of parameter sets as (sets, 1); a number where they are one."""
    return values[0] if len(set(values)) == 1 else np.array(values, float)[:, None]


_OWN = ("gain", "damping", "zero", "offset", "load")
"""Fields of a plant that are numbers."""


def together(plants: Sequence[DrivePlant]) -> DrivePlant:
    """Plants of one law as one plant of as many parameter sets."""

    def joined(values: Sequence[Any]) -> Any:
        return stacked([float(x) for x in values])

    first = plants[0]
    return DrivePlant(
        first.law,
        {name: joined([p.parameters[name] for p in plants]) for name in first.parameters},
        *(joined([getattr(p, name) for p in plants]) for name in _OWN),
    )


def complete(model: Model, values: Mapping[str, float]) -> dict[str, float]:
    """The values of all parameters of a model: what is not among them has its default, by the others.

    What has none does not matter to the log that they were fitted on, and is 0.
    """
    found = {q.name: float(values[q.name]) for q in model.parameters if values.get(q.name) is not None}
    for q in model.parameters:
        if q.name not in found:
            needed = set() if q.default is None else {s.name for s in q.default.free_symbols}
            found[q.name] = (
                float(value_of(q.default, found)) if q.default is not None and needed <= set(found) else 0.0
            )
    return found


def driven(drive: Drive, values: Mapping[str, float], scale: float | None = None) -> tuple[float, float]:
    """The gain and the damping of a plant for parameters and scale of a fit, as `Drive.torque` has them."""
    by, machine = drive.channels.motor.measured_by, drive.machine
    if by == "torque":
        return 1.0, 0.0
    letters = {**dict.fromkeys(machine.back_emf_letters, 0.0), **values, **drive.scaled(scale)}
    if by == "current":
        return float(machine.torque(letters, 1.0)), 0.0
    one, back = (machine.torque(letters, machine.current(letters, *at)) for at in ((1.0, 0.0), (0.0, 1.0)))
    return float(one), -float(back)


def plants_of(fits: Mapping[str, Refit]) -> dict[str, tuple[DrivePlant, Recording]]:
    """The plant of each fitted model, and the log as it sees it; fits of one model share its law."""
    laws: dict[tuple[int, bool], Law] = {}
    found: dict[str, tuple[DrivePlant, Recording]] = {}
    for name, fit in fits.items():
        armature = fit.data.drive.by_voltage and _changes_armature(fit)
        key = id(fit.model), armature
        laws[key] = laws.get(key) or Law(fit.model, armature)
        found[name] = plant_of(fit, laws[key])
    return found


def plant_of(fitted: Refit, law: Law) -> tuple[DrivePlant, Recording]:
    """The plant of a fitted model with this law, and the log as it sees it."""
    drive = fitted.data.drive
    found = {name: fitted.estimates[name].value for name in ALIGNMENT if name in fitted.estimates}
    aligned = drive.aligned(drive.channels.rig, found) if found else drive
    plant = DrivePlant(
        law, complete(fitted.model, fitted.values), *driven(aligned, fitted.values, fitted.scale)
    )
    recording = recording_of(aligned.channels)
    if fitted.model.states:
        shapes = {
            s.quantity.name: fitted.values[s.quantity.name] for e, _ in fitted.effects for s in e.shapes
        }
        states = state_series(fitted.model, fitted.data.signals, shapes)
        recording = dataclasses.replace(recording, states=states)
    return plant, recording


def _changes_armature(fitted: Refit) -> bool:
    """Whether effects change the electrical balance."""
    model = fitted.model
    used = {symbol for t in model.balance("electrical").terms for symbol in t.value.free_symbols}
    added = any("electrical" in extension.change.terms for extension in model.extensions)
    return added or not used.isdisjoint(model.replaced.values())
