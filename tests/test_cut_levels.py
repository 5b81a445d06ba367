"""Levels of dry friction never cross zero: where fitted terms would make one negative, it is cut and said."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import eccentric
from eccentric.effects import Setting, library
from eccentric.emission import cut_levels
from eccentric.emission.hot import load_module
from eccentric.model import Model, load_model, with_values
from tests import extended, paper

MU = 0.2
HARMONIC = "link_harmonic_friction[n=1]"
NONE = (0.0, 0.0)


def rippled(base: str, cosine: float, **values: float) -> Model:
    """Return a model of friction that varies with the cosine of the link angle; else it has these values."""
    effect = extended.effects("C1" if base.startswith("c1") else "C2")[HARMONIC]
    own = {"link_harmonic_c1": cosine, "link_harmonic_s1": 0.0}
    model = effect.extend(load_model(base), own)
    friction = {q.name: 0.0 for q in model.friction_parameters if q.name not in own}
    return with_values(model, {**friction, "mu": MU, **values}, base)


@pytest.mark.parametrize("c1", [0.05, -0.05])
def test_it_is_cut_where_the_harmonic_exceeds_the_rest(c1: float) -> None:
    """c0 + c1 cos theta is negative beyond acos(-c0/c1): around half a turn, or around 0."""
    c0 = 0.03
    model = rippled("c1_perpendicular", c1, C_m=c0, B_m=1e-3)
    (cut,) = cut_levels(model, (1.0, 40.0), NONE)
    end = math.acos(-c0 / c1)
    expected = (end, 2 * math.pi - end) if c1 > 0 else (2 * math.pi - end, 2 * math.pi + end)

    assert (cut.directions, cut.speed) == ((1, -1), 0.0)
    assert cut.lowest == pytest.approx(c0 - abs(c1))
    assert cut.intervals == (pytest.approx(expected, abs=1e-12),)
    inside, outside = (
        np.linspace(*expected, 99)[1:-1],
        np.linspace(expected[1], 2 * math.pi + expected[0], 99),
    )
    levels = [load_module(model).friction_budget(x / MU, 1.0)[:, :2] for x in (inside, outside[1:-1])]
    assert not levels[0].any()
    assert np.abs(levels[1]).min() > 0.0


@pytest.mark.parametrize("fastest", [2.0, 2.1, 3.3])
def test_the_speed_is_that_of_the_lowest_level(fastest: float) -> None:
    """At the critical velocity, where the load vanishes at the top."""
    p = paper.table_1(float, C_m=0.03)
    critical = paper.critical_velocity(p, math) / MU
    model = rippled("c2_parallel", 0.05, C_m=p.C_m, C_lN=p.C_lN)
    (cut,) = cut_levels(model, (0.0, fastest * critical), NONE)

    def level(angle: float) -> float:
        F_N = paper.normal_force_c2(angle / MU, critical, p, math)
        return MU * p.C_lN * F_N + p.C_m + 0.05 * math.cos(angle)

    assert cut.speed == pytest.approx(critical, rel=1e-7)
    assert cut.lowest == pytest.approx(-0.02, abs=1e-7)
    end = brentq(level, 2.0, 3.1)
    assert cut.intervals == (pytest.approx((end, 2.0 * math.pi - end), abs=1e-7),)


def test_each_direction_has_its_own() -> None:
    """Where friction differs by direction, so do the angles; one that is never negative is not reported."""
    levels = {1: 0.03, -1: 0.04}
    friction = {"C_m_pos": levels[1], "C_m_neg": levels[-1]}
    for c1, directions in ((0.05, [1, -1]), (0.035, [1])):
        found = cut_levels(rippled("c1_asymmetric", c1, **friction), (1.0, 40.0), NONE)
        assert [cut.directions for cut in found] == [(sign,) for sign in directions]
        for cut, sign in zip(found, directions, strict=True):
            assert cut.intervals[0][0] == pytest.approx(math.acos(-levels[sign] / c1))


@pytest.mark.parametrize(("c1", "C_m"), [(0.05, 0.0501), (0.05, 0.05), (0.0, 0.0)])
def test_what_is_not_negative_is_not_cut(c1: float, C_m: float) -> None:
    """Nor is a drive without dry friction."""
    assert cut_levels(rippled("c1_perpendicular", c1, C_m=C_m, B_m=1e-3), (1.0, 40.0), NONE) == ()


def test_a_carriage_has_positions() -> None:
    """Within its travel: a ripple of two turns of the screw per metre."""
    setting = Setting(load_model("screw_axis"), 4.0 * math.pi, {}, 0.1, 1.0, 15.0, 60.0, 20.0)
    effect = next(e for e in library(setting) if e.id == HARMONIC)
    values = {"link_harmonic_c1": 0.5, "link_harmonic_s1": 0.0}
    model = with_values(
        effect.extend(setting.base, values), {"kappa": 4.0 * math.pi, "B": 0.0, "C": 0.3}, "x"
    )
    (cut,) = cut_levels(model, (0.1, 1.0), (0.0, 1.0))
    end = math.acos(-0.6) / (4.0 * math.pi)

    assert np.ravel(cut.intervals) == pytest.approx([end, 0.5 - end, 0.5 + end, 1.0 - end])


def test_fit_and_diagnosis_say_so() -> None:
    """Once among the warnings, and with the angles in the document."""
    t = np.arange(0.0, 20.0, 0.01)
    sines = [(9.0, 1.3, 0.2), (4.0, 2.9, 1.0), (1.0, 7.0, 2.0)]
    angle = sum(a * np.sin(w * t + x) for a, w, x in sines)
    speed = sum(a * w * np.cos(w * t + x) for a, w, x in sines)
    torque = sum(-2e-3 * a * w * w * np.sin(w * t + x) for a, w, x in sines) + 1e-3 * speed
    torque += (0.03 + 0.05 * np.cos(0.5 * angle)) * np.sign(speed)
    torque += 1e-3 * np.random.default_rng(1).standard_normal(len(t))
    log = {"t": t, "angle": angle, "speed": speed, "torque": torque}
    known = {"case": "C1", "mu": 0.5, "M_kg": 0.0, "M_l_kg": 0.2, "L_m": 0.0}
    known |= {"J_m_kgm2": 2e-3, "J_l_kgm2": 0.0}
    columns = {"time": "t", "theta_m": "angle", "omega_m": "speed", "torque": "torque"}
    rig = {"drive": "torque", "columns": columns, "known": known}
    model = extended.effects("C1")[HARMONIC].extend(load_model("c1_perpendicular"), {})
    found = [eccentric.fit(log, rig, model), eccentric.diagnose(log, rig, only=HARMONIC)]
    for result in found:
        (cut,), (text,) = result.document["levels_cut"], [x for x in result.warnings if "negative" in x]

        assert cut["direction"] == "both"
        assert cut["lowest_Nm"] == pytest.approx(-0.02, abs=2e-4)
        assert cut["intervals"][0] == pytest.approx(
            [math.acos(-0.6), 2.0 * math.pi - math.acos(-0.6)], abs=5e-3
        )
        low, high = cut["intervals"][0]
        assert f"at link angles {low:.4g} to {high:.4g} rad, down to -0.0199 N m at rest" in text
    assert "levels_cut" not in eccentric.fit(log, rig).document
