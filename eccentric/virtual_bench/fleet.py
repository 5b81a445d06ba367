"""A fleet of drives in closed form: prescribed motion, seasonal friction, wear, faulty sensors.

Each joint swings an unbalanced mass in a vertical plane along a sum of sines, so that angle, velocity,
acceleration and current are closed-form: no simulation, about 0.2 us per row. The fleet is an oracle for the
toolkit, so nothing here comes from the derivations.
"""

from __future__ import annotations

import csv
import importlib
import io
import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator, default_rng
from numpy.typing import NDArray

from eccentric.core import InputError, own_folder, whole_folder

Array = NDArray[np.float64]

WAYS = {
    "viscous": "the lubricant ages: viscous friction of the motor's bearing rises",
    "coulomb": "a preload or a seal tightens: Coulomb friction of the motor's bearing rises",
    "load": "the link's bearing wears: friction that follows its load rises",
    "link_harmonic_friction": "a bearing is distorted: friction varies twice per turn of the link",
    "stribeck": "the lubricant film fails at low speed: friction rises towards rest",
}
"""Degradations of a joint, by the toolkit's name for them."""
BAD_SENSORS = {
    "current offset": "the current sensor shows an offset",
    "temperature stuck": "the temperature sensor repeats its last value",
}
"""Sensor faults; friction does not change."""
COUNTS = 32768
"""Encoder counts per motor turn."""
GRAVITY = 9.81


@dataclass(frozen=True)
class FleetJoint:
    """A joint: declared values (the paper's symbols, SI), sealed values, and its degradation.

    `way` is in WAYS or BAD_SENSORS, "" for a healthy joint; from period index `since` on it grows over
    `lasts` periods to `strength` times the mean friction torque.
    """

    name: str
    kind: str
    known: dict[str, float]
    C_m: float
    B_m: float
    C_lN: float
    B_lN: float
    warmer: float
    seed: int
    way: str = ""
    since: int = 0
    lasts: int = 1
    strength: float = 0.0

    def grown(self, period: int) -> float:
        """Progress of the change in a period: 0 before it, 1 at the end."""
        return float(np.clip((period - self.since + 1) / self.lasts, 0.0, 1.0)) if self.way else 0.0


@dataclass(frozen=True)
class FleetPlan:
    """A fleet: joints, names of the periods, rows per file, sampling rate [Hz]."""

    joints: tuple[FleetJoint, ...]
    periods: tuple[str, ...]
    rows: int
    rate_hz: float
    seed: int

    def log(self, joint: FleetJoint, period: int) -> dict[str, NDArray[Any]]:
        """The columns (rows,) of the log of a joint in a period, by its index."""
        random = default_rng([self.seed, joint.seed, period])
        t = np.arange(self.rows) / self.rate_hz
        theta, omega, alpha = _motion(random, t, joint.known["mu"])
        stuck = joint.way == "temperature stuck" and period >= joint.since
        warm = _temperature(period, joint) + 3.0 * (1.0 - np.exp(-t / 400.0))
        torque = _torque(joint, random, joint.grown(period), theta, omega, alpha, warm)
        current = torque / joint.known["k_i"]
        current = current + 0.01 * np.max(np.abs(current)) * random.standard_normal(self.rows)
        if joint.way == "current offset":
            current = current + joint.grown(period) * joint.strength * np.mean(np.abs(current))
        if stuck:
            warm = np.full_like(warm, round(_temperature(joint.since, joint), 1))
        step = 2.0 * pi / COUNTS
        return {
            "time_s": t,
            "theta_m_rad": np.round(theta / step) * step,
            "current_A": np.round(current, 4).astype(np.float32),
            "temperature_C": np.round(warm, 1).astype(np.float32),
        }

    def logs(self) -> Iterator[tuple[FleetJoint, int]]:
        """Every joint and period, joint by joint."""
        yield from ((joint, period) for joint in self.joints for period in range(len(self.periods)))

    def truth(self) -> dict[str, Any]:
        """The sealed truth: the changing joints, how, since when, and how much."""
        return {
            joint.name: {
                "way": joint.way,
                "since": self.periods[joint.since],
                "strength": joint.strength,
                "sensor": joint.way in BAD_SENSORS,
            }
            for joint in self.joints
            if joint.way
        }


