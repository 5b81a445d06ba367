"""Friction at rest: what a step costs, and what becomes of a drive that should stand still.

Instructions are counted under QEMU; times are those of one core, the fastest of several rounds.
"""

from __future__ import annotations

import contextlib
import importlib.util
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.cortex_m4 import GENERATED, OPTIMISED, TOOLS, Subject, instructions, missing
from benchmarks.record import Measured, Part, progress
from eccentric.emission import render
from eccentric.model import load_model
from generated import c2_parallel

STEP = "c2_parallel_friction_step"
_SUBJECT = Subject(
    STEP,
    "(float, float, float, float, float *, const c2_parallel_coefficients *)",
    "(x, y, 0.1f, 0.001f, out, &c2_parallel_default)",
    "void",
)
J_M, J_L = 2e-4, 0.04
DRIVES, STEPS = 4096, 5000
STILL, HELD_S, DT = 0.4, 5.0, 1e-3
"""Link angle at which friction holds the mass [rad], how long it should [s], and the time step [s]."""
MOST_CALLS = 50_000
METHODS = ("RK45", "LSODA", "Radau", "BDF")


def measured(quick: bool) -> Part:
    """Cost of a step on a Cortex-M4F, in NumPy and in JAX, and how far a drive at rest drifts."""
    figures, lines = {}, []
    if absent := missing(TOOLS):
        lines.append(f"Instructions on a Cortex-M4F: not installed: {', '.join(absent)}.")
    else:
        with tempfile.TemporaryDirectory() as folder:
            options = [*OPTIMISED, "-DECCENTRIC_REAL=float"]
            sources = [GENERATED / "c2_parallel.c"]
            counts = instructions(Path(folder), '#include "c2_parallel.h"\n', (_SUBJECT,), sources, options)
        figures["step instructions"] = Measured(float(max(counts[STEP])))
    progress("rest: NumPy")
    step, torque = numpy_times(100_000 if quick else 1_000_000)
    figures["step numpy"] = Measured(step, peer=f"{torque:.1f} (`mechanical_friction_torque`)")
    if importlib.util.find_spec("jax") is None:
        lines.append("JAX: not installed.")
    else:
        progress("rest: JAX")
        ours, naive = jax_times(DRIVES, STEPS // (10 if quick else 1))
        figures["step jax"] = Measured(
            ours / naive,
            f"{ours / naive:.2f} ({ours:.2f} s)",
            f"1 ({naive:.2f} s, explicit Euler by the sign)",
        )
    progress("rest: drift")
    return Part(figures, [*lines, "", *drift()])


def numpy_times(count: int) -> tuple[float, float]:
    """Time of an element of `friction_step` and of the friction torque alone [ns], over arrays."""
    random, p = np.random.default_rng(1), _parameters()
    theta_m, omega_m, torque = (random.uniform(-x, x, count) for x in (9.0, 50.0, 1.0))
    out, one = np.empty((count, 2)), np.empty(count)
    step = _fastest(lambda: c2_parallel.friction_step(theta_m, omega_m, torque, DT, p, out=out))
    plain = _fastest(lambda: c2_parallel.mechanical_friction_torque(theta_m, omega_m, p, out=one))
    return step / count * 1e9, plain / count * 1e9


def jax_times(drives: int, steps: int) -> tuple[float, float]:
    """Time of so many steps of so many drives [s]: with `friction_step`, and with a naive step."""
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    module = _jax_module()
    p = module.Parameters(J_m=J_M, J_l=J_L)
    inertia = J_M + p.mu**2 * J_L
    random = np.random.default_rng(2)
    start = (jnp.asarray(random.uniform(-9.0, 9.0, drives)), jnp.zeros(drives))
    motor = jnp.asarray(random.uniform(0.1, 0.4, drives))

    def torque(theta_m: Any, k: Any) -> Any:
        return motor * jnp.sin(2e-3 * k) - module.gravity_torque(theta_m, p)

    def set_valued(state: Any, k: Any) -> Any:
        theta_m, omega_m = state
        omega_m = module.friction_step(theta_m, omega_m, torque(theta_m, k), DT, p)[..., 0]
        return (theta_m + DT * omega_m, omega_m), None

    def naive(state: Any, k: Any) -> Any:
        theta_m, omega_m = state
        friction = module.mechanical_friction_torque(theta_m, omega_m, p)
        omega_m = omega_m + DT / inertia * (torque(theta_m, k) - friction)
        return (theta_m + DT * omega_m, omega_m), None

    def run(step: Callable[..., Any]) -> Callable[[], None]:
        compiled = jax.jit(lambda state: jax.lax.scan(step, state, jnp.arange(steps))[0])

        def once() -> None:
            compiled(start)[0].block_until_ready()

        once()  # compiles
        return once

    return _fastest(run(set_valued), 3), _fastest(run(naive), 3)


def ways() -> dict[str, Callable[[float, float], float]]:
    """The velocity after a time step by motor angle and velocity, under gravity alone: ours first."""
    p = _parameters()
    inertia, held = J_M + p.mu**2 * J_L, float(c2_parallel.breakaway_torque(p)[1])

    def by_torque(width: float) -> Callable[[float, float], float]:
        def step(angle: float, velocity: float) -> float:
            friction = float(c2_parallel.mechanical_friction_torque(angle, velocity, p))
            if width:  # the usual remedy: a steep slope in place of the jump
                viscous = float(c2_parallel.friction_budget(angle, velocity, p)[2])
                friction = held * np.tanh(velocity / width) + viscous * velocity
            return velocity - DT / inertia * (float(c2_parallel.gravity_torque(angle, p)) + friction)

        return step

    def ours(angle: float, velocity: float) -> float:
        torque = -float(c2_parallel.gravity_torque(angle, p))
        return float(c2_parallel.friction_step(angle, velocity, torque, DT, p)[0])

    return {
        "`friction_step`": ours,
        "explicit Euler, sign of the velocity": by_torque(0.0),
        **{f"the same, tanh(w/{w:g}) in place of the sign": by_torque(w) for w in (0.1, 1.0)},
    }


def drift() -> list[str]:
    """A table: a link that friction holds against gravity, by the ways to integrate it."""
    p = _parameters()
    theta_m, held = STILL / p.mu, float(c2_parallel.breakaway_torque(p)[1])
    rows = []
    for name, step in ways().items():
        angle, velocity = theta_m, 0.0
        for _ in range(round(HELD_S / DT)):
            velocity = step(angle, velocity)
            angle += DT * velocity
        rows.append((name, abs(angle - theta_m) * p.mu * 1e3))
    finished = [f"{method} {_reached(method, theta_m, J_M + p.mu**2 * J_L, p):.2g} s" for method in METHODS]
    return [
        f"A link held by friction {STILL:g} rad from its lowest point: gravity exerts"
        f" {float(c2_parallel.gravity_torque(theta_m, p)):.4f} N m of the {held:.4f} N m at which it breaks"
        f" away. After {HELD_S:g} s in steps of {DT * 1e3:g} ms it has moved by:",
        "",
        "| | mrad |",
        "|---|---|",
        *(f"| {what} | {size:.2g} |" for what, size in rows),
        "",
        f"A solver of ordinary differential equations with the friction torque as right-hand side and"
        f" {MOST_CALLS:,} evaluations reaches, of the first second: {', '.join(finished)}.",
    ]


class _EnoughError(Exception):
    pass


def _reached(method: str, theta_m: float, inertia: float, p: Any) -> float:
    """The time [s] of one second that a solver of SciPy reaches within the evaluations it is given."""
    calls, reached = 0, 0.0

    def slope(t: float, y: np.ndarray) -> list[float]:
        nonlocal calls, reached
        calls, reached = calls + 1, max(reached, t)
        if calls > MOST_CALLS:
            raise _EnoughError
        torque = c2_parallel.mechanical_friction_torque(y[0], y[1], p) + c2_parallel.gravity_torque(y[0], p)
        return [y[1], -float(torque) / inertia]

    with contextlib.suppress(_EnoughError):
        solve_ivp(slope, (0.0, 1.0), [theta_m, 0.0], method)
    return reached


def _parameters() -> Any:
    return c2_parallel.Parameters(J_m=J_M, J_l=J_L)


def _jax_module() -> ModuleType:
    model = load_model("c2_parallel")
    name = f"{model.name}_jax"
    module = ModuleType(name)
    sys.modules[name] = module  # a dataclass looks its module up
    exec(compile(render(model, backends=("jax",))[f"{name}.py"], name, "exec"), vars(module))  # noqa: S102
    return module


def _fastest(call: Callable[[], Any], rounds: int = 7) -> float:
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return min(times)
