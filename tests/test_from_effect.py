"""An effect as a candidate of the search: what it multiplies in others, as the extended model does."""

from __future__ import annotations

import numpy as np

from eccentric.fitting import Signals
from eccentric.model import load_model
from eccentric.search import candidate_of
from tests.extended import KNOWN, effects

DT, SLOPE = 0.004, 0.04
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
