"""A gear whose ratio varies: its torque by Lagrange's equation, what it resembles, and its plant."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from math import cos, hypot, sin
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

from eccentric.diagnosis import diagnose
from eccentric.effects import library
from eccentric.virtual_bench import simulate, write
from tests.extended import CASES, J_L, J_M, M_L, MU, G, L, M, call, inputs, setting, with_effect
from tests.virtual import drawn_scenario, moving

Array = np.ndarray
ORDERS = {"motor,n=1": 1.0, "motor,n=2": 2.0, "link,n=1": MU, "link,n=2": 2.0 * MU}
"""Variant -> how often the error repeats per radian of the motor, over 2 pi."""
SHARE, VISCOUS_SHARE = 0.3, 0.6  # of the friction without F_N on the link


@cache
def exact_torque(case: str, rate: float) -> Callable[..., Array]:
    """Torque of inertia, gravity and link friction on the motor, by Lagrange's equation in theta_m.

    A function of theta_m, omega_m, alpha_m and of the two parts of the error.
    """
    time, c, s = sp.symbols("time c s", real=True)
    motor = sp.Function("motor")(time)
    link = MU * motor + c * sp.cos(rate * motor) + s * sp.sin(rate * motor)
    g = G if case == "C2" else 0.0
    kinetic = J_M * sp.diff(motor, time) ** 2 / 2 + J_L * sp.diff(link, time) ** 2 / 2
    lagrangian = kinetic + M * g * L * sp.cos(link)
    speed = sp.diff(motor, time)
    free = sp.diff(sp.diff(lagrangian, speed), time) - sp.diff(lagrangian, motor)
    # Friction of the link by its own speed, as a generalised force of the motor angle. In C1 the fit counts
    # that of the transversal force, 0.2 kg 9.81 m/s^2, to the rest.
    across = 0.2 * 9.81 if case == "C1" else 0.0
    dry, viscous = 0.008 + MU * 0.08 * across, 0.0004 + MU**2 * 0.004 * across
    w_l, pull, weight = sp.diff(link, time), M * L * sp.diff(link, time) ** 2, (M + M_L) * g
    force = sp.sqrt(pull**2 + 2 * pull * weight * sp.cos(link) + weight**2)
    friction = (0.08 * force + SHARE * dry / MU) * sp.sign(w_l)
    friction += (0.004 * force + VISCOUS_SHARE * viscous / MU**2) * w_l
    torque = free + friction * sp.diff(link, motor)
    theta, w, alpha = sp.symbols("theta_m omega_m alpha_m", real=True)
    torque = torque.subs(sp.diff(motor, time, 2), alpha).subs(speed, w).subs(motor, theta)
    return sp.lambdify((theta, w, alpha, c, s), torque)


@pytest.mark.parametrize(
    ("case", "variant"),
    [
        ("C2", "motor,n=2"),
        *(
            pytest.param(*one, marks=pytest.mark.slow)
            for one in (("C1", "motor,n=2"), ("C1", "link,n=1"), ("C2", "link,n=1"))
        ),
    ],
)
def test_it_is_the_first_order_of_lagranges_equation(case: str, variant: str) -> None:
    """What is left of the exact torque falls with the square of the error."""
    x, effect = inputs(), with_effect(case, f"kinematic_error[{variant}]")
    x["omega_m"] = np.where(x["omega_m"] == 0.0, 7.0, x["omega_m"])
    exact = exact_torque(case, ORDERS[variant])
    left, added = [], []
    for size in (2e-4, 1e-4):
        c, s = 0.6 * size, 0.8 * size
        values = {"kinematic_c": c, "kinematic_s": s}
        values |= {"kinematic_share": SHARE, "kinematic_share_B": VISCOUS_SHARE}
        found = call(effect.module, "mechanical_residual", x)
        found = found - call(effect.module, "mechanical_residual", x, **values)
        more, none = (
            exact(x["theta_m"], x["omega_m"], x["alpha_m"], *error) for error in ((c, s), (0.0, 0.0))
        )
        left.append(float(np.sqrt(np.mean((more - none - found) ** 2))))
        added.append(float(np.sqrt(np.mean((more - none) ** 2))))

    assert 4.0 == pytest.approx(left[0] / left[1], rel=0.1)
    assert left[1] < 0.02 * added[1]


@pytest.mark.parametrize("case", [pytest.param("C1", marks=pytest.mark.slow), "C2"])
def test_the_circuit_shows_nothing_of_it(case: str) -> None:
    """The motor angle is read rightly, and so is the back-EMF; a misread angle shows there."""
    module = with_effect(case, "kinematic_error[motor,n=1]").module
    before, after = (call(module, "electrical_residual", inputs(), kinematic_c=c) for c in (0.0, 0.01))

    np.testing.assert_array_equal(before, after)


def left(y: Array, *others: Array) -> float:
    """Return the part of y, by its norm, that a fit of the others leaves."""
    x = np.column_stack(others)
    return float(np.linalg.norm(y - x @ np.linalg.lstsq(x, y, rcond=None)[0]) / np.linalg.norm(y))


def columns(case: str, effect_id: str, names: tuple[str, ...], theta: Array, w: Array) -> Array:
    """Columns of the mechanical balance at steady speeds, (rows, k)."""
    x = inputs(len(w)) | {"theta_m": theta, "omega_m": w, "alpha_m": 0.0 * w}
    module = with_effect(case, effect_id).module
    plain = call(module, "mechanical_residual", x)
    return np.column_stack([plain - call(module, "mechanical_residual", x, **{q: 1.0}) for q in names])


OWN = ("kinematic_c", "kinematic_s")


@pytest.mark.parametrize(
    ("case", "fastest", "least", "most"),
    [("C1", 5.0, 0.0, 1e-9), ("C1", 60.0, 0.3, 1.0), ("C2", 5.0, 0.3, 1.0), ("C2", 60.0, 0.3, 1.0)],
    ids=["C1, one speed", "C1, a range of speeds", "C2, one speed", "C2, a range of speeds"],
)
def test_without_gravity_only_a_range_of_speeds_tells_it_from_cogging_and_friction(
    case: str, fastest: float, least: float, most: float
) -> None:
    """At one speed in C1 it is a harmonic of the motor with one part by direction: a tie with those two."""
    rng = np.random.default_rng(4)
    theta = rng.uniform(0.0, 400.0, 3000)
    w = rng.choice([-1.0, 1.0], 3000) * rng.uniform(min(fastest, 5.0), fastest, 3000)
    own = columns(case, "kinematic_error[motor,n=2]", OWN, theta, w)
    harmonics = [wave(2.0 * theta) for wave in (np.cos, np.sin)]
    others = [*harmonics, *(h * np.sign(w) for h in harmonics)]

    assert least <= min(left(column, *others) for column in own.T) <= most


def test_a_misread_angle_of_the_link_has_another_torque() -> None:
    """Beside the encoder's torques, which count inertia of the motor too and no ratio, a fifth is left."""
    rng = np.random.default_rng(5)
    theta, w = rng.uniform(0.0, 400.0, 3000), rng.uniform(-40.0, 40.0, 3000)
    encoder = columns("C2", "encoder_eccentricity[link]", ("eccentric_c", "eccentric_s"), theta, w)
    own = columns("C2", "kinematic_error[link,n=1]", OWN, theta, w)

    assert min(left(column, *encoder.T) for column in own.T) > 0.2


