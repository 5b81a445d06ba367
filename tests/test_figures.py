"""The paper's figures 2, 4 and 5 show what its text, its captions and its Table 1 print."""

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest

from eccentric.paper import (
    Section,
    figure_2,
    figure_4,
    figure_5,
    friction_surface,
    sections,
    steady_curves,
)
from tests import oracle, paper

# Figure 4's caption holds with k_e in V s/rev, as Table 1 lists it (see `eccentric audit`, finding 3).
with mpmath.workdps(40):
    TABLE = paper.table_1(oracle.number, k_e=mpmath.mpf("0.20") / (2 * mpmath.pi))
PRINTED_VELOCITY = 7.41
"""Captions of figures 4 and 5 [rad/s]."""


@pytest.fixture(autouse=True)
def _many_digits() -> Iterator[None]:
    with mpmath.workdps(40):
        yield


@pytest.mark.parametrize("mu", paper.TABLE_1_POLYNOMIAL)
def test_figure_2_is_the_polynomial_of_table_1(mu: str) -> None:
    """The voltage is R/k_i times (11) with the printed digits, and without F_3 and F_2 the dashed line."""
    (curve,) = (one for one in steady_curves() if one.mu == pytest.approx(float(Fraction(mu))))
    F_3, F_2, F_1, F_0 = (float(text) for text in paper.TABLE_1_POLYNOMIAL[mu])
    w, sign = np.abs(curve.omega_m), np.sign(curve.omega_m)
    per_torque = 1.00 / 0.02

    assert curve.voltage == pytest.approx(
        sign * per_torque * (F_3 * w**3 + F_2 * w**2 + F_1 * w + F_0), rel=2e-5
    )
    assert curve.linear == pytest.approx(sign * per_torque * (F_1 * w + F_0), rel=2e-5)


def test_figure_2_shows_both_directions_and_both_gear_ratios() -> None:
    """Curves for 1/5 and 1/30, each from -250 to 250 rad/s."""
    shown = [(curve.mu, curve.omega_m.min(), curve.omega_m.max()) for curve in steady_curves()]

    assert [(1 / 5, -250.0, 250.0), (1 / 30, -250.0, 250.0)] == shown


def test_figure_4_has_its_minimum_where_the_caption_says() -> None:
    """At 7.41 rad/s and pi only the motor's friction is left, and no point of the surface lies below."""
    shown = friction_surface()
    angle, velocity, least = shown.minimum
    motor = (TABLE.B_m + TABLE.k_i * TABLE.k_e / TABLE.R) * velocity / TABLE.mu + TABLE.C_m

    assert (np.pi, PRINTED_VELOCITY) == (angle, round(velocity, 2))
    assert least == pytest.approx(float(motor), rel=1e-12)
    assert least <= shown.torque.min()
    near = np.unravel_index(np.argmin(shown.torque), shown.torque.shape)
    assert shown.theta_l[near] == pytest.approx(np.pi, abs=1e-9)
    assert shown.omega_l[near] == pytest.approx(PRINTED_VELOCITY, abs=8 * np.pi / 160)


def test_figure_4_is_the_torque_of_equation_18() -> None:
    """Every twentieth point of the surface is the closed form in 15 digits, over the range of the figure."""
    shown = friction_surface()
    points = list(
        zip(*(a[::20, ::20].ravel() for a in (shown.theta_l, shown.omega_l, shown.torque)), strict=True)
    )
    closed = [
        float(paper.friction_torque_c2(mpmath.mpf(angle) / TABLE.mu, mpmath.mpf(w) / TABLE.mu, TABLE))
        for angle, w, _ in points
    ]

    assert [torque for *_, torque in points] == pytest.approx(closed, rel=1e-12)
    assert (0.0, 2 * np.pi) == (shown.theta_l.min(), shown.theta_l.max())
    assert 0.0 < shown.omega_l.min() < 1e-5
    assert shown.omega_l.max() == pytest.approx(8 * np.pi)


@pytest.mark.parametrize(("place", "angle"), [(0, "0"), (1, "pi/2"), (2, "pi")], ids=str)
def test_figure_5_shows_equations_17_and_18_at_three_angles(place: int, angle: str) -> None:
    """Normal force and friction torque are the closed forms in 15 digits."""
    section = sections()[place]
    theta = {"0": mpmath.mpf(0), "pi/2": mpmath.pi / 2, "pi": mpmath.pi}[angle]

    assert float(theta) == section.theta_l
    for n in range(0, len(section.omega_l), 50):
        motor = theta / TABLE.mu, mpmath.mpf(section.omega_l[n]) / TABLE.mu
        # The angle in figure_5 is a double: where F_N is nearly zero that is what is left of it.
        assert section.normal_force[n] == pytest.approx(
            float(paper.normal_force_c2(*motor, TABLE)), rel=1e-12, abs=1e-12
        )
        assert section.torque[n] == pytest.approx(float(paper.friction_torque_c2(*motor, TABLE)), rel=1e-12)


def test_figure_5_touches_zero_with_a_kink_at_the_top_only() -> None:
    """F_N at pi falls to zero at 7.41 rad/s and rises again at once; at 0 and pi/2 it only rises."""
    bottom, level, top = sections()
    rising = [bool(np.all(np.diff(section.normal_force) > 0)) for section in (bottom, level, top)]
    lowest = int(np.argmin(top.normal_force))
    slopes = np.diff(top.normal_force) / np.diff(top.omega_l)
    # d F_N/d w at the top is -2 M L w below the critical velocity and 2 M L w above it.
    kink = 2 * 0.50 * 0.25 * PRINTED_VELOCITY

    assert [True, True, False] == rising
    assert top.omega_l[lowest] == pytest.approx(PRINTED_VELOCITY, abs=8 * np.pi / 999)
    assert top.normal_force[lowest] < kink * 8 * np.pi / 999
    assert (slopes[lowest - 2], slopes[lowest + 1]) == pytest.approx((-kink, kink), rel=0.02)


def _lines(axes: Any) -> list[np.ndarray]:
    return [np.array(line.get_data()) for line in axes.get_lines()]


def test_the_drawings_show_these_values() -> None:
    """The curves drawn are those above, under labels that name their gear ratio or link angle."""
    pytest.importorskip("matplotlib")
    (voltage,) = figure_2().axes
    torque, force = figure_5().axes
    curves = [
        np.array([x, curve.omega_m]) for curve in steady_curves() for x in (curve.voltage, curve.linear)
    ]

    def drawn(section: Section, values: np.ndarray) -> np.ndarray:
        return np.array([section.omega_l, values])

    np.testing.assert_array_equal(curves, _lines(voltage))
    np.testing.assert_array_equal([drawn(s, s.torque) for s in sections()], _lines(torque))
    np.testing.assert_array_equal([drawn(s, s.normal_force) for s in sections()], _lines(force))
    assert ["μ = 1/5", "μ = 1/5", "μ = 1/30", "μ = 1/30"] == [
        str(line.get_label()).split(",")[0] for line in voltage.get_lines()
    ]
    assert ["θ_l = 0", "θ_l = π/2", "θ_l = π"] == [line.get_label() for line in torque.get_lines()]
    assert "minimum: 0.0464 N m at\n(7.41 rad/s, π)" in [text.get_text() for text in figure_4().axes[1].texts]
