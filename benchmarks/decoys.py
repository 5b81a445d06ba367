"""A log with names as real loggers have them, and columns beside its own that must not be taken for signals.

The names are those of ROS topics, servo drives, PLC scopes, robot interfaces, MATLAB scripts and sketches.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from benchmarks.disguised import UNITS, Column, Disguised, in_unit
from eccentric.logs import Log

__all__ = ["decoyed"]

Array = NDArray[np.float64]
STYLE = "real names, decoys"
NAMES: dict[str, tuple[tuple[str, str], ...]] = {
    "time": (
        ("__time", "s"), ("Timestamp", "ms"), ("time_ms", "ms"), ("millis", "ms"), ("t", "s"),
        ("Time [s]", "s"), ("header.stamp", "s"), ("Zeit [ms]", "ms"), ("elapsed", "s"), ("timestamp_us", "us"),
    ),
    "angle": (
        ("/joint_states/joint1/position", "rad"), ("position", ""), ("q", "rad"), ("theta", "rad"),
        ("ActPos", "deg"), ("Position actual value (6064h)", "counts"), ("encoderPos", "counts"),
        ("Present Position", "counts"), ("pos_estimate", "rev"), ("phi_mess", "rad"), ("angle_deg", "deg"),
        ("Axis 1.NcToPlc.ActPos", "deg"), ("actual_q", "rad"), ("motor_angle", ""), ("Winkel [°]", "deg"),
        ("observation.position", "rad"), ("x", "rad"), ("Lageistwert", "rad"), ("qpos", "rad"), ("jointpos", ""),
    ),
    "speed": (
        ("/joint_states/joint1/velocity", "rad/s"), ("velocity", ""), ("qd", "rad/s"), ("dq", "rad/s"),
        ("omega", "rad/s"), ("ActVelo", "deg/s"), ("Velocity actual value", "rpm"), ("rpm", "rpm"),
        ("motor_rpm", "rpm"), ("vel_estimate", "rev/s"), ("n_ist", "rpm"), ("actual_qd", "rad/s"),
        ("Speed (RPM)", "rpm"), ("thetadot", "rad/s"), ("vel [Hz]", "rev/s"), ("v", "rad/s"), ("Drehzahlistwert", "rpm"), ("motorSpeedRPM", "rpm"), ("qvel", "rad/s"),
        ("Velocity Actual Value Averaged", "rpm"),
    ),
    "current": (
        ("Iq_measured", "A"), ("iq", "A"), ("motor_current", "A"), ("current_mA", "mA"), ("i_act", "A"),
        ("Present Current", "mA"), ("actual_current", "A"), ("I_ist", "A"), ("Current actual value", ""),
        ("q-axis current [A]", "A"), ("ActCurrent", "A"), ("Motorstrom [A]", "A"), ("/motor/current", "A"),
        ("i", "A"), ("q_current", "A"), ("motorcurrent", "A"), ("Stromistwert [A]", "A"), ("armatureCurrent", "A"),
    ),
    "voltage": (
        ("voltage", "V"), ("Uq", "V"), ("motor_voltage", "V"), ("u", "V"), ("v_motor [V]", "V"),
        ("ActVoltage", "V"), ("Klemmenspannung", "V"), ("U_soll [V]", "V"), ("voltage_cmd [V]", "V"),
    ),
    "torque": (
        ("/joint_states/joint1/effort", "N m"), ("tau", "N m"), ("tau_measured", "N m"), ("ActTorque", "N m"),
        ("torque_actual", "N m"), ("tau_J", "N m"), ("Torque (Nm)", "N m"), ("M_ist", "N m"),
        ("Drehmoment [Nm]", "N m"), ("trq_mNm", "mNm"), ("Momentenistwert [Nm]", "N m"), ("effort[0]", "N m"),
    ),
    "temperature": (("motor_temp", "degC"), ("Present Temperature", "degC"), ("temperature [°C]", "degC")),
    "duty": (("pwm", ""), ("MotorPWM", ""), ("duty", "")),
    "supply": (("vbus", "V"), ("supply [V]", "V"), ("Zwischenkreis [V]", "V")),
    "run": (("run", ""), ("trial", "")),
    "on": (("enable", ""), ("motor enabled", "")),
    "bad": (("suspect", ""), ("invalid", "")),
    "set angle": (("goal_position", ""), ("target_position", ""), ("theta_soll", "")),
}  # fmt: skip
"""Name and unit that the values are in; "" for any, since the name says none and loggers differ."""
SET = {
    "angle": ("q_d", "q_ref", "Position demand value", "SetPos", "theta_soll", "/joint_cmds/joint1/position"),
    "speed": (
        "target_velocity",
        "SetVelo",
        "n_soll",
        "dq_d",
        "velocity_setpoint",
        "vel_ref",
        "/cmd_vel/angular/z",
        "Drehzahlsollwert",
    ),
    "current": (
        "Iq_setpoint",
        "target_current",
        "i_soll",
        "goal_current",
        "current_cmd [A]",
        "Commanded Current",
    ),
    "torque": ("torque_cmd", "tau_d", "target_torque", "SetTorque", "desired_effort", "tau_ref [Nm]"),
}
MODELS = (
    "tau_model", "tau_pred", "Stribeck", "LuGre", "tau_rigid", "torque_ff", "predicted_current", "PINN",
    "friction_est", "Dahl", "simulated torque", "LSTM", "tau_inverse_dynamics_model", "feed forward",
    "fitted", "residual",
)  # fmt: skip
ERRORS = ("position_error", "Following error", "e_pos_err", "PosDiff", "Schleppfehler", "tracking error")
SLOW = (
    "bus_voltage",
    "dc_link_voltage",
    "actual_main_voltage",
    "battery [V]",
    "supply voltage",
    "input_voltage",
    "current_in",
)
STEADY = ("max_torque", "current_limit", "torque limit [Nm]", "upper_limit")
INDEX = ("frame_index", "seq", "sample", "header.seq", "episode_index")
STAMPS = ("stamp", "/tf/header/stamp", "recv_time", "log_timestamp")
TURNED = ("orientation.w", "ee_quat_z", "/tf/rotation/w")


Entry = tuple[Array, Column, float, float]
"""Values, what they are, SI per unit and offset."""


def decoyed(log: Log, known: Mapping[str, Column], rng: np.random.Generator) -> Disguised:
    """The columns in `known` under real names in random order, with up to six decoys among them.

    A decoy is a "decoy" in the truth; a copy and a second clock count as the column that they repeat.
    """
    entries: dict[str, Entry] = {}
    of: dict[str, str] = {}
    for old, column in known.items():
        name, unit = _chosen(column, rng)
        while name in entries:
            name, unit = _chosen(column, rng)
        entries[name], of[old] = _entry(log.columns[old], column, unit, rng), name
    for name, entry in _decoys(log, known, of, entries, rng):
        entries.setdefault(name, entry)
    order = [str(name) for name in rng.permutation(list(entries))]
    truth = {
        name: Column(c.quantity, c.unit, c.counts, of.get(c.same, c.same))
        for name in order
        for c in (entries[name][1],)
    }
    return Disguised(
        Log("log.csv", {name: entries[name][0] for name in order}, log.rows),
        truth,
        {name: entries[name][2] for name in order},
        {name: entries[name][3] for name in order},
        STYLE,
    )


def _chosen(column: Column, rng: np.random.Generator) -> tuple[str, str]:
    fits = [one for one in NAMES[column.quantity] if one[1] != "counts" or column.counts]
    return fits[int(rng.integers(len(fits)))]


def _entry(values: NDArray, column: Column, unit: str, rng: np.random.Generator) -> Entry:
    if column.quantity not in UNITS:
        return values, column, 1.0, 0.0
    if column.quantity == "time" and np.isclose(float(np.median(np.diff(values))), 1.0):
        unit = column.unit
    any_of = [u for u in UNITS[column.quantity] if u != "counts"]
    changed, factor, offset = in_unit(column, values, unit or str(rng.choice(any_of)))
    return changed, column, factor, offset


def _decoys(
    log: Log,
    known: Mapping[str, Column],
    of: Mapping[str, str],
    entries: Mapping[str, Entry],
    rng: np.random.Generator,
) -> Iterator[tuple[str, Entry]]:
    """Set values, results, errors, supplies, limits, indices, stamps and copies."""
    time = np.asarray(log.columns[_of(known, "time")], dtype=float)
    n = len(time)

    def decoy(values: Array) -> Entry:
        return values, Column("decoy"), 1.0, 0.0

    def name_of(names: Sequence[str]) -> str:
        return str(rng.choice(names))

    signals = [c for c in known if known[c].quantity in SET]
    drives = [c for c in signals if known[c].quantity in ("current", "torque")]
    about = str(rng.choice(signals))
    values, column, *_ = entries[of[about]]
    smooth = uniform_filter1d(np.asarray(values, dtype=float), 9)
    ahead = np.roll(smooth, -int(rng.integers(2, 8)))
    angle = entries[of[_of(known, "angle") or _of(known, "speed")]][0]
    kinds = rng.permutation(["set", "model", "error", "supply", "steady", "index", "stamp", "turned", "copy"])
    for kind in kinds[: int(rng.integers(2, 7))]:
        if kind == "set":
            yield name_of(SET[column.quantity]), decoy(ahead)
        elif kind == "model" and drives:
            drive = uniform_filter1d(np.asarray(log.columns[drives[0]], dtype=float), 15)
            yield name_of(MODELS), decoy(float(rng.choice([0.95, 1.1, 0.1])) * drive)
        elif kind == "error":
            yield name_of(ERRORS), decoy(ahead - values)
        elif kind == "supply" and not _of(known, "supply"):
            yield name_of(SLOW), decoy(24.0 - 0.02 * np.abs(smooth) / np.max(np.abs(smooth)))
        elif kind == "steady":
            yield name_of(STEADY), decoy(np.where(np.arange(n) < n // 2, 10.0, 8.0))
        elif kind == "index":
            yield name_of(INDEX), decoy(np.arange(n, dtype=float))
        elif kind == "stamp":
            seconds = entries[of[_of(known, "time")]][2] * entries[of[_of(known, "time")]][0]
            same = Column("time", "s", same=_of(known, "time"))
            yield name_of(STAMPS), (1.7e9 + seconds + 1e-4 * rng.random(n), same, 1.0, 0.0)
        elif kind == "turned":
            yield name_of(TURNED), decoy(np.cos(0.5 * angle / max(float(np.std(angle)), 1e-9)))
        elif kind == "copy" and not column.same:
            text = of[about]
            clean = f"{text}_filtered" if "[" not in text and "(" not in text else f"filtered {text}"
            same = Column(column.quantity, column.unit, column.counts, same=about)
            yield clean, (smooth, same, *entries[text][2:])


def _of(known: Mapping[str, Column], quantity: str) -> str:
    return next((name for name, column in known.items() if column.quantity == quantity), "")
