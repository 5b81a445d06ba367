"""An effect on the flux that the circuit cannot tell from another: its torque tells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from eccentric.search.both import search_all
from eccentric.search.smooth import Variables
from eccentric.search.verdict import decided
from tests.searched import N, candidate, design, mixed


@pytest.mark.parametrize(
    ("torque", "expected"),
    [({5: 6.0}, ("named", ["flux"])), ({}, ("not_identifiable", ["flux"]))],
    ids=["with its torque", "without"],
)
def test_the_torque_settles_what_the_circuit_leaves_open(
    torque: dict[int, float], expected: tuple[str, list[str]]
) -> None:
    """In the voltage both leave the same but for a millionth; only one has a torque, and takes it out."""
    flux = replace(
        candidate("flux", {2: 1.0}, balance="electrical"), also=lambda _: mixed({5: 2.0})[:, None], joint=True
    )
    other = candidate("other", {2: 1.0, 3: 1e-3}, balance="electrical")
    t, none = mixed({0: 1.0}), np.empty((N, 0))
    # The circuit has nothing to be fitted: R, k_i and k_e are declared.
    circuit = replace(design({2: 3.0}), name="electrical", coefficients=(), columns=none, samples=none)

    found = search_all(
        [design(torque), circuit],
        [flux, other, candidate("load", {7: 1.0})],
        Variables(t=t, theta_m=None, omega_m=t, alpha_m=0.0 * t, gravity=0.0 * t, mu=1.0, averaged=True),
        {},
        lambda _: None,
    )
    verdict = decided(found)

    assert expected == (verdict.verdict, [one.variant.candidate.id for one in verdict.adopted])
