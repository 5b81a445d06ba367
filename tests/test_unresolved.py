"""A torque that repeats faster than half the sampling rate: the log cannot show it, nor contradict it."""

from __future__ import annotations

from math import copysign, cos, pi

import numpy as np
import pytest
import sympy as sp

import eccentric
from eccentric.api.diagnosed import DiagnosisResult
from eccentric.effects import library
from eccentric.identification.drive import unresolved
from eccentric.model import load_model
from eccentric.model import vocabulary as v
from tests.extended import J_L, J_M, K_E, K_I, M_L, MU, G, L, M, R, setting

ORDER, RIPPLE, STEP = 12, 0.03, 1.0 / 250.0


@pytest.fixture(scope="module")
def found() -> DiagnosisResult:
    """A motor in C1 whose flux ripples 12 times per turn, up to 500 Hz, at 250 rows a second.

    Its current loop is ideal: the current has no ripple, the motion has it, and so has the voltage.
    """
    dt, rows = STEP / 20.0, 12_500
    inertia, theta, w, total, samples = J_M + MU**2 * J_L, 0.0, 0.0, 0.0, []
    time = np.arange(20 * rows) * dt
    wanted = 170.0 * np.sin(0.31 * time) + 80.0 * np.sin(0.97 * time)
    for k, reference in enumerate(wanted.tolist()):
        total += 0.4 * dt * (reference - w)
        current = 0.1 * (reference - w) + total
        flux = 1.0 + RIPPLE * cos(ORDER * theta)
        if k % 20 == 0:
            samples.append((time[k], theta, R * current + K_E * flux * w, current))
        torque = K_I * flux * current - 0.05 * copysign(min(abs(w), 1.0), w) - 5e-4 * w
        w += dt * torque / inertia
        theta += dt * w
    t, angle, voltage, amperes = np.array(samples).T
    rng = np.random.default_rng(1)
    columns = {
        "time_s": t,
        "theta_m_rad": np.round(angle * 32768 / (2.0 * pi)) * 2.0 * pi / 32768,
        "voltage_V": voltage + 0.02 * rng.standard_normal(rows),
        "current_A": amperes + 0.02 * rng.standard_normal(rows),
    }
    known = {"case": "C1", "M_kg": M, "M_l_kg": M_L, "L_m": L, "mu": MU, "R_ohm": R, "k_i_Nm_per_A": K_I}
    known |= {"k_e_Vs_per_rad": K_E, "J_m_kgm2": J_M, "J_l_kgm2": J_L, "g_m_s2": G}
    return eccentric.diagnose(columns, {"known": known, "encoder_counts_per_rev": 32768})


@pytest.mark.slow
def test_a_fast_ripple_that_the_circuit_shows_is_named(found: DiagnosisResult) -> None:
    """The motion cannot show it at most of the speeds, and does not contradict it there."""
    (effect,) = found.document["effects"]

    assert ("named", f"kt_ripple[n={ORDER}]") == (found.verdict, effect["id"])
    assert RIPPLE == pytest.approx(effect["parameters"][f"kt_ripple_c{ORDER}"]["value"], rel=0.05)
    assert any("faster than half the sampling rate" in line for line in found.lines)


def test_half_of_the_rate_is_the_limit() -> None:
    """At 250 rows a second what repeats twice per turn is resolved up to 125 Hz, in either direction."""
    base = setting("C1", warm=False)
    (effect,) = [e for e in library(base) if e.id == "cogging[n=2]"]
    terms = effect.extend(load_model("c1_perpendicular")).balance("mechanical").terms
    limit = 2.0 * pi * 125.0 / 2.0
    speeds = np.array([0.0, 0.99 * limit, 1.01 * limit, -0.99 * limit, -1.01 * limit])

    ((names, fast),) = unresolved(terms, {}, speeds, STEP)
    assert ("cogging_c2", "cogging_s2") == names
    assert [False, False, True, False, True] == fast.tolist()
    assert [] == unresolved(base.base.balance("mechanical").terms, {}, speeds, STEP)


def test_every_ripple_over_the_motor_declares_how_often_it_repeats() -> None:
    """Those over the link turn mu times as fast; the order of one is a shape."""
    visited = set()
    for effect in library(setting("C2", warm=False)):
        for term in effect.change.terms.get("mechanical", ()):
            often = sp.sympify(term.per_turn).subs(v.mu.symbol, MU)
            if often == 0:
                continue
            visited.add(effect.family)
            turn = MU if effect.evidence.depends_on[0] == "link_angle" else 1.0
            if effect.shapes and often.free_symbols:
                (shape,) = [one for one in effect.shapes if one.quantity.symbol in often.free_symbols]
                # A tight spot takes four widths of the link; an order of the motor is its own rate.
                bump = pi * MU / (2.0 * shape.low)
                rate = bump if effect.family == "local_defect" else shape.low
                assert rate == pytest.approx(float(often.subs(shape.quantity.symbol, shape.low)))
            else:
                _, numbered, n = effect.variant.rpartition("n=")
                assert turn * (int(n) if numbered else 1) == pytest.approx(float(often))

    assert visited == {
        "cogging",
        "encoder_eccentricity",
        "kinematic_error",
        "kt_ripple",
        "link_harmonic_friction",
        "local_defect",
        "motor_harmonic_friction",
        "nonsynchronous_friction",
    }