def fleet_plan(
    joints: int = 12,
    periods: int = 6,
    degrading: int = 2,
    bad_sensors: int = 0,
    seconds: float = 40.0,
    rate_hz: float = 200.0,
    seed: int = 1,
    ways: Sequence[str] = tuple(WAYS),
) -> FleetPlan:
    """Draw a fleet; the changing joints take the degradations of `ways` in turn.

    Raises InputError for a number out of range.
    """
    _require(joints=joints, periods=periods, degrading=degrading, bad_sensors=bad_sensors, seconds=seconds)
    random = default_rng(seed)
    width = len(str(joints))
    healthy = [_joint(random, f"J{k:0{width}d}", k) for k in range(1, joints + 1)]
    chosen = random.permutation(joints)[: degrading + bad_sensors]
    for turn, k in enumerate(chosen):
        every = tuple(ways) if turn < degrading else tuple(BAD_SENSORS)
        way = every[(turn if turn < degrading else turn - degrading) % len(every)]
        first = max(2, periods // 3)
        healthy[k] = replace(
            healthy[k],
            way=way,
            since=min(int(random.integers(first, max(first + 1, periods - 2))), periods - 1),
            lasts=int(random.integers(1, max(2, periods // 3))),
            strength=float(random.uniform(0.25, 0.5)),
        )
    names = tuple(f"{2025 + k // 12}-{k % 12 + 1:02d}" for k in range(periods))
    return FleetPlan(tuple(healthy), names, round(seconds * rate_hz), rate_hz, seed)


def _require(**numbers: float) -> None:
    least = {"joints": 1, "periods": 1, "degrading": 0, "bad_sensors": 0, "seconds": 5.0}
    most = {"joints": 10**5, "periods": 600, "seconds": 10**6}
    for name, value in numbers.items():
        if not least[name] <= value <= most.get(name, numbers["joints"]):
            raise InputError(
                name, f"a number from {least[name]:g} to {most.get(name, numbers['joints']):g}", f"{value:g}"
            )
    if numbers["degrading"] + numbers["bad_sensors"] > numbers["joints"]:
        raise InputError("degrading", problem="expected no more joints than the fleet has to change")


def _joint(random: Generator, name: str, seed: int) -> FleetJoint:
    kind = ("shoulder", "elbow")[int(random.integers(2))]
    size = {"shoulder": 1.0, "elbow": 0.6}[kind]

    def about(value: float, part: float = 0.1) -> float:
        return float(value * random.uniform(1.0 - part, 1.0 + part))

    M, L, mu = about(0.6 * size), about(0.32 * size), 0.2
    M_l = about(0.2 * size)
    known = {
        "M": M,
        "M_l": M_l,
        "L": L,
        "mu": mu,
        "k_i": about(0.06, 0.05),
        "J_m": about(1.2e-4 * size),
        "J_l": 1.15 * M * L**2,
        "g": GRAVITY,
    }
    level = 0.08 * size
    weight = (M + M_l) * GRAVITY
    return FleetJoint(
        name=name,
        kind=kind,
        known=known,
        C_m=about(0.45 * level, 0.3),
        B_m=about(0.018 * level, 0.3),
        C_lN=about(0.45 * level / (mu * weight), 0.3),
        B_lN=about(0.008 * level / (mu**2 * weight), 0.3),
        warmer=float(random.uniform(-4.0, 4.0)),
        seed=seed,
    )


def _motion(random: Generator, t: Array, mu: float) -> tuple[Array, Array, Array]:
    """Angle, velocity, acceleration of the motor: three sines, with the link occasionally passing the top."""
    theta, omega, alpha = (np.zeros_like(t) for _ in range(3))
    for size, hertz in ((2.2, 0.23), (0.9, 0.61), (0.25, 1.37)):
        a, w = size * random.uniform(0.8, 1.2) / mu, 2.0 * pi * hertz * random.uniform(0.9, 1.1)
        phase = w * t + random.uniform(0.0, 2.0 * pi)
        sine, cosine = np.sin(phase), np.cos(phase)
        theta += a * sine
        omega += a * w * cosine
        alpha -= a * w**2 * sine
    return theta, omega, alpha


def _temperature(period: int, joint: FleetJoint) -> float:
    """Mean temperature of a month [deg C]: coldest in the first, warmest half a year later."""
    wobble = float(default_rng([joint.seed, period, 7]).normal(0.0, 1.0))
    return 22.0 + joint.warmer - 8.0 * np.cos(2.0 * pi * period / 12.0) + wobble


def _torque(
    joint: FleetJoint, random: Generator, grown: float, theta: Array, omega: Array, alpha: Array, warm: Array
) -> Array:
    """The motor torque [N m] along the motion: inertia, gravity, and temperature-dependent friction."""
    rig, change = joint.known, joint.way if joint.way in WAYS else ""
    mu, weight = rig["mu"], (rig["M"] + rig["M_l"]) * rig["g"]
    link, swing = mu * theta, rig["M"] * rig["L"] * (mu * omega) ** 2
    # The bearing carries the weight and the centripetal force.
    normal = np.hypot(swing * np.sin(link), swing * np.cos(link) + weight)
    # Random variation from month to month.
    C_m, B_m, C_lN, B_lN = (
        value * random.normal(1.0, 0.01) for value in (joint.C_m, joint.B_m, joint.C_lN, joint.B_lN)
    )
    thin, sign = np.exp(-0.02 * (warm - 22.0)), np.sign(omega)
    dry, wet = C_m + mu * C_lN * normal, (B_m + mu**2 * B_lN * normal) * np.abs(omega) * thin
    friction = dry + wet
    if change:
        more = grown * joint.strength * float(np.mean(friction))
        friction = friction + more * _shape(change, joint, link, omega, normal, thin)
    inertia = rig["J_m"] + mu**2 * rig["J_l"]
    return inertia * alpha + mu * rig["M"] * rig["L"] * rig["g"] * np.sin(link) + sign * friction


def _shape(way: str, joint: FleetJoint, link: Array, omega: Array, normal: Array, thin: Array) -> Array:
    """Dependence of a change on the motion, (n,); with mean 1 for the three in the base model."""
    if way == "coulomb":
        return np.ones_like(omega)
    if way == "viscous":
        wet = np.abs(omega) * thin
        return wet / np.mean(wet)
    if way == "load":
        return normal / np.mean(normal)
    if way == "link_harmonic_friction":
        return np.sqrt(2.0) * np.cos(2.0 * link + 0.1 * joint.seed)
    return 2.0 * np.exp(-((omega / (0.25 * np.sqrt(np.mean(omega**2)))) ** 2))


_RIG = """# A kind of joint of the fleet; values of their own are in rigs.csv.
drive = "current"
encoder_counts_per_rev = 32768
low_pass_hz = 25.0

[columns]
time = "time_s"
theta_m = "theta_m_rad"
current = "current_A"
temperature = "temperature_C"

[known]
case = "C2"
g_m_s2 = 9.81
"""
_KEYS = {
    "M": "M_kg",
    "M_l": "M_l_kg",
    "L": "L_m",
    "mu": "mu",
    "k_i": "k_i_Nm_per_A",
    "J_m": "J_m_kgm2",
    "J_l": "J_l_kgm2",
}


def write_fleet(plan: FleetPlan, path: str | Path, progress: Callable[[float], None] | None = None) -> Path:
    """Write a fleet atomically into a new or empty folder; `progress` gets the completed fraction.

    Raises InputError if pyarrow is not installed, or the folder holds anything.
    """
    try:
        arrow, parquet = (importlib.import_module(name) for name in ("pyarrow", "pyarrow.parquet"))
    except ImportError:
        raise InputError("fleet", problem='pyarrow is required: pip install "eccentric[fleet]"') from None
    target = own_folder(path)
    if target.exists() and any(target.iterdir()):
        raise InputError(path, problem="expected a new or empty folder")
    total = len(plan.joints) * len(plan.periods)
    with whole_folder(path, "bench --fleet") as new:
        for done, (joint, period) in enumerate(plan.logs()):
            place = new / "logs" / f"joint={joint.name}" / f"month={plan.periods[period]}" / "log.parquet"
            place.parent.mkdir(parents=True)
            parquet.write_table(arrow.table(plan.log(joint, period)), place)
            if progress is not None and done % 20 == 0:
                progress(done / total)
        for kind in sorted({joint.kind for joint in plan.joints}):
            (new / f"{kind}.toml").write_text(_RIG, encoding="utf-8")
        (new / "rigs.csv").write_text(_table(plan), encoding="utf-8")
        (new / "truth.json").write_text(json.dumps(plan.truth(), indent=1) + "\n", encoding="utf-8")
    if progress is not None:
        progress(1.0)
    return Path(path)


def _table(plan: FleetPlan) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["joint", "rig", *_KEYS.values()])
    for joint in plan.joints:
        values = (f"{joint.known[letter]:.9g}" for letter in _KEYS)
        writer.writerow([joint.name, f"{joint.kind}.toml", *values])
    return text.getvalue()
