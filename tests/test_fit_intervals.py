"""How sure a fit says that it is: intervals that hold the truth, bounds, and quantities known by a range."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.stats import binom

import eccentric
from eccentric.identification import Estimate, fit
from eccentric.model import load_model
from eccentric.presentation import fit_lines
from eccentric.presentation.fit_text import _because
from eccentric.rigs import Rig
from eccentric.signals import Channels
from tests.planted import (
    FRICTION,
    K_I,
    KNOWN,
    M_L,
    MASS,
    TORQUE,
    coloured,
    torque,
    written,
)


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> tuple[Channels, Rig]:
    """Channels of the planted C2 rig without noise."""
    current = {"current_A": torque("C2", FRICTION) / K_I}
    return written(tmp_path_factory.mktemp("plain"), 'case = "C2"\n' + KNOWN + TORQUE + MASS, current)


def with_current(channels: Channels, current: np.ndarray) -> Channels:
    """The same channels with another current [A] (n,)."""
    return dataclasses.replace(channels, motor=dataclasses.replace(channels.motor, current=current))


@pytest.mark.slow
def test_intervals_cover_the_truth_under_coloured_noise(plain: tuple[Channels, Rig]) -> None:
    """Of 100 intervals under noise of 0.1 s memory, at least as many hold the truth as 95 % ones would."""
    channels, rig = plain
    assert channels.motor.current is not None
    rng, model, draws = np.random.default_rng(5), load_model("c2_parallel"), 100
    exact = fit(channels, rig, model).coefficients
    hits = dict.fromkeys(FRICTION, 0)
    for _ in range(draws):
        noisy = with_current(channels, channels.motor.current + coloured(rng, 0.1, 0.96))
        for name, e in fit(noisy, rig, model).coefficients.items():
            # The truth that the filtered angle allows, so that only the noise is judged.
            hits[name] += e.interval[0] <= exact[name].value <= e.interval[1]
    # 86 of 100: all four coefficients of true 95 % intervals stay above it 999 times in 1000.
    least = int(binom.ppf(0.001 / len(hits), draws, 0.95))
    assert {name: count for name, count in hits.items() if count < least} == {}


@pytest.mark.slow
def test_interval_at_a_bound_is_one_sided_and_holds_the_truth(plain: tuple[Channels, Rig]) -> None:
    """With no motor friction planted, half of the draws end at a bound; their intervals begin there."""
    channels, rig = plain
    assert channels.motor.current is not None
    exact = channels.motor.current - FRICTION["C_m"] * np.sign(channels.motion.omega_m) / K_I
    rng, model, draws = np.random.default_rng(6), load_model("c2_parallel"), 60
    held, hits = 0, 0
    for _ in range(draws):
        noisy = with_current(channels, exact + coloured(rng, 0.1, 0.96))
        e = fit(noisy, rig, model).coefficients["C_m"]
        hits += e.interval[0] <= 0.0
        held += e.bound_active == "lower"
        if e.bound_active:
            assert (e.value, e.interval[0]) == (0.0, 0.0)
            assert 0.0 < e.interval[1] < 3.0 * e.std_error
    assert binom.ppf(0.001, draws, 0.5) <= held <= binom.ppf(0.999, draws, 0.5)
    assert hits >= binom.ppf(0.001, draws, 0.95)


def test_an_undeclared_effect_shows_beside_the_bounds(plain: tuple[Channels, Rig]) -> None:
    """Friction that falls with speed meets the bounds: the free fit does better, and it is said."""
    channels, rig = plain
    assert channels.motor.current is not None
    speed = channels.motion.omega_m
    more = 0.08 * np.exp(-((speed / 15.0) ** 2)) * np.sign(speed) / K_I
    found = fit(with_current(channels, channels.motor.current + more), rig, load_model("c2_parallel"))
    assert found.bounds_active != []
    assert found.rmse["paper_unbounded"] < found.rmse["paper"]
    assert "which suggests a missing effect" in "\n".join(fit_lines(found, ["log"]))


def test_unknown_mass_is_found_within_its_range(plain: tuple[Channels, Rig]) -> None:
    """A link mass known by a range comes out within its interval, with the friction that belongs to it."""
    channels, rig = plain
    assert channels.motor.current is not None
    known = {k: v for k, v in rig.known.items() if k != "M_l"}
    rig = dataclasses.replace(rig, known=known, unknown={"M_l": (0.0, 1.0)})
    noise = coloured(np.random.default_rng(8), 0.02, 0.9)
    found = fit(with_current(channels, channels.motor.current + noise), rig, load_model("c2_parallel"))
    low, high = found.searched["M_l"].interval
    assert low <= M_L <= high
    assert high - low < 0.5
    outside = [
        n
        for n, v in FRICTION.items()
        if abs(found.coefficients[n].value - v) > 4.0 * found.coefficients[n].std_error
    ]
    assert outside == []
    # The training error has its least near the mass and grows to both ends of the range.
    profile = found.profiles["M_l"]
    assert profile.values[int(np.argmin(profile.rmse))] == pytest.approx(M_L, abs=0.125)


def _pendulum_log(friction_by_force: bool) -> tuple[dict[str, np.ndarray], dict[str, object]]:
    """A pendulum turned in both directions, with Table 1's friction by F_N or without it."""
    mass, bare, arm, inertia, k_i, gravity = 0.5, 0.2, 0.25, 0.04, 0.5, 9.81
    t = np.arange(0.0, 60.0, 0.004)
    theta = 9.0 * np.sin(0.9 * t) + 4.0 * np.sin(2.3 * t) + 0.02 * t
    omega = 8.1 * np.cos(0.9 * t) + 9.2 * np.cos(2.3 * t) + 0.02
    alpha = -7.29 * np.sin(0.9 * t) - 21.16 * np.sin(2.3 * t)
    swing, weight = mass * arm * omega**2, (mass + bare) * gravity
    force = np.sqrt(swing**2 + 2.0 * swing * weight * np.cos(theta) + weight**2)
    torque = inertia * alpha + mass * gravity * arm * np.sin(theta) + 0.002 * omega + 0.05 * np.sign(omega)
    if friction_by_force:
        torque += 0.004 * force * omega + 0.08 * force * np.sign(omega)
    noise = np.random.default_rng(5).normal(0.0, 0.4, len(t))
    known = {"case": "C2", "mu": 1, "k_i": f"{k_i} N m/A", "J_m": "0 kg m^2", "J_l": f"{inertia} kg m^2"}
    known |= {"M": f"{mass} kg", "M_l": f"{bare} kg", "L": f"{arm} m"}
    return {"time_s": t, "theta_m_rad": theta, "current_A": (torque + noise) / k_i}, {"known": known}


