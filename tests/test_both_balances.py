"""An effect on the flux that the circuit cannot tell from another: its torque tells."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from eccentric.effects import Shape
from eccentric.model import quantity
from eccentric.search.both import search_all
from eccentric.search.smooth import Variables
from eccentric.search.verdict import decided
from tests.searched import Array, N, candidate, design, mixed


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


def test_what_both_show_is_estimated_beside_what_else_the_torque_shows() -> None:
    """The circuit hardly tells the shape, its torque does, once a large ripple is no longer taken for noise.

    Of the shape that the circuit prefers, the torque leaves a part that another effect would take.
    """
    form, true = Shape(quantity("x", "1", "a shape"), 0.0, 4.0, points=5), 3.0

    def shown(values: Mapping[str, float]) -> Array:
        return mixed({2: 1.0, 3: 0.1 * values["x"]})[:, None]

    flux = replace(
        candidate("flux", shapes=(form,), of=shown, balance="electrical"),
        also=lambda values: mixed({5: 2.0, 6: values["x"]})[:, None],
        joint=True,
    )
    t, none = mixed({0: 1.0}), np.empty((N, 0))
    circuit = design({2: 3.0, 3: 0.3 * (true - 1.0)})
    circuit = replace(circuit, name="electrical", coefficients=(), columns=none, samples=none)

    found = search_all(
        [design({5: 6.0, 6: 3.0 * true, 7: 60.0}), circuit],
        [flux, candidate("ripple", {7: 1.0}), candidate("other", {6: 1.0})],
        Variables(t=t, theta_m=None, omega_m=t, alpha_m=0.0 * t, gravity=0.0 * t, mu=1.0, averaged=True),
        {},
        lambda _: None,
    )
    (own,) = found["electrical"].best.variants

    assert ["ripple"] == [v.candidate.id for v in found["mechanical"].best.variants]
    assert true == pytest.approx(own.values["x"], abs=0.05)


@pytest.mark.parametrize(
    ("voltage", "expected"),
    [
        (0.107, ("named", {"flux"})),
        (-0.107, ("named", {"friction"})),
        (0.0, ("named", {"friction"})),
    ],
    ids=["with its voltage", "with the opposite", "without"],
)
def test_the_circuit_adds_what_is_too_faint_to_be_adopted_there(
    voltage: float, expected: tuple[str, set[str]]
) -> None:
    """Friction has nearly the same torque, 2 apart in deviance, and no voltage; that of the flux gains 23."""
    flux = replace(
        candidate("flux", {2: 1.0}, balance="electrical"),
        also=lambda _: mixed({5: 6.0 / 0.107})[:, None],
        joint=True,
    )
    friction = candidate("friction", {5: 1.0, 6: 0.0052})
    t, none = mixed({0: 1.0}), np.empty((N, 0))
    circuit = replace(design({2: voltage}), name="electrical", coefficients=(), columns=none, samples=none)

    found = search_all(
        [design({5: 6.0}), circuit],
        [flux, friction],
        Variables(t=t, theta_m=None, omega_m=t, alpha_m=0.0 * t, gravity=0.0 * t, mu=1.0, averaged=True),
        {},
        lambda _: None,
    )
    verdict = decided(found)
    named = verdict.tied or [one.variant.candidate.id for one in verdict.adopted]
    assert found["electrical"].best.variants == ()
    assert expected == (verdict.verdict, set(named))


@pytest.mark.parametrize(
    ("voltage", "expected"), [(0.002, "flux"), (0.2, "friction")], ids=["silent", "against"]
)
def test_the_torque_names_an_effect_on_the_flux_unless_the_voltage_is_against_it(
    voltage: float, expected: str
) -> None:
    """The flux's effect fits the torque of 6 better; its voltage, `voltage`, is not there."""
    flux = replace(
        candidate("flux", {2: 1.0}, balance="electrical"),
        also=lambda _: mixed({5: 6.0 / voltage})[:, None],
        joint=True,
    )
    friction = candidate("friction", {5: 1.0, 6: 0.2})
    t, none = mixed({0: 1.0}), np.empty((N, 0))
    circuit = replace(design({}), name="electrical", coefficients=(), columns=none, samples=none)

    found = search_all(
        [design({5: 6.0}), circuit],
        [flux, friction],
        Variables(t=t, theta_m=None, omega_m=t, alpha_m=0.0 * t, gravity=0.0 * t, mu=1.0, averaged=True),
        {},
        lambda _: None,
    )

    assert [expected] == [v.candidate.id for v in found["mechanical"].best.variants]
