"""An elastic joint: its torque against two masses and a spring, simulated or solved to all orders."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import eccentric
from eccentric.effects import library
from eccentric.emission import executed, render
from tests.extended import J_L, J_M, K_E, K_I, M_L, MU, G, L, M, R, call, inputs, setting

Array = np.ndarray
LOAD = M * G * L  # gravity torque on the link [N m]


def periodic_torque(kappa: float, speed: float, angle: Array) -> Array:
    """Torque [N m] of an elastic link on a motor of constant speed, motor side, at angles of a whole turn.

    J_l theta_l'' + M g L sin theta_l = (mu theta_m - theta_l)/kappa, by its Fourier series over a turn.
    """
    order = 1j * np.fft.rfftfreq(len(angle), 1.0 / len(angle))
    twist = np.zeros_like(angle)
    for _ in range(60):
        bent = np.fft.irfft(order**2 * np.fft.rfft(twist), len(angle))
        twist = -kappa * (J_L * speed**2 * bent + LOAD * np.sin(angle + twist))
    return -MU * twist / kappa


@pytest.mark.parametrize("speed", [0.5, 3.0])
def test_it_is_the_first_order_of_two_masses_and_a_spring(speed: float) -> None:
    """What is left of the exact torque falls with the square of the compliance; `speed` of the link."""
    without = dict.fromkeys(setting("C2", warm=False).friction, 0.0)
    given = replace(setting("C2", warm=False), friction=without)
    (effect,) = [e for e in library(given) if e.family == "joint_compliance"]
    model = effect.extend(given.base)
    module = executed(render(model), model.name)
    angle = np.linspace(0.0, 2.0 * pi, 64, endpoint=False)
    x = inputs(len(angle)) | {
        "theta_m": angle / MU,
        "omega_m": np.full(64, speed / MU),
        "alpha_m": np.zeros(64),
    }
    left, added = [], []
    for kappa in (2e-3, 1e-3):
        found = call(module, "mechanical_residual", x, compliance=0.0)
        found = found - call(module, "mechanical_residual", x, compliance=kappa)
        exact = periodic_torque(kappa, speed, angle) - MU * LOAD * np.sin(angle)
        left.append(float(np.std(exact - found)))
        added.append(float(np.std(exact)))

    assert 4.0 == pytest.approx(left[0] / left[1], rel=0.05)
    assert left[1] < 0.02 * added[1]


def log_of(kappa: float, seed: int) -> tuple[dict[str, Array], dict[str, object]]:
    """Half a minute of a motor that swings an elastic link, kappa = 0 a rigid one, and the rig.

    The motion of the motor is given: a speed loop that is tuned for a rigid link rings with an elastic one,
    so that the bench has no such joint.
    """
    rng = np.random.default_rng(seed)
    t = np.arange(8_000) / 250.0
    rates = 2.0 * pi * np.array([0.071, 0.19, 0.43])
    sizes, shifts = np.array([12.0, 8.0, 4.0]) * rng.uniform(0.8, 1.2, 3), rng.uniform(0.0, 2.0 * pi, 3)

    def motion(time: Array | float) -> tuple[Array, Array, Array]:
        phase = np.multiply.outer(time, rates) + shifts
        return (-np.cos(phase) @ (sizes / rates), np.sin(phase) @ sizes, np.cos(phase) @ (sizes * rates))

    theta, w, alpha = motion(t)
    if kappa:
        damping = 0.2 * np.sqrt(J_L / kappa)

        def of_the_link(time: float, x: Array) -> tuple[float, float]:
            angle, speed, _ = motion(time)
            spring = (MU * angle - x[0]) / kappa + damping * (MU * speed - x[1])
            return x[1], (spring - LOAD * np.sin(x[0])) / J_L

        start = (MU * theta[0] - kappa * LOAD * np.sin(MU * theta[0]), MU * w[0])
        link, speed = solve_ivp(of_the_link, (0.0, t[-1]), start, t_eval=t, rtol=1e-8, atol=1e-9).y
        load = MU * ((MU * theta - link) / kappa + damping * (MU * w - speed))
    else:
        load = MU**2 * J_L * alpha + MU * LOAD * np.sin(MU * theta)
    torque = J_M * alpha + load + 0.03 * np.sign(w) + 4e-4 * w
    current = torque / K_I
    columns = {
        "time_s": t,
        "theta_m_rad": np.round(theta * 32768 / (2.0 * pi)) * 2.0 * pi / 32768,
        "voltage_V": R * current + K_E * w,
        "current_A": current + 0.004 * np.max(np.abs(current)) * rng.standard_normal(len(t)),
    }
    known = {"case": "C2", "M_kg": M, "M_l_kg": M_L, "L_m": L, "mu": MU, "R_ohm": R, "k_i_Nm_per_A": K_I}
    known |= {"k_e_Vs_per_rad": K_E, "J_m_kgm2": J_M, "J_l_kgm2": J_L, "g_m_s2": G}
    return columns, {"known": known, "encoder_counts_per_rev": 32768}


@pytest.mark.slow
def test_an_elastic_joint_is_named_with_its_compliance() -> None:
    """A spring on which the link swings at 10 Hz; the damper and all orders are the simulation's."""
    kappa = 1.0 / (J_L * (2.0 * pi * 10.0) ** 2)
    rivals = ["kinematic_error", "encoder_eccentricity", "inertia_mismatch", "mass_mismatch", "local_defect"]
    found = eccentric.diagnose(*log_of(kappa, 3), only=["joint_compliance", *rivals])

    assert ["joint_compliance"] == [effect["family"] for effect in found.document["effects"]]
    assert found.document["effects"][0]["parameters"]["compliance"]["value"] == pytest.approx(kappa, rel=0.1)


@pytest.mark.slow
def test_a_rigid_joint_is_not_called_elastic() -> None:
    """The same motion and noise without the spring."""
    assert "nothing_missing" == eccentric.diagnose(*log_of(0.0, 3)).document["verdict"]


def test_it_is_offered_where_gravity_acts_and_the_inertia_is_declared() -> None:
    """Without gravity it needs jerk and snap, which a log does not show below the resonance."""

    def offered(case: str, **changes: object) -> bool:
        found = library(replace(setting(case, warm=False), **changes))
        return "joint_compliance" in {effect.family for effect in found}

    assert [True, False, False] == [offered("C2"), offered("C1"), offered("C2", left_open=("inertia",))]
