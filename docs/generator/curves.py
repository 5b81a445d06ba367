"""What an effect adds to its balance, as numbers: the extended model less the base, on a course of motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import sympy as sp

from eccentric.effects import Effect
from eccentric.model import Model, meaning
from eccentric.model import vocabulary as v
from generator.setting import CURRENT, FRICTION, KNOWN, SPEED, WARM

Array = np.ndarray
# (name of the x axis, x, inputs); every course has the same number of samples but those over time.
Course = tuple[str, Array, dict[str, Array]]
Added = Callable[[Mapping[str, float], Mapping[str, Array]], Array]


def course(effect: Effect) -> Course:
    """How the drive moves in the picture of the effect: its leading variable goes through its range."""
    leading = effect.evidence.depends_on[0]
    if "time" in effect.evidence.depends_on:
        t = np.linspace(0.0, 60.0, 601)
        return "time [s], at a constant speed", t, _steady(t, t=t, omega_m=30.0, i=8.0)
    if effect.change.states:
        t = np.linspace(0.0, 2.0, 2001)
        omega = 20.0 * np.sin(2 * np.pi * t)
        theta = -20.0 / (2 * np.pi) * np.cos(2 * np.pi * t)
        current = CURRENT * np.sin(2 * np.pi * t)
        inputs = {"t": t, "omega_m": omega, "theta_m": theta, "i": current}
        inputs["alpha_m"] = np.gradient(omega, t)
        if leading == "current" and "history" in effect.evidence.depends_on:  # a loop
            return "current [A]", current, inputs
        return "time [s], the speed a sine of 1 Hz", t, inputs
    one = np.linspace(-1.0, 1.0, 401)
    turn = np.pi * (1 + one)
    if leading == "link_angle":
        return "link angle [deg]", np.degrees(turn), _steady(one, theta_m=turn / KNOWN["mu"], omega_m=20.0)
    if leading == "motor_angle":
        return "motor angle [deg]", np.degrees(turn), _steady(one, theta_m=turn, omega_m=20.0, i=8.0)
    if leading in {"gravity_load", "transmitted_torque"}:
        theta_l = 0.5 * np.pi * one
        gravity = KNOWN["mu"] * KNOWN["M"] * KNOWN["g"] * KNOWN["L"] * np.sin(theta_l)
        return "gravity torque [N m]", gravity, _steady(one, theta_m=theta_l / KNOWN["mu"], omega_m=20.0)
    if leading == "acceleration":
        return "acceleration [rad/s²]", 200.0 * one, _steady(one, alpha_m=200.0 * one, omega_m=20.0)
    if leading == "current":
        return "current [A]", CURRENT * one, _steady(one, i=CURRENT * one, omega_m=20.0)
    if leading == "temperature":
        warm = WARM + 25.0 * one
        return "temperature [°C]", warm, _steady(one, temperature=warm, omega_m=20.0, i=8.0)
    return "motor velocity [rad/s]", SPEED * one, _steady(one, omega_m=SPEED * one, theta_m=0.0)


def added(effect: Effect, base: Model) -> Added:
    """What the effect adds to the torque (or voltage) that the drive has to bring up.

    Args:
        effect: the record.
        base: the model it extends.

    Returns:
        A function of the effect's parameters by name and of the inputs by name, each (samples,); hidden
        states run along them.
    """
    model = effect.extend(base)
    own = [q.symbol for q in effect.parameters]
    others = (q for q in model.parameters if q.symbol not in own)
    numbers = {q.symbol: {**KNOWN, **FRICTION}.get(q.name, 0.0) for q in others}
    states = [state.symbol for state in effect.change.states]
    names = [*own, *(q.symbol for q in model.inputs), *states, v.dt.symbol]

    def compiled(expression: sp.Expr) -> Callable[..., Any]:
        return sp.lambdify(names, meaning(expression).subs(numbers), "numpy", cse=True)

    before, after = (one.expand(one.balance(effect.balance).residual()) for one in (base, model))
    change = compiled(before - after)
    updates = [compiled(model.expand(state.update)) for state in effect.change.states]

    def along(values: Mapping[str, float], inputs: Mapping[str, Array]) -> Array:
        parameters = [values[q.name] for q in effect.parameters]
        size = len(inputs["t"])
        signals = [inputs.get(q.name, np.zeros(size)) for q in model.inputs]
        step = np.gradient(inputs["t"])
        if not effect.change.states:
            return np.broadcast_to(change(*parameters, *signals, step), size)
        found, now = np.empty(size), [float(state.initial) for state in effect.change.states]
        for k, dt in enumerate(step):
            at = (*parameters, *(signal[k] for signal in signals), *now, dt)
            found[k] = change(*at)
            now = [float(update(*at)) for update in updates]
        return found

    return along


def _steady(like: Array, **inputs: Array | float) -> dict[str, Array]:
    """Inputs that hold still but for those given."""
    still = {"t": 0.0, "theta_m": 0.5 * np.pi / KNOWN["mu"], "omega_m": 0.0, "alpha_m": 0.0}
    still |= {"i": 0.0, "u": 0.0, "temperature": WARM}
    return {name: np.broadcast_to(value, like.shape) for name, value in {**still, **inputs}.items()}
