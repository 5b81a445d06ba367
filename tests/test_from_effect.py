"""An effect as a candidate of the search: what it multiplies in others, as the extended model does."""

from __future__ import annotations

import numpy as np
import pytest

from eccentric.diagnosis.search import candidate_of
from eccentric.identification import Signals
from eccentric.model import load_model
from tests.extended import KNOWN, effects

DT, SLOPE = 0.004, 0.04
MISMATCHES = {"R": "resistance_mismatch", "k_i": "ki_mismatch", "k_e": "ke_mismatch", "J": "inertia_mismatch"}
T = DT * np.arange(500)
MODEL = load_model("c2_parallel")


def test_a_temperature_scales_the_viscous_friction_of_another_effect() -> None:
    """By exp(-b (T - T_0)): the logarithm of the factor falls with slope b over the temperature."""
    warm = 20.0 + 30.0 * T / T[-1]
    values = {
        "theta_m": 40.0 * np.sin(1.3 * T),
        "omega_m": 52.0 * np.cos(1.3 * T),
        "alpha_m": 0.0 * T,
        "t": T,
    }
    signals = Signals({**values, "temperature": warm}, np.full_like(T, DT), (0,), KNOWN, base=MODEL)
    friction = np.ones(len(signals.columns(MODEL)))
    library = effects("C2")
    temperature, asymmetry, cogging = (
        candidate_of(library[name], MODEL, signals, friction, None)
        for name in ("viscosity_temperature", "viscous_asymmetry", "cogging[n=4]")
    )
    (shape,) = temperature.shapes
    assert temperature.scales is not None
    scaling = temperature.scales({shape.quantity.name: SLOPE})

    factor = scaling.on(asymmetry.roles)[:, 0]
    assert np.allclose(np.diff(np.log(factor)), -SLOPE * np.diff(warm), rtol=1e-9, atol=0.0)
    assert np.array_equal(scaling.on(cogging.roles), np.ones((len(T), len(cogging.roles))))


@pytest.mark.parametrize("family", ["presliding", "wear_runin[travel]"])
def test_the_history_of_an_instrument_is_that_of_the_angle(family: str) -> None:
    """A (z - sgn w) and C exp(-s/x) sgn w have z and s of the whole motion, and sgn w of the slow one.

    The slow speed alone reverses at other angles: its bristles would bend elsewhere.
    """
    swing = 2.0 * np.sin(1.3 * T) + 0.3 * np.sin(20.0 * T)
    speed, still = 2.6 * np.cos(1.3 * T) + 6.0 * np.cos(20.0 * T), np.full_like(T, DT)
    values = {"theta_m": swing, "omega_m": speed, "alpha_m": 0.0 * T, "t": T}
    signals = Signals(values, still, (0,), KNOWN, base=MODEL)
    slow = Signals(values | {"omega_m": 2.6 * np.cos(1.3 * T)}, still, (0,), KNOWN, base=MODEL)
    effect, friction = effects("C2")[family], np.ones(len(signals.columns(MODEL)))
    made = candidate_of(effect, MODEL, signals, friction, None, instruments=slow)
    (shape,) = effect.shapes
    assert made.instrument is not None

    at = {shape.quantity.name: 1.7}
    here, there = made.columns(at)[:, 0], made.instrument(at)[:, 0]
    sign, slow_sign = (np.sign(s.values["omega_m"]) for s in (signals, slow))
    if family == "presliding":
        assert np.allclose(here + sign, there + slow_sign, rtol=0.0, atol=1e-12)
    else:
        assert np.allclose(here * sign, there * slow_sign, rtol=0.0, atol=1e-12)


UNDECLARED = {letter: value for letter, value in KNOWN.items() if letter != "R"}


@pytest.mark.parametrize(
    ("letter", "known", "expected"),
    [
        ("R", KNOWN, 0.02 * KNOWN["R"]),
        ("k_e", KNOWN, 0.02 * KNOWN["k_e"]),
        ("k_i", KNOWN, 0.02),
        ("J", KNOWN, 0.05),
        ("k_e", KNOWN | {"k_e": 0.0}, 0.0),
        ("R", UNDECLARED, 0.0),
    ],
    ids=["R", "k_e", "k_i", "J", "two per cent of nothing", "not declared"],
)
def test_a_declared_value_is_off_by_its_tolerance(
    letter: str, known: dict[str, float], expected: float
) -> None:
    """R, k_i and k_e by 2 %, the inertia by 5 %: in ohm and V s/rad, or as a part of the value."""
    zero = dict.fromkeys(("theta_m", "omega_m", "alpha_m", "i", "u"), 0.0 * T)
    signals = Signals({**zero, "t": T}, np.full_like(T, DT), (0,), known, base=MODEL)
    friction = np.ones(len(signals.columns(MODEL)))
    effect = effects("C2")[MISMATCHES[letter]]

    actual = candidate_of(effect, MODEL, signals, friction, None).tolerance
    assert expected == pytest.approx(actual, rel=1e-12)
