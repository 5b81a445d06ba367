"""An arm's logs, ready for fits: external torques and loads of every joint; each joint as a single drive."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from eccentric.core import InputError
from eccentric.identification import (
    Coefficient,
    Design,
    Drive,
    Estimate,
    FitData,
    Machine,
    MetAlong,
    compiled,
    fit_data_of,
)
from eccentric.joints.base_parameters import (
    BaseParameters,
    BodyModule,
    JointMotions,
    base_of,
    moments_of,
    names_of,
)
from eccentric.joints.joint_model import EVERY, FORCE, joint_model, signals_of, sources_of
from eccentric.joints.limits import NEGLIGIBLE, VARIES
from eccentric.model import Load, Model, letters_of
from eccentric.rigs import ArmRig
from eccentric.signals import Channels, Rows, fit_rows, motion_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ArmLog:
    """The logs of an arm."""

    rig: ArmRig  # as declared
    channels: tuple[Channels, ...]  # of every joint, on the same rows
    module: BodyModule  # torques and loads of its bodies
    values: Array  # the current inertial parameters (joints, 10): declared or identified
    # one newton metre in the unit of each drive: 1, or in amperes where k_i is unknown
    scales: tuple[float, ...] = ()
    # k_i of each motor if identified from the declared bodies, else None
    gains: tuple[Estimate | None, ...] = ()
    _motions: dict[float, JointMotions] = field(default_factory=dict, repr=False)
    _along: dict[tuple[float, int], MetAlong] = field(default_factory=dict, repr=False)
    _bases: dict[int, BaseParameters] = field(default_factory=dict, repr=False)
    _regressors: dict[float, Array] = field(default_factory=dict, repr=False)
    _largest: dict[tuple[int, Load], float] = field(default_factory=dict, repr=False)

    def __len__(self) -> int:
        return len(self.channels)

    @property
    def bases(self) -> dict[int, BaseParameters]:
        """The base parameters selected so far, by joint: a prediction uses the same."""
        return dict(self._bases)

    @property
    def cut_hz(self) -> float:
        """Cut-off of the low pass of all angles [Hz]."""
        return self.channels[0].rig.sampling.low_pass_hz

    def with_values(self, values: Array) -> ArmLog:
        """A copy with other inertial parameters."""
        return replace(self, values=values, _along={}, _largest={})

    def motion(self, cut_hz: float | None = None) -> JointMotions:
        """The motion of all motors, low-passed at a cut-off [Hz], by default that of the rig."""
        cut = self.cut_hz if cut_hz is None else cut_hz
        if cut not in self._motions:
            each = [_below(channels, cut, self.cut_hz) for channels in self.channels]
            self._motions[cut] = JointMotions(*(np.stack(parts, axis=1) for parts in zip(*each, strict=True)))
        return self._motions[cut]

    def along(self, j: int, cut_hz: float | None = None) -> MetAlong:
        """External torques and loads of joint j, with all angles low-passed at a cut-off [Hz]."""
        cut = self.cut_hz if cut_hz is None else cut_hz
        if (cut, j) not in self._along:
            motion = self.motion(cut)
            columns = self._columns(motion) if self.rig.open else {}
            for k, met in enumerate(self.module.met(motion, self.values)):
                # With open bodies the columns correct the current ones.
                scaled = met.scaled(self.scales[k])
                signals, torque = signals_of(scaled), scaled.whole
                bodies = {
                    Coefficient(name, "bodies", _unit(place)): columns[place][:, k]
                    for place, name in self.open_of(k)
                }
                below = lambda other, k=k: self.along(k, other)  # noqa: E731 - binds k
                self._along[cut, k] = MetAlong(signals, torque, FORCE, bodies, below)
        return self._along[cut, j]

    def open_of(self, j: int) -> list[tuple[int, str]]:
        """Indices and names of the inertial parameters that form a basis for the torque of joint j."""
        if not self.rig.open:
            return []
        names = names_of(len(self))
        return [(place, names[place]) for place in self.base(j).chosen]

    def base(self, j: int) -> BaseParameters:
        """The base parameters of the torque of joint j alone, from its rows to fit."""
        if j not in self._bases:
            rows = self.channels[j].selection.fit_rows
            self._bases[j] = base_of(self.regressor(j)[rows])
        return self._bases[j]

    def regressor(self, j: int) -> Array:
        """The torque of joint j per inertial parameter (n, 10 joints)."""
        return self._regressor()[:, j]

    def rows(self, j: int) -> Rows:
        """The rows that the friction of joint j is fitted on."""
        return fit_rows(self.channels[j], self.channels[j].rig)

    def drive(self, j: int) -> Drive:
        """The drive of joint j without external torques.

        Without k_i, the declared bodies determine the torque constant; with open bodies nothing does, and
        the result is in amperes.
        """
        channels, rig = self.channels[j], self.rig.joints[j]
        by, where = channels.motor.measured_by, f"{self.rig.path}: [drives]"
        known: Mapping[str, float] = {
            name: rig.known[name] for name in ("mu", "k_i", "R", "k_e") if name in rig.known
        }
        machine = Machine(joint_model("joint", "A joint", ()))
        if by == "torque":
            return Drive(machine, channels, {**known, "k_i": 1.0}, None, "N m")
        if by == "current":
            if "k_i" in known:
                return Drive(machine, channels, known, None, "N m")
            if j < len(self.gains) and (gain := self.gains[j]) is not None:
                return Drive(machine, channels, {**known, "k_i": gain.value}, None, "N m")
            return Drive(machine, channels, {**known, "k_i": 1.0}, None, "A")
        if missing := [name for name in ("k_i", "R", "k_e") if name not in known]:
            raise InputError(
                f"{where} {missing[0]}",
                "a value",
                "none",
                why=f"to convert the voltage of joint {self.rig.number(j)} to torque",
            )
        return Drive(machine, channels, known, known["R"] / known["k_i"], "N m")

    def joint(self, j: int, loads: Collection[Load], name: str = "") -> tuple[Model, FitData]:
        """Joint j as a log of one drive, and its model with friction by these loads."""
        number = self.rig.number(j)
        title, sources = f"Joint {number} of {self.rig.chain.name}", sources_of(j, self.module.loads)
        turns = self.rig.chain.joints[j].turns
        model = joint_model(name or f"joint_{number}", title, loads, sources, turns=turns)
        drive = replace(self.drive(j), machine=Machine(model), along=self.along(j))
        return model, fit_data_of(drive, self.channels[j].rig, model)

    def present(self, j: int, among: Sequence[Load] = EVERY) -> tuple[Load, ...]:
        """The loads whose friction a log can separate from Coulomb and viscous friction and from each other.

        Friction by a constant load is part of the load-independent friction; a load negligible compared with
        those of other joints is rounding.
        """
        among = [load for load in among if self._is_borne(j, load)]
        model, data = self.joint(j, among)
        rows = data.rows.train
        identifiable: list[Load] = []
        columns = {c.load: [] for c in data.signals.columns(model)}
        for column in data.signals.columns(model):
            columns[column.load].append(compiled(model, column.basis, data.signals)({}, {}))
        basis = data.rows.mean(np.column_stack(columns[Load.NONE]))[rows]
        for load in among:
            added = data.rows.mean(np.column_stack(columns[load]))[rows]
            size = np.linalg.norm(added, axis=0)
            if not np.all(size > 0.0):
                continue
            residual = added - basis @ np.linalg.lstsq(basis, added, rcond=None)[0]
            if np.all(np.linalg.norm(residual, axis=0) > VARIES * size):
                identifiable.append(load)
                basis = np.column_stack([basis, added])
        return tuple(identifiable)

    def _is_borne(self, j: int, load: Load) -> bool:
        """Whether a load of joint j exceeds rounding of the largest load of its kind in any joint."""
        if not self._largest:
            for k, met in enumerate(self.module.met(self.motion(), self.values)):
                rows = self.channels[k].selection.fit_rows
                gear = np.abs(met.gravity + met.moving) / self.rig.joints[k].known["mu"]
                each = (met.F_N, met.F_T, met.M_B, gear)
                for one, size in zip(EVERY, each, strict=True):
                    self._largest[k, one] = float(np.max(np.abs(size[rows]), initial=0.0))
        forces = (Load.NORMAL, Load.TRANSVERSAL)
        kind = forces if load in forces else (Load.BENDING, Load.TRANSMITTED)
        most = max(self._largest[k, one] for k in range(len(self)) for one in kind)
        return self._largest[j, load] > NEGLIGIBLE * most

    def _regressor(self) -> Array:
        """The torques per inertial parameter at the rig's cut-off (n, joints, 10 joints)."""
        if self.cut_hz not in self._regressors:
            self._regressors[self.cut_hz] = self.module.regressor(self.motion())
        return self._regressors[self.cut_hz]

    def _columns(self, motion: JointMotions) -> dict[int, Array]:
        """The torques per unit of the inertial parameters that are open in any joint, each (n, joints)."""
        places = sorted({place for k in range(len(self)) for place, _ in self.open_of(k)})
        if motion is self.motion():
            every = self._regressor()
            return {place: every[:, :, place] for place in places}
        columns = self.module.regressor(motion, places)
        return {place: columns[:, :, k] for k, place in enumerate(places)}


