"""Steps of friction at rest beside an integration from event to event (a stop, a start) of the same drive.

The reference takes friction from the closed forms of the paper, with the direction of motion fixed.
"""

import inspect
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from eccentric.emission.hot import load_module
from eccentric.model import load_model
from tests import extended, paper
from tests.emitted import module

START, TILT, STRIBECK_A, STRIBECK_V = 2.0, 0.5, 0.03, 8.0
P = paper.table_1(float, J_m=2e-4, J_l=0.04, phi=TILT)
WAYS = {
    s: SimpleNamespace(sqrt=math.sqrt, sin=math.sin, cos=math.cos, sign=lambda _, s=s: s) for s in (1, -1)
}
"""Functions for the closed forms, by direction of motion."""


@dataclass(frozen=True)
class Drive:
    """A drive with the friction of Table 1.

    Attributes:
        friction: the resultant friction torque [N m] of angle, velocity, acceleration and direction.
        swing: amplitude of the motor torque [N m].
        gravity: in the plane of motion, over g.
        stribeck: increase of friction near rest [N m].
        values: further parameters of the emitted model.
    """

    friction: Callable[[float, float, float, SimpleNamespace], float]
    swing: float = 0.35
    gravity: float = 1.0
    stribeck: float = 0.0
    values: tuple[tuple[str, float], ...] = ()

    def torque(self, t: float, theta_m: float) -> float:
        """A motor torque that swings, minus gravity [N m]."""
        return self.swing * math.sin(1.7 * t) - self.gravity * paper.gravity_torque(theta_m, P, math)

    def level(self, theta_m: float) -> float:
        """Of friction at rest [N m]."""
        return self.friction(theta_m, 0.0, 0.0, WAYS[1]) + self.stribeck

    def acceleration(self, t: float, theta_m: float, omega_m: float, sign: int) -> float:
        """Of the motor in a direction of motion [rad/s^2]; found by iteration if friction follows it."""
        fallen = sign * self.stribeck * math.exp(-((omega_m / STRIBECK_V) ** 2))
        net = self.torque(t, theta_m) - fallen + paper.back_emf_damping(P) * omega_m
        alpha_m, before = 0.0, math.inf
        while abs(alpha_m - before) > 1e-12 * abs(alpha_m):
            friction = self.friction(theta_m, omega_m, alpha_m, WAYS[sign])
            alpha_m, before = (net - friction) / (P.J_m + P.mu**2 * P.J_l), alpha_m
        return alpha_m


def of_c2(theta_m: float, omega_m: float, _: float, way: SimpleNamespace) -> float:
    """Eqs (18)-(20)."""
    return paper.friction_torque_c2(theta_m, omega_m, P, way)


def of_rotating_link(theta_m: float, omega_m: float, alpha_m: float, way: SimpleNamespace) -> float:
    """In a tilted plane, with the acceleration in F_N."""
    return paper.friction_torque_rotating_link(theta_m, omega_m, alpha_m, P, way)


DRIVES = {
    "c1_perpendicular": Drive(lambda _, w, __, way: paper.friction_torque_c1(w, P, way), 0.07, gravity=0.0),
    "c2_parallel": Drive(of_c2),
    "rotating_link": Drive(of_rotating_link, gravity=math.cos(TILT), values=(("phi", TILT),)),
    "stribeck": Drive(
        of_c2, stribeck=STRIBECK_A, values=(("stribeck_A", STRIBECK_A), ("stribeck_v", STRIBECK_V))
    ),
}
every_drive = pytest.mark.parametrize("name", DRIVES)


