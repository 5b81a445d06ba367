"""The benchmark of intervals compares like with like: what is planted is what is fitted."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.coverage import Result, counted, effect_of, run
from eccentric.fitting.emitted import Emitted
from eccentric.model import load_model
from tests.extended import KNOWN, effects

FRICTION = {"C_m": 0.1, "B_m": 0.01, "C_lN": 0.02, "B_lN": 0.003}


@pytest.mark.parametrize(
    ("truth", "at", "expected"),
    [
        # A exp(-(w/v)^d), A w/(1 + (w/w_c)^2), A cos(n theta + phi)
        ({"family": "stribeck", "amplitude": 0.3, "shape": [4.0, 2.0]}, (0.0, 6.0), 0.3 * np.exp(-2.25)),
        ({"family": "eddy_current", "amplitude": 0.3, "shape": [4.0]}, (0.0, 6.0), 1.8 / 3.25),
        ({"family": "cogging", "amplitude": 0.3, "shape": [6.0, 0.4]}, (0.5, 6.0), 0.3 * np.cos(3.4)),
    ],
)
def test_the_planted_effect_is_that_of_the_library(
    truth: dict[str, object], at: tuple[float, float], expected: float
) -> None:
    """At one angle and speed, by the law of the bench."""
    name, values = effect_of(truth)
    effect = effects("C2")[name]
    emitted = Emitted(effect.extend(load_model("c2_parallel"), values))
    inputs = {
        name: np.array([x])
        for name, x in zip(("theta_m", "omega_m", "alpha_m", "i"), (*at, 0.0, 0.0), strict=True)
    }
    none = values | {c.name: 0.0 for c in effect.coefficients}
    without, there = (
        emitted("mechanical_residual", inputs, emitted.parameters({**KNOWN, **FRICTION, **own}))
        for own in (none, values)
    )

    assert float((without - there)[0]) == pytest.approx(expected, rel=1e-9)


def test_a_log_is_judged_by_all_three_kinds() -> None:
    """Inertia, four friction coefficients and the effect's own parameters."""
    result = run(97101)

    assert result.failed == ""
    assert {"inertia": 1, "friction": 4, "effect": 2} == {kind: len(own) for kind, own in result.held.items()}
    assert counted([result, Result("other", {"inertia": {"J_l": False}})], "inertia")[1] == 2