@pytest.mark.parametrize("case", [pytest.param("C1", marks=pytest.mark.slow), "C2"])
def test_it_is_offered_once_where_motor_and_link_turn_alike_and_not_for_an_open_inertia(case: str) -> None:
    """At mu = 1 a turn of the link is one of the motor; at mu = 1/2 two of them are."""
    given = setting(case, warm=False)

    def offered(**changes: object) -> list[str]:
        found = library(replace(given, **changes))
        return [effect.variant for effect in found if effect.family == "kinematic_error"]

    assert [[*ORDERS], ["motor,n=1", "motor,n=2"], ["motor,n=1", "motor,n=2", "link,n=1"], []] == [
        offered(),
        offered(mu=1.0),
        offered(mu=0.5),
        offered(left_open=("inertia",)),
    ]


@pytest.mark.parametrize("case", CASES)
def test_the_plant_moves_as_the_exact_equation_says(case: str) -> None:
    """Half a second under a constant voltage, against SciPy: twice as close with half the step squared."""
    scenario = drawn_scenario(3, case=case, effects=["kinematic_error[motor,n=2]"])
    effect, p, size = replace(scenario.effects[0], amplitude=0.01), scenario.plant, 0.01
    rate, shift = effect.shape

    def motion_of(_: float, x: Array) -> list[float]:
        theta, w = x
        link = p.mu * theta + size * sin(rate * theta + shift)
        ratio, bend = (
            p.mu + size * rate * cos(rate * theta + shift),
            -size * rate**2 * sin(rate * theta + shift),
        )
        weight = (p.M + p.M_l) * p.in_plane_gravity
        normal = hypot(p.M * p.L * (ratio * w) ** 2 + weight * cos(link), weight * sin(link))
        gamma, beta = (p.gamma_T, p.beta_T) if case == "C1" else (0.0, 0.0)
        friction = (p.C_lN * normal + gamma) * np.sign(w) + (p.B_lN * normal + beta) * ratio * w
        torque = p.k_i * (6.0 - p.k_e * w) / p.R - p.C_m * np.sign(w) - p.B_m * w
        torque -= (
            ratio * (p.M * p.in_plane_gravity * p.L * sin(link) + friction) + p.J_l * ratio * bend * w**2
        )
        return [w, torque / (p.J_m + p.J_l * ratio**2)]

    expected = solve_ivp(motion_of, (0.0, 0.5), [1.0, 30.0], rtol=1e-9, atol=1e-9, max_step=1e-3).y[:, -1]
    away = []
    for dt in (5e-4, 2.5e-4):
        motion, advance = moving(p, dt, [effect], theta=1.0, w=30.0)
        for _ in range(round(0.5 / dt)):
            advance(6.0)
        away.append(abs(motion.w - expected[1]))

    assert away[0] < 1e-5 * abs(expected[1])
    assert away[1] < 0.3 * away[0]


@pytest.mark.slow
def test_a_planted_one_is_named_with_its_size(tmp_path: Path) -> None:
    """On a bench log it is the only name, and its amplitude is the planted one."""
    scenario = drawn_scenario(97310, case="C2", mu=0.2, effects=["kinematic_error[motor,n=2]"], strength=0.1)
    run = simulate(scenario)
    log, rig, _ = write(run, tmp_path / "log.csv.gz")
    found = diagnose([log], rig)
    values = found.models.extended.values
    planted = run.truth["effects"][0]

    assert ["kinematic_error[motor,n=2]"] == [a.variant.candidate.id for a in found.attribution.adopted]
    assert "named" == found.attribution.verdict
    assert planted["amplitude"] == pytest.approx(
        np.hypot(values["kinematic_c"], values["kinematic_s"]), rel=0.05
    )