@cache
def reference(name: str, until: float) -> np.ndarray:
    """Angle and velocity every 0.2 s, from event to event."""
    drive, times = DRIVES[name], np.arange(1, round(5.0 * until) + 1) / 5.0
    rows, t, state, sign = [], 0.0, np.array([START, 0.0]), 0
    while t < until:
        if sign == 0:  # until the torque leaves the levels
            theta_m = state[0]
            grid = np.linspace(t, until, 20_001)
            beyond = [abs(drive.torque(s, theta_m)) > drive.level(theta_m) for s in grid]
            if not any(beyond):
                return np.array([*rows, *(state for s in times if s > t)])
            first = beyond.index(True)
            low, high = grid[max(first - 1, 0)], grid[first]
            for _ in range(60):
                middle = (low + high) / 2.0
                held = abs(drive.torque(middle, theta_m)) <= drive.level(theta_m)
                low, high = (middle, high) if held else (low, middle)
            rows += [state for s in times if t < s <= high]
            t, sign = float(high), int(math.copysign(1.0, drive.torque(high, theta_m)))

        def slope(s: float, y: np.ndarray, sign: int = sign) -> tuple[float, float]:
            return y[1], drive.acceleration(s, y[0], y[1], sign)

        def stopped(_: float, y: np.ndarray, sign: int = sign) -> float:
            return sign * y[1] + 1e-13

        stopped.terminal, stopped.direction = True, -1.0  # type: ignore[attr-defined]
        options = {"rtol": 1e-10, "atol": 1e-12, "events": stopped, "dense_output": True}
        found = solve_ivp(slope, (t, until), state, "DOP853", **options)
        rows += [found.sol(s) for s in times if t < s <= found.t[-1]]
        t, state = float(found.t[-1]), found.y[:, -1]
        if found.status == 1:
            state = np.array([state[0], 0.0])
            torque = drive.torque(t, state[0])
            sign = int(math.copysign(1.0, torque)) if abs(torque) > drive.level(state[0]) else 0
    return np.array(rows)


@cache
def stepped(name: str, until: float, dt: float) -> np.ndarray:
    """Angle and velocity every 0.2 s, by emitted steps."""
    drive = DRIVES[name]
    if drive.stribeck:
        emitted = load_module(extended.effects("C2")["stribeck[d=2]"].extend(load_model("c2_parallel"), {}))
    else:
        emitted = module(name)
    p = emitted.Parameters(J_m=P.J_m, J_l=P.J_l, **dict(drive.values))
    state = {"theta_m": START, "omega_m": 0.0, "alpha_m": 0.0}
    names = [x for x in inspect.signature(emitted.friction_step).parameters if x in state]
    rows = []
    for k in range(round(until / dt)):
        torque = drive.torque(k * dt, state["theta_m"])
        after = float(emitted.friction_step(*(state[x] for x in names), torque, dt, p)[0])
        alpha_m = (after - state["omega_m"]) / dt if after else 0.0
        state = {"theta_m": state["theta_m"] + dt * after, "omega_m": after, "alpha_m": alpha_m}
        if (k + 1) % round(0.2 / dt) == 0:
            rows.append((state["theta_m"], after))
    return np.array(rows)


@every_drive
def test_the_step_is_of_first_order(name: str) -> None:
    """The largest errors of angle and velocity over dt, from rest and past the first reversal.

    The term of next order is dt times a rate of these drives, some 5/s: 2 % of the error at 4 ms.
    """
    exact, steps = reference(name, 3.0), np.array([4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4])
    errors = [np.abs(stepped(name, 3.0, dt) - exact).max(axis=0) for dt in steps]
    orders, _ = np.polyfit(np.log(steps), np.log(errors), 1)

    assert exact[0] == pytest.approx([START, 0.0], abs=0.0)
    assert exact[:, 1].min() < -1.0 < 1.0 < exact[:, 1].max()
    assert orders == pytest.approx([1.0, 1.0], abs=0.02)


@every_drive
@pytest.mark.parametrize("dt", [1e-3, 2.5e-4])
def test_a_stop_is_missed_by_a_step_at_most(name: str, dt: float) -> None:
    """A drive stops at the end of a step: past several stops the error is still a few steps of travel."""
    exact = reference(name, 6.0)
    error = np.abs(stepped(name, 6.0, dt) - exact)[:, 0]

    assert error.max() < 2.0 * dt * np.abs(exact[:, 1]).max()