def arm_log(rig: ArmRig, channels: Sequence[Channels]) -> ArmLog:
    """The logs of an arm with the bodies declared in its file."""
    log = ArmLog(rig, tuple(channels), BodyModule(rig.chain), moments_of(rig.chain))
    scales = tuple(_scale(log, j) for j in range(len(log)))
    if rig.open:
        return replace(log, scales=tuple(1.0 if s is None else s.value for s in scales))
    gains = tuple(None if s is None else _gain(s, rig, j) for j, s in enumerate(scales))
    return replace(log, scales=(1.0,) * len(log), gains=gains)


def _scale(log: ArmLog, j: int) -> Estimate | None:
    """Amperes per newton metre, from the declared bodies; None where the torque is known."""
    drive = log.drive(j)
    if drive.unit == "N m":
        return None
    rows = log.rows(j)
    met = log.module.torques(log.motion(), log.values)[:, j]
    w = log.channels[j].motion.omega_m
    columns = np.column_stack([rows.plain_mean(met), rows.mean(np.column_stack([w, np.sign(w)]))])
    coefficients = (
        Coefficient("scale", "scale", "A/(N m)"),
        Coefficient("B", "friction", "A s/rad"),
        Coefficient("C", "friction", "A"),
    )
    design = Design(coefficients, rows.mean(drive.torque()), columns, rows.train, rows.weights)
    return design.solve().estimates()["scale"]


def _gain(scale: Estimate, rig: ArmRig, j: int) -> Estimate:
    """k_i of a motor from its inverse.

    Raises:
        InputError: the interval of the inverse includes zero or is negative.
    """
    low, high = scale.interval
    if low <= 0.0:
        reason = "its bodies need too little torque to identify it"
        if high < 0.0:
            reason = "its current is opposite to the torque of its bodies: one of the two has a wrong sign"
        required = f"expected a value for joint {rig.number(j)}, got none"
        raise InputError(f"{rig.path}: [drives] k_i", problem=f"{required}: {reason}")
    value = 1.0 / scale.value
    return Estimate(value, value**2 * scale.std_error, (1.0 / high, 1.0 / low), "N m/A")


def _below(channels: Channels, cut: float, rig_cut: float) -> tuple[Array, Array, Array]:
    motion, time = channels.motion, channels.time
    if cut == rig_cut:
        return motion.theta_m, motion.omega_m, motion.alpha_m
    (theta, omega, alpha), _ = motion_of(time.t, motion.theta_logged, time.segment, cut)
    return theta, omega, alpha


def _unit(place: int) -> str:
    return letters_of(0)[place % 10].unit
