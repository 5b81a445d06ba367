"""Logs of simulated rigs: Newton's law and closed-form motions, written out here without the package.

A motor of constants R, k_i, k_e turns a link by the gear mu; the link carries M at the distance L, gravity in
the plane of motion.  Motions are sums of sines, so that the drive they require is known in closed form; with
the motor switched off the link swings freely, integrated by SciPy from one reversal to the next.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]
Friction = Callable[[Array, Array], Array]
"""Friction torque at the motor (n,) [N m] beyond Coulomb and viscous, from its angle and speed (n,)."""

RATE = 125.0
COUNTS = 65536
VOLTAGE = ("time_s", "theta_m_rad", "voltage_V", "motor_off")
HELD_OUT = 'holdout_runs = ["driven_2", "free_1"]\n'
GARBAGE_V = 7.7
"""What is logged as voltage while the motor is switched off: it must not count."""


def none(_: Array, omega: Array) -> Array:
    """No further friction."""
    return np.zeros_like(omega)


@dataclass(frozen=True)
class Swing:
    """The rig, at the motor where not said otherwise; SI units."""

    M: float = 0.5
    L: float = 0.1
    mu: float = 0.5
    g: float = 9.81
    J: float = 0.003
    C: float = 0.02
    B: float = 0.0015
    R: float = 3.0
    k_i: float = 0.2
    k_e: float = 0.25
    more: Friction = none

    @property
    def known(self) -> str:
        """What the rig file knows of it: the geometry, neither motor nor inertia."""
        return f'case = "C2"\nM_kg = {self.M}\nM_l_kg = 0.0\nL_m = {self.L}\nmu = {self.mu}\n'

    def load(self, theta: Array) -> Array:
        """Gravity torque at the motor."""
        return self.mu * self.M * self.g * self.L * np.sin(self.mu * theta)

    def friction(self, theta: Array, omega: Array) -> Array:
        """Friction torque at the motor."""
        return self.C * np.sign(omega) + self.B * omega + self.more(theta, omega)

    def torque(self, theta: Array, omega: Array, alpha: Array) -> Array:
        """Drive torque that the motion requires."""
        return self.J * alpha + self.load(theta) + self.friction(theta, omega)

    def voltage(self, theta: Array, omega: Array, alpha: Array) -> Array:
        """Armature voltage that the motion requires, inductance neglected."""
        return self.R / self.k_i * self.torque(theta, omega, alpha) + self.k_e * omega


def sines(rng: np.random.Generator, pace: float = 1.0, seconds: float = 8.0) -> tuple[Array, ...]:
    """Time, angle, speed, acceleration of the motor: three sines of random frequency and phase.

    `pace` below 1 slows the same motion down.
    """
    t = np.arange(0.0, seconds, 1.0 / RATE)
    theta, omega, alpha = (np.zeros_like(t) for _ in range(3))
    for amplitude, low, high in ((4.0, 1.0, 2.0), (2.0, 2.5, 4.5), (0.6, 6.0, 9.0)):
        w, phase = pace * rng.uniform(low, high), rng.uniform(0.0, 2.0 * np.pi)
        theta += amplitude * np.sin(w * t + phase)
        omega += amplitude * w * np.cos(w * t + phase)
        alpha += -amplitude * w * w * np.sin(w * t + phase)
    return t, theta, omega, alpha


def free_swing(rig: Swing, theta: float, seconds: float = 10.0) -> tuple[Array, Array]:
    """Time and angle of the motor after it is let go at an angle, until it sticks."""
    t, step = 0.0, 1.0 / RATE
    state, found = np.array([theta, 0.0]), [np.array([theta])]
    while t < seconds - step:
        pull = -float(rig.load(state[:1])[0])
        if abs(pull) <= float(np.abs(rig.friction(state[:1], np.array([1e-9])))[0]):
            break
        side = np.sign(pull)

        def slope(_: float, y: Array, side: float = side) -> list[float]:
            # On this side of the reversal the sign of the speed is known, whatever the integrator tries.
            omega = side * max(side * y[1], 1e-9)
            torque = rig.load(y[:1]) + rig.friction(y[:1], np.array([omega]))
            return [y[1], -float(torque[0]) / rig.J]

        def reversal(time: float, y: Array, side: float = side, start: float = t) -> float:
            return side * y[1] if time > start + step else 1.0

        reversal.terminal = True  # pyright: ignore[reportFunctionMemberAccess]
        grid = np.arange(np.ceil(t / step + 1e-9), round(seconds / step)) * step
        part = solve_ivp(slope, (t, seconds), state, "DOP853", grid, events=reversal, rtol=1e-10, atol=1e-12)
        found.append(part.y[0])
        if part.status != 1:
            break
        t, state = float(part.t_events[0][0]), np.array([part.y_events[0][0][0], 0.0])
    angle = np.concatenate(found)
    return np.asarray(step * np.arange(len(angle), dtype=float)), angle


@dataclass(frozen=True)
class Run:
    """One run of a log: its columns by name, each (n,)."""

    columns: Mapping[str, Array]


def driven(
    rig: Swing, rng: np.random.Generator, noise_V: float = 0.0, noise_Nm: float = 0.0, pace: float = 1.0
) -> Run:
    """A run of sines, its drive measured in every way; white noise as given (`noise_Nm` on the torque)."""
    t, theta, omega, alpha = sines(rng, pace)
    torque = rig.torque(theta, omega, alpha) + noise_Nm * rng.standard_normal(len(t))
    voltage = rig.voltage(theta, omega, alpha) + noise_V * rng.standard_normal(len(t))
    return _run(t, theta, voltage, torque / rig.k_i, torque, np.zeros_like(t))


def _run(t: Array, theta: Array, *measured: Array) -> Run:
    """A run of these columns, the angle as its encoder counts it."""
    names = ("voltage_V", "current_A", "torque_Nm", "motor_off")
    return Run({"time_s": t, "theta_m_rad": _counted(theta)} | dict(zip(names, measured, strict=True)))


def free(rig: Swing, theta: float) -> Run:
    """A run with the motor switched off."""
    t, angle = free_swing(rig, theta)
    nothing = np.full_like(t, GARBAGE_V)
    return _run(t, angle, nothing, nothing, nothing, np.ones_like(t))


def log_of(rig: Swing, noise_V: float = 0.05, noise_Nm: float = 0.003, swings: bool = True) -> dict[str, Run]:
    """Six driven runs, two of them slow, and three free ones."""
    rng = np.random.default_rng(5)
    paces = (1.0, 0.2, 1.0, 1.0, 0.2, 1.0)
    runs = {f"driven_{k}": driven(rig, rng, noise_V, noise_Nm, p) for k, p in enumerate(paces)}
    return runs | ({f"free_{k}": free(rig, a) for k, a in enumerate((4.5, 5.5, 3.5))} if swings else {})


def _counted(theta: Array) -> Array:
    step = 2.0 * np.pi / COUNTS
    return np.round(theta / step) * step


def write_runs(path: Path, runs: Mapping[str, Run], names: Sequence[str]) -> Path:
    """Write these columns of runs as one log with a column `run`."""
    lines = [",".join(["run", *names])]
    for name, run in runs.items():
        rows = zip(*(run.columns[column] for column in names), strict=True)
        lines += [",".join([name, *(f"{x:.9g}" for x in row)]) for row in rows]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def write_rig(path: Path, known: str, above: str = "", columns: Sequence[str] = ()) -> Path:
    """Write a rig file for such a log."""
    text = f"encoder_counts_per_rev = {COUNTS}\n{above}\n"
    if columns:
        text += f"columns = {list(columns)!r}\n".replace("'", '"')
    path.write_text(f"{text}[known]\n{known}", encoding="utf-8")
    return path