def test_z_of_what_is_not_detected_is_that_of_the_estimate_once_it_is_there() -> None:
    """Table 1's coefficients over their standard errors, on the same log with and without friction by F_N."""
    without = eccentric.fit(*_pendulum_log(friction_by_force=False))
    beside = eccentric.fit(*_pendulum_log(friction_by_force=True))
    said = without.document["undetected"]

    assert set(said) == {"B_lN", "C_lN"}
    for name, value in (("B_lN", 0.004), ("C_lN", 0.08)):
        found = beside.estimates[name]
        assert said[name]["reference"] == value
        assert said[name]["upper_95"] < value
        assert said[name]["z"] == pytest.approx(found.value / found.std_error, rel=0.3)
        assert any(line.startswith(f"{name} is not detected: at most") for line in without.lines)
    assert "undetected" not in beside.document


@pytest.mark.parametrize(
    ("side", "widened", "expected"),
    [("lower", True, ", since C_lN at a bound may take its place"), (None, True, ""), ("lower", False, "")],
)
def test_a_value_that_another_bound_hides_says_which(side: str | None, widened: bool, expected: str) -> None:
    """Ten standard errors from 0, and not detected: its interval has the freedom of the other at a bound."""
    own = Estimate(0.0072, 0.00075, (0.0, 0.0089), "m s/rad", None, widened)
    other = Estimate(0.0, 0.01, (0.0, 0.02), "m", side, True)
    assert expected == _because("B_lN", {"B_lN": own, "C_lN": other})
